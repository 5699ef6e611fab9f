use glam::DVec2;
use polder_io::generate as make;
use polder_mesh::Pslg;

/// Every family of inputs, each of about `n` points: without constraints, and with constraints that do not cross.
pub fn families(n: usize, seed: u64) -> Vec<(&'static str, Pslg)> {
    [point_families(n, seed), constrained_families(n, seed)].concat()
}

/// The families without constraints.
pub fn point_families(n: usize, seed: u64) -> Vec<(&'static str, Pslg)> {
    let side = n.isqrt().max(1);
    vec![
        ("uniform", make::uniform(n, seed)),
        ("gaussian", make::gaussian(n, seed)),
        ("clusters", make::clusters(n, 10, 1e-4, seed)),
        ("tight clusters", make::clusters(n, 3, 1e-12, seed)),
        ("exponential", make::exponential(n, seed)),
        ("lattice", make::lattice(side, side)),
        ("strip", make::lattice(n / 2, 2)),
        ("crowd", make::crowd(n, seed)),
        ("circle", make::circle(n, seed)),
        ("cocircular", make::cocircular(n, seed)),
        ("concentric circles", make::concentric(n, 4, seed)),
        ("thin ring", make::thin_ring(n, 1e-9, seed)),
        ("collinear", make::collinear(n, seed)),
        ("collinear, one off", one_off(n, seed)),
        ("one-ulp collinear", make::near_collinear(n, 1, seed)),
        ("noisy line", make::noisy_line(n, 1e-6, seed)),
        ("all equal", equal(n)),
        ("spiral", points_of(make::spiral(n))),
        ("comb", points_of(make::comb(n))),
        ("huge", make::huge(n, seed)),
        ("tiny", make::tiny(n, seed)),
        ("subnormal", make::subnormal(n, seed)),
        ("mixed magnitudes", make::mixed_magnitudes(n, seed)),
    ]
}

/// The families with constraints; none crosses another, though they may touch, overlap or repeat.
pub fn constrained_families(n: usize, seed: u64) -> Vec<(&'static str, Pslg)> {
    vec![
        ("segments", make::segments(n, n / 10, seed)),
        ("many segments", make::segments(n, n / 2, seed)),
        ("spiral with constraints", make::spiral(n)),
        ("comb with constraints", make::comb(n)),
        ("fan", make::fan(n / 2, seed)),
        ("hub", hub(n, n / 10, seed)),
        ("rows", rows(n, n / 10, seed)),
        ("through vertices", make::through_vertices(n / 2, seed)),
        ("nested rings", make::nested_rings((n / 4).isqrt(), 1)),
        ("sparse nested rings", make::nested_rings((n / 4).isqrt(), 3)),
        ("lattice with overlapping constraints", overlapping(n)),
        ("collinear with constraints", along_a_line(n, seed)),
        ("huge segments", scaled(make::segments(n, n / 5, seed), f64::from_bits(2023 << 52))),
        ("tiny segments", scaled(make::segments(n, n / 5, seed), f64::from_bits(23 << 52))),
        ("shifted segments", shifted(make::segments(n, n / 5, seed))),
    ]
}

/// Constraints from one point among uniform ones to others.
fn hub(n: usize, constraints: usize, seed: u64) -> Pslg {
    let mut points = make::uniform(n, seed).into_parts().0;
    points.push(DVec2::new(0.5, 0.5));
    build(points, (0..constraints as u32).map(|i| [i, n as u32]).collect())
}

/// Parallel constraints over dense points, all of them through the whole square.
fn rows(n: usize, constraints: usize, seed: u64) -> Pslg {
    let mut points = make::uniform(n, seed).into_parts().0;
    for row in 0..constraints {
        let y = (row as f64 + 0.5) / constraints as f64;
        points.extend([DVec2::new(-0.1, y), DVec2::new(1.1, y)]);
    }
    build(points, (0..constraints as u32).map(|row| [n as u32 + 2 * row, n as u32 + 2 * row + 1]).collect())
}

fn points_of(pslg: Pslg) -> Pslg {
    build(pslg.into_parts().0, Vec::new())
}

fn build(points: Vec<DVec2>, constraints: Vec<[u32; 2]>) -> Pslg {
    Pslg::new(points, constraints).expect("families are made of finite points and indices in range")
}

fn equal(n: usize) -> Pslg {
    build(vec![DVec2::new(0.1, -7.5); n], Vec::new())
}

fn one_off(n: usize, seed: u64) -> Pslg {
    let mut points = make::collinear(n, seed).into_parts().0;
    if let Some(p) = points.get_mut(n / 2) {
        *p = DVec2::new(-1.0, 4.0);
    }
    build(points, Vec::new())
}

/// The rows and columns of a lattice as constraints, whole, in halves and repeated, with some of zero length; columns
/// run from row to row.
fn overlapping(n: usize) -> Pslg {
    let side = n.isqrt().max(2) as u32;
    let points = make::lattice(side as usize, side as usize).into_parts().0;
    let id = |x: u32, y: u32| y * side + x;
    let (last, middle) = (side - 1, side / 2);
    let mut constraints = Vec::new();
    for y in (0..side).step_by(3) {
        constraints.extend([[id(0, y), id(last, y)], [id(middle, y), id(0, y)], [id(0, y), id(last, y)]]);
        constraints.push([id(y, y), id(y, y)]);
    }
    for x in (0..side).step_by(2) {
        constraints.extend((0..last / 3).map(|k| [id(x, 3 * k + 3), id(x, 3 * k)]));
    }
    build(points, constraints)
}

fn along_a_line(n: usize, seed: u64) -> Pslg {
    let points = make::collinear(n, seed).into_parts().0;
    // Chains are written out in full, so that every such constraint takes the room of all its vertices.
    let ends = (0..(n as u32 / 4).min(500)).map(|i| [i, n as u32 - 1 - 2 * i]).collect();
    build(points, ends)
}

/// Scaled by a power of two: exactly, so that nothing comes to cross.
fn scaled(pslg: Pslg, scale: f64) -> Pslg {
    mapped(pslg, |p| scale * p)
}

/// Far from the origin: still exactly, since coordinates are multiples of 2⁻³⁰.
fn shifted(pslg: Pslg) -> Pslg {
    mapped(pslg, |p| p + DVec2::new(4_194_303.0, -4_194_304.0))
}

fn mapped(pslg: Pslg, map: impl Fn(DVec2) -> DVec2) -> Pslg {
    let (points, constraints) = pslg.into_parts();
    build(points.into_iter().map(map).collect(), constraints)
}
