//! Whether the device's f64 arithmetic gives the CPU's bits.
//!
//! Vulkan does not promise correctly rounded f64 operations. Predicates may use them as a filter only where this test
//! found no difference: sums, products, quotients, the error terms of Knuth's sum and Dekker's product, comparisons, over
//! ordinary, large, tiny, nearly equal, integer and signed-zero numbers, subnormals included. A test proves nothing of
//! what it did not try; the filter's bound is wider than the operations need for that reason.

use crate::Error;
use crate::buffer::Buffer;
use crate::device::Device;
use crate::engine::{Engine, RunOptions};
use crate::info::Feature;
use crate::kernel::Kernel;
use crate::kernels::{SelfTestF64, SelfTestF64Args};
use crate::recording::{Recording, groups_for};
use crate::reference::self_test_f64;
use std::fmt;

/// Pairs of each class.
const PAIRS: usize = 4096;
const RESULTS: usize = 9;
const NAMES: [&str; RESULTS] =
    ["sum", "difference", "product", "quotient", "sum error", "product error", "split high", "split low", "comparison"];
const CLASSES: [&str; 7] =
    ["ordinary", "any exponent", "nearly equal", "integers", "large", "tiny", "zeros and subnormals"];

/// What the f64 self-test found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SelfTest {
    /// The device has no f64.
    NoFloat64,
    /// Every result had the CPU's bits.
    Exact {
        /// Results compared.
        compared: usize,
    },
    /// Some did not.
    Inexact {
        /// Results compared.
        compared: usize,
        /// How many differed, by operation and class of numbers.
        different: Vec<(&'static str, &'static str, usize)>,
        /// The first that did: numbers, the CPU's result, the device's.
        first: [f64; 4],
    },
}

impl SelfTest {
    /// Whether f64 arithmetic may filter predicates.
    pub fn passed(&self) -> bool {
        matches!(self, SelfTest::Exact { .. })
    }
}

impl fmt::Display for SelfTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SelfTest::NoFloat64 => write!(f, "no f64: integers decide alone"),
            SelfTest::Exact { compared } => write!(f, "f64 exact in {compared} results: it filters"),
            SelfTest::Inexact { different, compared, first: [a, b, cpu, device] } => {
                let wrong: usize = different.iter().map(|(_, _, count)| count).sum();
                write!(f, "f64 differs in {wrong} of {compared} results, so integers decide alone:")?;
                for (operation, class, count) in different {
                    write!(f, " {operation} of {class} {count} times;")?;
                }
                write!(f, " first: {a:e}, {b:e} gave {device:e}, not {cpu:e}")
            }
        }
    }
}

impl Device {
    /// Tests f64 arithmetic, once a device.
    pub fn self_test(&self) -> Result<SelfTest, Error> {
        if let Some(known) = self.inner.self_test.get() {
            return Ok(known.clone());
        }
        let found = if self.has(Feature::ShaderFloat64) { test(self)? } else { SelfTest::NoFloat64 };
        Ok(self.inner.self_test.get_or_init(|| found).clone())
    }
}

fn test(device: &Device) -> Result<SelfTest, Error> {
    let pairs: Vec<[f64; 2]> = (0..CLASSES.len()).flat_map(pairs_of).collect();
    let kernel = Kernel::<SelfTestF64>::new(device, &[])?;
    let input = Buffer::<f64>::new(device, "self-test pairs", 2 * pairs.len())?;
    let output = Buffer::<f64>::new(device, "self-test results", RESULTS * pairs.len())?;
    let mut engine = Engine::new(device)?;
    engine.upload(input.view(), bytemuck::cast_slice(&pairs))?;
    let mut recording = Recording::new(device);
    let arguments = SelfTestF64Args { pairs: input.view(), results: output.view(), count: pairs.len() as u32 };
    recording.dispatch(&kernel, groups_for(pairs.len(), kernel.workgroup()[0]), &arguments);
    engine.run(&recording, &RunOptions::default())?;
    let results = engine.download_vec(output.view())?;

    let compared = results.len();
    let mut counts = [[0; RESULTS]; CLASSES.len()];
    let mut first = None;
    for (index, ([a, b], found)) in pairs.iter().zip(results.chunks_exact(RESULTS)).enumerate() {
        for (operation, (expected, found)) in self_test_f64(*a, *b).into_iter().zip(found).enumerate() {
            // Which NaN comes out is nobody's business.
            if expected.to_bits() != found.to_bits() && !(expected.is_nan() && found.is_nan()) {
                counts[index / PAIRS][operation] += 1;
                first.get_or_insert([*a, *b, expected, *found]);
            }
        }
    }
    let Some(first) = first else { return Ok(SelfTest::Exact { compared }) };
    let mut different = Vec::new();
    for (class, counts) in CLASSES.into_iter().zip(counts) {
        let wrong = NAMES.into_iter().zip(counts).filter(|(_, count)| *count > 0);
        different.extend(wrong.map(|(operation, count)| (operation, class, count)));
    }
    Ok(SelfTest::Inexact { compared, different, first })
}

/// A small generator: SplitMix64.
struct Bits(u64);

impl Bits {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number of either sign with an exponent in a range.
    fn float(&mut self, exponents: std::ops::Range<i32>) -> f64 {
        let spread = (exponents.end - exponents.start) as u64;
        let exponent = exponents.start + (self.next() % spread) as i32;
        let bits = self.next();
        f64::from_bits((bits & (1 << 63)) | (((exponent + 1023) as u64) << 52) | (bits >> 12))
    }
}

fn pairs_of(class: usize) -> Vec<[f64; 2]> {
    let mut bits = Bits(class as u64 + 1);
    let special = [0.0, -0.0, f64::MIN_POSITIVE, -f64::MIN_POSITIVE, 5e-324, -5e-324, 1.0, -1.0];
    let mut one = |index: usize| match class {
        0 => [bits.float(-2..2), bits.float(-2..2)],
        1 => [bits.float(-1022..1023), bits.float(-1022..1023)],
        2 => {
            let a = bits.float(-30..30);
            [a, -f64::from_bits(a.to_bits() ^ (bits.next() & 0xff))]
        }
        3 => [(bits.next() >> 34) as f64 - 5e8, (bits.next() >> 34) as f64 - 5e8],
        4 => [bits.float(900..1023), bits.float(-1022..100)],
        5 => [bits.float(-1022..-900), bits.float(-200..100)],
        _ if index < 64 => [special[index / 8], special[index % 8]],
        _ => {
            let subnormal = |bits: u64| f64::from_bits(bits & 0x800f_ffff_ffff_ffff);
            [subnormal(bits.next()), if index.is_multiple_of(2) { subnormal(bits.next()) } else { bits.float(-60..60) }]
        }
    };
    (0..PAIRS).map(&mut one).collect()
}
