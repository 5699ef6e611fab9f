//! The predicates of kernels against polder-predicates, over quadruples that are hard in different ways.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

#[path = "../../crates/polder-predicates/tests/common/mod.rs"]
mod quadruples;
mod vulkan_support;

use glam::DVec2;
use polder_flip::gpu::{Arithmetic, Signs};
use polder_flip::kernels::{MustFlipSigns, MustFlipSignsArgs, Orient2dSigns, Orient2dSignsArgs};
use polder_flip::reference;
use polder_vulkan::{Kernel, groups_for};
use quadruples::{Family, Random, families, ldexp};
use vulkan_support::Gpu;

/// What a word holds that no kernel wrote.
const UNTOUCHED: i32 = 77;
/// What the filter says of what it does not know.
const UNDECIDED: i32 = 2;

/// So many quadruples of each family: `POLDER_TUPLES`, else few enough for a CPU that plays a GPU.
fn cases(seed: u64) -> Vec<Family> {
    let count = std::env::var("POLDER_TUPLES").ok().and_then(|count| count.parse().ok()).unwrap_or(8_000);
    let mut list = families(count, seed);
    let mut random = Random(seed);
    for (name, make) in WIDE {
        let quadruples = (0..count).map(|_| make(&mut random)).collect();
        list.push(Family { name, quadruples, naive_orient2d_fails: true, naive_incircle_fails: true });
    }
    list
}

type Make = fn(&mut Random) -> [DVec2; 4];

/// Numbers of many bits, and determinants that are zero or nearly so.
const WIDE: [(&str, Make); 8] = [
    ("an integer circle of 13 bits", |r| {
        // 8125 is 13 * 5^4, so there are many; these are some.
        let points: [(i64, i64); 8] =
            [(8125, 0), (8120, 285), (8075, 900), (8004, 1397), (7605, 2860), (6851, 4368), (6667, 4644), (6325, 5100)];
        [0; 4].map(|_| {
            let (x, y) = r.pick(&points);
            let (x, y) = if r.below(2) == 0 { (x, y) } else { (y, x) };
            let sign = |r: &mut Random| r.pick(&[-1.0, 1.0]);
            DVec2::new(x as f64 * sign(r), y as f64 * sign(r))
        })
    }),
    ("integers of 30 bits, a triangle of area 1/2", |r| {
        // Neither step changes the area.
        let (mut p, mut q) = (DVec2::X, DVec2::Y);
        while p.max(q).max_element() < 1e8 {
            (p, q) = (q, p + q * r.integer(1, 9) as f64);
        }
        let mut points = [p, q, DVec2::ZERO, p];
        r.shuffle(&mut points[..3]);
        points
    }),
    ("products of two near the smallest double", |r| {
        [0; 4].map(|_| DVec2::new(r.unit() - 0.5, r.unit() - 0.5) * ldexp(1.0, r.integer(-538, -534) as i32))
    }),
    ("rectangles of all exponents", |r| rectangle(r, -1000, 990)),
    ("rectangles of a few exponents", |r| rectangle(r, -9, 60)),
    ("rectangles, a corner one ulp off", |r| {
        let points = rectangle(r, -40, 40);
        off_by_one(r, points)
    }),
    ("rectangles of all exponents, a corner one ulp off", |r| {
        let points = rectangle(r, -1000, 990);
        off_by_one(r, points)
    }),
    ("multiples of a vector, one ulp off", |r| {
        let step = DVec2::new(r.unit() - 0.5, r.unit() - 0.5);
        let mut points = [0; 4].map(|_| step * ldexp(1.0, r.integer(-500, 500) as i32));
        points[r.below(4) as usize] = DVec2::ZERO;
        if r.below(2) == 0 { points } else { off_by_one(r, points) }
    }),
];

/// Cocircular, whatever the four numbers are.
fn rectangle(random: &mut Random, low: i64, high: i64) -> [DVec2; 4] {
    let [x, y, z, w] = [0; 4].map(|_| ldexp(random.unit() - 0.5, random.integer(low, high) as i32));
    let mut corners = [[x, y], [z, y], [x, w], [z, w]].map(DVec2::from);
    random.shuffle(&mut corners);
    corners
}

fn off_by_one(random: &mut Random, mut points: [DVec2; 4]) -> [DVec2; 4] {
    let point = &mut points[random.below(4) as usize];
    let coordinate = if random.below(2) == 0 { &mut point.x } else { &mut point.y };
    *coordinate = if random.below(2) == 0 { coordinate.next_up() } else { coordinate.next_down() };
    points
}

/// The positions of all quadruples, and the numbers of the vertices of the first `N` points of each.
fn tuples<const N: usize>(quadruples: &[[DVec2; 4]]) -> (Vec<DVec2>, Vec<[u32; N]>) {
    let numbers = (0..quadruples.len() as u32).map(|q| std::array::from_fn(|k| 4 * q + k as u32));
    (quadruples.as_flattened().to_vec(), numbers.collect())
}

/// What one kernel writes.
fn orient2d_by(gpu: &mut Gpu, kernel: &Kernel<Orient2dSigns>, quadruples: &[[DVec2; 4]]) -> Vec<i32> {
    let (positions, triples) = tuples::<3>(quadruples);
    let (positions, input) = (gpu.buffer(&positions), gpu.buffer(&triples));
    let signs = gpu.buffer(&vec![UNTOUCHED; triples.len()]);
    let arguments = Orient2dSignsArgs {
        positions: positions.view().cast(),
        triples: input.view().cast(),
        signs: signs.view().cast(),
        count: triples.len() as u32,
    };
    let mut recording = gpu.recording();
    recording.dispatch(kernel, groups_for(triples.len(), kernel.workgroup()[0]), &arguments);
    gpu.run(&recording);
    gpu.fetch(signs.view())
}

fn must_flip_by(gpu: &mut Gpu, kernel: &Kernel<MustFlipSigns>, quadruples: &[[DVec2; 4]]) -> Vec<i32> {
    let (positions, numbers) = tuples::<4>(quadruples);
    let (positions, input) = (gpu.buffer(&positions), gpu.buffer(&numbers));
    let signs = gpu.buffer(&vec![UNTOUCHED; numbers.len()]);
    let arguments = MustFlipSignsArgs {
        positions: positions.view().cast(),
        quadruples: input.view().cast(),
        signs: signs.view().cast(),
        count: numbers.len() as u32,
    };
    let mut recording = gpu.recording();
    recording.dispatch(kernel, groups_for(numbers.len(), kernel.workgroup()[0]), &arguments);
    gpu.run(&recording);
    gpu.fetch(signs.view())
}

type By<S> = fn(&mut Gpu, &Kernel<S>, &[[DVec2; 4]]) -> Vec<i32>;

/// Each of FAST, EXACT and INTEGERS, with and without f64 in the code. Returns by family what FAST leaves.
fn compare<S: polder_vulkan::Shader>(
    gpu: &mut Gpu,
    seed: u64,
    by: By<S>,
    expected: fn(&[[DVec2; 4]]) -> Vec<i32>,
) -> Vec<(&'static str, f64)> {
    let device = &gpu.device;
    let fast = Kernel::<S>::new(device, &[("ARITHMETIC", 0)]).unwrap();
    let whole = [
        ("EXACT", Arithmetic::Filtered.kernel::<S>(device, &[]).unwrap()),
        ("INTEGERS", Arithmetic::Integers.kernel::<S>(device, &[]).unwrap()),
        ("INTEGERS beside f64", Kernel::<S>::new(device, &[("ARITHMETIC", 2)]).unwrap()),
    ];
    let mut fractions = Vec::new();
    for Family { name, quadruples, .. } in cases(seed) {
        let expected = expected(&quadruples);
        for (arithmetic, kernel) in &whole {
            assert_eq!(
                first_wrong(&by(gpu, kernel, &quadruples), &expected, &quadruples),
                None,
                "{arithmetic}: {name}"
            );
        }
        let mut signs = by(gpu, &fast, &quadruples);
        let left = signs.iter().filter(|&&sign| sign == UNDECIDED).count();
        fractions.push((name, left as f64 / signs.len() as f64));
        for (sign, expected) in signs.iter_mut().zip(&expected) {
            *sign = if *sign == UNDECIDED { *expected } else { *sign };
        }
        assert_eq!(first_wrong(&signs, &expected, &quadruples), None, "FAST: {name}");
    }
    fractions
}

/// Number, points, sign and true sign.
fn first_wrong(signs: &[i32], expected: &[i32], points: &[[DVec2; 4]]) -> Option<(usize, [DVec2; 4], i32, i32)> {
    let wrong = (0..expected.len()).find(|&i| signs[i] != expected[i])?;
    Some((wrong, points[wrong], signs[wrong], expected[wrong]))
}

/// FAST must not leave too much of these.
fn check_fractions(fractions: &[(&'static str, f64)], most: &[(&str, f64)]) {
    for (name, fraction) in fractions {
        println!("{fraction:8.4} left: {name}");
    }
    for (name, most) in most {
        let found = fractions.iter().find(|(found, _)| found == name).unwrap().1;
        assert!(found <= *most, "{name}: {found}");
    }
}

#[test]
fn orient2d_signs() {
    let mut gpu = Gpu::open();
    let expected = |quadruples: &[[DVec2; 4]]| {
        let (positions, triples) = tuples::<3>(quadruples);
        reference::orient2d_signs(&positions, &triples).unwrap()
    };
    let fractions = compare::<Orient2dSigns>(&mut gpu, 41, orient2d_by, expected);
    let most = [("random", 0.001), ("lattice", 0.0), ("integer circle", 0.01), ("collinear integers", 0.001)];
    check_fractions(&fractions, &most);
}

#[test]
fn must_flip_signs() {
    let mut gpu = Gpu::open();
    let expected = |quadruples: &[[DVec2; 4]]| {
        let (positions, numbers) = tuples::<4>(quadruples);
        reference::must_flip_signs(&positions, &numbers).unwrap()
    };
    let fractions = compare::<MustFlipSigns>(&mut gpu, 42, must_flip_by, expected);
    check_fractions(&fractions, &[("random", 0.001), ("quantized to 2^-10", 0.001), ("lattice", 0.0)]);
}

#[test]
fn signs_of_many_tuples() {
    let mut gpu = Gpu::open();
    let (positions, quadruples): (Vec<DVec2>, Vec<[u32; 4]>) = {
        let all: Vec<[DVec2; 4]> = families(300, 43).into_iter().flat_map(|family| family.quadruples).collect();
        tuples(&all)
    };
    let triples: Vec<[u32; 3]> = quadruples.iter().map(|&[a, _, c, d]| [d, a, c]).collect();
    let expected = (
        reference::orient2d_signs(&positions, &triples).unwrap(),
        reference::must_flip_signs(&positions, &quadruples).unwrap(),
    );
    let input = (gpu.buffer(&positions), gpu.buffer(&triples), gpu.buffer(&quadruples));
    for arithmetic in [Arithmetic::Filtered, Arithmetic::Integers] {
        let signs = Signs::new(&gpu.device, arithmetic).unwrap();
        for count in [0, 1, 255, 256, 257, triples.len()] {
            let output = (gpu.buffer(&vec![UNTOUCHED; count + 1]), gpu.buffer(&vec![UNTOUCHED; count + 1]));
            let (first, second) = (input.1.slice(0..count).unwrap(), input.2.slice(0..count).unwrap());
            let mut recording = gpu.recording();
            let (left, right) = (output.0.view().cast(), output.1.view().cast());
            signs.record_orient2d(&mut recording, input.0.view(), first, left).unwrap();
            signs.record_must_flip(&mut recording, input.0.view(), second, right).unwrap();
            gpu.run(&recording);
            let found = (gpu.fetch(output.0.view()), gpu.fetch(output.1.view()));
            assert_eq!((&found.0[..count], &found.1[..count]), (&expected.0[..count], &expected.1[..count]));
            assert_eq!((found.0[count], found.1[count]), (UNTOUCHED, UNTOUCHED));
        }
        let mut recording = gpu.recording();
        let few = gpu.buffer(&vec![UNTOUCHED; triples.len() - 1]);
        let refused = signs.record_orient2d(&mut recording, input.0.view(), input.1.view(), few.view().cast());
        assert!(refused.is_err() && recording.is_empty());
    }
}
