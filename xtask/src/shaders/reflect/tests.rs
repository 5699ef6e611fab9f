#![allow(clippy::unwrap_used, reason = "tests")]
use super::*;
use rspirv::binary::Assemble;

/// A committed kernel, changed.
fn changed(kernel: &str, change: impl Fn(&mut Instruction) -> bool) -> Result<Reflection, String> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let path = root.join("crates/polder-vulkan/spv").join(format!("{kernel}.spv"));
    let mut module = rspirv::dr::load_words(super::super::sources::read_words(&path).unwrap()).unwrap();
    module.annotations.retain_mut(|annotation| change(annotation));
    reflect(kernel, &module.assemble())
}

fn decorates(instruction: &Instruction, wanted: Decoration) -> bool {
    instruction.operands.contains(&Operand::Decoration(wanted))
}

#[test]
fn what_a_kernel_says_of_itself() {
    let found = changed("reduce_u64", |_| true).unwrap();
    let names: Vec<&str> = found.arguments.iter().map(|member| member.name.as_str()).collect();
    assert_eq!(names, ["values", "results", "counter", "limit"]);
    let Type::Buffer(values) = &found.arguments[0].of else { panic!() };
    assert_eq!((*values.element.clone(), values.read, values.written), (Type::Scalar("u64", 8), true, false));
    let Type::Buffer(counter) = &found.arguments[2].of else { panic!() };
    assert!(counter.optional && !values.optional);
    assert_eq!(found.workgroup, [Side::Constant(0), Side::Fixed(1), Side::Fixed(1)]);
    let constants: Vec<_> =
        found.constants.iter().map(|found| (found.name.as_str(), found.id, found.default)).collect();
    assert_eq!(constants, [("WORKGROUP", 0, 256), ("OPERATION", 1, 0)]);
    assert!(found.capabilities.contains(&"Int64".to_owned()));
}

#[test]
fn arithmetic_that_may_be_contracted_is_refused() {
    assert!(changed("self_test_f64", |_| true).is_ok());
    let refused = changed("self_test_f64", |found| !decorates(found, Decoration::NoContraction));
    assert!(refused.err().unwrap().contains("precise"));
}

#[test]
fn every_single_operation_has_to_be_precise() {
    let mut count = 0;
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/polder-vulkan/spv/self_test_f64.spv");
    let module = rspirv::dr::load_words(super::super::sources::read_words(&path).unwrap()).unwrap();
    for place in 0..module.annotations.len() {
        if decorates(&module.annotations[place], Decoration::NoContraction) {
            let mut module = module.clone();
            module.annotations.remove(place);
            assert!(reflect("self_test_f64", &module.assemble()).is_err());
            count += 1;
        }
    }
    assert!(count >= 20, "{count}");
}

#[test]
fn a_second_module_takes_the_same_arguments_and_no_f64() {
    let same = |_: &mut Instruction| true;
    let first = changed("self_test_f64", same).unwrap();
    assert!(first.check_second(&changed("self_test_f64", same).unwrap(), "self_test_f64").is_err());
    let mut second = changed("self_test_f64", same).unwrap();
    second.capabilities.retain(|name| name != "Float64");
    assert!(first.check_second(&second, "self_test_f64").is_ok());
    second.arguments.pop();
    assert!(first.check_second(&second, "self_test_f64").is_err());
    let other = Reflection { capabilities: vec!["Int16".to_owned()], ..changed("self_test_f64", same).unwrap() };
    assert!(first.check_second(&other, "self_test_f64").is_err());
}

#[test]
fn members_that_lie_elsewhere_in_rust_are_refused() {
    let refused = changed("copy_words", |found| {
        if let [_, Operand::LiteralBit32(2), Operand::Decoration(Decoration::Offset), Operand::LiteralBit32(offset)] =
            found.operands.as_mut_slice()
        {
            *offset += 4;
        }
        true
    });
    assert!(refused.err().unwrap().contains("lies elsewhere"));
}

#[test]
fn elements_that_are_not_packed_are_refused() {
    let refused = changed("copy_words", |found| {
        if decorates(found, Decoration::ArrayStride)
            && let Some(Operand::LiteralBit32(stride)) = found.operands.last_mut()
        {
            *stride *= 2;
        }
        true
    });
    assert!(refused.err().unwrap().contains("packed"));
}
