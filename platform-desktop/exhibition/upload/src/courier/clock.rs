//! The clock of a courier on Linux: the time since boot, including sleep.

use std::fs;
use std::sync::LazyLock;
use std::time::Instant;

/// Returns milliseconds since boot, from the kernel's uptime file, at a resolution of 10 ms. Without that
/// file, returns milliseconds since the first call.
#[must_use]
pub fn read_clock_ms() -> u64 {
    static FIRST_CALL: LazyLock<Instant> = LazyLock::new(Instant::now);
    // One clock for the whole run, as the two clocks have different origins.
    static HAS_UPTIME: LazyLock<bool> = LazyLock::new(|| read_uptime_ms().is_some());
    let first_call = *FIRST_CALL;
    match *HAS_UPTIME {
        // If a read fails, time stands still.
        true => read_uptime_ms().unwrap_or(0),
        false => u64::try_from(first_call.elapsed().as_millis()).unwrap_or(u64::MAX),
    }
}

fn read_uptime_ms() -> Option<u64> {
    let uptime = fs::read_to_string("/proc/uptime").ok()?;
    let (seconds, hundredths) = uptime.split(' ').next()?.split_once('.')?;
    Some(seconds.parse::<u64>().ok()? * 1000 + hundredths.parse::<u64>().ok()? * 10)
}

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Duration;

    use super::read_clock_ms;

    #[test]
    fn it_goes_on() {
        let before = read_clock_ms();
        thread::sleep(Duration::from_millis(60));
        let passed = read_clock_ms() - before;
        assert!((50..30_000).contains(&passed), "{passed} ms");
    }
}
