//! Which device to take.

use crate::Error;
use crate::info::{DeviceInfo, DeviceKind};

/// Which device to take.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Selection {
    /// What the environment variable `POLDER_DEVICE` says, an index or a name, else [`Selection::Best`].
    #[default]
    Environment,
    /// The first usable of the discrete ones, of the integrated ones, of the others; never a CPU.
    Best,
    /// By its place in the list.
    Index(usize),
    /// By a part of its name, in any case of letters; `cpu` and `lavapipe` stand for the first CPU device.
    Name(String),
}

impl Selection {
    /// An index if it is a number, a name else.
    pub fn parse(text: &str) -> Self {
        let text = text.trim();
        text.parse().map_or_else(|_| Selection::Name(text.to_owned()), Selection::Index)
    }

    fn from_environment() -> Self {
        match std::env::var("POLDER_DEVICE") {
            Ok(text) if !text.trim().is_empty() => Selection::parse(&text),
            _ => Selection::Best,
        }
    }

    /// Picks from the list. What is asked for by index or name is taken or refused, never replaced.
    pub(crate) fn pick<'a>(&self, devices: &'a [DeviceInfo]) -> Result<&'a DeviceInfo, Error> {
        let none = |wanted: String| Error::NoDevice { wanted, found: listed(devices) };
        let found = match self {
            Selection::Environment => return Selection::from_environment().pick(devices),
            Selection::Best => {
                let rank = |info: &&DeviceInfo| match info.kind {
                    DeviceKind::Discrete => 0,
                    DeviceKind::Integrated => 1,
                    _ => 2,
                };
                let able = devices.iter().filter(|info| info.usable() && info.kind != DeviceKind::Cpu);
                able.min_by_key(rank)
                    .ok_or_else(|| none("is a GPU that can be used, and a CPU has to be asked for".to_owned()))?
            }
            Selection::Index(index) => {
                devices.iter().find(|info| info.index == *index).ok_or_else(|| none(format!("has index {index}")))?
            }
            Selection::Name(name) => {
                let wanted = name.to_lowercase();
                let any_cpu = wanted == "cpu" || wanted == "lavapipe";
                let fits = |info: &&DeviceInfo| {
                    info.name.to_lowercase().contains(&wanted) || (any_cpu && info.kind == DeviceKind::Cpu)
                };
                devices.iter().find(fits).ok_or_else(|| none(format!("has `{name}` in its name")))?
            }
        };
        if found.usable() {
            Ok(found)
        } else {
            Err(Error::Unsupported { device: found.name.clone(), missing: found.missing.join(", ") })
        }
    }
}

fn listed(devices: &[DeviceInfo]) -> String {
    if devices.is_empty() {
        return "none".to_owned();
    }
    let line = |info: &DeviceInfo| {
        let why = if info.usable() { String::new() } else { format!(", lacks {}", info.missing.join(" and ")) };
        format!("{} {} ({:?}{why})", info.index, info.name, info.kind)
    };
    devices.iter().map(line).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::info::Limits;

    fn device(index: usize, name: &str, kind: DeviceKind, missing: &[&str]) -> DeviceInfo {
        let limits = Limits {
            workgroup_invocations: 256,
            workgroups: [65535; 3],
            shared_bytes: 32768,
            argument_bytes: 128,
            buffer_bytes: 1 << 30,
            allocation_bytes: 1 << 30,
            subgroup: 32,
        };
        DeviceInfo {
            index,
            name: name.to_owned(),
            kind,
            api_version: (1, 3, 0),
            driver: String::new(),
            memory_bytes: 1 << 30,
            limits,
            features: Vec::new(),
            missing: missing.iter().map(|text| (*text).to_owned()).collect(),
            physical: ash::vk::PhysicalDevice::default(),
            family: Some(0),
            timestamp_period: 1.0,
            timestamps: true,
            portability_subset: false,
            memory_budget: false,
            cache_name: String::new(),
        }
    }

    #[test]
    fn the_best_is_discrete_and_usable_and_no_cpu() {
        let cpu = device(0, "llvmpipe", DeviceKind::Cpu, &[]);
        let old = device(1, "Old Card", DeviceKind::Discrete, &["synchronization2", "timelineSemaphore"]);
        let small = device(2, "Graphics 620", DeviceKind::Integrated, &[]);
        let big = device(3, "New Card", DeviceKind::Discrete, &[]);
        let picked = |selection: Selection, devices: &[DeviceInfo]| selection.pick(devices).map(|info| info.index);
        let all = [cpu, old, small, big];
        assert_eq!(picked(Selection::Best, &all), Ok(3));
        assert_eq!(picked(Selection::Best, &all[..3]), Ok(2));
        assert!(matches!(picked(Selection::Best, &all[..2]), Err(Error::NoDevice { .. })));
        assert!(matches!(picked(Selection::Best, &[]), Err(Error::NoDevice { found, .. }) if found == "none"));
        // Asked for, a CPU is taken; what lacks something is refused by its name, and no other taken for it.
        for text in ["0", "LLVM", "cpu", "lavapipe"] {
            assert_eq!(picked(Selection::parse(text), &all), Ok(0));
        }
        match picked(Selection::parse("old card"), &all) {
            Err(Error::Unsupported { device, missing }) => {
                assert_eq!((device.as_str(), missing.as_str()), ("Old Card", "synchronization2, timelineSemaphore"));
            }
            other => panic!("{other:?}"),
        }
        assert!(matches!(picked(Selection::Index(4), &all), Err(Error::NoDevice { .. })));
    }
}
