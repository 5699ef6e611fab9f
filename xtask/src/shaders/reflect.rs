//! What a compiled kernel says of itself: arguments, workgroup, specialization constants, capabilities; and whether its
//! f64 arithmetic may be contracted.

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{BuiltIn, Decoration, ExecutionMode, Op, StorageClass};
use std::collections::BTreeMap;

/// Push constants that every device has.
const PUSH_BYTES: u32 = 128;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Type {
    /// The Rust scalar, and its bytes.
    Scalar(&'static str, u32),
    Array(Box<Type>, u32),
    Struct(Layout),
    /// An address of elements.
    Buffer(Buffer),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub(super) name: String,
    pub(super) members: Vec<Member>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Member {
    pub(super) name: String,
    pub(super) offset: u32,
    pub(super) of: Type,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Buffer {
    pub(super) element: Box<Type>,
    pub(super) read: bool,
    pub(super) written: bool,
    /// May be left out: its block is named `Maybe...`.
    pub(super) optional: bool,
    /// Reached by addresses of 64 bits, and so may have more than 4 GiB.
    pub(super) far: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Constant {
    pub(super) name: String,
    pub(super) id: u32,
    pub(super) default: u32,
}

pub(super) struct Reflection {
    pub(super) arguments: Vec<Member>,
    /// Each side of the workgroup: a number, or the id of a specialization constant.
    pub(super) workgroup: [Side; 3],
    pub(super) constants: Vec<Constant>,
    pub(super) capabilities: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    Fixed(u32),
    Constant(u32),
}

impl Type {
    pub(super) fn bytes(&self) -> u32 {
        match self {
            Type::Scalar(_, bytes) => *bytes,
            Type::Array(of, length) => of.bytes() * length,
            Type::Struct(layout) => layout.bytes(),
            Type::Buffer(_) => 8,
        }
    }

    pub(super) fn align(&self) -> u32 {
        match self {
            Type::Scalar(_, bytes) => *bytes,
            Type::Array(of, _) => of.align(),
            Type::Struct(layout) => layout.members.iter().map(|member| member.of.align()).max().unwrap_or(1),
            Type::Buffer(_) => 8,
        }
    }
}

impl Layout {
    fn bytes(&self) -> u32 {
        let end = self.members.last().map_or(0, |last| last.offset + last.of.bytes());
        let align = self.members.iter().map(|member| member.of.align()).max().unwrap_or(1);
        end.next_multiple_of(align)
    }
}

impl Reflection {
    /// Whether the same kernel, compiled without f64, takes the same arguments and has none.
    pub(super) fn check_second(&self, second: &Reflection, kernel: &str) -> Result<(), String> {
        let expected = self.capabilities.iter().filter(|name| *name != "Float64");
        let same = self.arguments == second.arguments
            && self.workgroup == second.workgroup
            && second.constants.iter().all(|constant| self.constants.contains(constant))
            && second.capabilities.iter().all(|name| expected.clone().any(|expected| expected == name));
        if same {
            Ok(())
        } else {
            Err(format!("{kernel}: without f64 it takes other arguments or needs other features"))
        }
    }
}

struct Reader {
    module: Module,
    kernel: String,
}

pub(super) fn reflect(kernel: &str, words: &[u32]) -> Result<Reflection, String> {
    let module = rspirv::dr::load_words(words).map_err(|error| format!("{kernel}: {error}"))?;
    let reader = Reader { module, kernel: kernel.to_owned() };
    reader.no_contraction()?;
    reader.no_descriptors()?;
    Ok(Reflection {
        arguments: reader.arguments()?,
        workgroup: reader.workgroup()?,
        constants: reader.constants()?,
        capabilities: reader.capabilities(),
    })
}

impl Reader {
    fn failed<T>(&self, why: &str) -> Result<T, String> {
        Err(format!("{}: {why}", self.kernel))
    }

    fn global(&self, id: u32) -> Result<&Instruction, String> {
        let mut found = self.module.types_global_values.iter();
        found.find(|instruction| instruction.result_id == Some(id)).ok_or(format!("{}: no type %{id}", self.kernel))
    }

    /// Every f64 addition, subtraction, multiplication and division must be `precise`: without it compilers fold the
    /// error terms of the predicates to zero.
    fn no_contraction(&self) -> Result<(), String> {
        let wide: Vec<u32> = self.f64_types();
        let body =
            self.module.functions.iter().flat_map(|function| &function.blocks).flat_map(|block| &block.instructions);
        for instruction in body {
            let arithmetic = matches!(instruction.class.opcode, Op::FAdd | Op::FSub | Op::FMul | Op::FDiv);
            let (Some(of), Some(id)) = (instruction.result_type, instruction.result_id) else { continue };
            if arithmetic && wide.contains(&of) && !self.decorated(id, Decoration::NoContraction) {
                let name = instruction.class.opname;
                return self.failed(&format!("Op{name} %{id} of f64 is not `precise`: it may be contracted"));
            }
        }
        Ok(())
    }

    fn f64_types(&self) -> Vec<u32> {
        let mut wide = Vec::new();
        for instruction in &self.module.types_global_values {
            let is_wide = match (instruction.class.opcode, instruction.operands.first()) {
                (Op::TypeFloat, Some(Operand::LiteralBit32(64))) => true,
                (Op::TypeVector, Some(Operand::IdRef(of))) => wide.contains(of),
                _ => false,
            };
            wide.extend(instruction.result_id.filter(|_| is_wide));
        }
        wide
    }

    /// Kernels reach memory by address alone.
    fn no_descriptors(&self) -> Result<(), String> {
        for instruction in &self.module.types_global_values {
            if instruction.class.opcode == Op::Variable
                && let Some(Operand::StorageClass(StorageClass::StorageBuffer | StorageClass::Uniform)) =
                    instruction.operands.first()
            {
                return self.failed("a kernel reaches memory by buffer references, not by bindings");
            }
        }
        Ok(())
    }

    fn decorated(&self, id: u32, wanted: Decoration) -> bool {
        self.decoration(id, wanted).is_some()
    }

    fn decoration(&self, id: u32, wanted: Decoration) -> Option<&[Operand]> {
        self.module.annotations.iter().find_map(|annotation| match annotation.operands.as_slice() {
            [Operand::IdRef(target), Operand::Decoration(found), rest @ ..]
                if annotation.class.opcode == Op::Decorate && *target == id && *found == wanted =>
            {
                Some(rest)
            }
            _ => None,
        })
    }

    fn member_decoration(&self, id: u32, member: u32, wanted: Decoration) -> Option<&[Operand]> {
        self.module.annotations.iter().find_map(|annotation| match annotation.operands.as_slice() {
            [Operand::IdRef(target), Operand::LiteralBit32(index), Operand::Decoration(found), rest @ ..]
                if *target == id && *index == member && *found == wanted =>
            {
                Some(rest)
            }
            _ => None,
        })
    }

    fn name(&self, id: u32) -> Option<String> {
        self.module.debug_names.iter().find_map(|entry| match entry.operands.as_slice() {
            [Operand::IdRef(target), Operand::LiteralString(name)] if *target == id => Some(name.clone()),
            _ => None,
        })
    }

    fn member_name(&self, id: u32, member: u32) -> Result<String, String> {
        let found = self.module.debug_names.iter().find_map(|entry| match entry.operands.as_slice() {
            [Operand::IdRef(target), Operand::LiteralBit32(index), Operand::LiteralString(name)]
                if *target == id && *index == member =>
            {
                Some(name.clone())
            }
            _ => None,
        });
        found.ok_or(format!("{}: member {member} of %{id} has no name", self.kernel))
    }

    fn arguments(&self) -> Result<Vec<Member>, String> {
        for instruction in &self.module.types_global_values {
            if instruction.class.opcode != Op::TypePointer {
                continue;
            }
            if let [Operand::StorageClass(StorageClass::PushConstant), Operand::IdRef(block)] =
                instruction.operands.as_slice()
                && self.global(*block)?.class.opcode == Op::TypeStruct
            {
                let members = self.layout(*block)?.members;
                let bytes = members.last().map_or(0, |last| last.offset + last.of.bytes());
                if bytes > PUSH_BYTES {
                    return self.failed(&format!("{bytes} bytes of arguments; {PUSH_BYTES} are promised by Vulkan"));
                }
                return Ok(members);
            }
        }
        Ok(Vec::new())
    }

    fn layout(&self, id: u32) -> Result<Layout, String> {
        let name = self.name(id).unwrap_or_default();
        let mut members: Vec<Member> = Vec::new();
        for (index, operand) in self.global(id)?.operands.iter().enumerate() {
            let Operand::IdRef(of) = operand else { return self.failed("a struct of no types") };
            let index = index as u32;
            let Some([Operand::LiteralBit32(offset)]) = self.member_decoration(id, index, Decoration::Offset) else {
                return self.failed(&format!("member {index} of {name} has no offset"));
            };
            let member = Member { name: self.member_name(id, index)?, offset: *offset, of: self.of(*of)? };
            // repr(C) puts a member at the first place that its alignment allows.
            let end = members.last().map_or(0, |last| last.offset + last.of.bytes());
            if end.next_multiple_of(member.of.align()) != member.offset {
                return self
                    .failed(&format!("{name}.{} lies elsewhere in Rust: order or pad the members", member.name));
            }
            members.push(member);
        }
        Ok(Layout { name, members })
    }

    fn of(&self, id: u32) -> Result<Type, String> {
        let instruction = self.global(id)?;
        match (instruction.class.opcode, instruction.operands.as_slice()) {
            (Op::TypeInt, [Operand::LiteralBit32(bits), Operand::LiteralBit32(signed)]) => {
                let name = match (bits, signed) {
                    (8, 0) => "u8",
                    (8, _) => "i8",
                    (16, 0) => "u16",
                    (16, _) => "i16",
                    (32, 0) => "u32",
                    (32, _) => "i32",
                    (_, 0) => "u64",
                    _ => "i64",
                };
                Ok(Type::Scalar(name, bits / 8))
            }
            (Op::TypeFloat, [Operand::LiteralBit32(bits), ..]) => {
                Ok(Type::Scalar(if *bits == 64 { "f64" } else { "f32" }, bits / 8))
            }
            (Op::TypeVector, [Operand::IdRef(of), Operand::LiteralBit32(length)]) => {
                Ok(Type::Array(Box::new(self.of(*of)?), *length))
            }
            (Op::TypeArray, [Operand::IdRef(of), Operand::IdRef(length)]) => {
                let element = self.of(*of)?;
                self.stride(id, &element)?;
                let [Operand::LiteralBit32(length)] = self.global(*length)?.operands.as_slice() else {
                    return self.failed("an array of specialized length in memory");
                };
                Ok(Type::Array(Box::new(element), *length))
            }
            (Op::TypeStruct, _) => Ok(Type::Struct(self.layout(id)?)),
            (Op::TypePointer, [Operand::StorageClass(StorageClass::PhysicalStorageBuffer), Operand::IdRef(block)]) => {
                self.buffer(*block).map(Type::Buffer)
            }
            (other, _) => self.failed(&format!("{other:?} cannot be an argument")),
        }
    }

    fn stride(&self, id: u32, element: &Type) -> Result<(), String> {
        match self.decoration(id, Decoration::ArrayStride) {
            Some([Operand::LiteralBit32(stride)]) if *stride == element.bytes() => Ok(()),
            _ => self.failed(&format!("elements of {} bytes are not packed in memory", element.bytes())),
        }
    }

    /// A block of one unbounded array is a buffer of its elements. A block of one other member is a buffer of such members,
    /// which shaders reach by adding to its address. Any other block is a buffer of itself.
    fn buffer(&self, block: u32) -> Result<Buffer, String> {
        let name = self.name(block).unwrap_or_default();
        let read = self.member_decoration(block, 0, Decoration::NonReadable).is_none();
        let written = self.member_decoration(block, 0, Decoration::NonWritable).is_none();
        let operands = &self.global(block)?.operands;
        let (mut element, mut far) = (None, false);
        if let [Operand::IdRef(only)] = operands.as_slice() {
            let array = self.global(*only)?;
            if let (Op::TypeRuntimeArray, [Operand::IdRef(of)]) = (array.class.opcode, array.operands.as_slice()) {
                let found = self.of(*of)?;
                self.stride(*only, &found)?;
                element = Some(found);
            } else {
                (element, far) = (Some(self.of(*only)?), true);
            }
        }
        let element = match element {
            Some(element) => element,
            None => Type::Struct(self.layout(block)?),
        };
        Ok(Buffer { element: Box::new(element), read, written, optional: name.starts_with("Maybe"), far })
    }

    fn workgroup(&self) -> Result<[Side; 3], String> {
        let side = |id: &u32| -> Result<Side, String> {
            let constant = self.global(*id)?;
            match (self.decoration(*id, Decoration::SpecId), constant.operands.as_slice()) {
                (Some([Operand::LiteralBit32(spec)]), _) => Ok(Side::Constant(*spec)),
                (_, [Operand::LiteralBit32(value)]) => Ok(Side::Fixed(*value)),
                _ => self.failed("a workgroup of unknown size"),
            }
        };
        // The built-in constant wins over the execution mode.
        for annotation in &self.module.annotations {
            if let [
                Operand::IdRef(id),
                Operand::Decoration(Decoration::BuiltIn),
                Operand::BuiltIn(BuiltIn::WorkgroupSize),
            ] = annotation.operands.as_slice()
                && let [Operand::IdRef(x), Operand::IdRef(y), Operand::IdRef(z)] = self.global(*id)?.operands.as_slice()
            {
                return Ok([side(x)?, side(y)?, side(z)?]);
            }
        }
        for mode in &self.module.execution_modes {
            match mode.operands.as_slice() {
                [
                    _,
                    Operand::ExecutionMode(ExecutionMode::LocalSize),
                    Operand::LiteralBit32(x),
                    Operand::LiteralBit32(y),
                    Operand::LiteralBit32(z),
                ] => return Ok([Side::Fixed(*x), Side::Fixed(*y), Side::Fixed(*z)]),
                [
                    _,
                    Operand::ExecutionMode(ExecutionMode::LocalSizeId),
                    Operand::IdRef(x),
                    Operand::IdRef(y),
                    Operand::IdRef(z),
                ] => return Ok([side(x)?, side(y)?, side(z)?]),
                _ => {}
            }
        }
        self.failed("no workgroup size")
    }

    /// The specialization constants by id. Id 0 is the width of the workgroup where that is specialized, and GLSL gives
    /// it no name.
    fn constants(&self) -> Result<Vec<Constant>, String> {
        let mut found: BTreeMap<u32, Constant> = BTreeMap::new();
        for instruction in &self.module.types_global_values {
            let Some(id) = instruction.result_id else { continue };
            let Some([Operand::LiteralBit32(spec)]) = self.decoration(id, Decoration::SpecId) else { continue };
            let default = match (instruction.class.opcode, instruction.operands.as_slice()) {
                (Op::SpecConstant, [Operand::LiteralBit32(value)]) => *value,
                (Op::SpecConstantTrue, _) => 1,
                (Op::SpecConstantFalse, _) => 0,
                _ => return self.failed("a specialization constant that is not of 32 bits"),
            };
            let name = if *spec == 0 { Some("WORKGROUP".to_owned()) } else { self.name(id) };
            let name =
                name.filter(|name| !name.is_empty()).ok_or(format!("{}: constant {spec} has no name", self.kernel))?;
            found.insert(*spec, Constant { name, id: *spec, default });
        }
        Ok(found.into_values().collect())
    }

    fn capabilities(&self) -> Vec<String> {
        let mut names: Vec<String> = self
            .module
            .capabilities
            .iter()
            .filter_map(|instruction| match instruction.operands.first() {
                Some(Operand::Capability(capability)) => Some(format!("{capability:?}")),
                _ => None,
            })
            .collect();
        names.sort();
        names
    }
}

#[cfg(test)]
mod tests;
