//! The bodies of a run by number and name: of a scene, which lists them, or of a replay, where they come as they come.

use std::collections::BTreeMap;

use umbra_physics::{BodyId, Labels, Scalar, World};
use umbra_scene::SceneRun;

/// The bodies of a run.
pub(crate) trait Cast {
    /// The number of a body, from 0; `None` for one that has none.
    fn index(&self, body: BodyId) -> Option<usize>;

    /// The name of a body.
    fn name(&self, body: BodyId) -> &str;
}

impl<S: Scalar> Cast for SceneRun<'_, S> {
    fn index(&self, body: BodyId) -> Option<usize> {
        SceneRun::index(self, body)
    }

    fn name(&self, body: BodyId) -> &str {
        SceneRun::name(self, body)
    }
}

/// The bodies of a replay, numbered in the order in which they come. One without a name is called by its handle.
#[derive(Debug, Default)]
pub(crate) struct Roster {
    numbers: BTreeMap<BodyId, usize>,
    names: Vec<String>,
}

impl Roster {
    /// Adds the bodies of a world that are new.
    pub(crate) fn see(&mut self, world: &World, labels: &Labels) {
        for body in world.bodies() {
            let id = body.id();
            self.numbers.entry(id).or_insert_with(|| {
                self.names.push(labels.body(id).map_or_else(|| id.to_string(), str::to_owned));
                self.names.len() - 1
            });
        }
    }
}

impl Cast for Roster {
    fn index(&self, body: BodyId) -> Option<usize> {
        self.numbers.get(&body).copied()
    }

    fn name(&self, body: BodyId) -> &str {
        self.index(body).map_or("", |index| &self.names[index])
    }
}
