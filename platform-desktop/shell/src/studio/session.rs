//! The current session: the world, its start volumes, and the claim on its file. It reads and encodes saves.
//! It decides neither when to save nor whether to record.

use std::io::ErrorKind;

use paros_core::World;
use paros_core::codec::BadSave;
use paros_core::limits::{INTERVALS, max_save_bytes};
use paros_core::volume::{Grid, Size};

use super::Notice;
use crate::claim::SessionClaim;
use crate::durable;
use crate::start_volume_store::StartVolumeStore;
use crate::statics::WorldWithStarts;
use crate::studio_paths::StudioPaths;

/// A world with its start volumes, and the claim on its session file.
pub(super) struct LiveSession<'a, const N: usize>
where
    Grid<N>: Size,
{
    pub(super) world: &'a mut World<N, INTERVALS>,
    pub(super) volumes: &'a mut StartVolumeStore<N, INTERVALS>,
    _claim: SessionClaim,
}

impl<'a, const N: usize> LiveSession<'a, N>
where
    Grid<N>: Size,
{
    /// Claims the lowest free session file for a world, and sets `paths.window` to its number.
    pub(super) fn claim_file(
        resident: &'a mut WorldWithStarts<N, INTERVALS>,
        paths: &mut StudioPaths,
    ) -> Self {
        let WorldWithStarts { start_volumes: volumes, world } = resident;
        let claim = SessionClaim::claim_lowest_free_number(&paths.sessions, N);
        paths.window = claim.number();
        LiveSession { world, volumes, _claim: claim }
    }

    /// Loads the saved session, if there is one. A file that can't be read is moved aside. Returns the
    /// messages for the visitor.
    pub(super) fn resume_saved(&mut self, paths: &StudioPaths) -> Vec<Notice> {
        let path = paths.session_file(N);
        let mut notices = Vec::new();
        if paths.window > 1 {
            let text = "another window has the studio's session; this one's is kept beside it, in";
            notices.push(Notice::Good(format!("{text} {}", path.display())));
        }
        let fault = match durable::read_regular_file(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return notices,
            Err(error) => error.to_string(),
            Ok(bytes) => match self.world.load(&bytes) {
                Ok(()) => return notices,
                Err(bad) => bad.to_string(),
            },
        };
        let aside = paths.unused_path_for_unreadable_save(N);
        let kept = match std::fs::rename(&path, &aside) {
            Ok(()) => format!("it is kept as {}", aside.display()),
            Err(error) => format!("it is {}, and can't be moved: {error}", path.display()),
        };
        notices.push(Notice::Bad(format!("the saved session can't be read: {fault}; {kept}")));
        notices
    }

    /// Encodes the world into `bytes`, replacing their contents. Allocates nothing if their capacity is
    /// enough for any save.
    pub(super) fn encode_into(&self, bytes: &mut Vec<u8>) {
        bytes.resize(max_save_bytes(N, INTERVALS), 0);
        let len = self.world.save(bytes);
        debug_assert!(len <= bytes.len(), "a world of {len} bytes");
        bytes.truncate(len);
    }

    /// Encodes the world.
    pub(super) fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.encode_into(&mut bytes);
        bytes
    }

    /// Loads another save and returns the save of the current world. If the other save is bad, the current
    /// world is restored.
    pub(super) fn load_or_keep(&mut self, save: &[u8]) -> Result<Vec<u8>, BadSave> {
        let current = self.encode();
        match self.world.load(save) {
            Ok(()) => Ok(current),
            Err(bad) => {
                // A load that fails may leave an empty world.
                let _ = self.world.load(&current);
                Err(bad)
            }
        }
    }

    /// Clears the world for another session. Returns the save of the current one if `is_kept`.
    pub(super) fn take_save_and_clear(&mut self, is_kept: bool) -> Option<Vec<u8>> {
        let save = is_kept.then(|| self.encode());
        self.world.clear();
        save
    }
}
