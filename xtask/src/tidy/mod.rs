//! `cargo xtask tidy`: the rules of the workspace that no compiler knows.

mod arrows;
mod kernels;
mod layout;
mod tree;

use std::fmt::{self, Display, Formatter};
use std::path::Path;
use tree::Tree;

/// Something that breaks a rule, or comes close to it.
#[derive(Debug, PartialEq, Eq)]
struct Finding {
    path: String,
    what: String,
    warning: bool,
}

impl Finding {
    fn error(path: impl Into<String>, what: impl Into<String>) -> Self {
        Self { path: path.into(), what: what.into(), warning: false }
    }

    fn warning(path: impl Into<String>, what: impl Into<String>) -> Self {
        Self { path: path.into(), what: what.into(), warning: true }
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let word = if self.warning { "warning" } else { "error" };
        write!(f, "{word}: {}: {}", self.path, self.what)
    }
}

pub(crate) fn run(root: &Path) -> Result<(), String> {
    let tree = Tree::read(root).map_err(|error| format!("the workspace cannot be read: {error}"))?;
    let rules = [
        arrows::check,
        kernels::check,
        layout::top_level,
        layout::sizes,
        layout::no_unsafe,
        layout::readmes,
        layout::examples,
        layout::snapshots,
    ];
    let findings: Vec<_> = rules.iter().flat_map(|rule| rule(&tree)).collect();
    findings.iter().for_each(|finding| eprintln!("{finding}"));
    match findings.iter().filter(|finding| !finding.warning).count() {
        0 => Ok(()),
        errors => Err(format!("{errors} rules of the workspace are broken")),
    }
}
