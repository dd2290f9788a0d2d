//! Calls of the table's members: guarded by the API level, and with exceptions as errors.

use std::fmt;

use jni::Env;
use jni::errors::Error as JniError;
use jni::objects::{JObject, JString};
use jni::signature::{RuntimeFieldSignature, RuntimeMethodSignature};
use jni::strings::JNIString;
use jni::{JValue, JValueOwned};

use super::table::{Kind, Member, SDK_INT};

/// What Java would not do.
#[derive(Debug)]
pub struct Error {
    /// The member that was called; none where the thread could not be attached.
    pub member: Option<Member>,
    /// Why it failed: the exception's class and message, say.
    pub why: String,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.member {
            Some(member) => write!(f, "{}.{}: {}", member.class, member.name, self.why),
            None => f.write_str(&self.why),
        }
    }
}

impl std::error::Error for Error {}

impl From<JniError> for Error {
    fn from(error: JniError) -> Self {
        Error { member: None, why: error.to_string() }
    }
}

/// A thread's way into Java, at the device's API level.
pub(super) struct Caller<'env, 'local> {
    env: &'env mut Env<'local>,
    level: i32,
}

impl<'env, 'local> Caller<'env, 'local> {
    /// A caller for a device of an API level.
    pub(super) fn new(env: &'env mut Env<'local>, level: i32) -> Self {
        Caller { env, level }
    }

    /// The device's API level.
    pub(super) fn level(env: &'env mut Env<'local>) -> Result<i32, Error> {
        // Every Android that this runs on has it.
        let mut caller = Caller::new(env, SDK_INT.since);
        caller.class(SDK_INT, &[])?.map_or(Ok(0), |value| int(SDK_INT, value))
    }

    /// Calls a method of an object. None if the device is older than the method.
    pub(super) fn method(
        &mut self,
        member: Member,
        object: &JObject<'_>,
        arguments: &[JValue<'_>],
    ) -> Result<Option<JValueOwned<'local>>, Error> {
        debug_assert_eq!(member.kind, Kind::Method);
        if self.level < member.since {
            return Ok(None);
        }
        let name = JNIString::from(member.name);
        let called = RuntimeMethodSignature::from_str(member.signature).and_then(|signature| {
            self.env.call_method(object, name, signature.method_signature(), arguments)
        });
        self.caught(member, called).map(Some)
    }

    /// Calls a method of a class, or reads a field. None if the device is older than it.
    pub(super) fn class(
        &mut self,
        member: Member,
        arguments: &[JValue<'_>],
    ) -> Result<Option<JValueOwned<'local>>, Error> {
        if self.level < member.since {
            return Ok(None);
        }
        let [class, name] = [member.class, member.name].map(JNIString::from);
        let called = if member.kind == Kind::StaticField {
            RuntimeFieldSignature::from_str(member.signature).and_then(|signature| {
                self.env.get_static_field(class, name, signature.field_signature())
            })
        } else {
            RuntimeMethodSignature::from_str(member.signature).and_then(|signature| {
                self.env.call_static_method(class, name, signature.method_signature(), arguments)
            })
        };
        self.caught(member, called).map(Some)
    }

    /// An object that a method returns; none if it is null, or the device older than the method.
    pub(super) fn object(
        &mut self,
        member: Member,
        object: &JObject<'_>,
        arguments: &[JValue<'_>],
    ) -> Result<Option<JObject<'local>>, Error> {
        let Some(value) = self.method(member, object, arguments)? else { return Ok(None) };
        let object = value.into_object().map_err(|error| failed(member, &error))?;
        Ok((!object.is_null()).then_some(object))
    }

    /// A text of Java's own.
    pub(super) fn text(&mut self, text: &str) -> Result<JString<'local>, Error> {
        Ok(self.env.new_string(text)?)
    }

    /// An array of texts.
    pub(super) fn texts(&mut self, texts: &[&str]) -> Result<JObject<'local>, Error> {
        let array = self.env.new_object_type_array::<JString<'_>>(texts.len(), JString::null())?;
        for (i, text) in texts.iter().enumerate() {
            let text = self.text(text)?;
            array.set_element(self.env, i, text)?;
        }
        Ok(array.into())
    }

    /// The text that a value of Java's is; none if it is null.
    pub(super) fn string(
        &mut self,
        member: Member,
        value: JValueOwned<'local>,
    ) -> Result<Option<String>, Error> {
        let object = value.into_object().map_err(|error| failed(member, &error))?;
        if object.is_null() {
            return Ok(None);
        }
        let text = self.env.cast_local::<JString<'_>>(object).map_err(|e| failed(member, &e))?;
        let read = text.try_to_string(self.env);
        // An answer may be long; until it is read, no reference of it would go.
        self.env.delete_local_ref(text);
        read.map(Some).map_err(|error| failed(member, &error))
    }

    /// With the exception, if there was one, in the error and no longer pending.
    fn caught<T>(&mut self, member: Member, called: Result<T, JniError>) -> Result<T, Error> {
        called.map_err(|error| match (error, self.env.exception_catch()) {
            (_, Err(JniError::CaughtJavaException { name, msg, .. })) => {
                Error { member: Some(member), why: format!("{name}: {msg}") }
            }
            (error, _) => failed(member, &error),
        })
    }
}

/// The number that a member's value is.
pub(super) fn int(member: Member, value: JValueOwned<'_>) -> Result<i32, Error> {
    value.into_int().map_err(|error| failed(member, &error))
}

/// The truth that a member's value is.
pub(super) fn truth(member: Member, value: JValueOwned<'_>) -> Result<bool, Error> {
    value.into_bool().map_err(|error| failed(member, &error))
}

/// The fraction that a member's value is.
pub(super) fn float(member: Member, value: JValueOwned<'_>) -> Result<f32, Error> {
    value.into_float().map_err(|error| failed(member, &error))
}

fn failed(member: Member, error: &JniError) -> Error {
    Error { member: Some(member), why: error.to_string() }
}
