//! The JNI calls, made on the host's JDK with stubs of Android's classes, which are generated from the
//! table. The Java VM checks every call (`-Xcheck:jni`).

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use paros_core::badge::Language;
use paros_headset::runtime::{
    BROKERS, ContentRow, FUNCTION_COLUMNS, INITIALIZE_FUNCTION, NEGOTIATE_FUNCTION,
    RUNTIME_COLUMNS, RuntimeLibrary, query_broker,
};
use paros_quest::device::table::{ALL_MEMBERS, MemberKind};
use paros_quest::device::{DeviceMonitor, MAX_ROWS, ManagedEntry};
use paros_shell::headset::device_health::{
    Battery, DeviceHealth, ThermalReading, ThermalState, ThermalStatus,
};
use paros_shell::settings::{LoadedSettings, SettingsLayer};

use crate::android::vm::{device_at_level, set_answer, set_field, stubs_folder, take_calls};
use crate::android::{compile_stubs, describe_member, is_android, members_by_class, run_javap};
use crate::java::{has_jdk, run_in_checked_vm};

#[test]
fn the_stubs_are_what_the_table_says() {
    if !has_jdk() {
        return;
    }
    let folder = stubs_folder();
    compile_stubs(&folder).expect("the sources are right");
    let table = members_by_class();
    let classes: Vec<_> = table.keys().copied().collect();
    let found = run_javap(&folder, &classes);
    assert_eq!(found.len(), classes.len());
    for ((class, members), found) in table.iter().zip(&found) {
        for member in members {
            assert!(
                found.contains(&describe_member(member)),
                "{class}: no {} in {found:?}",
                describe_member(member)
            );
        }
        // There are no other members, except the constructor, which `javap` prints under the whole class
        // name.
        let others = found.iter().filter(|told| !told.contains("android."));
        assert!(!is_android(class) || others.count() == members.len(), "{class}: {found:?}");
    }
    let _ = fs::remove_dir_all(folder);
}

#[test]
fn the_table_names_its_sources() {
    for member in ALL_MEMBERS {
        let page = member.class.replace('$', ".");
        let class = member.class.rsplit('/').next().expect("a name");
        let name = if member.kind == MemberKind::Constructor { class } else { member.name };
        assert!(member.source.starts_with(&format!("{page}#{name}")), "{}", member.source);
        assert!((1..=34).contains(&member.since));
    }
}

#[test]
fn every_call_is_right() {
    run_in_checked_vm("device::every_call_is_right", check_all_calls);
}

/// Runs all checks, in the child process.
fn check_all_calls() {
    check_names();
    check_batteries();
    check_thermal_readings();
    check_storage_folders();
    check_boot_counts();
    check_android_ids();
    check_networks();
    check_queries();
    check_brokers();
    check_managed_configurations();
    check_exceptions();
    check_monitor();
    let _ = fs::remove_dir_all(stubs_folder());
}

fn check_names() {
    set_field("android.os.Build.MANUFACTURER", "S:Oculus");
    set_field("android.os.Build.MODEL", "S:Quest 3");
    assert_eq!(
        device_at_level(29).read_manufacturer_and_model().expect("a name"),
        "Oculus Quest 3"
    );
    set_field("android.os.Build.MANUFACTURER", "N:");
    assert_eq!(device_at_level(29).read_manufacturer_and_model().expect("a name"), "Quest 3");
    assert_eq!(device_at_level(31).api_level(), 31);
}

fn check_batteries() {
    let device = device_at_level(29);
    let unknown = Battery { percent: None, charging: false };
    set_answer("Context.getSystemService[batterymanager]", "N:");
    assert_eq!(device.read_battery().expect("an answer"), unknown);
    set_answer("Context.getSystemService[batterymanager]", "O:android.os.BatteryManager");
    set_answer("BatteryManager.getIntProperty[4]", "I:57");
    set_answer("BatteryManager.isCharging", "Z:true");
    let expected = Battery { percent: Some(57), charging: true };
    assert_eq!(device.read_battery().expect("an answer"), expected);
    set_answer("BatteryManager.getIntProperty[4]", "I:-2147483648");
    assert_eq!(device.read_battery().expect("an answer").percent, None);
    take_calls();
    // A device older than `isCharging`.
    assert_eq!(self::device_at_level(22).read_battery().expect("an answer"), unknown);
    assert!(!take_calls().contains("isCharging"));
}

fn check_thermal_readings() {
    set_answer("Context.getSystemService[power]", "O:android.os.PowerManager");
    set_answer("PowerManager.getCurrentThermalStatus", "I:3");
    set_answer("PowerManager.getThermalHeadroom[10]", "F:0.75");
    let heat = device_at_level(30).read_thermal().expect("an answer");
    assert_eq!(heat, ThermalReading { status: ThermalStatus::Severe, headroom: Some(0.75) });
    take_calls();
    let early = ThermalReading { status: ThermalStatus::Severe, headroom: None };
    assert_eq!(device_at_level(29).read_thermal().expect("an answer"), early);
    assert!(!take_calls().contains("getThermalHeadroom"));
    let before = ThermalReading { status: ThermalStatus::None, headroom: None };
    assert_eq!(device_at_level(28).read_thermal().expect("an answer"), before);
    set_answer("PowerManager.getThermalHeadroom[10]", "F:NaN");
    assert_eq!(device_at_level(30).read_thermal().expect("an answer").headroom, None);
    for (number, status) in
        [(0, ThermalStatus::None), (6, ThermalStatus::Shutdown), (9, ThermalStatus::Shutdown)]
    {
        set_answer("PowerManager.getCurrentThermalStatus", &format!("I:{number}"));
        assert_eq!(device_at_level(29).read_thermal().expect("an answer").status, status);
    }
}

fn check_storage_folders() {
    set_answer("Context.getExternalFilesDir[null]", "P:/storage/emulated/0/paros");
    set_answer("Context.getFilesDir", "P:/data/user/0/paros");
    let at = || device_at_level(29).find_storage_folder().expect("a folder");
    assert_eq!(at(), Path::new("/storage/emulated/0/paros"));
    // A computer can read the storage folder, and no other app the private one.
    let private = || device_at_level(29).find_private_folder();
    assert_eq!(private().expect("a folder"), Path::new("/data/user/0/paros"));
    set_answer("Context.getExternalFilesDir[null]", "N:");
    assert_eq!(at(), Path::new("/data/user/0/paros"));
    set_answer("Context.getFilesDir", "N:");
    assert!(private().is_err());
    let why = device_at_level(29).find_storage_folder().expect_err("there is none").to_string();
    assert_eq!(why, "android/content/Context.getFilesDir: null");
}

fn check_boot_counts() {
    set_answer("Context.getContentResolver", "N:");
    let count = || device_at_level(29).read_boot_count().expect("an answer");
    assert_eq!(count(), None);
    set_answer("Context.getContentResolver", "O:android.content.ContentResolver");
    let setting = "Settings$Global.getInt[ContentResolver, boot_count, -1]";
    set_answer(setting, "I:41");
    assert_eq!(count(), Some(41));
    set_answer(setting, "I:-1");
    assert_eq!(count(), None);
    set_answer(setting, "E:not yours");
    assert!(device_at_level(29).read_boot_count().is_err());
    // A device older than the method.
    assert_eq!(self::device_at_level(16).read_boot_count().expect("an answer"), None);
}

fn check_android_ids() {
    let read = || device_at_level(29).read_android_id();
    let setting = "Settings$Secure.getString[ContentResolver, android_id]";
    set_answer("Context.getContentResolver", "O:android.content.ContentResolver");
    assert_eq!(read().expect("an answer"), None);
    set_answer(setting, "S:9774d56d682e549c");
    assert_eq!(read().expect("an answer").as_deref(), Some("9774d56d682e549c"));
    set_answer(setting, "S:");
    assert_eq!(read().expect("an answer"), None);
    set_answer(setting, "E:not yours");
    assert!(read().is_err());
}

fn check_networks() {
    let online = || device_at_level(29).is_online().expect("an answer");
    set_answer("Context.getSystemService[connectivity]", "O:android.net.ConnectivityManager");
    set_answer("ConnectivityManager.getActiveNetwork", "N:");
    assert!(!online());
    set_answer("ConnectivityManager.getActiveNetwork", "O:android.net.Network");
    assert!(!online());
    set_answer(
        "ConnectivityManager.getNetworkCapabilities[Network]",
        "O:android.net.NetworkCapabilities",
    );
    set_answer("NetworkCapabilities.hasCapability[16]", "Z:false");
    assert!(!online());
    set_answer("NetworkCapabilities.hasCapability[16]", "Z:true");
    assert!(online());
}

fn check_queries() {
    let ask = || {
        device_at_level(29)
            .query_first_content_rows("content://a/b", &["one", "two", "three"])
            .expect("an answer")
    };
    let nothing: [ContentRow; 0] = [];
    set_answer("Context.getContentResolver", "O:android.content.ContentResolver");
    set_answer("Uri.parse[content://a/b]", "O:android.net.Uri");
    take_calls();
    assert_eq!(ask(), nothing);
    assert!(
        take_calls().ends_with("ContentResolver.query[Uri, [one, two, three], null, null, null]")
    );
    set_answer("ContentResolver.query", "O:android.database.Cursor");
    set_answer("Cursor.moveToNext", "Z:false");
    set_answer("Cursor.getColumnIndex[one]", "I:7");
    set_answer("Cursor.getColumnIndex[two]", "I:-1");
    set_answer("Cursor.getColumnIndex[three]", "I:0");
    assert_eq!(ask(), nothing);
    assert!(take_calls().ends_with("Cursor.moveToNext[]\nCursor.close[]"));
    set_answer("Cursor.moveToNext", "Z:true\nZ:true\nZ:false");
    set_answer("Cursor.getString[7]", "S:grüße \u{1f3db}\nS:more");
    set_answer("Cursor.getString[0]", "N:");
    let rows = ["grüße \u{1f3db}", "more"].map(|text| vec![Some(text.to_owned()), None, None]);
    assert_eq!(ask(), rows);
    // A result that never ends.
    set_answer("Cursor.moveToNext", "Z:true");
    assert_eq!(ask().len(), MAX_ROWS);
    // An error in the middle still closes the cursor.
    set_answer("Cursor.getString[7]", "E:closed");
    take_calls();
    assert!(device_at_level(29).query_first_content_rows("content://a/b", &["one"]).is_err());
    assert!(take_calls().ends_with("Cursor.close[]"));
}

/// Checks a broker whose runtime renames functions: one row, then the functions' rows.
fn check_brokers() {
    let runtimes = "content://org.khronos.openxr.runtime_broker/openxr/1/abi/arm64-v8a/runtimes";
    for table in ["active", "active/0"] {
        set_answer(&format!("Uri.parse[{runtimes}/{table}]"), "O:android.net.Uri");
    }
    set_answer(&format!("Uri.parse[{runtimes}/com.maker.runtime/functions]"), "O:android.net.Uri");
    for (column, name) in RUNTIME_COLUMNS.iter().chain(&FUNCTION_COLUMNS).enumerate() {
        set_answer(&format!("Cursor.getColumnIndex[{name}]"), &format!("I:{column}"));
    }
    let answers =
        ["S:/vendor", "S:maker.so", "S:com.maker.runtime", "S:1", "S:a", "S:maker_negotiate"];
    for (column, answer) in answers.into_iter().enumerate() {
        set_answer(&format!("Cursor.getString[{column}]"), answer);
    }
    set_answer("Cursor.getString[4]", &format!("S:{INITIALIZE_FUNCTION}\nS:{NEGOTIATE_FUNCTION}"));
    set_answer("Cursor.getString[5]", "S:maker_initialize\nS:maker_negotiate");
    set_answer("Cursor.moveToNext", "Z:true\nZ:false\nZ:true\nZ:true\nZ:false");
    let device = device_at_level(29);
    let name_first = || {
        let mut query = |table: &str, columns: &[&str]| {
            let rows = device.query_first_content_rows(table, columns);
            rows.map_err(|error| error.to_string())
        };
        query_broker(BROKERS[0], &mut query).remove(0).library
    };
    let expected = RuntimeLibrary {
        path: "/vendor/maker.so".into(),
        initialize_symbol: "maker_initialize".into(),
        negotiate_symbol: Some("maker_negotiate".into()),
    };
    assert_eq!(name_first(), Ok(expected));
    // The package may not query the broker.
    set_answer("ContentResolver.query", "E:not yours");
    let why = name_first().expect_err("it was thrown");
    assert!(why.contains("not yours"), "{why}");
    // Only the query for the function names is refused.
    set_answer("ContentResolver.query", "O:android.database.Cursor\nE:not yours");
    set_answer("Cursor.moveToNext", "Z:true\nZ:false");
    let why = name_first().expect_err("it was thrown");
    assert!(why.starts_with("/vendor/maker.so: ") && why.contains("not yours"), "{why}");
}

fn check_managed_configurations() {
    let read = || device_at_level(29).read_managed_configuration();
    let entry = |key: &str, value: &str| ManagedEntry { key: key.into(), value: value.into() };
    set_answer("Context.getSystemService[restrictions]", "N:");
    assert_eq!(read().expect("an answer"), []);
    set_answer("Context.getSystemService[restrictions]", "O:android.content.RestrictionsManager");
    set_answer("RestrictionsManager.getApplicationRestrictions", "N:");
    assert_eq!(read().expect("an answer"), []);
    set_answer("RestrictionsManager.getApplicationRestrictions", "O:android.os.Bundle");
    // The bundle of an unmanaged device is empty.
    set_answer("BaseBundle.keySet", "O:java.util.HashSet");
    assert_eq!(read().expect("an answer"), []);
    set_answer("BaseBundle.keySet", "K:submit_depth,mode,handover_seconds,languages,visits,none");
    set_answer("BaseBundle.get[mode]", "S:owl");
    set_answer("BaseBundle.get[handover_seconds]", "I:120");
    set_answer("BaseBundle.get[submit_depth]", "Z:true");
    set_answer("BaseBundle.get[visits]", "Z:true");
    set_answer("BaseBundle.get[languages]", "S:greek, english");
    let entries = read().expect("an answer");
    let expected = [
        entry("handover_seconds", "120"),
        entry("languages", "greek, english"),
        entry("mode", "owl"),
        entry("submit_depth", "true"),
        entry("visits", "true"),
    ];
    assert_eq!(entries, expected);
    let texts = entries.iter().map(|entry| (&*entry.key, &*entry.value));
    let layer = SettingsLayer::from_texts("managed configuration", texts, &[]);
    let settings = LoadedSettings::merge(&[layer]).settings;
    assert_eq!((settings.handover_after.as_secs(), settings.submit_depth), (120, true));
    let languages = settings.visits.map(|visits| visits.languages);
    assert_eq!(languages, Some(vec![Language::Greek, Language::English]));
    // Many entries leak no reference: the VM would warn beyond its frame of 16.
    let many: Vec<_> = (0..300).map(|i| format!("mode{i}")).collect();
    set_answer("BaseBundle.keySet", &format!("K:{}", many.join(",")));
    set_answer("BaseBundle.get", "S:owl");
    assert_eq!(read().expect("an answer").len(), 256);
    set_answer("BaseBundle.get", "E:not today");
    assert!(read().is_err_and(|why| why.to_string().contains("not today")));
}

fn check_exceptions() {
    set_answer("Context.getSystemService[power]", "E:not today");
    let why = device_at_level(29).read_thermal().expect_err("it was thrown").to_string();
    assert!(why.starts_with("android/content/Context.getSystemService: "), "{why}");
    assert!(why.contains("java.lang.SecurityException") && why.contains("not today"), "{why}");
    // No exception is pending.
    set_answer("Context.getSystemService[power]", "O:android.os.PowerManager");
    assert!(device_at_level(29).read_thermal().is_ok());
    // A day's polling leaks no reference: the VM would warn beyond its frame of 16.
    let device = device_at_level(30);
    (0..1000).for_each(|_| assert!(device.read_thermal().is_ok()));
}

/// The monitor polls on a thread of its own, and ends at once.
fn check_monitor() {
    set_answer("PowerManager.getCurrentThermalStatus", "I:4");
    set_answer("BatteryManager.getIntProperty[4]", "I:12");
    set_answer("BatteryManager.isCharging", "Z:false");
    let monitor = DeviceMonitor::start_polling(device_at_level(30));
    let expected = DeviceHealth {
        thermal: ThermalState::Hot,
        battery_percent: Some(12),
        battery: Battery { percent: Some(12), charging: false },
        ..DeviceHealth::default()
    };
    let begun = Instant::now();
    while monitor.latest() != expected {
        assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", monitor.latest());
        std::thread::sleep(Duration::from_millis(5));
    }
    // The thread ends at once, not after its poll interval.
    let begun = Instant::now();
    drop(monitor);
    assert!(begun.elapsed() < Duration::from_secs(5));
}
