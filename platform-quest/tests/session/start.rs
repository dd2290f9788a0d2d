//! The start: a driver that compiles slowly or not at all, repeated failed starts, and a second start in one
//! process.

use std::fs;
use std::path::Path;
use std::time::Duration;

use paros_headset::notice_picture::draw_notice;
use paros_headset::start_up::{FAILURE_SHOWN, FailedStarts, RING_STEPS, StartNotice};
use paros_quest::platform::{PlainPlatform, Platform};
use paros_shell::require::require_or_skip;

use super::layered::{assert_no_violations, find_rig, inject_event, read_log};
use super::monado::{MonadoService, MonadoTree, ShellEnd, ShellProcess, wait_for};
use super::{hands_at_rest, read_frame};

/// The time that the slow driver takes to compile.
const COMPILING: Duration = Duration::from_secs(10);

/// The limit of the wait for events and frames meanwhile: a frame of the null compositor takes 50 ms, and
/// other tests run beside this one.
const LONGEST_WAIT_MS: u32 = 1000;

/// Writes a request file into the layer's folder, before a shell is started.
fn wish(monado: &MonadoService, name: &str, text: &str) {
    let folder = monado.folder.join("layer");
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join(name), text).expect("a wish");
}

/// Captures the visible notice as the compositor gets it: red, green, blue of each pixel.
fn capture_notice(shell: &mut ShellProcess, folder: &Path, name: &str) -> Vec<u8> {
    let path = folder.join(format!("{name}-notice.png"));
    shell.send(&format!("shot {}", folder.join(name).display()));
    wait_for("a picture", || path.exists());
    read_frame(&path).rgb
}

fn rgb_of(notice: &StartNotice) -> Vec<u8> {
    let pixels = draw_notice(notice);
    pixels.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

/// Returns the numbers in the log line with this beginning.
fn numbers_of(log: &str, beginning: &str) -> Vec<u32> {
    let line = log.lines().find(|line| line.starts_with(beginning));
    let line = line.unwrap_or_else(|| panic!("no {beginning} in {log}"));
    line.split(' ').filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn while_programs_are_compiled_events_are_drained_and_a_picture_is_seen() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "loading");
    let _hands = hands_at_rest(&monado);
    wish(&monado, "slow-pipelines", &COMPILING.as_millis().to_string());
    let mut shell = monado.start_mapped_shell(&layer, &[]);
    shell.wait_until("loading", |said| said.field("life") == "loading");
    wait_for("a notice", || read_log(&monado).contains("notice after"));
    inject_event(&monado, "presence 0");
    inject_event(&monado, "presence 1");
    let seen = capture_notice(&mut shell, &monado.folder, "loading");
    let is_seen = |step| rgb_of(&StartNotice::Loading { step }) == seen;
    assert!((0..RING_STEPS).any(is_seen), "another picture than that of loading");
    let said = shell.query_status();
    assert_eq!((said.field("life"), said.number("frames")), ("loading", 0));
    assert!(!read_log(&monado).contains("compiled"), "the driver was still at it");

    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    let log = read_log(&monado);
    let [after_ms] = numbers_of(&log, "notice after")[..] else { panic!("{log}") };
    assert!(after_ms < LONGEST_WAIT_MS, "the first notice was seen after {after_ms} ms");
    let [count, poll_ms, frame_ms] = numbers_of(&log, "studio after")[..] else { panic!("{log}") };
    assert!(count > 50, "{count} notices in {COMPILING:?}");
    assert!(poll_ms < LONGEST_WAIT_MS, "events waited for {poll_ms} ms");
    assert!(frame_ms < LONGEST_WAIT_MS, "frames waited for {frame_ms} ms");
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_no_violations(&log);
}

#[test]
fn a_visitor_who_leaves_while_programs_are_compiled_has_left() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "left-loading");
    wish(&monado, "slow-pipelines", "3000");
    let mut shell = monado.start_mapped_shell(&layer, &[]);
    shell.wait_until("loading", |said| said.field("life") == "loading");
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("paros-quest: Exiting\n"), "{errors}");
    assert!(!monado.folder.join("files/cache/failed-starts").exists(), "it did not fail");
}

/// Reads the shell's record of failed starts.
fn read_failed_starts(monado: &MonadoService) -> Option<FailedStarts> {
    let bytes = fs::read(monado.folder.join("files/cache/failed-starts")).ok()?;
    Some(FailedStarts::decode(&bytes).expect("whole"))
}

#[test]
fn a_failed_start_is_shown_and_logged_and_the_next_one_waits() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "failed-start");
    wish(&monado, "no-pipelines", "");
    let mut shell = monado.start_mapped_shell(&layer, &[]);
    let said = shell.wait_until("a notice", |said| said.text().starts_with("life notice; "));
    let cause = "could not make a pipeline: A device memory allocation has failed; the headset's";
    assert!(
        said.text().contains("Failed { cause: ") && said.text().contains(cause),
        "{}",
        said.text()
    );
    let whole = said.text().split('"').nth(1).expect("a quoted cause").to_owned();
    let seen = loop {
        wait_for("a notice", || read_log(&monado).contains("notice after"));
        let seen = capture_notice(&mut shell, &monado.folder, "failed");
        if !seen.is_empty() {
            break seen;
        }
    };
    let is_seen = |seconds| rgb_of(&StartNotice::Failed { cause: whole.clone(), seconds }) == seen;
    assert!((1..=FAILURE_SHOWN.as_secs()).any(is_seen), "another picture than that of the cause");
    assert_eq!(read_failed_starts(&monado).map(|failed| failed.count()), Some(1));
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(1), "{errors}");
    assert!(errors.lines().last().expect("a line").contains(cause), "{errors}");
    let log = fs::read_to_string(monado.folder.join("files/paros.log")).expect("a log");
    assert!(log.contains(&format!("Z the start failed: {whole}\n")), "{log}");

    // The fifth consecutive failed start.
    let (now, boot) = (PlainPlatform.since_boot(), PlainPlatform.boot_id().expect("a boot"));
    let failed = (0..4).fold(read_failed_starts(&monado), |failed, _| {
        Some(FailedStarts::after_failure(failed, boot, now))
    });
    let path = monado.folder.join("files/cache/failed-starts");
    fs::write(&path, failed.expect("a row").encode()).expect("room");
    fs::remove_file(monado.folder.join("layer/no-pipelines")).expect("a wish");
    let mut shell = monado.start_mapped_shell(&layer, &[]);
    shell.wait_until("waiting", |said| said.text().contains("notice Waiting { seconds: "));
    let seen = capture_notice(&mut shell, &monado.folder, "waiting");
    let is_seen = |seconds| rgb_of(&StartNotice::Waiting { seconds }) == seen;
    assert!((1..=16).any(is_seen), "another picture than that of the wait");
    shell.wait_until("focus", |said| said.field("life") == "focused");
    assert!(PlainPlatform.since_boot() >= now + Duration::from_secs(16), "it came too soon");
    wait_for("a good start", || !path.exists());
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("starts failed in a row, 5: the next one is in 1"), "{errors}");
    assert_no_violations(&read_log(&monado));
}

#[test]
fn a_second_start_in_the_process_works() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(again) = require_or_skip(find_rig("again")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "again");
    let _hands = hands_at_rest(&monado);
    let mut shell = monado.start_program(&again, &["files"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("the first run has ended\n"), "{errors}");
    assert_eq!(errors.matches("paros-quest: Focused\n").count(), 2, "{errors}");
}
