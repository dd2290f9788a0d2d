//! Accepts connections: TLS, timeouts against idle clients, and a graceful shutdown.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::{GracefulShutdown, Watcher};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;
use tokio_rustls::TlsAcceptor;
use tracing::{debug, warn};

use crate::server::app::BoothApp;
use crate::server::connections::{Connections, Holder, MAX_CONNECTIONS};
use crate::server::routes::Peer;

/// The timeout of a TLS handshake.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(10);

/// The timeout of a request's head. It also ends idle connections; a headset sends a request every two
/// seconds.
const HEAD_TIMEOUT: Duration = Duration::from_secs(15);

/// The most bytes of a request's head.
const MAX_HEAD_BYTES: usize = 16 << 10;

/// The time for open requests to finish at shutdown.
const END_TIMEOUT: Duration = Duration::from_secs(10);

/// Makes the routes of a connection.
pub(crate) type MakeRouter = fn(&Arc<BoothApp>) -> Router;

/// Serves routes, over TLS or plain, until `end` is ready. Then accepts no more connections, and returns when
/// all requests have finished.
pub(crate) async fn serve(
    app: Arc<BoothApp>,
    listener: TcpListener,
    (tls, router): (Option<TlsAcceptor>, MakeRouter),
    end: impl Future<Output = ()>,
) {
    let graceful = GracefulShutdown::new();
    let connections = Arc::new(Connections::new(MAX_CONNECTIONS));
    let mut end = std::pin::pin!(end);
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = &mut end => break,
        };
        match accepted {
            Ok((stream, peer)) => {
                let holder = Holder::Network(Peer(peer.ip()).network());
                match connections.open(holder, Instant::now()) {
                    Some(open) => {
                        let (app, tls, watcher) = (app.clone(), tls.clone(), graceful.watcher());
                        tokio::spawn(async move {
                            app.metrics.connections.add(1);
                            let routes = router(&app).layer(Extension(open.clone()));
                            tokio::select! {
                                () = serve_connection(routes, stream, peer, tls, watcher) => {}
                                () = open.closed() => app.metrics.closed_early.add(1),
                            }
                            app.metrics.connections.subtract_one();
                        });
                    }
                    None => app.metrics.turned_away.add(1),
                }
            }
            Err(error) => {
                warn!(%error, "no connection could be taken");
                // An error such as too many open files may pass in a moment.
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        }
    }
    drop(listener);
    app.changes.end();
    if timeout(END_TIMEOUT, graceful.shutdown()).await.is_err() {
        warn!("requests were cut off at the end");
    }
}

async fn serve_connection(
    routes: Router,
    stream: TcpStream,
    peer: SocketAddr,
    tls: Option<TlsAcceptor>,
    watcher: Watcher,
) {
    // Sends small responses without delay.
    let _ = stream.set_nodelay(true);
    let Some(tls) = tls else { return serve_stream(routes, stream, peer, watcher).await };
    match timeout(HANDSHAKE_TIMEOUT, tls.accept(stream)).await {
        Ok(Ok(stream)) => serve_stream(routes, stream, peer, watcher).await,
        Ok(Err(error)) => debug!(%peer, %error, "no handshake"),
        Err(_) => debug!(%peer, "the handshake took too long"),
    }
}

async fn serve_stream(
    routes: Router,
    stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static,
    peer: SocketAddr,
    watcher: Watcher,
) {
    let routes = routes.layer(Extension(Peer(peer.ip())));
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIMEOUT)
        .max_buf_size(MAX_HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(routes));
    if let Err(error) = watcher.watch(connection).await {
        debug!(%peer, %error, "a connection broke");
    }
}
