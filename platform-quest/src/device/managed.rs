//! The managed configuration of the app: settings from a management console, read through
//! `RestrictionsManager`.

use jni::JValue;
use jni::objects::JObject;

use super::call::{JavaCaller, JavaError, read_bool};
use super::table::{BUNDLE_VALUE, HAS_NEXT, ITERATOR, KEY_SET, NEXT, RESTRICTIONS, TO_STRING};
use super::{AndroidDevice, system_service};

const RESTRICTIONS_SERVICE: &str = "restrictions";

/// The maximum number of entries that are read: a bound against a faulty console.
const MAX_ENTRIES: usize = 256;

/// An entry of a managed configuration, with its value as text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ManagedEntry {
    /// The key, usually the name of a setting.
    pub key: String,
    /// The value: a string, the digits of a number, `true` or `false`.
    pub value: String,
}

impl AndroidDevice {
    /// Reads the managed configuration, sorted by key; empty on an unmanaged device. A key without a value is
    /// left out.
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn read_managed_configuration(&self) -> Result<Vec<ManagedEntry>, JavaError> {
        self.call_java(|caller, context| {
            let mut entries = Vec::new();
            let Some(manager) = system_service(caller, context, RESTRICTIONS_SERVICE)? else {
                return Ok(entries);
            };
            let Some(bundle) =
                caller.call_object_method_if_available(RESTRICTIONS, &manager, &[])?
            else {
                return Ok(entries);
            };
            let Some(keys) = caller.call_object_method_if_available(KEY_SET, &bundle, &[])? else {
                return Ok(entries);
            };
            let Some(keys) = caller.call_object_method_if_available(ITERATOR, &keys, &[])? else {
                return Ok(entries);
            };
            for _ in 0..MAX_ENTRIES {
                let more = caller.call_method_if_available(HAS_NEXT, &keys, &[])?;
                if !more.map_or(Ok(false), |value| read_bool(HAS_NEXT, value))? {
                    break;
                }
                let Some(key) = caller.call_method_if_available(NEXT, &keys, &[])? else { break };
                let Some(key) = caller.read_string(NEXT, key)? else { continue };
                let value = read_value(caller, &bundle, &key)?;
                entries.extend(value.map(|value| ManagedEntry { key, value }));
            }
            // A bundle's keys have no order.
            entries.sort_by(|a, b| a.key.cmp(&b.key));
            Ok(entries)
        })
    }
}

/// Reads the value of a bundle's key as text; `None` if it is null.
fn read_value(
    caller: &mut JavaCaller<'_, '_>,
    bundle: &JObject<'_>,
    key: &str,
) -> Result<Option<String>, JavaError> {
    let name: JObject<'_> = caller.new_string(key)?.into();
    let value =
        caller.call_object_method_if_available(BUNDLE_VALUE, bundle, &[JValue::Object(&name)]);
    caller.delete_local_reference(name);
    let Some(value) = value? else { return Ok(None) };
    let text = caller.call_method_if_available(TO_STRING, &value, &[]);
    caller.delete_local_reference(value);
    let Some(text) = text? else { return Ok(None) };
    caller.read_string(TO_STRING, text)
}
