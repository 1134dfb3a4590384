//! Rollback with [GGRS](https://docs.rs/ggrs): a match of two processes over UDP, on a line that is late and loses messages.
//!
//! ```sh
//! cargo run --release --example ggrs                  # starts both sides, and compares what they say
//! cargo run --release --example ggrs -- --desync 100  # the same, but one side moves a ship by an ulp at frame 100
//! cargo run --release --example ggrs -- synctest      # both players here; seven frames are undone before each frame
//! ```
//!
//! `adapter.rs` is reusable in any game; `session.rs` describes this game to GGRS; `peer.rs` is the main loop of
//! the game; `socket.rs` simulates a bad line.

mod adapter;
#[path = "../shared/game.rs"]
mod game;
#[path = "../shared/options.rs"]
mod options;
mod peer;
#[path = "../shared/peers.rs"]
mod peers;
#[path = "../../tests/support/random.rs"]
mod random;
mod session;
mod socket;

use std::env;
use std::error::Error;
use std::process::ExitCode;
use std::time::Duration;

use game::Game;
use options::Options;
use peers::Peer;

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1).peekable();
    let role = arguments.next_if(|first| !first.starts_with("--"));
    let done = match role.as_deref() {
        None => both(arguments),
        Some("peer") => Options::read(arguments, &peer::OPTIONS).map_err(Into::into).and_then(|o| peer::play(&o)),
        Some("synctest") => {
            Options::read(arguments, &["frames", "seed"]).map_err(Into::into).and_then(|o| synctest(&o))
        }
        Some(role) => Err(format!("unknown role {role}: peer, synctest, or none for both peers").into()),
    };
    done.unwrap_or_else(|error| {
        eprintln!("ggrs: {error}");
        ExitCode::from(2)
    })
}

/// Plays a match in this process alone.
fn synctest(options: &Options) -> Result<ExitCode, Box<dyn Error>> {
    let frames = options.get("frames")?.unwrap_or(1_000);
    let (game, world) = Game::start()?;
    let seed = options.get("seed")?.unwrap_or(1);
    // A refused call is refused on every side.
    let end = session::sync_test(world, frames, seed, |world, held| _ = game.act(world, held))?;
    let (undone, hash) = (end.undone, end.world.state_hash());
    println!("{frames} frames, {undone} undone and made again with the same hashes; {hash:016x} at the end");
    Ok(ExitCode::SUCCESS)
}

/// Starts two peers, tells them each other's ports, and compares their output.
fn both(arguments: impl Iterator<Item = String>) -> Result<ExitCode, Box<dyn Error>> {
    let options = Options::read(arguments, &["frames", "seed", "latency", "lost", "desync"])?;
    let program = env::current_exe()?;
    let start = |player: &str| {
        // They diverge if only one side does something.
        let orders = options.pairs().filter(|(name, _)| player == "1" || *name != "desync");
        let orders = orders.flat_map(|(name, value)| [format!("--{name}"), value.to_owned()]);
        let all: Vec<_> = ["peer", "--player", player].map(String::from).into_iter().chain(orders).collect();
        Peer::start(&program, &all, Duration::from_secs(70))
    };
    let mut peers = [start("0")?, start("1")?];
    let ports = [peers[0].hear("port")?, peers[1].hear("port")?];
    peers[0].tell(&ports[1])?;
    peers[1].tell(&ports[0])?;
    for (player, peer) in peers.iter_mut().enumerate() {
        println!("player {player}: {}", peer.hear("done")?);
    }
    let [a, b] = peers;
    let (a, b) = (a.end()?, b.end()?);
    let lines_of =
        |said: &[String], word| said.iter().filter(|line| line.starts_with(word)).cloned().collect::<Vec<_>>();
    let (hashes, others) = (lines_of(&a.said, "hash"), lines_of(&b.said, "hash"));
    let same = hashes.iter().zip(&others).take_while(|(a, b)| a == b).count();
    println!("{same} of {} hashes are the same; the last is {:?}", hashes.len(), hashes.last());
    for (player, said) in [a.said, b.said].iter().enumerate() {
        if let Some(first) = lines_of(said, "desync").first() {
            println!("player {player}: {first}");
        }
    }
    let agree = hashes == others && a.status == Some(0) && b.status == Some(0);
    Ok(if agree { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
