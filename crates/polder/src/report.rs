use polder_mesh::Triangulation;
use serde::Serialize;
use std::collections::BTreeMap;

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

/// One stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StageReport {
    /// Its name.
    pub name: &'static str,
    /// Seconds it took.
    pub seconds: f64,
    /// What it counted: rounds, flips, missing points, bad cases, debris pixels and so on.
    pub counts: BTreeMap<&'static str, u64>,
}
