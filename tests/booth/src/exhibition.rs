//! A simulated exhibition: some headsets, one of which is a thief's, and random events.

use paros_booth_rules::BoothTime;
use paros_models::random_visitor::RandomSource;
use paros_protocol::{CommandOutcome, HeartbeatAnswer};
use paros_upload::{BoothRequest, HttpAnswer, LinkAnswer, OutboxEvent};
use paros_upload::{OutboxSettings, RemoteCommand, RequestKind};

use crate::booth::{OPENING, SITE, SimBackup, SimBooth};
use crate::check::{check, check_settled, is_settled, list_unsettled};
use crate::headset::SimHeadset;
use crate::network::{Message, OnItsWay, Weather, fault_of};
use crate::truth::Truth;

/// Number of headsets, the thief's excluded.
const HEADSETS: usize = 3;

/// The index of the thief's device.
pub(crate) const THIEF: u8 = HEADSETS as u8;

/// Capacity of the event log, in lines.
const LOG_LINES: usize = 400;

/// A simulated exhibition.
pub struct Exhibition {
    /// The headsets.
    pub headsets: Vec<SimHeadset>,
    /// The booth's number of the thief's device.
    pub thief: u32,
    /// The booth.
    pub booth: SimBooth,
    /// The ground truth that the checks compare with.
    pub truth: Truth,
    /// The latest events, for failure messages.
    pub log: Vec<String>,
    pub(crate) now_ms: u64,
    pub(crate) weather: Weather,
    pub(crate) backup: Option<SimBackup>,
    pub(crate) grace_seconds: u32,
    pub(crate) on_its_way: Vec<OnItsWay>,
    pub(crate) dice: RandomSource,
}

impl Exhibition {
    /// Creates an exhibition from a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut dice = RandomSource::new(seed);
        let booth = SimBooth::new(dice.next_bits());
        let grace_seconds = [0, 60, 3600, 86_400][dice.below(4) as usize];
        let max_bytes = if dice.one_in(4) { 4000 } else { 1 << 24 };
        let settings = OutboxSettings { grace_seconds, max_bytes };
        let numbers: Vec<u32> = (0..=THIEF).map(|device| booth.enrol(device, OPENING)).collect();
        let headset = |&number: &u32| SimHeadset::new(number, settings, &mut dice);
        Exhibition {
            headsets: numbers[..HEADSETS].iter().map(headset).collect(),
            thief: numbers[HEADSETS],
            booth,
            truth: Truth::default(),
            log: Vec::new(),
            now_ms: 0,
            weather: Weather::FINE,
            backup: None,
            grace_seconds,
            on_its_way: Vec::new(),
            dice,
        }
    }

    /// Runs `acts` random actions, then heals all faults and waits until everything is settled.
    ///
    /// # Panics
    /// A sculpture is lost, stored twice, or never arrives.
    pub fn run(&mut self, acts: u32) {
        for act in 0..acts {
            self.act();
            self.pass_time();
            if act % 16 == 0 {
                check(self);
            }
        }
        self.heal();
        for _ in 0..400 {
            if is_settled(self) {
                break;
            }
            self.turn(1000);
        }
        assert!(is_settled(self), "it doesn't settle: {}", list_unsettled(self));
        check_settled(self);
    }

    pub(crate) fn note(&mut self, line: &str) {
        if self.log.len() == LOG_LINES {
            self.log.remove(0);
        }
        self.log.push(format!("{:>9} ms: {line}", self.now_ms));
    }

    pub(crate) const fn booth_time(&self) -> BoothTime {
        BoothTime(OPENING.0 + self.now_ms)
    }

    pub(crate) fn any_headset(&mut self) -> usize {
        self.dice.below(HEADSETS as u64) as usize
    }

    fn pass_time(&mut self) {
        let ms = match self.dice.below(40) {
            0 => 3_600_000 + self.dice.below(20_000_000),
            1..6 => self.dice.below(3000),
            _ => self.dice.below(300),
        };
        self.turn(ms);
        if self.dice.one_in(6) {
            let h = self.any_headset();
            self.power_up(h);
        }
    }

    pub(crate) fn power_up(&mut self, h: usize) {
        if self.headsets[h].sender.is_none() {
            self.headsets[h].power_up(SITE);
            self.note(&format!("headset {h} starts: {:?}", self.headsets[h].list_files()));
        }
    }

    /// Advances the time: messages arrive and headsets step.
    pub(crate) fn turn(&mut self, ms: u64) {
        self.now_ms += ms;
        for h in 0..HEADSETS {
            self.headsets[h].host.clock_ms += ms;
            self.headsets[h].disk.borrow_mut().now_s = self.now_ms / 1000;
        }
        self.deliver();
        for h in 0..HEADSETS {
            self.step(h);
        }
    }

    fn deliver(&mut self) {
        loop {
            let due = |message: &OnItsWay| message.arrives_ms <= self.now_ms;
            let next = self.on_its_way.iter().enumerate().filter(|(_, message)| due(message));
            let next = next.min_by_key(|(_, message)| message.arrives_ms).map(|(at, _)| at);
            let Some(at) = next else { return };
            let OnItsWay { headset, start, message, .. } = self.on_its_way.swap_remove(at);
            match message {
                Message::Request(request) => {
                    let now = self.booth_time();
                    let answer = self.booth.serve(headset as u8, &request, now);
                    self.note_noted(headset, &request, &answer);
                    let BoothRequest { kind, number, .. } = request;
                    let message = LinkAnswer { kind, number, result: Ok(answer) };
                    for arrives_ms in self.weather.deliveries(self.now_ms, &mut self.dice) {
                        let message = Message::Answer(message.clone());
                        self.on_its_way.push(OnItsWay { headset, start, arrives_ms, message });
                    }
                }
                Message::Answer(answer) => {
                    let headset = &self.headsets[headset];
                    if headset.start == start {
                        headset.wire.borrow_mut().arrived.push(answer);
                    }
                }
            }
        }
    }

    /// Records the announcements that the booth acknowledged, even if the response is lost.
    fn note_noted(&mut self, h: usize, request: &BoothRequest, answer: &HttpAnswer) {
        let is_heartbeat = request.kind == RequestKind::Heartbeat;
        if let Ok(answer) = HeartbeatAnswer::from_json(&answer.body)
            && is_heartbeat
        {
            let number = self.headsets[h].number;
            self.truth.noted.extend(answer.noted.iter().map(|noted| (number, noted.id)));
        }
    }

    pub(crate) fn step(&mut self, h: usize) {
        let headset = &mut self.headsets[h];
        let Some(sender) = &mut headset.sender else { return };
        sender.step(&mut headset.host);
        let sent = std::mem::take(&mut headset.wire.borrow_mut().sent);
        let events = std::mem::take(&mut headset.host.events);
        let start = headset.start;
        if headset.see_whether_it_is_dead() {
            self.note(&format!("headset {h} has no power"));
            return;
        }
        for request in sent {
            let times = self.weather.deliveries(self.now_ms, &mut self.dice);
            if times.is_empty()
                && let Some(fault) = fault_of(&request, &mut self.dice)
            {
                self.headsets[h].wire.borrow_mut().arrived.push(fault);
            }
            for arrives_ms in times {
                let message = Message::Request(request.clone());
                self.on_its_way.push(OnItsWay { headset: h, start, arrives_ms, message });
            }
        }
        for event in events {
            self.take_event(h, &event);
        }
    }

    fn take_event(&mut self, h: usize, event: &OutboxEvent) {
        self.note(&format!("headset {h}: {event:?}"));
        match event {
            OutboxEvent::KeptAtBooth(id) | OutboxEvent::DeletedAtBooth(id) => {
                self.truth.heard += 1;
                if let Some(made) = self.truth.find(*id) {
                    made.was_signed = true;
                }
            }
            OutboxEvent::Command { command, .. } => self.carry_out(h, command),
            _ => {}
        }
    }

    fn carry_out(&mut self, h: usize, command: &RemoteCommand) {
        let asked = self.truth.commands.get_mut(&(h, command.id)).expect("the staff's own");
        let headset = &mut self.headsets[h];
        assert_eq!((asked.kind, asked.boot_id), (command.kind, headset.boot_id));
        let age_ms = self.now_ms - asked.asked_ms;
        assert!(age_ms < 10_000, "a command of {age_ms} ms ago");
        let is_for_this = asked.session_id == headset.host.session_id;
        assert!(is_for_this || !asked.kind.is_for_visit(), "a command for an ended visit");
        asked.done += 1;
        assert_eq!(asked.done, 1, "a command is carried out twice");
        if let Some(sender) = &mut headset.sender {
            sender.note_command_done(command.id, CommandOutcome::Done);
        }
    }

    /// Ends all failures and powers every headset up.
    fn heal(&mut self) {
        self.note("all is well from now on");
        self.weather = Weather::FINE;
        self.booth.set_failures(0);
        for h in 0..HEADSETS {
            self.headsets[h].disk.borrow_mut().mend();
            self.headsets[h].see_whether_it_is_dead();
            // Restarts the program, which scans its folder again.
            self.headsets[h].kill();
            self.power_up(h);
            let sender = self.headsets[h].sender.as_mut().expect("nothing fails");
            let announced: Vec<_> = sender.spool().entries().iter().map(|entry| entry.id).collect();
            for id in announced {
                // Parcels already stored here stay.
                let _ = sender.abandon(id);
            }
        }
    }
}
