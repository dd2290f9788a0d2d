//! The `.rmap` file: a round trip preserves it, every corruption is rejected, and files are written
//! atomically.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use paros_core::RangeMaps;
use paros_core::volume::{Axis, BitGrid, BitSet, Column, Range};
use paros_models::cases::scaled_cases;
use paros_shell::durable::{self, WriteTarget};
use paros_shell::figures::Figure;
use paros_shell::rmap::{self, RmapError, RmapFault, RmapFaultAt};
use proptest::prelude::*;

/// Bytes before the columns, after them, and of the columns at 16.
const HEADER: usize = 12;
const CHECKSUM: usize = 4;
const COLUMNS: usize = 3 * 16 * 16 * 2;

struct Buffers {
    maps: RangeMaps<16>,
    other: RangeMaps<16>,
    plane: BitGrid<16>,
}

fn lock_buffers() -> MutexGuard<'static, Buffers> {
    static BUFFERS: Mutex<Buffers> = Mutex::new(Buffers {
        maps: RangeMaps::new(),
        other: RangeMaps::new(),
        plane: BitGrid::new(),
    });
    BUFFERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Creates an empty folder for one test.
fn make_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("rmap-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Encodes a sample volume: the toy.
fn encode_toy() -> Vec<u8> {
    encode_toy_of(&mut lock_buffers())
}

/// Encodes the toy and leaves its maps in `buffers`.
fn encode_toy_of(buffers: &mut Buffers) -> Vec<u8> {
    let Buffers { maps, plane, .. } = buffers;
    Figure::Toy.rasterize_into(maps, plane);
    rmap::encode(maps)
}

/// Updates the checksum after a change.
fn update_checksum(bytes: &mut [u8]) {
    let at = bytes.len() - CHECKSUM;
    let sum = bitwise_crc32(&bytes[..at]);
    bytes[at..].copy_from_slice(&sum.to_le_bytes());
}

/// Computes the CRC-32 of IEEE 802.3 bit by bit.
fn bitwise_crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}

fn decode_refusal(bytes: &[u8]) -> (usize, RmapFault) {
    let mut b = lock_buffers();
    let Buffers { maps, other, plane } = &mut *b;
    static CAT: OnceLock<RangeMaps<16>> = OnceLock::new();
    let cat = CAT.get_or_init(|| {
        Figure::Cat.rasterize_into(maps, plane);
        maps.clone()
    });
    maps.copy_from(cat);
    other.copy_from(maps);
    let RmapFaultAt { offset, fault } = rmap::decode(bytes, maps).expect_err("must be refused");
    assert!(maps == other, "a refused file left its mark");
    (offset, fault)
}

#[test]
fn the_checksum_is_crc_32() {
    assert_eq!(bitwise_crc32(b"123456789"), 0xcbf4_3926);
    let bytes = encode_toy();
    let (summed, sum) = bytes.split_at(bytes.len() - CHECKSUM);
    assert_eq!(bitwise_crc32(summed).to_le_bytes(), sum);
}

#[test]
fn the_layout_is_as_documented() {
    let mut b = lock_buffers();
    let bytes = encode_toy_of(&mut b);
    assert_eq!(bytes.len(), HEADER + COLUMNS + CHECKSUM);
    assert_eq!(bytes[..HEADER], *b"RMAP\x01\x00\x10\x00\x01\x00\x00\x00");
    for axis in Axis::ALL {
        for (line, place) in (0..256).map(|i| (i / 16, i % 16)) {
            let at = HEADER + 2 * (256 * axis as usize + 16 * line + place);
            let range = b.maps.column(axis, (line, place)).hull();
            let expected = if range.is_empty() {
                [0, 0]
            } else {
                [!(range.first() as u8), range.last() as u8]
            };
            assert_eq!(bytes[at..at + 2], expected);
        }
    }
}

#[test]
fn each_kind_of_damage_is_named_with_its_place() {
    let good = encode_toy();
    let change = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        update_checksum(&mut bytes);
        decode_refusal(&bytes)
    };
    assert_eq!(change(0, b'r'), (0, RmapFault::Magic(*b"rMAP")));
    assert_eq!(change(4, 3), (4, RmapFault::Version(3)));
    assert_eq!(change(6, 17), (6, RmapFault::Size(17)));
    assert_eq!(change(6, 32), (6, RmapFault::OtherSize { found: 32, expected: 16 }));
    assert_eq!(change(8, 2), (8, RmapFault::Layers { version: 1, found: 2 }));
    assert_eq!(change(9, 1), (9, RmapFault::Flags(1)));
    assert_eq!(change(11, 9), (11, RmapFault::Flags(9)));
    let (at, fault) = change(HEADER + 1, 16);
    let address = (0, 0);
    assert_eq!((at, fault), (HEADER, RmapFault::Range { axis: Axis::X, address, bytes: [0, 16] }));

    let mut bytes = good.clone();
    bytes.push(0);
    assert_eq!(decode_refusal(&bytes), (good.len(), RmapFault::Trailing));
    let mut bytes = good.clone();
    bytes[40] ^= 4;
    let (at, fault) = decode_refusal(&bytes);
    assert_eq!(at, HEADER + COLUMNS);
    assert!(matches!(fault, RmapFault::Checksum { .. }));
}

#[test]
fn a_loose_end_is_named_with_its_voxel() {
    let mut b = lock_buffers();
    b.maps.clear();
    for axis in Axis::ALL {
        b.maps.set_column(axis, axis.column_address([3, 4, 5]), Column::new([Range::new(0, 0)]));
    }
    // One voxel at (3, 4, 5), except that the column along z extends to 6.
    for (axis, hi) in [(Axis::X, 3), (Axis::Y, 4), (Axis::Z, 6)] {
        let lo = [3, 4, 5][axis as usize];
        b.maps.set_column(axis, axis.column_address([3, 4, 5]), Column::new([Range::new(lo, hi)]));
    }
    let bytes = rmap::encode(&b.maps);
    drop(b);
    let (at, fault) = decode_refusal(&bytes);
    assert_eq!(at, HEADER + 2 * (2 * 256 + 4 * 16 + 3) + 1);
    assert_eq!(fault, RmapFault::Loose { axis: Axis::Z, voxel: [3, 4, 6], missing: Axis::X });
}

#[test]
fn a_file_cut_short_anywhere_is_refused() {
    let bytes = encode_toy();
    for length in 0..bytes.len() {
        let (at, fault) = decode_refusal(&bytes[..length]);
        assert_eq!(at, length, "{fault}");
        assert!(matches!(fault, RmapFault::Truncated { .. }));
    }
}

#[test]
fn any_flipped_bit_is_found() {
    let good = encode_toy();
    for bit in 0..good.len() * 8 {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let (at, _) = decode_refusal(&bytes);
        assert!(at <= bytes.len());
    }
}

#[test]
fn files_come_back_and_errors_name_them() {
    let folder = make_folder("files");
    let path = folder.join("toy.rmap");
    let mut b = lock_buffers();
    let bytes = encode_toy_of(&mut b);
    rmap::write(&path, &b.maps).unwrap();
    assert_eq!(fs::read(&path).unwrap(), bytes);
    let header = rmap::read_header(&path).unwrap();
    assert_eq!(
        (header.grid_side, header.intervals_per_column, header.file_length()),
        (16, 1, bytes.len())
    );
    let Buffers { maps, other, .. } = &mut *b;
    other.clear();
    rmap::read(&path, other).unwrap();
    assert!(maps == other);
    assert_eq!(rmap::volume_checksum(maps), u32::from_le_bytes(*bytes.last_chunk().unwrap()));

    fs::write(&path, &bytes[..700]).unwrap();
    let error = rmap::read(&path, other).unwrap_err();
    assert!(matches!(error, RmapError::Bad { offset: 700, .. }));
    let text = error.to_string();
    assert!(text.contains("toy.rmap") && text.contains("byte 700"), "{text}");
    let text = rmap::read_header(&folder.join("none.rmap")).unwrap_err().to_string();
    assert!(text.contains("none.rmap"), "{text}");
    assert!(rmap::read(&folder, other).is_err(), "a folder is no file");
    assert!(maps == other);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(scaled_cases(3000)))]

    /// A file is accepted exactly if its ranges are the hulls of their own intersection.
    #[test]
    fn ranges_are_read_when_tight(
        voxels in prop::collection::vec(prop::array::uniform3(0usize..16), 0..40),
        changes in prop::collection::vec((0..COLUMNS / 2, 0usize..16, 0usize..16), 0..3),
    ) {
        let mut b = lock_buffers();
        let Buffers { maps, other, plane } = &mut *b;
        plane.clear();
        for [x, y, z] in voxels {
            plane.row_mut(y, z).insert(x);
        }
        plane.write_hulls(maps);
        for (column, lo, hi) in changes {
            let (axis, address) = (Axis::ALL[column / 256], (column / 16 % 16, column % 16));
            maps.set_column(axis, address, Column::new([Range::new(lo, hi)]));
        }
        plane.set_from_maps(maps);
        plane.write_hulls(other);
        let tight = maps == other;
        let bytes = rmap::encode(maps);
        other.clear();
        let read = rmap::decode(&bytes, other);
        prop_assert_eq!(read.is_ok(), tight);
        if tight {
            prop_assert!(maps == other);
        } else {
            prop_assert!(other.is_empty());
        }
    }

    /// Arbitrary bytes are rejected or read, without a panic.
    #[test]
    fn any_columns_are_no_reason_to_panic(
        mut columns in prop::collection::vec(any::<u8>(), COLUMNS),
        sparse in any::<bool>(),
    ) {
        if sparse {
            columns.iter_mut().for_each(|byte| *byte = if *byte < 250 { 0 } else { *byte });
        }
        let mut bytes = b"RMAP\x01\x00\x10\x00\x01\x00\x00\x00".to_vec();
        bytes.extend(columns);
        bytes.extend([0; CHECKSUM]);
        update_checksum(&mut bytes);
        let mut b = lock_buffers();
        b.other.clear();
        if rmap::decode(&bytes, &mut b.other).is_ok() {
            prop_assert_eq!(rmap::encode(&b.other), bytes);
        } else {
            prop_assert!(b.other.is_empty());
        }
    }
}

/// Lists the file names in a folder.
fn file_names(folder: &Path) -> Vec<String> {
    let name = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| name(entry.unwrap())).collect();
    names.sort();
    names
}

#[test]
fn a_file_is_replaced_when_its_bytes_are_there_and_not_before() {
    let folder = make_folder("target");
    let path = folder.join("file");
    durable::write_file(&path, b"old").unwrap();
    let (a, b) = (
        WriteTarget::resolve_and_check_writable(&path).unwrap(),
        WriteTarget::resolve_and_check_writable(&path).unwrap(),
    );
    assert_eq!(file_names(&folder), ["file"], "nothing is there to be left behind");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    a.write_file(b"first").unwrap();
    b.write_file(b"second").unwrap();
    assert_eq!(file_names(&folder), ["file"]);
    assert_eq!(fs::read(&path).unwrap(), b"second");
}

#[test]
fn of_several_files_all_are_written_or_none() {
    let folder = make_folder("several");
    fs::create_dir(folder.join("sub")).unwrap();
    let target = |name: &str| WriteTarget::resolve(&folder.join(name)).unwrap();
    let files = [(target("a"), &b"1"[..]), (target("sub/b"), b""), (target("c"), b"3")];
    fs::remove_dir(folder.join("sub")).unwrap();
    let error = durable::write_files(&files).unwrap_err();
    assert_eq!(error.path, folder.join("sub/b"));
    assert!(file_names(&folder).is_empty(), "{:?}", file_names(&folder));
    fs::create_dir(folder.join("sub")).unwrap();
    durable::write_files(&files).unwrap();
    assert_eq!(file_names(&folder), ["a", "c", "sub"]);
    assert_eq!(fs::read(folder.join("c")).unwrap(), b"3");
    assert_eq!(file_names(&folder.join("sub")), ["b"]);
}

#[test]
fn names_of_the_longest_length_are_written_and_longer_ones_refused() {
    let folder = make_folder("long");
    let longest = "n".repeat(255);
    durable::write_file(&folder.join(&longest), b"x").unwrap();
    assert_eq!(file_names(&folder), std::slice::from_ref(&longest));
    let longer = folder.join(longest + "n");
    for error in [
        WriteTarget::resolve(&longer).unwrap_err(),
        durable::write_file(&longer, b"x").unwrap_err(),
    ] {
        assert_eq!(error.source.kind(), std::io::ErrorKind::InvalidFilename, "{error}");
        assert_eq!(error.path, longer);
    }
}

#[test]
fn what_cannot_be_written_is_refused_by_name() {
    let folder = make_folder("refused");
    for path in [
        folder.join("none/file"),
        folder.clone(),
        PathBuf::from("/"),
        PathBuf::new(),
        folder.join("name/"),
    ] {
        let error = durable::write_file(&path, b"x").unwrap_err();
        assert_eq!(error.path, path);
        assert!(error.to_string().contains(&*path.to_string_lossy()));
    }
    assert!(file_names(&folder).is_empty());
}

#[cfg(unix)]
#[test]
fn links_stay_links_and_devices_stay_devices() {
    use std::os::unix::fs::FileTypeExt;
    let folder = make_folder("links");
    let (file, link) = (folder.join("file"), folder.join("link"));
    fs::write(&file, b"old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    durable::write_file(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&file).unwrap(), b"new");
    let target = |name: &str| WriteTarget::resolve(&folder.join(name)).unwrap();
    assert!(target("link").is_same_file(&target("file")));
    assert!(target("./new").is_same_file(&target("new")));
    assert!(!target("new").is_same_file(&target("file")));
    for nowhere in ["gone", "loop"] {
        let link = folder.join("to-".to_owned() + nowhere);
        let to = if nowhere == "loop" { link.clone() } else { folder.join(nowhere) };
        std::os::unix::fs::symlink(to, &link).unwrap();
        let error = durable::write_file(&link, b"new").unwrap_err();
        assert!(error.to_string().contains("link that leads nowhere"), "{error}");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }
    assert_eq!(file_names(&folder), ["file", "link", "to-gone", "to-loop"]);
    assert!(durable::write_file(Path::new("/dev/null"), b"x").is_err());
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}
