//! An HTTPS request and its answer.

use std::io;

use paros_protocol::limits::MAX_ANSWER_BYTES;
use paros_upload::{BoothCaller, HttpAnswer, HttpMethod, HttpRequest, LinkError, LinkFault};
use ureq::http::Response;
use ureq::http::header::RETRY_AFTER;
use ureq::{Agent, Body, Error};

use crate::make_agent;

/// A client of a booth, for one thread.
#[derive(Debug)]
pub struct HttpsCaller {
    agent: Agent,
    url: String,
}

impl HttpsCaller {
    /// Makes a client of the booth at `https://HOST:PORT`, with a certificate from the authority `ca` (DER).
    #[must_use]
    pub fn new(url: &str, ca: &[u8]) -> Self {
        HttpsCaller { agent: make_agent(ca), url: url.to_owned() }
    }

    fn send(&self, request: &HttpRequest<'_>) -> Result<Response<Body>, Error> {
        let url = format!("{}{}", self.url, request.path);
        let mut asked = match request.method {
            HttpMethod::Put => self.agent.put(url),
            HttpMethod::Post => self.agent.post(url),
        };
        for (name, value) in &request.headers {
            asked = asked.header(*name, value);
        }
        asked.config().timeout_global(Some(request.timeout)).build().send(request.body)
    }
}

impl BoothCaller for HttpsCaller {
    fn call(&mut self, request: &HttpRequest<'_>) -> Result<HttpAnswer, LinkError> {
        let answer = self.send(request).and_then(read_answer);
        answer.map_err(|error| LinkError { fault: fault_of(&error), why: error.to_string() })
    }
}

fn read_answer(mut response: Response<Body>) -> Result<HttpAnswer, Error> {
    let status = response.status().as_u16();
    let retry_after = response.headers().get(RETRY_AFTER);
    let retry_after = retry_after.and_then(|value| value.to_str().ok()?.trim().parse().ok());
    let most = MAX_ANSWER_BYTES as u64;
    let body = response.body_mut().with_config().limit(most).read_to_vec()?;
    Ok(HttpAnswer { status, retry_after, body })
}

/// Classifies an error for the outbox: unreachable, timed out, or an untrusted peer.
fn fault_of(error: &Error) -> LinkFault {
    match error {
        Error::Timeout(_) => LinkFault::TimedOut,
        Error::Tls(_) | Error::Rustls(_) => LinkFault::Untrusted,
        Error::Io(error) if is_tls(error) => LinkFault::Untrusted,
        Error::Io(error) if error.kind() == io::ErrorKind::TimedOut => LinkFault::TimedOut,
        _ => LinkFault::Unreachable,
    }
}

fn is_tls(error: &io::Error) -> bool {
    error.get_ref().is_some_and(|inner| inner.is::<rustls::Error>())
}
