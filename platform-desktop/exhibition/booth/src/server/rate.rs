//! Rate limits by token buckets.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The most buckets that a limiter remembers: some hundred kilobytes. Beyond, it forgets the fullest one.
const MAX_BUCKETS: usize = 4096;

/// A rate limiter with a token bucket for each client.
pub(crate) struct RateLimiter<K> {
    /// The most requests at once: the size of a bucket.
    burst: f32,
    /// The sustained number of requests a second: the rate at which a bucket fills.
    per_second: f32,
    buckets: Mutex<HashMap<K, Bucket>>,
}

struct Bucket {
    left: f32,
    at: Instant,
}

impl<K: Eq + Hash + Clone> RateLimiter<K> {
    /// Makes a limiter whose buckets are full.
    #[must_use]
    pub(crate) fn new(burst: u16, per_second: f32) -> Self {
        RateLimiter { burst: burst.into(), per_second, buckets: Mutex::default() }
    }

    /// Takes a request from a client's bucket. Returns `false` if the bucket is empty.
    pub(crate) fn take(&self, who: K, now: Instant) -> bool {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= MAX_BUCKETS && !buckets.contains_key(&who) {
            buckets.retain(|_, bucket| self.fill(bucket, now) < self.burst);
            if buckets.len() >= MAX_BUCKETS {
                let left = |bucket: &Bucket| self.fill(bucket, now);
                let fullest = buckets.iter().max_by(|a, b| left(a.1).total_cmp(&left(b.1)));
                let fullest = fullest.map(|(who, _)| who.clone());
                fullest.and_then(|who| buckets.remove(&who));
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

    /// Returns the number of requests that are missing from a client's bucket.
    pub(crate) fn used(&self, who: &K, now: Instant) -> f32 {
        let buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        buckets.get(who).map_or(0.0, |bucket| self.burst - self.fill(bucket, now))
    }

    /// Gives a taken request back to a client's bucket.
    pub(crate) fn give_back(&self, who: &K) {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(bucket) = buckets.get_mut(who) {
            bucket.left = (bucket.left + 1.0).min(self.burst);
        }
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
    fn what_is_given_back_is_there_again() {
        let limiter = RateLimiter::new(2, 1.0);
        let start = Instant::now();
        assert!(limiter.take(1, start) && limiter.take(1, start) && !limiter.take(1, start));
        assert_eq!((limiter.used(&1, start), limiter.used(&2, start)), (2.0, 0.0));
        limiter.give_back(&1);
        assert_eq!(limiter.used(&1, start), 1.0);
        assert!(limiter.take(1, start) && !limiter.take(1, start));
        assert_eq!(limiter.used(&1, start + Duration::from_millis(500)), 1.5);
    }

    #[test]
    fn many_who_ask_take_no_more_memory() {
        let limiter = RateLimiter::new(2, 1.0);
        let start = Instant::now();
        assert!((0..MAX_BUCKETS).all(|who| limiter.take(who, start)));
        assert!(limiter.take(7, start) && !limiter.take(7, start), "all are remembered");
        for who in MAX_BUCKETS..MAX_BUCKETS + 9 {
            assert!(limiter.take(who, start), "others have their turn");
        }
        assert_eq!(limiter.buckets.lock().unwrap().len(), MAX_BUCKETS);
        assert!(!limiter.take(7, start), "who has none left is remembered");
        let later = start + Duration::from_secs(9);
        assert!(
            limiter.take(2 * MAX_BUCKETS, later),
            "they are forgotten when their buckets are full"
        );
        assert!(limiter.buckets.lock().unwrap().len() < 9);
    }
}
