//! `polder devices` on a machine that has one.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

use serde_json::Value;
use std::process::Command;

/// What the command prints, with the environment's `POLDER_DEVICE` or another.
fn devices(args: &[&str], device: Option<&str>) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_polder"));
    command.arg("devices").args(args);
    match device {
        Some("") => command.env_remove("POLDER_DEVICE"),
        Some(device) => command.env("POLDER_DEVICE", device),
        None => &mut command,
    };
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn listed(device: Option<&str>) -> Value {
    serde_json::from_str(&devices(&["--json"], device)).unwrap()
}

#[test]
fn devices_are_listed_with_limits_and_verdict() {
    let all = listed(None);
    let list = all["devices"].as_array().unwrap();
    assert!(!list.is_empty());
    let text = devices(&[], None);
    for (index, device) in list.iter().enumerate() {
        assert_eq!(device["index"], index);
        let name = device["name"].as_str().unwrap();
        assert!(text.contains(name), "{text}");
        assert!(device["api_version"].as_str().unwrap().split('.').count() == 3);
        let usable = device["usable"].as_bool().unwrap();
        let missing = device["missing"].as_array().unwrap();
        if usable {
            assert!(missing.is_empty());
            let float64 = &device["float64"];
            let has = device["features"].as_array().unwrap().iter().any(|feature| feature == "shaderFloat64");
            assert!(!float64["exact"].as_bool().unwrap() || has);
            assert!(text.contains(float64["verdict"].as_str().unwrap()), "{text}");
            assert!(device["available_bytes"].as_u64().unwrap() <= device["memory_bytes"].as_u64().unwrap());
            for limit in ["buffer_bytes", "allocation_bytes", "workgroup_invocations", "shared_bytes", "subgroup"] {
                assert!(device["limits"][limit].as_u64().unwrap() > 0, "{limit}");
            }
        } else {
            assert!(!missing.is_empty() || device["error"].is_string());
            assert!(text.contains("cannot be used"), "{text}");
        }
    }
    // The tests' device is the one that is taken.
    assert_eq!(list.iter().filter(|device| device["taken"] == true).count(), 1);
    assert!(all["none_taken"].is_null() && text.contains("taken unless told otherwise"));
}

#[test]
fn what_is_not_there_is_not_taken() {
    let all = listed(Some("no such device"));
    assert!(all["devices"].as_array().unwrap().iter().all(|device| device["taken"] == false));
    assert!(all["none_taken"].as_str().unwrap().contains("no such device"));
    assert!(devices(&[], Some("no such device")).contains("none is taken"));
    // A CPU device is taken only when asked for.
    let all = listed(Some(""));
    let taken = all["devices"].as_array().unwrap().iter().find(|device| device["taken"] == true);
    assert!(taken.is_none_or(|device| device["kind"] != "cpu"));
}
