//! Tests of the destinations of files, and of failed writes.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Destination, FileKind, FileWriter, WriteJob, WriteOutcome};

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("paros-keeper-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn sculpture(folders: &[&Path], byte: u8) -> WriteJob {
    let place = Destination::NextFree {
        folders: folders.iter().map(|folder| folder.to_path_buf()).collect(),
        stem: "sculpture",
        extensions: vec!["stl", "rmap"],
    };
    WriteJob {
        kind: FileKind::Sculpture,
        destination: place,
        contents: vec![vec![byte], vec![byte, byte]],
    }
}

fn all(file_writer: &mut FileWriter) -> Vec<WriteOutcome> {
    std::iter::from_fn(|| file_writer.wait_for_next_outcome()).collect()
}

#[test]
fn files_are_written_in_order_and_all_or_none() {
    let folder = folder("order");
    let (a, b) = (folder.join("deep/a"), folder.join("b"));
    let mut file_writer = FileWriter::spawn();
    for bytes in [b"old".to_vec(), b"new".to_vec()] {
        file_writer.submit_file_or_wait(FileKind::Session, a.clone(), bytes);
    }
    // A folder can't be replaced by a file.
    let place = Destination::Replace(vec![b.clone(), folder.join("deep")]);
    let job =
        WriteJob { kind: FileKind::Trace, destination: place, contents: vec![vec![1], vec![2]] };
    file_writer.submit_or_wait(job.clone());
    let mut heard = all(&mut file_writer);
    assert!(heard[0].result.is_ok() && heard[1].result.is_ok());
    let last = heard.pop().expect("three");
    assert!(last.result.is_err());
    assert_eq!(last.job, job);
    assert_eq!(fs::read(&a).expect("written"), b"new");
    assert!(!b.exists());
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

#[test]
fn no_name_is_given_twice() {
    let folder = folder("twice");
    fs::write(folder.join("sculpture-002.rmap"), b"an old one").expect("a file");
    let mut file_writers: Vec<_> = (0..4).map(|_| FileWriter::spawn()).collect();
    for round in 0..8 {
        for (number, file_writer) in file_writers.iter_mut().enumerate() {
            file_writer.submit_or_wait(sculpture(&[&folder], round * 4 + number as u8));
        }
    }
    let mut bytes = Vec::new();
    for kept in file_writers.iter_mut().flat_map(all) {
        let paths = kept.result.expect("written");
        let [stl, rmap] = &paths[..] else { panic!("two files") };
        assert_eq!(stl.with_extension("rmap"), *rmap);
        let byte = fs::read(stl).expect("a file")[0];
        assert_eq!(fs::read(rmap).expect("a file"), [byte, byte]);
        bytes.push(byte);
    }
    bytes.sort_unstable();
    assert_eq!(bytes, (0..32).collect::<Vec<_>>());
    assert_eq!(fs::read(folder.join("sculpture-002.rmap")).expect("a file"), b"an old one");
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 65);
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}

#[test]
fn a_folder_that_takes_nothing_has_another_in_its_place() {
    let folder = folder("instead");
    let (file, there) = (folder.join("file"), folder.join("there"));
    fs::write(&file, b"no folder").expect("a file");
    let mut file_writer = FileWriter::spawn();
    file_writer.submit_or_wait(sculpture(&[&file, &there], 7));
    file_writer.submit_or_wait(sculpture(&[&file], 7));
    let heard = all(&mut file_writer);
    assert_eq!(heard[0].result.as_ref().expect("written")[0], there.join("sculpture-001.stl"));
    assert!(heard[0].fallback_cause.as_ref().expect("why").to_string().contains("file"));
    assert!(heard[1].result.is_err() && heard[1].fallback_cause.is_none());
    fs::remove_dir_all(&folder).expect("the folder can be removed");
}
