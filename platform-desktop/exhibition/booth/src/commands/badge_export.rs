//! Export of all data stored under a badge, as a ZIP archive: `known.json`, and for each sculpture its mesh,
//! picture and trace.

use std::io::{Cursor, Read as _, Write as _};

use flate2::read::DeflateDecoder;
use paros_booth_rules::limits::MAX_EXPORTED;
use paros_booth_rules::records::{MailState, Sculpture};
use paros_booth_rules::{BadgeRecords, Booth, BoothTime, Refusal, SculptureRecords};
use paros_core::badge::{BadgeNumber, Language, write_words};
use paros_protocol::{SculptureId, UploadFacts};
use serde_json::{Value, json};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::models::exporter::make_stl;

/// Returns the archive for a badge. Times in it are in milliseconds since 1970.
///
/// # Errors
/// [`Refusal::TooLarge`] if the badge has more sculptures than one export allows; errors of the store and the
/// disk.
pub(crate) fn write_export(booth: &Booth, badge: BadgeNumber) -> Result<Vec<u8>, Refusal> {
    let known = booth.list_known(badge)?;
    if known.sculptures.len() > MAX_EXPORTED {
        return Err(Refusal::TooLarge { what: "sculptures at once", most: MAX_EXPORTED as u64 });
    }
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let mut add = |name: &str, bytes: &[u8]| -> Result<(), Refusal> {
        zip.start_file(name, options).map_err(std::io::Error::from)?;
        Ok(zip.write_all(bytes)?)
    };
    let text =
        serde_json::to_vec_pretty(&tell_known(badge, &known)).map_err(std::io::Error::from)?;
    add("known.json", &text)?;
    for SculptureRecords { sculpture, .. } in &known.sculptures {
        let id = SculptureId(sculpture.id);
        // A mesh that can't be made any more is left out.
        if let Ok(stl) = make_stl(&booth.read_kept(sculpture)?) {
            add(&format!("{id}.stl"), &stl)?;
        }
        if let Some(png) = booth.read_picture(sculpture)? {
            add(&format!("{id}.png"), &png)?;
        }
        if let Some(packed) = booth.read_trace(sculpture)? {
            add(&format!("{id}.trace"), &unpack_trace(sculpture, &packed)?)?;
        }
    }
    Ok(zip.finish().map_err(std::io::Error::from)?.into_inner())
}

fn tell_known(badge: BadgeNumber, known: &BadgeRecords) -> Value {
    let mut words = String::new();
    // Writing to a String doesn't fail.
    let _ = write_words(&mut words, &badge.badge(), Language::English);
    let announced = known.announced.iter().map(|announced| {
        json!({
            "sculpture": SculptureId(announced.sculpture).to_string(),
            "headset": announced.headset,
            "heard_at": announced.heard_at.0,
        })
    });
    let deleted = known.deleted.iter().map(|deleted| {
        json!({
            "sculpture": SculptureId(deleted.id).to_string(),
            "headset": deleted.headset,
            "deleted_at": deleted.deleted_at.0,
        })
    });
    json!({
        "badge": words,
        "number": badge.get(),
        "sculptures": known.sculptures.iter().map(tell_sculpture).collect::<Vec<_>>(),
        "announced": announced.collect::<Vec<_>>(),
        "deleted": deleted.collect::<Vec<_>>(),
    })
}

fn tell_sculpture(known: &SculptureRecords) -> Value {
    let Sculpture { id, headset, received_at, keep_day, withdrawn_at, has_trace, .. } =
        &known.sculpture;
    let mails = known.mails.iter().map(|mail| {
        json!({
            "asked_at": mail.asked_at.0,
            "address": mail.address,
            "is_sent": mail.state == MailState::Accepted,
            "agreed_to_keep_address": mail.keeps_address,
        })
    });
    let prints = known.prints.iter().map(|print| {
        json!({ "asked_at": print.asked_at.0, "filament": print.filament, "note": print.note })
    });
    let audit = known
        .audit
        .iter()
        .map(|entry| json!({ "at": entry.at.0, "account": entry.account, "action": entry.action }));
    json!({
        "id": SculptureId(*id).to_string(),
        "headset": headset,
        "received_at": received_at.0,
        "kept_until": BoothTime::of_day(keep_day.saturating_add(1)).0,
        "withdrawn_at": withdrawn_at.map(|at| at.0),
        "has_trace": has_trace,
        "visit": UploadFacts::from_json(&known.sculpture.facts).ok().map(|facts| tell_facts(&facts)),
        "mails": mails.collect::<Vec<_>>(),
        "prints": prints.collect::<Vec<_>>(),
        "audit": audit.collect::<Vec<_>>(),
    })
}

fn tell_facts(facts: &UploadFacts) -> Value {
    json!({
        "language": String::from_utf8_lossy(&facts.language),
        "age_group": format!("{:?}", facts.age_group),
        "mode": format!("{:?}", facts.mode),
        "cause": format!("{:?}", facts.cause),
        "sculpting_seconds": facts.sculpting_seconds,
        "finished_at": facts.finished_at * 1000,
        "height_mm": f64::from(facts.height_mm_tenths) / 10.0,
    })
}

/// Unpacks a trace. It was validated on arrival.
fn unpack_trace(sculpture: &Sculpture, packed: &[u8]) -> Result<Vec<u8>, Refusal> {
    let facts = UploadFacts::from_json(&sculpture.facts);
    let most = facts.map_or(0, |facts| u64::from(facts.trace_raw_bytes));
    let mut trace = Vec::new();
    DeflateDecoder::new(packed).take(most).read_to_end(&mut trace)?;
    Ok(trace)
}
