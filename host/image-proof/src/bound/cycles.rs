//! Cycles of an instruction on a Cortex-M4, at most: the tables of the Cortex-M4 Technical Reference Manual (r0p1, 3.3.1 and
//! 7.2.3) with the dearest case of each row. They hold for memory without wait states that nobody else uses at that moment:
//! code, tables, stack and state in CCM RAM (STM32F303, STM32G4) or in SRAM. Overlaps that the manual describes (loads one
//! after the other, whole numbers beside a division) are not counted on, so that the sum is no less than the time.

use super::live::Live;
use super::operation::{Floating, Operation};
use crate::tick::thumb::Flow;

/// P of the manual: cycles to refill the pipeline after a jump, 1 to 3.
const REFILL: u32 = 3;
/// A division of whole numbers takes 2 to 12.
const DIVIDE: u32 = 12;
/// A division or a square root of single precision.
const FLOAT_DIVIDE: u32 = 14;
/// An access to memory: one, and one for its data.
const ACCESS: u32 = 2;

/// Cycles of an operation that goes on to the next instruction.
pub fn of(operation: &Operation) -> u32 {
    match *operation {
        // Barriers wait for what is under way, at most as long as the pipeline takes to fill.
        Operation::Nothing => 1 + REFILL,
        Operation::Unknown | Operation::If(..) | Operation::MoveTop(..) => 1,
        Operation::Compute { to: Some(15), .. } => 1 + REFILL,
        Operation::Compute { .. } => 1,
        Operation::Multiply { third, .. } => 1 + u32::from(third.is_some()),
        Operation::MultiplyLong { .. } => 1,
        Operation::Divide { .. } => DIVIDE,
        Operation::Extend { .. } | Operation::Extract { .. } | Operation::Insert { .. } => 1,
        Operation::Rearrange(..) => 1,
        Operation::Load { to: 15, .. } => ACCESS + REFILL,
        Operation::Load { .. } | Operation::Store { .. } => ACCESS,
        Operation::LoadPair(..) | Operation::StorePair(..) => 3,
        Operation::Multiple { list, .. } => 1 + list.count_ones() + if list >> 15 != 0 { REFILL } else { 0 },
        Operation::MultipleSingle { count, .. } => 1 + u32::from(count),
        Operation::ToSingle(..) | Operation::FromSingle(..) => 2,
        Operation::ToSingles(..) | Operation::FromSingles(..) => 2,
        Operation::FlagsFromSingle | Operation::SingleConstant(..) | Operation::CompareSingle(..) => 1,
        Operation::Float(what, ..) => match what {
            Floating::Divide | Floating::SquareRoot => FLOAT_DIVIDE,
            Floating::MultiplyAccumulate => 3,
            _ => 1,
        },
        // Special registers, saturation, halves: one or two.
        Operation::Forget(_) => 2,
    }
}

/// Cycles of an instruction that goes elsewhere.
pub fn of_jump(flow: Flow, operation: &Operation) -> u32 {
    match flow {
        Flow::Table { .. } => ACCESS + REFILL,
        // A return by a load has the load, too.
        Flow::Return | Flow::JumpRegister => of(operation).max(1 + REFILL),
        _ => 1 + REFILL,
    }
}

/// Registers whose value comes a cycle late for the very next instruction.
pub fn late(operation: &Operation) -> Live {
    match *operation {
        Operation::Float(Floating::Copy | Floating::Absolute | Floating::Negate, ..) => Live::default(),
        Operation::Float(_, to, _) => Live::of_single(to),
        _ => Live::default(),
    }
}
