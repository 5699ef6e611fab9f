//! Triangle's `.node` and `.poly`: lines of fields, `#` begins a comment, points numbered from 0 or 1.
//!
//! Stricter than Triangle where it would lose something in silence: points must be numbered in order, and a line must
//! hold exactly the fields that its section promises. Looser in nothing.

use crate::text::{Lines, Text};
use crate::{Input, IoError, Region, Source};
use glam::DVec2;
use polder_mesh::Pslg;
use std::io::{self, Write};

pub(crate) fn read_node(source: Source) -> Result<Input, IoError> {
    let mut lines = Lines::new(source, Some(b'#'));
    let points = read_points(&mut lines)?;
    lines.end()?;
    points.into_input(&lines, Segments::default())
}

pub(crate) fn read_poly(source: Source) -> Result<Input, IoError> {
    let sibling = source.beside("node");
    let mut lines = Lines::new(source, Some(b'#'));
    let mut points = read_points(&mut lines)?;
    // A .poly without points takes them from its .node. Without one it may still be an honest empty PSLG.
    let mut missing = None;
    if points.points.is_empty() {
        match sibling {
            Some(Ok(source)) => {
                let mut node = Lines::new(source, Some(b'#'));
                points = read_points(&mut node)?;
                node.end()?;
            }
            Some(Err(e)) => missing = Some(e),
            None => {
                let file = lines.source.name.clone();
                let what = "it has no points of its own, and no .node file beside it to take them from".into();
                missing = Some(IoError::Unsupported { file, what });
            }
        }
    }
    let segments = read_segments(&mut lines, &points, missing)?;
    let holes = read_holes(&mut lines)?;
    let regions = read_regions(&mut lines)?;
    lines.end()?;
    Ok(Input { holes, regions, ..points.into_input(&lines, segments)? })
}

#[derive(Default)]
struct Points {
    first: u32,
    points: Vec<DVec2>,
    attributes_per_point: usize,
    attributes: Vec<f64>,
    markers: Option<Vec<i64>>,
}

#[derive(Default)]
struct Segments {
    ends: Vec<[u32; 2]>,
    markers: Option<Vec<i64>>,
}

impl Points {
    fn into_input(self, lines: &Lines, segments: Segments) -> Result<Input, IoError> {
        let pslg = Pslg::new(self.points, segments.ends).map_err(|e| lines.malformed(e.to_string()))?;
        Ok(Input {
            first: self.first,
            attributes_per_point: self.attributes_per_point,
            attributes: self.attributes,
            point_markers: self.markers,
            constraint_markers: segments.markers,
            ..Input::new(pslg, self.first)
        })
    }
}

fn too_large(lines: &Lines, what: &'static str, limit: usize) -> IoError {
    IoError::TooLarge { file: lines.source.name.clone(), what, limit: limit as u64 }
}

fn read_points(lines: &mut Lines) -> Result<Points, IoError> {
    let mut header = lines.expect("the number of points")?;
    let count = header.count("the number of points")?;
    if header.count_or("the dimension", 2)? != 2 {
        return Err(header.malformed("the dimension must be 2"));
    }
    let attributes = header.count_or("the number of attributes", 0)?;
    let marked = header.count_or("the number of boundary markers", 0)?;
    if marked > 1 {
        return Err(header.malformed("the number of boundary markers must be 0 or 1"));
    }
    header.end()?;
    // "1 0 0", a line end, and two bytes for each further field.
    let bytes = attributes.saturating_add(marked).saturating_mul(2).saturating_add(6);
    let room = lines.room(count, "points", bytes)?;
    // Read into one number only, so that no absurd count of attributes can overflow it later.
    let attributes_per_point = usize::try_from(attributes).unwrap_or(usize::MAX);
    let mut out = Points { first: 1, attributes_per_point, ..Points::default() };
    out.points.reserve_exact(room);
    if lines.source.size.is_some() {
        out.attributes.reserve_exact(room.saturating_mul(attributes_per_point));
    }
    let mut markers = Vec::with_capacity(if marked == 1 { room } else { 0 });
    for i in 0..count {
        if i >= Pslg::MAX_POINTS as u64 {
            return Err(too_large(lines, "points", Pslg::MAX_POINTS));
        }
        if !lines.advance()? {
            return Err(lines.malformed(format!("the file ends after {i} of {count} points")));
        }
        let mut fields = lines.fields();
        let number = fields.integer("the number of a point")?;
        if i == 0 {
            out.first = match number {
                0 | 1 => number as u32,
                _ => return Err(fields.malformed(format!("the first point must be numbered 0 or 1, not {number}"))),
            };
        }
        if number != i as i64 + out.first as i64 {
            let expected = i + out.first as u64;
            return Err(fields.malformed(format!("point {expected} should follow, not {number}")));
        }
        out.points.push(fields.coordinates(i)?);
        for _ in 0..attributes {
            out.attributes.push(fields.number("an attribute")?);
        }
        if marked == 1 {
            markers.push(fields.integer("its boundary marker")?);
        }
        fields.end()?;
    }
    out.markers = (marked == 1).then_some(markers);
    Ok(out)
}

fn read_segments(lines: &mut Lines, points: &Points, mut missing: Option<IoError>) -> Result<Segments, IoError> {
    let mut header = lines.expect("the number of segments")?;
    let count = header.count("the number of segments")?;
    let marked = header.count_or("the number of boundary markers", 0)?;
    if marked > 1 {
        return Err(header.malformed("the number of boundary markers must be 0 or 1"));
    }
    header.end()?;
    let room = lines.room(count, "segments", 6)?;
    if let Some(missing) = missing.take().filter(|_| count > 0) {
        return Err(missing);
    }
    let mut ends = Vec::with_capacity(room);
    let mut markers = Vec::with_capacity(if marked == 1 { room } else { 0 });
    for i in 0..count {
        if i >= Pslg::MAX_CONSTRAINTS as u64 {
            return Err(too_large(lines, "segments", Pslg::MAX_CONSTRAINTS));
        }
        if !lines.advance()? {
            return Err(lines.malformed(format!("the file ends after {i} of {count} segments")));
        }
        let mut fields = lines.fields();
        fields.integer("the number of a segment")?;
        let mut end = || fields.point_index("segment", i, points.first, points.points.len() as u64);
        ends.push([end()?, end()?]);
        if marked == 1 {
            markers.push(fields.integer("its boundary marker")?);
        }
        fields.end()?;
    }
    Ok(Segments { ends, markers: (marked == 1).then_some(markers) })
}

fn read_holes(lines: &mut Lines) -> Result<Vec<DVec2>, IoError> {
    let mut header = lines.expect("the number of holes (0 if there are none)")?;
    let count = header.count("the number of holes")?;
    header.end()?;
    let mut holes = Vec::with_capacity(lines.room(count, "holes", 6)?);
    for i in 0..count {
        if !lines.advance()? {
            return Err(lines.malformed(format!("the file ends after {i} of {count} holes")));
        }
        let mut fields = lines.fields();
        fields.integer("the number of a hole")?;
        holes.push(fields.coordinates(i)?);
        fields.end()?;
    }
    Ok(holes)
}

fn read_regions(lines: &mut Lines) -> Result<Vec<Region>, IoError> {
    let Some(mut header) = lines.next()? else { return Ok(Vec::new()) };
    let count = header.count("the number of regions")?;
    header.end()?;
    let mut regions = Vec::with_capacity(lines.room(count, "regions", 8)?);
    for i in 0..count {
        if !lines.advance()? {
            return Err(lines.malformed(format!("the file ends after {i} of {count} regions")));
        }
        let mut fields = lines.fields();
        fields.integer("the number of a region")?;
        let point = fields.coordinates(i)?;
        let attribute = fields.number("its attribute")?;
        let max_area = if fields.is_empty() { None } else { Some(fields.number("its largest area")?) };
        regions.push(Region { point, attribute, max_area });
        fields.end()?;
    }
    Ok(regions)
}

/// Writes the points of an input as `.node`, with attributes and markers, numbered as it says.
///
/// # Errors
///
/// What `out` says.
pub fn write_node(out: &mut dyn Write, input: &Input) -> io::Result<()> {
    let mut text = Text::new(out);
    write_points(&mut text, input)?;
    text.finish()
}

/// Writes an input as `.poly`, with everything that it holds, numbered as it says.
///
/// # Errors
///
/// What `out` says.
pub fn write_poly(out: &mut dyn Write, input: &Input) -> io::Result<()> {
    let mut text = Text::new(out);
    write_points(&mut text, input)?;
    let first = input.first as u64;
    let constraints = input.pslg.constraints();
    text.field(constraints.len())?;
    text.field(u8::from(input.constraint_markers.is_some()))?;
    text.end_line()?;
    for (i, ends) in constraints.iter().enumerate() {
        text.field(i as u64 + first)?;
        ends.iter().try_for_each(|&v| text.field(v as u64 + first))?;
        if let Some(&marker) = input.constraint_markers.as_ref().and_then(|markers| markers.get(i)) {
            text.field(marker)?;
        }
        text.end_line()?;
    }
    text.field(input.holes.len())?;
    text.end_line()?;
    for (i, hole) in input.holes.iter().enumerate() {
        text.field(i as u64 + first)?;
        text.numbers(hole.to_array());
        text.end_line()?;
    }
    if !input.regions.is_empty() {
        text.field(input.regions.len())?;
        text.end_line()?;
    }
    for (i, region) in input.regions.iter().enumerate() {
        text.field(i as u64 + first)?;
        let [x, y] = region.point.to_array();
        text.numbers([Some(x), Some(y), Some(region.attribute), region.max_area].into_iter().flatten());
        text.end_line()?;
    }
    text.finish()
}

fn write_points(text: &mut Text<'_>, input: &Input) -> io::Result<()> {
    let points = input.pslg.points();
    let attributes = input.attributes_per_point;
    text.field(points.len())?;
    text.field(2)?;
    text.field(attributes)?;
    text.field(u8::from(input.point_markers.is_some()))?;
    text.end_line()?;
    for (i, p) in points.iter().enumerate() {
        text.field(i as u64 + input.first as u64)?;
        text.numbers(p.to_array());
        text.numbers(input.attributes.iter().skip(i * attributes).take(attributes).copied());
        if let Some(&marker) = input.point_markers.as_ref().and_then(|markers| markers.get(i)) {
            text.field(marker)?;
        }
        text.end_line()?;
    }
    Ok(())
}
