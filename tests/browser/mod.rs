//! A browser without a window, driven through the Chrome DevTools protocol.
//!
//! It speaks through two pipes, which a shell puts where Chromium looks for them: no port, no library.

use std::env;
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Longest time that a working browser takes for anything, with room for a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

const FLAGS: [&str; 11] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
    "--window-size=1280,800",
];

/// The browser that there is. Where there is none the test that asked says that it is skipped, and with
/// UMBRA_REQUIRE_BROWSER=1 it fails.
fn program() -> Option<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let program =
        env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|file| file.is_file());
    if program.is_none() || !Path::new("/bin/sh").is_file() {
        let required = env::var("UMBRA_REQUIRE_BROWSER").is_ok_and(|value| value == "1");
        assert!(!required, "UMBRA_REQUIRE_BROWSER=1, and there is no Chromium");
        // Past the harness, which shows what passed tests print to nobody.
        let name = thread::current().name().unwrap_or("test").to_owned();
        let _ = writeln!(std::io::stderr(), "{name}: SKIPPED, there is no Chromium");
        return None;
    }
    program
}

/// A browser with one page. Dropping it ends it.
pub(crate) struct Browser {
    process: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    profile: PathBuf,
    session: String,
    last_id: u64,
    /// Requests of the page and its errors, since it was opened.
    pub(crate) requests: Vec<String>,
    pub(crate) problems: Vec<String>,
}

impl Browser {
    /// None where there is no browser.
    pub(crate) fn start() -> Option<Self> {
        let program = program()?;
        let name = thread::current().name().unwrap_or("test").replace("::", "-");
        let profile = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("browser-{}-{name}", std::process::id()));
        fs::create_dir_all(&profile).expect("a folder for the profile");
        // Chromium reads from 3 and writes to 4.
        let mut process = Command::new("/bin/sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 0</dev/null 1>/dev/null"])
            .arg(program)
            .args(FLAGS)
            .arg(format!("--user-data-dir={}", profile.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let input = process.stdin.take().expect("a pipe");
        let output = process.stdout.take().expect("a pipe");
        let (sender, messages) = channel();
        thread::spawn(move || {
            for message in BufReader::new(output).split(0) {
                let Ok(message) = message else { break };
                let Ok(message) = serde_json::from_slice(&message) else { break };
                if sender.send(message).is_err() {
                    break;
                }
            }
        });
        let (requests, problems) = (Vec::new(), Vec::new());
        let session = String::new();
        let mut browser = Self { process, input, messages, profile, session, last_id: 0, requests, problems };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", attach);
        browser.session = session["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Calls a method of the protocol, and returns its result.
    pub(crate) fn call(&mut self, method: &str, params: Value) -> Value {
        self.last_id += 1;
        let mut message = json!({"id": self.last_id, "method": method, "params": params});
        if !self.session.is_empty() {
            message["sessionId"] = self.session.clone().into();
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.input.write_all(&bytes).expect("the browser listens");
        let start = Instant::now();
        loop {
            let left = PATIENCE.saturating_sub(start.elapsed());
            match self.messages.recv_timeout(left) {
                Ok(answer) if answer["id"] == self.last_id => {
                    assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                    return answer["result"].clone();
                }
                Ok(event) => self.note(&event),
                Err(RecvTimeoutError::Timeout) => panic!("{method}: no answer in {PATIENCE:?}"),
                Err(RecvTimeoutError::Disconnected) => panic!("{method}: the browser went away"),
            }
        }
    }

    fn note(&mut self, event: &Value) {
        let params = &event["params"];
        match event["method"].as_str() {
            Some("Network.requestWillBeSent") => self.requests.push(params["request"]["url"].to_string()),
            Some("Runtime.exceptionThrown") => self.problems.push(params["exceptionDetails"].to_string()),
            Some("Log.entryAdded") => self.problems.push(params["entry"].to_string()),
            Some("Runtime.consoleAPICalled") => self.problems.push(params["args"].to_string()),
            Some("Page.javascriptDialogOpening") => self.problems.push(params["message"].to_string()),
            _ => {}
        }
    }

    /// Opens a file, with what stands after the `#`, and waits until it is drawn.
    pub(crate) fn open(&mut self, file: &Path, fragment: &str) {
        self.call("Page.navigate", json!({"url": "about:blank"}));
        self.wait_for("location.href === 'about:blank'");
        self.requests.clear();
        self.problems.clear();
        let file = file.to_str().expect("UTF-8");
        self.call("Page.navigate", json!({"url": format!("file://{file}#{fragment}")}));
        self.wait_for("document.readyState === 'complete' && location.protocol === 'file:'");
        self.settle();
    }

    /// Waits until what is due is drawn.
    pub(crate) fn settle(&mut self) {
        let drawn = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))";
        assert_eq!(self.evaluate(drawn), true);
    }

    /// The value of an expression in the page, awaited.
    pub(crate) fn evaluate(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let result = self.call("Runtime.evaluate", params);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        result["result"]["value"].clone()
    }

    pub(crate) fn wait_for(&mut self, condition: &str) {
        let start = Instant::now();
        while self.evaluate(condition) != true {
            assert!(start.elapsed() < PATIENCE, "in vain: {condition}");
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// The text of an element.
    pub(crate) fn text(&mut self, selector: &str) -> String {
        let text = self.evaluate(&format!("document.querySelector({selector:?}).textContent"));
        text.as_str().unwrap_or_else(|| panic!("no text in {selector}")).to_owned()
    }

    /// A point of an element in px, by the shares of its width and height that lie before it.
    fn point(&mut self, selector: &str, [x, y]: [f64; 2]) -> [f64; 2] {
        let script = format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{block: 'nearest'}});
                const b = e.getBoundingClientRect(); return [b.x + {x} * b.width, b.y + {y} * b.height]; }})()"
        );
        let point = self.evaluate(&script);
        [0, 1].map(|i| point[i].as_f64().unwrap_or_else(|| panic!("no {selector}")))
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], more: Value) {
        let mut params = json!({"type": kind, "x": x, "y": y});
        for (name, value) in more.as_object().into_iter().flatten() {
            params[name] = value.clone();
        }
        self.call("Input.dispatchMouseEvent", params);
    }

    /// Moves the mouse there.
    pub(crate) fn hover(&mut self, selector: &str, at: [f64; 2]) {
        let point = self.point(selector, at);
        self.mouse("mouseMoved", point, json!({}));
        self.settle();
    }

    /// Clicks there, as a hand would: what lies above an element gets the click in its place.
    pub(crate) fn click_at(&mut self, selector: &str, at: [f64; 2]) {
        self.drag(selector, at, at);
    }

    pub(crate) fn click(&mut self, selector: &str) {
        self.click_at(selector, [0.5, 0.5]);
    }

    pub(crate) fn drag(&mut self, selector: &str, from: [f64; 2], to: [f64; 2]) {
        let (from, to) = (self.point(selector, from), self.point(selector, to));
        let held = json!({"button": "left", "buttons": 1, "clickCount": 1});
        self.mouse("mouseMoved", from, json!({}));
        self.mouse("mousePressed", from, held.clone());
        if from != to {
            self.mouse("mouseMoved", to, held.clone());
        }
        self.mouse("mouseReleased", to, held);
        self.settle();
    }

    /// Turns the wheel there; towards the user is above zero.
    pub(crate) fn wheel(&mut self, selector: &str, at: [f64; 2], delta: f64) {
        let point = self.point(selector, at);
        self.mouse("mouseWheel", point, json!({"deltaX": 0, "deltaY": delta}));
        self.settle();
    }

    /// Presses a key, given the name and the number that browsers have for it.
    pub(crate) fn press(&mut self, key: &str, number: u32, shift: bool) {
        for kind in ["keyDown", "keyUp"] {
            let params = json!({"type": kind, "key": key, "windowsVirtualKeyCode": number, "modifiers": if shift { 8 } else { 0 }});
            self.call("Input.dispatchKeyEvent", params);
        }
        self.settle();
    }

    /// Makes the window this large, and the theme dark or light.
    pub(crate) fn look(&mut self, [width, height]: [u32; 2], scheme: &str) {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", size);
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.call("Emulation.setEmulatedMedia", json!({"features": features}));
        self.settle();
    }

    /// A picture of what is seen, as PNG.
    pub(crate) fn picture(&mut self) -> Vec<u8> {
        let picture = self.call("Page.captureScreenshot", json!({"format": "png"}));
        bytes_of(picture["data"].as_str().expect("a picture"))
    }

    /// Fails unless the page asked for nothing but itself and nothing went wrong in it.
    pub(crate) fn assert_clean(&mut self) {
        self.settle();
        assert_eq!(self.problems, [""; 0]);
        assert!(self.requests.len() == 1 && self.requests[0].starts_with("\"file:///"), "{:?}", self.requests);
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        // Its children may write a moment longer.
        for _ in 0..20 {
            if fs::remove_dir_all(&self.profile).is_ok() {
                break;
            }
            thread::sleep(Duration::from_millis(50));
        }
    }
}

/// The bytes that a text in base64 stands for.
fn bytes_of(text: &str) -> Vec<u8> {
    let digits: Vec<u32> = text
        .bytes()
        .filter_map(|byte| match byte {
            b'A'..=b'Z' => Some(byte - b'A'),
            b'a'..=b'z' => Some(byte - b'a' + 26),
            b'0'..=b'9' => Some(byte - b'0' + 52),
            b'+' => Some(62),
            b'/' => Some(63),
            _ => None,
        })
        .map(u32::from)
        .collect();
    let four = |digits: &[u32]| {
        let word = (0..4).fold(0, |word, i| word << 6 | digits.get(i).copied().unwrap_or(0));
        word.to_be_bytes()[1..digits.len()].to_vec()
    };
    digits.chunks(4).flat_map(four).collect()
}
