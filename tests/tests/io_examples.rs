//! The inputs in examples/data: small, and everything that the command promises of them.
#![allow(clippy::unwrap_used, reason = "tests")]

use polder::verify;
use polder::{Options, triangulate};
use polder_io::Input;
use std::path::Path;

#[test]
fn every_example_is_small_and_triangulates() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/data");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        assert!(std::fs::metadata(&path).unwrap().len() < 500_000, "{}", path.display());
        if path.extension().is_none_or(|extension| extension != "poly") {
            continue;
        }
        count += 1;
        let input = Input::read(&path).unwrap();
        let output = triangulate(&input.pslg, &Options::default()).unwrap();
        let verdict = verify::check_triangulation(&input.pslg, &output.triangulation);
        assert!(verdict.is_canonical(), "{}: {verdict}", path.display());
    }
    assert!(count >= 6);
}
