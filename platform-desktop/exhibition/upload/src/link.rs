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
pub struct BoothRequest {
    /// The kind.
    pub kind: RequestKind,
    /// The request's own number among those of its kind.
    pub number: u32,
    /// The body.
    pub body: Vec<u8>,
}

/// The kind of a request.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RequestKind {
    /// `PUT /v1/sculptures/{id}`: a parcel's file.
    Put(SculptureId),
    /// `POST /v1/heartbeat`.
    Heartbeat,
}

/// The result of a request.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LinkAnswer {
    /// The request's kind.
    pub kind: RequestKind,
    /// The request's number.
    pub number: u32,
    /// The answer, or why there is none.
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
