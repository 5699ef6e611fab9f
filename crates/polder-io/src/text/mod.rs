//! Text files: fields of lines, and numbers as text.

mod fields;
mod lines;
mod number;
mod writer;

pub(crate) use fields::Fields;
pub(crate) use lines::Lines;
pub(crate) use number::push_number;
pub(crate) use writer::Text;
