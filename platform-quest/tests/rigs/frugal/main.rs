//! A profiler of the frame loop: allocations and CPU time of the shell's thread, frame by frame. Usage:
//! `frugal FOLDER FRAMES`. It runs the test commands from standard input, quits FRAMES frames after the
//! first hundred, and prints their cost: times in nanoseconds, the median of each, and the `worst`.
//!
//! A frame's own time is the thread's CPU time without steps of the world and calls into OpenXR and Vulkan.
//! Each of these is timed by reading the clock twice. The cost of that reading stays in the own time and is
//! printed beside it, as is the time of a fixed reference calculation between the frames: the own time in
//! multiples of it is comparable between machines.

mod calls;
mod clock;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::PathBuf;

use openxr as xr;
use paros_headset::start_up::StartUp;
use paros_quest::error::Error;
use paros_quest::options::ShellOptions;
use paros_quest::platform::{PlainPlatform, Platform, PlatformStatus};
use paros_quest::shell::run_shell;

/// Frames before the measured ones; these may allocate.
const WARM_UP_FRAMES: usize = 100;

struct CountingAllocator;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn count_allocation() {
    COUNT.with(|count| count.set(count.get() + 1));
}

// SAFETY: all is done by the system's allocator.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_allocation();
        // SAFETY: the caller's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count_allocation();
        // SAFETY: the caller's.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count_allocation();
        // SAFETY: the caller's.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// The cost of a frame, or of all frames so far.
#[derive(Clone, Copy, Default)]
struct FrameCost {
    allocations: u64,
    own_nanos: u64,
    step_nanos: u64,
    thread_nanos: u64,
    /// Calls into OpenXR and Vulkan, and steps of the world.
    foreign_calls: u64,
    /// The time of the reference calculation after the frame, which isn't part of the frame.
    reference_nanos: u64,
}

/// The host's platform, which also samples the cost of every frame.
struct ProfilingPlatform {
    frames: Vec<FrameCost>,
    wanted: usize,
    last: FrameCost,
    step_nanos: u64,
    reference: Box<clock::ReferenceTable>,
    /// `true` after the first frame of the studio; earlier frames show the loading notice.
    has_studio: bool,
}

impl ProfilingPlatform {
    fn cost_so_far(&self) -> FrameCost {
        FrameCost {
            own_nanos: clock::own_cpu_nanos_so_far(),
            thread_nanos: clock::thread_cpu_nanos_so_far(),
            allocations: COUNT.with(Cell::get),
            foreign_calls: clock::foreign_calls_so_far(),
            step_nanos: self.step_nanos,
            reference_nanos: 0,
        }
    }
}

impl Platform for ProfilingPlatform {
    fn load_openxr(&mut self) -> Result<xr::Entry, Error> {
        let entry = calls::entry_with_clocks(PlainPlatform.load_openxr()?);
        entry.map_err(|result| Error::Call { action: "look at the loader", result })
    }

    fn poll_status(&mut self) -> PlatformStatus {
        let (now, last) = (self.cost_so_far(), self.last);
        if calls::take_frame_ended()
            && self.has_studio
            && self.frames.len() < self.frames.capacity()
        {
            self.frames.push(FrameCost {
                allocations: now.allocations - last.allocations,
                own_nanos: now.own_nanos - last.own_nanos,
                step_nanos: now.step_nanos - last.step_nanos,
                thread_nanos: now.thread_nanos - last.thread_nanos,
                foreign_calls: now.foreign_calls - last.foreign_calls,
                reference_nanos: clock::measure_reference_nanos(&self.reference),
            });
        }
        self.last = self.cost_so_far();
        let quit_requested = self.frames.len() == self.wanted;
        PlatformStatus { quit_requested, ..PlatformStatus::default() }
    }

    fn note_start_up(&mut self, start: StartUp) {
        self.has_studio = start == StartUp::Ready;
    }

    fn run_world_step(&mut self, step: &mut dyn FnMut()) {
        let begun = clock::thread_cpu_nanos_so_far();
        clock::time_foreign_call(step);
        self.step_nanos += clock::thread_cpu_nanos_so_far() - begun;
    }

    fn vulkan_device_wrapper(&self) -> Option<fn(ash::Device) -> ash::Device> {
        Some(calls::device_with_clocks)
    }
}

fn main() {
    let mut args = std::env::args().skip(1);
    let folder = PathBuf::from(args.next().expect("a folder"));
    let frames: usize = args.next().and_then(|count| count.parse().ok()).expect("a number");
    let options =
        ShellOptions { folder: Some(folder), test_commands: true, ..ShellOptions::default() };
    let wanted = WARM_UP_FRAMES + frames;
    let frames = Vec::with_capacity(wanted);
    let mut platform = ProfilingPlatform {
        frames,
        wanted,
        last: FrameCost::default(),
        step_nanos: 0,
        reference: clock::reference_table(),
        has_studio: false,
    };
    run_shell::<128>(&mut platform, &options).expect("a session");
    let (first, rest) = platform.frames.split_at(WARM_UP_FRAMES);
    let taken: u64 = first.iter().map(|frame| frame.allocations).sum();
    let taking = rest.iter().filter(|frame| frame.allocations > 0).count();
    let most = rest.iter().map(|frame| frame.allocations).max().unwrap_or_default();
    println!(
        "frames {}; first {taken}; allocating {taking}; most {most}; own {}; worst {}; \
         steps {}; thread {}; calls {}; clock {}; reference {}",
        rest.len(),
        median_of(rest, |frame| frame.own_nanos),
        rest.iter().map(|frame| frame.own_nanos).max().unwrap_or_default(),
        median_of(rest, |frame| frame.step_nanos),
        median_of(rest, |frame| frame.thread_nanos),
        median_of(rest, |frame| frame.foreign_calls),
        median_of(rest, |frame| frame.foreign_calls)
            * clock::measure_clock_nanos_per_thousand_calls()
            / 1000,
        median_of(rest, |frame| frame.reference_nanos),
    );
}

fn median_of(frames: &[FrameCost], of: impl Fn(&FrameCost) -> u64) -> u64 {
    let mut all: Vec<u64> = frames.iter().map(of).collect();
    all.sort_unstable();
    all[all.len() / 2]
}
