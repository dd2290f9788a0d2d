//! HTTPS through Java's own classes: Android includes TLS, so that the package needs no second
//! implementation. Connections trust only the site's certificate authority, check the booth's name or address
//! with Java's own verifier, follow no redirects and use no proxy.
//!
//! The class of an exception and of its causes decides the fault that an outbox sees: timed out, untrusted
//! certificate, or otherwise unreachable.

mod trust;
mod watchdog;

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use jni::objects::{Global, JObject};
use jni::{AttachConfig, Env, JValue, JavaVM};
use paros_protocol::limits::MAX_ANSWER_BYTES;
use paros_upload::{BoothCaller, HttpAnswer, HttpRequest, LinkError, LinkFault};

use super::call::{JavaCaller, JavaError, read_int};
use super::table::{
    CLOSE_INPUT, CLOSE_OUTPUT, DISCONNECT, ERROR_STREAM, HEADER_FIELD, INPUT_STREAM, NEW_URL,
    NO_PROXY, OPEN_CONNECTION, OUTPUT_STREAM, READ_BYTES, RESPONSE_CODE, SET_CONNECT_TIMEOUT,
    SET_DO_OUTPUT, SET_FOLLOW_REDIRECTS, SET_READ_TIMEOUT, SET_REQUEST_METHOD,
    SET_REQUEST_PROPERTY, SET_SOCKET_FACTORY, SET_USE_CACHES, WRITE_BYTES,
};
use watchdog::Watchdog;

/// The maximum number of local references in a request. They are released at its end.
const REQUEST_REFERENCES: usize = 64;

/// All members that are called here exist since API level 1.
const API_LEVEL: i32 = 1;

/// Sends requests to a booth through Java. The calling thread stays attached to the Java VM until it ends.
#[derive(Debug)]
pub struct HttpsCaller {
    vm: JavaVM,
    url: String,
    ca: Vec<u8>,
    /// An `SSLSocketFactory` that trusts only the authority; created by the first request.
    sockets: Option<Global<JObject<'static>>>,
    watchdog: Watchdog,
}

/// The Java calls of one request.
struct Connection<'env, 'call, 'local> {
    caller: &'call mut JavaCaller<'env, 'local>,
    /// An `HttpsURLConnection`.
    object: JObject<'local>,
}

/// The reason why a request has no response.
#[derive(Debug)]
enum AskError {
    Java(JavaError),
    Other(LinkFault, String),
}

impl From<JavaError> for AskError {
    fn from(error: JavaError) -> Self {
        AskError::Java(error)
    }
}

impl From<jni::errors::Error> for AskError {
    fn from(error: jni::errors::Error) -> Self {
        AskError::Java(error.into())
    }
}

impl HttpsCaller {
    /// Creates a caller for the booth at `https://HOST:PORT`, whose certificate is issued by the authority
    /// `ca` (DER).
    #[must_use]
    pub fn new(vm: JavaVM, url: &str, ca: &[u8]) -> Self {
        let watchdog = Watchdog::start(vm.clone());
        HttpsCaller { vm, url: url.to_owned(), ca: ca.to_vec(), sockets: None, watchdog }
    }

    fn ask(
        &mut self,
        env: &mut Env<'_>,
        request: &HttpRequest<'_>,
    ) -> Result<HttpAnswer, AskError> {
        let caller = &mut JavaCaller::new(env, API_LEVEL);
        let sockets = match self.sockets.take() {
            Some(sockets) => sockets,
            None => trust::make_socket_factory(caller, &self.ca)?,
        };
        let sockets = self.sockets.insert(sockets);
        let url = format!("{}{}", self.url, request.path);
        let mut connection = Connection::prepare(caller, &url, sockets, request.timeout)?;
        let watched = connection.caller.new_global(&connection.object)?;
        let is_late = self.watchdog.watch(watched, Instant::now() + request.timeout);
        let answer = connection.send(request).and_then(|()| connection.read_answer());
        self.watchdog.rest();
        // A truncated head may look like a complete one, so a late response is discarded.
        let is_late = is_late.load(Ordering::Acquire);
        if is_late || answer.is_err() {
            // An exception doesn't matter here: the connection is over.
            let _ = connection.caller.call_method(DISCONNECT, &connection.object, &[]);
        }
        match answer {
            Err(AskError::Java(error)) if is_late => {
                Err(AskError::Other(LinkFault::TimedOut, error.to_string()))
            }
            Ok(_) if is_late => {
                Err(AskError::Other(LinkFault::TimedOut, "the answer has no end".into()))
            }
            answer => answer,
        }
    }
}

impl BoothCaller for HttpsCaller {
    fn call(&mut self, request: &HttpRequest<'_>) -> Result<HttpAnswer, LinkError> {
        if !self.url.starts_with("https://") {
            let why = format!("{}: expected https:// and an address", self.url);
            return Err(LinkError { fault: LinkFault::Unreachable, why });
        }
        let vm = self.vm.clone();
        let asked = vm.attach_current_thread_with_config(
            AttachConfig::default,
            Some(REQUEST_REFERENCES),
            |env| self.ask(env, request),
        );
        asked.map_err(AskError::into_link_error)
    }
}

impl<'env, 'call, 'local> Connection<'env, 'call, 'local> {
    /// Creates a connection to a URL. Nothing is sent yet.
    fn prepare(
        caller: &'call mut JavaCaller<'env, 'local>,
        url: &str,
        sockets: &JObject<'_>,
        timeout: Duration,
    ) -> Result<Self, AskError> {
        let url = caller.new_string(url)?;
        let url = caller.new_object(NEW_URL, &[JValue::Object(&url)])?;
        let no_proxy = caller.call_or_read_static_object(NO_PROXY, &[])?;
        let by = [JValue::Object(&no_proxy)];
        let object = caller.call_object_method(OPEN_CONNECTION, &url, &by)?;
        caller.call_method(SET_SOCKET_FACTORY, &object, &[JValue::Object(sockets)])?;
        // 0 would mean no timeout.
        let ms = i32::try_from(timeout.as_millis()).unwrap_or(i32::MAX).max(1);
        for (member, value) in [
            (SET_CONNECT_TIMEOUT, JValue::Int(ms)),
            (SET_READ_TIMEOUT, JValue::Int(ms)),
            (SET_FOLLOW_REDIRECTS, JValue::Bool(false)),
            (SET_USE_CACHES, JValue::Bool(false)),
            (SET_DO_OUTPUT, JValue::Bool(true)),
        ] {
            caller.call_method(member, &object, &[value])?;
        }
        Ok(Connection { caller, object })
    }

    /// Writes a request. Java buffers the whole body, so that it can send the request again if a kept-alive
    /// connection turns out to be closed.
    fn send(&mut self, request: &HttpRequest<'_>) -> Result<(), AskError> {
        let Connection { caller, object } = self;
        let method = caller.new_string(request.method.name())?;
        caller.call_method(SET_REQUEST_METHOD, object, &[JValue::Object(&method)])?;
        // Otherwise Android would request gzip and unpack it silently.
        let plain = ("Accept-Encoding", "identity");
        let headers = request.headers.iter().map(|(name, value)| (*name, &**value));
        for (name, value) in headers.chain([plain]) {
            let [name, value] = [caller.new_string(name)?, caller.new_string(value)?];
            let header = [JValue::Object(&name), JValue::Object(&value)];
            caller.call_method(SET_REQUEST_PROPERTY, object, &header)?;
        }
        let body = caller.new_byte_array(request.body)?;
        let output = caller.call_object_method(OUTPUT_STREAM, object, &[])?;
        caller.call_method(WRITE_BYTES, &output, &[JValue::Object(&body)])?;
        caller.call_method(CLOSE_OUTPUT, &output, &[])?;
        Ok(())
    }

    fn read_answer(&mut self) -> Result<HttpAnswer, AskError> {
        let Connection { caller, object } = self;
        let status = caller.call_method_if_available(RESPONSE_CODE, object, &[])?;
        let status = status.map_or(Ok(-1), |status| read_int(RESPONSE_CODE, status))?;
        let status = u16::try_from(status)
            .map_err(|_| AskError::Other(LinkFault::Unreachable, "it doesn't speak HTTP".into()))?;
        let name = caller.new_string("Retry-After")?;
        let name = [JValue::Object(&name)];
        let retry_after = match caller.call_method_if_available(HEADER_FIELD, object, &name)? {
            Some(value) => caller.read_string(HEADER_FIELD, value)?,
            None => None,
        };
        let retry_after = retry_after.and_then(|value| value.trim().parse().ok());
        let member = if status < 400 { INPUT_STREAM } else { ERROR_STREAM };
        let body = match caller.call_object_method_if_available(member, object, &[])? {
            Some(input) => read_body(caller, &input)?,
            None => Vec::new(),
        };
        Ok(HttpAnswer { status, retry_after, body })
    }
}

/// Reads a body to its end and closes it, so that the connection can be reused.
fn read_body(caller: &mut JavaCaller<'_, '_>, input: &JObject<'_>) -> Result<Vec<u8>, AskError> {
    let room = MAX_ANSWER_BYTES + 1;
    let array = caller.new_byte_array(&vec![0; room])?;
    let mut length = 0;
    while length < room {
        // A response is bounded by `MAX_ANSWER_BYTES`, so the numbers fit into an `i32`.
        let [from, most] = [length, room - length].map(|n| JValue::Int(n as i32));
        let read = [JValue::Object(&array), from, most];
        let read = caller.call_method_if_available(READ_BYTES, input, &read)?;
        let read = read.map_or(Ok(-1), |read| read_int(READ_BYTES, read))?;
        match usize::try_from(read) {
            Ok(read) => length += read.min(room - length),
            Err(_) => {
                let body = caller.read_first_bytes(&array, length)?;
                caller.call_method(CLOSE_INPUT, input, &[])?;
                return Ok(body);
            }
        }
    }
    let why = format!("an answer of more than {MAX_ANSWER_BYTES} bytes");
    Err(AskError::Other(LinkFault::Unreachable, why))
}

impl AskError {
    fn into_link_error(self) -> LinkError {
        match self {
            AskError::Other(fault, why) => LinkError { fault, why },
            AskError::Java(error) => {
                let fault = match error.thrown.as_deref() {
                    Some("java.net.SocketTimeoutException") => LinkFault::TimedOut,
                    // Android throws this for a certificate of another name.
                    Some("javax.net.ssl.SSLPeerUnverifiedException") => LinkFault::Untrusted,
                    _ if error.is_about_trust => LinkFault::Untrusted,
                    _ => LinkFault::Unreachable,
                };
                LinkError { fault, why: error.to_string() }
            }
        }
    }
}
