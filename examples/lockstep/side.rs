//! One side of a match.

use std::collections::VecDeque;
use std::error::Error;
use std::net::{Shutdown, TcpStream};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;
use std::{env, fs};

use umbra_physics::{Command, Dump, Fx, Inputs, PHYSICS_VERSION, Rollback, World};

use crate::game::{Controls, Game, bot};
use crate::wire::{Hello, MAGIC, Turn, receive, send};

/// Delay of buttons in ticks: 67 ms at 60 ticks a second, the time that a packet may take without delaying anyone.
const DELAY: u64 = 4;
/// Timeout after which a silent side is considered gone.
const PATIENCE: Duration = Duration::from_secs(10);
/// First tick at which the option `--desync` takes effect.
const CHEAT_AT: u64 = 100;
/// Interval in ticks at which hashes are printed; they are compared at every tick.
const PRINT: u64 = 10;

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
    hash: u64,
    world: World,
    /// The calls of the tick before.
    calls: Vec<Command>,
}

/// A match under way, and the connection.
struct Side {
    stream: TcpStream,
    player: u32,
    seed: u64,
    cheat: Option<Cheat>,
    game: Game,
    world: World,
    rollback: Rollback<Controls>,
    /// States whose hash the other side has not sent yet, the oldest first.
    kept: VecDeque<Kept>,
    /// The last state on which both sides agreed.
    agreed: World,
}

/// Plays a match over a connection. Prints `hash TICK HASH` for every tenth tick that both agree on, and `done TICK HASH`.
/// Returns true if all hashes were the same.
///
/// # Errors
/// A message for the user: the other side is gone, silent, or plays another match.
pub(crate) fn play(
    player: u32,
    mut stream: TcpStream,
    ticks: u64,
    seed: u64,
    cheat: Option<Cheat>,
) -> Result<bool, Box<dyn Error>> {
    let (game, world) = Game::start()?;
    greet(
        &mut stream,
        Hello { magic: MAGIC, physics_version: PHYSICS_VERSION, seed, ticks, start: world.state_hash() },
    )?;
    // A window of 0: no tick is made before the buttons of both players are known.
    let mut rollback = Rollback::new(&world, [0, 1], 0);
    // Buttons pressed at the first tick act after the delay; until then nobody presses anything.
    for tick in 0..DELAY {
        rollback.add_input(tick, 0, Controls::default())?;
        rollback.add_input(tick, 1, Controls::default())?;
    }
    let (agreed, kept) = (world.clone(), VecDeque::new());
    let mut side = Side { stream, player, seed, cheat, game, world, rollback, kept, agreed };
    side.say(Vec::new())?;
    for tick in 0..=ticks {
        while side.world.tick() < ticks && side.advance()? {}
        if !side.hear(tick)? {
            return Ok(false);
        }
    }
    println!("done {ticks} {:016x}", side.world.state_hash());
    Ok(true)
}

/// Makes sure that the other side plays the same match.
fn greet(stream: &mut TcpStream, hello: Hello) -> Result<(), Box<dyn Error>> {
    // A message is small and urgent: it must not wait to share a packet with the next one.
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    send(stream, &hello)?;
    match hello.differs_from(&receive(stream)?) {
        None => Ok(()),
        Some(what) => Err(format!("the other side has another {what}").into()),
    }
}

impl Side {
    /// Makes the next tick and sends its hash; returns false if it has to wait for the buttons of the other side.
    fn advance(&mut self) -> Result<bool, Box<dyn Error>> {
        let game = self.game;
        let report = self.rollback.advance(&mut self.world, |world, inputs| {
            // A refused call is refused on both sides.
            let _ = game.act(world, [inputs[0].1, inputs[1].1]);
        })?;
        let Some(calls) = report.confirmed().next().map(|tick| tick.commands.to_vec()) else { return Ok(false) };
        self.say(calls)?;
        Ok(true)
    }

    /// Sends the hash of a tick and the buttons for a later one, and keeps the state to answer for.
    fn say(&mut self, calls: Vec<Command>) -> Result<(), Box<dyn Error>> {
        let tick = self.world.tick();
        if self.cheat == Some(Cheat::Ulp) && tick == CHEAT_AT {
            let ship = self.game.ships[0];
            let mut position = self.world.body(ship)?.position();
            position.x = position.x.saturating_add(Fx::from_bits(1));
            self.world.set_position(ship, position)?;
            // Otherwise the rollback notices a change between two ticks.
            self.rollback.restart(&self.world);
        }
        let (hash, controls) = (self.world.state_hash(), bot(self.seed, self.player as usize, tick));
        self.rollback.add_input(tick + DELAY, self.player, controls)?;
        send(&mut self.stream, &Turn { tick, hash, controls })?;
        self.kept.push_back(Kept { hash, world: self.world.clone(), calls });
        Ok(())
    }

    /// Waits for the other side's message of a tick: its hash, and its buttons for a later tick. Returns true if the hashes agree.
    fn hear(&mut self, tick: u64) -> Result<bool, Box<dyn Error>> {
        let mut turn: Turn = receive(&mut self.stream)?;
        let kept =
            self.kept.pop_front().filter(|_| turn.tick == tick).ok_or("a message of the other side is missing")?;
        let hash = kept.hash;
        if turn.hash != hash {
            println!("desync {tick} {hash:016x} {:016x}", turn.hash);
            println!("dump {}", self.dump(&kept)?.display());
            self.leave();
            return Ok(false);
        }
        if tick % PRINT == 0 {
            println!("hash {tick} {hash:016x}");
        }
        self.agreed = kept.world;
        if self.cheat == Some(Cheat::Drop) && tick + DELAY >= CHEAT_AT && turn.controls != Controls::default() {
            (turn.controls, self.cheat) = (Controls::default(), None);
        }
        self.rollback.add_input(tick + DELAY, 1 - self.player, turn.controls)?;
        Ok(true)
    }

    /// Writes a dump of the tick in which the sides diverged, for `umbra diff`: from the last world that
    /// both had to the first that differs, with the calls of this side.
    fn dump(&self, kept: &Kept) -> Result<PathBuf, Box<dyn Error>> {
        let name = format!("lockstep-{}-{}-{}.umbradmp", std::process::id(), kept.world.tick(), self.player);
        let file = env::temp_dir().join(name);
        fs::write(&file, Dump::of_tick(&self.agreed, &kept.calls, &Inputs::new(), &kept.world).to_bytes())?;
        Ok(file)
    }

    /// Closes the connection without losing data under way: if it is closed with unread data, TCP resets it, and the other side
    /// would see an error in place of the message with the hash that differs.
    fn leave(&mut self) {
        if self.stream.shutdown(Shutdown::Write).is_ok() {
            let _ = std::io::copy(&mut self.stream, &mut std::io::sink());
        }
    }
}
