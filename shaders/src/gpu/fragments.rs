//! How many fragments were shaded for the parts of a frame's pass, where that was asked for.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};

/// Fragments shaded in a frame's pass, of all views, as the device counts them; zero where it does
/// not.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Fragments {
    /// For tools and hands.
    pub handled: u64,
    /// For the sculpture.
    pub sculpture: u64,
    /// For stool, bench and room.
    pub standing: u64,
}

/// What is counted by itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Part {
    Handled = 0,
    Sculpture = 1,
    Standing = 2,
}

const PARTS: u32 = 3;

/// The queries of one frame of the ring, for each part as many as there are views; none where
/// nothing is counted.
pub(super) struct Counters {
    gpu: Arc<Gpu>,
    pool: vk::QueryPool,
    views: u32,
}

impl Counters {
    pub(super) fn new(gpu: &Arc<Gpu>, views: u32) -> Result<Self, Error> {
        let mut counters = Counters { gpu: gpu.clone(), pool: vk::QueryPool::null(), views };
        if gpu.needs.fragment_counts {
            let info = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::PIPELINE_STATISTICS)
                .pipeline_statistics(vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS)
                .query_count(PARTS * views);
            // SAFETY: the device is alive, and counts.
            counters.pool =
                unsafe { gpu.device.create_query_pool(&info, None) }.doing("make a query pool")?;
        }
        Ok(counters)
    }

    fn count(&self) -> bool {
        self.pool != vk::QueryPool::null()
    }

    /// Outside of a pass, before anything is counted.
    pub(super) fn reset(&self, commands: vk::CommandBuffer) {
        if self.count() {
            let (device, all) = (&self.gpu.device, PARTS * self.views);
            // SAFETY: the frame's fence has passed, so no work writes these queries.
            unsafe { device.cmd_reset_query_pool(commands, self.pool, 0, all) };
        }
    }

    /// Records a part of the frame's pass, which counts.
    pub(super) fn around(&self, commands: vk::CommandBuffer, part: Part, record: impl FnOnce()) {
        let (device, query) = (&self.gpu.device, part as u32 * self.views);
        if self.count() {
            let exact = vk::QueryControlFlags::empty();
            // SAFETY: the queries were reset in this buffer, and each part is recorded once.
            unsafe { device.cmd_begin_query(commands, self.pool, query, exact) };
        }
        record();
        if self.count() {
            // SAFETY: it was begun above, in the same subpass.
            unsafe { device.cmd_end_query(commands, self.pool, query) };
        }
    }

    /// The counts of the frame whose fence has passed.
    pub(super) fn read(&self) -> Fragments {
        if !self.count() {
            return Fragments::default();
        }
        let of = |part: Part| -> u64 {
            let mut counts = [0u64; 2];
            let (device, first) = (&self.gpu.device, part as u32 * self.views);
            let counts = &mut counts[..self.views as usize];
            let kind = vk::QueryResultFlags::TYPE_64;
            // SAFETY: the pool has these queries, which the frame wrote; no wait is asked for.
            let read = unsafe { device.get_query_pool_results(self.pool, first, counts, kind) };
            read.map_or(0, |()| counts.iter().sum())
        };
        Fragments {
            handled: of(Part::Handled),
            sculpture: of(Part::Sculpture),
            standing: of(Part::Standing),
        }
    }
}

impl Drop for Counters {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe { self.gpu.device.destroy_query_pool(self.pool, None) };
    }
}
