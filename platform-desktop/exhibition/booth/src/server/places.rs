//! A concurrency limit for each client.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, PoisonError};

/// The number of places that each client has taken.
pub(crate) struct Places<K> {
    most_of_one: usize,
    counts: Mutex<HashMap<K, usize>>,
}

/// A place. It is given back on drop.
pub(crate) struct Place<K: Eq + Hash> {
    places: Arc<Places<K>>,
    who: K,
}

impl<K: Eq + Hash + Copy> Places<K> {
    pub(crate) fn new(most_of_one: usize) -> Self {
        Places { most_of_one, counts: Mutex::default() }
    }

    /// Takes a place for a client. Returns `None` if the client has taken all of its places.
    pub(crate) fn take(self: &Arc<Self>, who: K) -> Option<Place<K>> {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        let count = counts.get(&who).copied().unwrap_or(0);
        if count >= self.most_of_one {
            return None;
        }
        counts.insert(who, count + 1);
        Some(Place { places: self.clone(), who })
    }
}

impl<K: Eq + Hash> Drop for Place<K> {
    fn drop(&mut self) {
        let mut counts = self.places.counts.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = counts.get_mut(&self.who) {
            *count -= 1;
            if *count == 0 {
                counts.remove(&self.who);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::Places;

    #[test]
    fn each_has_so_many() {
        let places = Arc::new(Places::new(2));
        let take = |who| places.take(who);
        let mut taken: Vec<_> = [1, 1, 2, 2].map(|who| take(who).expect("one is left")).into();
        assert!(take(1).is_none() && take(2).is_none(), "each has two");
        taken.remove(0);
        assert!(take(1).is_some(), "one was given back");
        drop(taken);
        assert!(places.counts.lock().unwrap().is_empty());
    }
}
