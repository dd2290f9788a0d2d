//! Entry points for the fuzzer: the booth's parsers of untrusted bytes. They are not part of the public
//! interface.

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

/// Reads the print time in minutes and the material in tenths of a gram from the comments of a G-code file.
#[must_use]
pub fn parse_estimate(text: &str) -> Option<(u32, u32)> {
    printing::parse_estimate(text).map(|estimate| (estimate.minutes, estimate.tenths_gram))
}

/// Parses a printer's response bodies: Moonraker sends one, PrusaLink two. Returns the printer's state, file
/// and progress in percent.
#[must_use]
pub fn read_printer(
    first: &[u8],
    second: Option<&[u8]>,
) -> Option<(String, Option<String>, Option<u8>)> {
    printing::read_answers(first, second)
        .map(|status| (format!("{:?}", status.activity), status.file, status.percent))
}

/// Parses a printers file. Returns the number of printers.
///
/// # Errors
/// A description of what is wrong with the file and where.
pub fn parse_printers(text: &str) -> Result<usize, String> {
    printing::parse_printers(text).map(|printers| printers.len())
}

/// Parses a log of deletions.
///
/// # Errors
/// The first line that isn't valid.
pub fn parse_deletions(bytes: Vec<u8>) -> Result<Vec<Deletion>, String> {
    deletion_log::parse_deletions(bytes)
}

/// Unpacks a backup archive into an empty folder. Returns the time of the backup in milliseconds since 1970.
///
/// # Errors
/// A description of what is wrong with the archive.
pub fn unpack_backup(archive: &Path, folder: &Path) -> Result<u64, Error> {
    restore::unpack(archive, folder).map(|copied_at| copied_at.0)
}

/// Parses a form body. Returns its fields with these names, and the parsed size of a print.
#[must_use]
pub fn read_form(body: &[u8], names: &[&str]) -> Option<Vec<String>> {
    let form = "application/x-www-form-urlencoded";
    let request = Request::post("/").header(header::CONTENT_TYPE, form);
    let request = request.body(Body::from(body.to_vec())).ok()?;
    // The whole body is in memory, so the future is ready at once.
    let fields = Form::<staff::Fields>::from_request(request, &()).now_or_never()?.ok()?;
    let Form(fields) = fields;
    let size = staff::read_size(&fields.get("height"), &fields.get("minutes"));
    let size = size.map_or_else(|refusal| refusal.to_string(), |size| format!("{size:?}"));
    Some(names.iter().map(|name| fields.get(name)).chain([size]).collect())
}

/// Parses the query of the sculpture list's address. Returns the normalised address and the filter.
#[must_use]
pub fn read_list(query: &str) -> Option<(String, String)> {
    let address = format!("/staff?{query}").parse().ok()?;
    let Query(fields) = Query::<staff::Fields>::try_from_uri(&address).ok()?;
    let (link, filter) = staff::read_query(&fields, BoothTime(1_790_000_000_000));
    Some((link, format!("{filter:?}")))
}

/// Returns the length of a parcel's file, from the request's path and headers.
///
/// # Errors
/// A description of what was expected.
pub fn read_put(id: &str, headers: &[(&[u8], &[u8])]) -> Result<u64, String> {
    let mut map = HeaderMap::new();
    for (name, value) in headers {
        let name = HeaderName::from_bytes(name).map_err(|_| "a header's name")?;
        map.append(name, HeaderValue::from_bytes(value).map_err(|_| "a header's value")?);
    }
    let read = routes::read_put(id, &map).map_err(|refusal| refusal.to_string());
    read.map(|(_, length)| length)
}

/// Checks an STL that arrives in two pieces, and reads it as the 3MF export does. Returns `true` if the mesh
/// is closed, its number of triangles, and the number of triangles in the 3MF.
///
/// # Errors
/// The reason why the bytes are not a valid STL.
pub fn check_stl(first: &[u8], second: &[u8]) -> Result<(bool, u32, usize), String> {
    let mut check = mesh_check::MeshCheck::new();
    check.look_at(first);
    check.look_at(second);
    let report = check.finish()?;
    let (_, triangles) = threemf::read_stl(&[first, second].concat())?;
    Ok((report.is_closed, report.triangles, triangles.len()))
}

/// Makes the STL of a kept sculpture's file.
///
/// # Errors
/// A description of what is wrong with the file.
pub fn make_stl(kept: &[u8]) -> Result<Vec<u8>, String> {
    exporter::make_stl(kept)
}
