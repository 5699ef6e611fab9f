//! Two ways to one result.

use polder::Output;

/// Two backends gave the same, all of it: the triangulation, and what the reports say of points, constraints and triangles.
///
/// # Panics
///
/// If they did not.
pub fn assert_same_output(name: &str, found: &Output, expected: &Output) {
    let (mesh, wanted) = (&found.triangulation, &expected.triangulation);
    assert_eq!(mesh.digest(), wanted.digest(), "{name}");
    assert_eq!(mesh.constrained_bits(), wanted.constrained_bits(), "{name}");
    assert_eq!(mesh.chains(), wanted.chains(), "{name}");
    assert!(mesh == wanted, "{name}");
    assert_eq!(mesh.neighbors(), wanted.neighbors(), "{name}");
    let [found, expected] = [&found.report, &expected.report];
    assert_eq!(found.points, expected.points, "{name}");
    assert_eq!(found.constraints, expected.constraints, "{name}");
    assert_eq!(found.triangles, expected.triangles, "{name}");
}
