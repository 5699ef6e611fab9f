/// The order in which conflicts are settled: of all that claim a triangle, the one with the least priority gets it.
///
/// A fixed bijection of the 32-bit integers that scatters them (two rounds of multiply and xor-shift), so that two
/// ids never tie, and so that ids that ascend along a line of claims do not wait for each other in turn: where
/// neighbors conflict, a row of raw ids would be served one a round.
///
/// ```
/// assert_eq!([0, 1, 2].map(polder_flip::priority), [0, 1753845952, 3507691905]);
/// ```
#[inline]
pub const fn priority(id: u32) -> u32 {
    let mut x = id;
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

#[cfg(test)]
mod tests {
    use super::priority;

    /// Undoes each step of [`priority`] in turn; the factors are the inverses modulo 2³².
    fn inverse(priority: u32) -> u32 {
        let mut x = priority;
        x ^= x >> 16;
        x = x.wrapping_mul(0x4302_1123);
        x ^= x >> 15 ^ x >> 30;
        x = x.wrapping_mul(0x1d69_e2a5);
        x ^ x >> 16
    }

    #[test]
    fn is_a_bijection() {
        let some = (0..1 << 20).chain((0..1 << 20).map(|i: u32| i.wrapping_mul(4099))).chain(u32::MAX - 99..=u32::MAX);
        for id in some {
            assert_eq!(inverse(priority(id)), id);
        }
    }
}
