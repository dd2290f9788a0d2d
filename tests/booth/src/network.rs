//! A network that loses, delays, doubles and reorders.

use std::cell::RefCell;
use std::rc::Rc;

use paros_models::random_visitor::RandomSource;
use paros_upload::{BoothLink, BoothRequest, LinkAnswer, LinkFault};

/// What a headset has sent, and what has come for it.
#[derive(Debug, Default)]
pub struct Wire {
    /// Requests that haven't left yet.
    pub sent: Vec<BoothRequest>,
    /// Answers that the headset hasn't read yet.
    pub arrived: Vec<LinkAnswer>,
}

/// The link of a headset.
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

/// A message on its way.
#[derive(Debug)]
pub enum Message {
    /// To the booth.
    Request(BoothRequest),
    /// To the headset's start that asked.
    Answer(LinkAnswer),
}

/// A message, whose, and when it arrives.
#[derive(Debug)]
pub struct OnItsWay {
    /// Which headset's.
    pub headset: usize,
    /// Of which of its starts: to a later one nothing is delivered.
    pub start: u32,
    /// In milliseconds of the exhibition.
    pub arrives_ms: u64,
    /// What it is.
    pub message: Message,
}

/// How bad the network is: one in so many messages is lost, one in so many doubled.
#[derive(Clone, Copy, Debug)]
pub struct Weather {
    /// Of messages lost; 0 for none.
    pub lost_of: u64,
    /// Of messages doubled; 0 for none.
    pub doubled_of: u64,
    /// The longest that one takes, in milliseconds.
    pub longest_ms: u64,
    /// Whether nothing passes.
    pub is_down: bool,
}

impl Weather {
    /// All that is sent arrives at once.
    pub const FINE: Weather = Weather { lost_of: 0, doubled_of: 0, longest_ms: 20, is_down: false };

    /// Any.
    pub fn draw(dice: &mut RandomSource) -> Self {
        let longest_ms = [20, 300, 5_000, 90_000][dice.below(4) as usize];
        let lost_of = [0, 20, 5, 2][dice.below(4) as usize];
        let doubled_of = [0, 10, 3][dice.below(3) as usize];
        Weather { lost_of, doubled_of, longest_ms, is_down: dice.one_in(5) }
    }

    /// How often and when a message arrives.
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

/// What a link says of a request that was lost, if it notices.
#[must_use]
pub fn fault_of(request: &BoothRequest, dice: &mut RandomSource) -> Option<LinkAnswer> {
    let BoothRequest { kind, number, .. } = *request;
    let faults = [LinkFault::Unreachable, LinkFault::TimedOut, LinkFault::Untrusted];
    let fault = faults[dice.below(3) as usize];
    dice.one_in(2).then_some(LinkAnswer { kind, number, result: Err(fault) })
}
