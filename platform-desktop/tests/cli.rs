//! The `paros` command from a user's view: the results of good input, and for every kind of bad input exit
//! code 2 and a message that names the file, with nothing written.

use std::fs;
use std::process::{Command, Stdio};

use paros_shell::mesh::MAX_TRIANGLES;

use crate::support::{TOY, TestFolder, install_program};

const OCTAHEDRON: &str = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n\
    f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

/// A wedge along z lies down with y as the up axis, and stands with z.
#[test]
fn a_mesh_stands_on_the_axis_that_is_asked_for() {
    let folder = TestFolder::new("up");
    let vertices = "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 9\n";
    folder.write("wedge.obj", format!("{vertices}f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"));
    let mut height_of = |up: &[&str]| {
        folder.succeeds(&[&["bake", "wedge.obj", "-o", "v.rmap"], up].concat());
        folder.succeeds(&["export", "v.rmap", "-o", "m.stl"]);
        let said = folder.succeeds(&["info", "m.stl", "--json"]);
        let info: serde_json::Value = serde_json::from_str(&said).unwrap();
        let [low, high] =
            [0, 1].map(|end| [0, 1, 2].map(|axis| info["bounds"][end][axis].as_f64().unwrap()));
        let [x, y, z] = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        z / x.max(y)
    };
    let heights = [&[][..], &["--up", "y"], &["--up", "z"]].map(&mut height_of);
    assert!(heights[0] < 0.2 && heights[0] == heights[1], "{heights:?}");
    assert!(heights[2] > 4.0, "{heights:?}");
    folder.refuses(&["bake", "wedge.obj", "-o", "v.rmap", "--up", "x"], "x");
}

#[test]
fn a_mesh_becomes_a_volume_a_picture_and_a_print() {
    let folder = TestFolder::new("good");
    folder.write("octahedron.obj", OCTAHEDRON);
    let said = folder.succeeds(&["bake", "octahedron.obj", "-o", "v.rmap"]);
    assert!(said.starts_with("v.rmap: "), "{said}");
    let said = folder.succeeds(&["info", "v.rmap", "--json"]);
    let info: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&info["kind"], &info["size"]), (&"volume".into(), &128.into()));
    // 126 voxels along each axis: a sixth of the cube around it, and the voxels that its faces touch.
    let voxels = info["voxels"].as_u64().unwrap();
    assert!((330_000..380_000).contains(&voxels), "{voxels}");

    folder.succeeds(&["export", "v.rmap", "-o", "m.stl", "--height-mm", "80"]);
    let stl = folder.read("m.stl");
    let triangles = u32::from_le_bytes(stl[80..84].try_into().unwrap());
    assert!(triangles > 10_000);
    assert_eq!(stl.len(), 84 + 50 * triangles as usize);
    let said = folder.succeeds(&["info", "m.stl", "--json"]);
    let info: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(info["bounds"][1][2], 80.0);
    assert_eq!(info["winding_faults"], 0);

    folder.succeeds(&["render", "v.rmap", "-o", "p.png", "--size", "40x30", "--view", "-30,20"]);
    let png = folder.read("p.png");
    assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
    assert_eq!((png[19], png[23]), (40, 30));
    assert_eq!(folder.names(), ["m.stl", "octahedron.obj", "p.png", "v.rmap"]);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let folder = TestFolder::new("same");
    folder.write("toy.rmap", &*TOY);
    for (a, b, command) in [("a.stl", "b.stl", "export"), ("a.png", "b.png", "render")] {
        let mut args = vec![command, "toy.rmap", "-o", a];
        if command == "render" {
            args.extend(["--size", "48x48"]);
        }
        folder.succeeds(&args);
        args[3] = b;
        folder.succeeds(&args);
        assert!(folder.read(a) == folder.read(b), "{command}");
    }
}

#[test]
fn size_256_is_baked_and_exported() {
    let folder = TestFolder::new("large");
    folder.write("octahedron.obj", OCTAHEDRON);
    folder.succeeds(&["bake", "octahedron.obj", "-o", "v.rmap", "--size", "256"]);
    assert!(folder.succeeds(&["info", "v.rmap"]).contains("256^3"));
    folder.succeeds(&["export", "v.rmap", "-o", "m.stl"]);
}

#[test]
fn bad_meshes_are_refused() {
    let folder = TestFolder::new("meshes");
    let mut stl = vec![0; 84 + 50];
    stl[80] = 2;
    let triangle = |x: &str| format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\nf 1 2 3\n");
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
               end_header\n0 0 0\n1 0 0\n";
    let files: [(&str, Vec<u8>); 14] = [
        ("empty.obj", vec![]),
        ("empty.stl", vec![]),
        ("empty.ply", vec![]),
        ("empty.glb", vec![]),
        ("words.gltf", b"{".to_vec()),
        ("short.stl", stl),
        ("short.ply", ply.into()),
        ("flat.obj", triangle("0").into()),
        ("nan.obj", triangle("nan").into()),
        ("infinite.obj", triangle("inf").into()),
        ("huge.obj", triangle("1e38").into()),
        ("outside.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n".to_vec()),
        ("back.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 2 3\n".to_vec()),
        ("unknown.kind", OCTAHEDRON.into()),
    ];
    for (name, bytes) in files {
        folder.write(name, bytes);
        folder.refuses(&["bake", name, "-o", "v.rmap"], name);
    }
    folder.refuses(&["bake", "nothing.obj", "-o", "v.rmap"], "nothing.obj");
    folder.refuses(&["info", "nan.obj"], "nan.obj");
}

/// The number of triangles is limited, and the message states the excess.
#[test]
fn a_mesh_of_too_many_triangles_is_refused() {
    let folder = TestFolder::new("triangles");
    let (found, most) = (MAX_TRIANGLES + 1, MAX_TRIANGLES);
    folder.write("many.obj", format!("v 0 0 0\nf{}\n", " 1".repeat(found + 2)));
    let word = format!("many.obj: becomes {found} triangles or more; expected at most {most}");
    folder.refuses(&["bake", "many.obj", "-o", "v.rmap"], &word);
}

#[test]
fn bad_volumes_are_refused() {
    let folder = TestFolder::new("volumes");
    let good = &*TOY;
    let changed = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    let columns = good.len() - 16;
    let loose = {
        let mut bytes = changed(12 + columns / 2, !0);
        let at = bytes.len() - 4;
        let sum = crc32fast::hash(&bytes[..at]);
        bytes[at..].copy_from_slice(&sum.to_le_bytes());
        bytes
    };
    let small = [&b"RMAP\x01\x00\x40\x00\x01\x00\x00\x00"[..], &[0; 24576]].concat();
    let sum = crc32fast::hash(&small).to_le_bytes();
    let files: [(&str, Vec<u8>, &str); 9] = [
        ("empty.rmap", vec![], "byte 0"),
        ("magic.rmap", changed(0, b'X'), "magic"),
        ("version.rmap", changed(4, 9), "version 1 or 2, found 9"),
        ("size.rmap", changed(6, 127), "found 127"),
        ("small.rmap", [small, sum.to_vec()].concat(), "128 or 256, found 64"),
        ("sum.rmap", changed(5000, 0x55), "checksum"),
        ("loose.rmap", loose, "tight"),
        ("short.rmap", good[..9000].to_vec(), "byte 9000"),
        ("long.rmap", [&good[..], b"!"].concat(), "more bytes"),
    ];
    for (name, bytes, word) in files {
        folder.write(name, bytes);
        for args in [
            &["info", name][..],
            &["info", name, "--json"],
            &["export", name, "-o", "m.stl"],
            &["render", name, "-o", "p.png"],
        ] {
            folder.refuses(args, name);
            folder.refuses(args, word);
        }
    }
    folder.refuses(&["info", "nothing.rmap"], "nothing.rmap");
    folder.write("t.trace", b"PTRC\x01\0\x01\0\x80\0\0\0");
    folder.refuses(&["info", "t.trace"], "t.trace: is a trace, not a volume; use `paros play`");
    folder.refuses(&["info", "."], ".");
}

/// A file of one kind in the place of another: the message names its kind and the right command.
#[test]
fn a_file_of_another_kind_is_told_what_it_is() {
    let folder = TestFolder::new("kinds");
    folder.write("v.rmap", &*TOY);
    folder.write("m.obj", OCTAHEDRON);
    folder.write("m.stl", [0; 84]);
    for (name, command, output) in [("m.stl", "render", "p.png"), ("m.obj", "export", "x.stl")] {
        let word = format!("{name}: is a mesh, not a volume; `paros bake` makes one of it");
        folder.refuses(&[command, name, "-o", output], &word);
    }
    folder.refuses(&["bake", "v.rmap", "-o", "w.rmap"], "v.rmap: is a volume already");
    let word = "v.rmap: is a volume, not a trace; `paros render` draws it";
    folder.refuses(&["play", "v.rmap"], word);
}

/// The contents would not match the extension.
#[test]
fn a_name_of_another_kind_is_refused() {
    let folder = TestFolder::new("endings");
    folder.write("v.rmap", &*TOY);
    folder.write("m.obj", OCTAHEDRON);
    folder.write("t.trace", "");
    folder.refuses(&["export", "v.rmap", "-o", "m.ply"], "m.ply: expected a name in .stl");
    folder.refuses(&["render", "v.rmap", "-o", "p.jpg"], "p.jpg: expected a name in .png");
    folder.refuses(&["bake", "m.obj", "-o", "v.stl"], "v.stl: expected a name in .rmap");
    folder.refuses(&["play", "t.trace", "--stl", "s.obj"], "s.obj: expected a name in .stl");
    folder.succeeds(&["export", "v.rmap", "-o", "M.STL"]);
}

/// All commands report a missing file in the same words.
#[test]
fn a_missing_file_cannot_be_read() {
    let folder = TestFolder::new("missing");
    for args in [
        &["info", "none.rmap"][..],
        &["info", "none.obj"],
        &["bake", "none.obj", "-o", "v.rmap"],
        &["export", "none.rmap", "-o", "m.stl"],
        &["play", "none.trace"],
        &["window", "none.stl"],
        &["window", "none.rmap"],
    ] {
        folder.refuses(args, "cannot read: No such file");
    }
}

#[test]
fn the_bench_is_named_as_a_program_of_its_own() {
    let folder = TestFolder::new("bench");
    folder.refuses(&["bench"], "cargo run --release -p paros-bench\n");
    let args = ["bench", "islands", "--help", "owl"];
    folder.refuses(&args, "cargo run --release -p paros-bench -- islands --help owl\n");
}

/// This is checked before looking for a display: here there is none.
#[test]
fn a_window_for_what_is_no_stone_is_refused() {
    let folder = TestFolder::new("window");
    folder.write("t.trace", "");
    folder.write("letter.obj", "no mesh\n");
    folder.refuses(&["window", "t.trace"], "t.trace: no mesh or volume; expected a name in .rmap");
    folder.refuses(&["window", "letter.obj"], "letter.obj: holds no triangle");
    folder.write("v.rmap", &*TOY);
    folder.refuses(&["window", "v.rmap", "--size", "256"], "v.rmap: is a volume of 128");
    let output = folder.paros(&["window", "v.rmap"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("no window can be opened: no display"), "{errors}");
}

/// A display is named, but doesn't exist. With or without a server's libraries, the message contains no path
/// of the build machine.
#[test]
fn a_display_that_is_not_there_is_told_without_a_path_of_the_source() {
    let folder = TestFolder::new("no-server");
    let mut paros = folder.command(&["window"]);
    let output = paros.env("DISPLAY", ":59999").output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("no window can be opened: "), "{errors}");
    assert!(!errors.contains('/') && !errors.contains(".rs"), "{errors}");
}

#[test]
fn an_empty_volume_has_no_picture_and_no_print() {
    let folder = TestFolder::new("empty");
    let empty = [&b"RMAP\x01\x00\x80\x00\x01\x00\x00\x00"[..], &[0; 98304]].concat();
    let sum = crc32fast::hash(&empty).to_le_bytes();
    folder.write("v.rmap", [&empty[..], &sum].concat());
    assert!(folder.succeeds(&["info", "v.rmap"]).contains("voxels    0"));
    folder.refuses(&["export", "v.rmap", "-o", "m.stl"], "v.rmap: the volume is empty");
    folder.refuses(&["render", "v.rmap", "-o", "p.png"], "v.rmap: the volume is empty");
}

#[test]
fn bad_arguments_are_refused() {
    let folder = TestFolder::new("arguments");
    folder.write("v.rmap", &*TOY);
    folder.write("m.obj", OCTAHEDRON);
    for height in ["0", "-1", "nan", "inf", "tall", ""] {
        folder.refuses(&["export", "v.rmap", "-o", "m.stl", "--height-mm", height], "height-mm");
    }
    for size in ["0x0", "10", "9000x10", "-1x5", "x", ""] {
        folder.refuses(&["render", "v.rmap", "-o", "p.png", "--size", size], "size");
    }
    for view in ["1", "nan,0", "0,91", "inf,0", ","] {
        folder.refuses(&["render", "v.rmap", "-o", "p.png", "--view", view], "view");
    }
    for size in ["64", "512", "big"] {
        folder.refuses(&["bake", "m.obj", "-o", "x.rmap", "--size", size], "size");
    }
    folder.refuses(&["bake", "m.obj"], "--output");
    folder.refuses(&["chisel"], "chisel");
    folder.refuses(&["info"], "FILE");
}

#[test]
fn places_where_no_file_can_be_are_refused() {
    let folder = TestFolder::new("places");
    folder.write("v.rmap", &*TOY);
    folder.write("m.obj", OCTAHEDRON);
    fs::create_dir(folder.0.join("folder")).unwrap();
    for output in ["none/file", "folder", "m.obj/file", "/"] {
        folder.refuses(&["bake", "m.obj", "-o", output], output);
        folder.refuses(&["export", "v.rmap", "-o", output], output);
        folder.refuses(&["render", "v.rmap", "-o", output, "--size", "8x8"], output);
    }
    folder.refuses(&["export", "v.rmap", "-o", "./v.rmap"], "both input and output");
    folder.refuses(&["render", "v.rmap", "-o", "v.rmap"], "both input and output");
    folder.refuses(&["bake", "m.obj", "-o", "folder/../m.obj"], "both input and output");
    assert_eq!(folder.read("m.obj"), OCTAHEDRON.as_bytes());
    assert!(folder.read("v.rmap") == *TOY);
}

#[cfg(unix)]
#[test]
fn links_that_lead_nowhere_and_names_too_long_are_refused() {
    let folder = TestFolder::new("names");
    folder.write("m.obj", OCTAHEDRON);
    std::os::unix::fs::symlink("gone", folder.0.join("link")).unwrap();
    folder.refuses(&["bake", "m.obj", "-o", "link"], "link: cannot replace");
    assert!(fs::symlink_metadata(folder.0.join("link")).unwrap().is_symlink());
    let longest = "n".repeat(255);
    folder.refuses(&["bake", "m.obj", "-o", &format!("{longest}n")], "nnn: cannot create");
    folder.succeeds(&["bake", "m.obj", "-o", &longest]);
}

#[test]
fn a_command_that_is_killed_leaves_nothing() {
    let folder = TestFolder::new("killed");
    folder.write("v.rmap", &*TOY);
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    paros.args(["render", "v.rmap", "-o", "p.png", "--size", "8192x8192"]).current_dir(&folder.0);
    let mut paros = paros.stdin(Stdio::null()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(700));
    assert!(paros.try_wait().unwrap().is_none(), "64 million pixels take longer");
    paros.kill().unwrap();
    paros.wait().unwrap();
    assert_eq!(folder.names(), ["v.rmap"]);
}

/// The session takes long, so that a target that can't be written is reported before it.
#[test]
fn a_demo_that_has_no_place_leaves_nothing() {
    let folder = TestFolder::new("demo");
    folder.write("file", "");
    folder.refuses(&["demo", "-o", "file"], "file: cannot make the folder");
    folder.refuses(&["demo", "-o", "file/sub"], "file/sub: cannot make the folder");
    fs::create_dir_all(folder.0.join("out/report.txt")).unwrap();
    folder.refuses(&["demo", "-o", "out"], "report.txt: cannot replace");
    assert_eq!(fs::read_dir(folder.0.join("out")).unwrap().count(), 1);
}

/// A folder without write permission is a failure, not a wrong argument. Root may write anywhere, so then the
/// command runs as the user `nobody`.
#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_is_a_failure() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;
    const NOBODY: u32 = 65_534;
    let folder = std::env::temp_dir().join(format!("paros-{}-shut", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("m.obj"), OCTAHEDRON).unwrap();
    // The user `nobody` may not be able to read the build folder.
    let program = folder.join("paros");
    install_program(env!("CARGO_BIN_EXE_paros").as_ref(), &program);
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o555)).unwrap();
    let is_root = fs::metadata(&folder).unwrap().uid() == 0;
    for args in [&["demo", "-o", "."][..], &["demo", "-o", "sub"], &["bake", "m.obj", "-o", "v"]] {
        let mut paros = Command::new(&program);
        paros.args(args).current_dir(&folder).stdin(Stdio::null());
        let output = if is_root { paros.uid(NOBODY) } else { &mut paros }.output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{args:?}: {errors}");
        assert!(errors.contains("ermission denied"), "{args:?}: {errors}");
    }
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o755)).unwrap();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
    fs::remove_dir_all(&folder).unwrap();
}
