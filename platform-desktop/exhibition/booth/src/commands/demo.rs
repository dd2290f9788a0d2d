//! The demo booth: ten sculptures with badges, added as if a headset had sent them.

use std::fs::{self, DirBuilder};
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

use paros_booth_rules::{Booth, BoothTime, Refusal};
use paros_core::badge::BadgeNumber;
use paros_core::codec::trace::CORE_VERSION;
use paros_core::session::SessionMode;
use paros_protocol::{
    AgeGroup, BadgeReport, BlockSerial, ContentHash, FinishCause, Heartbeat, Parcel, SculptureId,
    UploadFacts,
};

use crate::commands::demo_shapes::{SHAPES, SIDE, make_volume};
use crate::commands::options::ServeOptions;
use crate::commands::own_headset::enrol_own_headset;
use crate::error::Error;
use crate::models::parcel_decode::check_parcel;
use crate::random::random_bytes;

/// The name of the demo's headset.
const HEADSET_NAME: &str = "Demo";

/// The time between the ends of two visits, in seconds.
const VISIT_SECONDS: u64 = 700;

/// A temporary folder for a demo without `--folder`. It is removed on drop.
#[derive(Debug)]
pub(crate) struct DemoFolder(PathBuf);

impl DemoFolder {
    /// Makes a temporary folder if the options ask for a demo and name no folder.
    ///
    /// # Errors
    /// An I/O error.
    pub(crate) fn make(options: &ServeOptions) -> Result<Option<Self>, Error> {
        if !options.demo || options.folder.folder.is_some() {
            return Ok(None);
        }
        let random = random_bytes::<8>().map_err(|error| Error::failure("random bits", error))?;
        let name = format!("paros-booth-demo-{:016x}", u64::from_le_bytes(random));
        let path = std::env::temp_dir().join(name);
        let made = DirBuilder::new().mode(0o700).create(&path);
        made.map_err(|error| Error::at(&path, error))?;
        Ok(Some(DemoFolder(path)))
    }

    /// Returns the folder's path.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for DemoFolder {
    fn drop(&mut self) {
        // If removal fails, the system cleans its temporary folder up later.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Adds the demo's sculptures to a booth. Sculptures that are there already are kept as they are.
///
/// # Errors
/// [`Error::Input`] if real headsets were enrolled in the booth; errors of the store and the disk.
pub(crate) fn add_demo(booth: &Booth, now: BoothTime) -> Result<(), Error> {
    let devices = booth.list_devices()?;
    if devices.iter().any(|device| device.name != HEADSET_NAME) {
        let why = "--demo: headsets were enrolled in this folder; name an empty one";
        return Err(Error::Input(why.into()));
    }
    if devices.is_empty() {
        fill(booth, now)?;
    }
    Ok(())
}

fn fill(booth: &Booth, now: BoothTime) -> Result<(), Refusal> {
    let device = enrol_own_headset(booth, (HEADSET_NAME, "demo"), now)?;
    let first = Heartbeat::first(device.headset, 1, BadgeReport { epoch: 1, blocks: Vec::new() });
    let answer = booth.take_heartbeat(&device, &first, now)?;
    let held = answer.badges.first();
    for (k, shape) in SHAPES.into_iter().enumerate() {
        let badge = held.and_then(|held| BadgeNumber::of_block(held.block, k as u8));
        let badge = (badge, held.map(|held| held.serial));
        let before = VISIT_SECONDS * (SHAPES.len() - k) as u64;
        let finished_at = BoothTime(now.0.saturating_sub(1000 * before));
        let parcel = make_parcel(k, &make_volume(shape), badge, finished_at)
            .map_err(Refusal::Undecodable)?;
        let id = parcel.facts().id;
        booth.take_parcel(device.headset, id, parcel.file_bytes(), &check_parcel, finished_at)?;
    }
    Ok(())
}

/// Makes the parcel that a headset would send for a volume.
fn make_parcel(
    k: usize,
    volume: &[u8],
    (badge, badge_serial): (Option<BadgeNumber>, Option<BlockSerial>),
    finished_at: BoothTime,
) -> Result<Parcel, String> {
    let ContentHash(hash) = ContentHash::of(format!("sculpture {k} of the demo").as_bytes());
    let mut id = [0; 16];
    id.copy_from_slice(&hash[..16]);
    let facts = UploadFacts {
        id: SculptureId(id),
        badge,
        badge_serial,
        core_version: CORE_VERSION,
        side: SIDE as u16,
        cause: FinishCause::Finished,
        language: if k.is_multiple_of(2) { *b"el" } else { *b"en" },
        mode: SessionMode::FreeForm,
        age_group: if k.is_multiple_of(3) { AgeGroup::UnderAge } else { AgeGroup::Unknown },
        sculpting_seconds: 300 + 20 * k as u32,
        finished_at: finished_at.seconds(),
        height_mm_tenths: 900,
        volume_bytes: 1,
        volume_raw_bytes: 1,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    };
    Parcel::pack(&facts, volume, None).map_err(|fault| fault.to_string())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::models::exporter::export_volume;

    #[test]
    fn all_shapes_are_sculptures_of_their_own_whose_mesh_is_closed() {
        let mut volumes = BTreeSet::new();
        for (k, shape) in SHAPES.into_iter().enumerate() {
            let volume = make_volume(shape);
            assert_eq!(make_volume(shape), volume, "the same each time");
            let badge = BadgeNumber::new(k as u32).expect("a number");
            let parcel =
                make_parcel(k, &volume, (Some(badge), None), BoothTime(1)).expect("a parcel");
            let facts = parcel.facts();
            check_parcel(facts, parcel.volume(), &[]).expect("it decodes");
            let mut check = crate::models::mesh_check::MeshCheck::new();
            check.look_at(&export_volume(facts, &volume).expect("a mesh"));
            let mesh = check.finish().expect("a mesh");
            assert!(mesh.is_closed && mesh.triangles > 1000, "{k}: {}", mesh.triangles);
            assert!(volumes.insert(volume), "{k} is another's");
        }
    }
}
