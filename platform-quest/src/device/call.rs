//! JNI calls of the table's members. A member that is newer than the device's API level is not called; a
//! Java exception becomes an error.

use std::fmt;

use jni::Env;
use jni::errors::Error as JniError;
use jni::objects::{JObject, JString};
use jni::signature::{RuntimeFieldSignature, RuntimeMethodSignature};
use jni::strings::JNIString;
use jni::{JValue, JValueOwned};

use super::table::{JavaMember, MemberKind, SDK_INT};

/// A call into Java that failed.
#[derive(Debug)]
pub struct JavaError {
    /// The member that was called; none where the thread could not be attached to the VM.
    pub member: Option<JavaMember>,
    /// Why it failed: the exception's class and message, say.
    pub why: String,
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
        JavaError { member: None, why: error.to_string() }
    }
}

/// The JNI environment of an attached thread, with the device's API level.
pub(super) struct JavaCaller<'env, 'local> {
    env: &'env mut Env<'local>,
    api_level: i32,
}

impl<'env, 'local> JavaCaller<'env, 'local> {
    /// A caller for a device of an API level.
    pub(super) fn new(env: &'env mut Env<'local>, device_api_level: i32) -> Self {
        JavaCaller { env, api_level: device_api_level }
    }

    /// Reads the device's API level.
    pub(super) fn read_api_level(env: &'env mut Env<'local>) -> Result<i32, JavaError> {
        // Every Android that this runs on has it.
        let mut caller = JavaCaller::new(env, SDK_INT.since);
        caller
            .call_or_read_static_if_available(SDK_INT, &[])?
            .map_or(Ok(0), |value| read_int(SDK_INT, value))
    }

    /// Calls a method of an object. None if the device is older than the method.
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

    /// Calls a method of a class, or reads a field. None if the device is older than it.
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

    /// Calls a method that returns an object. None if that is null, or the device older than the method.
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

    /// Converts a member's value to a text; none if it is null.
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

    /// Clears a pending Java exception and puts its class and message into the error.
    fn catch_exception<T>(
        &mut self,
        member: JavaMember,
        called: Result<T, JniError>,
    ) -> Result<T, JavaError> {
        called.map_err(|error| match (error, self.env.exception_catch()) {
            (_, Err(JniError::CaughtJavaException { name, msg, .. })) => {
                JavaError { member: Some(member), why: format!("{name}: {msg}") }
            }
            (error, _) => member_error(member, &error),
        })
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
    JavaError { member: Some(member), why: error.to_string() }
}
