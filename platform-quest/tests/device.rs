//! The calls into Android's Java classes, made on the host's JDK: stubs of the classes are made from
//! the table, and the machine checks every call (`-Xcheck:jni`).

mod android;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::time::{Duration, Instant};
use std::{env, fs};

use jni::objects::{Global, JObject, JString};
use jni::{Env, InitArgsBuilder, JNIVersion, JValue, JavaVM, jni_sig, jni_str};
use paros_quest::device::table::ALL;
use paros_quest::device::{self, Battery, Device, ROWS, Row, Thermal, Watch};
use paros_quest::runtime::{COLUMNS, FUNCTIONS, NEGOTIATE, Named, ask};
use paros_quest::strain::{Heat, Strain};
use paros_shell::require::require;

use android::{classes, compile, is_android, javap, told};

/// Set in the process whose calls are checked.
const INSIDE: &str = "PAROS_INSIDE_JAVA";

/// Where the stubs are. Every process has its own.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("android-{}", std::process::id()))
}

/// One machine a process: Java can't start a second.
static VM: LazyLock<JavaVM> = LazyLock::new(|| {
    compile(&folder()).expect("the sources are right");
    let classes = format!("-Djava.class.path={}", folder().join("classes").display());
    let arguments = InitArgsBuilder::new().version(JNIVersion::V1_8);
    let arguments = arguments.option("-Xcheck:jni").option(&classes).build().expect("arguments");
    JavaVM::new(arguments).expect("a JDK's machine")
});

/// Whether there is a JDK.
fn has_jdk() -> bool {
    let starts = |program: &&str| Command::new(program).arg("-version").output().is_ok();
    let missing = ["java", "javac", "javap"].into_iter().find(|program| !starts(program));
    require(missing.map_or(Ok(()), |program| Err(format!("no {program}"))))
        .expect("a JDK")
        .is_some()
}

#[test]
fn the_stubs_are_what_the_table_says() {
    if !has_jdk() {
        return;
    }
    let folder = folder();
    compile(&folder).expect("the sources are right");
    for (class, members) in classes() {
        let found = javap(&folder, class);
        for member in &members {
            assert!(found.contains(&told(member)), "{class}: no {} in {found:?}", told(member));
        }
        // And nothing else, but the constructor that `javap` calls by the whole class name.
        let members = found.iter().filter(|told| !told.contains("android."));
        assert!(!is_android(class) || members.count() == members_of(class), "{class}: {found:?}");
    }
    let _ = fs::remove_dir_all(folder);
}

fn members_of(class: &str) -> usize {
    classes()[class].len()
}

#[test]
fn the_table_names_its_sources() {
    for member in ALL {
        let page = member.class.replace('$', ".");
        assert!(member.source.starts_with(&format!("{page}#{}", member.name)), "{}", member.source);
        assert!((1..=34).contains(&member.since));
    }
}

/// The checks are told on standard output, which only another process can read.
#[test]
fn every_call_is_right() {
    if env::var_os(INSIDE).is_some() {
        return inside();
    }
    if !has_jdk() {
        return;
    }
    let mut again = Command::new(env::current_exe().expect("this test"));
    again.args(["--exact", "every_call_is_right", "--nocapture"]).env(INSIDE, "1");
    let output = again.output().expect("it starts again");
    let told =
        [output.stdout, output.stderr].map(|told| String::from_utf8_lossy(&told).into_owned());
    let told = told.concat();
    assert!(output.status.success(), "{told}");
    assert!(!told.contains("WARNING") && !told.contains("FATAL"), "{told}");
    assert!(told.contains("all calls made"), "{told}");
}

fn inside() {
    names();
    batteries();
    heats();
    storages();
    networks();
    queries();
    brokers();
    exceptions();
    watching();
    let _ = fs::remove_dir_all(folder());
    println!("all calls made");
}

fn names() {
    field("android.os.Build.MANUFACTURER", "S:Oculus");
    field("android.os.Build.MODEL", "S:Quest 3");
    assert_eq!(device(29).name().expect("a name"), "Oculus Quest 3");
    field("android.os.Build.MANUFACTURER", "N:");
    assert_eq!(device(29).name().expect("a name"), "Quest 3");
    assert_eq!(device(31).level(), 31);
}

fn batteries() {
    let device = device(29);
    let unknown = Battery { percent: None, charging: false };
    set("Context.getSystemService[batterymanager]", "N:");
    assert_eq!(device.battery().expect("an answer"), unknown);
    set("Context.getSystemService[batterymanager]", "O:android.os.BatteryManager");
    set("BatteryManager.getIntProperty[4]", "I:57");
    set("BatteryManager.isCharging", "Z:true");
    let expected = Battery { percent: Some(57), charging: true };
    assert_eq!(device.battery().expect("an answer"), expected);
    set("BatteryManager.getIntProperty[4]", "I:-2147483648");
    assert_eq!(device.battery().expect("an answer").percent, None);
    calls();
    // Older than the call that tells of charging.
    assert_eq!(self::device(22).battery().expect("an answer"), unknown);
    assert!(!calls().contains("isCharging"));
}

fn heats() {
    set("Context.getSystemService[power]", "O:android.os.PowerManager");
    set("PowerManager.getCurrentThermalStatus", "I:3");
    set("PowerManager.getThermalHeadroom[10]", "F:0.75");
    let heat = device(30).heat().expect("an answer");
    assert_eq!(heat, device::Heat { status: Thermal::Severe, headroom: Some(0.75) });
    calls();
    let early = device::Heat { status: Thermal::Severe, headroom: None };
    assert_eq!(device(29).heat().expect("an answer"), early);
    assert!(!calls().contains("getThermalHeadroom"));
    let before = device::Heat { status: Thermal::None, headroom: None };
    assert_eq!(device(28).heat().expect("an answer"), before);
    set("PowerManager.getThermalHeadroom[10]", "F:NaN");
    assert_eq!(device(30).heat().expect("an answer").headroom, None);
    for (number, status) in [(0, Thermal::None), (6, Thermal::Shutdown), (9, Thermal::Shutdown)] {
        set("PowerManager.getCurrentThermalStatus", &format!("I:{number}"));
        assert_eq!(device(29).heat().expect("an answer").status, status);
    }
}

fn storages() {
    set("Context.getExternalFilesDir[null]", "P:/storage/emulated/0/paros");
    set("Context.getFilesDir", "P:/data/user/0/paros");
    let at = || device(29).storage().expect("a folder");
    assert_eq!(at(), Path::new("/storage/emulated/0/paros"));
    set("Context.getExternalFilesDir[null]", "N:");
    assert_eq!(at(), Path::new("/data/user/0/paros"));
    set("Context.getFilesDir", "N:");
    let why = device(29).storage().expect_err("there is none").to_string();
    assert_eq!(why, "android/content/Context.getFilesDir: null");
}

fn networks() {
    let online = || device(29).online().expect("an answer");
    set("Context.getSystemService[connectivity]", "O:android.net.ConnectivityManager");
    set("ConnectivityManager.getActiveNetwork", "N:");
    assert!(!online());
    set("ConnectivityManager.getActiveNetwork", "O:android.net.Network");
    assert!(!online());
    set("ConnectivityManager.getNetworkCapabilities[Network]", "O:android.net.NetworkCapabilities");
    set("NetworkCapabilities.hasCapability[16]", "Z:false");
    assert!(!online());
    set("NetworkCapabilities.hasCapability[16]", "Z:true");
    assert!(online());
}

fn queries() {
    let ask = || device(29).query("content://a/b", &["one", "two", "three"]).expect("an answer");
    let nothing: [Row; 0] = [];
    set("Context.getContentResolver", "O:android.content.ContentResolver");
    set("Uri.parse[content://a/b]", "O:android.net.Uri");
    calls();
    assert_eq!(ask(), nothing);
    assert!(calls().ends_with("ContentResolver.query[Uri, [one, two, three], null, null, null]"));
    set("ContentResolver.query", "O:android.database.Cursor");
    set("Cursor.moveToNext", "Z:false");
    set("Cursor.getColumnIndex[one]", "I:7");
    set("Cursor.getColumnIndex[two]", "I:-1");
    set("Cursor.getColumnIndex[three]", "I:0");
    assert_eq!(ask(), nothing);
    assert!(calls().ends_with("Cursor.moveToNext[]\nCursor.close[]"));
    set("Cursor.moveToNext", "Z:true\nZ:true\nZ:false");
    set("Cursor.getString[7]", "S:grüße \u{1f3db}\nS:more");
    set("Cursor.getString[0]", "N:");
    let rows = ["grüße \u{1f3db}", "more"].map(|text| vec![Some(text.to_owned()), None, None]);
    assert_eq!(ask(), rows);
    // An answer that never ends.
    set("Cursor.moveToNext", "Z:true");
    assert_eq!(ask().len(), ROWS);
    // A refusal in the middle still ends the answer.
    set("Cursor.getString[7]", "E:closed");
    calls();
    assert!(device(29).query("content://a/b", &["one"]).is_err());
    assert!(calls().ends_with("Cursor.close[]"));
}

/// A broker whose runtime has names of its own: one row, then the functions'.
fn brokers() {
    let runtimes = "content://org.khronos.openxr.runtime_broker/openxr/1/abi/arm64-v8a/runtimes";
    set(&format!("Uri.parse[{runtimes}/active/0]"), "O:android.net.Uri");
    set(&format!("Uri.parse[{runtimes}/com.maker.runtime/functions]"), "O:android.net.Uri");
    for (column, name) in COLUMNS.iter().chain(&FUNCTIONS).enumerate() {
        set(&format!("Cursor.getColumnIndex[{name}]"), &format!("I:{column}"));
    }
    let answers =
        ["S:/vendor", "S:maker.so", "S:com.maker.runtime", "S:1", "S:a", "S:maker_negotiate"];
    for (column, answer) in answers.into_iter().enumerate() {
        set(&format!("Cursor.getString[{column}]"), answer);
    }
    set("Cursor.getString[4]", &format!("S:xrInitializeLoaderKHR\nS:{NEGOTIATE}"));
    set("Cursor.getString[5]", "S:maker_initialize\nS:maker_negotiate");
    set("Cursor.moveToNext", "Z:true\nZ:false\nZ:true\nZ:true\nZ:false");
    let device = device(29);
    let named = ask(|table, columns| device.query(table, columns)).expect("it is named");
    let expected =
        Named { library: "/vendor/maker.so".into(), negotiate: "maker_negotiate".into() };
    assert_eq!(named, expected);
    // The package may not be asked.
    set("ContentResolver.query", "O:android.database.Cursor\nE:not yours");
    set("Cursor.moveToNext", "Z:true\nZ:false");
    let why = ask(|table, columns| device.query(table, columns)).expect_err("it was thrown");
    assert!(why.to_string().contains("not yours"), "{why}");
}

fn exceptions() {
    set("Context.getSystemService[power]", "E:not today");
    let why = device(29).heat().expect_err("it was thrown").to_string();
    assert!(why.starts_with("android/content/Context.getSystemService: "), "{why}");
    assert!(why.contains("java.lang.SecurityException") && why.contains("not today"), "{why}");
    // Nothing is pending.
    set("Context.getSystemService[power]", "O:android.os.PowerManager");
    assert!(device(29).heat().is_ok());
    // Polled all day, no reference is left behind: the machine would warn beyond its frame of 16.
    let device = device(30);
    (0..1000).for_each(|_| assert!(device.heat().is_ok()));
}

/// Another thread asks, so that no frame waits.
fn watching() {
    set("PowerManager.getCurrentThermalStatus", "I:4");
    set("BatteryManager.getIntProperty[4]", "I:12");
    set("BatteryManager.isCharging", "Z:false");
    let watch = Watch::new(device(30));
    let expected = Strain { heat: Heat::Hot, charge: Some(12) };
    let begun = Instant::now();
    while watch.strain() != expected {
        assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", watch.strain());
        std::thread::sleep(Duration::from_millis(5));
    }
    // It is over at once, not when it would ask again.
    let begun = Instant::now();
    drop(watch);
    assert!(begun.elapsed() < Duration::from_secs(5));
}

/// A device of an API level, of a stub's context.
fn device(level: i32) -> Device {
    field("android.os.Build$VERSION.SDK_INT", &format!("I:{level}"));
    let context = java(|env| {
        let context = env.new_object(jni_str!("android/content/Context"), jni_sig!("()V"), &[])?;
        env.new_global_ref(context)
    });
    let context: Global<JObject<'static>> = context;
    // SAFETY: both live, and the second is a context.
    unsafe { Device::new(VM.get_raw().cast(), context.as_raw().cast()) }.expect("a device")
}

/// What the stubs answer from now on.
fn set(member: &str, answer: &str) {
    tell(
        |env, arguments| {
            let (name, how) =
                (jni_str!("set"), jni_sig!("(Ljava/lang/String;Ljava/lang/String;)V"));
            env.call_static_method(jni_str!("paros/Fake"), name, how, arguments)?.into_void()
        },
        [member, answer],
    );
}

fn field(field: &str, answer: &str) {
    tell(
        |env, arguments| {
            let (name, how) =
                (jni_str!("field"), jni_sig!("(Ljava/lang/String;Ljava/lang/String;)V"));
            env.call_static_method(jni_str!("paros/Fake"), name, how, arguments)?.into_void()
        },
        [field, answer],
    );
}

/// The calls since the last time, a line each.
fn calls() -> String {
    java(|env| {
        let how = jni_sig!("()Ljava/lang/String;");
        let calls = env.call_static_method(jni_str!("paros/Fake"), jni_str!("calls"), how, &[])?;
        let calls = calls.into_object()?;
        env.cast_local::<JString<'_>>(calls)?.try_to_string(env)
    })
}

fn tell(
    what: impl FnOnce(&mut Env<'_>, &[JValue<'_>]) -> jni::errors::Result<()>,
    texts: [&str; 2],
) {
    java(|env| {
        let [a, b] = [env.new_string(texts[0])?, env.new_string(texts[1])?];
        what(env, &[JValue::Object(&a), JValue::Object(&b)])
    });
}

fn java<T>(what: impl FnOnce(&mut Env<'_>) -> jni::errors::Result<T>) -> T {
    VM.attach_current_thread(what).expect("the stubs do it")
}
