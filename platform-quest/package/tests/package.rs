//! The packager, run as its users run it. Its packages are inspected with other tools.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use object::write::Object;
use object::{Architecture, BinaryFormat, Endianness};
use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, SessionState};
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_shell::figures::own_figure_mode;
use paros_shell::headset::package;
use paros_shell::settings::table::SETTINGS;
use paros_shell::settings::{FLEET_FILE_KEY, LoadedSettings, SettingsLayer};
use paros_shell::statics::{Resident, ResidentBitGrid, WorldWithStarts};
use paros_shell::tick_runner::TickRunner;

use crate::library::find_built_library;

const PASSWORD: (&str, &str) = ("PAROS_TEST_KEY", "a secret of tests");

/// A file that is not a library.
const TEXT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");

fn run_packager(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_package"));
    command.env(PASSWORD.0, PASSWORD.1).args(arguments).output().expect("it starts")
}

/// The machine numbers of ELF.
const AARCH64: u16 = 183;
const X86_64: u16 = 62;

/// Builds a stand-in for a loader: the header of a shared library, with one loadable segment of this
/// alignment in bytes.
fn stand_in_library(machine: u16, align: u64) -> Vec<u8> {
    let mut bytes = b"\x7fELF\x02\x01\x01".to_vec();
    bytes.resize(16, 0);
    for half in [3, machine, 1, 0] {
        bytes.extend(half.to_le_bytes());
    }
    // The entry point, the offset of the program header table, and no section header table.
    for word in [0u64, 64, 0] {
        bytes.extend(word.to_le_bytes());
    }
    for half in [0u16, 0, 64, 56, 1, 64, 0, 0] {
        bytes.extend(half.to_le_bytes());
    }
    bytes.extend([1u32, 4].map(u32::to_le_bytes).concat());
    bytes.extend([0u64, 0, 0, 120, 120, align].map(u64::to_le_bytes).concat());
    bytes
}

fn stderr_text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn create_release_key(name: &str) -> PathBuf {
    let store = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_file(&store);
    let mut make = Command::new("keytool");
    make.args(["-genkeypair", "-keyalg", "RSA", "-keysize", "2048", "-alias", "release"]);
    make.args(["-dname", "CN=Somebody", "-storepass:env", PASSWORD.0, "-keystore"]).arg(&store);
    assert!(make.env(PASSWORD.0, PASSWORD.1).status().expect("it starts").success());
    store
}

#[test]
fn the_same_input_makes_the_same_package() {
    let Some(library) = find_built_library() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let key = create_release_key("same.keystore");
    let [one, other] = ["one.apk", "other.apk"].map(|name| folder.join(name));
    let given = write_operator_files("same");
    let [library, key, settings, lion, hand] =
        [&library, &key, &given.settings, &given.lion, &given.hand]
            .map(|path| path.to_str().expect("UTF-8"));
    for path in [&one, &other] {
        let output = path.to_str().expect("UTF-8");
        let made = run_packager(&[
            "--library",
            library,
            "--key",
            key,
            "--key-password",
            "env:PAROS_TEST_KEY",
            "--settings",
            settings,
            "--figure",
            lion,
            "--figure",
            hand,
            "-o",
            output,
        ]);
        assert!(made.status.success(), "{}", stderr_text(&made));
        let report = String::from_utf8_lossy(&made.stdout);
        let has_adb = Command::new("adb").arg("version").output().is_ok();
        let adb = if has_adb { "" } else { "apt install adb\n" };
        assert!(
            report.ends_with(&format!("\n{output}\n{adb}adb install -r {output}\n")),
            "{report}"
        );
        assert!(report.contains("DN: CN=Somebody"), "{report}");
        let bytes = [&report, &*stderr_text(&made)].map(|text| text.contains(PASSWORD.1));
        assert_eq!(bytes, [false; 2]);
    }
    let [first, second] = [&one, &other].map(|path| fs::read(path).expect("it was made"));
    assert!(first == second, "two packages of one library differ");
    check_operator_assets::<128>(&one);
    check_operator_assets::<256>(&one);
}

/// The operator's content of a package.
struct OperatorFiles {
    settings: PathBuf,
    lion: PathBuf,
    hand: PathBuf,
}

/// A wedge that stands on y = 0 in OBJ, and on z = 0 in STL's text.
const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

const SETTINGS_TEXT: &str = "# for the zoo\nmode = \"lion\"\nhandover_seconds = 120\n";

fn write_operator_files(name: &str) -> OperatorFiles {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("operator-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let [settings, lion, hand] =
        ["zoo.toml", "lion.obj", "hand-2.stl"].map(|name| folder.join(name));
    let corners = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = FACES.map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).concat();
    let facets = FACES.map(|face| {
        let vertices = face.map(|i| {
            let [x, y, z] = CORNERS[i];
            format!("vertex {x} {y} {z}\n")
        });
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", vertices.concat())
    });
    fs::write(&settings, SETTINGS_TEXT).expect("room on the disk");
    fs::write(&lion, corners + &faces).expect("room on the disk");
    fs::write(&hand, format!("solid a\n{}endsolid a\n", facets.concat()))
        .expect("room on the disk");
    OperatorFiles { settings, lion, hand }
}

/// Checks the package's figures and settings as a headset loads them.
fn check_operator_assets<const N: usize>(package: &Path)
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let open = |name: &str| {
        let file = fs::File::open(package).expect("it was made");
        let mut package = zip::ZipArchive::new(file).expect("a package");
        let mut entry = package.by_name(&format!("assets/{name}")).ok()?;
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("it is whole");
        Some(bytes)
    };
    let names = package::read_own_figure_names(open).expect("a list");
    assert_eq!(names, ["lion", "hand-2"]);
    let text = open(package::SETTINGS_ASSET).expect("settings");
    assert!(text == SETTINGS_TEXT.as_bytes());
    let layer = SettingsLayer::parse_bytes("package", &text, &names);
    let settings = LoadedSettings::merge(&[layer]).settings;
    assert_eq!(settings.mode, own_figure_mode(0));

    let WorldWithStarts { start_volumes: volumes, world } = &mut *Grid::<N>::lock_world();
    package::load_start_volumes(volumes, open).expect("the volumes that there are always");
    package::load_own_figures(&names, volumes, open).expect("the figures");
    let SessionMode::Constrained { figure } = settings.mode else { panic!("a figure's mode") };
    let hidden = volumes.hidden_figures();
    assert_eq!(hidden.len(), usize::from(figure) + 2);
    let heights = hidden[usize::from(figure)..].iter().map(|hidden| {
        // One grid for both: two would overflow the thread's stack.
        let mut bits = Grid::<N>::lock_bit_grid();
        let top = |bits: &BitGrid<N>| {
            (0..N).rfind(|y| bits.layer(*y).iter().any(|row| !row.is_empty())).expect("voxels")
        };
        bits.set_from_maps(hidden.figure);
        assert!(!bits.layer(0).iter().all(BitSet::is_empty), "it stands on the ground");
        let top_of_figure = top(&bits);
        let figure: Vec<_> = (0..N * N).map(|i| bits.row(i / N, i % N)).collect();
        bits.set_from_maps(hidden.stone);
        let stone = (0..N * N).map(|i| bits.row(i / N, i % N));
        assert!(
            figure.iter().zip(stone).all(|(figure, stone)| *figure & stone == *figure),
            "it lies in its stone"
        );
        // The stone is 20 mm thick above the figure, and doesn't touch the box's sides.
        assert!((5 * N / 128..=6 * N / 128).contains(&(top(&bits) - top_of_figure)));
        assert!((0..N).all(|i| bits.row(i, 0).is_empty() && !bits.contains([0, i, N / 2])));
        top_of_figure
    });
    let heights: Vec<_> = heights.collect();
    // Up is y in an OBJ and z in an STL: one figure stands a third as high as it is long, the other on its
    // longest axis.
    assert!(heights[1] > 2 * heights[0], "{heights:?}");
    // A session of this mode begins.
    world.clear();
    let mut runner = TickRunner::new(world, volumes.start_volumes(&hidden));
    runner.run_tick(&TickInput { start: settings.mode, ..TickInput::default() });
    assert_eq!((world.session_state(), world.mode()), (SessionState::Sculpting, settings.mode));
    assert_eq!(volumes.hidden_figure_name(figure), Some("lion"));
}

#[test]
fn what_aapt_and_apksigner_say() {
    let Some(library) = find_built_library() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (path, loader) = (folder.join("said.apk"), folder.join("loader.so"));
    fs::write(&loader, stand_in_library(AARCH64, 16 << 10)).expect("room on the disk");
    let [library, loader, output] =
        [&library, &loader, &path].map(|path| path.to_str().expect("UTF-8"));
    // With a debug key of the tests' own.
    let mut command = Command::new(env!("CARGO_BIN_EXE_package"));
    command.env("ANDROID_USER_HOME", folder).args(["--library", library, "--loader", loader]);
    let made = command.args(["-o", output]).output().expect("it starts");
    assert!(made.status.success(), "{}", stderr_text(&made));
    let ask = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).arg(&path).output().expect("it starts");
        assert!(output.status.success(), "{program}: {}", stderr_text(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let badging = ask("aapt", &["dump", "badging"]);
    for line in ["package: name='org.paros.studio'", "native-code: 'arm64-v8a'", "sdkVersion:'29'"]
    {
        assert!(badging.contains(line), "no {line} in\n{badging}");
    }
    assert!(badging.contains("application: label='Paros' icon='res/mipmap"), "{badging}");
    check_restrictions(&ask(
        "aapt2",
        &["dump", "xmltree", "--file", "res/xml/app_restrictions.xml"],
    ));
    let listed = ask("aapt", &["list"]);
    // The lump, the toy, and four figures, each with its two stones: near the figure, and half as thick as
    // the lump.
    let starts = listed.lines().filter(|line| line.starts_with("assets/starts/128/")).count();
    assert_eq!(starts, 2 + 4 * 3);
    assert!(listed.lines().any(|line| line == "lib/arm64-v8a/libopenxr_loader.so"), "{listed}");
    let verified = ask("apksigner", &["verify", "-v", "--min-sdk-version", "29"]);
    assert!(verified.contains("v3 scheme (APK Signature Scheme v3): true"), "{verified}");
    ask("zipalign", &["-c", "-p", "4"]);
    assert!(fs::metadata(&path).expect("it was made").len() < 8 << 20);
}

/// Checks that a console offers exactly the settings of a headset, with bounds that it can show.
fn check_restrictions(dump: &str) {
    let attribute = |name: &str| {
        let values = dump.lines().filter(|line| line.contains(&format!(":{name}(")));
        values.map(|line| line.split('"').nth(1).unwrap_or_default().to_owned()).collect::<Vec<_>>()
    };
    let headsets = SETTINGS.iter().filter(|setting| setting.scope.is_for_headset());
    let names: Vec<_> = headsets.map(|setting| setting.name).chain([FLEET_FILE_KEY]).collect();
    assert_eq!(attribute("key"), names, "{dump}");
    // Each has a title and a description; size, mode, foveation and samples have entries.
    let references = |name: &str| dump.matches(&format!(":{name}(")).count();
    assert_eq!(["title", "description"].map(references), [names.len(); 2], "{dump}");
    assert_eq!(["entries", "entryValues"].map(references), [4; 2], "{dump}");
}

#[test]
fn what_is_wrong_is_told_and_nothing_is_left() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let output = folder.join("none.apk");
    let _ = fs::remove_file(&output);
    let at = output.to_str().expect("UTF-8");
    let fails = |arguments: &[&str], code: i32, why: &str| {
        let failed = run_packager(&[arguments, &["-o", at]].concat());
        assert_eq!(failed.status.code(), Some(code), "{}", stderr_text(&failed));
        assert!(stderr_text(&failed).contains(why), "{}", stderr_text(&failed));
        assert!(!output.exists());
    };
    fails(&["--key", "store"], 2, "--key-password");
    fails(&["--loader", "/no/such/loader.so"], 2, "/no/such/loader.so");
    fails(&["--loader", TEXT], 2, "it is no library");
    let loader = folder.join("wrong-loader.so");
    let at_loader = loader.to_str().expect("UTF-8");
    let object = Object::new(BinaryFormat::Elf, Architecture::Aarch64, Endianness::Little);
    for (bytes, why) in [
        (stand_in_library(AARCH64, 4 << 10), "a segment is aligned to 4096 bytes, not 16384"),
        (stand_in_library(X86_64, 16 << 10), "it is not for arm64"),
        (object.write().expect("an object"), "it is no library, but an object file"),
    ] {
        fs::write(&loader, bytes).expect("room on the disk");
        fails(&["--loader", at_loader], 2, &format!("{at_loader}: {why}"));
    }
    fails(&["--no-such-option"], 2, "--no-such-option");
    let given = write_operator_files("wrong");
    let write = |name: &str, text: &str| {
        let path = given.settings.with_file_name(name);
        fs::write(&path, text).expect("room on the disk");
        path.to_str().expect("UTF-8").to_owned()
    };
    let [settings, lion] = [&given.settings, &given.lion].map(|path| path.to_str().expect("UTF-8"));
    // The library is invalid, to show that nothing is built before the arguments are checked.
    let refused = |arguments: &[&str], why: &str| {
        fails(&[arguments, &["--library", TEXT]].concat(), 2, why);
    };
    // The mode of the lion without the lion's file.
    refused(
        &["--settings", settings],
        "zoo.toml:2:8: mode = \"lion\", expected free, creative or one of",
    );
    refused(&["--settings", "/no/such.toml"], "/no/such.toml: ");
    let wrong = write("wrong.toml", "size = 64\nrate = 90\n");
    refused(&["--settings", &wrong], "wrong.toml:1:8: size = 64, expected 128 or 256\n");
    refused(&["--settings", &wrong], "wrong.toml:2:1: rate: there is no such setting");
    let visits = write("visits.toml", "visits = true\nmode = \"owl\"\nstarts = [\"lion\"]\n");
    refused(&["--settings", &visits, "--figure", lion], "toml:2:8: mode = \"owl\", expected");
    let record = write("record.toml", "record = \"a.trace\"");
    refused(&["--settings", &record, "--figure", lion], "(lion) can't be played");
    let no_mesh = write("bear.obj", "v 0 0 0\nf 1 2 3\n");
    refused(&["--figure", lion, "--figure", &no_mesh], "bear.obj: ");
    refused(&["--figure", TEXT], "--figure: Cargo: no name of a figure");
    let owl = write("owl.obj", "");
    refused(&["--figure", &owl], "owl: there is one of this name already");
    refused(&["--figure", lion, "--figure", lion], "lion: there is one of this name already");
    let nine: Vec<_> = (0..9).flat_map(|_| ["--figure", lion]).collect();
    refused(&nine, "9 figures, expected at most 8");
    let nowhere = run_packager(&["-o", "/no/such/folder/x.apk"]);
    assert_eq!(nowhere.status.code(), Some(2), "{}", stderr_text(&nowhere));

    let Some(library) = find_built_library() else { return };
    fails(&["--library", TEXT], 2, "it is no library");
    let library = library.to_str().expect("UTF-8");
    let key = create_release_key("wrong.keystore").to_str().expect("UTF-8").to_owned();
    let wrong = ["--library", library, "--key", &key, "--key-password", "env:PATH"];
    fails(&wrong, 1, "apksigner failed");
}

/// Creates a fake compiler that reports a sysroot with these parts.
fn create_fake_compiler(name: &str, parts: &[&str]) -> PathBuf {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&root);
    for part in parts {
        let part = root.join("lib/rustlib").join(part);
        fs::create_dir_all(part.parent().expect("a folder")).expect("room on the disk");
        fs::write(part, "").expect("room on the disk");
    }
    let [draft, rustc] = ["draft", "rustc"].map(|name| root.join(name));
    let answers = format!("case $1 in -vV) echo host: here;; *) echo {};; esac", root.display());
    fs::write(&draft, format!("#!/bin/sh\n{answers}\n")).expect("room on the disk");
    // A separate process writes the file: otherwise a child that another test starts could inherit this
    // process's descriptor ("text file busy").
    let installed = Command::new("install").arg(draft).arg(&rustc).status();
    assert!(installed.expect("install").success());
    rustc
}

#[test]
fn all_that_is_missing_is_named_at_once() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let says = |rustc: &Path, arguments: &[&str]| {
        let mut bare = Command::new(env!("CARGO_BIN_EXE_package"));
        bare.args(arguments).env("PATH", "").env("RUSTC", rustc).env("CARGO_TARGET_DIR", folder);
        let output = bare.output().expect("it starts");
        assert_eq!(output.status.code(), Some(1));
        let text = stderr_text(&output);
        let mut lines = text.lines().map(str::to_owned);
        assert_eq!(lines.next().as_deref(), Some("package: something is missing; on Debian:"));
        let apt = lines.next().expect("programs are missing");
        let programs = "aapt zipalign apksigner default-jre-headless";
        let all = format!("apt install --no-install-recommends {programs}");
        assert!(apt == all || apt == format!("{all} android-framework-res"), "{text}");
        lines.collect::<Vec<_>>()
    };
    let target = "rustup target add aarch64-linux-android";
    let linker = "here/bin/rust-lld";
    let bare = create_fake_compiler("bare-compiler", &[linker]);
    assert_eq!(says(&bare, &[]), [target]);
    // With a given library nothing is built.
    assert_eq!(says(&bare, &["--library", TEXT]), [""; 0]);
    let whole = create_fake_compiler("whole-compiler", &[linker, "aarch64-linux-android/lib"]);
    assert_eq!(says(&whole, &[]), [""; 0]);
    // A compiler that was not installed by rustup.
    for rustc in [create_fake_compiler("other-compiler", &["here/lib"]), "/no/such/rustc".into()] {
        let line = says(&rustc, &[]).concat();
        assert!(line.starts_with(&format!("{target}  # ")), "{line}");
        assert!(line.ends_with(": by rustup, from https://rustup.rs"), "{line}");
    }
}
