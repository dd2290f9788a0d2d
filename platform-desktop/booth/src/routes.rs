//! Requests and answers: what headsets and those who watch the booth ask.

use std::net::IpAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{DefaultBodyLimit, Extension, Path, Request, State};
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post, put};
use axum::{Router, middleware};
use paros_booth_rules::limits::MAX_CHUNK_BYTES;
use paros_booth_rules::records::{Device, ExportState, Sculpture};
use paros_booth_rules::{Chunk, ParcelProgress, Query, Refusal};
use paros_core::outbox::messages::{
    ContentHash, DeviceToken, FleetEnrolment, Heartbeat, SculptureId,
};
use tokio::sync::OwnedSemaphorePermit;
use tracing::{info, warn};

use crate::app::BoothApp;
use crate::body::{bound_body, pass_over};
use crate::clock::booth_time;
use crate::parcel_decode::check_parcel;
use crate::staff;

/// How long what comes after a request's head may take: a piece of a parcel over a slow radio.
const BODY_TIMEOUT: Duration = Duration::from_secs(30);

/// Who asks.
#[derive(Clone, Copy)]
pub(crate) struct Peer(pub(crate) IpAddr);

type Answer = Result<Response, RefusalAnswer>;

/// A refusal as an answer.
pub(crate) struct RefusalAnswer(Refusal);

/// All routes.
pub(crate) fn router(app: &Arc<BoothApp>) -> Router {
    let of_headsets = Router::new()
        .route("/v1/sculptures/{id}", put(put_parcel))
        .route("/v1/heartbeat", post(take_heartbeat))
        .route_layer(from_fn_with_state(app.clone(), authenticate));
    let of_strangers = Router::new()
        .route("/v1/enrol/fleet", post(enrol_fleet))
        .route_layer(from_fn_with_state(app.clone(), limit_stranger));
    Router::new()
        .merge(of_headsets)
        .merge(of_strangers)
        .merge(staff::router(app))
        .route("/healthz", get(tell_health))
        .route("/metrics", get(tell_metrics))
        .layer(DefaultBodyLimit::max(MAX_CHUNK_BYTES))
        .layer(middleware::from_fn_with_state(app.clone(), bound_and_count))
        .layer(middleware::from_fn(staff::keep_frame))
        .with_state(app.clone())
}

/// Ends a request whose body takes too long, and counts its answer.
pub(crate) async fn bound_and_count(
    State(app): State<Arc<BoothApp>>,
    request: Request,
    next: Next,
) -> Response {
    let answer = if says_too_long(request.headers()) {
        let most = MAX_CHUNK_BYTES as u64;
        RefusalAnswer(Refusal::TooLarge { what: "bytes of a request", most }).into_response()
    } else {
        let (head, body) = request.into_parts();
        let (body, is_late) = bound_body(body, BODY_TIMEOUT);
        let answer = next.run(Request::from_parts(head, body)).await;
        match is_late.load(Ordering::Relaxed) {
            true => (StatusCode::REQUEST_TIMEOUT, "the request took too long\n").into_response(),
            false => answer,
        }
    };
    app.metrics.count_answer(answer.status().as_u16());
    answer
}

/// Whether a request says that more will come than is taken.
fn says_too_long(headers: &HeaderMap) -> bool {
    let length = headers.get(header::CONTENT_LENGTH).and_then(|value| value.to_str().ok());
    let length = length.and_then(|length| length.parse::<u64>().ok());
    length.is_some_and(|length| length > MAX_CHUNK_BYTES as u64)
}

/// Lets headsets in that have a token.
async fn authenticate(
    State(app): State<Arc<BoothApp>>,
    Extension(Peer(peer)): Extension<Peer>,
    mut request: Request,
    next: Next,
) -> Answer {
    match find_device(&app, peer, request.headers()).await {
        Ok(device) => {
            request.extensions_mut().insert(device);
            Ok(next.run(request).await)
        }
        Err(refusal) => Err(refuse_after_body(request, refusal).await),
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
        Err(refusal) => Err(refuse_after_body(request, refusal).await),
    }
}

async fn refuse_after_body(request: Request, refusal: Refusal) -> RefusalAnswer {
    pass_over(request.into_body()).await;
    refusal.into()
}

fn take_turn<K: Eq + std::hash::Hash>(
    limiter: &crate::rate::RateLimiter<K>,
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

/// `PUT /v1/sculptures/{id}?offset=K`: a piece of a parcel.
async fn put_parcel(
    State(app): State<Arc<BoothApp>>,
    Extension(device): Extension<Device>,
    Path(id): Path<String>,
    uri: Uri,
    request: Request,
) -> Answer {
    let head = read_put(&id, &uri, request.headers());
    let Ok((id, hash, parcel_bytes, offset)) = head else {
        return Err(refuse_after_body(request, head.err().unwrap_or(Refusal::UnknownToken)).await);
    };
    let of_chunk = device.clone();
    let (bytes, turn) = read_piece(&app, &device, request).await?;
    let progress = app.run(move |app| {
        // Until it is on the disk its memory is in use.
        let _turn = turn;
        let chunk = Chunk { id, hash, parcel_bytes, offset, bytes: &bytes };
        app.booth.take_chunk(&of_chunk, &chunk)
    });
    let mut progress = progress.await?;
    if progress == ParcelProgress::Whole {
        let headset = device.headset;
        progress = app
            .run_decode(move |app| {
                app.booth.finish_parcel(&device, (id, hash), &check_parcel, booth_time())
            })
            .await?;
        info!(headset, %id, kept = matches!(progress, ParcelProgress::Done(_)), "parcel");
        app.wakers.exports.wake();
    }
    Ok(match progress {
        ParcelProgress::Done(receipt) => {
            app.metrics.receipts.add(1);
            bytes_answer(StatusCode::OK, &receipt.to_bytes())
        }
        ParcelProgress::Held(held) => bytes_answer(StatusCode::ACCEPTED, &held.to_le_bytes()),
        ParcelProgress::Whole => bytes_answer(StatusCode::ACCEPTED, &parcel_bytes.to_le_bytes()),
    })
}

/// Reads a piece of a parcel from the network, when it is its turn, and holds that.
async fn read_piece(
    app: &BoothApp,
    device: &Device,
    request: Request,
) -> Result<(Bytes, OwnedSemaphorePermit), RefusalAnswer> {
    let Some(_place) = app.pieces_of_device.take(device.headset) else {
        let refusal = Refusal::Busy { what: "pieces of this headset at once", retry_after: 1 };
        return Err(refuse_after_body(request, refusal).await);
    };
    let turn = match app.pieces.enter().await {
        Ok(turn) => turn,
        Err(refusal) => return Err(refuse_after_body(request, refusal).await),
    };
    let read = to_bytes(request.into_body(), MAX_CHUNK_BYTES).await;
    let bytes = read.map_err(|error| Refusal::BadRequest(format!("no whole piece: {error}")))?;
    app.metrics.parcel_bytes.add(bytes.len() as u64);
    Ok((bytes, turn))
}

/// A sculpture, the hash and the length of its parcel, and where the piece begins.
pub(crate) type PutHead = (SculptureId, ContentHash, u64, u64);

/// What the address and the headers of a parcel's piece say.
pub(crate) fn read_put(id: &str, uri: &Uri, headers: &HeaderMap) -> Result<PutHead, Refusal> {
    let bad = |expected: &str| Refusal::BadRequest(format!("expected {expected}"));
    let id = SculptureId::parse_hex(id).ok_or_else(|| bad("an id of 32 hexadecimal digits"))?;
    let header = |name| headers.get(name).and_then(|value| value.to_str().ok());
    let hash = header("x-parcel-hash").and_then(ContentHash::parse_hex);
    let hash = hash.ok_or_else(|| bad("X-Parcel-Hash: 64 hexadecimal digits"))?;
    let parcel_bytes = header("x-parcel-bytes").and_then(parse_number);
    let parcel_bytes = parcel_bytes.ok_or_else(|| bad("X-Parcel-Bytes: a number"))?;
    let offset = uri.query().and_then(|query| query.strip_prefix("offset="));
    let offset = offset.and_then(parse_number).ok_or_else(|| bad("?offset= and a number"))?;
    Ok((id, hash, parcel_bytes, offset))
}

/// A number in digits alone: no sign, no space.
fn parse_number(text: &str) -> Option<u64> {
    let is_digits = text.bytes().all(|byte| byte.is_ascii_digit());
    if is_digits { text.parse().ok() } else { None }
}

/// `POST /v1/heartbeat`.
async fn take_heartbeat(
    State(app): State<Arc<BoothApp>>,
    Extension(device): Extension<Device>,
    bytes: Bytes,
) -> Answer {
    let beat = read_message(Heartbeat::from_bytes(&bytes))?;
    let answer =
        app.run_small(move |app| app.booth.take_heartbeat(&device, &beat, booth_time())).await?;
    app.metrics.heartbeats.add(1);
    Ok(bytes_answer(StatusCode::OK, &answer.to_bytes()))
}

/// `POST /v1/enrol/fleet`.
async fn enrol_fleet(State(app): State<Arc<BoothApp>>, bytes: Bytes) -> Answer {
    let asked = read_message(FleetEnrolment::from_bytes(&bytes))?;
    let answer = app.run(move |app| app.booth.enrol_fleet(&asked, booth_time())).await?;
    info!(headset = answer.headset, "enrolled by a fleet's token");
    Ok(bytes_answer(StatusCode::OK, &answer.to_bytes()))
}

/// `GET /healthz`: whether store and disk answer.
async fn tell_health(State(app): State<Arc<BoothApp>>) -> Answer {
    app.run(|app| app.booth.list_newest(1, booth_time()).map(drop)).await?;
    Ok("ok\n".into_response())
}

/// `GET /metrics`.
async fn tell_metrics(State(app): State<Arc<BoothApp>>) -> Answer {
    let text = app.run(|app| {
        let kept = app.booth.count(&Query::all::<Sculpture>())?;
        let queued = Query::all::<Sculpture>().equal("export", &ExportState::Queued);
        let devices = app.booth.count(&Query::all::<Device>().absent("revoked_at"))?;
        Ok(app.metrics.write(&[
            ("paros_booth_sculptures", "Sculptures kept.", kept),
            ("paros_booth_kept_bytes", "Bytes of kept files.", app.files.used_bytes()),
            ("paros_booth_exports_queued", "Meshes to compare.", app.booth.count(&queued)?),
            ("paros_booth_headsets", "Headsets enrolled.", devices),
        ]))
    });
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text.await?).into_response())
}

fn read_message<T>(message: Result<T, paros_core::codec::BadBytes>) -> Result<T, Refusal> {
    message.map_err(|bad| {
        Refusal::BadRequest(format!("byte {}: expected {}", bad.offset, bad.expected))
    })
}

fn bytes_answer(status: StatusCode, bytes: &[u8]) -> Response {
    let kind = [(header::CONTENT_TYPE, "application/octet-stream")];
    (status, kind, Body::from(bytes.to_vec())).into_response()
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
        // What store and disk say is for the log.
        let text = if refusal.is_failure() {
            warn!(%refusal, "a request failed");
            "the booth can't now; its log says why\n".to_owned()
        } else {
            format!("{refusal}\n")
        };
        let status = StatusCode::from_u16(status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let mut answer = (status, text).into_response();
        if let Some(seconds) = refusal.retry_after() {
            answer.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        answer
    }
}
