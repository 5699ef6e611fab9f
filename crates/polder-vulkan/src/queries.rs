//! Timestamps of one submission.

use crate::Error;
use crate::device::DeviceInner;
use crate::error::Called;
use crate::timing::Timings;
use ash::vk;
use std::sync::Arc;

/// Commands that one submission can time.
pub(crate) const ROOM: u32 = 2048;

pub(crate) struct Queries {
    device: Arc<DeviceInner>,
    pool: vk::QueryPool,
    names: Vec<&'static str>,
}

impl Queries {
    pub(crate) fn new(device: &Arc<DeviceInner>) -> Result<Self, Error> {
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2 * ROOM);
        // SAFETY: the device is alive.
        let pool = unsafe { device.raw.create_query_pool(&info, None) }.called("vkCreateQueryPool")?;
        let queries = Queries { device: Arc::clone(device), pool, names: Vec::new() };
        queries.reset(2 * ROOM);
        Ok(queries)
    }

    fn reset(&self, count: u32) {
        // SAFETY: no submission that uses the pool is in flight, and the device resets queries from the host.
        unsafe { self.device.raw.reset_query_pool(self.pool, 0, count) };
    }

    pub(crate) fn is_full(&self) -> bool {
        self.names.len() >= ROOM as usize
    }

    /// Before (`false`) and after (`true`) a command.
    pub(crate) fn stamp(&mut self, commands: vk::CommandBuffer, name: &'static str, after: bool) {
        if !after {
            self.names.push(name);
        }
        let query = 2 * (self.names.len() as u32 - 1) + u32::from(after);
        let stage = vk::PipelineStageFlags2::ALL_COMMANDS;
        // SAFETY: the command buffer is being recorded; the query was reset and is written once.
        unsafe { self.device.raw.cmd_write_timestamp2(commands, stage, self.pool, query) };
    }

    /// Reads what a finished submission wrote.
    pub(crate) fn collect(&mut self, timings: &mut Timings) -> Result<(), Error> {
        if self.names.is_empty() {
            return Ok(());
        }
        let mut ticks = vec![0_u64; 2 * self.names.len()];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the submission that wrote these queries is done.
        let read = unsafe { self.device.raw.get_query_pool_results(self.pool, 0, &mut ticks, flags) };
        self.device.note(read.called("vkGetQueryPoolResults"))?;
        let period = f64::from(self.device.info.timestamp_period);
        for (name, pair) in self.names.iter().zip(ticks.chunks_exact(2)) {
            timings.add(name, (pair[1].saturating_sub(pair[0]) as f64 * period) as u64);
        }
        self.forget();
        Ok(())
    }

    /// Drops what was stamped in a submission that never ran or is done.
    pub(crate) fn forget(&mut self) {
        self.reset(2 * self.names.len() as u32);
        self.names.clear();
    }
}

impl Drop for Queries {
    fn drop(&mut self) {
        // SAFETY: the engine parks queries that may be in flight; these are not.
        unsafe { self.device.raw.destroy_query_pool(self.pool, None) };
    }
}
