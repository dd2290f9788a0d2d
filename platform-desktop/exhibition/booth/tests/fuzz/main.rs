//! Fuzz targets of the crate `tests/fuzz` for the booth's parsers of untrusted input. As a test, each target
//! takes a second or two; `.ci/nightly` gives each a minute.

mod samples;

use std::fs;
use std::path::Path;

use paros_booth::{check_parcel, internals};
use paros_booth_rules::{BoothTime, Deletion};
use paros_protocol::{ContentHash, ParcelFault, SculptureId, UploadFacts};
use paros_tests_fuzz::engine::FuzzTarget;
use paros_tests_fuzz::fuzz_tests;

use samples::{archive, deflate, list, tetrahedron, upload_seed};

const TARGETS: [FuzzTarget; 8] =
    [UPLOAD, MESH, ESTIMATE, PRINTER, PRINTERS, DELETIONS, BACKUP, REQUEST];

fuzz_tests! { TARGETS => upload mesh estimate printer printers deletions backup request }

/// The input is a parcel whose files aren't compressed. The target compresses them, so that their contents
/// are fuzzed.
const UPLOAD: FuzzTarget = FuzzTarget {
    name: "upload",
    seeds: || vec![upload_seed()],
    words: &[b"\0\0\x80\x7f", b"\xff\xff\xff\xff", b"\x40\0", b"\x01\0"],
    longest: 8192,
    runs: 2000,
    run: |bytes| {
        let (facts, first) = match UploadFacts::split_head(bytes) {
            Ok(parts) => parts,
            Err(ParcelFault::Head(why)) => return why.to_string(),
            Err(_) => return "no head".into(),
        };
        // A longer one is refused before it is unpacked.
        let packed = if facts.trace_bytes % 2 == 0 { deflate(first) } else { first.to_vec() };
        let facts = UploadFacts {
            volume_bytes: packed.len() as u32,
            volume_raw_bytes: if facts.sculpting_seconds == 0 {
                facts.volume_raw_bytes
            } else {
                first.len() as u32
            },
            trace_bytes: 0,
            trace_raw_bytes: 0,
            ..facts
        };
        let checked = check_parcel(&facts, &packed, &[]);
        let kept = [&facts.to_head()[..], &packed].concat();
        // A kept parcel results in a mesh or an error, never in a panic.
        match (checked, internals::make_stl(&kept)) {
            (Ok(()), Ok(_)) => "a mesh".into(),
            (Ok(()), Err(why)) => format!("kept, {why}"),
            (Err(why), _) => why,
        }
    },
};

/// The input is the position at which an STL is split in two, and the STL.
const MESH: FuzzTarget = FuzzTarget {
    name: "mesh",
    seeds: || vec![[&[90][..], &tetrahedron()].concat()],
    words: &[b"\0\0\x80\x7f", b"\0\0\xc0\x7f", b"\x04\0\0\0", b"\0\0\0\x80"],
    longest: 2048,
    runs: 20_000,
    run: |bytes| {
        let Some((&at, stl)) = bytes.split_first() else { return "nothing".into() };
        let (first, second) = stl.split_at(usize::from(at).min(stl.len()));
        let checked = internals::check_stl(first, second);
        // The result doesn't depend on the position.
        assert_eq!(checked, internals::check_stl(stl, &[]));
        match checked {
            Ok((is_closed, triangles, of_3mf)) => {
                assert_eq!(84 + 50 * triangles as usize, stl.len());
                assert!(of_3mf <= triangles as usize);
                format!("closed: {is_closed}")
            }
            Err(why) => why,
        }
    },
};

const ESTIMATE: FuzzTarget = FuzzTarget {
    name: "estimate",
    seeds: || {
        let text: &[u8] = b"G1 X0\n; total filament used [g] = 29.41\n; estimated printing time (normal mode) = 1d 2h 3m 4s\n";
        vec![text.into()]
    },
    words: &[
        b"; total filament used [g] = ",
        b"; estimated printing time (normal mode) = ",
        b"99999999999d ",
        b"\xcf\x8e",
        b"NaN",
        b"inf",
        b"1e400",
        b"-",
    ],
    longest: 2048,
    runs: 30_000,
    run: |bytes| match internals::parse_estimate(&String::from_utf8_lossy(bytes)) {
        Some((minutes, tenths_gram)) => {
            assert!((1..=144_000).contains(&minutes) && tenths_gram <= 10_000_000);
            "a print".into()
        }
        None => "nothing".into(),
    },
};

/// The input is one response body, or two separated by a zero byte.
const PRINTER: FuzzTarget = FuzzTarget {
    name: "printer",
    seeds: || {
        let moonraker: &[u8] = br#"{"result":{"status":{"print_stats":{"state":"printing","filename":"a.gcode"},"virtual_sdcard":{"progress":0.42}}}}"#;
        let prusalink: &[u8] = b"{\"printer\":{\"state\":\"PRINTING\"}}\0{\"id\":9,\"progress\":42.5,\"file\":{\"name\":\"A~1.GCO\",\"display_name\":\"a.gcode\"}}";
        vec![moonraker.into(), prusalink.into(), b"{\"printer\":{\"state\":\"IDLE\"}}\0null".into()]
    },
    words: &[
        b"\"complete\"",
        b"\"cancelled\"",
        b"\"error\"",
        b"\"FINISHED\"",
        b"\"STOPPED\"",
        b"null",
        b"1e999",
        b"-1",
        b"[[[[[[[[",
        b"{\"",
        b"\"\\ud800\"",
        b"\0",
    ],
    longest: 4096,
    runs: 30_000,
    run: |bytes| {
        let mut answers = bytes.splitn(2, |byte| *byte == 0);
        let (first, second) = (answers.next().unwrap_or_default(), answers.next());
        match internals::read_printer(first, second) {
            Some((activity, file, percent)) => {
                assert!(percent.is_none_or(|percent| percent <= 100 && activity == "Printing"));
                format!("{activity} {} {}", file.is_some(), percent.is_some())
            }
            None => "nothing".into(),
        }
    },
};

const PRINTERS: FuzzTarget = FuzzTarget {
    name: "printers",
    seeds: || {
        let text: &[u8] = b"[[printer]]\nname = \"Left\"\nkind = \"moonraker\"\naddress = \"http://10.0.0.7\"\n[[printer]]\nname = \"Right\"\nkind = \"prusalink\"\naddress = \"https://right.example\"\nca = \"ca.pem\"\nkey = \"hunter2\"\nstorage = \"usb\"\n";
        vec![text.into()]
    },
    words: &[
        b"[[printer]]\n",
        b"name = \"\xce\xb1\"\n",
        b"storage = '../x'\n",
        b"http://",
        b"https://",
        b"\"\"\"",
        b"\n",
        b"=",
        b"#",
        b"\\u0000",
    ],
    longest: 4096,
    runs: 5000,
    run: |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return "no text".into() };
        match internals::parse_printers(text) {
            Ok(count) => {
                assert!(count <= 32);
                format!("printers: {}", count.min(3))
            }
            Err(why) => {
                assert!(!why.contains("hunter2"), "it tells the key: {why}");
                why
            }
        }
    },
};

const DELETIONS: FuzzTarget = FuzzTarget {
    name: "deletions",
    seeds: || {
        let deletion = |badge| {
            let (id, hash) = (SculptureId([3; 16]), ContentHash([7; 32]));
            Deletion { id, headset: 1, hash, badge, deleted_at: BoothTime(1_790_000_000_000) }
        };
        let lines = [deletion(None), deletion(Some(77))].map(|line| line.to_line()).concat();
        vec![lines.clone().into_bytes(), lines.as_bytes()[..lines.len() - 9].to_vec()]
    },
    words: &[b"\n", b" ", b"-", b"+1", b"4294967296", b"18446744073709551616", b"\xff"],
    longest: 1024,
    runs: 20_000,
    run: |bytes| match internals::parse_deletions(bytes.to_vec()) {
        Ok(read) => {
            // Written again, the entries parse as the same. An incomplete last line is not an entry.
            let lines: String = read.iter().map(Deletion::to_line).collect();
            assert_eq!(internals::parse_deletions(lines.into_bytes()).as_ref(), Ok(&read));
            assert!(read.len() <= bytes.iter().filter(|byte| **byte == b'\n').count());
            format!("lines: {}", read.len().min(3))
        }
        Err(why) => why,
    },
};

/// The input is an archive. Whatever it contains, only the files of a backup are written, and only into the
/// folder.
const BACKUP: FuzzTarget = FuzzTarget {
    name: "backup",
    seeds: || {
        let (id, hash) = ("ab".repeat(16), "cd".repeat(32));
        let sculpture = format!("sculptures/{id}-{hash}.sculpture");
        let whole = [
            ("backup.txt", "backup of a Paros booth, version 1\ncopied_at = 1790000000000\n"),
            ("booth.sqlite", "rows"),
            ("keys/ca.key", "key"),
            ("keys/ca.pem", "pem"),
            ("keys/site.key", "key"),
            (&sculpture, "sculpture"),
        ];
        let outside = [whole[0], ("../outside", "x"), ("/tmp/x", "y"), ("keys/../../x", "z")];
        vec![archive(&whole), archive(&outside), archive(&whole[1..])]
    },
    words: &[
        b"PK\x01\x02",
        b"PK\x03\x04",
        b"PK\x05\x06",
        b"PK\x06\x06",
        b"../",
        b"/",
        b"\0",
        b"backup.txt",
        b"booth.sqlite",
        b"\xff\xff\xff\xff",
    ],
    longest: 4096,
    // Few runs, as each syncs half a dozen files.
    runs: 150,
    run: run_backup,
};

/// The input is the lines of a request: a page's form, the query of a list, or the id and the headers of a
/// parcel.
const REQUEST: FuzzTarget = FuzzTarget {
    name: "request",
    seeds: || {
        let put = format!("{}\ncontent-length: 11000", "ab".repeat(16));
        let form: &[u8] =
            b"form=00ff&height=80%2C5&minutes=&filament=%3Cb%3Ewhite&note=by+five%0D%0A";
        let list = format!(
            "words=owl+%CE%B3%CE%AC%CF%84%CE%B1&day=2026-11-27&hour=9&headset=7&language=el&start=cat&older=1790000000000-{}",
            "ab".repeat(16)
        );
        vec![put.into_bytes(), form.into(), list.into_bytes()]
    },
    words: &[
        b"%",
        b"%00",
        b"%ff",
        b"+",
        b"&",
        b"=",
        b"height=",
        b"minutes=",
        b"?",
        b"#",
        b"18446744073709551616",
        b"-1",
        b"\xce\xb1",
        b"content-length: ",
        b"\n",
    ],
    longest: 2048,
    runs: 20_000,
    run: |bytes| {
        let mut outcome = String::new();
        if let Some(fields) = internals::read_form(bytes, &["form", "note"]) {
            assert_eq!(fields.len(), 3);
            outcome += &format!("form {}", fields[2]);
        }
        if let Some((link, filter)) = internals::read_list(&String::from_utf8_lossy(bytes)) {
            // The normalised address requests the same list.
            let query = link.strip_prefix("/staff?").expect("an address");
            assert_eq!(internals::read_list(query), Some((link.clone(), filter.clone())));
            let conditions = filter.matches("Some").count();
            outcome += &format!("list {} {conditions} ", filter.starts_with("Ok"));
        }
        let mut lines = bytes.split(|byte| *byte == b'\n');
        let mut line = || lines.next().unwrap_or_default();
        let id = String::from_utf8_lossy(line());
        let headers: Vec<_> = lines
            .filter_map(|line| {
                let at = line.windows(2).position(|two| two == b": ")?;
                Some((&line[..at], &line[at + 2..]))
            })
            .collect();
        match internals::read_put(&id, &headers) {
            Ok(_) => outcome + " a parcel",
            Err(why) => outcome + &why,
        }
    },
};

fn run_backup(bytes: &[u8]) -> String {
    let own = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz-backup");
    let _ = fs::remove_dir_all(&own);
    let (inside, at) = (own.join("a/b"), own.join("archive"));
    fs::create_dir_all(&inside).expect("room on the disk");
    fs::write(&at, bytes).expect("room on the disk");
    let unpacked = internals::unpack_backup(&at, &inside);
    let mut found = list(&own);
    found.retain(|path| *path != at);
    for path in found {
        let name = path.strip_prefix(&inside).expect("nothing is written elsewhere");
        let name = name.to_str().expect("text");
        let is_sculpture = name.strip_prefix("sculptures/").is_some_and(|name| {
            let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-.".contains(&byte);
            name.len() > 98 && name.bytes().all(is_plain)
        });
        let known = ["booth.sqlite", "deletions", "keys/ca.key", "keys/ca.pem", "keys/site.key"];
        assert!(is_sculpture || known.contains(&name), "{name}");
    }
    match unpacked {
        Ok(_) => "a backup".into(),
        Err(why) => why.to_string().rsplit(": ").next().unwrap_or_default().to_owned(),
    }
}
