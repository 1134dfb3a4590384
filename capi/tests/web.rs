//! The page in `examples/web`: the hashes it compares with, made by the library itself, and what a browser makes of it.
//!
//! `UMBRA_BLESS=1` writes the hashes. The browser wants the module that `examples/web/build.sh` makes, and Chromium: where
//! one is not there the test says that it is skipped, and with UMBRA_REQUIRE_WEB=1 it fails. Pictures are left beside the
//! build, in `tmp/web`.

#[path = "../../tests/browser/mod.rs"]
#[allow(dead_code, reason = "the tests of another page use the rest")]
mod browser;

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::thread;

use browser::Browser;
use serde_json::{Value, json};
use umbra_physics::{ApplyOptions, BodyId, Command, ForceOrImpulse, Fx, Input, Inputs, PHYSICS_VERSION, Vec2, World};
use umbra_scene::Scene;

const TICKS: usize = 1200;
const EVERY: usize = 30;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/web")
}

fn read(file: &str) -> String {
    fs::read_to_string(folder().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// A hash every so many ticks of the arena and its script, the first before any.
fn hashes() -> Vec<String> {
    let scene = Scene::parse(&read("arena.json")).expect("a scene");
    let run = scene.start::<Fx>().expect("it starts");
    let bodies: Vec<(String, BodyId)> =
        run.world().bodies().map(|body| (run.name(body.id()).to_owned(), body.id())).collect();
    let mut world: World = run.into_world();
    let script: Vec<Value> = serde_json::from_str(&read("script.json")).expect("a script");
    let number = |text: &Value| Fx::parse(text.as_str().expect("a text")).expect("a number");
    let command = |row: &Value| {
        let name = row["body"].as_str().expect("a name");
        let body = bodies.iter().find(|(known, _)| known == name).expect(name).1;
        let action = match (&row["impulse"], &row["angular_impulse"]) {
            (Value::Array(xy), Value::Null) => {
                ForceOrImpulse::Impulse { impulse: Vec2::new(number(&xy[0]), number(&xy[1])), point: None }
            }
            (Value::Null, Value::Array(components)) => ForceOrImpulse::AngularImpulse(number(&components[0])),
            pair => panic!("{pair:?}"),
        };
        Command::Apply { body, action, options: ApplyOptions::default() }
    };
    let mut hashes = vec![format!("{:016x}", world.state_hash())];
    for tick in 0..TICKS {
        let mut inputs = Inputs::new();
        let due = script.iter().filter(|row| row["tick"] == tick);
        for (sequence, row) in (0..).zip(due) {
            inputs.insert(Input { player: 0, sequence, command: command(row) }).expect("a place of its own");
        }
        assert!(world.carry_out(&inputs).iter().all(|outcome| outcome.result.is_ok()), "tick {tick}");
        assert!(world.step().faults.is_empty());
        if (tick + 1) % EVERY == 0 {
            hashes.push(format!("{:016x}", world.state_hash()));
        }
    }
    hashes
}

#[test]
fn the_hashes_are_those_of_the_library() {
    let rows: Vec<String> = hashes().iter().map(|hash| format!("    \"{hash}\"")).collect();
    let text = format!(
        "{{\n  \"physics_version\": {PHYSICS_VERSION},\n  \"every\": {EVERY},\n  \"hashes\": [\n{}\n  ]\n}}\n",
        rows.join(",\n")
    );
    if std::env::var("UMBRA_BLESS").is_ok_and(|value| value == "1") {
        fs::write(folder().join("golden.json"), &text).expect("it can be written");
    }
    assert_eq!(
        read("golden.json"),
        text,
        "UMBRA_BLESS=1 cargo test --test web, if the physics version or the arena changed"
    );
}

/// The module, where it was built.
fn module() -> Option<()> {
    if folder().join("umbra_physics.wasm").is_file() {
        return Some(());
    }
    let required = std::env::var("UMBRA_REQUIRE_WEB").is_ok_and(|value| value == "1");
    assert!(!required, "UMBRA_REQUIRE_WEB=1, and there is no examples/web/umbra_physics.wasm");
    // Past the harness, which shows what passed tests print to nobody.
    let _ = writeln!(std::io::stderr(), "the page in a browser: SKIPPED, examples/web/build.sh was not run");
    None
}

/// Serves the folder on this machine alone, until the process ends. What begins with `/wrong/` has another hash for tick 60,
/// what begins with `/empty/` has hashes of which nobody knows the ticks.
fn serve() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port();
    thread::spawn(move || listener.incoming().flatten().for_each(|stream| _ = answer(stream)));
    port
}

fn answer(mut stream: TcpStream) -> std::io::Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    while lines.next().transpose()?.is_some_and(|line| !line.is_empty()) {}
    let path = request.split(' ').nth(1).unwrap_or_default();
    let path = path.trim_start_matches('/');
    let folders = ["wrong/", "empty/"].into_iter();
    let (wrong, name) = folders.filter_map(|f| Some((f, path.strip_prefix(f)?))).next().unwrap_or(("", path));
    let name = if name.is_empty() { "index.html" } else { name };
    let kind = match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("css") => "text/css",
        Some("wasm") => "application/wasm",
        _ => "application/json",
    };
    let content = if name.contains("..") { None } else { fs::read(folder().join(name)).ok() };
    let (status, mut content) = content.map_or(("404 Not Found", Vec::new()), |content| ("200 OK", content));
    if name == "golden.json" {
        let golden = String::from_utf8_lossy(&content);
        content = match wrong {
            "wrong/" => golden.replace(&hashes()[60 / EVERY], "0123456789abcdef"),
            "empty/" => golden.replace("\"every\"", "\"each\""),
            _ => golden.into_owned(),
        }
        .into_bytes();
    }
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        content.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(&content)
}

fn go(browser: &mut Browser, port: u16, path: &str) {
    browser.call("Page.navigate", json!({"url": "about:blank"}));
    browser.wait_for("location.href === 'about:blank'");
    browser.requests.clear();
    browser.problems.clear();
    browser.call("Page.navigate", json!({"url": format!("http://127.0.0.1:{port}/{path}")}));
}

fn open(browser: &mut Browser, port: u16, path: &str) {
    go(browser, port, path);
    browser.wait_for("document.body?.classList.contains('ready') === true");
    // It plays by itself; the rest is tick by tick.
    browser.wait_for("demo.match.tick >= 3");
    browser.evaluate("demo.setPlaying(false)");
    browser.evaluate("demo.begin()");
}

fn keep_picture(browser: &mut Browser, name: &str) {
    browser.settle();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("web");
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join(name), browser.picture()).expect("it can be written");
}

#[test]
fn two_worlds_in_a_browser_are_those_of_the_machine() {
    let Some(()) = module() else { return };
    let Some(mut browser) = Browser::start() else { return };
    let port = serve();
    browser.look([1280, 800], "dark");
    open(&mut browser, port, "");

    // The whole script: the two alike at every tick, and both as here.
    browser.evaluate(&format!("demo.advance({})", TICKS / 2));
    keep_picture(&mut browser, "dark.png");
    browser.evaluate(&format!("demo.advance({})", TICKS - TICKS / 2));
    let native = browser.evaluate("({...demo.match.native, tick: demo.match.tick, alike: demo.match.alike})");
    let count = TICKS / EVERY + 1;
    let expected = json!({"compared": count, "equal": count, "parted": null, "tick": TICKS, "alike": TICKS});
    assert_eq!(native, expected);
    let last = hashes().pop().expect("one");
    assert_eq!((browser.text("#hash-a"), browser.text("#hash-b")), (last.clone(), last));
    assert_eq!(browser.text("#verdict"), "in agreement");

    // By hand: what is clicked and held goes to both.
    browser.look([1280, 800], "light");
    browser.evaluate("demo.begin(), demo.advance(200)");
    browser.click_at("#a", [0.3, 0.2]);
    let held = "dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowUp'}))";
    let scripted = browser.evaluate("demo.match.inputs");
    browser.evaluate(held);
    browser.evaluate("demo.advance(40)");
    let state = "[demo.match.inputs, demo.match.alike, demo.match.isScripted, demo.match.native.compared]";
    let now = browser.evaluate(state);
    assert!(
        now[0].as_u64() > scripted.as_u64().map(|inputs| inputs + 45),
        "a push of several, and 40 of the engine: {now}"
    );
    assert_eq!((&now[1], &now[2], &now[3]), (&json!(240), &json!(false), &json!(200 / EVERY + 1)));
    keep_picture(&mut browser, "light.png");

    // The stack stands until it is clicked: within 3 m of the click all is pushed, in both worlds alike.
    browser.evaluate(&held.replace("keydown", "keyup"));
    browser.evaluate("demo.begin()");
    let boxes =
        "demo.match.worlds[1].poses().filter(({ look }) => look === 7).map(({ drawX, drawY }) => [drawX, drawY])";
    browser.evaluate(&format!("globalThis.stack = {boxes}"));
    let moved = format!("{boxes}.map(([x, y], i) => Math.hypot(x - stack[i][0], y - stack[i][1]))");
    browser.evaluate("demo.advance(120)");
    assert_eq!(browser.evaluate(&format!("[stack.length, {moved}.every(way => way < 0.01)]")), json!([15, true]));
    let shares = browser.evaluate(
        "(() => { const { clientWidth: w, clientHeight: h } = document.querySelector('#a'), scale = Math.min(w / 25, h / 24.5);
            return [0.5 + 6.5 * scale / w, 0.5 + (2.25 + 7.5) * scale / h]; })()",
    );
    browser.click_at("#a", [0, 1].map(|i| shares[i].as_f64().expect("a number")));
    browser.evaluate("demo.advance(240)");
    let fell = browser.evaluate(&format!("{moved}.filter(way => way > 1).length"));
    assert!(fell.as_u64() >= Some(8), "{fell} of 15 boxes");
    assert_eq!(browser.evaluate("[demo.match.alike, demo.match.isScripted]"), json!([360, false]));
    keep_picture(&mut browser, "knocked-over.png");

    // An ulp: named at the first tick after it, with both values; A goes on as it was.
    open(&mut browser, port, "");
    browser.evaluate("demo.advance(100)");
    browser.evaluate("document.getElementById('ulp').click()");
    browser.evaluate("demo.advance(500)");
    assert_eq!(browser.text("#verdict"), "parted at tick 101");
    assert!(
        browser.text("#difference").starts_with("body 0, position.x is the first value"),
        "{}",
        browser.text("#difference")
    );
    assert_eq!(browser.evaluate("demo.match.native.equal"), json!(600 / EVERY + 1));
    assert_ne!(browser.text("#hash-a"), browser.text("#hash-b"));
    assert_eq!(browser.evaluate("demo.match.alike"), 100);
    keep_picture(&mut browser, "parted.png");
    browser.look([400, 860], "dark");
    keep_picture(&mut browser, "narrow.png");
    assert_eq!(browser.evaluate("document.documentElement.scrollWidth <= innerWidth"), true);
    assert_eq!(browser.problems, [""; 0]);
    let origin = format!("\"http://127.0.0.1:{port}/");
    assert!(
        browser.requests.iter().all(|url| url.starts_with(&origin) || url.starts_with("\"data:")),
        "{:?}",
        browser.requests
    );

    // Another hash than the native program's is no agreement.
    open(&mut browser, port, "wrong/");
    browser.evaluate("demo.advance(90)");
    assert_eq!(browser.text("#verdict"), "A is not as native at tick 60");

    // Nor is nothing to compare with.
    let state = "document.getElementById('verdict')?.dataset.state";
    go(&mut browser, port, "empty/");
    browser.wait_for(&format!("['wrong', 'agree'].includes({state})"));
    assert_eq!(browser.text("#verdict"), "golden.json has no hashes to compare with");

    // Nor a match that broke off: what a call throws amid a frame stays in the verdict.
    open(&mut browser, port, "");
    assert_eq!(browser.evaluate(state), "agree");
    browser.evaluate("demo.match.worlds[1].step = () => { throw new Error('unreachable executed') }");
    browser.evaluate("demo.setPlaying(true)");
    browser.wait_for(&format!("{state} === 'wrong'"));
    browser.evaluate("demo.begin()");
    assert_eq!((browser.evaluate(state), &*browser.text("#verdict")), (json!("wrong"), "unreachable executed"));
    assert!(browser.problems.iter().any(|problem| problem.contains("unreachable executed")), "{:?}", browser.problems);
}
