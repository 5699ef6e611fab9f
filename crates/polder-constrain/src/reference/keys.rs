//! The words by which conflicts are settled.

/// Bits of a sub-constraint's priority: the word of an owned triangle has four more.
pub(super) const OWNER_BITS: u32 = 28;
/// Bits of a pair's priority: the word of a claim has two more.
const CLAIM_BITS: u32 = 30;

/// [`polder_flip::priority`] for numbers of fewer bits: a bijection of them.
const fn scatter(id: u32, bits: u32) -> u32 {
    let mask = (1 << bits) - 1;
    let mut x = id & mask;
    x ^= x >> (bits / 2);
    x = x.wrapping_mul(0x7feb_352d) & mask;
    x ^= x >> (bits / 2 - 1);
    x = x.wrapping_mul(0x846c_a68b) & mask;
    x ^ x >> (bits / 2)
}

/// The order in which sub-constraints own triangles, of 28 bits.
pub const fn owner_priority(sub_constraint: u32) -> u32 {
    scatter(sub_constraint, OWNER_BITS)
}

/// The sub-constraint of an [`owner_priority`].
pub const fn owner_of(priority: u32) -> u32 {
    let mask = (1 << OWNER_BITS) - 1;
    let mut x = priority & mask;
    x ^= x >> 14;
    x = x.wrapping_mul(0x4302_1123) & mask;
    x ^= x >> 13 ^ x >> 26;
    x = x.wrapping_mul(0x1d69_e2a5) & mask;
    x ^ x >> 14
}

/// The key of a pair that may be flipped, by its case (1 to 3) and its first triangle: the lowest case goes first.
pub const fn claim_key(case: u8, triangle: u32) -> u32 {
    ((case - 1) as u32) << CLAIM_BITS | scatter(triangle, CLAIM_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn owners_are_found_again() {
        let top = 1 << OWNER_BITS;
        let some = (0..1 << 20).chain((0..1 << 16).map(|i: u32| i.wrapping_mul(4099) % top)).chain(top - 99..top);
        for id in some {
            assert!(owner_priority(id) < top);
            assert_eq!(owner_of(owner_priority(id)), id);
        }
    }

    #[test]
    fn claims_of_a_lower_case_are_less_and_differ_by_triangle() {
        let mut keys: Vec<u32> = (0..1 << 18).map(|t: u32| claim_key(2, t.wrapping_mul(4093))).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), 1 << 18);
        assert!((0..1000).all(|t| claim_key(1, t) < keys[0] && claim_key(3, t) > keys[keys.len() - 1]));
        assert!((0..1000).all(|t| claim_key(3, t) < u32::MAX));
    }
}
