use crate::AddedVertex;
use sha2::{Digest as _, Sha256};

/// The SHA-256 of a triangulation's triangles in canonical order.
///
/// The hashed bytes are the 16 bytes `polder mesh v1\n\0`, the number of triangles as a little-endian u64, then
/// the three corners of each triangle as little-endian u32. Where vertices were added there follow their number as a
/// little-endian u64, then x and y of each as little-endian f64. The format is stable: the same triangles have the same
/// digest in every version, on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Digest(pub [u8; 32]);

impl Digest {
    pub(crate) fn of(triangles: &[[u32; 3]], added: &[AddedVertex]) -> Self {
        let mut hash = Sha256::new();
        hash.update(b"polder mesh v1\n\0");
        hash.update((triangles.len() as u64).to_le_bytes());
        let mut bytes = Vec::with_capacity(12 * 4096);
        for part in triangles.chunks(4096) {
            bytes.clear();
            bytes.extend(part.iter().flatten().flat_map(|v| v.to_le_bytes()));
            hash.update(&bytes);
        }
        if !added.is_empty() {
            hash.update((added.len() as u64).to_le_bytes());
            added.iter().flat_map(|v| v.position.to_array()).for_each(|x| hash.update((x + 0.0).to_le_bytes()));
        }
        Self(hash.finalize().into())
    }
}

impl std::fmt::Display for Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
