//! `cargo xtask bench figures`: how flips grow with the triangles that constraints run through, and how many of them a
//! constraint runs through. \[QCT\] figures 15 and 16, on inputs of our own.
//!
//! Needs no Vulkan device: flips are counted on the references. With `--full` the synthetic inputs have the paper's sizes,
//! else a tenth of them; `--file` adds real ones; `--out` says where the pictures go.

mod draw;
mod measure;

use measure::Sample;
use polder::Pslg;
use polder_io::generate;
use serde::Serialize;
use std::path::Path;

/// The seed of all synthetic inputs.
const SEED: u64 = 1;

#[derive(Debug, Serialize)]
pub(crate) struct Results {
    /// A number of constraints, and more and more points.
    more_points: Series,
    /// A number of points, and more and more constraints.
    more_constraints: Series,
    /// Other inputs.
    others: Vec<Sample>,
    /// How many constraints run through so many triangles.
    distributions: Vec<Distribution>,
}

#[derive(Debug, Serialize)]
struct Series {
    name: String,
    samples: Vec<Sample>,
    fit: Fit,
}

/// The straight line through a series that leaves the least squares: flips = `slope` · intersections + `offset`.
#[derive(Clone, Copy, Debug, Serialize)]
struct Fit {
    slope: f64,
    offset: f64,
    /// The share of the variance that it explains.
    r_squared: f64,
}

#[derive(Debug, Serialize)]
struct Distribution {
    name: String,
    constraints: usize,
    intersections: u64,
    most: u64,
    /// Ranges of intersections, and how many constraints have that many.
    bins: Vec<Bin>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
struct Bin {
    from: u64,
    to: u64,
    constraints: u64,
}

pub(crate) fn run(file: Option<&Path>, full: bool, quick: bool, out: Option<&Path>) -> Result<Results, String> {
    let million = if full {
        1_000_000
    } else if quick {
        2_000
    } else {
        100_000
    };
    let synthetic = |points: usize, constraints: usize| {
        let name = format!("{} points, {} constraints", short(points), short(constraints));
        sample(&name, &generate::segments(points, constraints, SEED))
    };
    let name = format!("{} constraints, {} to {} points", short(million), short(2 * million), short(10 * million));
    let points = [2, 3, 4, 5, 6, 7, 8, 9, 10].map(|n| n * million);
    let more_points = Series::of(name, points.map(|points| synthetic(points, million)))?;
    let name = format!("{} points, {} to {} constraints", short(10 * million), short(million / 10), short(million));
    let constraints = [1, 2, 3, 4, 5, 6, 7, 8, 9].map(|n| n * million / 10);
    let mut samples = constraints.map(|constraints| synthetic(10 * million, constraints)).to_vec();
    samples.extend(more_points.samples.last().cloned().map(Ok));
    let more_constraints = Series::of(name, samples)?;

    let mut others = Vec::new();
    for points in [100, 1000, 10_000].map(|share| 10 * million / share) {
        others.push(sample("synthetic", &generate::segments(points, points / 10, SEED))?);
        others.push(sample("synthetic, every point an end", &generate::segments(points, points / 2, SEED))?);
    }
    for rings in [30, 100, 300] {
        others.push(sample("square rings", &generate::nested_rings(rings, 3))?);
    }
    for constraints in [100, 1000, 10_000] {
        others.push(sample("all from one point", &generate::fan(constraints, SEED))?);
    }
    for name in ["coast", "contours"] {
        let path = Path::new("examples/data").join(name).with_extension("poly");
        others.push(sample(&path.display().to_string(), &crate::gpu::read(&path)?)?);
    }
    let mut distributions: Vec<_> = more_constraints.samples.last().map(Distribution::of).into_iter().collect();
    if let Some(file) = file {
        let real = sample(&crate::gpu::stem(file), &crate::gpu::read(file)?)?;
        distributions.push(Distribution::of(&real));
        others.push(real);
    }
    let results = Results { more_points, more_constraints, others, distributions };
    if let Some(out) = out {
        draw::flips(&results, &out.join("flips.svg"))?;
        draw::intersections(&results, &out.join("intersections.svg"))?;
    }
    Ok(results)
}

fn sample(name: &str, pslg: &Pslg) -> Result<Sample, String> {
    eprintln!("{name}: {} points...", pslg.points().len());
    Sample::of(name, pslg)
}

/// A number as people say it.
fn short(n: usize) -> String {
    match n {
        _ if n >= 1_000_000 && n.is_multiple_of(100_000) => format!("{}M", n as f64 / 1e6),
        _ if n >= 1000 && n.is_multiple_of(100) => format!("{}k", n as f64 / 1e3),
        _ => n.to_string(),
    }
}

impl Series {
    fn of(name: String, samples: impl IntoIterator<Item = Result<Sample, String>>) -> Result<Self, String> {
        let samples = samples.into_iter().collect::<Result<Vec<_>, _>>()?;
        let fit = Fit::of(samples.iter().map(|sample| [sample.intersections as f64, sample.flips() as f64]));
        Ok(Self { name, samples, fit })
    }
}

impl Fit {
    fn of(points: impl Iterator<Item = [f64; 2]> + Clone) -> Self {
        let count = points.clone().count() as f64;
        let mean = [0, 1].map(|k| points.clone().map(|p| p[k]).sum::<f64>() / count);
        let moment = |i: usize, j: usize| points.clone().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
        let slope = moment(0, 1) / moment(0, 0);
        let r_squared = moment(0, 1).powi(2) / (moment(0, 0) * moment(1, 1));
        Self { slope, offset: mean[1] - slope * mean[0], r_squared }
    }

    fn at(&self, x: f64) -> f64 {
        self.slope * x + self.offset
    }
}

impl Distribution {
    /// By powers of two: none, up to 2, up to 4, and so on. One triangle alone is never run through.
    fn of(sample: &Sample) -> Self {
        let most = sample.most();
        let mut bins = vec![Bin { from: 0, to: 0, constraints: 0 }];
        let (mut from, mut to) = (1, 2);
        while from <= most {
            bins.push(Bin { from, to, constraints: 0 });
            (from, to) = (to + 1, 2 * to);
        }
        for bin in &mut bins {
            bin.constraints = sample.distribution.range(bin.from..=bin.to).map(|(_, &constraints)| constraints).sum();
        }
        let (constraints, intersections) = (sample.constraints, sample.intersections);
        Self { name: sample.set.clone(), constraints, intersections, most, bins }
    }
}

impl Results {
    pub(crate) fn print(&self) {
        println!("\nConstraints into Delaunay triangulations; intersections: pairs of a constraint and a triangle");
        println!(
            "{:<34} {:>9} {:>11} {:>13} {:>9} {:>9} {:>8} {:>7} {:>6}",
            "input", "points", "constraints", "intersections", "inserting", "restoring", "flips/i.", "most", "rounds"
        );
        let series = [&self.more_points, &self.more_constraints];
        for sample in series.iter().flat_map(|series| &series.samples).chain(&self.others) {
            println!(
                "{:<34} {:>9} {:>11} {:>13} {:>9} {:>9} {:>8} {:>7} {:>2}+{:>3}",
                sample.set,
                sample.points,
                sample.constraints,
                sample.intersections,
                sample.inserting,
                sample.restoring,
                match sample.intersections {
                    0 => "-".into(),
                    some => format!("{:.3}", sample.flips() as f64 / some as f64),
                },
                sample.most(),
                sample.outer_rounds,
                sample.inner_rounds,
            );
        }
        for Series { name, fit: Fit { slope, offset, r_squared }, .. } in series {
            println!("{name}: flips = {slope:.3} intersections + {offset:.0}, R² = {r_squared:.5}");
        }
        for Distribution { name, constraints, intersections, most, bins } in &self.distributions {
            println!("\n{name}: {intersections} intersections of {constraints} constraints, at most {most} of one");
            for Bin { from, to, constraints } in bins {
                println!(
                    "  {:>13}: {constraints:>9}",
                    if from == to { from.to_string() } else { format!("{from} to {to}") }
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_fitted_to_what_lies_on_it() {
        let fit = Fit::of([1.0, 2.0, 5.0].map(|x| [x, 3.0 * x - 2.0]).into_iter());
        assert!(
            (fit.slope - 3.0).abs() < 1e-12 && (fit.offset + 2.0).abs() < 1e-12 && (fit.r_squared - 1.0).abs() < 1e-12
        );
    }

    #[test]
    fn every_constraint_is_in_one_bin() {
        let sample = Sample::of("few", &generate::segments(2000, 200, 1)).unwrap_or_else(|error| panic!("{error}"));
        let distribution = Distribution::of(&sample);
        assert_eq!(distribution.bins.iter().map(|bin| bin.constraints).sum::<u64>(), 200);
        assert!(distribution.bins.windows(2).all(|pair| pair[0].to + 1 == pair[1].from));
        let counted: u64 = sample.distribution.iter().map(|(&intersections, &count)| intersections * count).sum();
        assert_eq!(counted, sample.intersections);
    }
}
