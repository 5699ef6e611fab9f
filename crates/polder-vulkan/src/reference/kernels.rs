//! One function for each kernel, of its name; kernels of two widths share one.

/// The sum of each tile of `tile` words; sums wrap around.
pub fn scan_reduce(words: &[u32], tile: usize) -> Vec<u32> {
    words.chunks(tile).map(|tile| tile.iter().fold(0, |sum: u32, word| sum.wrapping_add(*word))).collect()
}

/// The flags of each tile that are not zero.
pub fn compact_count(flags: &[u32], tile: usize) -> Vec<u32> {
    flags.chunks(tile).map(|tile| tile.iter().map(|flag| u32::from(*flag != 0)).sum()).collect()
}

/// The sums before each, and the sum of all.
pub fn scan_sums(sums: &[u32]) -> (Vec<u32>, u32) {
    super::exclusive_scan(sums)
}

/// The sums before each word, on from the scanned sum of each tile.
pub fn scan_tiles(words: &[u32], sums: &[u32], tile: usize) -> Vec<u32> {
    let on_from = |(words, sum): (&[u32], &u32)| {
        let sum = *sum;
        super::exclusive_scan(words).0.into_iter().map(move |before| before.wrapping_add(sum)).collect::<Vec<u32>>()
    };
    words.chunks(tile).zip(sums).flat_map(on_from).collect()
}

/// Writes into `kept`, from the scanned count of each tile on, the values whose flag is not zero; without values, indices.
pub fn compact_write(flags: &[u32], values: Option<&[u32]>, sums: &[u32], tile: usize, kept: &mut [u32]) {
    for (number, (flags, sum)) in flags.chunks(tile).zip(sums).enumerate() {
        let flagged = flags.iter().enumerate().filter(|(_, flag)| **flag != 0);
        for (to, (index, _)) in (*sum as usize..).zip(flagged) {
            let place = number * tile + index;
            kept[to] = values.map_or(place as u32, |values| values[place]);
        }
    }
}

/// One value for each of `groups` workgroups, which take the values in turns of `workgroup`.
pub fn reduce<T: Copy>(values: &[T], groups: usize, workgroup: usize, of_none: T, fold: impl Fn(T, T) -> T) -> Vec<T> {
    let mut results = vec![of_none; groups];
    for (turn, values) in values.chunks(workgroup).enumerate() {
        let result = &mut results[turn % groups];
        *result = values.iter().fold(*result, |a, b| fold(a, *b));
    }
    results
}

fn digit(key: u64, shift: u32, mask: u32) -> usize {
    ((key >> shift) as u32 & mask) as usize
}

/// How often each digit stands in each tile: at `digit * tiles + tile`.
pub fn sort_count<K: Copy + Into<u64>>(keys: &[K], tile: usize, shift: u32, mask: u32) -> Vec<u32> {
    let tiles = keys.len().div_ceil(tile);
    let mut counts = vec![0; 256 * tiles];
    for (number, keys) in keys.chunks(tile).enumerate() {
        for key in keys {
            counts[digit((*key).into(), shift, mask) * tiles + number] += 1;
        }
    }
    counts
}

/// Keys and values at their places: `starts` are the scanned counts.
pub fn sort_move<K: Copy + Into<u64>>(
    keys: &[K],
    values: &[u32],
    starts: &[u32],
    tile: usize,
    shift: u32,
    mask: u32,
) -> (Vec<K>, Vec<u32>) {
    let tiles = keys.len().div_ceil(tile);
    let mut next = starts.to_vec();
    let (mut moved_keys, mut moved_values) = (keys.to_vec(), values.to_vec());
    for (place, (key, value)) in keys.iter().zip(values).enumerate() {
        let to = &mut next[digit((*key).into(), shift, mask) * tiles + place / tile];
        moved_keys[*to as usize] = *key;
        moved_values[*to as usize] = *value;
        *to += 1;
    }
    (moved_keys, moved_values)
}

/// The words.
pub fn copy_words(from: &[u32], to: &mut [u32]) {
    to[..from.len()].copy_from_slice(from);
}

/// The value.
pub fn fill_words(to: &mut [u32], value: u32) {
    to.fill(value);
}

/// Where `counter` is not zero and nothing has halted yet: notes the loop's number, makes all sizes zero, and keeps what
/// those elsewhere were.
pub fn halt_unfinished(
    counter: u32,
    number: u32,
    halt: &mut u32,
    sizes: &mut [[u32; 4]],
    elsewhere: &mut [[u32; 3]],
    saved: &mut [[u32; 3]],
) {
    if counter != 0 && *halt == 0 {
        *halt = number;
        sizes.fill([0; 4]);
        saved.copy_from_slice(elsewhere);
        elsewhere.fill([0; 3]);
    }
}

/// Workgroups for `count` items, at most `limit`, of which one takes `items`.
pub fn dispatch_size(count: u32, limit: u32, items: u32) -> [u32; 3] {
    let [x, y, z] = crate::groups_for(count.min(limit) as usize, items);
    [x, y, z]
}

/// Sum, difference, product, quotient, the error of the sum (Knuth) and of the product (Dekker), the two halves of `a`,
/// and how the numbers compare.
pub fn self_test_f64(a: f64, b: f64) -> [f64; 9] {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let (sum, product) = (a + b, a * b);
    let virtual_b = sum - a;
    let sum_error = (a - (sum - virtual_b)) + (b - virtual_b);
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    let product_error = al * bl - (((product - ah * bh) - al * bh) - ah * bl);
    let comparison = f64::from(u8::from(a < b) + 2 * u8::from(a == b) + 4 * u8::from(a > b));
    [sum, a - b, product, a / b, sum_error, product_error, ah, al, comparison]
}
