//! Stanford `.ply`: elements of properties as the header lists them, as text or little-endian.

use super::{MeshFile, constrained_edges};
use crate::text::{Fields, Lines, Text};
use crate::{IoError, Source};
use glam::DVec2;
use polder_mesh::{Pslg, Triangulation};
use std::io::{self, Write};

#[derive(Clone, Copy, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of little-endian bytes; every one of these types fits into an f64 exactly.
    fn value(self, b: [u8; 8]) -> f64 {
        match self {
            Self::I8 => b[0] as i8 as f64,
            Self::U8 => b[0] as f64,
            Self::I16 => i16::from_le_bytes([b[0], b[1]]) as f64,
            Self::U16 => u16::from_le_bytes([b[0], b[1]]) as f64,
            Self::I32 => i32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f64,
            Self::U32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f64,
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f64,
            Self::F64 => f64::from_le_bytes(b),
        }
    }
}

struct Property {
    name: Vec<u8>,
    /// The type of the length, if it is a list.
    length: Option<Scalar>,
    scalar: Scalar,
}

struct Element {
    name: Vec<u8>,
    count: u64,
    properties: Vec<Property>,
}

/// Reads one value after the other, of either form.
struct Values {
    lines: Lines,
    binary: bool,
    /// Values of the current line not yet read, backwards.
    pending: Vec<f64>,
}

impl Values {
    fn malformed(&self, element: &Element, i: u64, what: &str) -> IoError {
        let name = element.name.escape_ascii();
        self.lines.malformed(format!("{name} {i} of {}: {what}", element.count))
    }

    fn next(&mut self, scalar: Scalar, element: &Element, i: u64) -> Result<f64, IoError> {
        if self.binary {
            let mut bytes = [0; 8];
            if self.lines.bytes(&mut bytes[..scalar.size()])? < scalar.size() {
                return Err(self.malformed(element, i, "the file ends within it"));
            }
            return Ok(scalar.value(bytes));
        }
        self.pending.pop().ok_or_else(|| self.malformed(element, i, "a value is missing"))
    }

    fn begin(&mut self, element: &Element, i: u64) -> Result<(), IoError> {
        if !self.binary {
            if !self.lines.advance()? {
                return Err(self.malformed(element, i, "the file ends before it"));
            }
            let mut fields = self.lines.fields();
            self.pending.clear();
            while !fields.is_empty() {
                self.pending.push(fields.number("a value")?);
            }
            self.pending.reverse();
        }
        Ok(())
    }
}

pub(super) fn read(source: Source) -> Result<MeshFile, IoError> {
    let mut lines = Lines::new(source, None);
    let mut magic = lines.expect("the word ply")?;
    if magic.field() != Some(b"ply") {
        return Err(magic.malformed("a .ply file begins with the word ply"));
    }
    let (binary, elements) = read_header(&mut lines)?;
    let mut values = Values { lines, binary, pending: Vec::new() };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for element in &elements {
        for i in 0..element.count {
            values.begin(element, i)?;
            let mut p = DVec2::ZERO;
            for property in &element.properties {
                let Some(length) = property.length else {
                    let value = values.next(property.scalar, element, i)?;
                    match &*property.name {
                        b"x" => p.x = value,
                        b"y" => p.y = value,
                        _ => {}
                    }
                    continue;
                };
                let length = values.next(length, element, i)?;
                let is_face = element.name == b"face" && property.name.starts_with(b"vertex_ind");
                if is_face && length != 3.0 {
                    return Err(values.malformed(element, i, "it is no triangle"));
                }
                let mut corners = [0; 3];
                // A list of a lying length ends with the file.
                for k in 0..length as u64 {
                    let value = values.next(property.scalar, element, i)?;
                    if is_face {
                        corners[k as usize % 3] = value as u32;
                        if value != value as u32 as f64 {
                            return Err(values.malformed(element, i, "a corner is no vertex"));
                        }
                    }
                }
                if is_face {
                    triangles.push(corners);
                }
            }
            if !values.pending.is_empty() {
                return Err(values.malformed(element, i, "more values than the header lists"));
            }
            if element.name == b"vertex" {
                let (file, place, point) = (values.lines.source.name.clone(), values.lines.place(), i);
                if !p.is_finite() {
                    let axis = if p.x.is_finite() { 'y' } else { 'x' };
                    return Err(IoError::NonFiniteCoordinate { file, place, point, axis });
                }
                if vertices.len() >= Pslg::MAX_POINTS {
                    return Err(IoError::TooLarge { file, what: "points", limit: Pslg::MAX_POINTS as u64 });
                }
                vertices.push(p);
            }
        }
    }
    let (points, bad) = (vertices.len(), |t: &[u32; 3]| t.iter().any(|&v| v as usize >= vertices.len()));
    if let Some(number) = triangles.iter().position(bad) {
        let index = triangles[number].into_iter().max().unwrap_or(0) as i64;
        return Err(IoError::IndexOutOfRange {
            file: values.lines.source.name.clone(),
            place: values.lines.place(),
            what: "triangle",
            number: number as u64,
            index,
            first: 0,
            points: points as u64,
        });
    }
    Ok(MeshFile { triangles, vertices: Some(vertices), first: 0 })
}

fn read_header(lines: &mut Lines) -> Result<(bool, Vec<Element>), IoError> {
    let mut binary = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let mut fields = lines.expect("the rest of the header")?;
        match fields.field() {
            Some(b"format") => {
                binary = match fields.field() {
                    Some(b"ascii") => Some(false),
                    Some(b"binary_little_endian") => Some(true),
                    _ => {
                        let what = "of .ply, ascii and binary_little_endian can be read".into();
                        return Err(IoError::Unsupported { file: lines.source.name.clone(), what });
                    }
                }
            }
            Some(b"element") => {
                let name = fields.field().unwrap_or_default().to_vec();
                elements.push(Element { name, count: fields.count("the number of elements")?, properties: Vec::new() });
            }
            Some(b"property") => {
                let Some(element) = elements.last_mut() else {
                    return Err(fields.malformed("a property before any element"));
                };
                let scalar = |fields: &Fields<'_>, word: Option<&[u8]>| {
                    Scalar::named(word.unwrap_or_default())
                        .ok_or_else(|| fields.malformed("this is no type of a property"))
                };
                let word = fields.field();
                let (length, scalar) = if word == Some(b"list") {
                    let (length, scalar_word) = (fields.field(), fields.field());
                    (Some(scalar(&fields, length)?), scalar(&fields, scalar_word)?)
                } else {
                    (None, scalar(&fields, word)?)
                };
                let name = fields.field().unwrap_or_default().to_vec();
                element.properties.push(Property { name, length, scalar });
            }
            Some(b"end_header") => break,
            Some(b"comment" | b"obj_info") => {}
            _ => return Err(fields.malformed("this line does not belong into the header")),
        }
    }
    let Some(binary) = binary else { return Err(lines.malformed("the header names no format")) };
    for element in &elements {
        let size = |p: &Property| if binary { p.length.unwrap_or(p.scalar).size() as u64 } else { 2 };
        let bytes = element.properties.iter().map(size).sum::<u64>();
        if bytes == 0 && element.count > 0 {
            return Err(lines.malformed("an element without properties"));
        }
        lines.room(element.count, "elements", bytes.max(1))?;
    }
    Ok((binary, elements))
}

/// Writes points, triangles, and constrained edges as the element `edge`, little-endian.
///
/// # Errors
///
/// What `out` says.
pub fn write_ply(out: &mut dyn Write, points: &[DVec2], triangulation: &Triangulation) -> io::Result<()> {
    let edges = constrained_edges(triangulation);
    let mut text = Text::new(out);
    let [n, t, e] = [points.len(), triangulation.triangles().len(), edges.len()];
    text.verbatim("ply\nformat binary_little_endian 1.0\ncomment a constrained Delaunay triangulation by polder")?;
    text.verbatim(&format!("element vertex {n}\nproperty double x\nproperty double y\nproperty double z"))?;
    text.verbatim(&format!("element face {t}\nproperty list uchar uint vertex_indices"))?;
    text.verbatim(&format!("element edge {e}\nproperty uint vertex1\nproperty uint vertex2\nend_header"))?;
    for p in points {
        [p.x, p.y, 0.0].iter().try_for_each(|x| text.bytes(&x.to_le_bytes()))?;
    }
    for corners in triangulation.triangles() {
        text.bytes(&[3])?;
        corners.iter().try_for_each(|v| text.bytes(&v.to_le_bytes()))?;
    }
    for edge in edges {
        edge.iter().try_for_each(|v| text.bytes(&v.to_le_bytes()))?;
    }
    text.finish()
}
