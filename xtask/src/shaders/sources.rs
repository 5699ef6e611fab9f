//! Where shaders and what is made of them lie, and the hash of a kernel with all that it includes.

use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// One folder of `shaders-glsl`, which is one crate.
pub(super) struct Stage {
    pub(super) name: String,
    pub(super) kernels: Vec<Source>,
}

/// One kernel: `<name>.comp`.
pub(super) struct Source {
    pub(super) name: String,
    #[cfg_attr(not(feature = "shaders"), expect(dead_code, reason = "only the compiler reads the file again"))]
    pub(super) path: PathBuf,
    /// The comment lines at the top of the file.
    pub(super) about: Vec<String>,
    /// SHA-256 of the file and of all that it includes, with their names.
    pub(super) hash: String,
    /// Whether it says what to do without f64, for devices that have none.
    asks_for_float64: bool,
}

/// Defined where a kernel is compiled for devices without f64. A kernel whose sources ask for it is compiled twice.
pub(super) const NO_FLOAT64: &str = "NO_FLOAT64";

impl Source {
    /// Whether there is a second module of it, without f64, beside one that uses these capabilities.
    pub(super) fn has_second(&self, capabilities: &[String]) -> bool {
        self.asks_for_float64 && capabilities.iter().any(|name| name == "Float64")
    }

    /// The second module's name: `<kernel>.integers`.
    pub(super) fn second(&self) -> String {
        format!("{}.integers", self.name)
    }
}

impl Stage {
    fn crate_folder(&self, root: &Path) -> PathBuf {
        root.join("crates").join(format!("polder-{}", self.name))
    }

    pub(super) fn spirv_folder(&self, root: &Path) -> PathBuf {
        self.crate_folder(root).join("spv")
    }

    pub(super) fn spirv_file(&self, root: &Path, module: &str) -> PathBuf {
        self.spirv_folder(root).join(format!("{module}.spv"))
    }

    pub(super) fn kernels_file(&self, root: &Path) -> PathBuf {
        self.crate_folder(root).join("src").join("kernels.rs")
    }

    /// The modules that are in the crate, sorted.
    pub(super) fn committed(&self, root: &Path) -> Result<Vec<String>, String> {
        let folder = self.spirv_folder(root);
        if !folder.exists() {
            return Ok(Vec::new());
        }
        let mut names: Vec<String> = files(&folder, "spv")?.iter().map(|path| stem(path)).collect();
        names.sort();
        Ok(names)
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// All stages with at least one kernel, by name.
pub(super) fn stages(root: &Path) -> Result<Vec<Stage>, String> {
    let base = root.join("shaders-glsl");
    let mut stages = Vec::new();
    for folder in sorted(&base)? {
        let name = stem(&folder);
        if !folder.is_dir() || name == "include" {
            continue;
        }
        let kernels =
            files(&folder, "comp")?.into_iter().map(|path| source(root, path)).collect::<Result<Vec<_>, _>>()?;
        if !kernels.is_empty() {
            stages.push(Stage { name, kernels });
        }
    }
    Ok(stages)
}

fn sorted(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| format!("{}: {error}", folder.display()))?;
    paths.sort();
    Ok(paths)
}

fn files(folder: &Path, extension: &str) -> Result<Vec<PathBuf>, String> {
    Ok(sorted(folder)?.into_iter().filter(|path| path.extension().is_some_and(|found| found == extension)).collect())
}

fn source(root: &Path, path: PathBuf) -> Result<Source, String> {
    let mut parts = BTreeMap::new();
    gather(root, &path, &mut parts)?;
    let mut hash = Sha256::new();
    for (name, text) in &parts {
        hash.update(name.as_bytes());
        hash.update([0]);
        hash.update(text.as_bytes());
        hash.update([0]);
    }
    let hash = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    let asks_for_float64 =
        parts.values().any(|text| text.lines().any(|line| line.trim() == format!("#ifndef {NO_FLOAT64}")));
    let about = parts[&named(root, &path)]
        .lines()
        .map_while(|line| line.strip_prefix("//"))
        .map(|line| line.trim().to_owned())
        .collect();
    Ok(Source { name: stem(&path), path, about, hash, asks_for_float64 })
}

fn named(root: &Path, path: &Path) -> String {
    path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

/// A file and all that it includes.
fn gather(root: &Path, path: &Path, parts: &mut BTreeMap<String, String>) -> Result<(), String> {
    let name = named(root, path);
    if parts.contains_key(&name) {
        return Ok(());
    }
    let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
    let included: Vec<String> = text.lines().filter_map(include_of).collect();
    parts.insert(name.clone(), text);
    for include in included {
        let found = resolve(root, path, &include).ok_or(format!("{name}: there is no \"{include}\" to include"))?;
        gather(root, &found, parts)?;
    }
    Ok(())
}

fn include_of(line: &str) -> Option<String> {
    let rest = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("include")?.trim();
    Some(rest.strip_prefix('"')?.split('"').next()?.to_owned())
}

/// Beside the file that includes it, else in `shaders-glsl/include`.
pub(super) fn resolve(root: &Path, from: &Path, include: &str) -> Option<PathBuf> {
    let beside = from.parent()?.join(include);
    let shared = root.join("shaders-glsl").join("include").join(include);
    [beside, shared].into_iter().find(|path| path.is_file())
}

pub(super) fn read_words(path: &Path) -> Result<Vec<u32>, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let (words, rest) = bytes.as_chunks::<4>();
    if !rest.is_empty() {
        return Err(format!("{}: not a whole number of words", path.display()));
    }
    Ok(words.iter().map(|word| u32::from_le_bytes(*word)).collect())
}

#[cfg_attr(not(feature = "shaders"), expect(dead_code, reason = "nothing is written without a compiler"))]
pub(super) fn write_if_changed(path: &Path, bytes: &[u8]) -> Result<(), String> {
    if std::fs::read(path).is_ok_and(|found| found == bytes) {
        return Ok(());
    }
    std::fs::write(path, bytes).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn a_hash_covers_all_that_is_included() {
        let root = std::env::temp_dir().join(format!("polder-sources-{}", std::process::id()));
        let write = |path: &str, text: &str| {
            let path = root.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        let hash = || {
            let stages = stages(&root).unwrap();
            assert_eq!((stages.len(), stages[0].name.as_str(), stages[0].kernels.len()), (1, "flip", 1));
            let kernel = &stages[0].kernels[0];
            assert_eq!((kernel.name.as_str(), kernel.about.as_slice()), ("mark", ["Marks.".to_owned()].as_slice()));
            kernel.hash.clone()
        };
        write("shaders-glsl/include/a.glsl", "#include \"b.glsl\"\n");
        write("shaders-glsl/include/b.glsl", "#include \"a.glsl\"\n");
        write("shaders-glsl/include/unused.glsl", "");
        write("shaders-glsl/flip/mark.comp", "// Marks.\n#version 460\n#include \"a.glsl\"\n");
        let first = hash();
        write("shaders-glsl/include/unused.glsl", "int x;");
        assert_eq!(hash(), first);
        write("shaders-glsl/include/b.glsl", "#include \"a.glsl\"\nint x;\n");
        let second = hash();
        assert_ne!(second, first);
        // A file beside the kernel hides the shared one.
        write("shaders-glsl/flip/a.glsl", "");
        assert!(hash() != second && hash() != first);
        // A second module only where the source asks for f64 and the first module uses it.
        let has_second = |capability: &str| stages(&root).unwrap()[0].kernels[0].has_second(&[capability.to_owned()]);
        assert!(!has_second("Float64"));
        write("shaders-glsl/flip/a.glsl", "#ifndef NO_FLOAT64\n#endif\n");
        assert!(has_second("Float64") && !has_second("Int64"));
        write("shaders-glsl/flip/mark.comp", "#include \"none.glsl\"\n");
        assert!(stages(&root).is_err());
        std::fs::remove_dir_all(&root).unwrap();
    }
}
