//! A headset's lease and what a booth sends it: refused at an offset within the bytes, or used: no number is given
//! twice, whatever was saved and answered, and what was loaded is saved as it was.

use paros_core::badge::{
    AnswerOutcome, BadgeLease, BadgeLedger, DAY_SECONDS, LeaseAnswer, LeaseReport, LeasedBlock,
    LeasedBlocks,
};
use paros_core::codec::{BadBytes, ByteReader};
use paros_core::internals::{ByteWriter, checksum};

use crate::engine::FuzzTarget;

/// An input is a saved lease without its checksum, then an answer to it, then the report of another headset.
pub(super) const LEASE: FuzzTarget = FuzzTarget {
    name: "lease",
    seeds,
    words: &[b"PBLS", b"\0\0\0\0", b"\xff\xff\xff\xff", b"\xff\x6f", b"\x3f", b"\x06"],
    longest: 200,
    runs: 15_000,
    run,
};

const HEADSET: u32 = 7;

/// Of a saved lease, without its checksum.
const BODY: usize = BadgeLease::BYTES - 8;

fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    for taken in [0, 3, 12] {
        let mut ledger = Box::new(BadgeLedger::new(90));
        let mut lease = BadgeLease::new(HEADSET, taken + 1);
        let answer = ledger.answer_report(&lease.make_report(), DAY_SECONDS).expect("an answer");
        assert_eq!(lease.take_answer(&answer), AnswerOutcome::Taken);
        (0..taken).for_each(|_| _ = lease.take_number(0));
        let report = lease.make_report();
        let answer = ledger.answer_report(&report, DAY_SECONDS).expect("an answer");
        let mut bytes = vec![0; 200 - BODY];
        let mut to = ByteWriter::new(&mut bytes);
        write_report(&mut to, &report);
        to.u8(answer.is_void.into());
        to.u8(answer.blocks.len() as u8);
        for block in &answer.blocks {
            to.u16(block.block());
            to.u8((64 - block.count()) as u8);
        }
        write_report(&mut to, &report);
        seeds.push([&save(&lease)[..BODY], &bytes].concat());
    }
    seeds
}

fn run(bytes: &[u8]) -> String {
    let (body, rest) = bytes.split_at(bytes.len().min(BODY));
    let saved = [body, &checksum(body).to_le_bytes()].concat();
    let mut lease = match BadgeLease::load(&saved, HEADSET) {
        Ok(lease) => lease,
        Err(bad) => {
            assert!(bad.offset <= saved.len());
            return bad.expected.into();
        }
    };
    assert_eq!(save(&lease)[..], saved);
    take_all(&mut lease.clone());
    let from = &mut ByteReader::new(rest);
    let outcome = match read_answer(from) {
        Ok(answer) => format!("{:?}", hear(&mut lease, &answer)),
        Err(bad) => bad.expected.into(),
    };
    take_all(&mut lease);
    let Ok(report) = read_report(from) else { return outcome };
    format!("{outcome}, {}", ask(&report))
}

fn write_report(to: &mut ByteWriter<'_>, report: &LeaseReport) {
    to.u32(report.headset);
    to.u64(report.epoch);
    to.u32(report.report);
    to.u32(report.taken);
}

fn read_report(from: &mut ByteReader<'_>) -> Result<LeaseReport, BadBytes> {
    Ok(LeaseReport {
        headset: from.u32()?,
        epoch: from.u64()?,
        report: from.u32()?,
        taken: from.u32()?,
    })
}

/// An answer of any bytes: the fields of its report, whether it is void, and blocks.
fn read_answer(from: &mut ByteReader<'_>) -> Result<LeaseAnswer, BadBytes> {
    let LeaseReport { headset, epoch, report, taken } = read_report(from)?;
    let is_void = from.u8()? & 1 == 1;
    let mut blocks = LeasedBlocks::new();
    for _ in 0..from.u8()? % 7 {
        let block = LeasedBlock::new(from.u16()?, from.u8()?);
        let is_new =
            |block: &LeasedBlock| blocks.iter().all(|other| other.block() != block.block());
        if let Some(block) = block.filter(|block| !is_void && is_new(block)) {
            // There are six at most.
            let _ = blocks.push(block);
        }
    }
    Ok(LeaseAnswer { headset, epoch, report, taken, is_void, blocks })
}

fn save(lease: &BadgeLease) -> [u8; BadgeLease::BYTES] {
    let mut bytes = [0; BadgeLease::BYTES];
    lease.save(&mut bytes);
    bytes
}

/// Takes an answer. What is ignored changes nothing.
fn hear(lease: &mut BadgeLease, answer: &LeaseAnswer) -> AnswerOutcome {
    let (before, had_taken) = (lease.clone(), lease.clone().make_report().taken);
    let outcome = lease.take_answer(answer);
    match outcome {
        AnswerOutcome::Ignored => assert_eq!(*lease, before),
        AnswerOutcome::Void => assert_eq!(lease.left(), 0),
        AnswerOutcome::Taken => {
            assert!(lease.clone().make_report().taken >= had_taken.max(answer.taken));
            let answered: u32 = answer.blocks.iter().map(|block| block.count()).sum();
            assert!(lease.left() <= answered);
        }
    }
    outcome
}

/// Takes all numbers that are left: each is leased, and none is given twice.
fn take_all(lease: &mut BadgeLease) {
    let mut seen = std::collections::HashSet::new();
    let (left, taken) = (lease.left(), lease.clone().make_report().taken);
    loop {
        lease.pass_time(u32::MAX);
        let number = lease.take_number(0);
        assert!(number.badge().number() == Ok(number));
        if number.is_provisional() {
            break;
        }
        assert!(seen.insert(number), "{number:?} twice");
    }
    // A lease that has counted as far as it can gives nothing more.
    assert_eq!(seen.len() as u32, left.min(u32::MAX - taken));
    assert_eq!(lease.clone().make_report().taken - taken, seen.len() as u32);
}

/// Asks a ledger that knows another lease of the same headset, which stays in order.
fn ask(report: &LeaseReport) -> String {
    let mut ledger = Box::new(BadgeLedger::new(90));
    let mut known = BadgeLease::new(HEADSET, 1);
    let answer = ledger.answer_report(&known.make_report(), DAY_SECONDS).expect("an answer");
    assert_eq!(known.take_answer(&answer), AnswerOutcome::Taken);
    let first = known.take_number(0);
    let second = known.make_report();
    ledger.answer_report(&second, DAY_SECONDS).expect("an answer");
    // A day later, as another lease soon after the first would be refused unread.
    let said = match ledger.answer_report(report, 2 * DAY_SECONDS) {
        Ok(answer) => if answer.is_void { "void" } else { "answered" }.into(),
        Err(refusal) => refusal.to_string(),
    };
    assert!(!ledger.is_free(first));
    said
}
