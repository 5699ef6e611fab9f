use crate::IoError;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Where bytes come from: a file, or any reader.
pub struct Source {
    reader: Box<dyn Read>,
    pub(crate) name: String,
    pub(crate) path: Option<PathBuf>,
    /// How many bytes there are, where that is known beforehand.
    pub(crate) size: Option<u64>,
    cancel: Option<Arc<AtomicBool>>,
}

impl Source {
    /// Opens a file.
    ///
    /// # Errors
    ///
    /// [`IoError::Io`] if it cannot be opened, or is a directory.
    pub fn open(path: &Path) -> Result<Self, IoError> {
        let name = path.display().to_string();
        let error = |source| IoError::Io { file: path.display().to_string(), source };
        let file = File::open(path).map_err(error)?;
        let meta = file.metadata().map_err(error)?;
        if meta.is_dir() {
            return Err(error(io::Error::from(io::ErrorKind::IsADirectory)));
        }
        let size = meta.is_file().then_some(meta.len());
        Ok(Self { reader: Box::new(file), name, path: Some(path.to_owned()), size, cancel: None })
    }

    /// Takes any reader; `name` is what errors call it.
    pub fn new(reader: impl Read + 'static, name: &str) -> Self {
        Self { reader: Box::new(reader), name: name.into(), path: None, size: None, cancel: None }
    }

    /// Takes bytes.
    pub fn bytes(bytes: impl AsRef<[u8]> + 'static, name: &str) -> Self {
        let size = bytes.as_ref().len() as u64;
        Self { size: Some(size), ..Self::new(io::Cursor::new(bytes), name) }
    }

    /// Reading stops with [`IoError::Cancelled`] once this is true.
    pub fn with_cancel(self, cancel: Option<Arc<AtomicBool>>) -> Self {
        Self { cancel, ..self }
    }

    /// The file with another extension beside this one.
    pub(crate) fn beside(&self, extension: &str) -> Option<Result<Self, IoError>> {
        let path = self.path.as_ref()?.with_extension(extension);
        Some(Self::open(&path).map(|source| source.with_cancel(self.cancel.clone())))
    }

    /// Reads some bytes; none means the end.
    pub(crate) fn read(&mut self, buffer: &mut [u8]) -> Result<usize, IoError> {
        loop {
            if self.cancel.as_ref().is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Err(IoError::Cancelled { file: self.name.clone() });
            }
            match self.reader.read(buffer) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                other => return other.map_err(|source| IoError::Io { file: self.name.clone(), source }),
            }
        }
    }

    /// Fills the buffer as far as there are bytes; fewer mean the end.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, IoError> {
        let mut filled = 0;
        while filled < buffer.len() {
            match self.read(&mut buffer[filled..])? {
                0 => break,
                n => filled += n,
            }
        }
        Ok(filled)
    }
}

impl std::fmt::Debug for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Source").field("name", &self.name).field("size", &self.size).finish_non_exhaustive()
    }
}
