//! Which crate may depend on which.

use super::Finding;
use super::tree::Tree;

/// What each crate may depend on of the others. Whoever adds an arrow adds it here, where it is seen.
const ALLOWED: &[(&str, &[&str])] = &[
    ("polder-mesh", &[]),
    ("polder-predicates", &[]),
    ("polder-vulkan", &[]),
    // The stages: on those three, and of stages on flipping alone.
    ("polder-voronoi", &["polder-mesh", "polder-predicates", "polder-vulkan", "polder-flip"]),
    // Dualizing takes the digital Voronoi diagram, whose type is stage 1's.
    ("polder-dualize", &["polder-mesh", "polder-predicates", "polder-vulkan", "polder-flip", "polder-voronoi"]),
    ("polder-flip", &["polder-mesh", "polder-predicates", "polder-vulkan"]),
    ("polder-canonical", &["polder-mesh", "polder-predicates", "polder-vulkan", "polder-flip"]),
    ("polder-constrain", &["polder-mesh", "polder-predicates", "polder-vulkan", "polder-flip"]),
    // The CPU backend is no stage: it stands beside them.
    ("polder-cpu", &["polder-mesh", "polder-predicates"]),
    ("polder-io", &["polder-mesh"]),
    (
        "polder",
        &[
            "polder-mesh",
            "polder-predicates",
            "polder-vulkan",
            "polder-voronoi",
            "polder-dualize",
            "polder-flip",
            "polder-constrain",
            "polder-canonical",
            "polder-cpu",
        ],
    ),
    ("polder-cli", &["polder", "polder-io", "polder-mesh"]),
];

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for name in tree.crates() {
        let path = format!("crates/{name}/Cargo.toml");
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
            findings.push(Finding::error(path, "tidy's table of arrows does not know this crate"));
            continue;
        };
        for dependency in dependencies(tree.get(&path).unwrap_or_default()) {
            if dependency.starts_with("polder") && !allowed.contains(&dependency) {
                findings.push(Finding::error(&path, format!("{name} must not depend on {dependency}")));
            }
        }
    }
    findings
}

/// The names under `[dependencies]`, also of a target and of the build; what only tests need is free.
fn dependencies(manifest: &str) -> Vec<&str> {
    let mut names = Vec::new();
    let mut section = "";
    for line in manifest.lines().map(str::trim) {
        if let Some(header) = line.strip_prefix('[') {
            section = header.trim_end_matches(']');
            // `[dependencies.name]`
            if let Some((before, name)) = section.rsplit_once('.')
                && is_dependencies(before)
            {
                names.push(name);
            }
        } else if is_dependencies(section) && !line.starts_with('#') {
            let name = line.split(['=', '.', ' ']).next().unwrap_or_default().trim_matches('"');
            if !name.is_empty() {
                names.push(name);
            }
        }
    }
    names
}

fn is_dependencies(section: &str) -> bool {
    let last = section.rsplit('.').next().unwrap_or_default();
    last == "dependencies" || last == "build-dependencies"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, manifest: &str) -> Vec<String> {
        let path = format!("crates/{name}/Cargo.toml");
        check(&Tree::of(&[(&path, manifest)])).into_iter().map(|finding| finding.what).collect()
    }

    #[test]
    fn allowed_arrows_pass() {
        let manifest = "[package]\nname = \"polder-dualize\"\n[dependencies]\npolder-voronoi.workspace = true\n\
                        polder-flip = { path = \"../polder-flip\" }\nglam.workspace = true\n";
        assert!(found("polder-dualize", manifest).is_empty());
        assert!(found("polder-io", "[dev-dependencies]\npolder.workspace = true\n").is_empty());
    }

    #[test]
    fn a_forbidden_arrow_is_found_in_every_spelling() {
        let what = ["polder-mesh must not depend on polder-predicates"];
        assert_eq!(found("polder-mesh", "[dependencies]\npolder-predicates.workspace = true\n"), what);
        assert_eq!(found("polder-mesh", "[dependencies]\npolder-predicates = { workspace = true }\n"), what);
        assert_eq!(found("polder-mesh", "[dependencies.polder-predicates]\nworkspace = true\n"), what);
        assert_eq!(found("polder-mesh", "[build-dependencies]\npolder-predicates = \"0.1\"\n"), what);
        let target = "[target.'cfg(unix)'.dependencies]\npolder-predicates.workspace = true\n";
        assert_eq!(found("polder-mesh", target), what);
    }

    #[test]
    fn stages_do_not_see_each_other() {
        let manifest = "[dependencies]\npolder-dualize.workspace = true\n";
        for stage in ["polder-voronoi", "polder-flip", "polder-constrain", "polder-cpu", "polder-io", "polder-cli"] {
            assert_eq!(found(stage, manifest), [format!("{stage} must not depend on polder-dualize")]);
        }
        assert!(found("polder", manifest).is_empty());
    }

    #[test]
    fn an_unknown_crate_is_found() {
        assert_eq!(found("polder-new", "").len(), 1);
    }
}
