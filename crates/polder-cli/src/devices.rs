//! `polder devices`.

use crate::args::DevicesArgs;
use crate::failure::Failure;
use crate::job::Job;
use polder::vulkan::{Device, DeviceInfo, DeviceKind, DeviceOptions, Error, Instance, Selection, SelfTest};
use serde_json::{Value, json};
use std::process::ExitCode;

/// What was found out about a device.
struct Found {
    info: DeviceInfo,
    /// Bytes that could be allocated now, and whether its f64 arithmetic is exact; or why it could not be opened.
    opened: Option<Result<(u64, SelfTest), Error>>,
    /// Whether it is the one that polder takes unless told otherwise.
    taken: bool,
}

pub(crate) fn devices(job: &Job, args: &DevicesArgs) -> Result<ExitCode, Failure> {
    job.stage("looking for devices");
    let instance = Instance::load(false).map_err(Failure::of_engine)?;
    let infos = instance.devices().map_err(Failure::of_engine)?;
    let taken = instance.device(&Selection::Environment);
    if infos.is_empty() {
        return Err(Failure::new("unsupported", "Vulkan is installed, but has no device"));
    }
    let found = |info: DeviceInfo| {
        job.stage(&format!("testing {}", info.name));
        let taken = taken.as_ref().is_ok_and(|taken| taken.index == info.index);
        Found { opened: info.usable().then(|| test(&instance, &info)), taken, info }
    };
    let found: Vec<Found> = infos.into_iter().map(found).collect();
    job.done();
    if args.json {
        let devices: Vec<Value> = found.iter().map(in_json).collect();
        let none_taken = taken.as_ref().err().map(Error::to_string);
        crate::print(&crate::json(&json!({ "devices": devices, "none_taken": none_taken }))?)?;
    } else {
        for device in &found {
            crate::print(&told(device))?;
        }
        if let Err(error) = &taken {
            crate::print(&format!("none is taken unless told: {error}"))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn test(instance: &Instance, info: &DeviceInfo) -> Result<(u64, SelfTest), Error> {
    let options = DeviceOptions { selection: Selection::Index(info.index), ..DeviceOptions::default() };
    let device = Device::open_on(instance, &options)?;
    Ok((device.available_memory(), device.self_test()?))
}

/// A few lines for people.
fn told(Found { info, opened, taken }: &Found) -> String {
    let verdict = match opened {
        // The description says what is missing.
        None => String::new(),
        Some(Err(error)) => format!("\n   cannot be used: {error}"),
        Some(Ok((available, verdict))) => {
            format!("\n   can be used: {} MiB are available; {verdict}", available >> 20)
        }
    };
    let mark = if *taken { "\n   taken unless told otherwise" } else { "" };
    format!("{info}{verdict}{mark}")
}

fn kind(info: &DeviceInfo) -> &'static str {
    match info.kind {
        DeviceKind::Discrete => "discrete",
        DeviceKind::Integrated => "integrated",
        DeviceKind::Virtual => "virtual",
        DeviceKind::Cpu => "cpu",
        _ => "other",
    }
}

fn in_json(Found { info, opened, taken }: &Found) -> Value {
    let (major, minor, patch) = info.api_version;
    let limits = &info.limits;
    let opened = match opened {
        None => json!({}),
        Some(Err(error)) => json!({ "error": error.to_string() }),
        Some(Ok((available, verdict))) => json!({
            "available_bytes": available,
            "float64": { "exact": verdict.passed(), "verdict": verdict.to_string() },
        }),
    };
    let mut all = json!({
        "index": info.index,
        "name": info.name,
        "kind": kind(info),
        "driver": info.driver,
        "api_version": format!("{major}.{minor}.{patch}"),
        "usable": opened.get("error").is_none() && info.usable(),
        "taken": taken,
        "missing": info.missing,
        "features": info.features.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "memory_bytes": info.memory_bytes,
        "limits": {
            "buffer_bytes": limits.buffer_bytes,
            "allocation_bytes": limits.allocation_bytes,
            "workgroup_invocations": limits.workgroup_invocations,
            "workgroups": limits.workgroups,
            "shared_bytes": limits.shared_bytes,
            "argument_bytes": limits.argument_bytes,
            "subgroup": limits.subgroup,
        },
    });
    if let (Some(all), Value::Object(opened)) = (all.as_object_mut(), opened) {
        all.extend(opened);
    }
    all
}
