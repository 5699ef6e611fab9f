//! Triangle's `.ele`, `.neigh` and `.edge`.

use super::MeshFile;
use crate::text::{Lines, Text};
use crate::{Input, IoError, Source};
use polder_mesh::{NONE, Triangulation};
use std::io::{self, Write};

pub(super) fn read(source: Source, vertices: Option<Input>) -> Result<MeshFile, IoError> {
    let mut lines = Lines::new(source, Some(b'#'));
    let mut header = lines.expect("the number of triangles")?;
    let count = header.count("the number of triangles")?;
    let corners = header.count_or("the number of corners of each", 3)?;
    let attributes = header.count_or("the number of attributes", 0)?;
    if !matches!(corners, 3 | 6) {
        return Err(header.malformed(format!("a triangle has 3 corners, or 6 nodes, not {corners}")));
    }
    header.end()?;
    let bytes = attributes.saturating_add(corners + 1).saturating_mul(2);
    let mut triangles = Vec::with_capacity(lines.room(count, "triangles", bytes)?);
    let mut first = vertices.as_ref().map_or(0, |input| input.first);
    let points = vertices.as_ref().map_or(u32::MAX as u64, |input| input.pslg.points().len() as u64);
    for i in 0..count {
        if !lines.advance()? {
            return Err(lines.malformed(format!("the file ends after {i} of {count} triangles")));
        }
        let mut fields = lines.fields();
        let number = fields.integer("the number of a triangle")?;
        if i == 0 && vertices.is_none() {
            first = match number {
                0 | 1 => number as u32,
                _ => return Err(fields.malformed(format!("the first triangle must be 0 or 1, not {number}"))),
            };
        }
        let mut corner = || fields.point_index("triangle", i, first, points);
        triangles.push([corner()?, corner()?, corner()?]);
        (3..corners).try_for_each(|_| corner().map(|_| ()))?;
        (0..attributes).try_for_each(|_| fields.number("an attribute").map(|_| ()))?;
        fields.end()?;
    }
    lines.end()?;
    let vertices = vertices.map(|input| input.pslg.into_parts().0);
    Ok(MeshFile { triangles, vertices, first })
}

/// Writes the triangles as `.ele`, triangles and points numbered from `first`.
///
/// # Errors
///
/// What `out` says.
pub fn write_ele(out: &mut dyn Write, triangulation: &Triangulation, first: u32) -> io::Result<()> {
    let mut text = Text::new(out);
    text.line([triangulation.triangles().len(), 3, 0])?;
    for (i, &[a, b, c]) in triangulation.triangles().iter().enumerate() {
        text.line([i as u64, a as u64, b as u64, c as u64].map(|i| i + first as u64))?;
    }
    text.finish()
}

/// Writes the neighbors of each triangle as `.neigh`, -1 for none: the k-th lies opposite the k-th corner.
///
/// # Errors
///
/// What `out` says.
pub fn write_neigh(out: &mut dyn Write, triangulation: &Triangulation, first: u32) -> io::Result<()> {
    let mut text = Text::new(out);
    text.line([triangulation.neighbors().len(), 3])?;
    for (i, neighbors) in triangulation.neighbors().iter().enumerate() {
        text.field(i as u64 + first as u64)?;
        text.line(neighbors.map(|n| if n == NONE { -1 } else { n as i64 + first as i64 }))?;
    }
    text.finish()
}

/// Writes the edges as `.edge`, each with a boundary marker as Triangle gives it: the constraint's own where that is
/// not 0 (1 if the input has none), else 1 on the hull, else 0.
///
/// # Errors
///
/// What `out` says.
pub fn write_edge(out: &mut dyn Write, triangulation: &Triangulation, input: &Input) -> io::Result<()> {
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut marked: Vec<([u32; 2], i64)> = Vec::new();
    for (i, chain) in triangulation.chains().iter().enumerate() {
        let marker = input.constraint_markers.as_ref().map_or(1, |markers| markers.get(i).copied().unwrap_or(0));
        if marker != 0 {
            marked.extend(chain.windows(2).map(|w| (sorted([w[0], w[1]]), marker)));
        }
    }
    // Stable: of constraints on one edge, the first gives the marker.
    marked.sort_by_key(|edge| edge.0);
    let mut text = Text::new(out);
    text.line([triangulation.edges().count(), 1])?;
    for (i, edge) in triangulation.edges().enumerate() {
        let ends = edge.vertices.map(|v| v.0);
        let place = marked.partition_point(|other| other.0 < sorted(ends));
        let own = marked.get(place).filter(|other| other.0 == sorted(ends)).map(|other| other.1);
        let first = input.first as i64;
        let on_hull = triangulation.neighbors()[edge.id.triangle().index()][edge.id.k()] == NONE;
        text.line([
            i as i64 + first,
            ends[0] as i64 + first,
            ends[1] as i64 + first,
            own.unwrap_or(i64::from(on_hull)),
        ])?;
    }
    text.finish()
}
