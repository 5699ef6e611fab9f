//! How long each kernel took, by name.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

/// The dispatches of one kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Timing {
    /// Dispatches.
    pub count: u64,
    /// Nanoseconds of all of them.
    pub total_ns: u64,
    /// Nanoseconds of the longest.
    pub longest_ns: u64,
}

/// Kernels by name, from timestamps around each dispatch, fill and copy. Measuring keeps commands from overlapping, so
/// the sum is a little more than the whole takes without.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Timings {
    by_name: BTreeMap<&'static str, Timing>,
}

impl Timings {
    pub(crate) fn add(&mut self, name: &'static str, ns: u64) {
        let entry = self.by_name.entry(name).or_default();
        entry.count += 1;
        entry.total_ns += ns;
        entry.longest_ns = entry.longest_ns.max(ns);
    }

    /// Adds what another run took.
    pub fn merge(&mut self, other: &Timings) {
        for (name, timing) in &other.by_name {
            let entry = self.by_name.entry(name).or_default();
            entry.count += timing.count;
            entry.total_ns += timing.total_ns;
            entry.longest_ns = entry.longest_ns.max(timing.longest_ns);
        }
    }

    /// By name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, Timing)> + '_ {
        self.by_name.iter().map(|(name, timing)| (*name, *timing))
    }

    /// One kernel.
    pub fn get(&self, name: &str) -> Option<Timing> {
        self.by_name.get(name).copied()
    }

    /// All kernels together.
    pub fn total(&self) -> Duration {
        Duration::from_nanos(self.by_name.values().map(|timing| timing.total_ns).sum())
    }

    /// `{"kernels": [{"name": ..., "count": ..., "total_ns": ..., "longest_ns": ...}, ...], "total_ns": ...}`
    pub fn to_json(&self) -> String {
        let one = |(name, timing): (&str, Timing)| {
            let Timing { count, total_ns, longest_ns } = timing;
            format!(r#"{{"name": "{name}", "count": {count}, "total_ns": {total_ns}, "longest_ns": {longest_ns}}}"#)
        };
        let kernels: Vec<String> = self.iter().map(one).collect();
        format!(r#"{{"kernels": [{}], "total_ns": {}}}"#, kernels.join(", "), self.total().as_nanos())
    }
}

impl fmt::Display for Timings {
    /// A table, the slowest first.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows: Vec<(&str, Timing)> = self.iter().collect();
        rows.sort_by_key(|(name, timing)| (std::cmp::Reverse(timing.total_ns), *name));
        writeln!(f, "{:<28} {:>7} {:>12} {:>12}", "kernel", "count", "total us", "longest us")?;
        for (name, timing) in rows {
            let us = |ns: u64| ns as f64 / 1e3;
            let (total, longest) = (us(timing.total_ns), us(timing.longest_ns));
            writeln!(f, "{name:<28} {:>7} {total:>12.2} {longest:>12.2}", timing.count)?;
        }
        write!(f, "{:<28} {:>7} {:>12.2}", "all", "", self.total().as_nanos() as f64 / 1e3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_and_json() {
        let mut timings = Timings::default();
        timings.add("scan", 1500);
        timings.add("sort", 4000);
        timings.add("scan", 500);
        assert_eq!(
            timings.to_json(),
            r#"{"kernels": [{"name": "scan", "count": 2, "total_ns": 2000, "longest_ns": 1500}, {"name": "sort", "count": 1, "total_ns": 4000, "longest_ns": 4000}], "total_ns": 6000}"#
        );
        let table = timings.to_string();
        assert!(table.find("sort") < table.find("scan"));
    }
}
