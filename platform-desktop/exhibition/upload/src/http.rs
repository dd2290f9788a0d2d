//! Requests to the booth over HTTPS, independent of the HTTP library: content, timeouts, and threads that
//! wait for answers.

use std::fmt;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use paros_protocol::{DeviceToken, HEARTBEAT_PATH, LinkTimes, PARCEL_PATH};

use super::link::{BoothLink, BoothRequest, HttpAnswer, LinkAnswer, LinkFault, RequestKind};

const OCTETS: &str = "application/octet-stream";
const JSON: &str = "application/json";

/// The address of a booth, its certificate authority, and the headset's token.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BoothAddress {
    /// The URL of the booth, `https://HOST:PORT`, without a trailing slash.
    pub url: String,
    /// The certificate of the site's certificate authority, DER.
    pub ca: Vec<u8>,
    /// The token that identifies the headset to the booth.
    pub token: DeviceToken,
}

/// An HTTP method.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HttpMethod {
    /// `PUT`.
    Put,
    /// `POST`.
    Post,
}

/// An HTTP request. The caller also sends the length of its body.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HttpRequest<'a> {
    /// The method.
    pub method: HttpMethod,
    /// The path with the query, starting with a slash.
    pub path: String,
    /// The names and values of the headers.
    pub headers: Vec<(&'static str, String)>,
    /// The body.
    pub body: &'a [u8],
    /// The timeout, counted from the start of the request.
    pub timeout: Duration,
}

/// The reason why a request has no answer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LinkError {
    /// The kind of the fault.
    pub fault: LinkFault,
    /// The library's message, for a log.
    pub why: String,
}

/// A blocking HTTPS client of a booth.
pub trait BoothCaller {
    /// Sends a request, and waits for the answer until the timeout. Doesn't follow redirects.
    ///
    /// # Errors
    /// No answer arrived, or its body is longer than
    /// [`MAX_ANSWER_BYTES`](paros_protocol::limits::MAX_ANSWER_BYTES).
    fn call(&mut self, request: &HttpRequest<'_>) -> Result<HttpAnswer, LinkError>;
}

/// A link with one thread for each kind of request, so that an upload doesn't delay heartbeats. After the
/// link is dropped, each thread ends with its current request.
#[derive(Debug)]
pub struct ThreadedLink {
    puts: Sender<BoothRequest>,
    heartbeats: Sender<BoothRequest>,
    answers: Receiver<(RequestKind, u32, Result<HttpAnswer, LinkError>)>,
    last_error: Option<LinkError>,
    log: Option<fn(fmt::Arguments<'_>)>,
    told: Option<LinkFault>,
}

impl HttpMethod {
    /// Returns the name of the method.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            HttpMethod::Put => "PUT",
            HttpMethod::Post => "POST",
        }
    }
}

impl<'a> HttpRequest<'a> {
    /// Makes a `POST` request of a message without a token.
    #[must_use]
    pub fn post(path: &str, body: &'a [u8]) -> Self {
        HttpRequest {
            method: HttpMethod::Post,
            path: path.to_owned(),
            headers: vec![("Content-Type", JSON.to_owned())],
            body,
            timeout: LinkTimes::default().small,
        }
    }

    /// Makes the HTTP request of an outbox's request, with the headset's token.
    #[must_use]
    pub fn of_outbox(request: &'a BoothRequest, token: &DeviceToken, times: LinkTimes) -> Self {
        let body = &request.body[..];
        let mut asked = match request.kind {
            RequestKind::Put(id) => HttpRequest {
                method: HttpMethod::Put,
                headers: vec![("Content-Type", OCTETS.to_owned())],
                timeout: times.of_parcel(body.len()),
                ..HttpRequest::post(&format!("{PARCEL_PATH}{id}"), body)
            },
            RequestKind::Heartbeat => {
                HttpRequest { timeout: times.small, ..HttpRequest::post(HEARTBEAT_PATH, body) }
            }
        };
        asked.headers.push(("Authorization", format!("Bearer {}", token.reveal())));
        asked
    }
}

impl ThreadedLink {
    /// Starts a link that sends parcels with `of_puts` and heartbeats with `of_heartbeats`.
    #[must_use]
    pub fn start<C: BoothCaller + Send + 'static>(
        token: DeviceToken,
        times: LinkTimes,
        of_puts: C,
        of_heartbeats: C,
    ) -> Self {
        let (tell, answers) = channel();
        let spawn = |name: &str, mut caller: C| {
            let tell = tell.clone();
            let (ask, requests) = channel::<BoothRequest>();
            // If the system can't start a thread, requests get no answer, as if the booth were unreachable.
            let _ = thread::Builder::new().name(name.to_owned()).spawn(move || {
                for request in requests {
                    let result = caller.call(&HttpRequest::of_outbox(&request, &token, times));
                    // The send fails if the link was dropped.
                    if tell.send((request.kind, request.number, result)).is_err() {
                        break;
                    }
                }
            });
            ask
        };
        let (puts, heartbeats) = (spawn("put", of_puts), spawn("heartbeat", of_heartbeats));
        ThreadedLink { puts, heartbeats, answers, last_error: None, log: None, told: None }
    }

    /// Returns the link with a log function, which gets a line when requests begin to fail, or fail for
    /// another kind of reason.
    #[must_use]
    pub fn with_log(self, log: fn(fmt::Arguments<'_>)) -> Self {
        ThreadedLink { log: Some(log), ..self }
    }

    /// Returns the error of the last request; `None` if it was answered.
    #[must_use]
    pub const fn last_error(&self) -> Option<&LinkError> {
        self.last_error.as_ref()
    }
}

impl BoothLink for ThreadedLink {
    fn send(&mut self, request: BoothRequest) {
        let queue = match request.kind {
            RequestKind::Put(_) => &self.puts,
            RequestKind::Heartbeat => &self.heartbeats,
        };
        // Fails if the thread has ended. The request then has no answer.
        let _ = queue.send(request);
    }

    fn poll(&mut self) -> Option<LinkAnswer> {
        let (kind, number, result) = self.answers.try_recv().ok()?;
        self.last_error = result.as_ref().err().cloned();
        let fault = self.last_error.as_ref().map(|error| error.fault);
        if let (Some(log), Some(error), true) = (self.log, &self.last_error, fault != self.told) {
            log(format_args!("{error}"));
        }
        self.told = fault;
        Some(LinkAnswer { kind, number, result: result.map_err(|error| error.fault) })
    }
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.fault {
            LinkFault::Unreachable => "the booth can't be reached",
            LinkFault::TimedOut => "the booth doesn't answer in time",
            LinkFault::Untrusted => "who answers isn't the booth",
        };
        write!(f, "{what}: {}", self.why)
    }
}

impl std::error::Error for LinkError {}

#[cfg(test)]
mod tests {
    use std::sync::{Mutex, PoisonError};
    use std::time::Instant;

    use super::*;

    /// A caller that returns these faults one after the other, from the last one, and then answers.
    struct Caller(Vec<LinkFault>);

    impl BoothCaller for Caller {
        fn call(&mut self, _: &HttpRequest<'_>) -> Result<HttpAnswer, LinkError> {
            match self.0.pop() {
                Some(fault) => {
                    Err(LinkError { fault, why: format!("as {} are left", self.0.len()) })
                }
                None => Ok(HttpAnswer { status: 200, retry_after: None, body: Vec::new() }),
            }
        }
    }

    static LINES: Mutex<Vec<String>> = Mutex::new(Vec::new());

    fn log(line: fmt::Arguments<'_>) {
        LINES.lock().unwrap_or_else(PoisonError::into_inner).push(line.to_string());
    }

    #[test]
    fn a_reason_is_told_once_as_long_as_it_stays() {
        use LinkFault::{TimedOut, Unreachable};
        let faults = vec![TimedOut, Unreachable, Unreachable];
        let token = DeviceToken([1; 32]);
        let times = LinkTimes::default();
        let link = ThreadedLink::start(token, times, Caller(Vec::new()), Caller(faults));
        let mut link = link.with_log(log);
        let mut ask = || {
            let body = b"{}".to_vec();
            link.send(BoothRequest { kind: RequestKind::Heartbeat, number: 1, body });
            let begun = Instant::now();
            loop {
                if let Some(answer) = link.poll() {
                    return (answer.result.err(), link.last_error().is_some());
                }
                assert!(begun.elapsed() < Duration::from_secs(60), "no answer");
                thread::sleep(Duration::from_millis(1));
            }
        };
        let found = [(); 5].map(|()| ask());
        let failed = |fault| (Some(fault), true);
        let fine = (None, false);
        assert_eq!(found, [failed(Unreachable), failed(Unreachable), failed(TimedOut), fine, fine]);
        let expected = [
            "the booth can't be reached: as 2 are left",
            "the booth doesn't answer in time: as 0 are left",
        ];
        assert_eq!(*LINES.lock().expect("nobody panicked"), expected);
    }
}
