//! The client of a printer on the network, for the two protocols that printers speak:
//!
//! | | Moonraker | PrusaLink |
//! |---|---|---|
//! | state | `GET /printer/objects/query?print_stats&virtual_sdcard` | `GET /api/v1/status`, `GET /api/v1/job` |
//! | upload and start | `POST /server/files/upload` (a form: `root`, `print`, `file`) | `PUT /api/v1/files/{storage}/{name}` with `Print-After-Upload` and `Overwrite` |
//! | stop | `POST /printer/print/cancel` | `DELETE /api/v1/job/{id}` |
//!
//! Both protocols take the API key in the header `X-Api-Key`. Source: Moonraker's documentation of its
//! external API (*Printer administration*, *File management*), and PrusaLink's OpenAPI description
//! (`prusa3d/Prusa-Link-Web`, `spec/openapi.yaml`). Responses are untrusted: their length is limited, and
//! their error texts are not passed on.

use std::fs::{self, File};
use std::io::{Chain, Cursor, Read as _};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use serde_json::Value;
use tokio_rustls::rustls::crypto::ring;
use ureq::http::Response;
use ureq::tls::{Certificate, RootCerts, TlsConfig, TlsProvider};
use ureq::{Agent, Body, SendBody};

use super::printer_file::{PrinterEntry, PrinterKind};
use crate::error::Error;

/// The most bytes of a response that are read.
const MAX_ANSWER: u64 = 64 << 10;

/// The timeout of a response.
const ANSWER_TIME: Duration = Duration::from_secs(10);

/// The timeout of an upload: 200 MB over a slow wireless network.
const UPLOAD_TIME: Duration = Duration::from_secs(1200);

/// The boundary between the parts of a multipart form. No line of G-code begins with it.
const BOUNDARY: &str = "----paros-booth-print-7c1f";

/// The connection to a printer.
pub(crate) struct PrinterLink {
    kind: PrinterKind,
    address: String,
    key: String,
    storage: String,
    agent: Agent,
}

/// The status of a printer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct PrinterStatus {
    pub(crate) activity: Activity,
    /// The current or last file.
    pub(crate) file: Option<String>,
    /// The progress in percent, while it prints.
    pub(crate) percent: Option<u8>,
    /// PrusaLink's job number.
    job: Option<u64>,
}

/// The activity of a printer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Activity {
    /// Ready for a print.
    Idle,
    /// Printing its file, or paused.
    Printing,
    /// Finished its file.
    Finished,
    /// The print of its file was cancelled.
    Stopped,
    /// The print failed.
    Broken,
    /// Busy with something else: leave it alone.
    Busy,
}

/// The reason why a request to a printer failed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum PrinterFault {
    /// No response in time. It is unknown whether the printer got the request.
    Silent,
    /// The printer refused the request.
    Refused(String),
}

impl PrinterLink {
    /// Makes the client of a printer in the printers file.
    ///
    /// # Errors
    /// The certificate authority's file can't be read.
    pub(crate) fn new(entry: &PrinterEntry) -> Result<Self, Error> {
        let mut tls = TlsConfig::builder()
            .provider(TlsProvider::Rustls)
            .unversioned_rustls_crypto_provider(Arc::new(ring::default_provider()));
        if let Some(path) = &entry.ca {
            let bad =
                |why: &dyn std::fmt::Display| Error::Input(format!("{}: {why}", path.display()));
            let pem = fs::read(path).map_err(|error| bad(&error))?;
            let ca = Certificate::from_pem(&pem).map_err(|error| bad(&error))?;
            tls = tls.root_certs(RootCerts::new_with_certs(&[ca]));
        }
        let config = Agent::config_builder()
            .tls_config(tls.build())
            .http_status_as_error(false)
            .max_redirects(0)
            .max_redirects_will_error(false)
            .proxy(None)
            .timeout_connect(Some(ANSWER_TIME))
            .timeout_recv_response(Some(ANSWER_TIME))
            .timeout_global(Some(UPLOAD_TIME))
            .build();
        Ok(PrinterLink {
            kind: entry.kind,
            address: entry.address.clone(),
            key: entry.key.0.clone(),
            storage: entry.storage.clone(),
            agent: config.into(),
        })
    }

    /// Requests the printer's status.
    ///
    /// # Errors
    /// The printer doesn't respond, refuses, or sends something invalid.
    pub(crate) fn status(&self) -> Result<PrinterStatus, PrinterFault> {
        match self.kind {
            PrinterKind::Moonraker => {
                let path = "/printer/objects/query?print_stats&virtual_sdcard";
                let answer = read(self.get(path)?)?;
                read_moonraker(&answer).ok_or_else(nonsense)
            }
            PrinterKind::PrusaLink => {
                let status = read(self.get("/api/v1/status")?)?;
                let job = self.get("/api/v1/job")?;
                // 204: there is no job.
                let job = if job.status() == 204 { Value::Null } else { read(job)? };
                read_prusalink(&status, &job).ok_or_else(nonsense)
            }
        }
    }

    /// Uploads a file under a name, and starts to print it.
    ///
    /// # Errors
    /// The printer doesn't respond, or refuses.
    pub(crate) fn send(&self, name: &str, gcode: &Path) -> Result<(), PrinterFault> {
        let failed = |_| PrinterFault::Refused("the slicer's file is gone".into());
        let file = File::open(gcode).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        let answer = match self.kind {
            PrinterKind::Moonraker => self.post_form(name, file, length),
            PrinterKind::PrusaLink => {
                let mut file = file;
                let path = format!("/api/v1/files/{}/{name}", self.storage);
                let request = self.agent.put(self.url(&path));
                self.keyed(request)
                    .header("Content-Type", "text/x.gcode")
                    .header("Content-Length", length.to_string())
                    .header("Print-After-Upload", "?1")
                    .header("Overwrite", "?1")
                    .send(SendBody::from_reader(&mut file))
            }
        };
        check(answer.map_err(|_| PrinterFault::Silent)?).map(drop)
    }

    /// Cancels the print that `status` describes.
    ///
    /// # Errors
    /// The printer doesn't respond, or refuses; `status` has no job number, which PrusaLink needs.
    pub(crate) fn stop(&self, status: &PrinterStatus) -> Result<(), PrinterFault> {
        let answer = match (self.kind, status.job) {
            (PrinterKind::Moonraker, _) => {
                self.keyed(self.agent.post(self.url("/printer/print/cancel"))).send_empty()
            }
            (PrinterKind::PrusaLink, Some(job)) => {
                self.keyed(self.agent.delete(self.url(&format!("/api/v1/job/{job}")))).call()
            }
            (PrinterKind::PrusaLink, None) => return Err(nonsense()),
        };
        check(answer.map_err(|_| PrinterFault::Silent)?).map(drop)
    }

    fn post_form(
        &self,
        name: &str,
        file: File,
        length: u64,
    ) -> Result<Response<Body>, ureq::Error> {
        let field = |name: &str, value: &str| {
            format!(
                "--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"{name}\"\r\n\r\n{value}\r\n"
            )
        };
        let head = format!(
            "{}{}--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"file\"; filename=\"{name}\"\r\n\
             Content-Type: application/octet-stream\r\n\r\n",
            field("root", "gcodes"),
            field("print", "true")
        );
        let end = format!("\r\n--{BOUNDARY}--\r\n");
        let length = head.len() as u64 + length + end.len() as u64;
        let mut body: Chain<Chain<Cursor<String>, File>, Cursor<String>> =
            Cursor::new(head).chain(file).chain(Cursor::new(end));
        let request = self.agent.post(self.url("/server/files/upload"));
        self.keyed(request)
            .header("Content-Type", format!("multipart/form-data; boundary={BOUNDARY}"))
            .header("Content-Length", length.to_string())
            .send(SendBody::from_reader(&mut body))
    }

    fn get(&self, path: &str) -> Result<Response<Body>, PrinterFault> {
        self.keyed(self.agent.get(self.url(path))).call().map_err(|_| PrinterFault::Silent)
    }

    fn url(&self, path: &str) -> String {
        format!("{}{path}", self.address)
    }

    fn keyed<B>(&self, request: ureq::RequestBuilder<B>) -> ureq::RequestBuilder<B> {
        if self.key.is_empty() { request } else { request.header("X-Api-Key", &self.key) }
    }
}

fn nonsense() -> PrinterFault {
    PrinterFault::Refused("the printer says what nobody understands".into())
}

fn check(answer: Response<Body>) -> Result<Response<Body>, PrinterFault> {
    match answer.status().as_u16() {
        200..300 => Ok(answer),
        401 | 403 => Err(PrinterFault::Refused("the printer wants another key".into())),
        status => Err(PrinterFault::Refused(format!("the printer said {status}"))),
    }
}

fn read(answer: Response<Body>) -> Result<Value, PrinterFault> {
    let mut answer = check(answer)?;
    let bytes = answer.body_mut().with_config().limit(MAX_ANSWER).read_to_vec();
    serde_json::from_slice(&bytes.map_err(|_| PrinterFault::Silent)?).map_err(|_| nonsense())
}

/// Parses the bodies of a printer's responses: Moonraker sends one, PrusaLink two. Returns `None` if they are
/// invalid.
pub(crate) fn read_answers(first: &[u8], second: Option<&[u8]>) -> Option<PrinterStatus> {
    let first = serde_json::from_slice(first).ok()?;
    match second {
        None => read_moonraker(&first),
        Some(second) => read_prusalink(&first, &serde_json::from_slice(second).ok()?),
    }
}

/// Converts a part of `whole` to percent.
fn percent(part: Option<f64>, whole: f64) -> Option<u8> {
    part.map(|part| (100.0 * part / whole).clamp(0.0, 100.0) as u8)
}

fn read_moonraker(answer: &Value) -> Option<PrinterStatus> {
    let status = &answer["result"]["status"];
    let stats = &status["print_stats"];
    let activity = match stats["state"].as_str()? {
        "standby" => Activity::Idle,
        "printing" | "paused" => Activity::Printing,
        "complete" => Activity::Finished,
        "cancelled" => Activity::Stopped,
        "error" => Activity::Broken,
        _ => Activity::Busy,
    };
    let file = stats["filename"].as_str().filter(|file| !file.is_empty()).map(str::to_owned);
    let percent = percent(status["virtual_sdcard"]["progress"].as_f64(), 1.0);
    let percent = percent.filter(|_| activity == Activity::Printing);
    Some(PrinterStatus { activity, file, percent, job: None })
}

fn read_prusalink(status: &Value, job: &Value) -> Option<PrinterStatus> {
    let activity = match status["printer"]["state"].as_str()? {
        "IDLE" | "READY" => Activity::Idle,
        "PRINTING" | "PAUSED" => Activity::Printing,
        "FINISHED" => Activity::Finished,
        "STOPPED" => Activity::Stopped,
        "ERROR" => Activity::Broken,
        _ => Activity::Busy,
    };
    // `name` may be the short name of a FAT file system.
    let name = |field: &str| job["file"][field].as_str().map(str::to_owned);
    let percent = percent(job["progress"].as_f64(), 100.0);
    Some(PrinterStatus {
        activity,
        file: name("display_name").or_else(|| name("name")),
        percent: percent.filter(|_| activity == Activity::Printing),
        job: job["id"].as_u64(),
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{Activity, read_moonraker, read_prusalink};

    #[test]
    fn states_of_both_are_read() {
        let moonraker = |state: &str| {
            let stats = json!({ "state": state, "filename": "a.gcode" });
            let status = json!({ "print_stats": stats, "virtual_sdcard": { "progress": 0.428 } });
            read_moonraker(&json!({ "result": { "status": status } }))
        };
        let printing = moonraker("printing").expect("a status");
        assert_eq!((printing.activity, printing.percent), (Activity::Printing, Some(42)));
        assert_eq!(printing.file.as_deref(), Some("a.gcode"));
        let idle = moonraker("standby").expect("a status");
        assert_eq!((idle.activity, idle.percent), (Activity::Idle, None));
        assert_eq!(moonraker("melting").map(|status| status.activity), Some(Activity::Busy));

        let prusalink = |state: &str| {
            let file = json!({ "name": "A~1.GCO", "display_name": "a.gcode" });
            let job = json!({ "id": 9, "progress": 250.0, "file": file });
            read_prusalink(&json!({ "printer": { "state": state } }), &job)
        };
        let printing = prusalink("PRINTING").expect("a status");
        assert_eq!((printing.job, printing.percent), (Some(9), Some(100)));
        assert_eq!(printing.file.as_deref(), Some("a.gcode"));
        assert_eq!(prusalink("ATTENTION").map(|status| status.activity), Some(Activity::Busy));
        for nonsense in [json!(null), json!([]), json!({ "result": 1 }), json!({ "printer": [] })] {
            assert_eq!(read_moonraker(&nonsense), None);
            assert_eq!(read_prusalink(&nonsense, &json!({})), None);
        }
    }
}
