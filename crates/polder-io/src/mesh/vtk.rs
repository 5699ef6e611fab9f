//! Legacy `.vtk` as text: POLYDATA with triangles as polygons and constrained edges as lines; UNSTRUCTURED_GRID is
//! read too.

use super::{MeshFile, constrained_edges};
use crate::text::{Lines, Text};
use crate::{IoError, Source};
use glam::DVec2;
use polder_mesh::{Pslg, Triangulation};
use std::io::{self, Write};

/// Fields across lines.
struct Words {
    lines: Lines,
    /// The fields of the current line not yet read, backwards.
    pending: Vec<Vec<u8>>,
}

impl Words {
    fn next(&mut self) -> Result<Option<Vec<u8>>, IoError> {
        if self.pending.is_empty() {
            let Some(mut fields) = self.lines.next()? else { return Ok(None) };
            while let Some(field) = fields.field() {
                self.pending.push(field.to_vec());
            }
            self.pending.reverse();
        }
        Ok(self.pending.pop())
    }

    fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, IoError> {
        let Some(field) = self.next()? else { return Err(self.lines.ended(what)) };
        let number = std::str::from_utf8(&field).ok().and_then(|text| text.parse().ok());
        number.ok_or_else(|| {
            let field: String = field.escape_ascii().to_string().chars().take(24).collect();
            self.lines.malformed(format!("{what} should be a number, not \"{field}\""))
        })
    }
}

pub(super) fn read(source: Source) -> Result<MeshFile, IoError> {
    let mut lines = Lines::new(source, None);
    let mut header = lines.expect("the line \"# vtk DataFile Version\"")?;
    if header.field() != Some(b"#") || header.field() != Some(b"vtk") {
        return Err(header.malformed("a legacy .vtk file begins with \"# vtk DataFile Version\""));
    }
    lines.expect("the title")?;
    // A blank title is passed over like any blank line; then its place is taken by the form.
    let is_form = |field: Option<&[u8]>| matches!(field, Some(b"ASCII" | b"BINARY"));
    let mut form = lines.fields().field().map(<[u8]>::to_vec);
    if !is_form(form.as_deref()) {
        form = lines.expect("ASCII or BINARY")?.field().map(<[u8]>::to_vec);
    }
    match form.as_deref() {
        Some(b"ASCII") => {}
        Some(b"BINARY") => {
            let what = "binary .vtk cannot be read; write it as ASCII".into();
            return Err(IoError::Unsupported { file: lines.source.name.clone(), what });
        }
        _ => return Err(lines.malformed("ASCII should stand here")),
    }
    let mut words = Words { lines, pending: Vec::new() };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    while let Some(word) = words.next()? {
        match &*word {
            b"POINTS" => vertices = read_points(&mut words)?,
            b"POLYGONS" | b"CELLS" => read_cells(&mut words, word == b"POLYGONS", vertices.len(), &mut triangles)?,
            b"VERTICES" | b"LINES" | b"CELL_TYPES" => {
                let cells: u64 = words.number("the number of cells")?;
                let skipped = if word == b"CELL_TYPES" { cells } else { words.number("the number of values")? };
                for _ in 0..skipped {
                    words.number::<i64>("a value")?;
                }
            }
            b"DATASET" => match words.next()?.as_deref() {
                Some(b"POLYDATA" | b"UNSTRUCTURED_GRID") => {}
                _ => return Err(words.lines.malformed("only POLYDATA and UNSTRUCTURED_GRID can be read")),
            },
            // What follows belongs to points or cells: colors, fields, normals.
            b"POINT_DATA" | b"CELL_DATA" => break,
            _ => return Err(words.lines.malformed(format!("unknown section {}", word.escape_ascii()))),
        }
    }
    Ok(MeshFile { triangles, vertices: Some(vertices), first: 0 })
}

fn read_points(words: &mut Words) -> Result<Vec<DVec2>, IoError> {
    let count: u64 = words.number("the number of points")?;
    words.next()?;
    let mut vertices = Vec::with_capacity(words.lines.room(count, "points", 6)?);
    for point in 0..count {
        if point >= Pslg::MAX_POINTS as u64 {
            let (file, limit) = (words.lines.source.name.clone(), Pslg::MAX_POINTS as u64);
            return Err(IoError::TooLarge { file, what: "points", limit });
        }
        let p = DVec2::new(words.number("a coordinate")?, words.number("a coordinate")?);
        words.number::<f64>("a coordinate")?;
        if !p.is_finite() {
            let axis = if p.x.is_finite() { 'y' } else { 'x' };
            let (file, place) = (words.lines.source.name.clone(), words.lines.place());
            return Err(IoError::NonFiniteCoordinate { file, place, point, axis });
        }
        vertices.push(p);
    }
    Ok(vertices)
}

/// Triangles; among cells of an unstructured grid those of fewer corners are lines and points, and passed over.
fn read_cells(words: &mut Words, polygons: bool, points: usize, triangles: &mut Vec<[u32; 3]>) -> Result<(), IoError> {
    let count: u64 = words.number("the number of cells")?;
    let _values: u64 = words.number("the number of values")?;
    words.lines.room(count, "cells", 2)?;
    for _ in 0..count {
        let corners: u64 = words.number("the number of corners")?;
        if corners > 3 || (corners < 3 && polygons) {
            return Err(words.lines.malformed(format!("a cell with {corners} corners is no triangle")));
        }
        let mut triangle = [0; 3];
        for corner in &mut triangle[..corners as usize] {
            let index: i64 = words.number("a corner")?;
            *corner = u32::try_from(index).ok().filter(|&v| (v as usize) < points).ok_or_else(|| {
                IoError::IndexOutOfRange {
                    file: words.lines.source.name.clone(),
                    place: words.lines.place(),
                    what: "triangle",
                    number: triangles.len() as u64,
                    index,
                    first: 0,
                    points: points as u64,
                }
            })?;
        }
        if corners == 3 {
            triangles.push(triangle);
        }
    }
    Ok(())
}

/// Writes points, constrained edges as lines, and triangles as polygons, as text.
///
/// # Errors
///
/// What `out` says.
pub fn write_vtk(out: &mut dyn Write, points: &[DVec2], triangulation: &Triangulation) -> io::Result<()> {
    let mut text = Text::new(out);
    text.verbatim("# vtk DataFile Version 3.0\na constrained Delaunay triangulation by polder\nASCII")?;
    text.verbatim("DATASET POLYDATA")?;
    text.verbatim(&format!("POINTS {} double", points.len()))?;
    for p in points {
        text.numbers([p.x, p.y, 0.0]);
        text.end_line()?;
    }
    let edges = constrained_edges(triangulation);
    if !edges.is_empty() {
        text.verbatim(&format!("LINES {} {}", edges.len(), 3 * edges.len()))?;
        edges.iter().try_for_each(|&[a, b]| text.line([2, a, b]))?;
    }
    let triangles = triangulation.triangles();
    text.verbatim(&format!("POLYGONS {} {}", triangles.len(), 4 * triangles.len()))?;
    triangles.iter().try_for_each(|&[a, b, c]| text.line([3, a, b, c]))?;
    text.finish()
}
