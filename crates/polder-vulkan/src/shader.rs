//! What the generated `kernels.rs` of a crate says of each kernel, and how arguments become bytes.

use crate::buffer::{BufferInner, View};
use bytemuck::Pod;
use std::marker::PhantomData;
use std::sync::Arc;

/// How a kernel uses a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Access {
    Read,
    Write,
    ReadWrite,
}

/// An argument that is a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BufferArgument {
    /// Its name in the shader.
    pub name: &'static str,
    /// Where its address lies in the arguments.
    pub offset: u32,
    /// How it is used.
    pub access: Access,
    /// Whether the kernel reaches more than 4 GiB of it.
    pub far: bool,
}

/// One side of a workgroup.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// So many invocations.
    Fixed(u32),
    /// As the specialization constant of this id says.
    Constant(u32),
}

/// A specialization constant of 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Constant {
    /// Its name in the shader; `WORKGROUP` is the first side of the workgroup.
    pub name: &'static str,
    /// Its number.
    pub id: u32,
    /// What it is where nobody sets it.
    pub default: u32,
}

/// SPIR-V and what the engine knows of it.
///
/// The engine trusts it: a kernel reaches memory by address and can do with it what it wants, so code comes from
/// `cargo xtask shaders` and from nowhere else.
#[derive(Debug, Clone, Copy)]
pub struct Code {
    /// The kernel's name.
    pub name: &'static str,
    /// The module, aligned to words.
    pub words: &'static [u8],
    /// The same kernel without f64, for devices that have none or that are not to use it.
    pub without_float64: Option<&'static [u8]>,
    /// Bytes of arguments.
    pub argument_bytes: u32,
    /// The arguments that are buffers.
    pub buffers: &'static [BufferArgument],
    /// Sides of the workgroup.
    pub workgroup: [Side; 3],
    /// Specialization constants.
    pub constants: &'static [Constant],
    /// SPIR-V capabilities.
    pub capabilities: &'static [&'static str],
    /// SHA-256 of the sources.
    pub source_hash: &'static str,
    /// The compiler.
    pub compiler: &'static str,
}

impl Code {
    /// With the words that do without f64, where there are any.
    pub(crate) fn less_float64(self) -> Code {
        Code { words: self.without_float64.unwrap_or(self.words), ..self }
    }

    /// Whether these are those words.
    pub(crate) fn is_less_float64(&self) -> bool {
        self.without_float64.is_some_and(|words| std::ptr::eq(words, self.words))
    }
}

/// A kernel's name as a type; implemented by generated code.
pub trait Shader {
    /// Its typed arguments.
    type Args<'a>;
    /// Its code.
    const CODE: Code;
    /// Writes the arguments where the kernel expects them.
    fn encode<'a>(args: &Self::Args<'a>, encoder: &mut Encoder<'_, 'a>);
}

/// A part of a buffer that a command uses.
#[derive(Clone)]
pub(crate) struct Touch {
    pub(crate) buffer: Arc<BufferInner>,
    pub(crate) start: u64,
    pub(crate) end: u64,
    pub(crate) write: bool,
    /// Whether it may be longer than kernels reach elsewhere.
    pub(crate) far: bool,
}

impl Touch {
    pub(crate) fn of<T: Pod>(view: View<'_, T>, write: bool) -> Self {
        let buffer = Arc::clone(view.buffer);
        Touch { buffer, start: view.start, end: view.start + view.bytes(), write, far: false }
    }
}

/// Takes arguments and notes which memory they let the kernel touch.
pub struct Encoder<'e, 'a> {
    buffers: &'static [BufferArgument],
    bytes: &'e mut Vec<u8>,
    touches: &'e mut Vec<Touch>,
    of: PhantomData<&'a ()>,
}

impl<'e, 'a> Encoder<'e, 'a> {
    pub(crate) fn new(code: &Code, bytes: &'e mut Vec<u8>, touches: &'e mut Vec<Touch>) -> Self {
        bytes.clear();
        bytes.resize(code.argument_bytes as usize, 0);
        Encoder { buffers: code.buffers, bytes, touches, of: PhantomData }
    }

    /// A value that is no buffer.
    pub fn value<T: Pod>(&mut self, offset: usize, value: T) {
        if let Some(place) = self.bytes.get_mut(offset..offset + size_of::<T>()) {
            place.copy_from_slice(bytemuck::bytes_of(&value));
        }
    }

    /// A buffer; nothing if it is left out.
    pub fn buffer<T: Pod>(&mut self, offset: usize, view: impl Into<Option<View<'a, T>>>) {
        let Some(view) = view.into() else { return };
        self.value(offset, view.device_address());
        let argument = self.buffers.iter().find(|argument| argument.offset as usize == offset);
        let access = argument.map_or(Access::ReadWrite, |argument| argument.access);
        let far = argument.is_some_and(|argument| argument.far);
        self.touches.push(Touch { far, ..Touch::of(view, access != Access::Read) });
    }
}

/// Bytes at an address that words may have.
#[doc(hidden)]
#[repr(C, align(4))]
#[derive(Debug)]
pub struct Aligned<Bytes: ?Sized>(pub Bytes);

/// The bytes of a compiled shader, aligned to words.
#[macro_export]
macro_rules! include_spirv {
    ($path:expr) => {{
        static WORDS: &$crate::Aligned<[u8]> = &$crate::Aligned(*include_bytes!($path));
        &WORDS.0
    }};
}
