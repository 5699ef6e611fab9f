//! Wavefront `.obj`: `v x y z`, `f a b c` with indices from 1, or from the end if negative; `l` for constrained edges.

use super::{MeshFile, constrained_edges};
use crate::text::{Fields, Lines, Text};
use crate::{IoError, Source};
use glam::DVec2;
use polder_mesh::{Pslg, Triangulation};
use std::io::{self, Write};

/// Reads vertices and triangles, in any order; z, texture, normals, groups and all else are passed over.
pub(super) fn read(source: Source) -> Result<MeshFile, IoError> {
    let mut lines = Lines::new(source, Some(b'#'));
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    // A triangle may name vertices that follow it: what it names, and where, until all are known.
    let mut last = (0, 0, lines.place());
    while let Some(mut fields) = lines.next()? {
        match fields.field() {
            Some(b"v") => vertices.push(fields.coordinates(vertices.len() as u64)?),
            Some(b"f") => {
                let mut corner = || corner(&mut fields, vertices.len());
                let corners = [corner()?, corner()?, corner()?];
                fields.end()?;
                let highest = corners.into_iter().max().unwrap_or(0);
                if highest as usize >= vertices.len() && highest >= last.0 {
                    last = (highest, triangles.len() as u64, lines.place());
                }
                triangles.push(corners);
            }
            _ => {}
        }
    }
    if !triangles.is_empty() && last.0 as usize >= vertices.len() {
        let (file, index, points) = (lines.source.name.clone(), last.0 as i64 + 1, vertices.len() as u64);
        return Err(IoError::IndexOutOfRange {
            file,
            place: last.2,
            what: "triangle",
            number: last.1,
            index,
            first: 1,
            points,
        });
    }
    if vertices.len() > Pslg::MAX_POINTS {
        let limit = Pslg::MAX_POINTS as u64;
        return Err(IoError::TooLarge { file: lines.source.name.clone(), what: "points", limit });
    }
    Ok(MeshFile { triangles, vertices: Some(vertices), first: 1 })
}

/// The vertex in `7`, `7/1`, `7//3` or `-1`.
fn corner(fields: &mut Fields<'_>, vertices: usize) -> Result<u32, IoError> {
    let field = fields.field().ok_or_else(|| fields.malformed("a face has three corners or more"))?;
    let index = field.split(|&b| b == b'/').next().unwrap_or_default();
    let index = std::str::from_utf8(index).ok().and_then(|text| text.parse::<i64>().ok());
    let from_zero = index.and_then(|i| match i {
        1.. => Some(i - 1),
        0 => None,
        _ => i.checked_add(vertices as i64),
    });
    from_zero
        .and_then(|i| u32::try_from(i).ok())
        .ok_or_else(|| fields.malformed(format!("{} names no vertex", field.escape_ascii())))
}

/// Writes points, triangles, and constrained edges as lines.
///
/// # Errors
///
/// What `out` says.
pub fn write_obj(out: &mut dyn Write, points: &[DVec2], triangulation: &Triangulation) -> io::Result<()> {
    let mut text = Text::new(out);
    for p in points {
        text.field('v')?;
        text.numbers([p.x, p.y, 0.0]);
        text.end_line()?;
    }
    for [a, b, c] in triangulation.triangles() {
        text.field('f')?;
        text.line([a, b, c].map(|&v| v as u64 + 1))?;
    }
    for [a, b] in constrained_edges(triangulation) {
        text.field('l')?;
        text.line([a, b].map(|v| v as u64 + 1))?;
    }
    text.finish()
}
