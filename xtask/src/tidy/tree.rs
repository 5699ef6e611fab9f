//! The files of the workspace.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// Every file by its path from the root, with `/` between folders; contents of Rust and TOML files alone. Build
/// products and the history are left out.
#[derive(Default)]
pub(super) struct Tree {
    files: BTreeMap<String, String>,
}

impl Tree {
    pub(super) fn read(root: &Path) -> io::Result<Self> {
        let mut tree = Self::default();
        let mut folders = vec![(root.to_path_buf(), String::new())];
        while let Some((folder, prefix)) = folders.pop() {
            for entry in fs::read_dir(folder)? {
                let entry = entry?;
                let name = entry.file_name().to_string_lossy().into_owned();
                let path = format!("{prefix}{name}");
                if entry.file_type()?.is_dir() {
                    if name != "target" && name != ".git" {
                        folders.push((entry.path(), format!("{path}/")));
                    }
                } else {
                    let is_read = [".rs", ".toml"].iter().any(|end| name.ends_with(end));
                    let text = if is_read { fs::read_to_string(entry.path())? } else { String::new() };
                    tree.files.insert(path, text);
                }
            }
        }
        Ok(tree)
    }

    #[cfg(test)]
    pub(super) fn of(files: &[(&str, &str)]) -> Self {
        Self { files: files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect() }
    }

    pub(super) fn files(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files.iter().map(|(path, text)| (path.as_str(), text.as_str()))
    }

    /// The files in a folder and below, given with its final `/`.
    pub(super) fn under<'a>(&'a self, folder: &'a str) -> impl Iterator<Item = (&'a str, &'a str)> {
        self.files().filter(move |(path, _)| path.starts_with(folder))
    }

    pub(super) fn get(&self, path: &str) -> Option<&str> {
        self.files.get(path).map(String::as_str)
    }

    /// The names of the packages in `crates/`.
    pub(super) fn crates(&self) -> Vec<&str> {
        let manifests =
            self.under("crates/").filter_map(|(path, _)| path.strip_prefix("crates/")?.strip_suffix("/Cargo.toml"));
        manifests.filter(|name| !name.contains('/')).collect()
    }
}
