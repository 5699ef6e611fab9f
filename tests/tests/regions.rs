//! Regions, domains and places against slower ways to the same, in integers.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder::regions::{Place, Regions, domain, locate, regions_at, seed_of_regions};
use polder::{DVec2, EdgeId, Error, Options, Pslg, TriangleId, Triangulation, triangulate};
use polder_tests::families;
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;

const NONE: u32 = u32::MAX;

struct Random(Pcg64Mcg);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn below(&mut self, n: i64) -> i64 {
        i64::from(self.0.next_u32()) % n
    }
}

type At = [i64; 2];

fn point(p: At) -> DVec2 {
    DVec2::new(p[0] as f64, p[1] as f64)
}

fn whole(points: &[At], constraints: &[[u32; 2]]) -> (Vec<DVec2>, Triangulation) {
    let points: Vec<DVec2> = points.iter().copied().map(point).collect();
    let pslg = Pslg::new(points.clone(), constraints.to_vec()).unwrap();
    (points, triangulate(&pslg, &Options::default()).unwrap().triangulation)
}

fn side(a: At, b: At, p: At) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// By all triangles: the lowest that holds the point, its border included.
fn searched(points: &[At], mesh: &Triangulation, p: At) -> Option<(u32, [i64; 3])> {
    (0..mesh.triangles().len() as u32).find_map(|t| {
        let [a, b, c] = mesh.triangles()[t as usize].map(|v| points[v as usize]);
        let signs = [side(b, c, p), side(c, a, p), side(a, b, p)].map(i64::signum);
        (!signs.contains(&-1)).then_some((t, signs))
    })
}

#[test]
fn points_are_found_where_they_are() {
    let mut random = Random::new(1);
    let mut found = [0; 4];
    for round in 0..150 {
        let side = 2 + random.below(9);
        let points: Vec<At> =
            (0..1 + random.below(40)).map(|_| [2 * random.below(side), 2 * random.below(side)]).collect();
        let (at, mut mesh) = whole(&points, &[]);
        if round % 3 == 0 {
            // With holes in it, and with borders that are not convex.
            mesh = mesh.filter(|t| t.0 % 4 != 1).0;
        }
        let seeds: Vec<At> =
            (0..60).map(|_| [random.below(2 * side + 2) - 2, random.below(2 * side + 2) - 2]).collect();
        let places = locate(&at, &mesh, &seeds.iter().copied().map(point).collect::<Vec<_>>()).unwrap();
        for (&seed, place) in seeds.iter().zip(places) {
            let expected = searched(&points, &mesh, seed);
            let kind = match (place, expected) {
                (Place::Outside, None) => 0,
                (Place::Inside(t), Some((lowest, [1, 1, 1]))) if t.0 == lowest => 1,
                (Place::OnEdge(edge), Some((lowest, signs))) if signs.iter().sum::<i64>() == 2 => {
                    let k = signs.iter().position(|&sign| sign == 0).unwrap();
                    assert_eq!(edge, EdgeId::of(TriangleId(lowest), k));
                    2
                }
                (Place::OnVertex(v), Some(_)) if points[v.index()] == seed => {
                    assert_eq!(mesh.representatives()[v.index()], v.0);
                    3
                }
                other => panic!("{seed:?} {other:?}"),
            };
            found[kind] += 1;
        }
    }
    assert!(found.iter().all(|&count| count > 300), "{found:?}");
}

/// Depths by going over all triangles until nothing changes.
fn relaxed(mesh: &Triangulation) -> Vec<u32> {
    let mut depths = vec![NONE; mesh.triangles().len()];
    loop {
        let mut changed = false;
        for t in 0..depths.len() {
            for k in 0..3 {
                let wall = u32::from(mesh.constrained_bits()[t] >> k & 1);
                let beyond = match mesh.neighbors()[t][k] {
                    NONE => 0,
                    n => depths[n as usize],
                };
                let offer = beyond.saturating_add(wall);
                if offer < depths[t] {
                    (depths[t], changed) = (offer, true);
                }
            }
        }
        if !changed {
            return depths;
        }
    }
}

fn assert_regions(name: &str, mesh: &Triangulation) -> Regions {
    let regions = Regions::of(mesh);
    assert_eq!(regions.labels(|r| regions.depth(r)), relaxed(mesh), "{name}: depths");
    let mut firsts = vec![NONE; regions.count()];
    for (t, &region) in regions.regions().iter().enumerate() {
        firsts[region as usize] = firsts[region as usize].min(t as u32);
        for k in (0..3).filter(|&k| mesh.constrained_bits()[t] >> k & 1 == 0) {
            let n = mesh.neighbors()[t][k];
            assert!(n == NONE || regions.regions()[n as usize] == region, "{name}: an open edge between regions");
        }
    }
    assert!(firsts.is_sorted(), "{name}: regions out of order");
    // What is one region hangs together: so many trees of open edges as there are regions.
    let mut parents: Vec<usize> = (0..mesh.triangles().len()).collect();
    fn root(parents: &mut [usize], mut t: usize) -> usize {
        while parents[t] != t {
            parents[t] = parents[parents[t]];
            t = parents[t];
        }
        t
    }
    for t in 0..mesh.triangles().len() {
        for k in (0..3).filter(|&k| mesh.constrained_bits()[t] >> k & 1 == 0 && mesh.neighbors()[t][k] != NONE) {
            let (a, b) = (root(&mut parents, t), root(&mut parents, mesh.neighbors()[t][k] as usize));
            parents[a] = b;
        }
    }
    let trees = (0..parents.len()).filter(|&t| parents[t] == t).count();
    assert_eq!(regions.count(), trees, "{name}");
    regions
}

/// Triangle's way: what is infected infects what no segment protects.
fn eaten(points: &[DVec2], mesh: &Triangulation, holes: &[DVec2]) -> Vec<TriangleId> {
    let spreads = |t: usize, k: usize| mesh.constrained_bits()[t] >> k & 1 == 0;
    let count = mesh.triangles().len();
    let open = |t: usize| (0..3).any(|k| mesh.neighbors()[t][k] == NONE && spreads(t, k));
    let mut infected: Vec<bool> = (0..count).map(open).collect();
    for place in locate(points, mesh, holes).unwrap() {
        match place {
            Place::Outside => {}
            Place::Inside(t) => infected[t.index()] = true,
            Place::OnEdge(edge) => infected[edge.triangle().index()] = true,
            Place::OnVertex(v) => infected[mesh.star(v)[0].index()] = true,
        }
    }
    loop {
        let next: Vec<bool> = (0..count)
            .map(|t| {
                let reached = |k: usize| {
                    let n = mesh.neighbors()[t][k];
                    n != NONE && spreads(t, k) && infected[n as usize]
                };
                infected[t] || (0..3).any(reached)
            })
            .collect();
        if next == infected {
            return (0..count as u32).map(TriangleId).filter(|t| !infected[t.index()]).collect();
        }
        infected = next;
    }
}

#[test]
fn every_family_has_regions_and_a_domain() {
    let mut deep = 0;
    for (name, pslg) in families(1500, 4) {
        let mesh = triangulate(&pslg, &Options::default()).unwrap().triangulation;
        let regions = assert_regions(name, &mesh);
        deep = deep.max(regions.depths().iter().copied().max().unwrap_or(0));
        let holes: Vec<DVec2> =
            pslg.points().chunks(97).map(|part| 0.3 * part[0] + 0.7 * part[part.len() - 1]).collect();
        match domain(pslg.points(), &mesh, &holes) {
            Ok(domain) => {
                assert_eq!(domain.triangles, eaten(pslg.points(), &mesh, &holes), "{name}");
                assert_eq!(domain.triangles.len(), domain.triangulation.triangles().len());
            }
            Err(error) => assert!(matches!(error, Error::SeedOnConstraint { .. }), "{name}: {error}"),
        }
        let none = domain(pslg.points(), &mesh, &[]).unwrap();
        assert_eq!(none.triangles, eaten(pslg.points(), &mesh, &[]), "{name}");
    }
    assert!(deep > 10, "{deep}");
}

/// Rings of random radii about the origin, each inside the one before, with points between them.
fn rings(random: &mut Random) -> (Vec<At>, Vec<Vec<u32>>) {
    let (mut points, mut rings) = (Vec::new(), Vec::new());
    let mut outer = 1 << 20;
    for _ in 0..1 + random.below(4) {
        let inner = outer / 3;
        let corners = 3 + random.below(30);
        let first = points.len() as u32;
        for i in 0..corners {
            // A turn by thirds of a circle at most, so that the ring goes round the origin once.
            let angle = std::f64::consts::TAU * i as f64 / corners as f64;
            let radius = (inner + 1 + random.below(outer - inner)) as f64;
            points.push([(radius * angle.cos()) as i64, (radius * angle.sin()) as i64]);
        }
        rings.push((first..points.len() as u32).collect());
        // A chord of a wide angle may come nearer to the origin than its ends by half.
        outer = inner / 3;
    }
    for _ in 0..random.below(60) {
        let place = || [0, 0];
        let mut p = place();
        p.iter_mut().for_each(|x| *x = random.below(1 << 21) - (1 << 20));
        points.push(p);
    }
    (points, rings)
}

/// Whether a ray from a third of `sum` crosses the rings an odd number of times; `sum` lies on none of them.
fn is_odd(points: &[At], rings: &[Vec<u32>], sum: At) -> bool {
    let mut odd = false;
    for ring in rings {
        for (i, &v) in ring.iter().enumerate() {
            let [a, b] = [v, ring[(i + 1) % ring.len()]].map(|v| points[v as usize].map(|x| 3 * x));
            let spans = (a[1] <= sum[1]) != (b[1] <= sum[1]);
            let [low, high] = if a[1] < b[1] { [a, b] } else { [b, a] };
            odd ^= spans && side(low, high, sum) > 0;
        }
    }
    odd
}

#[test]
fn what_the_even_odd_rule_finds_inside_is_inside() {
    let mut random = Random::new(3);
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..200 {
        let (points, rings) = rings(&mut random);
        let edges = rings.iter().flat_map(|ring| (0..ring.len()).map(move |i| [ring[i], ring[(i + 1) % ring.len()]]));
        let constraints: Vec<[u32; 2]> = edges.collect();
        let pslg = Pslg::new(points.iter().copied().map(point).collect(), constraints).unwrap();
        let Ok(output) = triangulate(&pslg, &Options::default()) else { continue };
        let mesh = output.triangulation;
        let regions = assert_regions("rings", &mesh);
        for (t, corners) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = corners.map(|v| points[v as usize]);
            let odd = is_odd(&points, &rings, [a[0] + b[0] + c[0], a[1] + b[1] + c[1]]);
            assert_eq!(regions.is_inside(regions.region(TriangleId(t as u32))), odd);
            if odd { inside += 1 } else { outside += 1 }
        }
    }
    assert!(inside > 3000 && outside > 3000, "{inside} inside, {outside} outside");
}

fn square(first: u32) -> impl Iterator<Item = [u32; 2]> {
    (0..4).map(move |k| [first + k, first + (k + 1) % 4])
}

#[test]
fn outlines_that_touch_or_repeat_and_lines_that_end_inside() {
    // Two squares with a side in common, drawn by both; the first outline twice over; and a line into the second.
    let points = [[0, 0], [4, 0], [4, 4], [0, 4], [4, 0], [8, 0], [8, 4], [4, 4], [6, 2], [-9, 2]];
    let constraints: Vec<[u32; 2]> = square(0).chain(square(0)).chain(square(4)).chain([[8, 6]]).collect();
    let (at, mesh) = whole(&points, &constraints);
    let regions = assert_regions("squares", &mesh);
    let seeds = [[1, 2], [7, 2], [6, 2], [-1, 2], [7, 3], [2, 0], [4, 2], [8, 4], [-20, 0]].map(point);
    let of = |seed: usize| regions_at(&at, &mesh, &regions, &seeds[seed..=seed]);
    let depth = |seed: usize| of(seed).unwrap()[0].map(|region| regions.depth(region));
    assert_eq!([0, 1, 2, 3, 4, 8].map(depth), [Some(1), Some(1), Some(1), Some(0), Some(1), None]);
    assert_eq!(of(5), Ok(of(0).unwrap()), "a point on the hull's border is in the region inside");
    // Between two regions; and a corner of the hull with one region around it.
    assert_eq!(of(6), Err(Error::SeedOnConstraint { seed: 0 }));
    assert_eq!(of(7), Ok(of(1).unwrap()));
    assert_eq!(domain(&at, &mesh, &seeds).unwrap_err(), Error::SeedOnConstraint { seed: 6 });
    let seeds = [seeds[1], seeds[4], seeds[0]];
    let labels = seed_of_regions(&at, &mesh, &regions, &seeds).unwrap();
    let label = |p: At| labels[regions_at(&at, &mesh, &regions, &[point(p)]).unwrap()[0].unwrap() as usize];
    assert_eq!([label([7, 2]), label([1, 1]), label([-1, 2])], [Some(0), Some(2), None]);
}

#[test]
fn outlines_that_meet_in_one_point_have_a_border_that_is_pinched() {
    let points = [[0, 0], [4, 0], [4, 4], [0, 4], [8, 4], [8, 8], [4, 8]];
    let constraints: Vec<[u32; 2]> = square(0).chain([[2, 4], [4, 5], [5, 6], [6, 2]]).collect();
    let (at, mesh) = whole(&points, &constraints);
    let inside = domain(&at, &mesh, &[]).unwrap();
    assert_eq!((mesh.triangles().len(), inside.triangulation.triangles().len()), (6, 4));
    assert_eq!(inside.regions.depths().iter().filter(|&&depth| depth == 1).count(), 2);
    let seeds = [[1, 1], [7, 7], [6, 2]].map(point);
    let is_in = locate(&at, &inside.triangulation, &seeds).unwrap().into_iter().map(|place| place != Place::Outside);
    assert_eq!(is_in.collect::<Vec<_>>(), [true, true, false]);
}

#[test]
fn nothing_to_find_and_nothing_to_find_it_with() {
    let (at, line) = whole(&[[0, 0], [1, 1], [2, 2]], &[[0, 2]]);
    assert_eq!(locate(&at, &line, &at), Ok(vec![Place::Outside; 3]));
    assert_eq!(domain(&at, &line, &at).unwrap().holes, [None; 3]);
    let (at, mesh) = whole(&[[0, 0], [4, 0], [0, 4]], &[]);
    assert!(domain(&at, &mesh, &[]).unwrap().triangles.is_empty(), "nothing holds the outside back");
    assert_eq!(locate(&at, &mesh, &[]), Ok(Vec::new()));
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(locate(&at, &mesh, &[DVec2::ONE, DVec2::new(0.0, bad)]), Err(Error::SeedNotFinite { seed: 1 }));
    }
    assert!(matches!(locate(&at[..2], &mesh, &at), Err(Error::Input(_))));
    let huge = [DVec2::splat(-f64::MAX), DVec2::splat(f64::MAX), DVec2::new(f64::MAX, -f64::MAX), DVec2::ONE];
    let places = locate(&at, &mesh, &huge).unwrap();
    assert_eq!(places, [Place::Outside, Place::Outside, Place::Outside, Place::Inside(TriangleId(0))]);
}
