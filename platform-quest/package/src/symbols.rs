//! The symbols that Android's libraries export, and the API levels that introduced them.

use std::collections::BTreeMap;

/// The list of `symbols.txt`: maps a symbol's name to its library and the API level that introduced it.
#[derive(Debug, Clone)]
pub(crate) struct Symbols(BTreeMap<&'static str, SymbolOrigin>);

/// The library and the API level that a symbol comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SymbolOrigin {
    /// The library, for instance `libc`.
    pub(crate) library: &'static str,
    /// The first API level that has the symbol; 21 also stands for all earlier ones.
    pub(crate) since: u32,
}

impl Symbols {
    /// Loads the whole list.
    pub(crate) fn load_all() -> Self {
        let mut symbols = BTreeMap::new();
        let mut origin = SymbolOrigin { library: "", since: 0 };
        for line in include_str!("symbols.txt").lines().filter(|line| !line.starts_with('#')) {
            if line.starts_with(' ') {
                symbols.extend(line.split_whitespace().map(|name| (name, origin)));
            } else if let Some((library, since)) = line.split_once(' ') {
                origin = SymbolOrigin { library, since: since.parse().unwrap_or(u32::MAX) };
            }
        }
        Symbols(symbols)
    }

    /// Returns the origin of a symbol, if Android has it.
    pub(crate) fn find_origin(&self, name: &str) -> Option<SymbolOrigin> {
        self.0.get(name).copied()
    }

    /// Returns the libraries' names.
    pub(crate) fn libraries(&self) -> Vec<&'static str> {
        let mut names: Vec<_> = self.0.values().map(|origin| origin.library).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Returns the symbols that a library exports at an API level.
    pub(crate) fn exported_by(
        &self,
        library: &str,
        api_level: u32,
    ) -> impl Iterator<Item = &'static str> {
        let offered =
            move |origin: &SymbolOrigin| origin.library == library && origin.since <= api_level;
        self.0.iter().filter(move |(_, origin)| offered(origin)).map(|(name, _)| *name)
    }

    /// Returns the list without one symbol.
    #[cfg(test)]
    pub(crate) fn without(mut self, name: &str) -> Self {
        assert!(self.0.remove(name).is_some(), "{name} is not listed");
        self
    }
}

#[cfg(test)]
mod tests {
    use super::{SymbolOrigin, Symbols};

    #[test]
    fn the_list_is_read() {
        let symbols = Symbols::load_all();
        assert_eq!(symbols.libraries(), ["libandroid", "libc", "libdl", "liblog", "libm"]);
        assert_eq!(
            symbols.find_origin("getrandom"),
            Some(SymbolOrigin { library: "libc", since: 28 })
        );
        assert_eq!(
            symbols.find_origin("dlopen"),
            Some(SymbolOrigin { library: "libdl", since: 21 })
        );
        assert_eq!(symbols.find_origin("no_such_function"), None);
        assert!(symbols.0.values().all(|origin| (21..=34).contains(&origin.since)));
        let has = |level| {
            symbols.exported_by("libandroid", level).any(|name| name == "AInputEvent_release")
        };
        assert!(!has(30) && has(31));
    }
}
