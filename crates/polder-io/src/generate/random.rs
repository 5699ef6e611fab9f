use glam::DVec2;
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64;

/// Random numbers whose bits are the same everywhere: integers from PCG, then exact or correctly rounded operations
/// (`+ - * / sqrt`) alone. No sine, logarithm or power, whose last bits differ from platform to platform.
pub(super) struct Random(Pcg64);

/// The family gets a stream of its own, so that two families with one seed have nothing in common.
impl Random {
    pub(super) fn new(family: &str, seed: u64) -> Self {
        // FNV-1a of the family's name.
        let stream =
            family.bytes().fold(0xcbf2_9ce4_8422_2325u64, |h, b| (h ^ b as u64).wrapping_mul(0x0100_0000_01b3));
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        bytes[16..24].copy_from_slice(&stream.to_le_bytes());
        Self(Pcg64::from_seed(bytes))
    }

    pub(super) fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number below `n`, `n > 0`, by multiplication (its bias is below n / 2⁶⁴).
    pub(super) fn below(&mut self, n: u64) -> u64 {
        ((self.bits() as u128 * n as u128) >> 64) as u64
    }

    /// A multiple of 2⁻⁵³ in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * power_of_two(-53)
    }

    pub(super) fn square(&mut self) -> DVec2 {
        DVec2::new(self.unit(), self.unit())
    }

    /// Nearly normal, mean 0, deviation 1, never beyond 6: the sum of twelve uniform numbers, less six.
    pub(super) fn normal(&mut self) -> f64 {
        let sum = (0..6)
            .map(|_| {
                let bits = self.bits();
                (bits >> 32) as i64 + (bits & 0xffff_ffff) as i64
            })
            .sum::<i64>();
        (sum - 6 * ((1 << 32) - 1)) as f64 * power_of_two(-32)
    }

    /// A direction of length 1, up to rounding, without preference.
    pub(super) fn direction(&mut self) -> DVec2 {
        loop {
            let p = 2.0 * self.square() - DVec2::ONE;
            let square = p.x * p.x + p.y * p.y;
            // Two of three tries land in the ring; 10⁻⁴⁰ bounds the chance of a hundred misses.
            if square > 0.01 && square < 1.0 {
                return p / square.sqrt();
            }
        }
    }

    pub(super) fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i as u64 + 1) as usize);
        }
    }
}

/// 2 to the `e`, exactly; `e` from -1022 to 1023.
pub(super) const fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}
