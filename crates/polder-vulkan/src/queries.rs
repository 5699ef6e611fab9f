//! Timestamps of one submission.

use crate::Error;
use crate::device::DeviceInner;
use crate::engine::RunReport;
use crate::error::Called;
use ash::vk;
use std::sync::Arc;

/// Commands that one submission can time.
pub(crate) const ROOM: u32 = 2048;

pub(crate) struct Queries {
    device: Arc<DeviceInner>,
    pool: vk::QueryPool,
    entries: Vec<Entry>,
    used: u32,
}

/// What was stamped, in order.
enum Entry {
    /// Before and after a command: two queries.
    Command(&'static str),
    /// Where a section begins, or none: one query.
    Section(Option<&'static str>),
}

impl Queries {
    pub(crate) fn new(device: &Arc<DeviceInner>) -> Result<Self, Error> {
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2 * ROOM);
        // SAFETY: the device is alive.
        let pool = unsafe { device.raw.create_query_pool(&info, None) }.called("vkCreateQueryPool")?;
        let queries = Queries { device: Arc::clone(device), pool, entries: Vec::new(), used: 0 };
        queries.reset(2 * ROOM);
        Ok(queries)
    }

    fn reset(&self, count: u32) {
        if count == 0 {
            return;
        }
        // SAFETY: no submission that uses the pool is in flight, and the device resets queries from the host.
        unsafe { self.device.raw.reset_query_pool(self.pool, 0, count) };
    }

    pub(crate) fn is_full(&self) -> bool {
        // Room for a command, and for the end of a section.
        self.used > 2 * ROOM - 3
    }

    /// Before (`false`) and after (`true`) a command.
    pub(crate) fn stamp(&mut self, commands: vk::CommandBuffer, name: &'static str, after: bool) {
        if !after {
            self.entries.push(Entry::Command(name));
        }
        self.write(commands);
    }

    /// Where a section begins, or all end.
    pub(crate) fn section(&mut self, commands: vk::CommandBuffer, name: Option<&'static str>) {
        if self.used < 2 * ROOM {
            self.entries.push(Entry::Section(name));
            self.write(commands);
        }
    }

    fn write(&mut self, commands: vk::CommandBuffer) {
        let query = self.used;
        self.used += 1;
        let stage = vk::PipelineStageFlags2::ALL_COMMANDS;
        // SAFETY: the command buffer is being recorded; the query was reset and is written once.
        unsafe { self.device.raw.cmd_write_timestamp2(commands, stage, self.pool, query) };
    }

    /// Reads what a finished submission wrote.
    pub(crate) fn collect(&mut self, report: &mut RunReport) -> Result<(), Error> {
        if self.used == 0 {
            return Ok(());
        }
        let mut ticks = vec![0_u64; self.used as usize];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the submission that wrote these queries is done.
        let read = unsafe { self.device.raw.get_query_pool_results(self.pool, 0, &mut ticks, flags) };
        self.device.note(read.called("vkGetQueryPoolResults"))?;
        let period = f64::from(self.device.info.timestamp_period);
        let ns = |from: u64, to: u64| (to.saturating_sub(from) as f64 * period) as u64;
        let mut ticks = ticks.into_iter();
        let mut open: Option<(&'static str, u64)> = None;
        for entry in &self.entries {
            let Some(tick) = ticks.next() else { break };
            match *entry {
                Entry::Command(name) => {
                    let ns = ns(tick, ticks.next().unwrap_or(tick));
                    report.timings.add(name, ns);
                    if let Some((section, _)) = open {
                        report.by_section.entry(section).or_default().add(name, ns);
                    }
                }
                Entry::Section(name) => {
                    if let Some((before, from)) = open.take() {
                        report.sections.add(before, ns(from, tick));
                    }
                    open = name.map(|name| (name, tick));
                }
            }
        }
        self.forget();
        Ok(())
    }

    /// Drops what was stamped in a submission that never ran or is done.
    pub(crate) fn forget(&mut self) {
        self.reset(self.used);
        self.entries.clear();
        self.used = 0;
    }
}

impl Drop for Queries {
    fn drop(&mut self) {
        // SAFETY: the engine parks queries that may be in flight; these are not.
        unsafe { self.device.raw.destroy_query_pool(self.pool, None) };
    }
}
