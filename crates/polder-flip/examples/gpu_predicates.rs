//! What a sign costs on a device, by kind of points and by arithmetic: nanoseconds a test, medians of fifteen by timestamps,
//! after the signs were held against the reference. `gpu_predicates [tests]`; `POLDER_DEVICE` names the device.

use glam::DVec2;
use polder_flip::gpu::{Arithmetic, Signs};
use polder_flip::kernels::{MustFlipSigns, MustFlipSignsArgs, Orient2dSigns, Orient2dSignsArgs};
use polder_flip::reference;
use polder_vulkan::{Buffer, CacheFolder, Device, DeviceOptions, Engine, Kernel, Recording, RunOptions, groups_for};
use std::time::{Duration, Instant};

const RUNS: usize = 15;
const WARM_UP: Duration = Duration::from_millis(700);
/// What the filter says of what it does not know.
const UNDECIDED: u32 = 2;
/// Tests whose signs are compared with the reference.
const COMPARED: usize = 20_000;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let device = Device::open(&DeviceOptions { cache: CacheFolder::Off, ..DeviceOptions::default() })?;
    println!("{}", device.info());
    println!("{}", device.self_test()?);
    for (name, arithmetic) in [("filter", 0), ("filter, then integers", 1), ("integers", 2)] {
        let constants = [("ARITHMETIC", arithmetic), ("WORKGROUP", 256)];
        let start = Instant::now();
        Kernel::<Orient2dSigns>::new(&device, &constants)?;
        let first = start.elapsed();
        Kernel::<MustFlipSigns>::new(&device, &constants)?;
        println!("to compile {name}: orient2d {first:?}, must_flip {:?}", start.elapsed() - first);
    }
    let count: usize = std::env::args().nth(1).map_or(Ok(1 << 16), |count| count.parse())?;
    println!("{count} tests each; ns a test: filter alone (what it leaves), with integers behind it, integers");
    for (name, make) in SETS {
        let mut random = Random(1);
        let points: Vec<[DVec2; 4]> = (0..count).map(|i| make(&mut random, i)).collect();
        measure(&device, name, &points)?;
    }
    Ok(())
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    fn point(&mut self) -> DVec2 {
        DVec2::new(self.unit(), self.unit())
    }
}

type Make = fn(&mut Random, usize) -> [DVec2; 4];

const SETS: [(&str, Make); 8] = [
    ("random", random),
    ("lattice", |_, i| square(i)),
    ("lattice of 0.1", |_, i| square(i).map(|p| p * 0.1)),
    ("1 in 1000 of a lattice of 0.1", |r, i| rarely(1000, r, i)),
    ("1 in 10 of a lattice of 0.1", |r, i| rarely(10, r, i)),
    ("circle", |_, i| [0, 1, 3, 2].map(|k| DVec2::from_angle((i + k) as f64 * 6.28e-6))),
    ("lattice of 0.1 with a stray 1e-20", |_, i| {
        let mut square = square(i).map(|p| p * 0.1);
        square[i % 4].x += if square[i % 4].x == 0.0 { 1e-20 } else { 0.0 };
        square[(i + 1) % 4].y *= 1e-20;
        square
    }),
    ("random times 1e-300", |r, i| random(r, i).map(|p| p * 1e-300)),
];

/// Close together: a triangle and a point on the other side of an edge.
fn random(random: &mut Random, _: usize) -> [DVec2; 4] {
    let center = random.point();
    [0; 4].map(|_| center + 1e-3 * random.point())
}

/// Cocircular: a cell of a lattice of 1000 columns.
fn square(i: usize) -> [DVec2; 4] {
    let (x, y) = ((i % 1000) as f64, (i / 1000 % 1000) as f64);
    [[x, y], [x + 1.0, y], [x, y + 1.0], [x + 1.0, y + 1.0]].map(DVec2::from)
}

fn rarely(rate: u64, r: &mut Random, i: usize) -> [DVec2; 4] {
    if r.next().is_multiple_of(rate) { square(i).map(|p| p * 0.1) } else { random(r, i) }
}

fn measure(device: &Device, name: &str, points: &[[DVec2; 4]]) -> Result<(), Failure> {
    let count = points.len();
    let mut engine = Engine::new(device)?;
    let numbers: Vec<[u32; 4]> = (0..count as u32).map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]).collect();
    let triples: Vec<[u32; 3]> = numbers.iter().map(|&[a, b, _, d]| [a, b, d]).collect();
    let positions = Buffer::<DVec2>::new(device, "positions", 4 * count)?;
    let (quadruple_buffer, triple_buffer) =
        (Buffer::<[u32; 4]>::new(device, "quadruples", count)?, Buffer::<[u32; 3]>::new(device, "triples", count)?);
    let output = Buffer::<u32>::new(device, "signs", count)?;
    engine.upload(positions.view(), points.as_flattened())?;
    engine.upload(quadruple_buffer.view(), &numbers)?;
    engine.upload(triple_buffer.view(), &triples)?;
    let filtered = Signs::new(device, Arithmetic::Filtered)?;
    let integers = Signs::new(device, Arithmetic::Integers)?;
    let compared = count.min(COMPARED);
    let expected = [
        reference::orient2d_signs(points.as_flattened(), &triples[..compared]).ok_or("no position")?,
        reference::must_flip_signs(points.as_flattened(), &numbers[..compared]).ok_or("no position")?,
    ];
    for (predicate, expected) in ["orient2d", "must_flip"].into_iter().zip(&expected) {
        let is_orient2d = predicate == "orient2d";
        let whole = |signs: &Signs| -> Result<Recording, Failure> {
            let mut recording = Recording::new(device);
            if is_orient2d {
                signs.record_orient2d(&mut recording, positions.view(), triple_buffer.view(), output.view())?;
            } else {
                signs.record_must_flip(&mut recording, positions.view(), quadruple_buffer.view(), output.view())?;
            }
            Ok(recording)
        };
        let mut filter = Recording::new(device);
        let (groups, constants) = (groups_for(count, 256), [("ARITHMETIC", 0), ("WORKGROUP", 256)]);
        let (positions, signs, limit) = (positions.view().cast(), output.view(), count as u32);
        if is_orient2d {
            let kernel = Kernel::<Orient2dSigns>::new(device, &constants)?;
            let triples = triple_buffer.view().cast();
            filter.dispatch(&kernel, groups, &Orient2dSignsArgs { positions, triples, signs, count: limit });
        } else {
            let kernel = Kernel::<MustFlipSigns>::new(device, &constants)?;
            let quadruples = quadruple_buffer.view().cast();
            filter.dispatch(&kernel, groups, &MustFlipSignsArgs { positions, quadruples, signs, count: limit });
        }
        let mut left = 0;
        let ways = [filter, whole(&filtered)?, whole(&integers)?];
        for (way, recording) in ways.iter().enumerate() {
            engine.upload(output.view(), &vec![7; count])?;
            engine.run(recording, &RunOptions::default())?;
            let signs = engine.download_vec(output.view())?;
            if way == 0 {
                left = signs.iter().filter(|&&sign| sign == UNDECIDED).count();
            } else if signs.iter().zip(expected).any(|(&found, &expected)| found as i32 != expected) {
                return Err(format!("{name}: {predicate} gives another result").into());
            }
        }
        // Clocks rise with work, so all take turns, and the first turns do not count.
        let mut runs = [const { Vec::new() }; 3];
        let start = Instant::now();
        while runs[0].len() < RUNS {
            let warm = start.elapsed() > WARM_UP;
            for (recording, runs) in ways.iter().zip(&mut runs) {
                let options = RunOptions { timestamps: true, ..RunOptions::default() };
                let time = engine.run(recording, &options)?.timings.total();
                if warm {
                    runs.push(time);
                }
            }
        }
        let times = runs.map(|mut runs| {
            runs.sort();
            runs[RUNS / 2].as_secs_f64() * 1e9 / count as f64
        });
        let rate = 100.0 * left as f64 / count as f64;
        let [filter, exact, integers] = times;
        println!("{predicate:<9} {filter:8.4} ({rate:7.3} %) {exact:8.4} {integers:8.4}  {name}");
    }
    Ok(())
}
