//! `paros sound` from a user's view: a trace becomes a WAV file, and a failure leaves no files.

use std::io::Cursor;

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::limits::INTERVALS;
use paros_core::session::{BenchItem, PointerCommand, SessionMode, Tool, commands};
use paros_core::{HandInput, TickInput};
use paros_shell::tick_runner;

use crate::support::TestFolder;

/// Records two seconds: a motor runs in the second half of the first, and the session ends with the second.
fn record_motor() -> Vec<u8> {
    tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        runner.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
        let item = BenchItem::Tool(Tool::Rotary).number() as u8;
        let pointer = PointerCommand::Take { hand: 1, item };
        runner.run_tick(&TickInput { pointer, ..TickInput::default() });
        for tick in 2..144 {
            let bit = Pose { position: Vec3::new(64.0, 150.0, 64.0), rotation: Quat::IDENTITY };
            let trigger = if (36..72).contains(&tick) { 255 } else { 0 };
            let mut input = TickInput::default();
            input.hands[1] = HandInput { trigger, ..runner.world().hand_with_bit_at(1, &bit) };
            input.commands = if tick == 108 { commands::FINISH } else { 0 };
            runner.run_tick(&input);
        }
        runner.end_recording_to_bytes().unwrap()
    })
}

#[test]
fn a_trace_is_heard_as_it_was() {
    let folder = TestFolder::new("sound");
    folder.write("t.trace", record_motor());
    let told = folder.succeeds(&["sound", "t.trace", "-o", "s.wav", "--loudness", "100"]);
    assert_eq!(told, "s.wav: 2.0 s\n");
    let bytes = folder.read("s.wav");
    let mut wav = hound::WavReader::new(Cursor::new(&bytes)).unwrap();
    let spec = wav.spec();
    assert_eq!((spec.channels, spec.sample_rate, spec.bits_per_sample), (2, 48_000, 16));
    let samples: Vec<i32> = wav.samples::<i16>().map(|sample| sample.unwrap().into()).collect();
    assert_eq!(samples.len(), 2 * 2 * 48_000);
    let loudest_in_ticks = |ticks: core::ops::Range<usize>| {
        let of_tick = |tick: usize| 2 * (tick * 48_000 / 72);
        let samples = &samples[of_tick(ticks.start)..of_tick(ticks.end)];
        samples.iter().map(|sample| sample.abs()).max().unwrap()
    };
    // The tool is taken, which makes a short sound.
    assert!(loudest_in_ticks(1..4) > 500);
    assert_eq!(loudest_in_ticks(30..36), 0);
    assert!(loudest_in_ticks(36..38) > 1000 && loudest_in_ticks(38..72) > 2000);
    assert_eq!(loudest_in_ticks(90..108), 0);
    assert!(loudest_in_ticks(108..110) > 1000);
    // Half the loudness setting means a quarter of the amplitude. The output is deterministic.
    folder.succeeds(&["sound", "t.trace", "-o", "half.wav", "--loudness", "50"]);
    folder.succeeds(&["sound", "t.trace", "-o", "again.wav", "--loudness", "100"]);
    assert!(folder.read("again.wav") == bytes);
    let half = folder.read("half.wav");
    let half = hound::WavReader::new(Cursor::new(&half)).unwrap().into_samples::<i16>();
    let quiet = half.map(|sample| i32::from(sample.unwrap().abs())).max().unwrap();
    let loud = loudest_in_ticks(0..144);
    assert!((quiet - loud / 4).abs() <= 1, "{quiet} {loud}");
}

#[test]
fn what_can_not_be_heard_leaves_nothing() {
    let folder = TestFolder::new("sound-refuses");
    let mut trace = record_motor();
    folder.write("t.trace", &trace);
    *trace.last_mut().unwrap() ^= 1;
    folder.write("bad.trace", &trace);
    folder.write("cut.trace", &trace[..1000]);
    folder.refuses(&["sound", "bad.trace", "-o", "s.wav"], "bad.trace: tick 143: another state");
    folder.refuses(&["sound", "cut.trace", "-o", "s.wav"], "cut.trace");
    folder.refuses(&["sound", "t.trace", "-o", "s.mp3"], "s.mp3");
    folder.refuses(&["sound", "t.trace", "-o", "none/s.wav"], "none");
    folder.refuses(&["sound", "t.trace", "-o", "s.wav", "--loudness", "0"], "1..=100");
    folder.refuses(&["sound", "none.trace", "-o", "s.wav"], "none.trace");
}
