//! One side of a match.

use std::collections::VecDeque;
use std::error::Error;
use std::net::{Shutdown, TcpStream};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;
use std::{env, fs};

use umbra_physics::{Dump, Fx, PHYSICS_VERSION, World};

use crate::game::{Controls, Game, bot};
use crate::wire::{Hello, Turn};

/// Buttons act so many ticks after they are pressed: 67 ms at 60 ticks a second, which a packet may take without anyone waiting.
pub(crate) const DELAY: u64 = 4;
/// A side that says nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(10);
/// The tick from which a side that is told to cheats.
const CHEAT_AT: u64 = 100;
/// Hashes are printed every so many ticks; they are compared at each.
const PRINT: u64 = 10;

/// Result of a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All hashes were the same.
    Agreed,
    /// One was not.
    Parted,
}

/// Ways to provoke a desync.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cheat {
    /// A ship is put aside by an ulp, before the hash of tick 100 is taken.
    Ulp,
    /// The first buttons of the other player's from tick 100 on are missed.
    Drop,
}

impl FromStr for Cheat {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        match text {
            "ulp" => Ok(Self::Ulp),
            "drop" => Ok(Self::Drop),
            _ => Err(()),
        }
    }
}

/// The state at a tick, until the other side has said what it has there.
struct Kept {
    tick: u64,
    hash: u64,
    world: World,
    /// Buttons held over the tick that led to the hash.
    held: [Controls; 2],
}

/// The connection, and what is under way on it.
struct Side {
    stream: TcpStream,
    /// The ticks that the other side has not spoken about yet, the oldest first: as many as the delay has, and this one.
    kept: VecDeque<Kept>,
    /// The last state that both sides have.
    agreed: Option<World>,
    /// The memory of a state that is no longer kept, for the next one.
    spare: Option<World>,
    /// The other side's buttons for the ticks to come.
    others: VecDeque<Controls>,
}

/// Plays a match over a connection. Prints `hash TICK HASH` for every tenth tick that both agree on, and `done TICK HASH`.
///
/// # Errors
/// What went wrong, for the user: the other side is gone, silent, or plays another match.
pub(crate) fn play(
    player: usize,
    stream: TcpStream,
    ticks: u64,
    seed: u64,
    cheat: Option<Cheat>,
) -> Result<Outcome, Box<dyn Error>> {
    let (game, mut world) = Game::start()?;
    // What is pressed at the first tick acts after the delay; before that nobody holds anything.
    let mut ours: VecDeque<Controls> = (0..DELAY).map(|_| Controls::default()).collect();
    let mut side = Side { stream, kept: VecDeque::new(), agreed: None, spare: None, others: ours.clone() };
    side.greet(Hello { physics_version: PHYSICS_VERSION, seed, ticks, start: world.state_hash() })?;

    let (mut missed, mut both) = (false, [Controls::default(); 2]);
    for tick in 0..=ticks {
        if cheat == Some(Cheat::Ulp) && tick == CHEAT_AT {
            let mut position = world.body(game.ships[0])?.position();
            position.x = position.x.saturating_add(Fx::from_bits(1));
            world.set_position(game.ships[0], position)?;
        }
        let pressed = bot(seed, player, tick);
        ours.push_back(pressed);
        side.say(&world, tick, pressed, both)?;
        // What the other side said a delay ago has its buttons for this tick.
        if tick >= DELAY && !side.hear(&game, player)? {
            return Ok(Outcome::Parted);
        }
        if tick == ticks {
            break;
        }
        let held = ours.pop_front().unwrap_or_default();
        let mut other = side.others.pop_front().unwrap_or_default();
        if cheat == Some(Cheat::Drop) && tick >= CHEAT_AT && !missed && other != Controls::default() {
            (other, missed) = (Controls::default(), true);
        }
        both = if player == 0 { [held, other] } else { [other, held] };
        game.advance(&mut world, both)?;
    }
    // The hashes of the last ticks are still on their way.
    while !side.kept.is_empty() {
        if !side.hear(&game, player)? {
            return Ok(Outcome::Parted);
        }
    }
    println!("done {ticks} {:016x}", world.state_hash());
    Ok(Outcome::Agreed)
}

impl Side {
    /// Makes sure that the other side plays the same match.
    fn greet(&mut self, hello: Hello) -> Result<(), Box<dyn Error>> {
        // A turn is small and wanted at once: it must not wait for the next one to share its packet.
        self.stream.set_nodelay(true)?;
        self.stream.set_read_timeout(Some(PATIENCE))?;
        self.stream.set_write_timeout(Some(PATIENCE))?;
        hello.send(&mut self.stream)?;
        match hello.differs_from(&Hello::receive(&mut self.stream)?) {
            None => Ok(()),
            Some(what) => Err(format!("the other side has another {what}").into()),
        }
    }

    /// Sends the hash of a tick and the buttons for a later one, and keeps the state to answer for.
    fn say(&mut self, world: &World, tick: u64, controls: Controls, held: [Controls; 2]) -> Result<(), Box<dyn Error>> {
        let hash = world.state_hash();
        Turn { tick, hash, controls: controls.0 }.send(&mut self.stream)?;
        let world = match self.spare.take() {
            Some(mut spare) => {
                spare.clone_from(world);
                spare
            }
            None => world.clone(),
        };
        self.kept.push_back(Kept { tick, hash, world, held });
        Ok(())
    }

    /// Waits for what the other side says of the oldest tick that is kept; whether it has the same state there.
    fn hear(&mut self, game: &Game, player: usize) -> Result<bool, Box<dyn Error>> {
        let Some(kept) = self.kept.pop_front() else { return Ok(true) };
        let Kept { tick, hash, .. } = kept;
        let turn = Turn::receive(&mut self.stream, tick)?;
        if turn.hash != hash {
            println!("desync {tick} {hash:016x} {:016x}", turn.hash);
            if let Some(before) = &self.agreed {
                println!("dump {}", dump(game, before, &kept, player)?.display());
            }
            self.leave();
            return Ok(false);
        }
        if tick % PRINT == 0 {
            println!("hash {tick} {hash:016x}");
        }
        self.others.push_back(Controls(turn.controls));
        self.spare = self.agreed.replace(kept.world);
        Ok(true)
    }

    /// Closes the connection without taking from the other side what is on its way to it: closed with something unread, TCP
    /// resets, and the other side would hear of that in place of the turn that tells it the same.
    fn leave(&mut self) {
        if self.stream.shutdown(Shutdown::Write).is_ok() {
            let _ = std::io::copy(&mut self.stream, &mut std::io::sink());
        }
    }
}

/// Writes down all that is known of the tick in which the sides parted, for `umbra diff` and its like: from the last world that
/// both had to the first that is another, by way of what this side holds was done.
fn dump(game: &Game, before: &World, kept: &Kept, player: usize) -> Result<PathBuf, Box<dyn Error>> {
    let act = |world: &mut World| {
        // What is refused is refused on both sides.
        let _ = game.act(world, kept.held);
    };
    let file = env::temp_dir().join(format!("lockstep-{}-{}-{player}.umbradmp", std::process::id(), kept.tick));
    fs::write(&file, Dump::of_game(before, act, &kept.world).to_bytes())?;
    Ok(file)
}
