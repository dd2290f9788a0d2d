//! Fragment counts of the parts of the frame's pass (pipeline statistics queries), where requested.

use std::sync::Arc;

use ash::vk;

use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};

/// Fragment shader invocations of a frame's pass, summed over views; zero without counting.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct FragmentCounts {
    /// For tools and hands.
    pub handheld: u64,
    /// For the sculpture.
    pub sculpture: u64,
    /// For stool, bench and room.
    pub surroundings: u64,
}

/// Parts of the frame's pass that are counted separately.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PassPart {
    Handheld = 0,
    Sculpture = 1,
    Surroundings = 2,
}

const PART_COUNT: u32 = 3;

/// The query pool of one frame of the ring, one query for each part and view; null without counting.
pub(crate) struct FragmentQueries {
    gpu: Arc<Gpu>,
    pool: vk::QueryPool,
    views: u32,
}

impl FragmentQueries {
    pub(crate) fn new(gpu: &Arc<Gpu>, views: u32) -> Result<Self, Error> {
        let mut counters = FragmentQueries { gpu: gpu.clone(), pool: vk::QueryPool::null(), views };
        if gpu.features.fragment_counts {
            let info = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::PIPELINE_STATISTICS)
                .pipeline_statistics(vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS)
                .query_count(PART_COUNT * views);
            // SAFETY: the device is alive, and counts.
            counters.pool = unsafe { gpu.device.create_query_pool(&info, None) }
                .could_not("make a query pool")?;
        }
        Ok(counters)
    }

    fn is_enabled(&self) -> bool {
        self.pool != vk::QueryPool::null()
    }

    /// Records the reset of all queries, outside of a render pass.
    pub(crate) fn reset(&self, commands: vk::CommandBuffer) {
        if self.is_enabled() {
            let (device, all) = (&self.gpu.device, PART_COUNT * self.views);
            // SAFETY: the frame's fence has passed, so no work writes these queries.
            unsafe { device.cmd_reset_query_pool(commands, self.pool, 0, all) };
        }
    }

    /// Records a part of the frame's pass between the begin and end of its query.
    pub(crate) fn count_during(
        &self,
        commands: vk::CommandBuffer,
        part: PassPart,
        record: impl FnOnce(),
    ) {
        let (device, query) = (&self.gpu.device, part as u32 * self.views);
        if self.is_enabled() {
            let exact = vk::QueryControlFlags::empty();
            // SAFETY: the queries were reset in this buffer, and each part is recorded once.
            unsafe { device.cmd_begin_query(commands, self.pool, query, exact) };
        }
        record();
        if self.is_enabled() {
            // SAFETY: it was begun above, in the same subpass.
            unsafe { device.cmd_end_query(commands, self.pool, query) };
        }
    }

    /// Reads the counts of a frame whose fence is signaled.
    pub(crate) fn read(&self) -> FragmentCounts {
        if !self.is_enabled() {
            return FragmentCounts::default();
        }
        let of = |part: PassPart| -> u64 {
            let mut counts = [0u64; 2];
            let (device, first) = (&self.gpu.device, part as u32 * self.views);
            let counts = &mut counts[..self.views as usize];
            let kind = vk::QueryResultFlags::TYPE_64;
            // SAFETY: the pool has these queries, which the frame wrote; no wait is asked for.
            let read = unsafe { device.get_query_pool_results(self.pool, first, counts, kind) };
            read.map_or(0, |()| counts.iter().sum())
        };
        FragmentCounts {
            handheld: of(PassPart::Handheld),
            sculpture: of(PassPart::Sculpture),
            surroundings: of(PassPart::Surroundings),
        }
    }
}

impl Drop for FragmentQueries {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe { self.gpu.device.destroy_query_pool(self.pool, None) };
    }
}
