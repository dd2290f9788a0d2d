//! A real headless browser, controlled by the Chrome DevTools Protocol over a pair of pipes: JSON messages,
//! each terminated by a zero byte.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use paros_shell::require::require_or_skip;
use serde_json::{Value, json};

/// The timeout of a page or a response, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser window. The browser is killed on drop.
pub(crate) struct Chromium {
    process: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    session: String,
    last: u64,
    /// Events that arrived while a response was awaited.
    events: Vec<Value>,
}

/// A screenshot of the page.
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// The red, green and blue of each pixel.
    pub(crate) pixels: Vec<[u8; 3]>,
}

impl Chromium {
    /// Starts a browser with a new profile under `name`. Returns `None` and reports it if no browser is
    /// installed.
    pub(crate) fn start(name: &str) -> Option<Self> {
        let found = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(|program| {
            let told = Command::new(program).arg("--version").stderr(Stdio::null()).output();
            told.is_ok_and(|told| told.status.success())
        });
        let program = require_or_skip(found.ok_or("no chromium")).expect("chromium");
        program.map(|program| Chromium::start_program(program, name))
    }

    fn start_program(program: &str, name: &str) -> Self {
        let profile = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("chromium-{name}"));
        let _ = fs::remove_dir_all(&profile);
        // A shell passes the pipes as the file descriptors 3 and 4, which the protocol uses.
        let mut process = Command::new("sh")
            .args([
                "-c",
                "exec \"$@\" 3<&0 4>&1 0</dev/null 1>/dev/null 2>/dev/null",
                "sh",
                program,
            ])
            .args(["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run"])
            .args(["--disable-dev-shm-usage", "--ignore-certificate-errors"])
            .args(["--disable-background-networking", "--disable-component-update"])
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
            .args(["--lang=en", "--hide-scrollbars"])
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let to = process.stdin.take().expect("a pipe");
        let from = read_messages(process.stdout.take().expect("a pipe"));
        let (session, events) = (String::new(), Vec::new());
        let mut browser = Chromium { process, to, from, session, last: 0, events };
        let target = browser.call("Target.createTarget", &json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", &attach);
        browser.session = attached["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page.enable", "Runtime.enable", "Log.enable", "Network.enable"] {
            browser.call(domain, &json!({}));
        }
        browser
    }

    /// Sets the size of the window, in CSS pixels.
    pub(crate) fn resize(&mut self, (width, height): (u32, u32), is_phone: bool) {
        let size = json!({
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone,
        });
        self.call("Emulation.setDeviceMetricsOverride", &size);
    }

    /// Opens a page, and waits until it is loaded.
    pub(crate) fn open(&mut self, url: &str) {
        self.events.clear();
        let opened = self.call("Page.navigate", &json!({ "url": url }));
        assert!(opened["errorText"].is_null(), "{url}: {opened}");
        self.wait_for_load();
    }

    /// Evaluates an expression in the page. Awaits a promise.
    pub(crate) fn ask(&mut self, expression: &str) -> Value {
        let asked = json!({
            "expression": expression, "returnByValue": true, "awaitPromise": true,
        });
        let answer = self.call("Runtime.evaluate", &asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression:.80}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Returns `true` if an element matches a CSS selector.
    pub(crate) fn has(&mut self, selector: &str) -> bool {
        self.ask(&format!("document.querySelector({}) !== null", quote(selector))) == true
    }

    /// Returns the visible text of the page.
    pub(crate) fn text(&mut self) -> String {
        self.ask("document.body.innerText").as_str().expect("text").to_owned()
    }

    /// Clicks the first element that matches a selector, with the mouse.
    pub(crate) fn click(&mut self, selector: &str) {
        let place = self.ask(&format!(
            "(() => {{ const found = document.querySelector({}); if (!found) return null;
             found.scrollIntoView({{ block: 'center', behavior: 'instant' }});
             const box = found.getBoundingClientRect();
             return [box.x + box.width / 2, box.y + box.height / 2]; }})()",
            quote(selector)
        ));
        assert!(place.is_array(), "no {selector}: {}", self.text());
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({
                "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1,
            });
            self.call("Input.dispatchMouseEvent", &event);
        }
    }

    /// Clicks a link or a button, and waits for the next page.
    pub(crate) fn follow(&mut self, selector: &str) {
        self.events.clear();
        self.click(selector);
        self.wait_for_load();
    }

    /// Types into a field.
    pub(crate) fn fill(&mut self, selector: &str, text: &str) {
        self.click(selector);
        self.call("Input.insertText", &json!({ "text": text }));
    }

    /// Presses Enter, and waits for the next page.
    pub(crate) fn enter(&mut self) {
        self.events.clear();
        for (kind, text) in [("keyDown", "\r"), ("keyUp", "")] {
            let event = json!({
                "type": kind, "key": "Enter", "code": "Enter", "text": text,
                "windowsVirtualKeyCode": 13,
            });
            self.call("Input.dispatchKeyEvent", &event);
        }
        self.wait_for_load();
    }

    /// Takes a screenshot as PNG, and also stores it under `target/tmp`.
    pub(crate) fn draw(&mut self, name: &str) -> Vec<u8> {
        let drawn = self.call("Page.captureScreenshot", &json!({ "format": "png" }));
        let png = STANDARD.decode(drawn["data"].as_str().expect("a picture")).expect("base64");
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("staff-page");
        fs::create_dir_all(&folder).expect("room on the disk");
        fs::write(folder.join(format!("{name}.png")), &png).expect("room on the disk");
        png
    }

    /// Waits until an expression is true.
    pub(crate) fn wait_for(&mut self, expression: &str) {
        let start = Instant::now();
        while self.ask(expression) != true {
            assert!(start.elapsed() < PATIENCE, "never: {expression}");
            thread::sleep(Duration::from_millis(100));
        }
    }

    /// Presses, moves or releases the mouse.
    pub(crate) fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        let params = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", &params);
    }

    pub(crate) fn press_key(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", &json!({ "type": kind, "key": key, "code": key }));
        }
    }

    /// Takes a screenshot of a part of the page: left, top, width, height. Also stores it as a file for
    /// people to look at.
    pub(crate) fn picture(&mut self, name: &str, [x, y, width, height]: [f64; 4]) -> Picture {
        let clip = json!({ "x": x, "y": y, "width": width, "height": height, "scale": 1 });
        let shot = self.call("Page.captureScreenshot", &json!({ "format": "png", "clip": clip }));
        let png = STANDARD.decode(shot["data"].as_str().expect("a picture")).expect("base64");
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
        fs::write(path, &png).expect("room on the disk");
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("it fits")];
        let info = reader.next_frame(&mut bytes).expect("a picture");
        let samples = info.color_type.samples();
        let pixels =
            bytes.chunks_exact(samples).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Picture { width: info.width as usize, height: info.height as usize, pixels }
    }

    /// Waits until a page is loaded, and checks that no request or script in it failed.
    fn wait_for_load(&mut self) {
        let start = Instant::now();
        let is_load = |event: &Value| event["method"] == "Page.loadEventFired";
        while !self.events.iter().any(is_load) {
            let event = self.receive(start);
            self.events.push(event);
        }
        for event in &self.events {
            let entry = &event["params"]["entry"];
            let is_wrong = event["method"] == "Log.entryAdded"
                && ["security", "javascript"].contains(&entry["source"].as_str().unwrap_or(""));
            assert!(!is_wrong && event["method"] != "Runtime.exceptionThrown", "{event}");
        }
    }

    /// Calls a method of the protocol, and returns its result.
    pub(crate) fn call(&mut self, method: &str, params: &Value) -> Value {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": params });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.clone().into();
        }
        let sent = self.to.write_all(format!("{message}\0").as_bytes());
        sent.and_then(|()| self.to.flush()).expect("the browser lives");
        let start = Instant::now();
        loop {
            let mut answer = self.receive(start);
            if answer["id"] == self.last {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].take();
            }
            self.events.push(answer);
        }
    }

    fn receive(&mut self, start: Instant) -> Value {
        match self.from.recv_timeout(PATIENCE.saturating_sub(start.elapsed())) {
            Ok(message) => message,
            Err(RecvTimeoutError::Timeout) => panic!("the browser is silent"),
            Err(RecvTimeoutError::Disconnected) => panic!("the browser has ended"),
        }
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn read_messages(from: ChildStdout) -> Receiver<Value> {
    let (to, messages) = channel();
    thread::spawn(move || {
        for message in BufReader::new(from).split(0).map_while(Result::ok) {
            let message = serde_json::from_slice(&message).expect("JSON");
            if to.send(message).is_err() {
                break;
            }
        }
    });
    messages
}

/// Writes a text as a JavaScript literal.
fn quote(text: &str) -> String {
    Value::from(text).to_string()
}
