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

    // Few points are not worth a device.
    let report = text(polder(dir, "triangulate in.node -o out.ele --report json"));
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["backend"], "cpu");
    assert!(report["why"].as_str().unwrap().contains("2000 points"));
}

#[test]
fn constraints_too_and_crossings_are_named_or_split() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    text(polder(dir, "generate segments 500 --segments 50 -o segments.poly"));
    let digest = text(polder(dir, "digest segments.poly --backend cpu"));
    let report = text(polder(dir, "triangulate segments.poly -o out.ele --backend vulkan --report json"));
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["constraints"]["total"], 50);
    let names: Vec<&str> = report["stages"].as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"walk") && names.contains(&"constrain"), "{names:?}");
    assert_eq!(text(polder(dir, "digest segments.poly --backend vulkan")), digest);
    assert_eq!(text(polder(dir, "verify segments.poly out.ele --canonical")), "out.ele: valid and canonical\n");

    std::fs::write(dir.join("x.poly"), "4 2 0 0\n0 0 0\n1 4 0\n2 4 3\n3 0 3\n2 0\n0 0 2\n1 3 1\n0\n").unwrap();
    let by = |backend: &str| polder(dir, &format!("triangulate x.poly -o x.ele --backend {backend}"));
    let (cpu, vulkan) = (by("cpu"), by("vulkan"));
    assert_ne!(vulkan.status.code(), Some(0));
    assert_eq!((vulkan.status.code(), &vulkan.stderr), (cpu.status.code(), &cpu.stderr));
    let split = |backend: &str| {
        text(polder(dir, &format!("triangulate x.poly -o {backend}.ele --crossings split --backend {backend}")));
        std::fs::read(dir.join(format!("{backend}.ele"))).unwrap()
    };
    assert_eq!(split("vulkan"), split("cpu"));
}

/// Faults that the environment asks for, which builds with debug assertions heed.
#[test]
fn what_fails_on_a_device_is_one_line_and_an_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    text(polder(dir, "generate segments 300 --segments 30 -o in.poly"));
    let faulty = |fault: &str, args: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_polder"));
        command.current_dir(dir).env("POLDER_FAULT", fault).args(args.split(' ')).output().unwrap()
    };
    for (fault, kind, line) in [
        ("lose:4", "device_lost", "polder: the device was lost; --backend cpu needs no device\n"),
        ("time_out:4", "device_lost", "polder: the device did not finish within "),
        ("refuse:9", "out_of_memory", "polder: out of device memory: "),
    ] {
        let told = faulty(fault, "triangulate in.poly -o out.ele --backend vulkan");
        let error = String::from_utf8(told.stderr).unwrap();
        assert!(error.starts_with(line) && error.lines().count() == 1, "{fault}: {error}");
        assert_eq!((told.status.code(), told.stdout.len()), (Some(3), 0), "{fault}");
        assert!(!dir.join("out.ele").exists(), "{fault}");
        let told = faulty(fault, "triangulate in.poly -o out.ele --backend vulkan --error-format json");
        let error: Value = serde_json::from_str(std::str::from_utf8(&told.stderr).unwrap()).unwrap();
        assert_eq!(error["kind"], kind);
    }
}
