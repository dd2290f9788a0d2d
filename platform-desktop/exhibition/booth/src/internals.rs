//! The booth's readers of bytes that others write, for the fuzzer alone: nothing here is promised.

use std::path::Path;

use axum::body::Body;
use axum::extract::{Form, FromRequest as _, Query};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Request, header};
use futures_util::FutureExt as _;
use paros_booth_rules::{BoothTime, Deletion};

use crate::commands::restore;
use crate::error::Error;
use crate::models::{exporter, mesh_check, threemf};
use crate::server::routes;
use crate::store::deletion_log;
use crate::{printing, staff};

/// Minutes and tenths of a gram that the comments of some G-code tell.
#[must_use]
pub fn parse_estimate(text: &str) -> Option<(u32, u32)> {
    printing::parse_estimate(text).map(|estimate| (estimate.minutes, estimate.tenths_gram))
}

/// What a printer's answers say: of Moonraker's protocol the first, of PrusaLink's both. Its state, its file and its
/// percent.
#[must_use]
pub fn read_printer(
    first: &[u8],
    second: Option<&[u8]>,
) -> Option<(String, Option<String>, Option<u8>)> {
    printing::read_answers(first, second)
        .map(|status| (format!("{:?}", status.activity), status.file, status.percent))
}

/// How many printers a file names.
///
/// # Errors
/// What is wrong with it and where.
pub fn parse_printers(text: &str) -> Result<usize, String> {
    printing::parse_printers(text).map(|printers| printers.len())
}

/// A log of deletions.
///
/// # Errors
/// The first line that is none of a log.
pub fn parse_deletions(bytes: Vec<u8>) -> Result<Vec<Deletion>, String> {
    deletion_log::parse_deletions(bytes)
}

/// Unpacks a backup's archive into an empty folder. When it was made, in milliseconds.
///
/// # Errors
/// What is wrong with it.
pub fn unpack_backup(archive: &Path, folder: &Path) -> Result<u64, Error> {
    restore::unpack(archive, folder).map(|copied_at| copied_at.0)
}

/// The fields of a page's form with these names, and the size of a print in it.
#[must_use]
pub fn read_form(body: &[u8], names: &[&str]) -> Option<Vec<String>> {
    let form = "application/x-www-form-urlencoded";
    let request = Request::post("/").header(header::CONTENT_TYPE, form);
    let request = request.body(Body::from(body.to_vec())).ok()?;
    // All of it is there, so that nothing is waited for.
    let fields = Form::<staff::Fields>::from_request(request, &()).now_or_never()?.ok()?;
    let Form(fields) = fields;
    let size = staff::read_size(&fields.get("height"), &fields.get("minutes"));
    let size = size.map_or_else(|refusal| refusal.to_string(), |size| format!("{size:?}"));
    Some(names.iter().map(|name| fields.get(name)).chain([size]).collect())
}

/// Reads the query of the address of the list of sculptures. Returns the address as the booth writes it, and what it lists.
#[must_use]
pub fn read_list(query: &str) -> Option<(String, String)> {
    let address = format!("/staff?{query}").parse().ok()?;
    let Query(fields) = Query::<staff::Fields>::try_from_uri(&address).ok()?;
    let (link, filter) = staff::read_query(&fields, BoothTime(1_790_000_000_000));
    Some((link, format!("{filter:?}")))
}

/// The length of a parcel's file, as the address and the headers say.
///
/// # Errors
/// What was expected.
pub fn read_put(id: &str, headers: &[(&[u8], &[u8])]) -> Result<u64, String> {
    let mut map = HeaderMap::new();
    for (name, value) in headers {
        let name = HeaderName::from_bytes(name).map_err(|_| "a header's name")?;
        map.append(name, HeaderValue::from_bytes(value).map_err(|_| "a header's value")?);
    }
    let read = routes::read_put(id, &map).map_err(|refusal| refusal.to_string());
    read.map(|(_, length)| length)
}

/// What is told of a mesh whose bytes pass by in two pieces, and of its 3MF: whether it is closed, and its triangles.
///
/// # Errors
/// Why it is no STL.
pub fn check_stl(first: &[u8], second: &[u8]) -> Result<(bool, u32, usize), String> {
    let mut check = mesh_check::MeshCheck::new();
    check.look_at(first);
    check.look_at(second);
    let report = check.finish()?;
    let (_, triangles) = threemf::read_stl(&[first, second].concat())?;
    Ok((report.is_closed, report.triangles, triangles.len()))
}

/// The STL of a kept file.
///
/// # Errors
/// What is wrong with it.
pub fn make_stl(kept: &[u8]) -> Result<Vec<u8>, String> {
    exporter::make_stl(kept)
}
