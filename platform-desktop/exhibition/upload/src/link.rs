//! Requests to the booth and its answers.

use paros_protocol::SculptureId;

/// A link to the booth. It asks and never waits: answers are polled. What is asked may be lost; an answer comes late,
/// or not at all.
pub trait BoothLink {
    /// Sends a request. There are at most two under way, one of each kind; an older one of the kind has been given
    /// up.
    fn send(&mut self, request: BoothRequest);

    /// The next answer that has come.
    fn poll(&mut self) -> Option<LinkAnswer>;
}

impl<L: BoothLink + ?Sized> BoothLink for Box<L> {
    fn send(&mut self, request: BoothRequest) {
        (**self).send(request);
    }

    fn poll(&mut self) -> Option<LinkAnswer> {
        (**self).poll()
    }
}

/// A request to the booth.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum BoothRequest {
    /// `PUT /v1/sculptures/{id}`.
    Put {
        /// The request's own number.
        number: u32,
        /// The sculpture.
        id: SculptureId,
        /// The body: the parcel's file.
        body: Vec<u8>,
    },
    /// `POST /v1/heartbeat`.
    Heartbeat {
        /// The heartbeat's own number.
        number: u32,
        /// The body.
        body: Vec<u8>,
    },
}

/// Which request an answer is to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SentRequest {
    /// A `PUT`.
    Put {
        /// Of the request.
        number: u32,
    },
    /// A heartbeat.
    Heartbeat {
        /// Of the request.
        number: u32,
    },
}

/// What came of a request.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LinkAnswer {
    /// Which it was.
    pub request: SentRequest,
    /// What was answered.
    pub result: Result<HttpAnswer, LinkFault>,
}

/// An answer of HTTP.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HttpAnswer {
    /// The status.
    pub status: u16,
    /// The header `Retry-After`, where it is a number of seconds.
    pub retry_after: Option<u32>,
    /// The body, at most 8 KiB of it.
    pub body: Vec<u8>,
}

/// Why there is no answer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LinkFault {
    /// Nobody is there, or the way there is interrupted.
    Unreachable,
    /// Nothing came in time.
    TimedOut,
    /// Who is there isn't the booth: its certificate isn't of the site.
    Untrusted,
}

impl BoothRequest {
    /// Which request an answer to it is to.
    #[must_use]
    pub const fn sent(&self) -> SentRequest {
        match self {
            BoothRequest::Put { number, .. } => SentRequest::Put { number: *number },
            BoothRequest::Heartbeat { number, .. } => SentRequest::Heartbeat { number: *number },
        }
    }
}
