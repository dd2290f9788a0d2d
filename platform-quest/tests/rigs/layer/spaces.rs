//! Reference spaces: LOCAL_FLOOR is hidden if the file `no-floor` exists in the layer's folder, and STAGE if
//! `no-stage` does.

use openxr::sys;
use sys::{ReferenceSpaceType, Result as Status, pfn};

use super::chain::call_next;
use super::folder::{layer_folder, log_line};

const HIDDEN: [(&str, ReferenceSpaceType); 2] =
    [("no-floor", ReferenceSpaceType::LOCAL_FLOOR), ("no-stage", ReferenceSpaceType::STAGE)];

fn is_hidden(kind: ReferenceSpaceType) -> bool {
    HIDDEN.iter().any(|(file, hidden)| *hidden == kind && layer_folder().join(file).exists())
}

pub(crate) unsafe extern "system" fn enumerate_reference_spaces(
    session: sys::Session,
    capacity: u32,
    count: *mut u32,
    spaces: *mut ReferenceSpaceType,
) -> Status {
    let done = call_next!(c"xrEnumerateReferenceSpaces": EnumerateReferenceSpaces, session, capacity, count, spaces);
    if done == Status::SUCCESS && capacity > 0 {
        // SAFETY: the call has succeeded, and so many kinds stand there.
        let all = unsafe { core::slice::from_raw_parts_mut(spaces, *count as usize) };
        let seen: Vec<_> = all.iter().copied().filter(|kind| !is_hidden(*kind)).collect();
        all[..seen.len()].copy_from_slice(&seen);
        // SAFETY: as above.
        unsafe { *count = seen.len() as u32 };
    }
    done
}

/// Logs `space KIND HEIGHT`. A hidden space can't be created.
pub(crate) unsafe extern "system" fn create_reference_space(
    session: sys::Session,
    info: *const sys::ReferenceSpaceCreateInfo,
    space: *mut sys::Space,
) -> Status {
    // SAFETY: the shell's structure is valid during the call.
    let (kind, pose) = unsafe { ((*info).reference_space_type, (*info).pose_in_reference_space) };
    // Logs a height of -0 as 0.
    log_line(&format!("space {kind:?} {}", pose.position.y + 0.0));
    if is_hidden(kind) {
        return Status::ERROR_REFERENCE_SPACE_UNSUPPORTED;
    }
    call_next!(c"xrCreateReferenceSpace": CreateReferenceSpace, session, info, space)
}
