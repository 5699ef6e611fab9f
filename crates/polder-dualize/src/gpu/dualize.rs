//! Stage 2 on the device.

use crate::reference::kernels::dualize::words_in_row;

/// Rows and columns of corners of a workgroup that counts.
const COUNT_TILE: [u32; 2] = [256, 8];

/// Words of corners of a grid: bits for 32 corners of a row each.
pub fn words_of([width, height]: [u32; 2]) -> usize {
    words_in_row(width) as usize * (height as usize + 1)
}

/// Workgroups of the kernel that counts.
pub fn count_groups([width, height]: [u32; 2]) -> [u32; 3] {
    [(width + 1).div_ceil(COUNT_TILE[0]), (height + 1).div_ceil(COUNT_TILE[1]), 1]
}
