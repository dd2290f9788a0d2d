//! The shell with a count of its allocations and of its thread's time, frame by frame: `frugal FOLDER
//! FRAMES`. Prints the numbers of the frames after the first hundred.

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

/// A system that looks at every frame.
struct Watching {
    frames: usize,
    allocations: Vec<u64>,
    micros: Vec<u64>,
    last: (u64, u64),
}

impl Host for Watching {
    fn entry(&mut self) -> Result<xr::Entry, Error> {
        Plain.entry()
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
        let now = (COUNT.with(Cell::get), thread_micros());
        if self.allocations.len() < self.frames {
            self.allocations.push(now.0 - self.last.0);
            self.micros.push(now.1 - self.last.1);
        }
        self.last = now;
        Told { leave: self.allocations.len() == self.frames, ..Told::default() }
    }
}

fn main() {
    let mut args = std::env::args().skip(1);
    let folder = PathBuf::from(args.next().expect("a folder"));
    let frames = args.next().and_then(|frames| frames.parse().ok()).expect("a number of frames");
    let options = Options { folder: Some(folder), ..Options::default() };
    let room = || Vec::with_capacity(frames);
    let mut host = Watching { frames, allocations: room(), micros: room(), last: (0, 0) };
    shell::run::<128>(&mut host, &options).expect("a session");
    let (allocations, micros) = (&mut host.allocations[FIRST..], &mut host.micros[FIRST..]);
    let taking = allocations.iter().filter(|count| **count > 0).count();
    let most = allocations.iter().max().copied().unwrap_or_default();
    micros.sort_unstable();
    let median = micros[micros.len() / 2];
    println!("frames {}; that allocate {taking}; at most {most}; median {median} us", micros.len());
}

/// This thread's time on a processor, in microseconds.
fn thread_micros() -> u64 {
    #[repr(C)]
    struct Timespec {
        seconds: i64,
        nanos: i64,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut Timespec) -> i32;
    }
    const CLOCK_THREAD_CPUTIME_ID: i32 = 3;
    let mut time = Timespec { seconds: 0, nanos: 0 };
    // SAFETY: the structure is that of 64-bit Linux.
    unsafe { clock_gettime(CLOCK_THREAD_CPUTIME_ID, &mut time) };
    time.seconds.cast_unsigned() * 1_000_000 + time.nanos.cast_unsigned() / 1000
}
