use std::fmt::Display;
use std::io::{self, Write};

/// Lines of fields on their way out, block by block.
pub(crate) struct Text<'a> {
    out: &'a mut dyn Write,
    block: Vec<u8>,
}

impl<'a> Text<'a> {
    pub(crate) fn new(out: &'a mut dyn Write) -> Self {
        Self { out, block: Vec::new() }
    }

    /// A field of whole numbers or words.
    pub(crate) fn field(&mut self, field: impl Display) -> io::Result<()> {
        write!(self.block, "{field} ")
    }

    /// One field each: the shortest decimal that reads back as the same bits.
    pub(crate) fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        for x in numbers {
            super::push_number(&mut self.block, x);
            self.block.push(b' ');
        }
    }

    /// Ends the line.
    pub(crate) fn end_line(&mut self) -> io::Result<()> {
        if self.block.last() == Some(&b' ') {
            self.block.pop();
        }
        self.block.push(b'\n');
        if self.block.len() >= 1 << 16 { self.flush() } else { Ok(()) }
    }

    /// One line of such fields.
    pub(crate) fn line<T: Display>(&mut self, fields: impl IntoIterator<Item = T>) -> io::Result<()> {
        fields.into_iter().try_for_each(|field| self.field(field))?;
        self.end_line()
    }

    /// One line as it is.
    pub(crate) fn verbatim(&mut self, line: &str) -> io::Result<()> {
        self.block.extend_from_slice(line.as_bytes());
        self.end_line()
    }

    /// Bytes as they are.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.block.extend_from_slice(bytes);
        if self.block.len() >= 1 << 16 { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(&self.block)?;
        self.block.clear();
        Ok(())
    }

    /// Writes what is left.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.flush()
    }
}
