//! The server, from its start to its end.

use std::io::{self, Write as _};
use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

use paros_booth_rules::limits::{MAX_CLOCK_GAP, MAX_CLOCK_STEP};
use paros_booth_rules::{Booth, ClockJump, Refusal};
use paros_shell::durable::take_storage_warnings;
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio_rustls::TlsAcceptor;
use tracing::{info, warn};

use crate::clock::booth_time;
use crate::commands::demo::{DemoFolder, add_demo};
use crate::commands::options::ServeOptions;
use crate::commands::settings::{SiteFacts, list_settings};
use crate::error::Error;
use crate::models::exporter::export_next;
use crate::printing::{Printer, Slicer, slice_next, start_printers};
use crate::public::{self, PublicAddress};
use crate::random::random_bytes;
use crate::server::app::{BoothApp, OpenBooth, WHOLE_THREADS, WORK_THREADS, Wakers};
use crate::server::keys::BoothKeys;
use crate::server::leaf::{LeafKeeper, local_names, primary_address};
use crate::server::listener::{MakeRouter, serve};
use crate::server::mailer::Mailer;
use crate::server::routes;
use crate::server::staff_certificate::{StaffCertificate, end_of_pem};
use crate::server::worker::{LOW_PRIORITY, WHOLE_PRIORITY, Worker, go_behind};
use crate::staff::LoginGate;
use crate::store::folder_lock::FolderLock;

/// The interval at which expired data is deleted.
const SWEEP_EVERY: Duration = Duration::from_secs(300);

/// The interval at which the certificate's age and the machine's addresses are checked.
const LOOK_AT_LEAF_EVERY: Duration = Duration::from_secs(86_400);

/// Serves until SIGTERM or SIGINT.
///
/// # Errors
/// The reason why the server can't start.
pub(crate) fn run(options: &ServeOptions) -> Result<(), Error> {
    start_log(options.json);
    // Pictures are drawn on one thread with a low priority. An existing pool is kept.
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(1).start_handler(|_| go_behind(LOW_PRIORITY));
    let _ = pool.build_global();
    let public = PublicAddress::new(&options.public)?;
    let of_staff = StaffCertificate::load(&options.certificate)?;
    let mailer = Mailer::new(&options.mail, public.clone())?;
    let quota = u64::from(options.quota_gb) * 1_000_000_000;
    let (runtime, of_wholes) =
        build_runtimes().map_err(|error| Error::failure("threads", error))?;
    // Binds first: if the port is in use, no folder is made. Early connections wait in the socket's backlog.
    let listeners = runtime.block_on(Listeners::bind(options.listen, public.as_ref()))?;
    let demo = DemoFolder::make(options)?;
    let folder = demo.as_ref().map_or(options.folder.path(), |demo| demo.path());
    let shared = &options.folder.shared;
    let _lock = shared.is_alone().then(|| FolderLock::take(folder)).transpose()?;
    let open = OpenBooth::open_or_make(folder, shared, options.keep.plan(), quota)?;
    if shared.is_alone() {
        open.booth.drop_leases()?;
    }
    if options.demo {
        add_demo(&open.booth, booth_time())?;
    }
    let names = LeafNames { listen: options.listen.ip(), others: options.name.clone() };
    let of_exports = open.booth.clone();
    // The export thread has a low priority, so that it doesn't delay uploads.
    let exports = Worker::start_behind(move || export_next(&of_exports));
    let of_mails = open.booth.clone();
    let mails = mailer.map(|mailer| Worker::start(move || mailer.send_next(&of_mails)));
    let (slices, printers) = start_slices(&open.booth, options, folder)?;
    let wakers = Wakers {
        exports: exports.waker(),
        mails: mails.as_ref().map(Worker::waker),
        slices: slices.worker.as_ref().map(Worker::waker),
    };
    let first_code = draw_first_code(&open.booth)?;
    let logins = LoginGate::new(first_code.clone());
    let facts = SiteFacts {
        ca_pem: open.keys.ca_pem.clone(),
        ca_end: end_of_pem(&open.keys.ca_pem),
        settings: list_settings(options),
        museum: options.museum.clone(),
        of_staff: of_staff.clone(),
    };
    let (wakers, public_of_app) = ((wakers, printers), public.clone());
    let threads = of_wholes.handle().clone();
    let of_booth = (open.booth, open.files, open.changes);
    let app = BoothApp::new(of_booth, wakers, logins, public_of_app, facts, threads);
    let app = Arc::new(app);
    let serving = Serving { app: app.clone(), public, first_code, of_staff, names, listeners };
    let served = runtime.block_on(serving.serve_until_told(open.keys));
    // The order matters: the runtimes' threads finish, then the app is dropped, and then its workers can end.
    runtime.shutdown_timeout(Duration::from_secs(10));
    of_wholes.shutdown_timeout(Duration::from_secs(5));
    drop(app);
    drop((exports, mails, slices));
    info!("ended");
    served
}

/// Makes the runtime that serves, and the one whose threads work on whole parcels and models.
fn build_runtimes() -> io::Result<(Runtime, Runtime)> {
    let mut serving = Builder::new_multi_thread();
    let serving = serving.enable_all().max_blocking_threads(WORK_THREADS).build()?;
    let mut of_wholes = Builder::new_current_thread();
    let of_wholes = of_wholes.on_thread_start(|| go_behind(WHOLE_PRIORITY));
    let of_wholes = of_wholes.max_blocking_threads(WHOLE_THREADS).build()?;
    Ok((serving, of_wholes))
}

/// The parts that serving needs.
struct Serving {
    app: Arc<BoothApp>,
    public: Option<PublicAddress>,
    first_code: Option<String>,
    of_staff: StaffCertificate,
    names: LeafNames,
    listeners: Listeners,
}

/// The listeners: for staff and headsets, and for visitors if they have pages.
struct Listeners {
    all: TcpListener,
    visitors: Option<TcpListener>,
}

impl Listeners {
    async fn bind(listen: SocketAddr, public: Option<&PublicAddress>) -> Result<Self, Error> {
        let visitors = match public {
            Some(public) => Some(bind(public.listen, "--public-listen").await?),
            None => None,
        };
        Ok(Listeners { all: bind(listen, "--listen").await?, visitors })
    }
}

async fn bind(address: SocketAddr, option: &str) -> Result<TcpListener, Error> {
    TcpListener::bind(address).await.map_err(|error| {
        let hint = match error.kind() {
            io::ErrorKind::AddrInUse => "; end what listens there, or name another address",
            _ => "",
        };
        Error::failure(format!("{option} {address}"), format!("{error}{hint}"))
    })
}

impl Serving {
    /// Serves staff and headsets, and visitors if they have pages, until a signal ends the program.
    async fn serve_until_told(self, keys: BoothKeys) -> Result<(), Error> {
        let Serving { app, public, first_code, of_staff, names, listeners } = self;
        let Listeners { all: listener, visitors } = listeners;
        let fingerprint = keys.site.ca_hash;
        let leaf = LeafKeeper::new(keys, of_staff, names.now(), SystemTime::now())?;
        let tls = TlsAcceptor::from(Arc::new(leaf.tls_config()?));
        let listen = listener.local_addr().map_err(|error| Error::failure("socket", error))?;
        let visitors = visitors.map(|listener| {
            if let Ok(address) = listener.local_addr() {
                info!(%address, "listening for visitors");
            }
            (listener, public.and_then(|public| public.tls))
        });
        let ends = (end_of_program()?, end_of_program()?);
        let hangup = signal(SignalKind::hangup());
        let hangup = hangup.map_err(|error| Error::failure("signals", error))?;
        tell_address(listen, &fingerprint.to_string(), first_code.as_deref());
        tokio::spawn(keep_leaf(leaf, names, hangup));
        tokio::spawn(sweep_now_and_then(app.clone()));
        serve_all(&app, (listener, tls), visitors, ends).await;
        Ok(())
    }
}

/// Serves headsets and staff, and visitors if they have pages, until both `end` futures are ready.
async fn serve_all(
    app: &Arc<BoothApp>,
    (listener, tls): (TcpListener, TlsAcceptor),
    visitors: Option<(TcpListener, Option<TlsAcceptor>)>,
    (end, end_of_visitors): (impl Future<Output = ()>, impl Future<Output = ()>),
) {
    let staff = serve(app.clone(), listener, (Some(tls), routes::router), end);
    match visitors {
        Some((listener, tls)) => {
            let routes = (tls, public::router as MakeRouter);
            let visitors = serve(app.clone(), listener, routes, end_of_visitors);
            tokio::join!(staff, visitors);
        }
        None => staff.await,
    }
}

/// The threads that slice. Dropping this aborts a running slice.
struct Slices {
    worker: Option<Worker>,
    of_printers: Vec<Worker>,
    end: Option<Arc<AtomicBool>>,
}

impl Drop for Slices {
    fn drop(&mut self) {
        if let Some(end) = &self.end {
            end.store(true, Ordering::Relaxed);
        }
        // Doesn't wait for a thread that is uploading to its printer: the state of the print is already
        // recorded.
        self.of_printers.drain(..).for_each(Worker::leave);
    }
}

/// Starts the threads that slice, if there is a slicer.
fn start_slices(
    booth: &Booth,
    options: &ServeOptions,
    folder: &Path,
) -> Result<(Slices, Vec<Printer>), Error> {
    let folder = folder.join("slices");
    let slicer = Slicer::find(&options.slicer, &folder)?.map(Arc::new);
    let (printers, of_printers) = match &options.slicer.printers {
        Some(file) => start_printers(file, booth, slicer.as_ref())?,
        None => Default::default(),
    };
    let end = slicer.as_ref().map(|slicer| slicer.end());
    if slicer.is_none() {
        info!("no slicer: prints have no estimate");
    }
    let of_slices = booth.clone();
    let worker = slicer.map(|slicer| Worker::start(move || slice_next(&of_slices, &slicer)));
    Ok((Slices { worker, of_printers, end }, printers))
}

/// Prints the booth's address on standard output, once clients can connect.
fn tell_address(listen: SocketAddr, fingerprint: &str, first_code: Option<&str>) {
    let ip = if listen.ip().is_unspecified() { primary_address() } else { Some(listen.ip()) };
    let ip = ip.unwrap_or(IpAddr::from([127, 0, 0, 1]));
    let address = format!("https://{}", SocketAddr::new(ip, listen.port()));
    info!(address, fingerprint, "listening");
    // Standard output may be closed.
    let _ = writeln!(io::stdout(), "{address}\ncertificate authority, SHA-256: {fingerprint}");
    if let Some(code) = first_code {
        let _ = writeln!(io::stdout(), "first account: {address}/staff/first with the code {code}");
    }
}

/// Generates the code that is needed to create the first account. Returns `None` if there is an account. The
/// code isn't logged.
fn draw_first_code(booth: &Booth) -> Result<Option<String>, Error> {
    if booth.has_accounts()? {
        return Ok(None);
    }
    let bits = random_bytes::<6>().map_err(|error| Error::failure("random bits", error))?;
    let pairs: Vec<String> =
        bits.chunks(2).map(|two| format!("{:02x}{:02x}", two[0], two[1])).collect();
    Ok(Some(pairs.join("-")))
}

/// Returns a future that is ready after SIGTERM or SIGINT.
fn end_of_program() -> Result<impl Future<Output = ()>, Error> {
    let fail = |error| Error::failure("signals", error);
    let mut terminate = signal(SignalKind::terminate()).map_err(fail)?;
    let mut interrupt = signal(SignalKind::interrupt()).map_err(fail)?;
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
        info!("told to end");
    })
}

/// The names and addresses by which clients reach the booth.
struct LeafNames {
    listen: IpAddr,
    others: Vec<String>,
}

impl LeafNames {
    fn now(&self) -> Vec<String> {
        local_names(self.listen, &self.others)
    }
}

/// Renews the certificate: checks it every day, and makes a new one at SIGHUP.
async fn keep_leaf(leaf: Arc<LeafKeeper>, names: LeafNames, mut hangup: Signal) {
    loop {
        let renewed = tokio::select! {
            () = tokio::time::sleep(LOOK_AT_LEAF_EVERY) => {
                leaf.renew_if_due(&names.now(), SystemTime::now())
            }
            _ = hangup.recv() => leaf.reload(&names.now(), SystemTime::now()).map(|()| true),
        };
        match renewed {
            Ok(true) => info!("a new certificate"),
            Ok(false) => {}
            Err(error) => warn!(%error, "no new certificate; the one that there is stays"),
        }
    }
}

async fn sweep_now_and_then(app: Arc<BoothApp>) {
    let mut most = MAX_CLOCK_GAP;
    loop {
        match app.run(move |app| sweep(app, most)).await {
            Ok(()) => most = MAX_CLOCK_STEP,
            Err(error) => warn!(%error, "the sweep failed"),
        }
        for warning in take_storage_warnings() {
            warn!(%warning, "storage");
        }
        tokio::time::sleep(SWEEP_EVERY).await;
    }
}

fn sweep(app: &BoothApp, most: Duration) -> Result<(), Refusal> {
    let report = app.booth.sweep(booth_time(), most)?;
    if report != Default::default() {
        info!(?report, "swept");
    }
    if let Some(ClockJump { seen_at, now }) = app.booth.find_clock_jump(booth_time())? {
        let (seen_at, now) = (seen_at.seconds(), now.seconds());
        warn!(
            seen_at,
            now, "the clock jumped: nothing expires until an admin confirms it on the staff page"
        );
    }
    Ok(())
}

fn start_log(is_json: bool) {
    let log = tracing_subscriber::fmt()
        .with_max_level(tracing::Level::INFO)
        .with_writer(io::stderr)
        .with_target(false);
    // An existing logger is kept.
    if is_json {
        let _ = log.json().try_init();
    } else {
        let _ = log.with_ansi(false).try_init();
    }
}
