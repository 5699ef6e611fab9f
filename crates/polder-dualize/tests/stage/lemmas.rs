//! The lemmas of [CET] section 3.3 and its Conditions I to III, each under its own name, and each shown to fail where
//! the diagram or the dualization is wrong on purpose.

use crate::common::Random;
use crate::properties::{
    Pixel, condition_1, condition_2, condition_3, consistent_orientation, finite, no_crossing, no_nesting, orient,
    pixels, triangles,
};
use polder_dualize::{DualizeError, reference};
use polder_mesh::GHOST;
use polder_voronoi::reference::{color, debris, flooding::flood, recolor};
use polder_voronoi::{Diagram, Sites};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Sites at these pixels, in a grid that is as large as told.
fn sites(size: [u32; 2], mut pixels: Vec<[u16; 2]>) -> Sites {
    pixels.sort_unstable_by_key(|&[x, y]| [y, x]);
    pixels.dedup();
    Sites { size, order: (0..pixels.len() as u32).collect(), count: pixels.len(), pixels }
}

/// The flooded diagram, by the short way.
fn flooded(sites: &Sites) -> Diagram {
    let mut diagram = color(sites).unwrap();
    debris(&mut diagram, sites).unwrap();
    recolor(&mut diagram, sites).unwrap();
    diagram
}

fn on_one_line(at: &[Pixel]) -> bool {
    at.len() < 3 || at.iter().all(|&p| orient(at[0], at[1], p) == 0)
}

/// Scattered sites, or sites along a flat arc, whose regions are long and thin and full of necks and debris.
fn random_sites(random: &mut Random) -> Sites {
    let size = [1 + random.below(40) as u32, 1 + random.below(40) as u32];
    let n = 1 + random.below(30);
    let pixel = |random: &mut Random| [random.below(size[0].into()) as u16, random.below(size[1].into()) as u16];
    let (bend, slope) = (random.unit(), random.unit() - 0.5);
    let arc = random.below(2) == 1;
    let pixels = (0..n).map(|_| {
        let [x, y] = pixel(random);
        if !arc {
            return [x, y];
        }
        let t = f64::from(x) / f64::from(size[0]) - 0.5;
        let height = (0.5 + bend * t * t + slope * t).clamp(0.0, 0.999);
        [x, (height * f64::from(size[1])) as u16]
    });
    let pixels = pixels.collect();
    sites(size, pixels)
}

fn strategy() -> impl Strategy<Value = Sites> {
    any::<u64>().prop_map(|seed| random_sites(&mut Random::new(seed)))
}

fn ok(result: Result<(), String>) -> Result<(), TestCaseError> {
    result.map_err(TestCaseError::fail)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn no_crossing_lemma(sites in strategy()) {
        ok(no_crossing(&triangles(&flooded(&sites), false), &pixels(&sites)))?;
    }

    #[test]
    fn consistent_orientation_lemma(sites in strategy()) {
        ok(consistent_orientation(&triangles(&flooded(&sites), false), &pixels(&sites)))?;
    }

    #[test]
    fn no_nesting_lemma(sites in strategy()) {
        ok(no_nesting(&triangles(&flooded(&sites), false), &pixels(&sites)))?;
    }

    #[test]
    fn condition_i(sites in strategy()) {
        let mesh = reference::dualize(&flooded(&sites), &sites).unwrap().mesh;
        if sites.count > 1 {
            ok(condition_1(&mesh, sites.count))?;
        }
    }

    #[test]
    fn condition_ii(sites in strategy()) {
        let mesh = reference::dualize(&flooded(&sites), &sites).unwrap().mesh;
        mesh.check().unwrap();
        if !on_one_line(&pixels(&sites)) {
            ok(condition_2(&mesh.triangles))?;
        }
    }

    #[test]
    fn condition_iii(sites in strategy()) {
        let mesh = reference::dualize(&flooded(&sites), &sites).unwrap().mesh;
        ok(condition_3(&finite(&mesh), &pixels(&sites)))?;
    }

    /// The triangles of the stage, before the hull is closed, are those of the definition.
    #[test]
    fn dual_is_the_definition(sites in strategy()) {
        let diagram = flooded(&sites);
        prop_assert_eq!(&diagram, &Diagram { debris: diagram.debris.clone(), ..flood(&sites).unwrap().diagram });
        let mesh = reference::dual(&diagram, &sites).unwrap().mesh;
        let mut ours = finite(&mesh);
        prop_assert_eq!(&ours, &triangles(&diagram, false).into_iter().map(rotated(&ours)).collect::<Vec<_>>());
        ours.iter_mut().for_each(|t| t.sort_unstable());
        ours.sort_unstable();
        let before = ours.len();
        ours.dedup();
        prop_assert_eq!(before, ours.len());
    }
}

/// Starts a triangle at the corner at which the same triangle starts in a list.
fn rotated(list: &[[u32; 3]]) -> impl Fn([u32; 3]) -> [u32; 3] {
    move |[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().find(|t| list.contains(t)).unwrap_or([a, b, c])
}

/// The ways in which a diagram or its dualization is made wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mutation {
    /// Debris keeps the color that the Euclidean coloring gave it.
    DebrisLeft,
    /// Necks make triangles too.
    NecksCounted,
    /// Two neighboring pixels have swapped their colors.
    PixelsSwapped,
}

/// The diagram and the triangles of a mutation; for two pixels, the first pair that differ from a random one on.
fn mutated(mutation: Mutation, sites: &Sites, random: &mut Random) -> (Diagram, Vec<[u32; 3]>) {
    let mut diagram = match mutation {
        Mutation::DebrisLeft => color(sites).unwrap(),
        _ => flooded(sites),
    };
    if mutation == Mutation::PixelsSwapped {
        let n = diagram.colors.len();
        let from = random.below(n as u64) as usize;
        let step = if random.below(2) == 0 { 1 } else { diagram.width as usize };
        let mut pairs = (0..n).map(|k| (from + k) % n).map(|i| (i, i + step));
        let differ = |&(i, j): &(usize, usize)| j < n && diagram.colors[i] != diagram.colors[j];
        if let Some((i, j)) = pairs.find(differ) {
            diagram.colors.swap(i, j);
        }
    }
    let triangles = triangles(&diagram, mutation == Mutation::NecksCounted);
    (diagram, triangles)
}

/// Which checks fail, somewhere among 2000 inputs: the three lemmas, and the three conditions. The triangles are those
/// inside the grid, where the hull is not closed yet, so the conditions are held against the triangles that are right:
/// Condition I fails if a site is lost, II if that complex is a sphere and this one is not, III as far as it says
/// something of an open hull.
fn failing(mutation: Mutation) -> Vec<&'static str> {
    let mut random = Random::new(3);
    let names = ["no crossing", "consistent orientation", "no nesting", "I", "II", "III", "refused"];
    let mut failed = [false; 7];
    for _ in 0..2000 {
        let sites = random_sites(&mut random);
        let at = pixels(&sites);
        if on_one_line(&at) {
            continue;
        }
        let right = triangles(&flooded(&sites), false);
        let (diagram, wrong) = mutated(mutation, &sites, &mut random);
        let lemmas = [no_crossing(&wrong, &at), consistent_orientation(&wrong, &at), no_nesting(&wrong, &at)];
        let lemmas = lemmas.map(|result| result.is_err());
        let vertices = |triangles: &[[u32; 3]]| triangles.iter().flatten().collect::<BTreeSet<_>>().len();
        let conditions = [
            vertices(&wrong) < vertices(&right),
            condition_2(&closed_up(&right)).is_ok() && condition_2(&closed_up(&wrong)).is_err(),
            lemmas.contains(&true),
        ];
        let refused = mutation != Mutation::NecksCounted && reference::dualize(&diagram, &sites).is_err();
        let results = lemmas.into_iter().chain(conditions).chain([refused]);
        failed.iter_mut().zip(results).for_each(|(failed, result)| *failed |= result);
    }
    names.into_iter().zip(failed).filter(|(_, failed)| *failed).map(|(name, _)| name).collect()
}

/// The triangles with a ghost triangle at each edge that has no other side.
fn closed_up(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let sides: Vec<[u32; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let open = sides.iter().filter(|[u, w]| !sides.contains(&[*w, *u]));
    triangles.iter().copied().chain(open.map(|&[u, w]| [w, u, GHOST])).collect()
}

const LEMMAS: [&str; 3] = ["no crossing", "consistent orientation", "no nesting"];

/// Debris adds triangles and takes no site away, so it cannot hurt Condition I.
#[test]
fn the_properties_fail_where_debris_is_left() {
    assert_eq!(failing(Mutation::DebrisLeft), [&LEMMAS[..], &["II", "III", "refused"]].concat());
}

/// Nor can necks.
#[test]
fn the_properties_fail_where_necks_count_as_vertices() {
    assert_eq!(failing(Mutation::NecksCounted), [&LEMMAS[..], &["II", "III"]].concat());
}

#[test]
fn the_properties_fail_where_two_pixels_are_swapped() {
    assert_eq!(failing(Mutation::PixelsSwapped), [&LEMMAS[..], &["I", "II", "III", "refused"]].concat());
}

#[test]
fn a_site_without_a_region_is_refused() {
    let sites = sites([4, 1], vec![[0, 0], [3, 0]]);
    let diagram = Diagram { width: 4, height: 1, colors: vec![0; 4], debris: Vec::new() };
    let expected = DualizeError::NotASphere { triangles: 0, sites: 2, expected: 2 };
    assert_eq!(reference::dualize(&diagram, &sites).unwrap_err(), expected);
}
