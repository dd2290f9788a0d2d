//! Tests of devices that work and devices that fail: each is a library of its own, built from `mock_alsa.c`
//! or `mock_aaudio.c` by the C compiler that Rust links with. One test uses the system's own device, if there
//! is one.
#![cfg(unix)]

use std::ffi::c_int;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex, Once, PoisonError, RwLock, RwLockReadGuard};
use std::thread;
use std::time::{Duration, Instant};
use std::{env, fmt, fs};

use paros_core::TickInput;
use paros_core::glam::{Quat, Vec3};
use paros_core::session::{BenchItem, Tool};
use paros_models::scripted_hand::{RIGHT, input_with_bit_at, start_from_stone, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shell::require::require_or_skip;
use paros_sound::{Interface, SoundDevice, Speaker};

/// A world after a tick in which a motor runs, once it is made.
static HARNESS: RwLock<WorldHarness<64, 2>> = RwLock::new(WorldHarness::new());

const BOTH: [Interface; 2] = [Interface::Alsa, Interface::AAudio];

/// The timeout for something that a thread does.
const PATIENCE: Duration = Duration::from_secs(20);

/// A mock library, and the lines logged about it.
struct MockDevice {
    interface: Interface,
    library: PathBuf,
    said: Arc<Mutex<Vec<String>>>,
}

impl MockDevice {
    /// Compiles a mock that no other test uses.
    fn build(interface: Interface, name: &str, definitions: &[&str]) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("devices");
        fs::create_dir_all(&folder).expect("room on the disk");
        let library = folder.join(format!("{interface:?}-{name}.so"));
        let source = match interface {
            Interface::Alsa => "mock_alsa.c",
            Interface::AAudio => "mock_aaudio.c",
        };
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/devices").join(source);
        let mut cc = Command::new("cc");
        cc.args(["-shared", "-fPIC", "-Wall", "-o"]).arg(&library).arg(source);
        cc.args(definitions.iter().map(|definition| format!("-D{definition}")));
        assert!(cc.status().expect("a C compiler").success(), "cc makes {}", library.display());
        MockDevice { interface, library, said: Arc::default() }
    }

    fn spawn_speaker(&self) -> Speaker {
        let device = SoundDevice { interface: self.interface, library: self.library.clone() };
        Speaker::spawn(device, 100, log_to(&self.said)).expect("a thread")
    }

    fn number<T: Copy>(&self, name: &str) -> T {
        // SAFETY: it is a mock, which has no initialisers.
        let library = unsafe { libloading::Library::new(&self.library) }.expect("a mock");
        // SAFETY: the mock has a number of this name, of this type.
        unsafe { **library.get::<*const T>(name.as_bytes()).expect("a number") }
    }

    fn count(&self, name: &str) -> c_int {
        self.number(name)
    }

    fn said(&self) -> Vec<String> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Waits until a condition holds, and asserts that the device was used correctly.
    fn wait_until(&self, what: &str, mut is_so: impl FnMut(&Self) -> bool) {
        let begun = Instant::now();
        while !is_so(self) {
            assert!(begun.elapsed() < PATIENCE, "{:?}: {what}: {:?}", self.interface, self.said());
            thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(self.count("wrong"), 0, "{:?}: {what}", self.interface);
    }
}

fn log_to(said: &Arc<Mutex<Vec<String>>>) -> impl Fn(fmt::Arguments<'_>) + Send + 'static {
    let said = Arc::clone(said);
    move |line| said.lock().unwrap_or_else(PoisonError::into_inner).push(line.to_string())
}

/// Returns the world in which a motor runs, and the input of its last tick.
fn world_with_motor() -> (RwLockReadGuard<'static, WorldHarness<64, 2>>, TickInput) {
    static MAKE: Once = Once::new();

    let input = |harness: &WorldHarness<64, 2>| {
        input_with_bit_at(harness, Vec3::new(225.0, 330.0, 225.0), Quat::IDENTITY, 255)
    };
    MAKE.call_once(|| {
        let mut harness = HARNESS.write().unwrap_or_else(PoisonError::into_inner);
        start_from_stone(&mut harness, |place| place.y < 200.0);
        take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
        let input = input(&harness);
        harness.step(&input);
    });
    let harness = HARNESS.read().unwrap_or_else(PoisonError::into_inner);
    let input = input(&harness);
    (harness, input)
}

/// Plays ticks of a running motor at their rate until a condition holds.
fn play_until(
    speaker: &mut Speaker,
    mock: &MockDevice,
    mut is_so: impl FnMut(&MockDevice) -> bool,
) {
    let (harness, input) = world_with_motor();
    mock.wait_until("while a motor runs", |mock| {
        speaker.play_tick(&harness.world, &input);
        thread::sleep(Duration::from_millis(9));
        is_so(mock)
    });
}

#[test]
fn a_motor_is_played_and_the_device_closed_after_it() {
    for interface in BOTH {
        let mock = MockDevice::build(interface, "plain", &[]);
        let mut speaker = mock.spawn_speaker();
        play_until(&mut speaker, &mock, |mock| mock.number::<f32>("loudest") > 0.03);
        // Without ticks it becomes silent, and is closed after a second.
        mock.wait_until("closed when idle", |mock| mock.count("closed") == 1);
        assert_eq!(mock.count("opened"), 1);
        play_until(&mut speaker, &mock, |mock| mock.count("opened") == 2);
        drop(speaker);
        mock.wait_until("closed at the end", |mock| mock.count("closed") == 2);
        assert!(mock.said().is_empty(), "{:?}", mock.said());
    }
}

#[test]
fn a_device_that_takes_little_at_once_gets_all() {
    for interface in BOTH {
        let mock = MockDevice::build(interface, "little", &["TAKES_LITTLE"]);
        let mut speaker = mock.spawn_speaker();
        play_until(&mut speaker, &mock, |mock| mock.count("written") > 9600);
        assert!(mock.number::<f32>("loudest") > 0.03 && mock.said().is_empty());
    }
}

#[test]
fn late_frames_are_recovered_from() {
    let mock = MockDevice::build(Interface::Alsa, "underruns", &["UNDERRUNS"]);
    let mut speaker = mock.spawn_speaker();
    play_until(&mut speaker, &mock, |mock| mock.count("recovered") >= 5);
    assert_eq!((mock.count("opened"), mock.said()), (1, vec![]));
}

#[test]
fn a_device_that_breaks_off_is_opened_again_and_it_is_said_once() {
    for (interface, line) in [
        (Interface::Alsa, "no sound: snd_pcm_writei: No such device"),
        (Interface::AAudio, "no sound: AAudioStream_write: AAUDIO_ERROR_DISCONNECTED"),
    ] {
        let mock = MockDevice::build(interface, "breaks", &["BREAKS"]);
        let mut speaker = mock.spawn_speaker();
        play_until(&mut speaker, &mock, |mock| mock.count("opened") == 2);
        assert_eq!((mock.count("closed"), mock.said()), (1, vec![line.to_owned()]));
    }
}

#[test]
fn a_device_that_is_not_there_is_said_once_and_tried_again() {
    for (interface, line) in [
        (Interface::Alsa, "no sound: snd_pcm_open: No such file or directory"),
        (Interface::AAudio, "no sound: AAudioStreamBuilder_openStream: AAUDIO_ERROR_UNAVAILABLE"),
    ] {
        let mock = MockDevice::build(interface, "absent", &["FAIL_OPEN=2"]);
        let mut speaker = mock.spawn_speaker();
        play_until(&mut speaker, &mock, |mock| mock.count("written") > 0);
        assert_eq!((mock.count("open_failures"), mock.said()), (2, vec![line.to_owned()]));
    }
}

#[test]
fn a_stream_that_takes_nothing_is_closed_and_said() {
    let mock = MockDevice::build(Interface::AAudio, "stuck", &["TAKES_NOTHING"]);
    let mut speaker = mock.spawn_speaker();
    play_until(&mut speaker, &mock, |mock| mock.count("closed") == 1);
    mock.wait_until("said", |mock| !mock.said().is_empty());
    assert_eq!(mock.said(), ["no sound: AAudioStream_write: no frames in half a second"]);
}

#[test]
fn a_library_that_lacks_a_function_is_none() {
    for (interface, name) in
        [(Interface::Alsa, "snd_pcm_writei"), (Interface::AAudio, "AAudioStream_write")]
    {
        let mock = MockDevice::build(interface, "lacks", &["LACKS_WRITE"]);
        let speaker = mock.spawn_speaker();
        mock.wait_until("said", |mock| !mock.said().is_empty());
        assert_eq!(mock.said(), [format!("no sound: the library has no {name}")]);
        drop(speaker);
    }
}

#[test]
fn a_machine_without_the_library_is_silent_and_says_so_once() {
    for interface in BOTH {
        let said = Arc::default();
        let device = SoundDevice { interface, library: "libno-such-sound.so".into() };
        let mut speaker = Speaker::spawn(device.clone(), 70, log_to(&said)).expect("a thread");
        let (harness, input) = world_with_motor();
        // More plans than a queue holds don't block.
        (0..500).for_each(|_| speaker.play_tick(&harness.world, &input));
        let begun = Instant::now();
        while said.lock().expect("nobody panics").is_empty() && begun.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(5));
        }
        let lines = said.lock().expect("nobody panics").clone();
        assert!(lines.len() == 1 && lines[0].contains("libno-such-sound.so"), "{lines:?}");
        assert!(Speaker::spawn(device, 0, |_| panic!("it is off")).is_none());
    }
}

/// The environment variable that is set in the process that plays through ALSA's own library.
const INSIDE: &str = "PAROS_INSIDE_ALSA";

/// The real library accepts the calls, and writes the frames to a file instead of a card.
#[test]
fn alsa_takes_what_is_played() {
    let device = SoundDevice::of_system();
    if env::var_os(INSIDE).is_some() {
        return play_into_file(device);
    }
    // SAFETY: the system's sound library.
    let found = unsafe { libloading::Library::new(&device.library) };
    if require_or_skip(found).expect("ALSA (Debian: libasound2)").is_none() {
        return;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("alsa");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room on the disk");
    let (config, played) = (folder.join("asound.conf"), folder.join("played.raw"));
    let text = format!(
        "pcm.null {{ type null }}\npcm.default {{ type file slave.pcm null file \"{}\" format raw }}\n",
        played.display()
    );
    fs::write(&config, text).expect("room on the disk");
    assert_eq!(play_in_process(&config), "");
    let bytes = fs::read(&played).expect("frames");
    let samples = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let loudest = samples.fold(0.0f32, |loudest, sample| loudest.max(sample.abs()));
    assert!((0.03..0.5).contains(&loudest), "{loudest}");
    fs::remove_file(&played).expect("it was written");
    // Without a device the library's own error handler would print a lot.
    fs::write(&config, "pcm.null { type null }\n").expect("room on the disk");
    assert_eq!(play_in_process(&config), "no sound: snd_pcm_open: No such file or directory\n");
}

/// Runs the test again in a process of its own, with this configuration of ALSA. Returns its error output.
fn play_in_process(config: &Path) -> String {
    let mut again = Command::new(env::current_exe().expect("this test"));
    again.args(["--exact", "devices::alsa_takes_what_is_played", "--nocapture"]);
    let output = again.env(INSIDE, "1").env("ALSA_CONFIG_PATH", config).output();
    let output = output.expect("it starts again");
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stderr).expect("text")
}

/// Plays a motor for a moment. The file device takes frames as fast as they are made.
fn play_into_file(device: SoundDevice) {
    let mut speaker = Speaker::spawn(device, 100, |line| eprintln!("{line}")).expect("a thread");
    let (harness, input) = world_with_motor();
    for _ in 0..10 {
        speaker.play_tick(&harness.world, &input);
        thread::sleep(Duration::from_millis(9));
    }
}
