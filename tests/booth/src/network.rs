//! A network that loses, delays, duplicates and reorders messages.

use std::cell::RefCell;
use std::rc::Rc;

use paros_models::random_visitor::RandomSource;
use paros_upload::{BoothLink, BoothRequest, LinkAnswer, LinkFault};

/// A headset's queues of requests and responses.
#[derive(Debug, Default)]
pub struct Wire {
    /// Requests not delivered to the network yet.
    pub sent: Vec<BoothRequest>,
    /// Responses that the headset hasn't read yet.
    pub arrived: Vec<LinkAnswer>,
}

/// A headset's link to the booth.
#[derive(Clone, Debug, Default)]
pub struct SimLink(pub Rc<RefCell<Wire>>);

impl BoothLink for SimLink {
    fn send(&mut self, request: BoothRequest) {
        self.0.borrow_mut().sent.push(request);
    }

    fn poll(&mut self) -> Option<LinkAnswer> {
        let mut wire = self.0.borrow_mut();
        if wire.arrived.is_empty() { None } else { Some(wire.arrived.remove(0)) }
    }
}

/// A message in transit.
#[derive(Debug)]
pub enum Message {
    /// A request to the booth.
    Request(BoothRequest),
    /// A response to the start that sent the request.
    Answer(LinkAnswer),
}

/// A message in transit, with its headset and arrival time.
#[derive(Debug)]
pub struct OnItsWay {
    /// The headset's index.
    pub headset: usize,
    /// The start that sent the message: a later start doesn't receive it.
    pub start: u32,
    /// Arrival time, in milliseconds of the exhibition.
    pub arrives_ms: u64,
    /// The message.
    pub message: Message,
}

/// The network's faults: one message in `lost_of` is lost, one in `doubled_of` duplicated.
#[derive(Clone, Copy, Debug)]
pub struct Weather {
    /// One message in this many is lost; 0 for none.
    pub lost_of: u64,
    /// One message in this many is duplicated; 0 for none.
    pub doubled_of: u64,
    /// The longest delay of a message, in milliseconds.
    pub longest_ms: u64,
    /// `true` if the network is down.
    pub is_down: bool,
}

impl Weather {
    /// A perfect network: every message arrives at once.
    pub const FINE: Weather = Weather { lost_of: 0, doubled_of: 0, longest_ms: 20, is_down: false };

    /// Draws random faults.
    pub fn draw(dice: &mut RandomSource) -> Self {
        let longest_ms = [20, 300, 5_000, 90_000][dice.below(4) as usize];
        let lost_of = [0, 20, 5, 2][dice.below(4) as usize];
        let doubled_of = [0, 10, 3][dice.below(3) as usize];
        Weather { lost_of, doubled_of, longest_ms, is_down: dice.one_in(5) }
    }

    /// Returns the arrival time of each copy of a message.
    pub fn deliveries(&self, now_ms: u64, dice: &mut RandomSource) -> Vec<u64> {
        let mut times = Vec::new();
        let is_lost = self.is_down || self.lost_of > 0 && dice.one_in(self.lost_of);
        if !is_lost {
            times.push(now_ms + 1 + dice.below(self.longest_ms));
            if self.doubled_of > 0 && dice.one_in(self.doubled_of) {
                times.push(now_ms + 1 + dice.below(3 * self.longest_ms));
            }
        }
        times
    }
}

/// Returns the link's error for a lost request, if the link notices the loss.
#[must_use]
pub fn fault_of(request: &BoothRequest, dice: &mut RandomSource) -> Option<LinkAnswer> {
    let BoothRequest { kind, number, .. } = *request;
    let faults = [LinkFault::Unreachable, LinkFault::TimedOut, LinkFault::Untrusted];
    let fault = faults[dice.below(3) as usize];
    dice.one_in(2).then_some(LinkAnswer { kind, number, result: Err(fault) })
}
