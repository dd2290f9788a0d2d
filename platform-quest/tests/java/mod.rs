//! A Java VM that checks every call (`-Xcheck:jni`), in a process of its own.

use std::env;
use std::process::Command;

use jni::{InitArgsBuilder, JNIVersion, JavaVM};
use paros_shell::require::require_or_skip;

/// The environment variable of the child process whose calls are checked.
const INSIDE: &str = "PAROS_INSIDE_JAVA";

/// Returns `true` if there is a JDK.
pub(crate) fn has_jdk() -> bool {
    let starts = |program: &&str| Command::new(program).arg("-version").output().is_ok();
    let missing = ["java", "javac", "javap"].into_iter().find(|program| !starts(program));
    require_or_skip(missing.map_or(Ok(()), |program| Err(format!("no {program}"))))
        .expect("a JDK")
        .is_some()
}

/// Starts the Java VM of this process, which checks every call. It only uses the quick compiler, as it
/// doesn't run for long.
pub(crate) fn start_checked_vm(arguments: InitArgsBuilder<'_>) -> JavaVM {
    let arguments = arguments.version(JNIVersion::V1_8).option("-Xcheck:jni");
    let arguments = arguments.option("-XX:TieredStopAtLevel=1").option("-XX:+UseSerialGC");
    JavaVM::new(arguments.build().expect("arguments")).expect("a JDK's machine")
}

/// Runs the body of the test of this name in a child process, and asserts that the VM there reports no fault.
/// The VM reports faults on standard output, which only the parent process can read.
pub(crate) fn run_in_checked_vm(test: &str, body: impl FnOnce()) {
    const DONE: &str = "all calls made";

    if env::var_os(INSIDE).is_some() {
        body();
        println!("{DONE}");
        return;
    }
    if !has_jdk() {
        return;
    }
    let mut again = Command::new(env::current_exe().expect("this test"));
    again.args(["--exact", test, "--nocapture"]).env(INSIDE, "1");
    let output = again.output().expect("it starts again");
    let told =
        [output.stdout, output.stderr].map(|told| String::from_utf8_lossy(&told).into_owned());
    let told = told.concat();
    assert!(output.status.success(), "{told}");
    assert!(!told.contains("WARNING") && !told.contains("FATAL"), "{told}");
    assert!(told.contains(DONE), "{told}");
}
