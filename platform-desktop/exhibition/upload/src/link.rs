//! The link to the booth: requests and answers.

use paros_protocol::SculptureId;

/// A non-blocking link to the booth: answers are polled. Requests may be lost, and answers may be late or
/// missing.
pub trait BoothLink {
    /// Sends a request. At most two requests are under way, one of each kind. A new request replaces an older
    /// one of its kind, which has timed out.
    fn send(&mut self, request: BoothRequest);

    /// Returns the next answer that has arrived.
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
    /// The kind of the request.
    pub kind: RequestKind,
    /// The sequence number of the request among those of its kind.
    pub number: u32,
    /// The body of the request.
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
    /// The kind of the request.
    pub kind: RequestKind,
    /// The sequence number of the request.
    pub number: u32,
    /// The answer, or the reason why there is none.
    pub result: Result<HttpAnswer, LinkFault>,
}

/// An HTTP answer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HttpAnswer {
    /// The HTTP status.
    pub status: u16,
    /// The seconds of the header `Retry-After`; `None` if the header is missing or has another form.
    pub retry_after: Option<u32>,
    /// The body, at most 8 KiB.
    pub body: Vec<u8>,
}

/// The reason why there is no answer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LinkFault {
    /// The host doesn't exist, or the connection failed.
    Unreachable,
    /// The request timed out.
    TimedOut,
    /// The peer isn't the booth: its certificate isn't from the site's authority.
    Untrusted,
}
