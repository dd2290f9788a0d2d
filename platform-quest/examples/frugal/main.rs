//! The shell with a count of its allocations and a clock on its thread, frame by frame: `frugal
//! FOLDER FRAMES`. It does what a test writes to it, leaves after so many frames behind the first
//! hundred, and prints what they took: in nanoseconds, the median of each but for `worst`.
//!
//! A frame's own time is this thread's time on a processor without that of steps of the world and
//! of calls into OpenXR and Vulkan. Each has the clock around it: what that takes is left in, and
//! printed beside it.

mod calls;
mod clock;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::PathBuf;

use openxr as xr;
use paros_quest::error::Error;
use paros_quest::host::{Host, Plain, Told};
use paros_quest::options::Options;
use paros_quest::shell;

/// Frames that may take memory.
const FIRST: usize = 100;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    COUNT.with(|count| count.set(count.get() + 1));
}

// SAFETY: all is done by the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: the caller's.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller's.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What there was so far, or in a frame.
#[derive(Clone, Copy, Default)]
struct Sums {
    allocations: u64,
    /// All times are in nanoseconds.
    own: u64,
    steps: u64,
    thread: u64,
    /// Calls and steps.
    calls: u64,
}

/// A system that looks at every frame.
struct Watching {
    frames: Vec<Sums>,
    wanted: usize,
    last: Sums,
    steps: u64,
}

impl Host for Watching {
    fn entry(&mut self) -> Result<xr::Entry, Error> {
        let entry = calls::entry(Plain.entry()?);
        entry.map_err(|result| Error::Call { doing: "look at the loader", result })
    }

    fn instance(
        &mut self,
        entry: &xr::Entry,
        application: &xr::ApplicationInfo<'_>,
        extensions: xr::ExtensionSet,
    ) -> xr::Result<xr::Instance> {
        Plain.instance(entry, application, extensions)
    }

    fn told(&mut self) -> Told {
        let (own, thread) = (clock::own(), clock::nanos());
        let (allocations, calls) = (COUNT.with(Cell::get), clock::calls());
        let now = Sums { allocations, own, steps: self.steps, thread, calls };
        let last = core::mem::replace(&mut self.last, now);
        if calls::frame_has_ended() && self.frames.len() < self.frames.capacity() {
            self.frames.push(Sums {
                allocations: now.allocations - last.allocations,
                own: now.own - last.own,
                steps: now.steps - last.steps,
                thread: now.thread - last.thread,
                calls: now.calls - last.calls,
            });
        }
        Told { leave: self.frames.len() == self.wanted, ..Told::default() }
    }

    fn step(&mut self, step: &mut dyn FnMut()) {
        let begun = clock::nanos();
        clock::elsewhere(step);
        self.steps += clock::nanos() - begun;
    }

    fn around_device(&self) -> Option<fn(ash::Device) -> ash::Device> {
        Some(calls::device)
    }
}

fn main() {
    let mut args = std::env::args().skip(1);
    let folder = PathBuf::from(args.next().expect("a folder"));
    let frames: usize = args.next().and_then(|count| count.parse().ok()).expect("a number");
    let options = Options { folder: Some(folder), script: true, ..Options::default() };
    let wanted = FIRST + frames;
    let frames = Vec::with_capacity(wanted);
    let mut host = Watching { frames, wanted, last: Sums::default(), steps: 0 };
    shell::run::<128>(&mut host, &options).expect("a session");
    let (first, rest) = host.frames.split_at(FIRST);
    let taken: u64 = first.iter().map(|frame| frame.allocations).sum();
    let taking = rest.iter().filter(|frame| frame.allocations > 0).count();
    let most = rest.iter().map(|frame| frame.allocations).max().unwrap_or_default();
    println!(
        "frames {}; first {taken}; allocating {taking}; most {most}; own {}; worst {}; \
         steps {}; thread {}; calls {}; clock {}",
        rest.len(),
        median(rest, |frame| frame.own),
        rest.iter().map(|frame| frame.own).max().unwrap_or_default(),
        median(rest, |frame| frame.steps),
        median(rest, |frame| frame.thread),
        median(rest, |frame| frame.calls),
        median(rest, |frame| frame.calls) * clock::cost() / 1000,
    );
}

fn median(frames: &[Sums], of: impl Fn(&Sums) -> u64) -> u64 {
    let mut all: Vec<u64> = frames.iter().map(of).collect();
    all.sort_unstable();
    all[all.len() / 2]
}
