//! What must be where, and what must not.

use super::Finding;
use super::tree::Tree;
use std::collections::BTreeSet;

/// What may stand at the top level; build products and the history are not looked at.
const TOP_LEVEL: &[&str] = &[
    ".cargo",
    ".ci",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "benches",
    "crates",
    "docs",
    "examples",
    "references.bib",
    "rust-toolchain.toml",
    "rustfmt.toml",
    "shaders-glsl",
    "tests",
    "xtask",
];

/// A file of Rust may have so many lines without a word, and so many at all.
const LINES: [usize; 2] = [500, 600];

/// Crates that people use alone, each with an example of that.
const STAGES: [&str; 4] = ["polder-voronoi", "polder-dualize", "polder-flip", "polder-constrain"];

pub(super) fn top_level(tree: &Tree) -> Vec<Finding> {
    let present: BTreeSet<_> = tree.files().filter_map(|(path, _)| path.split('/').next()).collect();
    let strange = present.iter().filter(|name| !TOP_LEVEL.contains(name));
    strange.map(|name| Finding::error(*name, "this has no place at the top level")).collect()
}

pub(super) fn sizes(tree: &Tree) -> Vec<Finding> {
    let long = |(path, text): (&str, &str)| {
        let lines = text.lines().count();
        let [warn, fail] = LINES;
        if lines > fail {
            Some(Finding::error(path, format!("{lines} lines; more than {fail} are too many for one file")))
        } else if lines > warn {
            Some(Finding::warning(path, format!("{lines} lines; about {warn} is where a file should be split")))
        } else {
            None
        }
    };
    tree.files().filter(|(path, _)| path.ends_with(".rs")).filter_map(long).collect()
}

/// Every crate root forbids unsafe code, but for the one that talks to the driver.
pub(super) fn no_unsafe(tree: &Tree) -> Vec<Finding> {
    let is_root = |path: &str| {
        let Some((package, file)) = path.rsplit_once("/src/") else { return false };
        ["lib.rs", "main.rs"].contains(&file) && tree.get(&format!("{package}/Cargo.toml")).is_some()
    };
    let roots = tree.files().filter(|(path, _)| is_root(path) && !path.starts_with("crates/polder-vulkan/"));
    let open = roots.filter(|(_, text)| !text.lines().any(|line| line.trim() == "#![forbid(unsafe_code)]"));
    open.map(|(path, _)| Finding::error(path, "`#![forbid(unsafe_code)]` is missing")).collect()
}

pub(super) fn readmes(tree: &Tree) -> Vec<Finding> {
    missing(tree, tree.crates().into_iter(), "README.md")
}

pub(super) fn examples(tree: &Tree) -> Vec<Finding> {
    missing(tree, STAGES.into_iter(), "examples/alone.rs")
}

fn missing<'a>(tree: &Tree, crates: impl Iterator<Item = &'a str>, file: &str) -> Vec<Finding> {
    let paths = crates.map(|name| format!("crates/{name}/{file}"));
    paths.filter(|path| tree.get(path).is_none()).map(|path| Finding::error(path, "this file is missing")).collect()
}

pub(super) fn snapshots(tree: &Tree) -> Vec<Finding> {
    let new = tree.files().filter(|(path, _)| path.ends_with(".snap.new") || path.ends_with(".pending-snap"));
    new.map(|(path, _)| Finding::error(path, "a snapshot that nobody has looked at yet")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(findings: Vec<Finding>) -> Vec<String> {
        findings.into_iter().map(|finding| finding.path).collect()
    }

    #[test]
    fn strangers_at_the_top_level_are_found() {
        let tree =
            Tree::of(&[("Cargo.toml", ""), ("crates/polder/src/lib.rs", ""), ("notes.txt", ""), ("old/a.rs", "")]);
        assert_eq!(paths(top_level(&tree)), ["notes.txt", "old"]);
    }

    #[test]
    fn long_files_are_found() {
        let [fits, warns, fails] = [500, 501, 601].map(|lines| "\n".repeat(lines));
        let tree = Tree::of(&[("a.rs", &fits), ("b.rs", &warns), ("c.rs", &fails), ("d.svg", &fails)]);
        let found: Vec<_> = sizes(&tree).into_iter().map(|finding| (finding.path, finding.warning)).collect();
        assert_eq!(found, [("b.rs".to_owned(), true), ("c.rs".to_owned(), false)]);
    }

    #[test]
    fn roots_that_allow_unsafe_code_are_found() {
        let tree = Tree::of(&[
            ("crates/polder/Cargo.toml", ""),
            ("crates/polder/src/lib.rs", "//! Docs.\n#![forbid(unsafe_code)]\n"),
            ("crates/polder-io/Cargo.toml", ""),
            ("crates/polder-io/src/lib.rs", "// #![forbid(unsafe_code)]\n"),
            ("crates/polder-io/src/text/lib.rs", ""),
            ("crates/polder-vulkan/Cargo.toml", ""),
            ("crates/polder-vulkan/src/lib.rs", ""),
            ("xtask/Cargo.toml", ""),
            ("xtask/src/main.rs", ""),
        ]);
        assert_eq!(paths(no_unsafe(&tree)), ["crates/polder-io/src/lib.rs", "xtask/src/main.rs"]);
    }

    #[test]
    fn missing_readmes_and_examples_are_found() {
        let tree = Tree::of(&[
            ("crates/polder-flip/Cargo.toml", ""),
            ("crates/polder-flip/examples/alone.rs", ""),
            ("crates/polder-io/Cargo.toml", ""),
            ("crates/polder-io/README.md", ""),
        ]);
        assert_eq!(paths(readmes(&tree)), ["crates/polder-flip/README.md"]);
        let others = ["polder-voronoi", "polder-dualize", "polder-constrain"];
        assert_eq!(paths(examples(&tree)), others.map(|name| format!("crates/{name}/examples/alone.rs")));
    }

    #[test]
    fn new_snapshots_are_found() {
        let tree = Tree::of(&[("tests/tests/snapshots/a.snap", ""), ("tests/tests/snapshots/b.snap.new", "")]);
        assert_eq!(paths(snapshots(&tree)), ["tests/tests/snapshots/b.snap.new"]);
    }
}
