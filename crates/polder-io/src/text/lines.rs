use super::Fields;
use crate::{IoError, Place, Source};
use std::ops::Range;

/// A line may have so many bytes; a longer one is no line of these formats.
const LONGEST: usize = 1 << 20;

/// The lines of a text file that hold something, read block by block.
pub(crate) struct Lines {
    pub(crate) source: Source,
    buffer: Vec<u8>,
    /// The bytes of the buffer not yet given out.
    rest: Range<usize>,
    ended: bool,
    comment: Option<u8>,
    current: Range<usize>,
    line: u64,
}

impl Lines {
    /// `comment` begins a comment, which ends with its line.
    pub(crate) fn new(source: Source, comment: Option<u8>) -> Self {
        Self { source, buffer: vec![0; 1 << 16], rest: 0..0, ended: false, comment, current: 0..0, line: 0 }
    }

    /// The number of the current line, from 1.
    pub(crate) fn place(&self) -> Place {
        Place::Line(self.line.max(1))
    }

    pub(crate) fn malformed(&self, what: impl Into<String>) -> IoError {
        IoError::Malformed { file: self.source.name.clone(), place: self.place(), what: what.into() }
    }

    /// Goes to the next line that holds a field; comments and blank lines are passed over.
    pub(crate) fn advance(&mut self) -> Result<bool, IoError> {
        while let Some(mut line) = self.raw()? {
            if self.line == 1 && self.buffer[line.clone()].starts_with(b"\xef\xbb\xbf") {
                line.start += 3;
            }
            if let Some(i) = self.comment.and_then(|c| self.buffer[line.clone()].iter().position(|&b| b == c)) {
                line.end = line.start + i;
            }
            if !self.buffer[line.clone()].trim_ascii().is_empty() {
                self.current = line;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The fields of the current line.
    pub(crate) fn fields(&self) -> Fields<'_> {
        Fields::new(&self.buffer[self.current.clone()], self.place(), &self.source.name)
    }

    /// The next line, if there is one.
    pub(crate) fn next(&mut self) -> Result<Option<Fields<'_>>, IoError> {
        Ok(if self.advance()? { Some(self.fields()) } else { None })
    }

    /// The next line, which must be there; `what` says what should stand on it.
    pub(crate) fn expect(&mut self, what: &str) -> Result<Fields<'_>, IoError> {
        if self.advance()? { Ok(self.fields()) } else { Err(self.ended(what)) }
    }

    pub(crate) fn ended(&self, what: &str) -> IoError {
        self.malformed(format!("the file ends where {what} should follow"))
    }

    /// That nothing follows.
    pub(crate) fn end(&mut self) -> Result<(), IoError> {
        if self.advance()? { Err(self.malformed("more follows after the end of the last section")) } else { Ok(()) }
    }

    /// How many records a promised number is worth reserving memory for, each of at least `bytes` bytes; an error if
    /// the file has no room for them.
    pub(crate) fn room(&self, count: u64, what: &str, bytes: u64) -> Result<usize, IoError> {
        match self.source.size {
            Some(size) if count > size / bytes => {
                Err(self.malformed(format!("{count} {what} are promised, but the whole file has only {size} bytes")))
            }
            Some(_) => Ok(count as usize),
            None => Ok(count.min(1 << 16) as usize),
        }
    }

    /// Bytes after the current line, as they are; fewer than asked for mean the end.
    pub(crate) fn bytes(&mut self, out: &mut [u8]) -> Result<usize, IoError> {
        let mut filled = 0;
        while filled < out.len() {
            if self.rest.is_empty() {
                let n = self.source.read(&mut self.buffer)?;
                self.rest = 0..n;
                if n == 0 {
                    break;
                }
            }
            let n = self.rest.len().min(out.len() - filled);
            out[filled..filled + n].copy_from_slice(&self.buffer[self.rest.start..self.rest.start + n]);
            self.rest.start += n;
            filled += n;
        }
        Ok(filled)
    }

    /// The next line as it is, without its end.
    fn raw(&mut self) -> Result<Option<Range<usize>>, IoError> {
        let mut looked = 0;
        loop {
            if let Some(i) = self.buffer[self.rest.start + looked..self.rest.end].iter().position(|&b| b == b'\n') {
                let line = self.rest.start..self.rest.start + looked + i;
                self.rest.start = line.end + 1;
                self.line += 1;
                return Ok(Some(line));
            }
            if self.ended {
                let line = self.rest.clone();
                self.rest.start = line.end;
                self.line += u64::from(!line.is_empty());
                return Ok((!line.is_empty()).then_some(line));
            }
            looked = self.rest.len();
            self.buffer.copy_within(self.rest.clone(), 0);
            self.rest = 0..looked;
            if looked == self.buffer.len() {
                if looked >= LONGEST {
                    self.line += 1;
                    return Err(self.malformed(format!("a line of more than {LONGEST} bytes")));
                }
                self.buffer.resize(2 * looked, 0);
            }
            let n = self.source.read(&mut self.buffer[looked..])?;
            self.rest.end += n;
            self.ended = n == 0;
        }
    }
}
