//! `polder triangulate` and `polder digest` on a Vulkan device.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn polder(dir: &Path, args: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_polder")).current_dir(dir).args(args.split(' ')).output().unwrap()
}

fn text(output: Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_device_gives_the_digest_of_the_cpu_and_says_what_it_did() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    text(polder(dir, "generate gaussian 2000 -o in.node"));
    let digest = text(polder(dir, "digest in.node --backend cpu"));
    assert_eq!(text(polder(dir, "digest in.node --backend vulkan")), digest);
    let report = text(polder(dir, "triangulate in.node -o out.ele --backend vulkan --report json"));
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!((&report["backend"], &report["why"]), (&"vulkan".into(), &"asked for".into()));
    assert!(!report["device"]["name"].as_str().unwrap().is_empty());
    let on_cpu = |stage: &Value| stage["on"] == "cpu";
    assert!(!report["stages"].as_array().unwrap().iter().any(on_cpu));
    assert_eq!(text(polder(dir, "verify in.node out.ele --canonical")), "out.ele: valid and canonical\n");

    // Few points are not worth a device, and segments cannot be inserted there.
    let report = text(polder(dir, "triangulate in.node -o out.ele --report json"));
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["backend"], "cpu");
    assert!(report["why"].as_str().unwrap().contains("2000 points"));
    text(polder(dir, "generate segments 500 --segments 50 -o segments.poly"));
    let refused = polder(dir, "triangulate segments.poly -o out.ele --backend vulkan");
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("constraints"));
}
