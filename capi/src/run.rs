//! Runs that are not the caller's: of a scene, and of a replay.

use std::sync::Arc;

use umbra_physics::{Playback, Replay};
use umbra_scene::{Scene, SceneRun};

use crate::status::Result;

/// The run of a scene, with the scene.
#[derive(Clone)]
pub(crate) struct ScenePlay {
    /// First, so that it ends first: it borrows from the scene, whatever its lifetime says, and nothing of it is handed out with
    /// that lifetime.
    pub(crate) run: SceneRun<'static>,
    _scene: Arc<Scene>,
}

impl ScenePlay {
    pub(crate) fn new(scene: Scene) -> Result<Self> {
        let scene = Arc::new(scene);
        // SAFETY: what an `Arc` holds does not move, and lives as long as one of its copies; each play has one, and drops its
        // run before.
        let borrowed: &'static Scene = unsafe { &*Arc::as_ptr(&scene) };
        Ok(Self { run: borrowed.start()?, _scene: scene })
    }
}

/// The playback of a replay, with the replay.
#[derive(Clone)]
pub(crate) struct ReplayPlay {
    /// First, so that it ends first: it borrows from the replay, whatever its lifetime says, and nothing of it is handed out with
    /// that lifetime.
    pub(crate) playback: Playback<'static>,
    replay: Arc<Replay>,
}

impl ReplayPlay {
    pub(crate) fn new(replay: Replay) -> Self {
        let replay = Arc::new(replay);
        // SAFETY: what an `Arc` holds does not move, and lives as long as one of its copies; each play has one, and drops its
        // playback before.
        let borrowed: &'static Replay = unsafe { &*Arc::as_ptr(&replay) };
        Self { playback: borrowed.play(), replay }
    }

    pub(crate) fn replay(&self) -> &Replay {
        &self.replay
    }

    pub(crate) fn is_at_end(&self) -> bool {
        self.playback.world().tick() == self.replay.end()
    }
}

#[cfg(test)]
mod tests {
    use umbra_physics::{Fx, Inputs, RecordOptions, Recorder};

    use super::*;

    const SCENE: &str =
        r#"{"bodies": [{"name": "a"}], "inputs": [{"from": 0, "to": 9, "body": "a", "force": [1, 0]}]}"#;

    #[test]
    fn the_run_of_a_scene_outlives_its_copies_and_they_it() {
        let mut first = ScenePlay::new(Scene::parse(SCENE).unwrap()).unwrap();
        let mut second = first.clone();
        first.run.advance().unwrap();
        drop(first);
        for _ in 0..9 {
            second.run.advance().unwrap();
        }
        assert!(second.run.world().bodies().all(|body| body.velocity().x > Fx::ZERO));
    }

    #[test]
    fn the_playback_of_a_replay_outlives_its_copies_and_they_it() {
        let mut world = ScenePlay::new(Scene::parse(SCENE).unwrap()).unwrap().run.into_world();
        let mut recorder = Recorder::new(&world, RecordOptions::default());
        for _ in 0..9 {
            recorder.step(&mut world, &Inputs::new());
        }
        let replay = Replay::from_bytes(&recorder.finish(&world), &[]).unwrap();
        let mut first = ReplayPlay::new(replay);
        let mut second = first.clone();
        assert_eq!(first.playback.step(), Ok(true));
        drop(first);
        while second.playback.step().unwrap() {}
        assert_eq!(second.playback.world().state_hash(), world.state_hash());
    }
}
