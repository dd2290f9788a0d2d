//! The routes of headsets and of monitoring, and what all routes share.

use std::fmt::Display;
use std::net::IpAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use axum::extract::{DefaultBodyLimit, Extension, Path, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post, put};
use axum::{Router, middleware};
use futures_util::StreamExt as _;
use paros_booth_rules::Refusal;
use paros_booth_rules::records::{Device, Sculpture};
use paros_protocol::limits::MAX_PARCEL_FILE_BYTES;
use paros_protocol::{
    DeviceToken, FLEET_ENROLMENT_PATH, FleetEnrolment, HEARTBEAT_PATH, Heartbeat, LinkTimes,
    PARCEL_PATH, ParcelOutcome, ProtocolError, SculptureId,
};
use tokio::sync::OwnedSemaphorePermit;
use tracing::{info, warn};

use crate::clock::booth_time;
use crate::models::parcel_decode::check_parcel;
use crate::server::app::{BoothApp, SMALL_PARCEL_BYTES};
use crate::server::body::{BodyTimes, MAX_REQUEST_BYTES, bound_body, pass_over};
use crate::server::connections::{Connection, Holder};
use crate::server::places::Place;
use crate::staff;

/// The timeouts of a request's body, except for parcels.
const BODY_TIMES: BodyTimes =
    BodyTimes { whole: Duration::from_secs(30), idle: Duration::from_secs(30) };

/// The longest time without progress of a parcel, over a slow wireless network.
const LONGEST_IDLE: Duration = Duration::from_secs(60);

/// The client's address.
#[derive(Clone, Copy)]
pub(crate) struct Peer(pub(crate) IpAddr);

impl Peer {
    /// Returns the network that the address counts as. For IPv6 this is the first 64 bits, as one household
    /// may use all addresses of such a network.
    pub(crate) fn network(self) -> IpAddr {
        match self.0.to_canonical() {
            IpAddr::V6(address) => IpAddr::V6((address.to_bits() >> 64 << 64).into()),
            address @ IpAddr::V4(_) => address,
        }
    }
}

type Answer = Result<Response, RefusalAnswer>;

/// A refusal as a response.
pub(crate) struct RefusalAnswer(Refusal);

/// Makes all routes of the listener for headsets and staff.
pub(crate) fn router(app: &Arc<BoothApp>) -> Router {
    let of_headsets = Router::new()
        .route(&format!("{PARCEL_PATH}{{id}}"), put(put_parcel))
        .route(HEARTBEAT_PATH, post(take_heartbeat))
        .route_layer(from_fn_with_state(app.clone(), authenticate));
    let of_strangers = Router::new()
        .route(FLEET_ENROLMENT_PATH, post(enrol_fleet))
        .route_layer(from_fn_with_state(app.clone(), limit_stranger));
    Router::new()
        .merge(of_headsets)
        .merge(of_strangers)
        .merge(staff::router(app))
        .route("/healthz", get(tell_health))
        .route("/metrics", get(tell_metrics))
        .layer(DefaultBodyLimit::max(MAX_REQUEST_BYTES))
        .layer(middleware::from_fn_with_state(app.clone(), bound_and_count))
        .layer(middleware::from_fn(staff::keep_frame))
        .with_state(app.clone())
}

/// Applies the limits on a request's body, counts the response, and notes that the connection is used.
pub(crate) async fn bound_and_count(
    State(app): State<Arc<BoothApp>>,
    Extension(connection): Extension<Arc<Connection>>,
    request: Request,
    next: Next,
) -> Response {
    connection.touch(Instant::now());
    let length = read_length(request.headers()).ok();
    let path = request.uri().path();
    let is_parcel = [PARCEL_PATH, staff::IMPORT_PATH].iter().any(|start| path.starts_with(start));
    let (most, times) = match is_parcel {
        true => (MAX_PARCEL_FILE_BYTES, parcel_times(length.unwrap_or(0))),
        false => (MAX_REQUEST_BYTES as u64, BODY_TIMES),
    };
    let answer = if length.is_some_and(|length| length > most) {
        RefusalAnswer(Refusal::TooLarge { what: "bytes of a request", most }).into_response()
    } else {
        let (head, body) = request.into_parts();
        let (body, is_late) = bound_body(body, times);
        let answer = next.run(Request::from_parts(head, body)).await;
        match is_late.load(Ordering::Relaxed) {
            true => (StatusCode::REQUEST_TIMEOUT, "the request took too long\n").into_response(),
            false => answer,
        }
    };
    app.metrics.count_answer(answer.status().as_u16());
    answer
}

/// Returns the timeouts of a parcel with this length: the headset waits as long.
fn parcel_times(length: u64) -> BodyTimes {
    let whole = LinkTimes::default().of_parcel(usize::try_from(length).unwrap_or(usize::MAX));
    BodyTimes { whole, idle: LONGEST_IDLE }
}

/// Reads the length of a request's body from its headers.
///
/// # Errors
/// There is no valid length.
pub(crate) fn read_length(headers: &HeaderMap) -> Result<u64, Refusal> {
    let length = headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok());
    let bad = || Refusal::BadRequest("expected Content-Length: a number".into());
    length.and_then(|length| length.parse().ok()).ok_or_else(bad)
}

/// Authenticates a headset by its token.
async fn authenticate(
    State(app): State<Arc<BoothApp>>,
    Extension(Peer(peer)): Extension<Peer>,
    Extension(connection): Extension<Arc<Connection>>,
    mut request: Request,
    next: Next,
) -> Answer {
    match find_device(&app, peer, request.headers()).await {
        Ok(device) => {
            connection.hold(Holder::Headset(device.headset));
            request.extensions_mut().insert(device);
            Ok(next.run(request).await)
        }
        Err(refusal) => Err(refuse_after_body(request, refusal).await.into()),
    }
}

async fn find_device(
    app: &Arc<BoothApp>,
    peer: IpAddr,
    headers: &HeaderMap,
) -> Result<Device, Refusal> {
    let found = match bearer_token(headers) {
        Some(token) => app.run_small(move |app| app.booth.authenticate(&token)).await,
        None => Err(Refusal::UnknownToken),
    };
    match &found {
        Ok(device) => take_turn(&app.of_device, device.headset)?,
        Err(Refusal::UnknownToken | Refusal::Forbidden(_)) => take_turn(&app.of_stranger, peer)?,
        Err(_) => {}
    }
    found
}

async fn limit_stranger(
    State(app): State<Arc<BoothApp>>,
    Extension(Peer(peer)): Extension<Peer>,
    request: Request,
    next: Next,
) -> Answer {
    match take_turn(&app.of_stranger, peer) {
        Ok(()) => Ok(next.run(request).await),
        Err(refusal) => Err(refuse_after_body(request, refusal).await.into()),
    }
}

/// Reads and discards the body of a request, so that its sender gets the refusal. Returns the refusal.
pub(crate) async fn refuse_after_body(request: Request, refusal: Refusal) -> Refusal {
    pass_over(request.into_body()).await;
    refusal
}

fn take_turn<K: Eq + std::hash::Hash + Clone>(
    limiter: &crate::server::rate::RateLimiter<K>,
    who: K,
) -> Result<(), Refusal> {
    match limiter.take(who, Instant::now()) {
        true => Ok(()),
        false => Err(Refusal::Busy { what: "requests", retry_after: 2 }),
    }
}

fn bearer_token(headers: &HeaderMap) -> Option<DeviceToken> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    DeviceToken::parse_hex(value.strip_prefix("Bearer ")?)
}

/// `PUT /v1/sculptures/{id}`: a parcel with its hash. Responds with 200 if it is kept, and 410 if it was
/// deleted.
async fn put_parcel(
    State(app): State<Arc<BoothApp>>,
    Extension(device): Extension<Device>,
    Path(id): Path<String>,
    request: Request,
) -> Answer {
    let (id, length) = match read_put(&id, request.headers()) {
        Ok(head) => head,
        Err(refusal) => return Err(refuse_after_body(request, refusal).await.into()),
    };
    let headset = device.headset;
    let (file, place) = read_parcel(&app, headset, length, request).await?;
    let outcome = app.run_decode(move |app| {
        // The place is held until the parcel is on disk, as its memory is in use.
        let _place = place;
        app.booth.take_parcel(headset, id, &file, &check_parcel, booth_time())
    });
    let outcome = outcome.await?;
    info!(headset, %id, ?outcome, "parcel");
    if outcome == ParcelOutcome::Kept {
        app.metrics.parcels.add(1);
        app.wakers.exports.wake();
    }
    Ok((status_of(outcome.status()), outcome.body()).into_response())
}

/// Waits for a place, and reads a headset's parcel from the network. Returns the parcel with its place.
pub(crate) async fn read_parcel(
    app: &BoothApp,
    headset: u32,
    length: u64,
    request: Request,
) -> Result<(Vec<u8>, (Place<u32>, OwnedSemaphorePermit)), Refusal> {
    let Some(place) = app.parcels_of_device.take(headset) else {
        let refusal = Refusal::Busy { what: "parcels of this headset at once", retry_after: 1 };
        return Err(refuse_after_body(request, refusal).await);
    };
    let is_small = length <= SMALL_PARCEL_BYTES;
    let gate = if is_small { &app.small_parcels } else { &app.large_parcels };
    let turn = match gate.enter().await {
        Ok(turn) => turn,
        Err(refusal) => return Err(refuse_after_body(request, refusal).await),
    };
    let bytes = read_body(request.into_body(), length).await?;
    app.metrics.parcel_bytes.add(bytes.len() as u64);
    Ok((bytes, (place, turn)))
}

/// Copies a body of this length into one buffer, as each frame, however small, keeps a whole buffer of the
/// connection in memory.
async fn read_body(body: Body, length: u64) -> Result<Vec<u8>, Refusal> {
    let bad = |why: &dyn Display| Refusal::BadRequest(format!("no whole parcel: {why}"));
    let length = usize::try_from(length).map_err(|error| bad(&error))?;
    let mut bytes = Vec::with_capacity(length);
    let mut frames = body.into_data_stream();
    while let Some(frame) = frames.next().await {
        bytes.extend_from_slice(&frame.map_err(|error| bad(&error))?);
        if bytes.len() > length {
            return Err(bad(&"it is longer than its head says"));
        }
    }
    Ok(bytes)
}

/// Reads the sculpture's id, and the length of its parcel's file in bytes, from the path and the headers.
pub(crate) fn read_put(id: &str, headers: &HeaderMap) -> Result<(SculptureId, u64), Refusal> {
    let bad = || Refusal::BadRequest("expected an id of 32 hexadecimal digits".into());
    let id = SculptureId::parse_hex(id).ok_or_else(bad)?;
    Ok((id, read_length(headers)?))
}

/// `POST /v1/heartbeat`.
async fn take_heartbeat(
    State(app): State<Arc<BoothApp>>,
    Extension(device): Extension<Device>,
    bytes: Bytes,
) -> Answer {
    let beat = read_message(Heartbeat::from_json(&bytes))?;
    let answer =
        app.run_small(move |app| app.booth.take_heartbeat(&device, &beat, booth_time())).await?;
    app.metrics.heartbeats.add(1);
    Ok(json_answer(answer.to_json()))
}

/// `POST /v1/enrol/fleet`.
async fn enrol_fleet(State(app): State<Arc<BoothApp>>, bytes: Bytes) -> Answer {
    let asked = read_message(FleetEnrolment::from_json(&bytes))?;
    let answer = app.run(move |app| app.booth.enrol_fleet(&asked, booth_time())).await?;
    info!(headset = answer.headset, "enrolled by a fleet's token");
    Ok(json_answer(answer.to_json()))
}

/// `GET /healthz`: 200 if the store and the files can be written to.
async fn tell_health(State(app): State<Arc<BoothApp>>) -> Answer {
    app.run(BoothApp::check_writes).await?;
    Ok("ok\n".into_response())
}

/// `GET /metrics`.
async fn tell_metrics(State(app): State<Arc<BoothApp>>) -> Answer {
    let text = app.run(|app| {
        let kept = app.booth.count::<Sculpture>("", &[])?;
        let queues = app.booth.measure_queues(booth_time())?;
        let devices = app.booth.count::<Device>("WHERE revoked_at IS NULL", &[])?;
        let free = app.booth.count_badges()?.free;
        Ok(app.metrics.write(&[
            ("paros_booth_sculptures", "Sculptures kept.", kept),
            ("paros_booth_kept_bytes", "Bytes of kept files.", app.files.used_bytes()),
            (
                "paros_booth_room_bytes",
                "Bytes of files for which there is room.",
                app.files.room_bytes(),
            ),
            ("paros_booth_exports_queued", "Meshes to make.", queues.exports),
            ("paros_booth_missing", "Sculptures announced that haven't arrived.", queues.missing),
            ("paros_booth_mails_queued", "Mails to send.", queues.mails),
            (
                "paros_booth_oldest_mail_seconds",
                "Age of the oldest mail to send.",
                queues.oldest_mail.as_secs(),
            ),
            ("paros_booth_prints_queued", "Prints that wait for a printer.", queues.prints),
            (
                "paros_booth_oldest_print_seconds",
                "Age of the oldest of these prints.",
                queues.oldest_print.as_secs(),
            ),
            ("paros_booth_headsets", "Headsets enrolled.", devices),
            ("paros_booth_badge_blocks_free", "Blocks of 64 badges to be leased.", free),
        ]))
    });
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text.await?).into_response())
}

fn read_message<T>(message: Result<T, ProtocolError>) -> Result<T, Refusal> {
    message.map_err(|why| Refusal::BadRequest(why.to_string()))
}

fn status_of(status: u16) -> StatusCode {
    StatusCode::from_u16(status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR)
}

fn json_answer(json: Vec<u8>) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], json).into_response()
}

impl From<Refusal> for RefusalAnswer {
    fn from(refusal: Refusal) -> Self {
        RefusalAnswer(refusal)
    }
}

impl IntoResponse for RefusalAnswer {
    fn into_response(self) -> Response {
        let RefusalAnswer(refusal) = self;
        let status = refusal.status();
        // Errors of the store and the disk are only logged.
        let text = if refusal.is_failure() {
            warn!(%refusal, "a request failed");
            "the booth can't now; its log says why\n".to_owned()
        } else {
            format!("{refusal}\n")
        };
        let mut answer = (status_of(status), text).into_response();
        if let Some(seconds) = refusal.retry_after() {
            answer.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        answer
    }
}

#[cfg(test)]
mod tests {
    use std::net::IpAddr;

    use super::Peer;

    #[test]
    fn a_household_is_one_network() {
        let network = |text: &str| Peer(text.parse::<IpAddr>().expect("an address")).network();
        assert_eq!(network("2001:db8:1:2:3:4:5:6"), network("2001:db8:1:2:ffff::1"));
        assert_ne!(network("2001:db8:1:2::1"), network("2001:db8:1:3::1"));
        assert_ne!(network("10.0.0.1"), network("10.0.0.2"));
        assert_eq!(network("10.0.0.1"), network("::ffff:10.0.0.1"));
    }
}
