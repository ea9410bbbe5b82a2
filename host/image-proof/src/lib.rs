//! What is proved about the step that ships, on the emulated board and from the linked image: that its results are the
//! host's in every bit, what it takes at worst and at most, that it cannot panic and how much stack it needs.

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

/// How a joint's tick goes through contacts that change, as the measuring images say it: sub-steps, Verlet sub-steps or none.
fn parts<'a>(fields: &mut impl Iterator<Item = &'a str>) -> Option<Substeps> {
    let mut number = || fields.next()?.parse().ok();
    let (corrected, verlet) = (number()?, number()?);
    Some(if verlet > 0 { Substeps::Verlet(verlet) } else { Substeps::Corrected(corrected) })
}
