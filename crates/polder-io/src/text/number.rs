use std::io::Write;

/// Appends the shortest decimal that reads back as the same bits.
pub(crate) fn push_number(out: &mut Vec<u8>, x: f64) {
    let whole = x as i64;
    let result = if whole as f64 == x && whole.unsigned_abs() < 1 << 53 && !(x == 0.0 && x.is_sign_negative()) {
        write!(out, "{whole}")
    } else {
        write!(out, "{x:?}")
    };
    debug_assert!(result.is_ok(), "writing to memory does not fail");
}
