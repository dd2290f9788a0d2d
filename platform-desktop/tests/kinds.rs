//! How the commands interpret their argument: as a figure, a file to open, or a file of unknown kind.

use crate::support::{TETRAHEDRON, TOY, TestFolder};

#[test]
fn a_file_of_no_known_kind_is_told_which_there_are() {
    let folder = TestFolder::new("unknown");
    folder.write("README.md", "# Paros\n");
    folder.write("p.png", b"\x89PNG\r\n\x1a\n");
    folder.write("nothing", "");
    for (name, seems) in [("README.md", "text"), ("p.png", "a PNG picture"), ("nothing", "empty")] {
        let word = format!(
            "{name}: neither a volume (.rmap) nor a mesh (.obj, .stl, .ply, .gltf or .glb) nor a \
             trace; it seems to be {seems}"
        );
        for args in [&["info", name][..], &["render", name, "-o", "x.png"]] {
            folder.refuses(args, &word);
        }
    }
}

#[test]
fn a_figure_is_drawn_by_its_name() {
    let folder = TestFolder::new("figure");
    folder.write("toy.rmap", &*TOY);
    folder.succeeds(&["render", "toy", "-o", "a.png", "--size", "48x48"]);
    folder.succeeds(&["render", "toy.rmap", "-o", "b.png", "--size", "48x48"]);
    assert!(folder.read("a.png") == folder.read("b.png"));
    folder.refuses(&["render", "./toy", "-o", "c.png"], "./toy: cannot read: No such file");
}

/// The same as `window FILE`; here there is no display.
#[test]
fn a_file_alone_is_opened_in_the_window() {
    let folder = TestFolder::new("alone");
    folder.write("v.rmap", &*TOY);
    folder.write("letter.obj", "no mesh\n");
    folder.write("solid.obj", TETRAHEDRON);
    folder.succeeds(&["bake", "solid.obj", "-o", "large.rmap", "--size", "256"]);
    for name in ["v.rmap", "large.rmap"] {
        let output = folder.paros(&[name]);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{errors}");
        assert!(errors.contains("no window can be opened: no display"), "{errors}");
    }
    folder.refuses(&["letter.obj"], "letter.obj: holds no triangle");
    folder.refuses(&["none.stl"], "none.stl: cannot read: No such file");
    folder.refuses(&["v.rmap", "info"], "info");
    folder.refuses(&["rendr"], "rendr: neither a command nor a file");
}
