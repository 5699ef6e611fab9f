use crate::{IoError, Place};

/// The fields of one line, separated by blanks.
pub(crate) struct Fields<'a> {
    rest: &'a [u8],
    place: Place,
    file: &'a str,
}

impl<'a> Fields<'a> {
    pub(super) fn new(line: &'a [u8], place: Place, file: &'a str) -> Self {
        Self { rest: line, place, file }
    }

    pub(crate) fn malformed(&self, what: impl Into<String>) -> IoError {
        IoError::Malformed { file: self.file.into(), place: self.place, what: what.into() }
    }

    /// The next field, if there is one.
    pub(crate) fn field(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &self.rest[start..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.rest = &rest[end..];
        Some(&rest[..end])
    }

    /// Whether no field follows.
    pub(crate) fn is_empty(&self) -> bool {
        self.rest.trim_ascii().is_empty()
    }

    /// That no field follows.
    pub(crate) fn end(mut self) -> Result<(), IoError> {
        match self.field() {
            None => Ok(()),
            Some(field) => Err(self.malformed(format!("{} is one field too many", quoted(field)))),
        }
    }

    fn parse<T: std::str::FromStr>(&mut self, what: &str, kind: &str) -> Result<T, IoError> {
        let Some(field) = self.field() else {
            return Err(self.malformed(format!("the line ends where {what} should follow")));
        };
        let number = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
        number.ok_or_else(|| self.malformed(format!("{what} should be {kind}, not {}", quoted(field))))
    }

    /// A number, exactly as Rust parses it.
    pub(crate) fn number(&mut self, what: &str) -> Result<f64, IoError> {
        self.parse(what, "a number")
    }

    /// A whole number of either sign.
    pub(crate) fn integer(&mut self, what: &str) -> Result<i64, IoError> {
        self.parse(what, "a whole number")
    }

    /// A whole number from 0.
    pub(crate) fn count(&mut self, what: &str) -> Result<u64, IoError> {
        self.parse(what, "a whole number from 0")
    }

    /// A whole number from 0, or `default` where the line ends.
    pub(crate) fn count_or(&mut self, what: &str, default: u64) -> Result<u64, IoError> {
        if self.is_empty() { Ok(default) } else { self.count(what) }
    }

    /// The two finite coordinates of point `point`.
    pub(crate) fn coordinates(&mut self, point: u64) -> Result<glam::DVec2, IoError> {
        let p = glam::DVec2::new(self.number("its x coordinate")?, self.number("its y coordinate")?);
        if p.is_finite() {
            return Ok(p);
        }
        let axis = if p.x.is_finite() { 'y' } else { 'x' };
        Err(IoError::NonFiniteCoordinate { file: self.file.into(), place: self.place, point, axis })
    }

    /// A number `index`, read from a file that counts from `first`, as an index below `points`.
    pub(crate) fn point_index(
        &mut self,
        what: &'static str,
        number: u64,
        first: u32,
        points: u64,
    ) -> Result<u32, IoError> {
        let index = self.integer("the number of a point")?;
        let from_zero = index.checked_sub(first as i64).and_then(|i| u32::try_from(i).ok());
        from_zero.filter(|&i| (i as u64) < points).ok_or_else(|| IoError::IndexOutOfRange {
            file: self.file.into(),
            place: self.place,
            what,
            number,
            index,
            first,
            points,
        })
    }
}

/// A field as it may be shown: printable and not long.
fn quoted(field: &[u8]) -> String {
    let mut text: String = String::from_utf8_lossy(field).escape_debug().take(24).collect();
    if text.chars().count() == 24 {
        text.push_str("...");
    }
    format!("\"{text}\"")
}
