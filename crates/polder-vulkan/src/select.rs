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
                    .ok_or_else(|| none("the best one (a CPU device has to be asked for)".to_owned()))?
            }
            Selection::Index(index) => {
                devices.iter().find(|info| info.index == *index).ok_or_else(|| none(format!("index {index}")))?
            }
            Selection::Name(name) => {
                let wanted = name.to_lowercase();
                let any_cpu = wanted == "cpu" || wanted == "lavapipe";
                let fits = |info: &&DeviceInfo| {
                    info.name.to_lowercase().contains(&wanted) || (any_cpu && info.kind == DeviceKind::Cpu)
                };
                devices.iter().find(fits).ok_or_else(|| none(format!("name `{name}`")))?
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
