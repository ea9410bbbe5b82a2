//! Proofs about the step that ships, on the emulated board and from the linked image: results equal to the host's in
//! every bit, worst case and upper bound of its instructions, no panic, and the stack that it needs.

pub mod board_model;
pub mod bound;
pub mod costs;
pub mod everything;
pub mod joints;
pub mod roles;
pub mod same_bits;
mod sizes;
pub mod tick;
pub mod worst_case;

use model_core::gears::certificate::Substeps;

/// Method of a tick in which contacts change, from the fields of a measuring image: number of corrected sub-steps and
/// of Verlet sub-steps.
fn parse_substeps<'a>(fields: &mut impl Iterator<Item = &'a str>) -> Option<Substeps> {
    let mut number = || fields.next()?.parse().ok();
    let (corrected, verlet) = (number()?, number()?);
    Some(if verlet > 0 { Substeps::Verlet(verlet) } else { Substeps::Corrected(corrected) })
}
