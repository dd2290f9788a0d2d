//! A simulated printer that speaks Moonraker's or PrusaLink's published protocol.

use std::collections::HashMap;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;

use serde_json::{Value, json};

/// The protocol of the printer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Protocol {
    Moonraker,
    PrusaLink,
}

#[derive(Default)]
struct State {
    files: HashMap<String, Vec<u8>>,
    file: Option<String>,
    /// The state in PrusaLink's words, in capitals.
    state: &'static str,
    job: u64,
    stopped: usize,
    wrong_keys: usize,
    is_off: bool,
    refuses: bool,
    raves: bool,
}

/// A simulated printer on its own port.
pub(crate) struct StandIn {
    pub(crate) protocol: Protocol,
    pub(crate) address: SocketAddr,
    state: Arc<Mutex<State>>,
}

impl StandIn {
    pub(crate) fn start(protocol: Protocol) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("an address");
        let state = Arc::new(Mutex::new(State { state: "IDLE", ..State::default() }));
        let of_threads = state.clone();
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let state = of_threads.clone();
                thread::spawn(move || serve(protocol, stream, &state));
            }
        });
        StandIn { protocol, address, state }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap()
    }

    /// Returns the file that is being printed.
    pub(crate) fn printing(&self) -> Option<String> {
        let state = self.lock();
        state.file.clone().filter(|_| state.state == "PRINTING")
    }

    pub(crate) fn received(&self, file: &str) -> String {
        String::from_utf8(self.lock().files[file].clone()).expect("text")
    }

    pub(crate) fn finish(&self) {
        self.lock().state = "FINISHED";
    }

    pub(crate) fn stopped(&self) -> usize {
        self.lock().stopped
    }

    pub(crate) fn wrong_keys(&self) -> usize {
        self.lock().wrong_keys
    }

    /// Makes the printer accept connections without a response.
    pub(crate) fn turn_off(&self) {
        self.lock().is_off = true;
    }

    /// Makes the printer refuse files.
    pub(crate) fn refuse(&self) {
        self.lock().refuses = true;
    }

    /// Makes the printer send endless responses.
    pub(crate) fn rave(&self) {
        self.lock().raves = true;
    }
}

/// A request.
struct Request {
    method: String,
    path: String,
    headers: HashMap<String, String>,
    body: Vec<u8>,
}

fn serve(protocol: Protocol, stream: TcpStream, state: &Mutex<State>) {
    let mut reader = BufReader::new(stream);
    while let Some(request) = read(&mut reader) {
        let answer = {
            let mut state = state.lock().unwrap();
            if state.is_off {
                drop(state);
                thread::sleep(std::time::Duration::from_secs(600));
                return;
            }
            if state.raves {
                drop(state);
                return rave(reader.get_mut());
            }
            let key = match protocol {
                Protocol::Moonraker => "s3cret-moonraker",
                Protocol::PrusaLink => "s3cret-prusalink",
            };
            if request.headers.get("x-api-key").map(String::as_str) != Some(key) {
                state.wrong_keys += 1;
                (401, Value::Null)
            } else if protocol == Protocol::Moonraker {
                moonraker(&mut state, &request)
            } else {
                prusalink(&mut state, &request)
            }
        };
        let body = if answer.0 == 204 { String::new() } else { answer.1.to_string() };
        let head = format!("HTTP/1.1 {} X\r\nContent-Length: {}\r\n\r\n", answer.0, body.len());
        if reader.get_mut().write_all((head + &body).as_bytes()).is_err() {
            return;
        }
    }
}

fn rave(stream: &mut TcpStream) {
    let _ =
        stream.write_all(b"HTTP/1.1 200 OK\r\nContent-Length: 99999999\r\n\r\n{\"<script>\":\"");
    while stream.write_all(&[b'a'; 4096]).is_ok() {}
}

fn read(reader: &mut BufReader<TcpStream>) -> Option<Request> {
    let mut line = String::new();
    reader.read_line(&mut line).ok().filter(|length| *length > 0)?;
    let mut words = line.split_whitespace().map(str::to_owned);
    let (method, path) = (words.next()?, words.next()?);
    let mut headers = HashMap::new();
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).ok()?;
        let Some((name, value)) = line.trim_end().split_once(": ") else { break };
        headers.insert(name.to_lowercase(), value.to_owned());
    }
    let length =
        headers.get("content-length").map_or(0, |length| length.parse().expect("a number"));
    let mut body = vec![0; length];
    reader.read_exact(&mut body).ok()?;
    Some(Request { method, path, headers, body })
}

/// Responds as Moonraker's documentation describes: "Printer administration", "File management".
fn moonraker(state: &mut State, request: &Request) -> (u16, Value) {
    match (request.method.as_str(), request.path.as_str()) {
        ("GET", "/printer/objects/query?print_stats&virtual_sdcard") => {
            let word = match state.state {
                "PRINTING" => "printing",
                "FINISHED" => "complete",
                "STOPPED" => "cancelled",
                _ => "standby",
            };
            let file = state.file.clone().unwrap_or_default();
            let stats = json!({ "state": word, "filename": file, "print_duration": 0.0 });
            let status = json!({ "print_stats": stats, "virtual_sdcard": { "progress": 0.42 } });
            (200, json!({ "result": { "eventtime": 1.5, "status": status } }))
        }
        ("POST", "/server/files/upload") => {
            let kind = &request.headers["content-type"];
            let boundary = kind.strip_prefix("multipart/form-data; boundary=").expect("a form");
            let mut fields = HashMap::new();
            let body = String::from_utf8(request.body.clone()).expect("text");
            assert!(body.ends_with(&format!("--{boundary}--\r\n")), "the form has an end");
            for part in body.split(&format!("--{boundary}\r\n")).skip(1) {
                let (head, value) = part.split_once("\r\n\r\n").expect("a part");
                let name = |key: &str| Some(head.split(key).nth(1)?.split('"').next()?.to_owned());
                let value = value.split(&format!("\r\n--{boundary}")).next().expect("a value");
                let value = value.strip_suffix("\r\n").unwrap_or(value).to_owned();
                fields.insert(name("; name=\"").expect("a name"), (name("filename=\""), value));
            }
            assert_eq!(fields["root"].1, "gcodes");
            let (file, gcode) = fields["file"].clone();
            take_file(state, file.expect("a name"), gcode.into_bytes(), fields["print"].1 == "true")
        }
        ("POST", "/printer/print/cancel") => stop(state, 200),
        _ => (404, Value::Null),
    }
}

/// Responds as PrusaLink's `openapi.yaml` describes.
fn prusalink(state: &mut State, request: &Request) -> (u16, Value) {
    let file = request.path.strip_prefix("/api/v1/files/usb/");
    match (request.method.as_str(), request.path.as_str(), file) {
        ("GET", "/api/v1/status", _) => {
            (200, json!({ "printer": { "state": state.state, "temp_bed": 23.8 } }))
        }
        ("GET", "/api/v1/job", _) => match &state.file {
            Some(file) => {
                let file = json!({ "name": "PAROS~1.GCO", "display_name": file, "path": "/usb" });
                (
                    200,
                    json!({ "id": state.job, "state": state.state, "progress": 42.0, "file": file }),
                )
            }
            None => (204, Value::Null),
        },
        ("PUT", _, Some(file)) => {
            let prints = request.headers["print-after-upload"] == "?1";
            assert_eq!(request.headers["overwrite"], "?1");
            take_file(state, file.to_owned(), request.body.clone(), prints)
        }
        ("DELETE", path, _) if path == format!("/api/v1/job/{}", state.job) => stop(state, 204),
        _ => (404, Value::Null),
    }
}

fn take_file(state: &mut State, file: String, gcode: Vec<u8>, prints: bool) -> (u16, Value) {
    if state.refuses || state.state == "PRINTING" {
        return (409, json!({ "title": "<script>not now</script>" }));
    }
    state.files.insert(file.clone(), gcode);
    if prints {
        (state.file, state.state) = (Some(file), "PRINTING");
        state.job += 1;
    }
    (201, json!({ "print_started": prints }))
}

fn stop(state: &mut State, status: u16) -> (u16, Value) {
    if state.state != "PRINTING" {
        return (409, Value::Null);
    }
    state.state = "STOPPED";
    state.stopped += 1;
    (status, json!({ "result": "ok" }))
}
