//! The sessions of this game: its description for GGRS, and the test without a network.

use std::net::SocketAddr;

use ggrs::{Config, InputStatus, PlayerType, PredictRepeatLast, SessionBuilder};
use umbra_physics::World;

use super::adapter::{GgrsWorld, Saved};
use super::game::{Controls, bot};

/// The game as GGRS sees it.
pub(crate) struct Match;

impl Config for Match {
    type Input = Controls;
    // Buttons are held rather than tapped.
    type InputPredictor = PredictRepeatLast;
    type State = Saved;
    type Address = SocketAddr;
}

/// Largest number of frames that are predicted, and so undone at a time.
pub(crate) const WINDOW: usize = 8;

/// The inputs of the two players; a player who is gone presses nothing.
pub(crate) fn controls(inputs: &[(Controls, InputStatus)]) -> [Controls; 2] {
    [0, 1].map(|player| inputs.get(player).map_or(Controls::default(), |(held, _)| *held))
}

/// Plays a match of two bots alone. Before each frame it goes back by seven and repeats them with the same inputs: the hashes
/// must be the same.
///
/// # Errors
/// [`MismatchedChecksum`](ggrs::GgrsError::MismatchedChecksum) if they are not; an error of the adapter.
pub(crate) fn sync_test(
    world: World,
    frames: u32,
    seed: u64,
    mut tick: impl FnMut(&mut World, [Controls; 2]),
) -> Result<GgrsWorld, Box<dyn std::error::Error>> {
    let mut session = SessionBuilder::<Match>::new()
        .with_num_players(2)?
        .with_max_prediction_window(WINDOW)
        .with_check_distance(WINDOW - 1)
        .add_player(PlayerType::Local, 0)?
        .add_player(PlayerType::Local, 1)?
        .start_synctest_session()?;
    let mut ours = GgrsWorld::new(world);
    for frame in 0..frames {
        for player in [0, 1] {
            session.add_local_input(player, bot(seed, player, frame.into()))?;
        }
        let requests = session.advance_frame()?;
        ours.fulfil(requests, |world, inputs| tick(world, controls(inputs)))?;
    }
    Ok(ours)
}
