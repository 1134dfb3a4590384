//! One side of a match between two processes.

use std::error::Error;
use std::io::BufRead as _;
use std::net::{Ipv4Addr, SocketAddr};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ggrs::{DesyncDetection, Frame, GgrsError, GgrsEvent, P2PSession, PlayerType, SessionBuilder, SessionState};
use umbra_physics::{BodyId, Fx, World};

use crate::adapter::GgrsWorld;
use crate::game::{Game, bot};
use crate::options::Options;
use crate::session::{Match, WINDOW, controls};
use crate::socket::{BadLine, Line};

/// Duration of a frame: short, so that a match is over in seconds; the line counts frames.
const FRAME: Duration = Duration::from_millis(2);
/// Interval in frames at which peers compare hashes and print them.
const CHECK: u32 = 10;
/// Time limit of a match.
const LIMIT: Duration = Duration::from_secs(60);

pub(crate) const OPTIONS: [&str; 6] = ["player", "frames", "seed", "latency", "lost", "desync"];

/// Settings of a peer.
struct Orders {
    player: usize,
    frames: u32,
    seed: u64,
    line: Line,
    /// Frame before which a ship is moved by one ulp, on this side only.
    desync: Option<u64>,
}

impl Orders {
    fn read(options: &Options) -> Result<Self, String> {
        let player = options.get("player")?.filter(|player| *player < 2).ok_or("--player takes 0 or 1")?;
        Ok(Self {
            player,
            frames: options.get("frames")?.unwrap_or(600),
            seed: options.get("seed")?.unwrap_or(1),
            line: Line {
                latency: options.get("latency")?.unwrap_or(5),
                jitter: 3,
                lost: options.get("lost")?.unwrap_or(10),
                doubled: 5,
            },
            desync: options.get("desync")?,
        })
    }

    fn start(&self, socket: BadLine, port: u16) -> Result<P2PSession<Match>, GgrsError> {
        let remote = PlayerType::Remote(SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
        let players = if self.player == 0 { [PlayerType::Local, remote] } else { [remote, PlayerType::Local] };
        let [first, second] = players;
        SessionBuilder::<Match>::new()
            .with_num_players(2)?
            .with_max_prediction_window(WINDOW)
            .with_input_delay(0)
            .with_fps((1_000 / FRAME.as_millis()) as usize)?
            .with_desync_detection_mode(DesyncDetection::On { interval: CHECK })
            .with_disconnect_timeout(Duration::from_secs(20))
            .add_player(first, 0)?
            .add_player(second, 1)?
            .start_p2p_session(socket)
    }
}

/// A match that is under way.
struct Peer {
    orders: Orders,
    session: P2PSession<Match>,
    game: Game,
    ours: GgrsWorld,
    /// The frame whose hash is printed next.
    next: u32,
    /// Number of frames to skip, so that the other side catches up.
    skip: u32,
    parted: bool,
}

/// Plays a match: prints `port N`, and reads the port of the other side from the standard input; then `hash FRAME HASH` for
/// the frames that nothing can change any more, `desync FRAME HASH HASH` for those in which GGRS found that the other side
/// has another hash; at last `done` and the work of rolling back. Ends when its standard input does.
///
/// # Errors
/// A message for the user.
pub(crate) fn play(options: &Options) -> Result<ExitCode, Box<dyn Error>> {
    let orders = Orders::read(options)?;
    let socket = BadLine::bind(orders.line, orders.seed.wrapping_add(orders.player as u64))?;
    println!("port {}", socket.port()?);
    let mut port = String::new();
    std::io::stdin().lock().read_line(&mut port)?;
    let session = orders.start(socket, port.trim().parse()?)?;
    let dismissed = when_input_ends();

    let (game, world) = Game::start()?;
    let mut peer = Peer { orders, session, game, ours: GgrsWorld::new(world), next: CHECK, skip: 0, parted: false };
    let deadline = Instant::now() + LIMIT;
    // The other side may still need packets of this one after it is done.
    let mut done = false;
    while !(done && dismissed.load(Ordering::Relaxed)) {
        if Instant::now() > deadline {
            return Err("the match takes too long".into());
        }
        peer.frame()?;
        if !done && peer.next > peer.orders.frames {
            done = true;
            let GgrsWorld { loads, undone, deepest, .. } = peer.ours;
            println!("done loads {loads} undone {undone} deepest {deepest}");
        }
        thread::sleep(FRAME);
    }
    Ok(if peer.parted { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

fn when_input_ends() -> Arc<AtomicBool> {
    let ended = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&ended);
    thread::spawn(move || {
        std::io::stdin().lock().lines().for_each(drop);
        flag.store(true, Ordering::Relaxed);
    });
    ended
}

impl Peer {
    /// A turn of the game's loop: hear, then move on by a frame if the window of prediction allows it.
    fn frame(&mut self) -> Result<(), Box<dyn Error>> {
        if self.session.current_state() != SessionState::Running || self.skip > 0 {
            self.skip = self.skip.saturating_sub(1);
            self.session.poll_remote_clients();
            return self.hear();
        }
        // If GGRS does not advance, it asks for the same frame again, and this input must be the same then.
        let held = bot(self.orders.seed, self.orders.player, self.session.current_frame() as u64);
        self.session.add_local_input(self.orders.player, held)?;
        let requests = match self.session.advance_frame() {
            Err(GgrsError::PredictionThreshold | GgrsError::NotSynchronized) => return self.hear(),
            requests => requests?,
        };
        let (game, desync) = (self.game, self.orders.desync);
        self.ours.fulfil(requests, |world, inputs| {
            // Repeated whenever this frame is recomputed.
            if desync == Some(world.tick()) {
                move_by_an_ulp(world, game.ships[0]);
            }
            // A refused call is refused on both sides.
            let _ = game.act(world, controls(inputs));
        })?;
        self.print_confirmed();
        self.hear()
    }

    /// Prints the hashes of the frames before which all inputs are known.
    fn print_confirmed(&mut self) {
        // The call before this one rolled back with all known inputs, so the saved hash of such a frame is final.
        let confirmed = self.session.confirmed_frame() + 1;
        while self.next <= self.orders.frames && self.next as Frame <= confirmed {
            let Some(hash) = self.ours.hash(self.next as Frame) else { break };
            println!("hash {} {hash:016x}", self.next);
            self.next += CHECK;
        }
    }

    fn hear(&mut self) -> Result<(), Box<dyn Error>> {
        for event in self.session.events() {
            match event {
                GgrsEvent::WaitRecommendation { skip_frames } => self.skip += skip_frames,
                GgrsEvent::DesyncDetected { frame, local_checksum, remote_checksum, .. } => {
                    println!("desync {frame} {local_checksum:016x} {remote_checksum:016x}");
                    self.parted = true;
                }
                GgrsEvent::Disconnected { .. } => return Err("the other side is gone".into()),
                // Messages about connecting, and about a line that is silent for a while.
                _ => {}
            }
        }
        Ok(())
    }
}

/// Moves a body to the right.
fn move_by_an_ulp(world: &mut World, body: BodyId) {
    let mut position = world.body(body).expect("a ship stays in the world").position();
    position.x = position.x.saturating_add(Fx::from_bits(1));
    world.set_position(body, position).expect("a place beside the ship");
}
