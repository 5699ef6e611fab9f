//! Each kernel has a reference and a test of its name.

use super::Finding;
use super::tree::Tree;

/// For `shaders-glsl/<stage>/<kernel>.comp`, the crate `polder-<stage>` has a function `<kernel>` in its `reference`, and
/// a test `<kernel>` is in that crate or in the workspace's tests. Kernels that differ in the width of their elements
/// alone (`sort_u32`, `sort_u64`) may share both (`sort`).
pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, _) in tree.under("shaders-glsl/") {
        let Some(kernel) = path.strip_prefix("shaders-glsl/").and_then(|rest| rest.strip_suffix(".comp")) else {
            continue;
        };
        let Some((stage, name)) = kernel.split_once('/').filter(|(_, name)| !name.contains('/')) else {
            findings.push(Finding::error(path, "a kernel belongs into the folder of its stage"));
            continue;
        };
        let home = format!("crates/polder-{stage}/");
        if tree.get(&format!("{home}Cargo.toml")).is_none() {
            findings.push(Finding::error(path, format!("there is no crate polder-{stage}")));
            continue;
        }
        let reference = format!("{home}src/reference");
        if !tree.under(&reference).any(|(_, text)| has_function(text, name) || has_function(text, shared(name))) {
            findings.push(Finding::error(path, format!("no function `{name}` in {reference}")));
        }
        if !tree
            .under(&home)
            .chain(tree.under("tests/"))
            .any(|(_, text)| has_test(text, name) || has_test(text, shared(name)))
        {
            findings.push(Finding::error(path, format!("no test `{name}` in {home} or tests/")));
        }
    }
    findings
}

/// The name without the width of its elements.
fn shared(name: &str) -> &str {
    ["_u32", "_u64"].iter().find_map(|width| name.strip_suffix(width)).unwrap_or(name)
}

fn is_function(line: &str, name: &str) -> bool {
    let line = line.trim_start();
    let line = ["pub(crate) ", "pub(super) ", "pub "].iter().find_map(|p| line.strip_prefix(p)).unwrap_or(line);
    let after = line.strip_prefix("fn ").and_then(|line| line.strip_prefix(name));
    after.is_some_and(|after| after.starts_with(['(', '<']))
}

fn has_function(text: &str, name: &str) -> bool {
    text.lines().any(|line| is_function(line, name))
}

/// Whether a function of that name has `#[test]` among the attributes above it.
fn has_test(text: &str, name: &str) -> bool {
    let mut is_test = false;
    text.lines().any(|line| {
        let line = line.trim_start();
        if line.starts_with("#[") || line.starts_with("//") || line.is_empty() {
            is_test |= line.starts_with("#[test]");
            return false;
        }
        std::mem::take(&mut is_test) && is_function(line, name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANIFEST: (&str, &str) = ("crates/polder-flip/Cargo.toml", "");
    const KERNEL: (&str, &str) = ("shaders-glsl/flip/mark.comp", "");
    const REFERENCE: (&str, &str) = ("crates/polder-flip/src/reference/rounds.rs", "pub fn mark(mesh: &Mesh) {}\n");
    const TEST: (&str, &str) = ("tests/tests/flip_kernels.rs", "#[test]\n#[ignore = \"long\"]\nfn mark() {\n");

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        check(&Tree::of(files)).into_iter().map(|finding| finding.what).collect()
    }

    #[test]
    fn a_kernel_with_both_passes() {
        assert!(found(&[MANIFEST, KERNEL, REFERENCE, TEST]).is_empty());
        assert!(found(&[("shaders-glsl/include/predicates.glsl", "")]).is_empty());
    }

    #[test]
    fn kernels_of_two_widths_may_share_reference_and_test() {
        let wide = ("shaders-glsl/flip/mark_u64.comp", "");
        assert!(found(&[MANIFEST, wide, REFERENCE, TEST]).is_empty());
        let other = ("shaders-glsl/flip/mark_f64.comp", "");
        assert_eq!(found(&[MANIFEST, other, REFERENCE, TEST]).len(), 2);
    }

    #[test]
    fn a_kernel_without_reference_is_found() {
        let other = (REFERENCE.0, "pub fn mark_all(mesh: &Mesh) {}\n");
        assert_eq!(found(&[MANIFEST, KERNEL, other, TEST]), ["no function `mark` in crates/polder-flip/src/reference"]);
    }

    #[test]
    fn a_kernel_without_test_is_found() {
        let helper = (TEST.0, "#[test]\nfn other() {}\nfn mark() {}\n");
        let what = ["no test `mark` in crates/polder-flip/ or tests/"];
        assert_eq!(found(&[MANIFEST, KERNEL, REFERENCE, helper]), what);
    }

    #[test]
    fn a_kernel_in_a_strange_place_is_found() {
        assert_eq!(found(&[("shaders-glsl/mark.comp", "")]).len(), 1);
        assert_eq!(found(&[("shaders-glsl/fly/mark.comp", "")]), ["there is no crate polder-fly"]);
    }
}
