//! One request and its answer.

use std::io;

use paros_shell::outbox::{BoothRequest, HttpAnswer, LinkAnswer, LinkFault, SentRequest};
use ureq::http::Response;
use ureq::http::header::{AUTHORIZATION, CONTENT_TYPE, RETRY_AFTER};
use ureq::{Agent, Body, Error};

use crate::BoothAddress;

/// Bytes of a body that are read at most: no answer of the booth has more.
const MAX_BODY_BYTES: u64 = 4096;

pub(crate) const OCTETS: &str = "application/octet-stream";

/// A booth, as one thread asks it.
pub(crate) struct Booth {
    agent: Agent,
    url: String,
    authorization: String,
}

impl Booth {
    pub(crate) fn new(agent: Agent, address: &BoothAddress) -> Self {
        let authorization = format!("Bearer {}", address.token.reveal());
        Booth { agent, url: address.url.clone(), authorization }
    }

    /// Asks, and waits for the answer.
    pub(crate) fn ask(&self, request: &BoothRequest) -> LinkAnswer {
        let request_of = match request {
            BoothRequest::Put { number, .. } => SentRequest::Put { number: *number },
            BoothRequest::Heartbeat { number, .. } => SentRequest::Heartbeat { number: *number },
        };
        let result = self.send(request).and_then(read_answer).map_err(|error| fault_of(&error));
        LinkAnswer { request: request_of, result }
    }

    fn send(&self, request: &BoothRequest) -> Result<Response<Body>, Error> {
        let url = &self.url;
        match request {
            BoothRequest::Put { id, hash, parcel_bytes, offset, part, .. } => self
                .agent
                .put(format!("{url}/v1/sculptures/{id}?offset={offset}"))
                .header(AUTHORIZATION, &self.authorization)
                .header(CONTENT_TYPE, OCTETS)
                .header("X-Parcel-Hash", hash.to_string())
                .header("X-Parcel-Bytes", parcel_bytes.to_string())
                .send(&part[..]),
            BoothRequest::Heartbeat { body, .. } => self
                .agent
                .post(format!("{url}/v1/heartbeat"))
                .header(AUTHORIZATION, &self.authorization)
                .header(CONTENT_TYPE, OCTETS)
                .send(&body[..]),
        }
    }
}

pub(crate) fn read_answer(mut response: Response<Body>) -> Result<HttpAnswer, Error> {
    let status = response.status().as_u16();
    let retry_after = response.headers().get(RETRY_AFTER);
    let retry_after = retry_after.and_then(|value| value.to_str().ok()?.trim().parse().ok());
    let body = response.body_mut().with_config().limit(MAX_BODY_BYTES).read_to_vec()?;
    Ok(HttpAnswer { status, retry_after, body })
}

/// What an error means for the outbox: nothing was heard, nothing in time, or by somebody else.
pub(crate) fn fault_of(error: &Error) -> LinkFault {
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
