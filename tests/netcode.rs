//! Lockstep and rollback as games have them: with GGRS, between processes, over lines that are late and lose messages. Every
//! hash that a peer says is compared with that of a run that never heard of a network.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::fs;
use std::io::{ErrorKind, Write as _};
use std::net::{Ipv4Addr, TcpStream};
use std::time::Duration;

use allocation_counter::measure;
use ggrs::{GgrsError, GgrsRequest, PlayerType, SessionBuilder};
use umbra_physics::{BodyId, Difference, Dump, Fx, Owner, TickPhase};

#[path = "../examples/ggrs/adapter.rs"]
#[allow(dead_code, reason = "the hashes of single frames are for peers")]
mod adapter;
#[path = "support/example.rs"]
mod example;
#[path = "../examples/shared/game.rs"]
mod game;
#[path = "../examples/shared/peers.rs"]
mod peers;
#[path = "support/random.rs"]
mod random;
#[path = "../examples/ggrs/session.rs"]
mod session;
#[path = "../examples/lockstep/wire.rs"]
#[allow(dead_code, reason = "whether two agree is for peers")]
mod wire;

use adapter::GgrsWorld;
use example::example;
use game::{Controls, Game, bot};
use peers::{Ended, Peer};
use session::{Match, WINDOW, sync_test};
use wire::{Hello, MAGIC, Turn, receive, send};

/// A process of a test that is not over by then never will be: the slowest takes 3 s.
const LIMIT: Duration = Duration::from_secs(120);

/// The events of a match, by their number.
#[derive(Debug, Default)]
struct Happened {
    fired: usize,
    hits: usize,
    fell_asleep: usize,
    woke: usize,
    /// The most contacts at a time.
    contacts: usize,
}

/// A match of two bots without any network, whose buttons act `delay` ticks after they are pressed: the hashes from the first
/// tick to the last, and all that happened.
fn straight(seed: u64, ticks: u64, delay: u64) -> (Vec<u64>, Happened) {
    let (game, mut world) = Game::start().expect("a fair game");
    let mut happened = Happened::default();
    let mut hashes = vec![world.state_hash()];
    for tick in 0..ticks {
        let held = |player| tick.checked_sub(delay).map_or(Controls::default(), |tick| bot(seed, player, tick));
        let tally = game.act(&mut world, [held(0), held(1)]).expect("nothing is refused");
        let report = world.step();
        happened.fired += tally.fired;
        happened.hits += tally.hits;
        happened.fell_asleep += report.fell_asleep.len();
        happened.woke += report.woke.len();
        happened.contacts = happened.contacts.max(world.contacts().count());
        hashes.push(world.state_hash());
    }
    (hashes, happened)
}

/// The lines that begin with this word, as what follows it.
fn lines<'t>(ended: &'t Ended, word: &str) -> Vec<Vec<&'t str>> {
    let words = ended.said.iter().map(|line| line.split_whitespace().collect::<Vec<_>>());
    words.filter(|line| line.first() == Some(&word)).map(|line| line[1..].to_vec()).collect()
}

/// (tick, hash) of the lines `hash TICK HASH`.
fn hashes(ended: &Ended) -> Vec<(usize, u64)> {
    let number = |text: &str| text.parse().expect("a tick");
    let hash = |text: &str| u64::from_str_radix(text, 16).expect("a hash");
    lines(ended, "hash").iter().map(|line| (number(line[0]), hash(line[1]))).collect()
}

// In one process.

#[test]
fn going_back_seven_frames_before_each_changes_no_bit() {
    const FRAMES: u32 = 1_000;
    let (game, world) = Game::start().expect("a fair game");
    let end = sync_test(world, FRAMES, 3, |world, held| _ = game.act(world, held).expect("nothing is refused"));
    let end = end.expect("the frames made again have the hashes they had");
    let (straight, happened) = straight(3, FRAMES.into(), 0);
    assert_eq!(Some(&end.world.state_hash()), straight.last(), "from a run that never goes back");
    assert_eq!((end.loads, end.deepest), (FRAMES - WINDOW as u32, WINDOW as u32 - 1));
    // The match had what may go wrong.
    assert!(happened.fired > 50 && happened.hits > 5, "{happened:?}");
    assert!(happened.fell_asleep > 5 && happened.woke > 5 && happened.contacts > 15, "{happened:?}");
}

#[test]
fn a_game_with_state_beside_the_world_is_found() {
    let (game, world) = Game::start().expect("a fair game");
    let steps = Cell::new(0_i64);
    let forgetful = sync_test(world, 100, 3, |world, controls| {
        // What is counted here is not taken back when the world is.
        steps.set(steps.get() + 1);
        world.apply_torque(game.ships[0], Fx::from_bits(steps.get() << 20)).expect("a small torque");
        game.act(world, controls).expect("nothing is refused");
    });
    let error = forgetful.err().expect("the hashes differ");
    let error = error.downcast_ref::<GgrsError>();
    assert!(matches!(error, Some(GgrsError::MismatchedChecksum { .. })), "{error:?}");
}

#[test]
fn a_game_that_steps_by_itself_is_told_so() {
    let (_, world) = Game::start().expect("a fair game");
    let twice = sync_test(world, 100, 3, |world, _| _ = world.step());
    let error = twice.err().expect("frames and ticks differ");
    assert_eq!(error.to_string(), "2 ticks at frame 1: `tick` must not step");
}

#[test]
fn saving_and_loading_take_nothing_from_the_heap() {
    let (_, world) = Game::start().expect("a fair game");
    let session = SessionBuilder::<Match>::new().with_num_players(2).expect("two players");
    let session = session.with_max_prediction_window(WINDOW).with_check_distance(WINDOW - 1);
    let session = session.add_player(PlayerType::Local, 0).and_then(|s| s.add_player(PlayerType::Local, 1));
    let mut session = session.and_then(SessionBuilder::start_synctest_session).expect("a fair session");
    let mut ours = GgrsWorld::new(world);
    let (mut all_saves, mut loads) = (0, 0);
    for frame in 0..100 {
        (0..2).for_each(|player| session.add_local_input(player, Controls::default()).expect("a player"));
        let requests = session.advance_frame().expect("the same hashes");
        let saves = requests.iter().filter(|r| matches!(r, GgrsRequest::SaveGameState { .. })).count();
        loads += requests.iter().filter(|r| matches!(r, GgrsRequest::LoadGameState { .. })).count();
        all_saves += saves;
        let used = measure(|| ours.fulfil(requests, |_, _| ()).expect("what was saved can be loaded"));
        // By then each of GGRS's places has a snapshot, and room for the report that the rocks fell asleep at tick 30.
        if frame > 50 {
            assert_eq!(used.count_total, 0, "frame {frame}: {used:?}");
        }
    }
    assert!(all_saves > 600 && loads > 80, "{all_saves} saves, {loads} loads");
}

// Between two processes, with rollback.

/// Plays a match of two processes, each with these orders besides.
fn rollback_match(orders: [&[&str]; 2]) -> [Ended; 2] {
    let program = example("ggrs");
    let start = |player: usize| {
        let player_name = ["0", "1"][player];
        let all = [&["peer", "--player", player_name], orders[player]].concat();
        Peer::start(&program, &all, LIMIT).expect("a peer starts")
    };
    let mut peers = [start(0), start(1)];
    let ports = [0, 1].map(|player| peers[player].hear("port").expect("a peer says its port"));
    (0..2).for_each(|player| peers[player].tell(&ports[1 - player]).expect("a peer listens"));
    // Either needs the other to the end.
    peers.iter_mut().for_each(|peer| drop(peer.hear("done").expect("a peer comes to the end")));
    peers.map(|peer| peer.end().expect("a peer ends"))
}

#[test]
fn two_processes_over_a_bad_line_roll_back_and_agree() {
    const FRAMES: u64 = 600;
    let orders: &[&str] = &["--frames", "600", "--seed", "5", "--latency", "5", "--lost", "10"];
    let ended = rollback_match([orders, orders]);
    let (straight, _) = straight(5, FRAMES, 0);
    let expected: Vec<_> = (10..=FRAMES as usize).step_by(10).map(|frame| (frame, straight[frame])).collect();
    let (mut all_loads, mut deepest_of_all) = (0, 0);
    for peer in &ended {
        assert_eq!(peer.status, Some(0));
        assert_eq!(hashes(peer), expected);
        assert!(lines(peer, "desync").is_empty());
        let done = &lines(peer, "done")[0];
        let (loads, deepest): (u32, u32) = (done[1].parse().expect("loads"), done[5].parse().expect("frames"));
        all_loads += loads;
        deepest_of_all = deepest_of_all.max(deepest);
    }
    // New buttons every six frames of 600, and messages take five frames or more: the side that is ahead, or either if none is,
    // has foreseen frames with the old buttons almost each time. One that goes back by eight frames may have two changes in it.
    assert!(all_loads >= 40, "{all_loads} loads");
    assert!((5..=WINDOW as u32).contains(&deepest_of_all), "{deepest_of_all} frames undone");
}

#[test]
fn an_ulp_on_one_side_of_a_rollback_match_is_found_by_both() {
    let orders: &[&str] = &["--frames", "300", "--seed", "5"];
    let cheat = [orders, &["--desync", "100"]].concat();
    let ended = rollback_match([orders, &cheat]);
    let (straight, _) = straight(5, 300, 0);
    let [honest, cheat] = ended.each_ref().map(hashes);
    assert_eq!(honest, (10..=300).step_by(10).map(|frame| (frame, straight[frame])).collect::<Vec<_>>());
    // The ship is put aside on the way from frame 100 to 101.
    for ((frame, honest), (_, cheat)) in honest.into_iter().zip(cheat) {
        assert_eq!(honest == cheat, frame <= 100, "frame {frame}");
    }
    let desyncs = ended.each_ref().map(|peer| {
        assert_eq!(peer.status, Some(1));
        let reports = lines(peer, "desync").into_iter();
        reports.map(|line| (line[0].to_owned(), BTreeSet::from([line[1].to_owned(), line[2].to_owned()])))
    });
    let [mut honest, cheat] = desyncs;
    // A report of a hash may be lost, but not all of them on either way.
    let cheat: Vec<_> = cheat.collect();
    assert!(cheat.iter().all(|(frame, _)| frame.parse::<u32>().is_ok_and(|frame| frame > 100)), "{cheat:?}");
    assert!(honest.any(|line| cheat.contains(&line)), "both name a frame, and the same two hashes");
}

// Between two processes, in lockstep.

/// The ticks that buttons take to act: `DELAY` in the example.
const DELAY: u64 = 4;

/// Plays a match of two processes, each with these orders besides.
fn lockstep_match(orders: [&[&str]; 2]) -> [Ended; 2] {
    let program = example("lockstep");
    let mut server = Peer::start(&program, &[&["serve"], orders[0]].concat(), LIMIT).expect("a server starts");
    let port = server.hear("port").expect("a server says its port");
    let client = Peer::start(&program, &[&["join", "--port", &port], orders[1]].concat(), LIMIT);
    let client = client.expect("a client starts");
    [server, client].map(|side| side.end().expect("a side ends"))
}

#[test]
fn two_processes_in_lockstep_agree_at_every_tick() {
    let orders: &[&str] = &["--ticks", "600", "--seed", "7"];
    let (straight, _) = straight(7, 600, DELAY);
    for side in lockstep_match([orders, orders]) {
        assert_eq!(side.status, Some(0));
        assert_eq!(hashes(&side), (0..=600).step_by(10).map(|tick| (tick, straight[tick])).collect::<Vec<_>>());
        assert_eq!(lines(&side, "done"), [["600", &format!("{:016x}", straight[600])]]);
        assert!(lines(&side, "desync").is_empty());
    }
}

/// A match that one side spoils: the tick at which both say that they part, and the first value that is not the same in what
/// they wrote down.
fn parted(orders: [&[&str]; 2]) -> (usize, Difference) {
    let (straight, _) = straight(1, 600, DELAY);
    let ended = lockstep_match(orders);
    let [a, b] = ended.each_ref().map(|side| {
        assert_eq!(side.status, Some(1), "{:?}", side.said);
        assert!(lines(side, "done").is_empty());
        let reports = lines(side, "desync");
        assert_eq!(reports.len(), 1, "{reports:?}");
        reports[0].iter().map(|&word| word.to_owned()).collect::<Vec<_>>()
    });
    assert_eq!((&a[0], &a[1], &a[2]), (&b[0], &b[2], &b[1]), "the same tick, and each other's hash");
    let tick: usize = a[0].parse().expect("a tick");
    let honest = if orders[0].is_empty() { &a } else { &b };
    assert_eq!(honest[1], format!("{:016x}", straight[tick]));
    assert_ne!(honest[1], honest[2]);
    for side in &ended {
        assert!(hashes(side).into_iter().all(|(at, hash)| at < tick && hash == straight[at]));
    }
    let [ours, theirs] = ended.map(|side| {
        let file = lines(&side, "dump")[0][0].to_owned();
        let dump = Dump::from_bytes(&fs::read(&file).expect("a file"), &[]).expect("it is whole");
        fs::remove_file(&file).expect("it is there");
        dump
    });
    (tick, ours.first_difference(&theirs).expect("they part"))
}

#[test]
fn an_ulp_on_one_side_is_found_by_both_at_its_tick() {
    let cheat: &[&str] = &["--desync", "ulp"];
    for orders in [[cheat, &[]], [&[], cheat]] {
        let (tick, difference) = parted(orders);
        assert_eq!(tick, 100);
        // Nothing that was done, and no stage: one world was changed from without after the step.
        assert_eq!((difference.tick, difference.phase), (99, TickPhase::End), "{difference}");
        assert_eq!(
            (difference.owner, &difference.field[..]),
            (Owner::Body(BodyId::from_parts(0, 0)), "position.x"),
            "{difference}"
        );
    }
}

#[test]
fn an_input_that_one_side_misses_is_found_by_both_at_the_next_tick() {
    let cheat: &[&str] = &["--desync", "drop"];
    for (orders, missed) in [([cheat, &[]], 1), ([&[], cheat], 0)] {
        let first = (100..).find(|tick| bot(1, missed, tick - DELAY) != Controls::default()).expect("a bot plays");
        let (tick, difference) = parted(orders);
        assert_eq!(tick as u64, first + 1);
        assert_eq!((difference.tick, difference.phase), (first, TickPhase::Calls), "{difference}");
    }
}

#[test]
fn peers_of_different_matches_do_not_start() {
    let ended = lockstep_match([&["--seed", "1"], &["--seed", "2"]]);
    assert!(ended.iter().all(|side| side.status == Some(2) && hashes(side).is_empty()));
    let ended = lockstep_match([&["--ticks", "10"], &["--ticks", "20"]]);
    assert!(ended.iter().all(|side| side.status == Some(2) && hashes(side).is_empty()));
}

#[test]
fn packets_are_decoded_whole_or_not_at_all() {
    let hello = Hello { magic: MAGIC, physics_version: 7, seed: 1 << 40, ticks: 600, start: u64::MAX };
    let turn = Turn { tick: 300, hash: 0x0123_4567_89ab_cdef, controls: Controls(9) };
    let (mut greeting, mut word) = (Vec::new(), Vec::new());
    send(&mut greeting, &hello).expect("there is room");
    send(&mut word, &turn).expect("there is room");
    assert_eq!(receive::<Hello>(&mut &greeting[..]).ok(), Some(hello));
    assert_eq!(receive::<Turn>(&mut &word[..]).ok(), Some(turn));
    for length in 0..greeting.len() {
        let cut = receive::<Hello>(&mut &greeting[..length]).map_err(|error| error.kind());
        assert_eq!(cut, Err(ErrorKind::UnexpectedEof), "cut at {length}");
    }
    // One for the other; a byte too many; and more than there is, which is not waited for.
    let invalid =
        |result: Result<(), std::io::Error>| assert_eq!(result.map_err(|e| e.kind()), Err(ErrorKind::InvalidData));
    invalid(receive::<Hello>(&mut &word[..]).map(drop));
    invalid(receive::<Turn>(&mut &greeting[..]).map(drop));
    word[0] += 1;
    word.push(0);
    invalid(receive::<Turn>(&mut &word[..]).map(drop));
    invalid(receive::<Hello>(&mut &[0xff, 0xff][..]).map(drop));
}

#[test]
fn invalid_packets_end_a_match_with_an_error() {
    let program = example("lockstep");
    let length = |length: u16| length.to_le_bytes().to_vec();
    let untrusted = [
        ("nothing", vec![]),
        ("half a length", vec![5]),
        ("a frame cut off", [length(32), vec![0; 9]].concat()),
        ("an empty frame", length(0)),
        ("a frame of 64 kB", [length(u16::MAX), vec![0; 65_535]].concat()),
        ("another protocol", b"GET / HTTP/1.1\r\n\r\n".to_vec()),
        ("a hello of zeros", [length(32), vec![0; 32]].concat()),
    ];
    for (what, bytes) in untrusted {
        let mut server = Peer::start(&program, &["serve"], LIMIT).expect("a server starts");
        let port = server.hear("port").expect("a server says its port").parse().expect("a port");
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).expect("the server listens");
        // It may hang up before it has all.
        let _ = stream.write_all(&bytes);
        drop(stream);
        let ended = server.end().expect("the server ends");
        assert_eq!(ended.status, Some(2), "{what}: neither a match nor a panic");
        assert!(hashes(&ended).is_empty(), "{what}");
    }
}
