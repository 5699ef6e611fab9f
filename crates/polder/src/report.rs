use polder_mesh::{Chains, Pslg, Triangulation};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A triangulation, and how it came about.
#[derive(Clone, Debug)]
pub struct Output {
    /// The constrained Delaunay triangulation, in canonical order.
    pub triangulation: Triangulation,
    /// How it came about, and what became of the input.
    pub report: Report,
}

/// How a triangulation came about, and what became of the input.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The backend that did the work: `cpu`, `reference` or `vulkan`.
    pub backend: &'static str,
    /// Why this backend.
    pub why: String,
    /// The way taken, in words.
    pub way: &'static str,
    /// Threads of the CPU used.
    pub threads: usize,
    /// The Vulkan device, if one did the work.
    pub device: Option<DeviceReport>,
    /// What became of the points.
    pub points: PointReport,
    /// What became of the constraints.
    pub constraints: ConstraintReport,
    /// Triangles of the result.
    pub triangles: usize,
    /// Seconds from the call to the result.
    pub seconds: f64,
    /// The stages in the order in which they ran.
    pub stages: Vec<StageReport>,
}

/// What became of the points; [`Triangulation::representatives`] says it of each.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PointReport {
    /// Points in the input.
    pub total: usize,
    /// Distinct points: vertices of the triangulation.
    pub vertices: usize,
    /// Points that equal a lower one.
    pub duplicates: usize,
    /// Vertices that are no points of the input: added where constraints cross.
    pub added: usize,
}

/// What became of the constraints; [`Triangulation::chains`] says it of each.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ConstraintReport {
    /// Constraints in the input.
    pub total: usize,
    /// Indices of those whose two ends are equal in value.
    pub zero_length: Vec<u32>,
    /// Indices of those that join the same two vertices as a lower one.
    pub repeated: Vec<u32>,
    /// How many pass through vertices and therefore are chains of several edges.
    pub through_vertices: usize,
    /// Edges of the triangulation that are part of a constraint.
    pub constrained_edges: usize,
}

/// A Vulkan device, and what it was asked to do.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct DeviceReport {
    /// Its name.
    pub name: String,
    /// `discrete`, `integrated`, `virtual`, `cpu` or `other`.
    pub kind: &'static str,
    /// Its driver.
    pub driver: String,
    /// How signs were decided on it.
    pub arithmetic: &'static str,
    /// Seconds that opening it and making its kernels took, if that was part of the call.
    pub opening_seconds: Option<f64>,
    /// Times that the host waited for it, transfers not counted.
    pub host_waits: u32,
    /// Kernels dispatched.
    pub dispatches: u32,
    /// The most bytes of its memory that were held at once through this [`Gpu`](crate::Gpu).
    pub peak_bytes: u64,
    /// Its kernels, if [`Options::timestamps`](crate::Options::timestamps) asked for their times.
    pub kernels: Vec<KernelReport>,
}

/// One kernel of one stage, by timestamps around each dispatch.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct KernelReport {
    /// The stage.
    pub stage: &'static str,
    /// The kernel.
    pub name: &'static str,
    /// Dispatches.
    pub count: u64,
    /// Seconds of all of them.
    pub seconds: f64,
}

/// Where a stage ran.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// On the CPU.
    #[default]
    Cpu,
    /// On the Vulkan device.
    Device,
    /// Between the two: data moved, nothing computed.
    Transfer,
}

/// One stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StageReport {
    /// Its name.
    pub name: &'static str,
    /// Where it ran.
    pub on: Place,
    /// Seconds it took; on a device, by its own clock.
    pub seconds: f64,
    /// What it counted: rounds, flips, missing points, bad cases, debris pixels and so on.
    pub counts: BTreeMap<&'static str, u64>,
}

/// Times the stages of one call.
pub(crate) struct Stopwatch {
    start: Instant,
    last: Instant,
    stages: Vec<StageReport>,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        let now = Instant::now();
        Self { start: now, last: now, stages: Vec::new() }
    }

    /// What follows is timed from here on.
    pub(crate) fn skip(&mut self) {
        self.last = Instant::now();
    }

    /// Ends a stage on the CPU, which began where the one before ended.
    pub(crate) fn stage<const N: usize>(&mut self, name: &'static str, counts: [(&'static str, u64); N]) {
        self.stage_on(Place::Cpu, name, counts);
    }

    /// Ends a stage, which began where the one before ended.
    pub(crate) fn stage_on<const N: usize>(&mut self, on: Place, name: &'static str, counts: [(&'static str, u64); N]) {
        let now = Instant::now();
        let seconds = (now - self.last).as_secs_f64();
        self.last = now;
        self.stages.push(StageReport { name, on, seconds, counts: counts.into() });
    }
}

impl Report {
    /// The stages that ran on the CPU.
    pub fn stages_on_cpu(&self) -> impl Iterator<Item = &StageReport> {
        self.stages.iter().filter(|stage| stage.on == Place::Cpu)
    }

    /// The times so far.
    pub(crate) fn started(watch: Stopwatch) -> Self {
        let seconds = watch.start.elapsed().as_secs_f64();
        Self { seconds, stages: watch.stages, ..Self::default() }
    }

    /// What became of the input, and the times.
    pub(crate) fn of(pslg: &Pslg, triangulation: &Triangulation, watch: Stopwatch) -> Self {
        let duplicates = triangulation.duplicates().count();
        let total = pslg.points().len();
        Self {
            points: PointReport { total, vertices: total - duplicates, duplicates, added: 0 },
            constraints: constraints(triangulation),
            triangles: triangulation.triangles().len(),
            seconds: watch.start.elapsed().as_secs_f64(),
            stages: watch.stages,
            ..Self::default()
        }
    }
}

impl Report {
    /// The report of a triangulation of cut constraints, as one of the input.
    pub(crate) fn of_split(self, input: &Pslg, triangulation: &Triangulation, watch: Stopwatch) -> Self {
        let (total, added) = (input.points().len(), triangulation.added().len());
        let vertices = self.points.vertices;
        Self {
            points: PointReport { total, vertices, duplicates: total + added - vertices, added },
            constraints: constraints(triangulation),
            seconds: watch.start.elapsed().as_secs_f64(),
            stages: [watch.stages, self.stages].concat(),
            ..self
        }
    }
}

fn constraints(triangulation: &Triangulation) -> ConstraintReport {
    let chains = triangulation.chains();
    let mut report = ConstraintReport {
        total: chains.len(),
        through_vertices: chains.iter().filter(|chain| chain.len() > 2).count(),
        constrained_edges: triangulation.edges().filter(|edge| edge.constrained).count(),
        ..ConstraintReport::default()
    };
    report.name_needless(chains);
    report
}

impl ConstraintReport {
    /// Names the constraints that have no length, and those that repeat others: their chains say so.
    ///
    /// Few repeat others, and sorting ten million takes longer than fetching their triangulation does. So a bit for each hash
    /// tells apart those whose hash is met once; the rest alone is sorted.
    pub(crate) fn name_needless(&mut self, chains: &Chains) {
        let all = || (0..chains.len() as u32).into_par_iter();
        let ends = |i: u32| match *chains.get(i as usize) {
            [a, .., b] => Some([a.min(b), a.max(b)]),
            _ => None,
        };
        self.zero_length = all().filter(|&i| ends(i).is_none()).collect();
        let (met, again) = (Hashes::room_for(chains.len()), Hashes::room_for(chains.len()));
        all().filter_map(ends).filter(|&pair| met.add(pair)).for_each(|pair| {
            again.add(pair);
        });
        let mut rest: Vec<([u32; 2], u32)> =
            all().filter_map(|i| ends(i).filter(|&pair| again.has(pair)).map(|pair| (pair, i))).collect();
        rest.par_sort_unstable();
        self.repeated = rest.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1].1).collect();
        self.repeated.sort_unstable();
    }
}

/// A set of hashes of pairs, to which all threads add.
struct Hashes {
    bits: Vec<AtomicU64>,
    shift: u32,
}

impl Hashes {
    /// With eight times as many hashes as there are pairs.
    fn room_for(pairs: usize) -> Self {
        let words = pairs.div_ceil(8).next_power_of_two();
        let bits = (0..words).into_par_iter().map(|_| AtomicU64::new(0)).collect();
        Self { bits, shift: 58 - words.trailing_zeros() }
    }

    fn place(&self, [a, b]: [u32; 2]) -> (&AtomicU64, u64) {
        let hash = (u64::from(a) << 32 | u64::from(b)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> self.shift;
        (&self.bits[(hash >> 6) as usize], 1 << (hash & 63))
    }

    /// Whether it was there before.
    fn add(&self, pair: [u32; 2]) -> bool {
        let (word, bit) = self.place(pair);
        word.fetch_or(bit, Ordering::Relaxed) & bit != 0
    }

    fn has(&self, pair: [u32; 2]) -> bool {
        let (word, bit) = self.place(pair);
        word.load(Ordering::Relaxed) & bit != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needless_constraints_are_named() {
        let mut chains = Chains::default();
        let mut report = ConstraintReport::default();
        report.name_needless(&chains);
        assert_eq!((report.zero_length.len(), report.repeated.len()), (0, 0));
        // Every seventh repeats one before, the other way round or along other vertices; every hundredth has no length.
        let (mut zero_length, mut repeated) = (Vec::new(), Vec::new());
        for i in 0..20_000 {
            match (i % 100, i % 7) {
                (3, _) => {
                    zero_length.push(i);
                    chains.push([i]);
                }
                (_, 5) if i > 100 && (i - 5) % 100 != 3 => {
                    repeated.push(i);
                    chains.push([i - 4, 7, i - 5]);
                }
                _ => chains.push([i, i + 1]),
            }
        }
        report.name_needless(&chains);
        assert_eq!((report.zero_length, report.repeated), (zero_length, repeated));
    }
}
