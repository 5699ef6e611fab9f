//! The primitives as a whole.

/// The sum of all words before each, and of all; sums wrap around.
pub fn exclusive_scan(words: &[u32]) -> (Vec<u32>, u32) {
    let mut sum = 0_u32;
    let scanned = words
        .iter()
        .map(|word| {
            let before = sum;
            sum = sum.wrapping_add(*word);
            before
        })
        .collect();
    (scanned, sum)
}

/// The values whose flag is not zero, in order.
pub fn compact(flags: &[u32], values: &[u32]) -> Vec<u32> {
    flags.iter().zip(values).filter(|(flag, _)| **flag != 0).map(|(_, value)| *value).collect()
}

/// The indices of flags that are not zero, in order.
pub fn compact_indices(flags: &[u32]) -> Vec<u32> {
    (0..).zip(flags).filter(|(_, flag)| **flag != 0).map(|(index, _)| index).collect()
}

/// Keys and their values in the order of the lowest `bits` of the keys; equal ones stay in the order that they had.
pub fn sort<K: Copy + Into<u64>>(keys: &[K], values: &[u32], bits: u32) -> (Vec<K>, Vec<u32>) {
    let mask = if bits >= 64 { u64::MAX } else { (1 << bits) - 1 };
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by_key(|index| keys[*index].into() & mask);
    (order.iter().map(|index| keys[*index]).collect(), order.iter().map(|index| values[*index]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_cases() {
        assert_eq!(exclusive_scan(&[]), (vec![], 0));
        assert_eq!(exclusive_scan(&[3, u32::MAX, 5]), (vec![0, 3, 2], 7));
        assert_eq!(compact(&[0, 2, 0, 1], &[10, 11, 12, 13]), [11, 13]);
        assert_eq!(compact_indices(&[0, 2, 0, 1]), [1, 3]);
        assert_eq!(
            sort(&[0x13_u32, 0x02, 0x23, 0x01], &[0, 1, 2, 3], 4),
            (vec![0x01, 0x02, 0x13, 0x23], vec![3, 1, 0, 2])
        );
    }
}
