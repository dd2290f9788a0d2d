//! A world's save: written from the model's state, and parsed for the parts that only the core knows.

use std::collections::VecDeque;
use std::sync::Arc;

use paros_core::codec::{BadBytes, ByteReader};
use paros_core::edit::{HalfSpace, Pose};
use paros_core::limits::{MAX_TRAIL_POSES, STATE_BYTES};
use paros_core::session::{HandState, SessionMode};

use crate::dense::DenseVolume;
use crate::step::StepModel;
use crate::step::bench::write_pose;
use crate::step::ensure;
use crate::step::volume::Columns;

/// Length of a visit in bytes.
const VISIT_BYTES: usize = 58;

/// Length of the part before a save's state, in bytes: magic, version, side and checksum.
pub const HEADER_BYTES: usize = 16;

/// The island pass in a save.
#[derive(Clone, PartialEq, Debug)]
pub struct SeenPass {
    /// `true` if a pass runs.
    pub is_running: bool,
    /// `true` if a pass is requested.
    pub is_requested: bool,
    /// `true` if all of ground and mask is reached.
    pub is_seeded: bool,
    /// The voxels reached.
    pub reached: Arc<DenseVolume>,
    /// The rows to visit, by y and z.
    queued: Vec<bool>,
}

impl SeenPass {
    /// Returns the state without a pass.
    pub fn none(side: usize) -> Self {
        SeenPass {
            is_running: false,
            is_requested: false,
            is_seeded: false,
            reached: Arc::new(DenseVolume::empty(side)),
            queued: vec![false; side * side],
        }
    }

    /// Returns `true` if row (y, z) is queued for a visit.
    pub fn is_queued(&self, y: i32, z: i32) -> bool {
        self.queued[y as usize * self.reached.side() + z as usize]
    }

    /// Returns `true` if no row is left to visit.
    pub fn is_done_searching(&self) -> bool {
        self.is_seeded && !self.queued.contains(&true)
    }

    /// Reads the islands' part of a save.
    ///
    /// # Errors
    /// The bytes aren't a valid island search.
    fn read(bytes: &[u8], side: usize) -> Result<Self, String> {
        let mut from = ByteReader::new(bytes);
        Self::read_from(&mut from, side)
            .and_then(|seen| from.expect_end().map(|()| seen))
            .map_err(|bad| format!("islands of a save: {bad:?}"))
    }

    fn read_from(from: &mut ByteReader<'_>, side: usize) -> Result<Self, BadBytes> {
        let flags = from.u8()?;
        let _kept_sum = from.u64()?;
        let mut seen = SeenPass::none(side);
        (seen.is_running, seen.is_requested) = (flags & 1 != 0, flags & 2 != 0);
        seen.is_seeded = seen.is_running;
        if !seen.is_running {
            return Ok(seen);
        }
        let _cursor = from.u8()?;
        let mut reached = DenseVolume::empty(side);
        for y in 0..side {
            let queued = read_bits(from, side)?;
            seen.queued[y * side..][..side].copy_from_slice(&queued);
            for (z, _) in read_bits(from, side)?.iter().enumerate().filter(|(_, held)| **held) {
                for (x, _) in read_bits(from, side)?.iter().enumerate().filter(|(_, bit)| **bit) {
                    reached.set([x, y, z].map(|i| i as i32), true);
                }
            }
        }
        seen.reached = Arc::new(reached);
        Ok(seen)
    }
}

impl<const K: usize> StepModel<K> {
    /// Returns the save's bytes from the state to the undo history.
    pub fn to_save_bytes(&self) -> Vec<u8> {
        let mut to = self.state_bytes();
        write_columns(&mut to, self.volume.columns());
        write_columns(&mut to, self.mask.columns());
        self.history.write(&mut to);
        to
    }

    /// Returns the bytes of all small state, which are the first part of its digest.
    pub fn state_bytes(&self) -> Vec<u8> {
        let mut to = Vec::new();
        to.extend(self.tick.to_le_bytes());
        to.push(self.session as u8);
        to.extend(match self.mode {
            SessionMode::None => [0, 0],
            SessionMode::FreeForm => [1, 0],
            SessionMode::Constrained { figure } => [2, figure],
            SessionMode::Creative => [3, 0],
            SessionMode::Own => [4, 0],
        });
        let is_masked = u8::from(!self.mask.voxels().is_empty());
        to.push(
            is_masked | u8::from(self.is_mirrored) << 1 | self.counted_axes << 2 | self.told << 4,
        );
        to.push(self.string_mm);
        to.extend(self.stool.to_le_bytes());
        write_pose(&mut to, self.head);
        for (hand, trail) in self.hands.iter().zip(&self.trails) {
            write_hand(&mut to, hand);
            write_trail(&mut to, trail);
            write_plane(&mut to, hand.above_float);
        }
        self.bench.write(&mut to);
        // No visit; visits have their own model, `crate::visit`.
        to.extend([0; VISIT_BYTES]);
        to.extend(self.mask_digest.to_le_bytes());
        to
    }
}

/// A world's save, split into two parts.
#[derive(Debug)]
pub struct SplitSave<'a> {
    /// The bytes from the state to the undo history.
    pub known: &'a [u8],
    /// The island pass.
    pub seen: SeenPass,
}

impl<'a> SplitSave<'a> {
    /// Splits the save of a world of `side`^3 voxels and `intervals` intervals a column.
    ///
    /// # Errors
    /// The bytes end early, or don't end with a valid island search.
    pub fn of(save: &'a [u8], side: usize, intervals: usize) -> Result<Self, String> {
        let mut from = ByteReader::new(save);
        skip_to_islands(&mut from, side, intervals)
            .map_err(|bad| format!("undo history of a save: {bad:?}"))?;
        let (known, islands) = save.split_at(from.offset());
        Ok(SplitSave { known: &known[HEADER_BYTES..], seen: SeenPass::read(islands, side)? })
    }

    /// Compares the known part with the model's state.
    ///
    /// # Errors
    /// The place of the difference.
    pub fn compare<const K: usize>(&self, model: &StepModel<K>) -> Result<(), String> {
        let expected = model.to_save_bytes();
        let differs = self.known.iter().zip(&expected).position(|(is, should)| is != should);
        let maps = 3 * model.side() * model.side() * 2 * K;
        let ends = [
            ("state", STATE_BYTES),
            ("volume", STATE_BYTES + maps),
            ("mask", STATE_BYTES + 2 * maps),
        ];
        if let Some(at) = differs {
            let part = ends.iter().find(|(_, end)| at < *end).map_or("undo", |(part, _)| part);
            return Err(format!("the save differs at byte {at}, in {part}"));
        }
        let lengths = (self.known.len(), expected.len());
        ensure!(lengths.0 == lengths.1, "the save's length but for islands: {lengths:?}");
        Ok(())
    }
}

/// Skips state, volume, mask and undo history.
fn skip_to_islands(
    from: &mut ByteReader<'_>,
    side: usize,
    intervals: usize,
) -> Result<(), BadBytes> {
    from.bytes(HEADER_BYTES + STATE_BYTES + 2 * 3 * side * side * 2 * intervals)?;
    let (packed, _applied, flags) = (from.u16()?, from.u16()?, from.u8()?);
    for _ in 0..packed + u16::from(flags & 1) {
        let cells = from.u32()? as usize;
        from.bytes(2 * cells)?;
    }
    Ok(())
}

fn write_columns<const K: usize>(to: &mut Vec<u8>, columns: &Columns<K>) {
    for column in columns.iter().flatten() {
        to.extend(column.to_bytes().as_flattened());
    }
}

/// Writes grip, aim, frozen and wanted pose, flags, buttons, the trigger's ticks and the pulse.
fn write_hand(to: &mut Vec<u8>, hand: &HandState) {
    write_pose(to, hand.grip);
    write_pose(to, hand.aim);
    write_pose(to, (hand.frozen_pose.position, hand.frozen_pose.rotation));
    write_pose(to, (hand.raw_pose.position, hand.raw_pose.rotation));
    let flags = [hand.tracked, hand.trigger, hand.squeeze, hand.can_sweep];
    let more = [hand.has_frozen_pose, hand.is_light, hand.awaits_release, hand.holds_stool];
    let flags = [flags, more].concat();
    to.push(flags.iter().enumerate().map(|(i, &flag)| u8::from(flag) << i).sum());
    to.push(hand.buttons);
    to.extend(hand.trigger_ticks.to_le_bytes());
    to.push(hand.haptic);
    to.push(hand.resize_push as u8);
}

/// Writes a plane's normal in 16 bits a part, and its offset.
fn write_plane(to: &mut Vec<u8>, above: HalfSpace) {
    to.extend(above.normal.to_array().into_iter().flat_map(|part| (part as i16).to_le_bytes()));
    to.extend(above.offset.to_le_bytes());
}

/// Writes the number of poses, the poses, and zeros up to the capacity.
fn write_trail(to: &mut Vec<u8>, trail: &VecDeque<Pose>) {
    to.push(trail.len() as u8);
    let end = to.len() + MAX_TRAIL_POSES * 28;
    trail.iter().for_each(|pose| write_pose(to, (pose.position, pose.rotation)));
    to.resize(end, 0);
}

/// Reads a row of bits in words of 64.
fn read_bits(from: &mut ByteReader<'_>, side: usize) -> Result<Vec<bool>, BadBytes> {
    let mut bits = Vec::with_capacity(side);
    for _ in 0..side.div_ceil(64) {
        let word = from.u64()?;
        bits.extend((0..side.min(64)).map(|i| word >> i & 1 != 0));
    }
    Ok(bits)
}
