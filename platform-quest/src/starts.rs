//! The start volumes that the package brings along, so that a headset need not make them.

use paros_core::maps::Maps;
use paros_core::size::{Grid, Size};
use paros_shell::figures::Figure;
use paros_shell::rmap::{self, Fault};
use paros_shell::starts::StartVolumes;

/// Why the volumes of a package are not the ones to start from.
#[derive(Debug)]
pub enum Error {
    /// The package lacks one.
    Missing(String),
    /// One is damaged at a byte.
    Bad(String, usize, Fault),
}

/// What a figure's volume of a size is called in the package: an `.rmap`.
#[must_use]
pub fn asset<const N: usize>(figure: Figure) -> String {
    format!("starts/{N}/{}.rmap", figure.name())
}

/// Takes the figures from a package, where `open` finds the bytes of an asset by its name.
///
/// # Errors
/// One is missing or damaged. Then the volumes are still to be made.
pub fn load<const N: usize>(
    volumes: &mut StartVolumes<N>,
    open: impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    volumes.take(|figure, maps: &mut Maps<N>| {
        let name = asset::<N>(figure);
        let Some(bytes) = open(&name) else { return Err(Error::Missing(name)) };
        rmap::decode(&bytes, maps).map_err(|(at, fault)| Error::Bad(name, at, fault))
    })
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Error::Missing(name) => write!(f, "{name}: missing in the package"),
            Error::Bad(name, at, fault) => write!(f, "{name}: byte {at}: {fault}"),
        }
    }
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use paros_core::plane::Plane;
    use paros_shell::figures::Figure;
    use paros_shell::rmap;
    use paros_shell::starts::StartVolumes;

    use super::{Error, load};

    #[test]
    fn packaged_volumes_are_the_ones_that_would_be_made() {
        let [mut made, mut taken, mut broken] =
            [const { StartVolumes::<64>::new() }; 3].map(Box::new);
        made.make(&mut Plane::new(), |_| {});
        let made = &made;
        let bytes_of = |name: &str| {
            let named = |figure: &Figure| name == format!("starts/64/{}.rmap", figure.name());
            Some(rmap::encode(made.figure(Figure::ALL.into_iter().find(named)?)))
        };
        let asked = Cell::new(0);
        let open = |name: &str| {
            asked.set(asked.get() + 1);
            bytes_of(name)
        };
        load(&mut taken, open).expect("all are there");
        assert_eq!(asked.get(), Figure::ALL.len());
        for figure in Figure::ALL {
            assert_eq!(rmap::encode(taken.figure(figure)), rmap::encode(made.figure(figure)));
        }
        // They need not be made any more.
        taken.make(&mut Plane::new(), |_| panic!("made again"));

        let without = |name: &str| bytes_of(name).filter(|_| !name.contains("cat"));
        let why = load(&mut broken, without).expect_err("one is missing");
        assert!(matches!(&why, Error::Missing(name) if name == "starts/64/cat.rmap"));
        let cut = |name: &str| bytes_of(name).map(|bytes| bytes[..bytes.len() - 1].to_vec());
        let why = load(&mut broken, cut).expect_err("all are short");
        assert!(matches!(why, Error::Bad(..)), "{why}");
        let again = Cell::new(0);
        broken.make(&mut Plane::new(), |_| again.set(again.get() + 1));
        assert_eq!(again.get(), Figure::ALL.len());
    }
}
