//! `paros render --turn`: turntables, and the other reports of `render` on its pictures.

use std::io::Cursor;

use crate::support::TestFolder;

/// Returns the frames of an animated PNG, and the duration of the first in seconds.
fn frames(png: &[u8]) -> (Vec<Vec<u8>>, f32) {
    let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
    let count = reader.info().animation_control().unwrap().num_frames;
    let delay = reader.info().frame_control().unwrap();
    let seconds = f32::from(delay.delay_num) / f32::from(delay.delay_den);
    let frames = (0..count).map(|_| {
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        bytes
    });
    (frames.collect(), seconds)
}

#[test]
fn a_turntable_shows_the_sculpture_from_all_sides() {
    let folder = TestFolder::new("turn");
    let size = ["--size", "48x40", "--view", "10,15"];
    let render = |more: &[&str]| {
        folder.succeeds(&[&["render", "cat", "-o", "p.png"], &size[..], more].concat())
    };
    let said = render(&["--turn", "4"]);
    assert_eq!(said, "p.png: 4 frames of 48x40 pixels\n");
    let (turned, seconds) = frames(&folder.read("p.png"));
    assert_eq!((turned.len(), seconds), (4, 1.5));
    assert!((0..4).all(|i| turned[i] != turned[(i + 1) % 4]), "it turns");
    // Each frame equals the still picture from its view.
    for (frame, azimuth) in [(0, "10,15"), (3, "280,15")] {
        folder.succeeds(&["render", "cat", "-o", "one.png", "--size", "48x40", "--view", azimuth]);
        let still = folder.read("one.png");
        let mut reader = png::Decoder::new(Cursor::new(&still[..])).read_info().unwrap();
        assert!(reader.info().animation_control().is_none());
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        assert!(bytes == turned[frame], "the view from {azimuth}");
    }
    let said = render(&["--turn", "2", "--json"]);
    let written: serde_json::Value = serde_json::from_str(&said).unwrap();
    let expected =
        serde_json::json!({ "picture": "p.png", "width": 48, "height": 40, "frames": 2 });
    assert_eq!(written, expected);
    assert_eq!(folder.names(), ["one.png", "p.png"]);
}

#[test]
fn a_turntable_of_a_wrong_number_of_frames_is_refused() {
    let folder = TestFolder::new("turn-bad");
    for frames in ["0", "1", "361", "-3", "2.5", "many", ""] {
        folder.refuses(&["render", "cat", "-o", "p.png", "--turn", frames], "--turn");
    }
    folder.refuses(&["render", "cat", "-o", "p.jpg", "--turn", "3"], "p.jpg");
    folder.write("v.rmap", "no volume");
    folder.refuses(&["render", "v.rmap", "-o", "p.png", "--turn", "3"], "v.rmap");
    let large = ["render", "cat", "-o", "p.png", "--turn", "9", "--size", "8192x8192"];
    folder.refuses(&large, "9 frames of 8192x8192");
}
