//! Token buckets: how often somebody may ask.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Whoever asks that a limiter remembers. Where there are more it forgets those who may ask as often as anybody.
const MAX_BUCKETS: usize = 4096;

/// A bucket for each of those who ask.
pub(crate) struct RateLimiter<K> {
    /// Requests at once.
    burst: f32,
    /// Requests a second in the long run.
    per_second: f32,
    buckets: Mutex<HashMap<K, Bucket>>,
}

struct Bucket {
    left: f32,
    at: Instant,
}

impl<K: Eq + Hash> RateLimiter<K> {
    /// Of full buckets.
    #[must_use]
    pub(crate) fn new(burst: u16, per_second: f32) -> Self {
        RateLimiter { burst: burst.into(), per_second, buckets: Mutex::default() }
    }

    /// Takes a request from somebody's bucket; false where none is left.
    pub(crate) fn take(&self, who: K, now: Instant) -> bool {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= MAX_BUCKETS && !buckets.contains_key(&who) {
            buckets.retain(|_, bucket| self.fill(bucket, now) < self.burst);
            if buckets.len() >= MAX_BUCKETS {
                return false;
            }
        }
        let bucket = buckets.entry(who).or_insert(Bucket { left: self.burst, at: now });
        bucket.left = self.fill(bucket, now);
        bucket.at = now;
        let is_there = bucket.left >= 1.0;
        if is_there {
            bucket.left -= 1.0;
        }
        is_there
    }

    fn fill(&self, bucket: &Bucket, now: Instant) -> f32 {
        let seconds = now.saturating_duration_since(bucket.at).as_secs_f32();
        (bucket.left + seconds * self.per_second).min(self.burst)
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::{MAX_BUCKETS, RateLimiter};

    #[test]
    fn a_burst_goes_through_and_then_so_many_a_second() {
        let limiter = RateLimiter::new(3, 2.0);
        let start = Instant::now();
        let count = |who, now| (0..9).filter(|_| limiter.take(who, now)).count();
        assert_eq!(count(1, start), 3);
        assert_eq!(count(2, start), 3, "each has a bucket");
        assert_eq!(count(1, start + Duration::from_secs(1)), 2);
        assert_eq!(count(1, start + Duration::from_secs(99)), 3, "it fills no further");
    }

    #[test]
    fn many_who_ask_take_no_more_memory() {
        let limiter = RateLimiter::new(2, 1.0);
        let start = Instant::now();
        assert!((0..MAX_BUCKETS).all(|who| limiter.take(who, start)));
        assert!(!limiter.take(MAX_BUCKETS, start), "all are remembered");
        let later = start + Duration::from_secs(9);
        assert!(limiter.take(MAX_BUCKETS, later), "they are forgotten when their buckets are full");
        assert!(limiter.buckets.lock().unwrap().len() < 9);
    }
}
