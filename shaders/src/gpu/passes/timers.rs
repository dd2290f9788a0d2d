//! GPU times of the parts of a frame (timestamp queries).

use std::sync::Arc;

use ash::vk;

use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};

/// GPU times of a frame's passes, in nanoseconds; zero on a device without timestamps.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct FrameTimes {
    /// Texture uploads.
    pub uploads_ns: u64,
    /// The shadow map.
    pub shadow_ns: u64,
    /// The march starts of tiles and beams.
    pub tiles_ns: u64,
    /// The frame's pass: sculpture and scene, clears and resolves.
    pub pass_ns: u64,
    /// The sculpture within the frame's pass; `None` unless the renderer [times] it. On a GPU that draws in
    /// tiles, timestamps within a pass would make each tile wait for idle.
    ///
    /// [times]: crate::gpu::Renderer::set_timing_of_sculpture
    pub sculpture_ns: Option<u64>,
    /// The whole frame.
    pub total_ns: u64,
}

/// Timestamps of a frame, in order; the value is the query's number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Timestamp {
    Begin = 0,
    Uploaded = 2,
    Shadowed = 4,
    Tiled = 6,
    SculptureBegins = 8,
    SculptureEnds = 10,
    End = 12,
}

/// Two queries for each timestamp: within a multiview pass a timestamp takes one for each view.
const QUERY_COUNT: u32 = 14;

/// The query pool of one frame of the ring.
pub(crate) struct TimestampQueries {
    gpu: Arc<Gpu>,
    pool: vk::QueryPool,
}

impl TimestampQueries {
    pub(crate) fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(QUERY_COUNT);
        // SAFETY: the device is alive and the info complete.
        let pool =
            unsafe { gpu.device.create_query_pool(&info, None) }.could_not("make a query pool")?;
        Ok(TimestampQueries { gpu: gpu.clone(), pool })
    }

    pub(crate) fn reset(&self, commands: vk::CommandBuffer) {
        // SAFETY: the frame's fence has passed, so no work writes these queries.
        unsafe { self.gpu.device.cmd_reset_query_pool(commands, self.pool, 0, QUERY_COUNT) };
    }

    pub(crate) fn write_timestamp(&self, commands: vk::CommandBuffer, mark: Timestamp) {
        if self.gpu.features.timestamp_period_fs == 0 {
            return;
        }
        let stage = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
        // SAFETY: the queries were reset in this buffer and each mark is set once.
        unsafe { self.gpu.device.cmd_write_timestamp(commands, stage, self.pool, mark as u32) };
    }

    /// Reads the times of a frame whose fence is signaled.
    pub(crate) fn read(&self) -> FrameTimes {
        self.read_passes().unwrap_or_default()
    }

    /// Reads the times; `None` if a timestamp was not written.
    fn read_passes(&self) -> Option<FrameTimes> {
        let [begin, uploaded, shadowed, tiled, end] = [
            Timestamp::Begin,
            Timestamp::Uploaded,
            Timestamp::Shadowed,
            Timestamp::Tiled,
            Timestamp::End,
        ]
        .map(|mark| self.read_timestamp(mark));
        let sculpture = [Timestamp::SculptureBegins, Timestamp::SculptureEnds]
            .map(|mark| self.read_timestamp(mark));
        let between = |from: Option<u64>, to: Option<u64>| {
            let ticks = to?.saturating_sub(from?);
            Some(ticks * self.gpu.features.timestamp_period_fs / 1_000_000)
        };
        Some(FrameTimes {
            uploads_ns: between(begin, uploaded)?,
            shadow_ns: between(uploaded, shadowed)?,
            tiles_ns: between(shadowed, tiled)?,
            pass_ns: between(tiled, end)?,
            sculpture_ns: between(sculpture[0], sculpture[1]),
            total_ns: between(begin, end)?,
        })
    }

    fn read_timestamp(&self, mark: Timestamp) -> Option<u64> {
        let mut ticks = [0u64];
        // SAFETY: the pool has this query; no wait is asked for.
        let read = unsafe {
            self.gpu.device.get_query_pool_results(
                self.pool,
                mark as u32,
                &mut ticks,
                vk::QueryResultFlags::TYPE_64,
            )
        };
        read.ok().map(|()| ticks[0])
    }
}

impl Drop for TimestampQueries {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe { self.gpu.device.destroy_query_pool(self.pool, None) };
    }
}
