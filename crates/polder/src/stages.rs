//! The stages' references in order, with everything that they pass on to each other.

use crate::plan::flips_first;
use crate::report::Stopwatch;
use crate::{Error, Options};
use polder_constrain::{Crossings, InsertReport, Walk};
use polder_dualize::reference::{self as dualize, Phases};
use polder_dualize::{Dualized, Inserted, Shifted};
use polder_flip::FlipReport;
use polder_flip::reference::flip_with;
use polder_mesh::{Chains, DVec2, GhostMesh, Parts, Pslg, Triangulation};
use polder_voronoi::Resolution;

/// What each stage made of one input, and the result.
///
/// All meshes number their vertices as [`Sites::order`](polder_voronoi::Sites::order) does: sites in pixel order, then
/// the missing points. `stages` runs on one thread; it is there to look at, to test and to teach.
#[derive(Clone, Debug)]
pub struct Stages {
    /// Stage 1: the grid, the sites and the digital Voronoi diagram, debris recolored.
    pub voronoi: polder_voronoi::reference::Output,
    /// Stage 2: the triangulation of the sites at their pixel centers.
    pub dualized: Dualized,
    /// Stage 3: the triangulation of the sites that are left, at their true positions.
    pub shifted: Shifted,
    /// Stage 4: the triangulation of all distinct points.
    pub inserted: Inserted,
    /// Where there are at least three constraints to four points: that triangulation, flipped to the Delaunay one before
    /// they walk it.
    pub flipped_first: Option<(GhostMesh, FlipReport)>,
    /// Stage 6, first step: the constraints cut at vertices, and the vertices along each.
    pub walk: Walk,
    /// Stage 6: the triangulation with every constraint in it.
    pub constrained: GhostMesh,
    /// What inserting the constraints did.
    pub insertion: InsertReport,
    /// Stage 5: the constrained Delaunay triangulation.
    pub flipped: GhostMesh,
    /// The flips that led to it.
    pub flips: FlipReport,
    /// The pixel centers of the sites: the positions of the dualized mesh.
    pub centers: Vec<DVec2>,
    /// The positions of all points in the renumbering: those of every other mesh.
    pub positions: Vec<DVec2>,
    /// The result.
    pub triangulation: Triangulation,
}

/// Runs the stages' references in order. `None` if there are no points.
///
/// # Errors
///
/// Those of [`triangulate`](crate::triangulate).
pub fn stages(pslg: &Pslg, options: &Options) -> Result<Option<Stages>, Error> {
    run(pslg, options, &mut Stopwatch::start())
}

const STAGES: u64 = 8;

/// Stages 1 to 4, which know no constraints.
fn points(pslg: &Pslg, options: &Options, watch: &mut Stopwatch) -> Result<Phases, Error> {
    let monitor = options.monitor();
    let resolution = match options.grid {
        Some(side) => Resolution::LongerSide(side).into(),
        None => polder_voronoi::Options::default(),
    };
    monitor.step("voronoi", 0, STAGES)?;
    let voronoi = polder_voronoi::reference::diagram(pslg.points(), &resolution)?;
    let counts = voronoi.counts;
    watch.stage(
        "voronoi",
        [
            ("pixels", counts.pixels),
            ("sites", counts.sites),
            ("missing_points", counts.missing),
            ("debris_pixels", counts.debris),
        ],
    );

    let sites = &voronoi.sites;
    let positions: Vec<DVec2> = sites.order.iter().map(|&i| pslg.points()[i as usize]).collect();

    monitor.step("dualize", 1, STAGES)?;
    let dualized = dualize::dual(&voronoi.diagram, sites)?;
    watch.stage("dualize", [("necks", dualized.necks)]);

    monitor.step("shift", 2, STAGES)?;
    let shifted = dualize::shift_with(dualized.mesh.clone(), &dualize::centers(&voronoi), &positions, &mut || {
        monitor.step("shift", 2, STAGES)
    })?;
    watch.stage(
        "shift",
        [
            ("bad_cases", shifted.bad as u64),
            ("taken_out", shifted.taken_out().count() as u64),
            ("rounds", shifted.rounds.iter().sum()),
            ("hull_flips", shifted.hull.flips),
        ],
    );

    monitor.step("insert", 3, STAGES)?;
    let new = dualize::points_to_insert(&voronoi.diagram, sites, &shifted);
    let inserted =
        dualize::insert_with(shifted.mesh.clone(), &positions, &new, &mut || monitor.step("insert", 3, STAGES))?;
    watch.stage(
        "insert",
        [
            ("inserted", inserted.inserted),
            ("duplicates", inserted.duplicates),
            ("rounds", inserted.rounds),
            ("flips", inserted.flips.flips),
            ("hull_flips", inserted.hull.flips),
        ],
    );
    Ok(Phases { voronoi, dualized, shifted, inserted })
}

pub(crate) fn run(pslg: &Pslg, options: &Options, watch: &mut Stopwatch) -> Result<Option<Stages>, Error> {
    use polder_constrain::reference as constrain;

    if pslg.points().is_empty() {
        return Ok(None);
    }
    let monitor = options.monitor();
    let phases = points(pslg, options, watch)?;
    let (centers, positions) = (phases.centers(), phases.positions(pslg.points()));
    let Phases { voronoi, dualized, shifted, inserted } = phases;

    let flipped_first = match flips_first(pslg.points().len(), pslg.constraints().len()) {
        true => {
            monitor.step("flip_points", 4, STAGES)?;
            let mut mesh = inserted.mesh.clone();
            let flips = flip_with(&mut mesh, &positions, &mut || monitor.step("flip_points", 4, STAGES))?;
            watch.stage("flip_points", flip_counts(&flips));
            Some((mesh, flips))
        }
        false => None,
    };

    monitor.step("constrain", 5, STAGES)?;
    let start = flipped_first.as_ref().map_or(&inserted.mesh, |(mesh, _)| mesh);
    let ends = vertices_of(pslg, &voronoi.sites.order, &inserted.vertex_of);
    let walk = constrain::walk(start, &positions, &ends)?;
    let crossings = constrain::crossings(start, &positions, &walk, options.max_crossings)?;
    if !crossings.pairs.is_empty() || crossings.truncated {
        return Err(crossing(crossings));
    }
    let mut constrained = start.clone();
    let mut inserting = constrain::Insertion::new(&mut constrained, &positions, &walk.sub_constraints)?;
    while !inserting.is_done() {
        monitor.step("constrain", 5, STAGES)?;
        inserting.outer_round()?;
    }
    let insertion = inserting.report();
    watch.stage(
        "constrain",
        [
            ("pieces", insertion.sub_constraints),
            ("intersections", walk.intersections()),
            ("rounds", insertion.inner_rounds),
            ("outer_rounds", insertion.outer_rounds),
            ("rebuilt", insertion.rebuilt),
            ("flips", insertion.all_flips()),
        ],
    );

    monitor.step("flip", 6, STAGES)?;
    let mut flipped = constrained.clone();
    let flips = flip_with(&mut flipped, &positions, &mut || monitor.step("flip", 6, STAGES))?;
    watch.stage("flip", flip_counts(&flips));

    monitor.step("canonical_order", 7, STAGES)?;
    let names = inserted.names(&voronoi.sites.order);
    let representatives = inserted.representatives(&voronoi.sites.order, &names);
    let mut chains: Chains = walk.chains.clone();
    chains.rename(&names);
    let triangulation = Triangulation::from_mesh(&flipped, &names, Parts { representatives, chains });
    watch.stage("canonical_order", []);
    Ok(Some(Stages {
        voronoi,
        dualized,
        shifted,
        inserted,
        flipped_first,
        walk,
        constrained,
        insertion,
        flipped,
        flips,
        centers,
        positions,
        triangulation,
    }))
}

fn flip_counts(flips: &FlipReport) -> [(&'static str, u64); 3] {
    [("rounds", flips.rounds), ("flips", flips.flips), ("tests", flips.tests)]
}

/// The constraints' ends as vertices of the mesh.
fn vertices_of(pslg: &Pslg, order: &[u32], vertex_of: &[u32]) -> Vec<[u32; 2]> {
    let mut vertex = vec![0; order.len()];
    for (&input, &v) in order.iter().zip(vertex_of) {
        vertex[input as usize] = v;
    }
    pslg.constraints().iter().map(|ends| ends.map(|end| vertex[end as usize])).collect()
}

pub(crate) fn crossing(crossings: Crossings) -> Error {
    Error::CrossingConstraints { pairs: crossings.pairs, truncated: crossings.truncated }
}
