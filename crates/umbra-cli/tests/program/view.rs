//! The page of `umbra view`: what is in it, and what a browser makes of it.
//!
//! Where there is no Chromium the tests that need one say that they are skipped, and with UMBRA_REQUIRE_BROWSER=1 they
//! fail. Pictures of the page are left beside the build, in `tmp/view`.

#[path = "../../../../tests/browser/mod.rs"]
mod browser;

use std::fs;
use std::path::{Path, PathBuf};

use browser::Browser;
use serde_json::Value;
use umbra_physics::{
    BodyDef, Command as Order, Fx, Input, Inputs, RecordOptions, Recorder, Shape, World, WorldDef, fx, vec2,
};
use umbra_scene::Scene;

use crate::{root, umbra};

/// A page, or another file, of a test's own; it goes when the test is over.
struct Page(PathBuf);

impl Page {
    /// The page of a scene, with what was printed.
    fn of(scene: &str, ticks: Option<u64>) -> (Self, String) {
        Self::with(scene, ticks, &[])
    }

    fn with(scene: &str, ticks: Option<u64>, options: &[&str]) -> (Self, String) {
        let name = Path::new(scene).file_stem().expect("a name").to_string_lossy().into_owned();
        let test = std::thread::current().name().unwrap_or("test").to_owned();
        let page =
            Self(Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{test}-{name}.html", std::process::id())));
        let ticks = ticks.map(|ticks| ticks.to_string());
        let mut arguments = [&["view", scene, "--out", page.path()], options].concat();
        if let Some(ticks) = &ticks {
            arguments.extend(["--ticks", ticks]);
        }
        let output = umbra(&arguments);
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(0), "{said}");
        assert!(output.stdout.is_empty());
        (page, said)
    }

    /// A scene or a replay, which goes as well.
    fn scene(name: &str, content: impl AsRef<[u8]>) -> Self {
        let file = Self(Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{name}.json", std::process::id())));
        fs::write(&file.0, content).expect("the scene can be written");
        file
    }

    fn path(&self) -> &str {
        self.0.to_str().expect("UTF-8")
    }

    fn text(&self) -> String {
        fs::read_to_string(&self.0).expect("the page is there")
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// The output of `umbra run --json` for a scene.
fn ran(scene: &str, ticks: u64) -> Value {
    let output = umbra(&["run", scene, "--json", "--ticks", &ticks.to_string()]);
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// The state hash at each tick, as the page writes them.
fn hashes(scene: &str, ticks: u64) -> Vec<String> {
    let text = fs::read_to_string(root().join(scene)).expect("the scene is there");
    hashes_of(&text, ticks)
}

fn hashes_of(text: &str, ticks: u64) -> Vec<String> {
    let scene = Scene::parse(text).expect("a scene");
    let mut run = scene.start::<Fx>().expect("it starts");
    let mut hashes = vec![format!("{:016x}", run.world().state_hash())];
    for _ in 0..ticks {
        run.advance().expect("it goes on");
        hashes.push(format!("{:016x}", run.world().state_hash()));
    }
    hashes
}

/// The position of a body after some steps, m.
fn position_of(body: &str, text: &str, ticks: u64) -> [f64; 2] {
    let scene = Scene::parse(text).expect("a scene");
    let mut run = scene.start::<Fx>().expect("it starts");
    (0..ticks).for_each(|_| _ = run.advance().expect("it goes on"));
    let world = run.world();
    let body = world.bodies().find(|other| run.name(other.id()) == body).expect("it is there");
    body.position().to_f64()
}

/// The tick that the page shows.
fn tick(browser: &mut Browser) -> usize {
    let text = browser.text("#tick");
    text.split(' ').next().and_then(|tick| tick.parse().ok()).unwrap_or_else(|| panic!("no tick in {text}"))
}

/// The tick that the page shows, which has to have its hash.
fn checked_tick(browser: &mut Browser, hashes: &[String]) -> usize {
    let tick = tick(browser);
    assert_eq!(browser.text("#hash"), hashes[tick], "tick {tick}");
    tick
}

const HOME: (&str, u32) = ("Home", 36);
const END: (&str, u32) = ("End", 35);
const LEFT: (&str, u32) = ("ArrowLeft", 37);
const RIGHT: (&str, u32) = ("ArrowRight", 39);
const SPACE: (&str, u32) = (" ", 32);

#[test]
fn a_page_needs_nothing_else_and_is_the_same_each_time() {
    let (page, said) = Page::of("scenes/sleepers.json", Some(120));
    assert_eq!(said, "", "nothing to say of a page with everything in it");
    let text = page.text();
    assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>\n"));
    assert!(text.contains("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "));
    for outside in ["http://", "https://", " src=", "url(", "@import", "import(", "fetch(", &root().to_string_lossy()] {
        assert!(!text.contains(outside), "{outside}");
    }
    assert_eq!(text, Page::of("scenes/sleepers.json", Some(120)).0.text());
}

#[test]
fn unreadable_and_unwritable_files_are_named() {
    let output = umbra(&["view", "scenes/no-such-scene.json", "--out", "x.html"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("scenes/no-such-scene.json: cannot read: "));
    let output = umbra(&["view", "scenes/kepler.json", "--ticks", "1", "--out", "no/such/folder/x.html"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("no/such/folder/x.html: cannot write: "));
    assert_eq!(umbra(&["view", "scenes/kepler.json"]).status.code(), Some(2), "it has to go somewhere");
}

#[test]
fn the_page_plays_pauses_steps_and_scrubs() {
    let Some(mut browser) = Browser::start() else { return };
    let (page, _) = Page::of("scenes/kepler.json", Some(600));
    let (hashes, end) = (hashes("scenes/kepler.json", 600), ran("scenes/kepler.json", 600));
    browser.open(&page.0, "");
    assert_eq!(checked_tick(&mut browser, &hashes), 0);
    browser.click("#play");
    browser.wait_for("parseInt(document.querySelector('#tick').textContent) > 5");
    browser.click("#play");
    let paused = checked_tick(&mut browser, &hashes);
    std::thread::sleep(std::time::Duration::from_millis(200));
    assert_eq!(tick(&mut browser), paused);
    browser.click("#forth");
    assert_eq!(checked_tick(&mut browser, &hashes), paused + 1);
    browser.click("#back");
    browser.click("#back");
    assert_eq!(checked_tick(&mut browser, &hashes), paused - 1);
    // From the thumb to the end of the bar.
    browser.drag("#scrub", [0.5, 0.5], [1.0, 0.5]);
    assert_eq!(checked_tick(&mut browser, &hashes), 600);
    assert_eq!(browser.text("#hash"), end["state_hash"]);
    assert_eq!(browser.text("#time"), format!("{} s", end["time"].as_str().expect("a ratio")));
    browser.click_at("#scrub", [0.5, 0.5]);
    let middle = checked_tick(&mut browser, &hashes);
    assert!((295..=305).contains(&middle), "{middle}");
    browser.click("#home");
    assert_eq!(checked_tick(&mut browser, &hashes), 0);
    browser.click("#end");
    assert_eq!(checked_tick(&mut browser, &hashes), 600);
    browser.assert_clean();
}

#[test]
fn the_page_listens_to_the_keyboard() {
    let Some(mut browser) = Browser::start() else { return };
    let (page, _) = Page::of("scenes/kepler.json", Some(300));
    let hashes = hashes("scenes/kepler.json", 300);
    browser.open(&page.0, "tick=17");
    assert_eq!(checked_tick(&mut browser, &hashes), 17, "from the address");
    let expected = [(END, false, 300), (LEFT, false, 299), (LEFT, true, 289), (HOME, false, 0), (RIGHT, true, 10)];
    for ((key, number), shift, tick) in expected {
        browser.press(key, number, shift);
        assert_eq!(checked_tick(&mut browser, &hashes), tick, "{key}");
    }
    browser.press(SPACE.0, SPACE.1, false);
    browser.wait_for("parseInt(document.querySelector('#tick').textContent) > 15");
    assert_eq!(browser.evaluate("document.querySelector('#play').getAttribute('aria-label')"), "Pause");
    browser.press(SPACE.0, SPACE.1, false);
    assert_eq!(browser.evaluate("document.querySelector('#play').getAttribute('aria-label')"), "Play");
    checked_tick(&mut browser, &hashes);
    // A run that is over stays at its end, and plays from the start again.
    browser.press(END.0, END.1, false);
    browser.press(LEFT.0, LEFT.1, true);
    browser.evaluate("document.querySelector('#speed').value = '8'");
    browser.press(SPACE.0, SPACE.1, false);
    browser.wait_for("document.querySelector('#play').getAttribute('aria-label') === 'Play'");
    assert_eq!(tick(&mut browser), 300);
    browser.press(SPACE.0, SPACE.1, false);
    browser.wait_for("parseInt(document.querySelector('#tick').textContent) < 250");
    browser.assert_clean();
}

#[test]
fn every_value_is_exact() {
    let Some(mut browser) = Browser::start() else { return };
    let table = Page(Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-exact.csv", std::process::id())));
    // Thrown from one end of the world to the other each tick: what is stored wraps around.
    let jumps = (0..24).map(|tick| {
        let far = "1073741823.9999999997671694";
        let sign = |bit: u32| if tick >> bit & 1 == 1 { "-" } else { "" };
        let place = format!("[{}{far}, {}{far}]", sign(0), sign(1));
        let velocity = format!("[{}1048575.3, {}1048575.7]", sign(2), sign(0));
        format!("{{\"at\": {tick}, \"body\": \"a\", \"set\": {{\"position\": {place}, \"velocity\": {velocity}}}}}")
    });
    let jumps = jumps.collect::<Vec<_>>().join(", ");
    let text = format!("{{\"time_step\": \"1/10000\", \"bodies\": [{{\"name\": \"a\"}}], \"inputs\": [{jumps}]}}");
    let jumping = Page::scene("jumping", &text);
    let scenes =
        [("scenes/tumbling.json", "299", "13"), ("scenes/too-stiff.json", "40", "2"), (jumping.path(), "30", "1")];
    for (scene, ticks, every) in scenes {
        let (page, _) = Page::of(scene, ticks.parse().ok());
        assert!(umbra(&["run", scene, "--ticks", ticks, "--csv", table.path(), "--every", every]).status.success());
        let rows = table.text();
        let rows: Vec<Vec<&str>> = rows.lines().skip(1).map(|line| line.split(',').collect()).collect();
        browser.open(&page.0, "");
        for row in rows {
            let script = format!(
                "(async () => {{
                    const who = document.querySelector('#who');
                    who.value = [...who.options].find(option => option.text === {:?}).value;
                    who.dispatchEvent(new Event('change'));
                    const scrub = document.querySelector('#scrub');
                    scrub.value = {};
                    scrub.dispatchEvent(new Event('input'));
                    await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));
                    return [...document.querySelectorAll('#body dd')].map(dd => `${{dd.dataset.name}}: ${{dd.textContent}}`);
                }})()",
                row[1], row[0]
            );
            let shown = browser.evaluate(&script);
            let shown: Vec<&str> = shown.as_array().expect("a list").iter().filter_map(Value::as_str).collect();
            let [_, name, x, y, angle, vx, vy, spin] = row[..] else { panic!("{row:?}") };
            let expected = [
                format!("name: {name}"),
                format!("x: {x} m"),
                format!("y: {y} m"),
                format!("angle: {angle} rad"),
                format!("velocity x: {vx} m/s"),
                format!("velocity y: {vy} m/s"),
                format!("spin: {spin} rad/s"),
            ];
            for value in &expected {
                assert!(shown.contains(&value.as_str()), "tick {}: {value} in {shown:#?}", row[0]);
            }
        }
        browser.assert_clean();
    }
}

#[test]
fn time_is_exact_when_the_step_changes() {
    let Some(mut browser) = Browser::start() else { return };
    let inputs = r#"{"at": 9, "set": {"time_step": "1001/60000"}}, {"at": 10, "set": {"time_step": "1/7"}}"#;
    let scene = Page::scene("steps", format!("{{\"ticks\": 20, \"inputs\": [{inputs}]}}"));
    let (page, _) = Page::of(scene.path(), None);
    browser.open(&page.0, "");
    for tick in [1, 8, 9, 10, 11, 20] {
        browser.press(HOME.0, HOME.1, false);
        (0..tick).for_each(|_| browser.press(RIGHT.0, RIGHT.1, false));
        let (shown, exact) = (browser.text("#time"), ran(scene.path(), tick)["time"].clone());
        let exact = exact.as_str().expect("a ratio");
        let (num, den) = exact.split_once('/').expect("no whole number");
        let value = num.parse::<f64>().expect("a number") / den.parse::<f64>().expect("a number");
        let decimal = format!("{value} s");
        assert!(shown == decimal || shown == format!("{exact} s ≈ {value:.3} s"), "{shown} for {exact}");
    }
    browser.assert_clean();
}

#[test]
fn events_are_listed_and_marked() {
    let Some(mut browser) = Browser::start() else { return };
    let (page, _) = Page::of("scenes/sleepers.json", None);
    browser.open(&page.0, "");
    assert_eq!(browser.text("#counts"), "100 dynamic, 3 kinematic, 22 static");
    assert_eq!(
        browser.text("#list li").trim(),
        "30fell asleep box-0-0, box-1-0, box-2-0, box-3-0, box-4-0, box-5-0, 94 more"
    );
    browser.click("#list li:first-child button");
    assert_eq!(tick(&mut browser), 30);
    assert_eq!(browser.text("#counts"), "3 kinematic, 22 static, 100 asleep");
    assert_eq!(browser.text("#body dd[data-name=name]"), "box-0-0");
    // The first mark: tick 30 of 780, between the middles of the thumb at both ends.
    let share = browser.evaluate("(7 + (document.querySelector('#marks').clientWidth - 14) * 30 / 780) / document.querySelector('#marks').clientWidth");
    browser.hover("#marks", [share.as_f64().expect("a number"), 0.5]);
    assert!(browser.text("#tip").starts_with("tick 30: fell asleep\nbox-0-0, "));
    assert_eq!(browser.evaluate("document.querySelector('#tip').hidden"), false);
    // Inputs alone: a hundred, ten a row.
    browser.evaluate("(() => { const kinds = document.querySelector('#kinds'); kinds.value = 'input'; kinds.dispatchEvent(new Event('change')); })()");
    assert_eq!(browser.evaluate("document.querySelectorAll('#list li').length"), 100);
    assert_eq!(browser.text("#list li").trim(), "60input impulse (4, 0) N·s at (0, 0.05) m on box-0-0");
    browser.assert_clean();

    let (page, _) = Page::of("scenes/too-stiff.json", None);
    browser.open(&page.0, "");
    assert_eq!(browser.text("#list"), "16quarantined ω·dt = 2.1: velocity beyond 2^20 m/s");
    browser.click("#list button");
    assert_eq!(browser.text("#counts"), "2 dynamic, 1 quarantined");
    browser.click("#back");
    assert_eq!(browser.text("#counts"), "3 dynamic");
    let (page, _) = Page::of("scenes/lander.json", None);
    browser.open(&page.0, "");
    let held = "document.querySelectorAll('#list li')[2].textContent";
    assert_eq!(browser.evaluate(held), "200input force (0, 2376) N on lander, in its frame (to tick 499)");
    browser.assert_clean();
}

#[test]
fn the_picture_pans_zooms_and_follows() {
    let Some(mut browser) = Browser::start() else { return };
    let (page, _) = Page::of("scenes/kepler.json", Some(600));
    let picture = |browser: &mut Browser| browser.evaluate("document.querySelector('#canvas').toDataURL()");
    let middle = [0.5, 0.5];
    browser.open(&page.0, "tick=300");
    // Away from the canvas, or what lies under the mouse has a ring around it.
    browser.hover("h1", middle);
    let whole = picture(&mut browser);
    browser.drag("#canvas", middle, [0.6, 0.7]);
    let panned = picture(&mut browser);
    browser.wheel("#canvas", middle, -300.0);
    let zoomed = picture(&mut browser);
    assert!(whole != panned && panned != zoomed);
    browser.click("#fit");
    browser.hover("h1", middle);
    assert!(picture(&mut browser) == whole, "it fits again");
    // A body that is followed is in the middle of the canvas, where the mouse finds it.
    browser.evaluate("(() => { const who = document.querySelector('#who'); who.selectedIndex = 1; who.dispatchEvent(new Event('change')); })()");
    browser.click("#follow");
    let followed = picture(&mut browser);
    assert!(followed != whole);
    browser.press("Escape", 27, false);
    assert_eq!(browser.evaluate("document.querySelectorAll('#body dd').length"), 0);
    browser.hover("#canvas", middle);
    let name = browser.text("#body dd[data-name=name]");
    browser.hover("h1", middle);
    assert_eq!(browser.evaluate("document.querySelectorAll('#body dd').length"), 0, "none is under the mouse");
    browser.click_at("#canvas", middle);
    browser.hover("h1", middle);
    assert_eq!(browser.text("#body dd[data-name=name]"), name, "it was clicked");
    browser.press(END.0, END.1, false);
    browser.hover("#canvas", middle);
    assert_eq!(browser.evaluate("document.querySelector('#canvas').classList.contains('over')"), true, "still there");
    for toggle in ["#arrows", "#trails"] {
        let before = picture(&mut browser);
        browser.click(toggle);
        browser.hover("#canvas", middle);
        assert!(picture(&mut browser) != before, "{toggle}");
    }
    browser.assert_clean();
}

/// Script: a copy of the canvas of the page whose pixels can be read.
const CANVAS: &str = "const canvas = document.querySelector('#canvas'), ratio = canvas.width / canvas.clientWidth;
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const pen = copy.getContext('2d', { willReadFrequently: true });
    pen.drawImage(canvas, 0, 0);";

/// A crate of 1 m on a floor, seen at ten times its size.
const CRATE: &str = r#"{"ticks": 90, "gravity": [0, -10], "sleep_after": null, "bodies": [
    {"name": "floor", "kind": "static", "colliders": [{"shape": {"rectangle": {"width": 8, "height": 1}}}]},
    {"name": "crate", "position": [0, 1], "colliders": [{"shape": {"rectangle": {"width": 1, "height": 1}}}]}],
    "plot": {"view": [[-5, -2], [5, 4]], "trails": "none"}}"#;

#[test]
fn colliders_are_drawn_and_found_by_the_mouse() {
    let scene = Page::scene("colliders", CRATE);
    let (page, _) = Page::of(scene.path(), None);
    let text = page.text();
    assert!(
        text.contains(r#""shapes":[[["p",[[-4.0,-0.5],[4.0,-0.5],[4.0,0.5],[-4.0,0.5]]]],[["p",[[-0.5,-0.5],"#),
        "{text}"
    );
    let Some(mut browser) = Browser::start() else { return };
    browser.open(&page.0, "tick=60");
    assert_eq!(browser.evaluate("document.querySelectorAll('#tools label').length"), 3, "no contacts were recorded");
    // The middle of the picture is at (0, 1): in the crate, and 0.9 m lower in the floor.
    browser.hover("#canvas", [0.5, 0.5]);
    assert_eq!(browser.text("#body dd[data-name=name]"), "crate");
    let share = browser.evaluate(
        "(() => { const { clientWidth: w, clientHeight: h } = document.querySelector('#canvas');
            return 0.5 + 0.9 * Math.min((w - 48) / 10, (h - 112) / 6) / h; })()",
    );
    browser.hover("#canvas", [0.5, share.as_f64().expect("a number")]);
    assert_eq!(browser.text("#body dd[data-name=name]"), "floor");
    browser.assert_clean();
}

/// A body that a call puts 8 m away, and one that flies there.
const TRAILS: &str = r#"{"ticks": 60, "sleep_after": null, "bodies": [
    {"name": "put", "position": [-4, -0.65], "colliders": [{"shape": {"circle": {"radius": 0.25}}}]},
    {"name": "flies", "position": [-4, 2.35], "velocity": [8, 0], "colliders": [{"shape": {"circle": {"radius": 0.25}}}]}],
    "inputs": [{"at": 30, "body": "put", "set": {"position": [4, -0.65]}}],
    "plot": {"view": [[-5, -2], [5, 4]]}}"#;

#[test]
fn a_trail_has_a_gap_where_a_call_put_the_body_elsewhere() {
    let scene = Page::scene("trails", TRAILS);
    let (page, _) = Page::of(scene.path(), None);
    let Some(mut browser) = Browser::start() else { return };
    browser.look([1280, 800], "light");
    browser.open(&page.0, "tick=60");
    browser.hover("h1", [0.5, 0.5]);
    // How blue the bluest point is on a short upright line in the middle of each way: between the lines of the grid.
    let blue = |browser: &mut Browser, y: f64| {
        let script = format!(
            "(() => {{
                {CANVAS}
                const scale = Math.min((canvas.clientWidth - 48) / 10, (canvas.clientHeight - 112) / 6);
                const px = (canvas.clientWidth / 2 + 0.35 * scale) * ratio, py = (canvas.clientHeight / 2 - ({y} - 1) * scale) * ratio;
                const {{ data }} = pen.getImageData(Math.round(px), Math.round(py) - 5, 1, 11);
                let bluest = 0;
                for (let i = 0; i < data.length; i += 4) bluest = Math.max(bluest, data[i + 2] - data[i]);
                return bluest;
            }})()"
        );
        browser.evaluate(&script).as_f64().expect("a number")
    };
    let [put, flies] = [-0.65, 2.35].map(|y| blue(&mut browser, y));
    assert!(put < 10.0 && flies > 30.0, "{put} {flies}");
    browser.assert_clean();
}

#[test]
fn contacts_are_recorded_and_shown_on_request() {
    let scene = Page::scene("contacts", CRATE);
    let (page, _) = Page::with(scene.path(), None, &["--contacts"]);
    let Some(mut browser) = Browser::start() else { return };
    browser.look([1280, 800], "light");
    browser.open(&page.0, "tick=60");
    browser.hover("h1", [0.5, 0.5]);
    // The box around all that has the colour of contacts, in m.
    let red = "(() => {
        CANVAS
        const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
        const scale = Math.min((canvas.clientWidth - 48) / 10, (canvas.clientHeight - 112) / 6);
        let [left, bottom, right, top] = [Infinity, Infinity, -Infinity, -Infinity];
        for (let i = 0; i < data.length; i += 4) {
            if (data[i] < data[i + 1] + 30 || data[i] < data[i + 2] + 30) continue;
            const x = (i / 4 % canvas.width / ratio - canvas.clientWidth / 2) / scale;
            const y = 1 - (Math.floor(i / 4 / canvas.width) / ratio - canvas.clientHeight / 2) / scale;
            [left, bottom, right, top] = [Math.min(left, x), Math.min(bottom, y), Math.max(right, x), Math.max(top, y)];
        }
        return [left, bottom, right, top].map(value => Number.isFinite(value) ? Math.round(value * 100) / 100 : null);
    })()"
        .replace("CANVAS", CANVAS);
    let box_ = |browser: &mut Browser| -> [Option<f64>; 4] {
        let value = browser.evaluate(&red);
        std::array::from_fn(|i| value[i].as_f64())
    };
    // Points alone at first: at both lower corners of the crate.
    let [Some(left), Some(bottom), Some(right), Some(top)] = box_(&mut browser) else { panic!("no points") };
    assert!((left + 0.5).abs() < 0.1 && (right - 0.5).abs() < 0.1, "{left} {right}");
    assert!((bottom - 0.5).abs() < 0.1 && (top - 0.5).abs() < 0.1, "{bottom} {top}");
    browser.click("#points");
    assert_eq!(box_(&mut browser), [None; 4]);
    assert_eq!(browser.evaluate("document.querySelector('#trails').checked"), false, "as the scene says");
    // The key does the same as the box. Arrows go up from the corners.
    browser.press("i", 73, false);
    let [_, Some(bottom), _, Some(top)] = box_(&mut browser) else { panic!("no impulses") };
    assert!((bottom - 0.5).abs() < 0.2 && top > 0.9, "{bottom} {top}");
    let picture = |browser: &mut Browser| browser.evaluate("document.querySelector('#canvas').toDataURL()");
    let before = picture(&mut browser);
    browser.press("n", 78, false);
    assert!(picture(&mut browser) != before, "normals");
    browser.press("i", 73, false);
    browser.press("k", 75, false);
    browser.click("#home");
    assert_eq!(box_(&mut browser), [None; 4], "nothing has touched before the first step");
    browser.assert_clean();
}

#[test]
fn joints_are_drawn_until_they_break() {
    let scene = r#"{"ticks": 60, "gravity": [0, -10], "bodies": [{"name": "lamp", "position": [0, -1], "velocity": [2, 0]},
        {"name": "cabin", "position": [3, 0]}],
      "joints": [{"bodies": [null, "lamp"], "points": [[0, 1], [0, -1]], "distance": {}, "break_force": 100},
        {"bodies": [null, "cabin"], "point": [3, 0], "axis": [0, 1], "prismatic": {"limits": [-1, 3]}}],
      "inputs": [{"at": 20, "body": "lamp", "impulse": [0, -5]}],
      "plot": {"view": [[-5, -2], [5, 4]], "trails": "none"}}"#;
    let scene = Page::scene("joints", scene);
    let (page, _) = Page::of(scene.path(), None);
    let text = page.text();
    // A rod that ends on the lamp, the first body, until it breaks; a lift with its axis between its limits.
    let rod = r#"[0,20,[["s",[[0.0,1.0]],[[0.0,0.0],0]],["m",[[0.0,1.0]]],["m",[[0.0,0.0],0]]]]"#;
    assert!(text.contains(&format!("\"joints\":[{rod},[0,60,[[\"s\",[[3.0,0.0]],[[0.0,0.0],1]],[\"s\",[[")), "{text}");
    let Some(mut browser) = Browser::start() else { return };
    browser.look([1280, 800], "light");
    // True where the picture is darker than its grid within 3 px of a point, m.
    let is_dark = |browser: &mut Browser, [x, y]: [f64; 2]| {
        let script = format!(
            "(() => {{
                {CANVAS}
                const scale = Math.min((canvas.clientWidth - 48) / 10, (canvas.clientHeight - 112) / 6);
                const [left, top] = [{x} * scale + canvas.clientWidth / 2, (1 - {y}) * scale + canvas.clientHeight / 2];
                const {{ data }} = pen.getImageData((left - 3) * ratio, (top - 3) * ratio, 7 * ratio, 7 * ratio);
                return data.some((value, i) => i % 4 === 0 && value < 180 && data[i + 1] < 180 && data[i + 2] < 180);
            }})()"
        );
        browser.evaluate(&script) == true
    };
    browser.open(&page.0, "");
    browser.hover("h1", [0.5, 0.5]);
    // The middle of the rod and the axis above and below the cabin, and places beside them.
    for (at, expected) in
        [([0.0, 0.2], true), ([3.0, 2.6], true), ([3.0, -0.8], true), ([0.4, 0.2], false), ([3.4, 2.6], false)]
    {
        assert_eq!(is_dark(&mut browser, at), expected, "{at:?}");
    }
    for _ in 0..20 {
        browser.press(RIGHT.0, RIGHT.1, false);
    }
    let [x, y] = position_of("lamp", &scene.text(), 20);
    let upper = [0.4 * x, 1.0 + 0.4 * (y - 1.0)];
    assert!(x > 0.5 && is_dark(&mut browser, upper), "the rod swings with the lamp at {x}, {y}");
    browser.press(RIGHT.0, RIGHT.1, false);
    assert!(!is_dark(&mut browser, upper), "it broke");
    assert!(is_dark(&mut browser, [3.0, 2.6]), "the lift did not");
    browser.assert_clean();
}

#[test]
fn nothing_at_all_is_a_page_too() {
    let Some(mut browser) = Browser::start() else { return };
    let scene = Page::scene("nothing", "{}");
    for ticks in [0, 3] {
        let (page, _) = Page::of(scene.path(), Some(ticks));
        browser.open(&page.0, "");
        assert_eq!(browser.text("#counts"), "none");
        assert_eq!(browser.text("#hash"), hashes_of("{}", 0)[0]);
        browser.press(END.0, END.1, false);
        assert_eq!(tick(&mut browser) as u64, ticks);
        browser.press(SPACE.0, SPACE.1, false);
        browser.wait_for("document.querySelector('#play').getAttribute('aria-label') === 'Play'");
        assert_eq!(tick(&mut browser) as u64, ticks);
        browser.assert_clean();
    }
}

#[test]
fn a_replay_is_played_and_one_cut_off_as_far_as_it_goes() {
    let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    let disc = Shape::circle(fx!(0.5)).expect("a circle");
    let ball = world.add_body(BodyDef::dynamic().with_collider(disc)).expect("there is room");
    (0..7).for_each(|_| _ = world.step());
    let mut recorder = Recorder::new(&world, RecordOptions { hash_every: 3, ..RecordOptions::default() });
    let mut hashes = vec![format!("{:016x}", world.state_hash())];
    for tick in 7..200 {
        let mut inputs = Inputs::new();
        if tick % 50 == 0 {
            let command = Order::SetVelocity { body: ball, velocity: vec2(1, 5) };
            inputs.insert(Input { player: 0, sequence: 0, command }).expect("one of its kind");
        }
        recorder.step(&mut world, &inputs);
        hashes.push(format!("{:016x}", world.state_hash()));
    }
    let bytes = recorder.finish(&world);
    let (whole, cut) = (Page::scene("whole", &bytes), Page::scene("cut", &bytes[..bytes.len() * 3 / 5]));
    let (page, said) = Page::of(whole.path(), None);
    assert_eq!(said, "");
    let (cut_page, said) = Page::of(cut.path(), None);
    assert!(said.contains("cut off: whole up to tick "), "{said}");
    let foreign = Page::scene("foreign", &bytes[..40]);
    let output = umbra(&["view", foreign.path(), "--out", page.path()]);
    assert_eq!(output.status.code(), Some(2), "no world to begin with");
    let Some(mut browser) = Browser::start() else { return };
    // The page begins with tick 7.
    let from_zero: Vec<String> = vec![String::new(); 7].into_iter().chain(hashes).collect();
    browser.open(&page.0, "");
    for (key, tick_there) in [(HOME, 7), (RIGHT, 8), (END, 200), (LEFT, 199)] {
        browser.press(key.0, key.1, false);
        assert_eq!(checked_tick(&mut browser, &from_zero), tick_there);
    }
    assert_eq!(browser.text("#list li"), "50input velocity of body 0: (1, 5) m/s");
    assert_eq!(browser.evaluate("document.querySelectorAll('#list li').length"), 3, "one each 50 ticks, no divergence");
    browser.open(&cut_page.0, "");
    browser.press(END.0, END.1, false);
    let end = checked_tick(&mut browser, &from_zero);
    assert!((8..200).contains(&end), "{end}");
    browser.assert_clean();
}

#[test]
fn texts_of_a_scene_stay_texts() {
    let hostile =
        "</script></title><script>document.title = 'theirs'</script><img src=x onerror='alert(1)'>&lt;<!--{{about}}";
    let scene = serde_json::json!({
        "title": hostile,
        "about": hostile,
        "ticks": 3,
        "bodies": [{"name": hostile, "colliders": [{"shape": {"circle": {"radius": 1}}}]}],
        "inputs": [{"at": 1, "body": hostile, "force": [1, 0]}, {"at": 2, "body": hostile, "do": "remove"}],
    });
    let file = Page::scene("hostile", scene.to_string());
    let (page, _) = Page::of(file.path(), None);
    assert!(!page.text().contains("<img"), "no tag of theirs");
    let Some(mut browser) = Browser::start() else { return };
    browser.open(&page.0, "");
    assert_eq!(browser.evaluate("document.title"), hostile);
    assert_eq!(browser.text("h1"), hostile);
    assert_eq!(browser.text("details p"), hostile);
    assert_eq!(browser.evaluate("document.querySelector('#who').options[1].text"), hostile);
    browser.click("#list button");
    assert!(browser.text("#list").contains(hostile));
    browser.click("#end");
    assert_eq!(browser.text("#counts"), "none");
    assert_eq!(browser.evaluate("document.querySelectorAll('img').length"), 0);
    browser.assert_clean();
}

#[test]
#[cfg_attr(debug_assertions, ignore = "steps a net of 1,000 nodes twice: in release builds")]
fn a_large_run_is_thinned_and_the_page_says_so() {
    let Some(mut browser) = Browser::start() else { return };
    let (page, said) = Page::of("scenes/spring-net.json", None);
    let thinned = "every 4th of 2000 ticks is in the page: all would make it too large";
    assert_eq!(said, format!("{}: {thinned}\n", page.path()));
    assert!(fs::metadata(&page.0).expect("it is there").len() <= 20_000_000);
    let hashes = hashes("scenes/spring-net.json", 2000);
    browser.open(&page.0, "");
    assert_eq!(browser.text("#thinned"), thinned);
    for (key, tick) in [(RIGHT, 4), (RIGHT, 8), (END, 2000), (LEFT, 1996)] {
        browser.press(key.0, key.1, false);
        assert_eq!(checked_tick(&mut browser, &hashes), tick);
    }
    browser.assert_clean();
}

/// The luminance of a colour such as `rgb(13, 17, 23)`, 0 to 1.
fn luminance(colour: &str) -> f64 {
    let numbers = colour.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse::<f64>().ok());
    let linear = numbers.map(|value| {
        let value = value / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    });
    linear.zip([0.2126, 0.7152, 0.0722]).map(|(value, weight)| value * weight).sum()
}

#[test]
fn the_page_is_legible_wide_narrow_and_dark() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("view");
    fs::create_dir_all(&folder).expect("a folder for pictures");
    let (page, _) = Page::of("scenes/sleepers.json", None);
    browser.open(&page.0, "tick=400");
    for (name, size, scheme) in [
        ("wide-light", [1280, 800], "light"),
        ("wide-dark", [1280, 800], "dark"),
        ("narrow-light", [390, 800], "light"),
        ("narrow-dark", [390, 800], "dark"),
    ] {
        browser.look(size, scheme);
        fs::write(folder.join(format!("{name}.png")), browser.picture()).expect("the picture can be written");
        assert_eq!(browser.evaluate("document.documentElement.scrollWidth"), size[0], "{name}: nothing sticks out");
        let colours = browser.evaluate(
            "(() => { const { color, backgroundColor } = getComputedStyle(document.body); return [color, backgroundColor]; })()",
        );
        let [ink, paper] = [0, 1].map(|i| luminance(colours[i].as_str().expect("a colour")));
        assert_eq!(paper < 0.1, scheme == "dark", "{name}");
        assert!((ink.max(paper) + 0.05) / (ink.min(paper) + 0.05) > 7.0, "{name}: {colours}");
        // All controls are where a hand can reach them.
        let covered = browser.evaluate(
            "[...document.querySelectorAll('#tools *, #transport button, #transport select, #transport input')].filter(e => {
                const b = e.getBoundingClientRect();
                const top = document.elementFromPoint(b.x + b.width / 2, b.y + b.height / 2);
                return !(top && (e.contains(top) || top.contains(e)));
            }).map(e => e.id)",
        );
        assert_eq!(covered, serde_json::json!([]), "{name}");
    }
    browser.assert_clean();
}

/// The texts of the events that the page lists.
fn listed(browser: &mut Browser) -> Vec<String> {
    let list = browser.evaluate("[...document.querySelectorAll('#list li')].map(li => li.textContent)");
    list.as_array().expect("a list").iter().filter_map(Value::as_str).map(str::to_owned).collect()
}

#[test]
fn contacts_hits_sensors_and_joints_are_listed_and_inputs_are_folded() {
    let inputs: Vec<String> = (0..100)
        .map(|tick| format!(r#"{{"at": {tick}, "body": "drone", "set": {{"velocity": [0.{tick:03}, 0]}}}}"#))
        .collect();
    let scene = format!(
        r#"{{"ticks": 70, "gravity": [0, -10], "sleep_after": null, "bodies": [
        {{"name": "floor", "kind": "static", "colliders": [{{"shape": {{"rectangle": {{"width": 8, "height": 1}}}}}}]}},
        {{"name": "gate", "kind": "static", "position": [0, 3],
            "colliders": [{{"shape": {{"rectangle": {{"width": 2, "height": 0.5}}}}, "sensor": true}}]}},
        {{"name": "ball", "position": [0, 5],
            "colliders": [{{"shape": {{"circle": {{"radius": 0.25}}}}, "contact_events": true, "hit_events": true}}]}},
        {{"name": "drone", "position": [3, 9], "gravity_scale": 0}}],
        "joints": [{{"bodies": [null, "drone"], "points": [[3, 10], [3, 9]], "distance": {{}}, "break_force": 0, "events": true}}],
        "inputs": [{}]}}"#,
        inputs.join(", ")
    );
    let scene = Page::scene("encounters", scene);
    let (page, said) = Page::of(scene.path(), None);
    assert_eq!(said, "", "all is listed");
    let Some(mut browser) = Browser::start() else { return };
    browser.open(&page.0, "");
    let list = listed(&mut browser);
    let find =
        |start: &str| list.iter().find(|line| line.trim_start_matches(|c: char| c.is_ascii_digit()).starts_with(start));
    let input = "0input velocity of drone (to tick 69)";
    assert!(list.iter().any(|line| line == input), "{list:#?}");
    assert_eq!(list.iter().filter(|line| line.contains("input ")).count(), 1, "{list:#?}");
    for start in
        ["broke drone: joint 0", "entered a sensor ball, gate", "left a sensor ball, gate", "touch floor, ball"]
    {
        assert!(find(start).is_some(), "{start} in {list:#?}");
    }
    let hit = find("hit floor, ball: at 9.").expect("a fall of 4.25 m");
    assert!(hit.ends_with(" N·s"), "{hit}");
    // They are kinds to choose, and go to their tick.
    browser.evaluate("(() => { const kinds = document.querySelector('#kinds'); kinds.value = 'hit'; kinds.dispatchEvent(new Event('change')); })()");
    assert_eq!(listed(&mut browser).len(), 1);
    browser.click("#list button");
    assert!((54..58).contains(&tick(&mut browser)));
    assert_eq!(browser.text("#body dd[data-name=name]"), "floor");
    browser.assert_clean();
}

#[test]
fn the_picture_fits_the_outlines_of_bodies() {
    // A long floor, and a ball above it: a disc around the floor would be 40 m high.
    let scene = r#"{"ticks": 1, "bodies": [
        {"name": "floor", "kind": "static", "colliders": [{"shape": {"chain": {"points": [[20, 0], [-20, 0]]}}}]},
        {"name": "plank", "position": [0, 3], "colliders": [{"shape": {"rectangle": {"width": 30, "height": 1}}}]}]}"#;
    let scene = Page::scene("fit", scene);
    let (page, _) = Page::of(scene.path(), None);
    let Some(mut browser) = Browser::start() else { return };
    browser.look([1280, 800], "light");
    browser.open(&page.0, "");
    // From x = -20 to 20 over the width, and from y = 0 to 3.5 about the middle.
    let shares = browser.evaluate(
        "(() => {
            const { clientWidth: w, clientHeight: h } = document.querySelector('#canvas'), scale = (w - 48) / 40;
            const at = (x, y) => [0.5 + x * scale / w, 0.5 - (y - 1.75) * scale / h];
            return [at(-19.9, 0), at(19.9, 0), at(14.9, 3.4), at(15.5, 3.4)];
        })()",
    );
    for (i, name) in ["floor", "floor", "plank", ""].into_iter().enumerate() {
        let share = [0, 1].map(|axis| shares[i][axis].as_f64().expect("a number"));
        browser.hover("#canvas", share);
        let shown = browser.evaluate("document.querySelector('#body dd[data-name=name]')?.textContent ?? ''");
        assert_eq!(shown, name, "{share:?}");
    }
    browser.assert_clean();
}

#[test]
fn sensors_one_way_colliders_and_belts_are_told_apart() {
    let scene = r#"{"ticks": 2, "bodies": [
        {"name": "wall", "kind": "static", "position": [-3, 0], "colliders": [{"shape": {"rectangle": {"width": 1, "height": 1}}}]},
        {"name": "coin", "kind": "static", "position": [-1, 0], "colliders": [{"shape": {"rectangle": {"width": 1, "height": 1}}, "sensor": true}]},
        {"name": "plank", "kind": "static", "position": [1, 0], "angle": 1.5707963267,
            "colliders": [{"shape": {"rectangle": {"width": 1, "height": 1}}, "one_way": {}}]},
        {"name": "belt", "kind": "static", "position": [3, 0], "colliders": [{"shape": {"rectangle": {"width": 1, "height": 1}}, "surface_speed": 2}]}],
        "plot": {"view": [[-5, -2], [5, 2]], "trails": "none"}}"#;
    let scene = Page::scene("surfaces", scene);
    let (page, _) = Page::of(scene.path(), None);
    let text = page.text();
    assert!(text.contains(r#"["sensor",[["p",[[-0.5,-0.5],"#), "{text}");
    // A belt whose speed is above zero carries its top to the left; a plank holds upwards in its own axes.
    assert!(text.contains(r#"],[0.0,0.0],[0.0,1.0]]"#) && text.contains(r#"],[0.0,0.0],[-1.0,0.0]]"#), "{text}");
    let Some(mut browser) = Browser::start() else { return };
    browser.look([1280, 800], "light");
    browser.open(&page.0, "");
    browser.hover("h1", [0.5, 0.5]);
    let legend = browser.text("#legend");
    assert_eq!(legend, "staticsensorone-waybelt");
    // How dark the area of each is, away from its middle with the arrow: 0 for the paper. And the number of dark points of its left edge.
    let measure = |browser: &mut Browser, x: f64| {
        let script = format!(
            "(() => {{
                {CANVAS}
                const scale = Math.min((canvas.clientWidth - 48) / 10, (canvas.clientHeight - 112) / 4);
                const darkness = (x, y) => {{
                    const px = (canvas.clientWidth / 2 + x * scale) * ratio, py = (canvas.clientHeight / 2 - y * scale) * ratio;
                    const [r, g, b] = pen.getImageData(Math.round(px), Math.round(py), 1, 1).data;
                    return 255 - (r + g + b) / 3;
                }};
                let dark = 0;
                for (let i = -45; i <= 45; i++) dark += Math.max(darkness({x} - 0.5, i / 100), darkness({x} - 0.5 - 1 / scale, i / 100)) > 100;
                return [darkness({x} + 0.3, 0.3), dark];
            }})()"
        );
        let value = browser.evaluate(&script);
        [0, 1].map(|i| value[i].as_f64().expect("a number"))
    };
    let [wall, coin, plank, belt] = [-3.0, -1.0, 1.0, 3.0].map(|x| measure(&mut browser, x));
    assert!(
        coin[0] < plank[0] && plank[0] < wall[0] && (belt[0] - wall[0]).abs() < 2.0,
        "{coin:?} {plank:?} {wall:?} {belt:?}"
    );
    // The edge of a wall has no gaps; all others have dashes.
    assert!(wall[1] > 88.0, "{wall:?}");
    for dashed in [coin, plank, belt] {
        assert!((20.0..85.0).contains(&dashed[1]), "{dashed:?}");
    }
    browser.assert_clean();
    // The picture of `--plot` has the same dashes.
    let picture = Page(Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-surfaces.svg", std::process::id())));
    assert!(umbra(&["view", scene.path(), "--plot", picture.path()]).status.success());
    let picture = picture.text();
    for (dashes, count) in [("4 4", 1), ("9 3 2 3", 1), ("2 2", 1)] {
        assert_eq!(picture.matches(&format!("stroke-dasharray=\"{dashes}\"")).count(), count, "{dashes}");
    }
}
