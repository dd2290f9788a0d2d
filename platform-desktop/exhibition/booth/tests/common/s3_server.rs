//! An S3 server in the test's process, over a folder.

use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use hyper_util::rt::TokioIo;
use s3s::auth::SimpleAuth;
use s3s::service::S3ServiceBuilder;
use s3s_fs::FileSystem;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;

/// A running server. It is stopped on drop.
pub(crate) struct S3Server {
    address: SocketAddr,
    folder: PathBuf,
    _runtime: Runtime,
}

impl S3Server {
    /// Starts a server in a new folder, with the bucket `booth`.
    pub(crate) fn start(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("booth")).expect("room on the disk");
        let mut service = S3ServiceBuilder::new(FileSystem::new(&folder).expect("a folder"));
        service.set_auth(SimpleAuth::from_single("key", "secret"));
        let service = service.build();
        let runtime = Runtime::new().expect("threads");
        let listener = runtime.block_on(TcpListener::bind("127.0.0.1:0")).expect("a port");
        let address = listener.local_addr().expect("it is bound");
        runtime.spawn(async move {
            loop {
                let Ok((stream, _)) = listener.accept().await else { continue };
                let service = service.clone();
                tokio::spawn(async move {
                    let http = hyper::server::conn::http1::Builder::new();
                    // A client that is killed breaks its connection.
                    let _ = http.serve_connection(TokioIo::new(stream), service).await;
                });
            }
        });
        S3Server { address, folder, _runtime: runtime }
    }

    /// Returns the environment variables that configure a client of the server.
    pub(crate) fn settings(&self) -> Vec<(String, String)> {
        [
            ("AWS_ENDPOINT_URL", format!("http://{}", self.address).as_str()),
            ("AWS_ACCESS_KEY_ID", "key"),
            ("AWS_SECRET_ACCESS_KEY", "secret"),
            ("AWS_REGION", "us-east-1"),
        ]
        .map(|(name, value)| (name.to_owned(), value.to_owned()))
        .into()
    }

    /// Returns the path of a folder in the bucket.
    pub(crate) fn folder(&self, name: &str) -> PathBuf {
        self.folder.join("booth").join(name)
    }
}
