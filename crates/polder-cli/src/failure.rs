//! Why the command ends without its result, for people and for programs.

use crate::args::ErrorFormat;
use serde_json::{Map, Value, json};
use std::path::Path;

/// What went wrong.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: &'static str,
    message: String,
    details: Map<String, Value>,
}

/// Crossing pairs that a sentence names; JSON names all.
const NAMED: usize = 5;

impl Failure {
    pub(crate) fn new(kind: &'static str, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), details: Map::new() }
    }

    fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.details.insert(key.into(), value.into());
        self
    }

    pub(crate) fn io(path: &Path, error: &std::io::Error) -> Self {
        let name =
            if path == Path::new(crate::job::DASH) { "standard output".into() } else { path.display().to_string() };
        Self::new("io", format!("{name}: {error}"))
    }

    /// What the library says of holes, which files number from `first`.
    pub(crate) fn of_domain(error: polder::Error, first: u32) -> Self {
        let (kind, message) = (error.kind(), error.to_string());
        match error {
            polder::Error::SeedOnConstraint { seed } => {
                let hole = seed as u64 + u64::from(first);
                let message = format!("hole {hole} lies on a segment, between regions");
                Self::new(kind, message).with("hole", hole)
            }
            _ => Self::new(kind, message),
        }
    }

    /// An error of the library. Segments are named as the file numbers them, which begins with `first`.
    pub(crate) fn of_library(error: polder::Error, first: u32) -> Self {
        let kind = error.kind();
        match error {
            polder::Error::CrossingConstraints { pairs, truncated } => {
                let number = |i: u32| i as u64 + first as u64;
                let pairs: Vec<[u64; 2]> = pairs.into_iter().map(|pair| pair.map(number)).collect();
                let more = if truncated { "at least " } else { "" };
                let listed: Vec<_> = pairs.iter().take(NAMED).map(|[a, b]| format!("{a} and {b}")).collect();
                let rest = if pairs.len() > NAMED { ", ..." } else { "" };
                let message = match pairs.len() {
                    0 => "segments cross".into(),
                    1 => format!("{more}1 pair of segments crosses: {}", listed[0]),
                    n => format!("{more}{n} pairs of segments cross: {}{rest}", listed.join(", ")),
                };
                Self::new(kind, message).with("pairs", json!(pairs)).with("truncated", truncated).with("first", first)
            }
            polder::Error::Cancelled(_) => Self::new(kind, "cancelled"),
            polder::Error::DeviceLost { what } | polder::Error::OutOfMemory { what } => {
                Self::new(kind, format!("{what}; --backend cpu needs no device"))
            }
            polder::Error::SplitTooLarge { what: what @ "added vertices", limit } => {
                Self::new(kind, format!("more than {limit} {what}; --max-added says how many may be"))
            }
            other => Self::new(kind, other.to_string()),
        }
    }

    /// An error of the compute engine.
    pub(crate) fn of_engine(error: polder::vulkan::Error) -> Self {
        use polder::vulkan::Error;
        let kind = match &error {
            Error::NoVulkan(_) | Error::NoDevice { .. } | Error::Unsupported { .. } | Error::NoValidation => {
                "unsupported"
            }
            Error::OutOfMemory { .. } | Error::TooLarge { .. } => "out_of_memory",
            Error::DeviceLost | Error::Timeout { .. } => "device_lost",
            Error::Cancelled => "cancelled",
            Error::Bound { .. } => "bound_exceeded",
            _ => "internal",
        };
        // Loaders explain themselves in several lines.
        let message = error.to_string();
        Self::new(kind, message.lines().next().unwrap_or_default())
    }

    /// 1 for bad input, 3 for files, device, resources and defects, 4 for cancelled.
    pub(crate) fn exit_code(&self) -> u8 {
        match self.kind {
            "malformed_file"
            | "index_out_of_range"
            | "non_finite_coordinate"
            | "crossing_constraints"
            | "seed_on_constraint"
            | "split_unfinished"
            | "too_large" => 1,
            "cancelled" => 4,
            _ => 3,
        }
    }

    /// Tells it on standard error.
    pub(crate) fn tell(&self, format: ErrorFormat) {
        match format {
            ErrorFormat::Human => eprintln!("polder: {}", self.message),
            ErrorFormat::Json => {
                let mut object = Map::new();
                object.insert("kind".into(), self.kind.into());
                object.insert("message".into(), self.message.clone().into());
                object.extend(self.details.clone());
                eprintln!("{}", Value::Object(object));
            }
        }
    }
}

impl From<polder_io::IoError> for Failure {
    fn from(error: polder_io::IoError) -> Self {
        let failure = Self::new(error.kind(), error.to_string());
        match error.place() {
            Some(polder_io::Place::Line(line)) => failure.with("line", line),
            Some(polder_io::Place::Byte(byte)) => failure.with("byte", byte),
            _ => failure,
        }
    }
}
