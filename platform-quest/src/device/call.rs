//! JNI calls of the table's members. A member that is newer than the device's API level is not called. A Java
//! exception becomes an error.

use std::fmt;

use jni::Env;
use jni::errors::Error as JniError;
use jni::objects::{Global, JByteArray, JObject, JString, JThrowable};
use jni::signature::{RuntimeFieldSignature, RuntimeMethodSignature};
use jni::strings::JNIString;
use jni::{JValue, JValueOwned};

use super::table::{JavaMember, MemberKind, SDK_INT};

/// A call into Java that failed.
#[derive(Debug)]
pub struct JavaError {
    /// The member that was called; `None` if the thread could not be attached to the VM.
    pub member: Option<JavaMember>,
    /// The class of the exception that was thrown, if any, for instance `java.net.SocketTimeoutException`.
    pub thrown: Option<Box<str>>,
    /// `true` if the exception or one of its causes is about keys and certificates.
    pub is_about_trust: bool,
    /// The reason, for instance the exception's class and message.
    pub why: String,
}

impl JavaError {
    /// Returns the error for a member whose value must not be null, but is.
    pub(super) fn null(member: JavaMember) -> Self {
        JavaError { member: Some(member), thrown: None, is_about_trust: false, why: "null".into() }
    }
}

impl fmt::Display for JavaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.member {
            Some(member) => write!(f, "{}.{}: {}", member.class, member.name, self.why),
            None => f.write_str(&self.why),
        }
    }
}

impl std::error::Error for JavaError {}

impl From<JniError> for JavaError {
    fn from(error: JniError) -> Self {
        JavaError { member: None, thrown: None, is_about_trust: false, why: error.to_string() }
    }
}

/// The superclass of all exceptions about keys and certificates, whichever provider checks them.
const SECURITY_EXCEPTION: &str = "java/security/GeneralSecurityException";

/// The maximum number of causes that are examined: a bound, as an exception may be its own cause.
const MAX_CAUSES: usize = 8;

/// The JNI environment of an attached thread, with the device's API level.
pub(super) struct JavaCaller<'env, 'local> {
    env: &'env mut Env<'local>,
    api_level: i32,
}

impl<'env, 'local> JavaCaller<'env, 'local> {
    /// Creates a caller for a device of this API level.
    pub(super) fn new(env: &'env mut Env<'local>, device_api_level: i32) -> Self {
        JavaCaller { env, api_level: device_api_level }
    }

    /// Reads the device's API level.
    pub(super) fn read_api_level(env: &'env mut Env<'local>) -> Result<i32, JavaError> {
        // Every supported version of Android has this field.
        let mut caller = JavaCaller::new(env, SDK_INT.since);
        caller
            .call_or_read_static_if_available(SDK_INT, &[])?
            .map_or(Ok(0), |value| read_int(SDK_INT, value))
    }

    /// Calls a method of an object. Returns `None` if the device is older than the method.
    pub(super) fn call_method_if_available(
        &mut self,
        member: JavaMember,
        object: &JObject<'_>,
        arguments: &[JValue<'_>],
    ) -> Result<Option<JValueOwned<'local>>, JavaError> {
        debug_assert_eq!(member.kind, MemberKind::Method);
        if self.api_level < member.since {
            return Ok(None);
        }
        let name = JNIString::from(member.name);
        let called = RuntimeMethodSignature::from_str(member.signature).and_then(|signature| {
            self.env.call_method(object, name, signature.method_signature(), arguments)
        });
        self.catch_exception(member, called).map(Some)
    }

    /// Calls a static method or reads a static field. Returns `None` if the device is older than the member.
    pub(super) fn call_or_read_static_if_available(
        &mut self,
        member: JavaMember,
        arguments: &[JValue<'_>],
    ) -> Result<Option<JValueOwned<'local>>, JavaError> {
        if self.api_level < member.since {
            return Ok(None);
        }
        let [class, name] = [member.class, member.name].map(JNIString::from);
        let called = if member.kind == MemberKind::StaticField {
            RuntimeFieldSignature::from_str(member.signature).and_then(|signature| {
                self.env.get_static_field(class, name, signature.field_signature())
            })
        } else {
            RuntimeMethodSignature::from_str(member.signature).and_then(|signature| {
                self.env.call_static_method(class, name, signature.method_signature(), arguments)
            })
        };
        self.catch_exception(member, called).map(Some)
    }

    /// Calls a method that returns an object. Returns `None` if the object is null, or the device is older
    /// than the method.
    pub(super) fn call_object_method_if_available(
        &mut self,
        member: JavaMember,
        object: &JObject<'_>,
        arguments: &[JValue<'_>],
    ) -> Result<Option<JObject<'local>>, JavaError> {
        let Some(value) = self.call_method_if_available(member, object, arguments)? else {
            return Ok(None);
        };
        let object = value.into_object().map_err(|error| member_error(member, &error))?;
        Ok((!object.is_null()).then_some(object))
    }

    /// Creates a Java string.
    pub(super) fn new_string(&mut self, text: &str) -> Result<JString<'local>, JavaError> {
        Ok(self.env.new_string(text)?)
    }

    /// Creates an array of Java strings.
    pub(super) fn new_string_array(
        &mut self,
        texts: &[&str],
    ) -> Result<JObject<'local>, JavaError> {
        let array = self.env.new_object_type_array::<JString<'_>>(texts.len(), JString::null())?;
        for (i, text) in texts.iter().enumerate() {
            let text = self.new_string(text)?;
            array.set_element(self.env, i, text)?;
        }
        Ok(array.into())
    }

    /// Converts a member's value to a string; `None` if it is null.
    pub(super) fn read_string(
        &mut self,
        member: JavaMember,
        value: JValueOwned<'local>,
    ) -> Result<Option<String>, JavaError> {
        let object = value.into_object().map_err(|error| member_error(member, &error))?;
        if object.is_null() {
            return Ok(None);
        }
        let text =
            self.env.cast_local::<JString<'_>>(object).map_err(|e| member_error(member, &e))?;
        let read = text.try_to_string(self.env);
        // A result may have many rows: without this, each would keep a local reference until the call ends.
        self.env.delete_local_ref(text);
        read.map(Some).map_err(|error| member_error(member, &error))
    }

    /// Deletes a local reference: without this, each would be kept until the call into Java ends.
    pub(super) fn delete_local_reference(&mut self, object: JObject<'local>) {
        self.env.delete_local_ref(object);
    }

    /// Calls a method of an object and ignores its result.
    pub(super) fn call_method(
        &mut self,
        member: JavaMember,
        object: &JObject<'_>,
        arguments: &[JValue<'_>],
    ) -> Result<(), JavaError> {
        let value = self.call_method_if_available(member, object, arguments)?;
        if let Some(JValueOwned::Object(object)) = value {
            self.delete_local_reference(object);
        }
        Ok(())
    }

    /// Calls a method that returns an object, which is never null.
    pub(super) fn call_object_method(
        &mut self,
        member: JavaMember,
        object: &JObject<'_>,
        arguments: &[JValue<'_>],
    ) -> Result<JObject<'local>, JavaError> {
        let object = self.call_object_method_if_available(member, object, arguments)?;
        object.ok_or_else(|| JavaError::null(member))
    }

    /// Calls a static method or reads a static field whose value is an object and never null.
    pub(super) fn call_or_read_static_object(
        &mut self,
        member: JavaMember,
        arguments: &[JValue<'_>],
    ) -> Result<JObject<'local>, JavaError> {
        let value = self.call_or_read_static_if_available(member, arguments)?;
        let object = value.map(JValueOwned::into_object).transpose();
        let object = object.map_err(|error| member_error(member, &error))?;
        object.filter(|object| !object.is_null()).ok_or_else(|| JavaError::null(member))
    }

    /// Creates an object with a constructor.
    pub(super) fn new_object(
        &mut self,
        member: JavaMember,
        arguments: &[JValue<'_>],
    ) -> Result<JObject<'local>, JavaError> {
        debug_assert_eq!(member.kind, MemberKind::Constructor);
        let class = JNIString::from(member.class);
        let created = RuntimeMethodSignature::from_str(member.signature).and_then(|signature| {
            self.env.new_object(class, signature.method_signature(), arguments)
        });
        self.catch_exception(member, created)
    }

    /// Creates an array of bytes.
    pub(super) fn new_byte_array(&mut self, bytes: &[u8]) -> Result<JByteArray<'local>, JavaError> {
        let array = self.env.byte_array_from_slice(bytes);
        array.map_err(|error| self.take_exception(None, &error))
    }

    /// Copies the first `count` bytes of an array, which must have that many.
    pub(super) fn read_first_bytes(
        &mut self,
        array: &JByteArray<'_>,
        count: usize,
    ) -> Result<Vec<u8>, JavaError> {
        let mut bytes = vec![0; count];
        array.get_region(self.env, 0, &mut bytes)?;
        Ok(bytes.into_iter().map(i8::cast_unsigned).collect())
    }

    /// Creates a global reference, which other threads may use.
    pub(super) fn new_global(
        &mut self,
        object: &JObject<'_>,
    ) -> Result<Global<JObject<'static>>, JavaError> {
        Ok(self.env.new_global_ref(object)?)
    }

    /// Clears a pending Java exception and puts its class and message into the error.
    fn catch_exception<T>(
        &mut self,
        member: JavaMember,
        called: Result<T, JniError>,
    ) -> Result<T, JavaError> {
        called.map_err(|error| self.take_exception(Some(member), &error))
    }

    /// Returns the error of a failed call, with the exception that it threw. Without an exception, the `jni`
    /// crate's error is used.
    fn take_exception(&mut self, member: Option<JavaMember>, error: &JniError) -> JavaError {
        let thrown = self.env.exception_occurred().inspect(|_| self.env.exception_clear());
        let Some(thrown) = thrown else {
            let why = error.to_string();
            return JavaError { member, thrown: None, is_about_trust: false, why };
        };
        let told = self.describe_exception(&thrown);
        let is_about_trust = self.is_about_trust(thrown);
        // Reading the exception may have thrown another one.
        self.env.exception_clear();
        let is_about_trust = is_about_trust.unwrap_or(false);
        match told {
            Ok((name, message)) => {
                let why = format!("{name}: {message}");
                JavaError { member, thrown: Some(name.into()), is_about_trust, why }
            }
            Err(unread) => {
                let why = format!("{error}, and its exception can't be read: {unread}");
                JavaError { member, thrown: None, is_about_trust, why }
            }
        }
    }

    /// Returns `true` if an exception or one of its causes is about keys and certificates. The outer class
    /// alone doesn't tell: TLS throws the same class when a connection is cut off.
    fn is_about_trust(&mut self, mut thrown: JThrowable<'local>) -> Result<bool, JniError> {
        for _ in 0..MAX_CAUSES {
            let is_security = self.env.is_instance_of(&thrown, JNIString::from(SECURITY_EXCEPTION));
            let cause = thrown.get_cause(self.env);
            self.env.delete_local_ref(thrown);
            if is_security? {
                return Ok(true);
            }
            thrown = cause?;
            if thrown.is_null() {
                break;
            }
        }
        Ok(false)
    }

    /// Returns an exception's class and message. The call stack isn't read: each of its frames would be a
    /// local reference.
    fn describe_exception(
        &mut self,
        thrown: &JThrowable<'_>,
    ) -> Result<(String, String), JniError> {
        let (class, message) = (self.env.get_object_class(thrown)?, thrown.get_message(self.env)?);
        let name = class.get_name(self.env)?;
        let told = name.try_to_string(self.env)?;
        let message_told =
            if message.is_null() { Ok(String::new()) } else { message.try_to_string(self.env) };
        self.env.delete_local_ref(name);
        self.env.delete_local_ref(message);
        self.env.delete_local_ref(class);
        Ok((told, message_told?))
    }
}

/// Converts a member's value to an integer.
pub(super) fn read_int(member: JavaMember, value: JValueOwned<'_>) -> Result<i32, JavaError> {
    value.into_int().map_err(|error| member_error(member, &error))
}

/// Converts a member's value to a boolean.
pub(super) fn read_bool(member: JavaMember, value: JValueOwned<'_>) -> Result<bool, JavaError> {
    value.into_bool().map_err(|error| member_error(member, &error))
}

/// Converts a member's value to a float.
pub(super) fn read_float(member: JavaMember, value: JValueOwned<'_>) -> Result<f32, JavaError> {
    value.into_float().map_err(|error| member_error(member, &error))
}

fn member_error(member: JavaMember, error: &JniError) -> JavaError {
    JavaError { member: Some(member), thrown: None, is_about_trust: false, why: error.to_string() }
}
