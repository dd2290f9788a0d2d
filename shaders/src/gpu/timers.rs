//! How long the device took for the parts of a frame.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};

/// Nanoseconds of a frame's parts on the device; zero where it has no timestamps.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Times {
    /// Copies of what changed.
    pub uploads: u64,
    /// What the sun sees.
    pub shadow: u64,
    /// Where the tiles' rays start.
    pub tiles: u64,
    /// The sculpture within the frame's pass.
    pub sculpture: u64,
    /// The rest of the frame's pass: the scene, and the pixels' clearing and resolving.
    pub scene: u64,
    /// All of the frame.
    pub whole: u64,
}

/// Moments of a frame, in order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Mark {
    Begin = 0,
    Uploaded = 2,
    Shadowed = 4,
    Tiled = 6,
    SculptureBegins = 8,
    SculptureEnds = 10,
    End = 12,
}

/// Marks, each with room for two views: within a multiview pass a timestamp takes one query each.
const QUERIES: u32 = 14;

/// The timestamps of one frame of the ring.
pub(super) struct Timers {
    gpu: Arc<Gpu>,
    pool: vk::QueryPool,
}

impl Timers {
    pub(super) fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(QUERIES);
        // SAFETY: the device is alive and the info complete.
        let pool =
            unsafe { gpu.device.create_query_pool(&info, None) }.doing("make a query pool")?;
        Ok(Timers { gpu: gpu.clone(), pool })
    }

    pub(super) fn reset(&self, commands: vk::CommandBuffer) {
        // SAFETY: the frame's fence has passed, so no work writes these queries.
        unsafe { self.gpu.device.cmd_reset_query_pool(commands, self.pool, 0, QUERIES) };
    }

    pub(super) fn mark(&self, commands: vk::CommandBuffer, mark: Mark) {
        if self.gpu.needs.timestamp_period == 0 {
            return;
        }
        let stage = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
        // SAFETY: the queries were reset in this buffer and each mark is set once.
        unsafe { self.gpu.device.cmd_write_timestamp(commands, stage, self.pool, mark as u32) };
    }

    /// The times of the frame whose fence has passed.
    pub(super) fn read(&self) -> Times {
        let mut ticks = [0u64; QUERIES as usize];
        for mark in [
            Mark::Begin,
            Mark::Uploaded,
            Mark::Shadowed,
            Mark::Tiled,
            Mark::SculptureBegins,
            Mark::SculptureEnds,
            Mark::End,
        ] {
            let place = mark as usize;
            // SAFETY: the pool has this query, which the frame wrote; no wait is asked for.
            let read = unsafe {
                self.gpu.device.get_query_pool_results(
                    self.pool,
                    place as u32,
                    &mut ticks[place..=place],
                    vk::QueryResultFlags::TYPE_64,
                )
            };
            if read.is_err() {
                return Times::default();
            }
        }
        let between = |from: Mark, to: Mark| {
            let ticks = ticks[to as usize].saturating_sub(ticks[from as usize]);
            ticks * self.gpu.needs.timestamp_period / 1_000_000
        };
        Times {
            uploads: between(Mark::Begin, Mark::Uploaded),
            shadow: between(Mark::Uploaded, Mark::Shadowed),
            tiles: between(Mark::Shadowed, Mark::Tiled),
            sculpture: between(Mark::SculptureBegins, Mark::SculptureEnds),
            scene: between(Mark::Tiled, Mark::SculptureBegins)
                + between(Mark::SculptureEnds, Mark::End),
            whole: between(Mark::Begin, Mark::End),
        }
    }
}

impl Drop for Timers {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe { self.gpu.device.destroy_query_pool(self.pool, None) };
    }
}
