//! The raw little-endian formats: `.pslg` for inputs, `.tri` for triangles.

use crate::{IoError, Place, Source};
use bytemuck::Zeroable;
use glam::DVec2;
use polder_mesh::Pslg;
use std::io::{self, Write};

/// Bytes read or written at a time.
const BLOCK: usize = 1 << 18;

struct Reader {
    source: Source,
    at: u64,
}

impl Reader {
    fn malformed(&self, byte: u64, what: impl Into<String>) -> IoError {
        IoError::Malformed { file: self.source.name.clone(), place: Place::Byte(byte), what: what.into() }
    }

    fn count(&mut self, what: &str) -> Result<u64, IoError> {
        let mut bytes = [0; 8];
        let n = self.source.fill(&mut bytes)?;
        if n < 8 {
            return Err(self.malformed(self.at + n as u64, format!("the file ends within {what}")));
        }
        self.at += 8;
        Ok(u64::from_le_bytes(bytes))
    }

    /// Checks a promised size against the true one, if that is known.
    fn promise(&self, bytes: u128, what: &str) -> Result<(), IoError> {
        match self.source.size {
            Some(size) if bytes > size as u128 => Err(self.malformed(
                0,
                format!("the file has {size} bytes, but {what} take {bytes}: it is truncated, or of another format"),
            )),
            Some(size) if bytes < size as u128 => {
                Err(self.malformed(bytes as u64, format!("{what} end here, but the file has {size} bytes")))
            }
            _ => Ok(()),
        }
    }

    /// Reads `count` records of `SIZE` bytes; memory grows with what is there.
    fn records<const SIZE: usize, T>(
        &mut self,
        count: u64,
        what: &str,
        mut record: impl FnMut(&Self, u64, &[u8; SIZE]) -> Result<T, IoError>,
    ) -> Result<Vec<T>, IoError> {
        let known = self.source.size.is_some();
        let mut out = Vec::with_capacity(if known { count as usize } else { count.min(1 << 16) as usize });
        let mut block = vec![0; BLOCK / SIZE * SIZE];
        let mut left = count as u128 * SIZE as u128;
        while left > 0 {
            let part = left.min(block.len() as u128) as usize;
            let n = self.source.fill(&mut block[..part])?;
            for bytes in block[..n].as_chunks::<SIZE>().0 {
                out.push(record(self, out.len() as u64, bytes)?);
                self.at += SIZE as u64;
            }
            if n < part {
                let at = self.at + (n % SIZE) as u64;
                return Err(self.malformed(at, format!("the file ends after {} of {count} {what}", out.len())));
            }
            left -= part as u128;
        }
        Ok(out)
    }

    fn end(mut self) -> Result<(), IoError> {
        match self.source.fill(&mut [0])? {
            0 => Ok(()),
            _ => Err(self.malformed(self.at, "more follows where the file should end")),
        }
    }
}

fn u32s<const N: usize>(bytes: &[u8]) -> [u32; N] {
    let mut words = [0; N];
    for (word, bytes) in words.iter_mut().zip(bytes.as_chunks::<4>().0) {
        *word = u32::from_le_bytes(*bytes);
    }
    words
}

pub(crate) fn read_pslg(source: Source) -> Result<Pslg, IoError> {
    let mut reader = Reader { source, at: 0 };
    let n = reader.count("the number of points")?;
    let m = reader.count("the number of constraints")?;
    reader.promise(16 + 16 * n as u128 + 8 * m as u128, &format!("{n} points and {m} constraints"))?;
    for (what, count, limit) in [("points", n, Pslg::MAX_POINTS), ("constraints", m, Pslg::MAX_CONSTRAINTS)] {
        if count > limit as u64 && reader.source.size.is_some() {
            return Err(IoError::TooLarge { file: reader.source.name, what, limit: limit as u64 });
        }
    }
    let points = reader.records(n, "points", |reader, point, bytes: &[u8; 16]| {
        let [x, y] = [0, 8].map(|i| {
            let mut word = [0; 8];
            word.copy_from_slice(&bytes[i..i + 8]);
            f64::from_le_bytes(word)
        });
        if point >= Pslg::MAX_POINTS as u64 {
            let limit = Pslg::MAX_POINTS as u64;
            return Err(IoError::TooLarge { file: reader.source.name.clone(), what: "points", limit });
        }
        let p = DVec2::new(x, y);
        if p.is_finite() {
            return Ok(p);
        }
        let (axis, byte) = if x.is_finite() { ('y', reader.at + 8) } else { ('x', reader.at) };
        let (file, place) = (reader.source.name.clone(), Place::Byte(byte));
        Err(IoError::NonFiniteCoordinate { file, place, point, axis })
    })?;
    let constraints = reader.records(m, "constraints", |reader, number, bytes: &[u8; 8]| {
        let ends = u32s::<2>(bytes);
        if number >= Pslg::MAX_CONSTRAINTS as u64 {
            let limit = Pslg::MAX_CONSTRAINTS as u64;
            return Err(IoError::TooLarge { file: reader.source.name.clone(), what: "constraints", limit });
        }
        match ends.iter().position(|&v| v as usize >= points.len()) {
            None => Ok(ends),
            Some(k) => Err(IoError::IndexOutOfRange {
                file: reader.source.name.clone(),
                place: Place::Byte(reader.at + 4 * k as u64),
                what: "segment",
                number,
                index: ends[k] as i64,
                first: 0,
                points: points.len() as u64,
            }),
        }
    })?;
    let file = reader.source.name.clone();
    reader.end()?;
    Pslg::new(points, constraints).map_err(|e| IoError::Malformed { file, place: Place::Byte(0), what: e.to_string() })
}

pub(crate) fn read_tri(source: Source) -> Result<Vec<[u32; 3]>, IoError> {
    let mut reader = Reader { source, at: 0 };
    let t = reader.count("the number of triangles")?;
    reader.promise(8 + 12 * t as u128, &format!("{t} triangles"))?;
    let triangles = reader.records(t, "triangles", |_, _, bytes: &[u8; 12]| Ok(u32s::<3>(bytes)))?;
    reader.end()?;
    Ok(triangles)
}

/// Writes items block by block, each as the bytes of its words.
fn write_words<T: Copy, W: Zeroable + AsRef<[u8]>>(
    out: &mut dyn Write,
    items: &[T],
    bytes: impl Fn(T) -> W,
) -> io::Result<()> {
    let mut block = Vec::with_capacity(BLOCK);
    for part in items.chunks(BLOCK / size_of::<W>()) {
        block.clear();
        part.iter().for_each(|&item| block.extend_from_slice(bytes(item).as_ref()));
        out.write_all(&block)?;
    }
    Ok(())
}

fn words<const N: usize, const SIZE: usize>(words: [u32; N]) -> [u8; SIZE] {
    let mut bytes = [0; SIZE];
    for (bytes, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *bytes = word.to_le_bytes();
    }
    bytes
}

/// Writes a PSLG as `.pslg`.
///
/// # Errors
///
/// What `out` says.
pub fn write_pslg(out: &mut dyn Write, pslg: &Pslg) -> io::Result<()> {
    out.write_all(&(pslg.points().len() as u64).to_le_bytes())?;
    out.write_all(&(pslg.constraints().len() as u64).to_le_bytes())?;
    write_words(out, pslg.points(), |p| {
        let mut bytes = [0u8; 16];
        bytes[..8].copy_from_slice(&p.x.to_le_bytes());
        bytes[8..].copy_from_slice(&p.y.to_le_bytes());
        bytes
    })?;
    write_words(out, pslg.constraints(), words::<2, 8>)
}

/// Writes triangles as `.tri`: u64 t, then t times three u32 that count from 0.
///
/// # Errors
///
/// What `out` says.
pub fn write_tri(out: &mut dyn Write, triangles: &[[u32; 3]]) -> io::Result<()> {
    out.write_all(&(triangles.len() as u64).to_le_bytes())?;
    write_words(out, triangles, words::<3, 12>)
}
