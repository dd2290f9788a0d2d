//! The host's Java VM with the stubs, the stubs' answers, and a device that uses them.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use jni::objects::{Global, JObject, JString};
use jni::{Env, InitArgsBuilder, JValue, JavaVM, jni_sig, jni_str};
use paros_quest::device::AndroidDevice;

use super::compile_stubs;
use crate::java::start_checked_vm;

/// Returns the folder of the stubs; every process has its own.
pub(crate) fn stubs_folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("android-{}", std::process::id()))
}

/// The Java VM: a process can start only one.
static VM: LazyLock<JavaVM> = LazyLock::new(|| {
    compile_stubs(&stubs_folder()).expect("the sources are right");
    let classes = format!("-Djava.class.path={}", stubs_folder().join("classes").display());
    let arguments = InitArgsBuilder::new();
    start_checked_vm(arguments.option(&classes))
});

/// Creates a device of an API level, with a context of the stubs.
pub(crate) fn device_at_level(level: i32) -> AndroidDevice {
    set_field("android.os.Build$VERSION.SDK_INT", &format!("I:{level}"));
    let context = with_java(|env| {
        let context = env.new_object(jni_str!("android/content/Context"), jni_sig!("()V"), &[])?;
        env.new_global_ref(context)
    });
    let context: Global<JObject<'static>> = context;
    // SAFETY: both live, and the second is a context.
    unsafe { AndroidDevice::from_raw(VM.get_raw().cast(), context.as_raw().cast()) }
        .expect("a device")
}

/// Sets the return value of a stub's method from now on.
pub(crate) fn set_answer(member: &str, answer: &str) {
    call_fake(
        |env, arguments| {
            let (name, how) =
                (jni_str!("set"), jni_sig!("(Ljava/lang/String;Ljava/lang/String;)V"));
            env.call_static_method(jni_str!("paros/Fake"), name, how, arguments)?.into_void()
        },
        [member, answer],
    );
}

/// Sets a static field of a stub.
pub(crate) fn set_field(field: &str, answer: &str) {
    call_fake(
        |env, arguments| {
            let (name, how) =
                (jni_str!("field"), jni_sig!("(Ljava/lang/String;Ljava/lang/String;)V"));
            env.call_static_method(jni_str!("paros/Fake"), name, how, arguments)?.into_void()
        },
        [field, answer],
    );
}

/// Takes the log of the stubs' calls since the last take, one a line.
pub(crate) fn take_calls() -> String {
    with_java(|env| {
        let how = jni_sig!("()Ljava/lang/String;");
        let calls = env.call_static_method(jni_str!("paros/Fake"), jni_str!("calls"), how, &[])?;
        let calls = calls.into_object()?;
        env.cast_local::<JString<'_>>(calls)?.try_to_string(env)
    })
}

/// Calls a method of `paros.Fake` with two strings.
fn call_fake(
    what: impl FnOnce(&mut Env<'_>, &[JValue<'_>]) -> jni::errors::Result<()>,
    texts: [&str; 2],
) {
    with_java(|env| {
        let [a, b] = [env.new_string(texts[0])?, env.new_string(texts[1])?];
        what(env, &[JValue::Object(&a), JValue::Object(&b)])
    });
}

fn with_java<T>(what: impl FnOnce(&mut Env<'_>) -> jni::errors::Result<T>) -> T {
    VM.attach_current_thread(what).expect("the stubs do it")
}
