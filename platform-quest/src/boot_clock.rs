//! The time since the device booted, sleep included.
//!
//! `std::time::Instant` is `CLOCK_MONOTONIC` on Linux and Android, which stops while the device sleeps: a
//! headset that slept for a night would seem to have been off for seconds.

use std::time::Duration;

/// Returns the time since boot from `CLOCK_BOOTTIME` (Linux 2.6.39).
#[cfg(any(target_os = "linux", target_os = "android"))]
pub(crate) fn read_since_boot() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: there is room for the time.
    let failed = unsafe { libc::clock_gettime(libc::CLOCK_BOOTTIME, &raw mut time) } != 0;
    debug_assert!(!failed, "a kernel that has the clock");
    let seconds = u64::try_from(time.tv_sec).unwrap_or(0);
    Duration::new(seconds, u32::try_from(time.tv_nsec).unwrap_or(0))
}

/// Returns the time since the first call, on systems that no headset uses.
#[cfg(not(any(target_os = "linux", target_os = "android")))]
pub(crate) fn read_since_boot() -> Duration {
    use std::sync::LazyLock;
    use std::time::Instant;

    static FIRST_CALL: LazyLock<Instant> = LazyLock::new(Instant::now);
    FIRST_CALL.elapsed()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::env;
    use std::fs;
    use std::process::Command;

    use paros_shell::last_use::BootId;
    use paros_shell::require::require_or_skip;

    use super::read_since_boot;

    /// Set in the child process, whose boot clock is a day ahead.
    const INSIDE: &str = "PAROS_HAS_SLEPT";

    /// A day: `/proc/uptime` counts sleep, `CLOCK_MONOTONIC` does not.
    const SLEPT: &str = "86400";

    /// In a time namespace the clock that counts sleep is a day ahead of the one that doesn't, as on a device
    /// that has slept for a day.
    #[test]
    fn sleep_is_counted() {
        let uptime = fs::read_to_string("/proc/uptime").expect("a kernel's uptime");
        let uptime: f64 = uptime.split(' ').next().and_then(|n| n.parse().ok()).expect("seconds");
        let here = read_since_boot().as_secs_f64();
        assert!((here - uptime).abs() < 5.0, "{here} s, and {uptime} s by the kernel");
        let boot = BootId::read_from_kernel();
        assert!(boot.is_some() && boot == BootId::read_from_kernel());
        if env::var_os(INSIDE).is_some() {
            return;
        }
        let slept = |program: &str| {
            let mut command = Command::new("unshare");
            command.args(["--time", "--boottime", SLEPT, program]);
            command
        };
        let starts = slept("true").output().is_ok_and(|done| done.status.success());
        let can = starts.then_some(()).ok_or("no right to a time namespace (unshare --time)");
        if require_or_skip(can).expect("a right").is_none() {
            return;
        }
        let own = env::current_exe().expect("this test");
        let mut again = slept(own.to_str().expect("a path as text"));
        again.args(["--exact", "boot_clock::tests::sleep_is_counted"]).env(INSIDE, "1");
        let done = again.output().expect("it starts again");
        let told = String::from_utf8_lossy(&done.stdout);
        assert!(done.status.success() && told.contains("1 passed"), "{told}");
    }
}
