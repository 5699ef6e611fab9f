//! What a generated `kernels.rs` is made of: for each kernel a table, from which types and [`Shader`](crate::Shader) follow.

/// A kernel: a type that names it, a struct of its arguments, and what the engine has to know of it. Written by
/// `cargo xtask shaders`, from the source and the compiled module.
///
/// Arguments are buffers, then values, each with its offset. A buffer is `read`, `written` or `both`; with `maybe_` before
/// that, it may be left out. `integers` says that there is a second module, which does without f64.
#[macro_export]
macro_rules! define_kernel {
    (
        $(#[$about:meta])*
        $kernel:ident($args:ident) = $name:literal $(and $integers:literal)?;
        buffers { $($at:literal: $access:ident $buffer:ident: $view:ty,)* }
        values { $($place:literal: $value:ident: $of:ty,)* }
        argument_bytes $bytes:literal;
        workgroup [$($side:ident($count:literal)),*];
        constants [$($constant:literal($id:literal) = $default:literal),*];
        capabilities [$($capability:literal),*];
        source $hash:literal;
        compiler $compiler:literal;
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy)]
        pub enum $kernel {}

        #[doc = concat!("Arguments of [`", stringify!($kernel), "`].")]
        #[derive(Debug, Clone, Copy)]
        pub struct $args<'a> {
            $(
                #[doc = $crate::define_kernel!(@about $access)]
                pub $buffer: $view,
            )*
            $(
                /// a value
                pub $value: $of,
            )*
        }

        impl $crate::Shader for $kernel {
            type Args<'a> = $args<'a>;

            const CODE: $crate::Code = $crate::Code {
                name: $name,
                words: $crate::include_spirv!(concat!("../spv/", $name, ".spv")),
                without_float64: $crate::define_kernel!(@second $($integers)?),
                argument_bytes: $bytes,
                buffers: &[
                    $($crate::BufferArgument {
                        name: stringify!($buffer),
                        offset: $at,
                        access: $crate::define_kernel!(@access $access),
                        far: $crate::define_kernel!(@far $access),
                    },)*
                ],
                workgroup: [$($crate::Side::$side($count)),*],
                constants: &[$($crate::Constant { name: $constant, id: $id, default: $default }),*],
                capabilities: &[$($capability),*],
                source_hash: $hash,
                compiler: $compiler,
            };

            fn encode<'a>(args: &Self::Args<'a>, encoder: &mut $crate::Encoder<'_, 'a>) {
                $(encoder.buffer($at, args.$buffer);)*
                $(encoder.value($place, args.$value);)*
            }
        }
    };
    (@second) => { None };
    (@second $integers:literal) => { Some($crate::include_spirv!(concat!("../spv/", $integers, ".spv"))) };
    (@about read) => { "read" };
    (@about written) => { "written" };
    (@about both) => { "read and written" };
    (@about maybe_read) => { "read, may be left out" };
    (@about maybe_written) => { "written, may be left out" };
    (@about maybe_both) => { "read and written, may be left out" };
    (@about far_read) => { "read, of any length" };
    (@about far_written) => { "written, of any length" };
    (@about far_both) => { "read and written, of any length" };
    (@access read) => { $crate::Access::Read };
    (@access written) => { $crate::Access::Write };
    (@access both) => { $crate::Access::ReadWrite };
    (@access maybe_read) => { $crate::Access::Read };
    (@access maybe_written) => { $crate::Access::Write };
    (@access maybe_both) => { $crate::Access::ReadWrite };
    (@access far_read) => { $crate::Access::Read };
    (@access far_written) => { $crate::Access::Write };
    (@access far_both) => { $crate::Access::ReadWrite };
    (@far far_read) => { true };
    (@far far_written) => { true };
    (@far far_both) => { true };
    (@far $other:ident) => { false };
}
