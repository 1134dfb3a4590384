//! Lockstep: two processes over TCP, with a `Rollback` whose window is 0. A tick is made once both sides' inputs for it have
//! arrived; inputs are sent a few ticks ahead, to allow for the delay of the network. Each side sends the hash of its state at
//! every tick.
//!
//! ```sh
//! cargo run --release --example lockstep                  # starts both sides and compares their output
//! cargo run --release --example lockstep -- --desync ulp  # one side moves a ship by an ulp; `drop`: it misses an input
//! cargo run --release --example lockstep -- serve         # one side only: prints a port,
//! cargo run --release --example lockstep -- join --port PORT  # for the other side
//! ```
//!
//! Exit status 0 if the sides agree to the end, 1 if they diverge, 2 if there is no match.

#[path = "../shared/game.rs"]
mod game;
#[path = "../shared/options.rs"]
mod options;
#[path = "../shared/peers.rs"]
#[allow(dead_code, reason = "a peer is told nothing here")]
mod peers;
#[path = "../../tests/support/random.rs"]
mod random;
mod side;
mod wire;

use std::error::Error;
use std::io;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::process::ExitCode;
use std::thread;
use std::time::{Duration, Instant};
use std::{env, fs};

use options::Options;
use peers::Peer;
use side::{Cheat, play};
use umbra_physics::Dump;

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1).peekable();
    let role = arguments.next_if(|first| !first.starts_with("--"));
    run(role.as_deref(), arguments).unwrap_or_else(|error| {
        eprintln!("lockstep: {error}");
        ExitCode::from(2)
    })
}

fn run(role: Option<&str>, arguments: impl Iterator<Item = String>) -> Result<ExitCode, Box<dyn Error>> {
    let known = ["ticks", "seed", "desync", "port"];
    let options = Options::read(arguments, if role == Some("join") { &known } else { &known[..3] })?;
    let (player, stream) = match role {
        None => return both(&options),
        Some("serve") => {
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
            println!("port {}", listener.local_addr()?.port());
            (0, accept(&listener)?)
        }
        Some("join") => {
            let port: u16 = options.get("port")?.ok_or("join needs --port")?;
            (1, TcpStream::connect((Ipv4Addr::LOCALHOST, port))?)
        }
        Some(role) => return Err(format!("unknown role {role}: serve, join, or none for both").into()),
    };
    let (ticks, seed) = (options.get("ticks")?.unwrap_or(600), options.get("seed")?.unwrap_or(1));
    let agreed = play(player, stream, ticks, seed, options.get::<Cheat>("desync")?)?;
    Ok(if agreed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Accepts the first connection within a minute, so that no process waits for ever.
fn accept(listener: &TcpListener) -> io::Result<TcpStream> {
    listener.set_nonblocking(true)?;
    let deadline = Instant::now() + Duration::from_secs(60);
    loop {
        match listener.accept() {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock && Instant::now() < deadline => {
                thread::sleep(Duration::from_millis(5));
            }
            // On some systems a connection inherits the settings of its listener.
            accepted => return accepted.and_then(|(stream, _)| stream.set_nonblocking(false).map(|()| stream)),
        }
    }
}

/// Starts two sides and compares their output.
fn both(options: &Options) -> Result<ExitCode, Box<dyn Error>> {
    let program = env::current_exe()?;
    let start = |role: &[&str], cheats: bool| {
        let passed = options.pairs().filter(|(name, _)| cheats || *name != "desync");
        let passed = passed.flat_map(|(name, value)| [format!("--{name}"), value.to_owned()]);
        let all: Vec<_> = role.iter().map(|&word| word.to_owned()).chain(passed).collect();
        Peer::start(&program, &all, Duration::from_secs(60))
    };
    let mut server = start(&["serve"], false)?;
    let port = server.hear("port")?;
    let client = start(&["join", "--port", &port], true)?;
    let sides = [server.end()?, client.end()?];
    let lines_of = |side: usize, of_hashes: bool| {
        let said = sides[side].said.iter().filter(|line| !line.starts_with("port"));
        said.filter(move |line| line.starts_with("hash") == of_hashes).collect::<Vec<_>>()
    };
    let same = lines_of(0, true).iter().zip(lines_of(1, true)).take_while(|(a, b)| **a == *b).count();
    println!("{same} hashes, one every tenth tick, are the same");
    let (ours, theirs) = (lines_of(0, false), lines_of(1, false));
    for (player, (said, opposite)) in [(&ours, &theirs), (&theirs, &ours)].into_iter().enumerate() {
        println!("player {player} ends with status {:?}", sides[player].status);
        // The first value that differs, if the sides diverged.
        said.iter().filter(|line| !opposite.contains(line)).for_each(|line| println!("  {line}"));
    }
    let dumps: Vec<&str> =
        sides.iter().flat_map(|side| &side.said).filter_map(|line| line.strip_prefix("dump ")).collect();
    if let [a, b] = dumps[..] {
        let [a, b] = [a, b].map(|file| Ok::<_, Box<dyn Error>>(Dump::from_bytes(&fs::read(file)?, &[])?));
        match a?.first_difference(&b?) {
            Some(difference) => println!("the first value that is not the same: {difference}"),
            None => println!("the sides do the same from the same world: one of them was changed from without"),
        }
    }
    let agree =
        lines_of(0, true) == lines_of(1, true) && ours == theirs && sides.iter().all(|side| side.status == Some(0));
    Ok(if agree { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
