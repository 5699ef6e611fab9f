//! Compiled pipelines, kept on disk: a pipeline takes a driver milliseconds to make and a fraction of one to read.
//!
//! One file a device and driver. Drivers check what they are given, but not all do it well, so the file carries its
//! length and a checksum, and is replaced as a whole.

use crate::Error;
use crate::error::Called;
use ash::vk;
use std::path::{Path, PathBuf};

/// Where compiled pipelines are kept.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum CacheFolder {
    /// `polder` in the user's cache folder (`POLDER_CACHE` names another); nowhere if there is none.
    #[default]
    User,
    /// Here.
    At(PathBuf),
    /// Nowhere.
    Off,
}

impl CacheFolder {
    fn path(&self) -> Option<PathBuf> {
        let variable = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        match self {
            CacheFolder::Off => None,
            CacheFolder::At(path) => Some(path.clone()),
            CacheFolder::User => {
                let user = if cfg!(windows) {
                    variable("LOCALAPPDATA")
                } else if cfg!(target_os = "macos") {
                    variable("HOME").map(|home| home.join("Library").join("Caches"))
                } else {
                    variable("XDG_CACHE_HOME").or_else(|| variable("HOME").map(|home| home.join(".cache")))
                };
                variable("POLDER_CACHE").or_else(|| user.map(|folder| folder.join("polder")))
            }
        }
    }
}

pub(crate) struct PipelineCache {
    pub(crate) raw: vk::PipelineCache,
    file: Option<PathBuf>,
    read: Vec<u8>,
}

const HEADER: usize = 16;

impl PipelineCache {
    pub(crate) fn open(device: &ash::Device, folder: &CacheFolder, name: &str) -> Result<Self, Error> {
        let file = folder.path().map(|folder| folder.join(format!("pipelines-{name}.bin")));
        let read = file.as_deref().and_then(read_checked).unwrap_or_default();
        let info = vk::PipelineCacheCreateInfo::default().initial_data(&read);
        // SAFETY: the device is alive, and the data is what it or its like wrote.
        let raw = unsafe { device.create_pipeline_cache(&info, None) }.called("vkCreatePipelineCache")?;
        Ok(PipelineCache { raw, file, read })
    }

    /// Writes what is new. A cache that cannot be written is no error.
    pub(crate) fn save(&self, device: &ash::Device) {
        let Some(file) = &self.file else { return };
        // SAFETY: the cache is of this device and alive.
        let Ok(data) = (unsafe { device.get_pipeline_cache_data(self.raw) }) else { return };
        if data != self.read {
            let _ = write_checked(file, &data);
        }
    }

    /// The cache must not be used afterwards.
    pub(crate) fn destroy(&self, device: &ash::Device) {
        // SAFETY: of this device, destroyed once by the device's drop, and every pipeline is gone by then.
        unsafe { device.destroy_pipeline_cache(self.raw, None) };
    }
}

fn checksum(data: &[u8]) -> u64 {
    // FNV-1a: this guards against torn files, not against anybody.
    data.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

fn read_checked(path: &Path) -> Option<Vec<u8>> {
    let mut whole = std::fs::read(path).ok()?;
    let length = u64::from_le_bytes(whole.get(..8)?.try_into().ok()?);
    let sum = u64::from_le_bytes(whole.get(8..HEADER)?.try_into().ok()?);
    let data = whole.split_off(HEADER);
    (length == data.len() as u64 && sum == checksum(&data)).then_some(data)
}

fn write_checked(path: &Path, data: &[u8]) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut whole = (data.len() as u64).to_le_bytes().to_vec();
    whole.extend(checksum(data).to_le_bytes());
    whole.extend(data);
    let mine = path.with_extension(format!("{}.tmp", std::process::id()));
    std::fs::write(&mine, whole)?;
    std::fs::rename(&mine, path).inspect_err(|_| drop(std::fs::remove_file(&mine)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn what_was_torn_is_not_read() {
        let folder = std::env::temp_dir().join(format!("polder-cache-{}", std::process::id()));
        let path = folder.join("pipelines-x.bin");
        write_checked(&path, b"pipelines").unwrap();
        assert_eq!(read_checked(&path).unwrap(), b"pipelines");
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            assert_eq!(read_checked(&path), None);
        }
        for at in 0..whole.len() {
            let mut turned = whole.clone();
            turned[at] ^= 1;
            std::fs::write(&path, &turned).unwrap();
            assert_eq!(read_checked(&path), None);
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
