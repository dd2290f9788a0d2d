//! The open connections of a listener. Decides which one is closed to make room for a new one.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use tokio::sync::Notify;

/// The most connections at once: two for each of 256 headsets, and 128 for staff, visitors and unknown
/// clients.
pub(crate) const MAX_CONNECTIONS: usize = 640;

/// The connections that a headset keeps when the limit is reached: one for heartbeats, one for a parcel.
const KEPT_OF_HEADSET: usize = 2;

/// The connections that an account keeps when the limit is reached: a browser opens six at once, and an
/// account may be used on two tablets.
const KEPT_OF_ACCOUNT: usize = 12;

/// The connections that the link of a sculpture keeps when the limit is reached: a browser opens six at once.
const KEPT_OF_LINK: usize = 6;

/// The holder of a connection: its network, until a request on it is authenticated.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Holder {
    /// A network without an authenticated request.
    Network(IpAddr),
    /// An enrolled headset.
    Headset(u32),
    /// A logged-in account.
    Account(String),
    /// A visitor with the link of this sculpture.
    Link([u8; 16]),
}

impl Holder {
    const fn kept(&self) -> usize {
        match self {
            Holder::Network(_) => 0,
            Holder::Headset(_) => KEPT_OF_HEADSET,
            Holder::Account(_) => KEPT_OF_ACCOUNT,
            Holder::Link(_) => KEPT_OF_LINK,
        }
    }
}

/// All open connections of a listener.
///
/// At the limit, a new connection closes another one: of the holder that exceeds its kept connections by
/// most, the one whose last request is oldest. So idle connections are closed first, a holder of many
/// connections loses its own, and the kept connections of a headset, an account or a link are never closed
/// for others.
pub(crate) struct Connections {
    most: usize,
    open: Mutex<Table>,
}

#[derive(Default)]
struct Table {
    next: u64,
    entries: HashMap<u64, Entry>,
}

struct Entry {
    holder: Holder,
    used_at: Instant,
    close: Arc<Notify>,
}

/// An open connection. Dropping it frees its place.
pub(crate) struct Connection {
    all: Arc<Connections>,
    number: u64,
    close: Arc<Notify>,
}

impl Connections {
    #[must_use]
    pub(crate) fn new(most: usize) -> Self {
        Connections { most, open: Mutex::default() }
    }

    /// Opens a connection. At the limit, closes another one; returns `None` if none may be closed.
    pub(crate) fn open(self: &Arc<Self>, holder: Holder, now: Instant) -> Option<Arc<Connection>> {
        let close = Arc::new(Notify::new());
        let mut table = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if table.entries.len() >= self.most {
            let number = table.find_closable()?;
            table.entries.remove(&number)?.close.notify_one();
        }
        let number = table.next;
        table.next += 1;
        table.entries.insert(number, Entry { holder, used_at: now, close: close.clone() });
        Some(Arc::new(Connection { all: self.clone(), number, close }))
    }

    fn change(&self, number: u64, change: impl FnOnce(&mut Entry)) {
        let mut table = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        // A connection that is about to be closed has no entry any more.
        if let Some(entry) = table.entries.get_mut(&number) {
            change(entry);
        }
    }
}

impl Table {
    /// Finds the connection to close to make room for a new one.
    fn find_closable(&self) -> Option<u64> {
        let mut counts = HashMap::<&Holder, usize>::new();
        for entry in self.entries.values() {
            *counts.entry(&entry.holder).or_default() += 1;
        }
        let excess = |entry: &Entry| counts[&entry.holder].saturating_sub(entry.holder.kept());
        let closable = self.entries.iter().filter(|(_, entry)| excess(entry) > 0);
        let found = closable.max_by_key(|(_, entry)| (excess(entry), Reverse(entry.used_at)));
        found.map(|(number, _)| *number)
    }
}

impl Connection {
    /// Sets the connection's holder, after a request on it was authenticated.
    pub(crate) fn hold(&self, holder: Holder) {
        self.all.change(self.number, |entry| entry.holder = holder);
    }

    /// Notes the begin of a request.
    pub(crate) fn touch(&self, now: Instant) {
        self.all.change(self.number, |entry| entry.used_at = now);
    }

    /// Waits until the connection has to close to make room for another one.
    pub(crate) async fn closed(&self) {
        self.close.notified().await;
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        let mut table = self.all.open.lock().unwrap_or_else(PoisonError::into_inner);
        table.entries.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use std::net::IpAddr;
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    use futures_util::FutureExt as _;

    use super::{Connection, Connections, Holder, KEPT_OF_ACCOUNT, KEPT_OF_HEADSET, KEPT_OF_LINK};

    /// A table with a limit, its clock, and its connections in order of arrival.
    struct Rig {
        all: Arc<Connections>,
        now: Instant,
        came: Vec<Option<Arc<Connection>>>,
    }

    impl Rig {
        fn new(most: usize) -> Self {
            Rig { all: Arc::new(Connections::new(most)), now: Instant::now(), came: Vec::new() }
        }

        fn open(&mut self, holder: &Holder) -> bool {
            self.now += Duration::from_secs(1);
            self.came.push(self.all.open(holder.clone(), self.now));
            self.came.last().is_some_and(Option::is_some)
        }

        /// Takes the connections that have to close. Returns their places in the order of arrival.
        fn take_closed(&mut self) -> Vec<usize> {
            let must_close = |came: &Option<Arc<Connection>>| {
                came.as_ref().is_some_and(|open| open.closed().now_or_never().is_some())
            };
            let closed: Vec<usize> =
                (0..self.came.len()).filter(|k| must_close(&self.came[*k])).collect();
            closed.iter().for_each(|k| self.came[*k] = None);
            closed
        }
    }

    fn network(last: u8) -> Holder {
        Holder::Network(IpAddr::from([10, 0, 0, last]))
    }

    #[test]
    fn who_has_most_makes_room_with_what_is_idle_for_longest() {
        let mut rig = Rig::new(6);
        for holder in [network(1), network(2), network(2), network(1), network(1), network(3)] {
            assert!(rig.open(&holder));
        }
        rig.now += Duration::from_secs(1);
        rig.came[0].as_ref().expect("it is open").touch(rig.now);
        assert_eq!(rig.take_closed(), [0; 0]);
        assert!(rig.open(&network(4)));
        assert_eq!(rig.take_closed(), [3], "10.0.0.1 has three, and the first was just used");
        assert!(rig.open(&network(3)), "three networks have two each");
        assert_eq!(rig.take_closed(), [1]);
        rig.came[2] = None;
        assert!(rig.open(&network(5)));
        assert_eq!(rig.take_closed(), [0; 0], "one was closed by itself");
    }

    #[test]
    fn who_proved_who_they_are_stays() {
        let places = KEPT_OF_ACCOUNT + KEPT_OF_HEADSET + KEPT_OF_LINK;
        let mut rig = Rig::new(places);
        let ana = Holder::Account("ana".into());
        let (headset, link) = (Holder::Headset(1), Holder::Link([1; 16]));
        for (holder, kept) in
            [(&ana, KEPT_OF_ACCOUNT), (&headset, KEPT_OF_HEADSET), (&link, KEPT_OF_LINK)]
        {
            for _ in 0..kept {
                // Each connection is a stranger's at first.
                assert!(rig.open(&network(1)));
                let open = rig.came.last().and_then(Option::as_ref);
                open.expect("there is room").hold(holder.clone());
            }
        }
        assert!(!rig.open(&network(1)), "all are kept");
        rig.came[0] = None;
        for _ in 0..3 {
            assert!(rig.open(&network(1)), "strangers have a place that they take from each other");
        }
        assert_eq!(rig.take_closed().len(), 2);
        let last = rig.came.last().and_then(Option::as_ref);
        last.expect("it is open").hold(headset.clone());
        assert!(rig.open(&network(1)), "a headset has one more than it keeps");
        assert_eq!(rig.take_closed(), [KEPT_OF_ACCOUNT], "its oldest one");
    }

    #[test]
    fn places_are_given_back() {
        let mut rig = Rig::new(3);
        for last in 0..9 {
            assert!(rig.open(&network(last)));
        }
        rig.take_closed();
        rig.came.clear();
        assert!(rig.all.open.lock().unwrap().entries.is_empty());
    }
}
