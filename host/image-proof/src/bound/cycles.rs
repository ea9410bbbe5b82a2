//! Upper bound on the cycles of an instruction on a Cortex-M4: the tables of the Cortex-M4 Technical Reference Manual
//! (r0p1, 3.3.1 and 7.2.3) with the most expensive case of each row. They hold for memory without wait states and
//! without contention: code, tables, stack and state in CCM RAM (STM32F303, STM32G4) or in SRAM. Overlaps that the
//! manual describes (consecutive loads, integer instructions during a division) are not credited, so that the sum is
//! never below the real time.

use super::live::RegisterSet;
use super::operation::{Floating, Operation};
use crate::tick::thumb::Flow;

/// P of the manual: cycles to refill the pipeline after a jump, 1 to 3.
const REFILL: u32 = 3;
/// Integer division, 2 to 12 cycles.
const DIVIDE: u32 = 12;
/// Division or square root in single precision.
const FLOAT_DIVIDE: u32 = 14;
/// Memory access: one cycle, and one for its data.
const ACCESS: u32 = 2;

/// Cycles of an operation that continues with the next instruction.
pub fn of_operation(operation: &Operation) -> u32 {
    match *operation {
        // A barrier waits for pending work, at most for a refill of the pipeline.
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
        // Special registers, saturation, half words: one or two cycles.
        Operation::Clobber(_) => 2,
    }
}

/// Cycles of an instruction that may jump.
pub fn of_jump(flow: Flow, operation: &Operation) -> u32 {
    match flow {
        Flow::Table { .. } => ACCESS + REFILL,
        // A return by a load also takes the cycles of the load.
        Flow::Return | Flow::JumpRegister => of_operation(operation).max(1 + REFILL),
        _ => 1 + REFILL,
    }
}

/// Registers whose value arrives one cycle late for the next instruction.
pub fn late_registers(operation: &Operation) -> RegisterSet {
    match *operation {
        Operation::Float(Floating::Copy | Floating::Absolute | Floating::Negate, ..) => RegisterSet::default(),
        Operation::Float(_, to, _) => RegisterSet::single(to),
        _ => RegisterSet::default(),
    }
}
