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

/// Delay of buttons in ticks: 67 ms at 60 ticks a second, the time that a packet may take without delaying anyone.
pub(crate) const DELAY: u64 = 4;
/// Timeout after which a silent side is considered gone.
const PATIENCE: Duration = Duration::from_secs(10);
/// First tick at which the option `--desync` takes effect.
const CHEAT_AT: u64 = 100;
/// Interval in ticks at which hashes are printed; they are compared at every tick.
const PRINT: u64 = 10;

/// Result of a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All hashes were the same.
    Agreed,
    /// A hash differed.
    Parted,
}

/// Ways to provoke a desync.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cheat {
    /// Moves a ship by an ulp, before the hash of tick 100 is taken.
    Ulp,
    /// Misses the first buttons of the other player from tick 100 on.
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

/// The state at a tick, until the hash of the other side arrives.
struct Kept {
    tick: u64,
    hash: u64,
    world: World,
    /// Buttons held over the tick that led to the hash.
    held: [Controls; 2],
}

/// The connection, and the messages under way on it.
struct Side {
    stream: TcpStream,
    /// Ticks whose hash the other side has not sent yet, the oldest first: as many as the delay has, and this one.
    kept: VecDeque<Kept>,
    /// The last state on which both sides agreed.
    agreed: Option<World>,
    /// Memory of a state that is no longer kept, to reuse.
    spare: Option<World>,
    /// Buttons of the other side for future ticks.
    others: VecDeque<Controls>,
}

/// Plays a match over a connection. Prints `hash TICK HASH` for every tenth tick that both agree on, and `done TICK HASH`.
///
/// # Errors
/// A message for the user: the other side is gone, silent, or plays another match.
pub(crate) fn play(
    player: usize,
    stream: TcpStream,
    ticks: u64,
    seed: u64,
    cheat: Option<Cheat>,
) -> Result<Outcome, Box<dyn Error>> {
    let (game, mut world) = Game::start()?;
    // Buttons pressed at the first tick act after the delay; until then nobody presses anything.
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
        // The message that the other side sent a delay ago has its buttons for this tick.
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
    // The hashes of the last ticks are still under way.
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
        // A message is small and urgent: it must not wait to share a packet with the next one.
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

    /// Waits for the other side's message about the oldest kept tick; returns true if the hashes agree.
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

    /// Closes the connection without losing data under way: if it is closed with unread data, TCP resets it, and the other side
    /// would see an error in place of the message with the hash that differs.
    fn leave(&mut self) {
        if self.stream.shutdown(Shutdown::Write).is_ok() {
            let _ = std::io::copy(&mut self.stream, &mut std::io::sink());
        }
    }
}

/// Writes a dump of the tick in which the sides diverged, for `umbra diff`: from the last world that
/// both had to the first that differs, with the inputs of this side.
fn dump(game: &Game, before: &World, kept: &Kept, player: usize) -> Result<PathBuf, Box<dyn Error>> {
    let act = |world: &mut World| {
        // A refused command is refused on both sides.
        let _ = game.act(world, kept.held);
    };
    let file = env::temp_dir().join(format!("lockstep-{}-{}-{player}.umbradmp", std::process::id(), kept.tick));
    fs::write(&file, Dump::of_game(before, act, &kept.world).to_bytes())?;
    Ok(file)
}
