//! The trust of a connection: a single certificate authority.

use jni::JValue;
use jni::objects::{Global, JObject};

use super::AskError;
use crate::device::call::{JavaCaller, JavaError};
use crate::device::table::{
    CERTIFICATE_FACTORY, INIT_SSL_CONTEXT, INIT_TRUST_FACTORY, KEY_STORE, KEY_STORE_TYPE,
    LOAD_KEY_STORE, NEW_BYTES_INPUT, READ_CERTIFICATE, SET_CERTIFICATE, SOCKET_FACTORY,
    SSL_CONTEXT, TRUST_ALGORITHM, TRUST_FACTORY, TRUST_MANAGERS,
};

/// Creates an `SSLSocketFactory` whose sockets trust only the authority with this certificate (DER).
pub(super) fn make_socket_factory(
    caller: &mut JavaCaller<'_, '_>,
    ca: &[u8],
) -> Result<Global<JObject<'static>>, AskError> {
    let store = make_key_store(caller, ca)?;
    let algorithm = caller.call_or_read_static_object(TRUST_ALGORITHM, &[])?;
    let trust = caller.call_or_read_static_object(TRUST_FACTORY, &[JValue::Object(&algorithm)])?;
    caller.call_method(INIT_TRUST_FACTORY, &trust, &[JValue::Object(&store)])?;
    let managers = caller.call_object_method(TRUST_MANAGERS, &trust, &[])?;
    let protocol = caller.new_string("TLS")?;
    let context = caller.call_or_read_static_object(SSL_CONTEXT, &[JValue::Object(&protocol)])?;
    let null = JObject::null();
    let by = [&null, &managers, &null].map(JValue::Object);
    caller.call_method(INIT_SSL_CONTEXT, &context, &by)?;
    let sockets = caller.call_object_method(SOCKET_FACTORY, &context, &[])?;
    Ok(caller.new_global(&sockets)?)
}

/// Creates a `KeyStore` that holds one certificate.
fn make_key_store<'local>(
    caller: &mut JavaCaller<'_, 'local>,
    ca: &[u8],
) -> Result<JObject<'local>, JavaError> {
    let bytes = caller.new_byte_array(ca)?;
    let input = caller.new_object(NEW_BYTES_INPUT, &[JValue::Object(&bytes)])?;
    let kind = caller.new_string("X.509")?;
    let reader =
        caller.call_or_read_static_object(CERTIFICATE_FACTORY, &[JValue::Object(&kind)])?;
    let certificate =
        caller.call_object_method(READ_CERTIFICATE, &reader, &[JValue::Object(&input)])?;
    let kind = caller.call_or_read_static_object(KEY_STORE_TYPE, &[])?;
    let store = caller.call_or_read_static_object(KEY_STORE, &[JValue::Object(&kind)])?;
    let null = JObject::null();
    caller.call_method(LOAD_KEY_STORE, &store, &[JValue::Object(&null), JValue::Object(&null)])?;
    let name = caller.new_string("site")?;
    let entry = [JValue::Object(&name), JValue::Object(&certificate)];
    caller.call_method(SET_CERTIFICATE, &store, &entry)?;
    Ok(store)
}
