//! What Android's libraries offer, and since when.

use std::collections::BTreeMap;

/// The list of `symbols.txt`: by a symbol's name the library that has it, and the API level it came
/// with.
#[derive(Debug, Clone)]
pub(crate) struct Symbols(BTreeMap<&'static str, Home>);

/// Where a symbol is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Home {
    /// The library, `libc` say.
    pub(crate) library: &'static str,
    /// The first API level that has it; 21 stands for all before.
    pub(crate) since: u32,
}

impl Symbols {
    /// The whole list.
    pub(crate) fn all() -> Self {
        let mut symbols = BTreeMap::new();
        let mut home = Home { library: "", since: 0 };
        for line in include_str!("symbols.txt").lines().filter(|line| !line.starts_with('#')) {
            if line.starts_with(' ') {
                symbols.extend(line.split_whitespace().map(|name| (name, home)));
            } else if let Some((library, since)) = line.split_once(' ') {
                home = Home { library, since: since.parse().unwrap_or(u32::MAX) };
            }
        }
        Symbols(symbols)
    }

    /// Where a symbol is found, if anywhere.
    pub(crate) fn home(&self, name: &str) -> Option<Home> {
        self.0.get(name).copied()
    }

    /// The libraries' names.
    pub(crate) fn libraries(&self) -> Vec<&'static str> {
        let mut names: Vec<_> = self.0.values().map(|home| home.library).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// What a library offers at an API level.
    pub(crate) fn of(&self, library: &str, level: u32) -> impl Iterator<Item = &'static str> {
        let offered = move |home: &Home| home.library == library && home.since <= level;
        self.0.iter().filter(move |(_, home)| offered(home)).map(|(name, _)| *name)
    }

    /// Forgets a symbol.
    #[cfg(test)]
    pub(crate) fn without(mut self, name: &str) -> Self {
        assert!(self.0.remove(name).is_some(), "{name} is not listed");
        self
    }
}

#[cfg(test)]
mod tests {
    use super::{Home, Symbols};

    #[test]
    fn the_list_is_read() {
        let symbols = Symbols::all();
        assert_eq!(symbols.libraries(), ["libandroid", "libc", "libdl", "liblog", "libm"]);
        assert_eq!(symbols.home("getrandom"), Some(Home { library: "libc", since: 28 }));
        assert_eq!(symbols.home("dlopen"), Some(Home { library: "libdl", since: 21 }));
        assert_eq!(symbols.home("no_such_function"), None);
        assert!(symbols.0.values().all(|home| (21..=34).contains(&home.since)));
        let has = |level| symbols.of("libandroid", level).any(|name| name == "AInputEvent_release");
        assert!(!has(30) && has(31));
    }
}
