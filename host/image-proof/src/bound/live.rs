//! Liveness of registers. Dead registers can be forgotten, so that states that differ only in them merge. A register
//! wrongly found dead would only loosen the bound.

use std::collections::BTreeMap;

use petgraph::graph::{DiGraph, NodeIndex};

use super::operation::{
    Address, Arithmetic, Flags, Floating, Offset, Operand, Operation, Register, Shift, Single, operation,
};
use crate::tick::functions::{Function, Functions};
use crate::tick::thumb::Flow;

/// Set of registers and flags, one bit each: 16 core registers, 32 single-precision ones, the flags of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Live(u64);

const FLAGS: Live = Live(1 << 48);
const FLOAT_FLAGS: Live = Live(1 << 49);
/// Registers that may hold a callee's arguments.
const ARGUMENTS: Live = Live(0x200f | 0xffff << 16);
/// Registers that a callee may change.
const SCRATCH: Live = Live(0x500f | 0xffff << 16 | 3 << 48);

impl Live {
    /// All registers.
    pub const ALL: Self = Self(u64::MAX);
    /// No register.
    const NONE: Self = Self(0);

    fn core(register: Register) -> Self {
        Self(1 << (register & 15))
    }

    fn single(single: Single) -> Self {
        Self(1 << (16 + u32::from(single & 31)))
    }

    fn list(list: u16) -> Self {
        Self(list.into())
    }

    /// Set of one single-precision register.
    pub fn of_single(single: Single) -> Self {
        Self::single(single)
    }

    fn row(first: Single, count: u8) -> Self {
        (0..count).fold(Self::NONE, |row, index| row.and(Self::single(first.saturating_add(index))))
    }

    /// Union.
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    fn less(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Returns whether two sets intersect.
    pub fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns whether a core register is in the set.
    pub fn has_core(self, register: Register) -> bool {
        self.0 & Self::core(register).0 != 0
    }

    /// Returns whether a single-precision register is in the set.
    pub fn has_single(self, single: Single) -> bool {
        self.0 & Self::single(single).0 != 0
    }

    /// Returns whether the flags of the core and of the floating-point unit are in the set.
    pub fn has_flags(self) -> [bool; 2] {
        [self.0 & FLAGS.0 != 0, self.0 & FLOAT_FLAGS.0 != 0]
    }
}

/// Registers that an operation uses and sets.
#[derive(Debug, Clone, Copy, Default)]
pub struct Effect {
    /// Used registers.
    pub uses: Live,
    /// Registers that are set as a whole.
    pub sets: Live,
}

/// Registers used and set by an operation.
pub fn effect(operation: &Operation) -> Effect {
    let core = Live::core;
    let address = |at: &Address| match at.offset {
        Offset::Constant(_) => core(at.base),
        Offset::Register(register, _) => core(at.base).and(core(register)),
    };
    let (uses, sets) = match *operation {
        Operation::Nothing | Operation::Unknown => (Live::NONE, Live::NONE),
        Operation::If(..) => (FLAGS, Live::NONE),
        Operation::Compute { what, to, first, second, flags } => {
            let operand = match second {
                Operand::Constant(..) => Live::NONE,
                Operand::Shifted(register, ..) => core(register),
                Operand::ShiftedBy(register, _, by) => core(register).and(core(by)),
            };
            let first = if matches!(what, Arithmetic::Move | Arithmetic::Not) { Live::NONE } else { core(first) };
            let carries = matches!(what, Arithmetic::AddCarry | Arithmetic::SubtractCarry)
                || matches!(second, Operand::Shifted(_, Shift::Carry, _));
            let flags_in = if carries { FLAGS } else { Live::NONE };
            let flags_out = if flags == Flags::Kept { Live::NONE } else { FLAGS };
            (operand.and(first).and(flags_in), to.map_or(Live::NONE, core).and(flags_out))
        }
        Operation::MoveTop(to, _) => (core(to), Live::NONE),
        Operation::Multiply { to, first, second, third, .. } => {
            (core(first).and(core(second)).and(third.map_or(Live::NONE, |(third, _)| core(third))), core(to))
        }
        Operation::MultiplyLong { to, factors, accumulates, .. } => {
            let to = core(to[0]).and(core(to[1]));
            let factors = core(factors[0]).and(core(factors[1]));
            (if accumulates { factors.and(to) } else { factors }, to)
        }
        Operation::Divide { to, of, .. } => (core(of[0]).and(core(of[1])), core(to)),
        Operation::Extend { to, from, plus, .. } => (core(from).and(plus.map_or(Live::NONE, core)), core(to)),
        Operation::Extract { to, from, .. } => (core(from), core(to)),
        Operation::Insert { to, from, .. } => (core(to).and(from.map_or(Live::NONE, core)), Live::NONE),
        Operation::Rearrange(_, to, from) => (core(from), core(to)),
        Operation::Load { to, ref at, .. } => (address(at), core(to)),
        Operation::Store { from, ref at, success, .. } => {
            (address(at).and(core(from)), success.map_or(Live::NONE, core))
        }
        Operation::LoadPair(to, ref at) => (address(at), core(to[0]).and(core(to[1]))),
        Operation::StorePair(from, ref at) => (address(at).and(core(from[0])).and(core(from[1])), Live::NONE),
        Operation::Multiple { loads: true, base, list, .. } => (core(base), Live::list(list)),
        Operation::Multiple { loads: false, base, list, .. } => (core(base).and(Live::list(list)), Live::NONE),
        Operation::MultipleSingle { loads: true, base, first, count, .. } => (core(base), Live::row(first, count)),
        Operation::MultipleSingle { loads: false, base, first, count, .. } => {
            (core(base).and(Live::row(first, count)), Live::NONE)
        }
        Operation::ToSingle(to, from) => (core(from), Live::single(to)),
        Operation::FromSingle(to, from) => (Live::single(from), core(to)),
        Operation::ToSingles(to, from) => (core(from[0]).and(core(from[1])), Live::row(to, 2)),
        Operation::FromSingles(to, from) => (Live::row(from, 2), core(to[0]).and(core(to[1]))),
        Operation::SingleConstant(to, _) => (Live::NONE, Live::single(to)),
        Operation::Float(what, to, of) => {
            let of = Live::single(of[0]).and(Live::single(of[1]));
            (if what == Floating::MultiplyAccumulate { of.and(Live::single(to)) } else { of }, Live::single(to))
        }
        Operation::CompareSingle(one, other) => {
            (Live::single(one).and(other.map_or(Live::NONE, Live::single)), FLOAT_FLAGS)
        }
        Operation::FlagsFromSingle => (FLOAT_FLAGS, FLAGS),
        Operation::Forget(registers) => (Live::NONE, Live::list(registers)),
    };
    Effect { uses, sets }
}

/// Registers used and set by an instruction in its function.
fn effect_at(functions: &Functions, function: &Function, address: u32) -> Effect {
    let (first, second) = functions.halves(address);
    let own = effect(&operation(first, second));
    let flow = function.code.get(&address).map(|instruction| instruction.flow);
    match flow {
        Some(Flow::Next) | None => own,
        // `cbz` and `cbnz` hold their register where a conditional branch holds part of its distance.
        Some(Flow::Branch(_)) if first & 0xf500 == 0xb100 => {
            Effect { uses: Live::core((first & 7) as Register), sets: Live::NONE }
        }
        Some(Flow::Branch(_)) => Effect { uses: FLAGS, sets: Live::NONE },
        Some(Flow::Call(_) | Flow::CallRegister) => Effect { uses: own.uses.and(ARGUMENTS), sets: SCRATCH },
        Some(Flow::Jump(to)) if (function.address..function.end).contains(&to) => own,
        Some(Flow::Table { .. }) => Effect {
            uses: Live::core((first & 15) as Register).and(Live::core((second & 15) as Register)),
            sets: Live::NONE,
        },
        Some(Flow::Jump(_) | Flow::JumpRegister | Flow::Return | Flow::Trap) => {
            Effect { uses: Live::ALL.less(FLAGS).less(FLOAT_FLAGS), sets: Live::NONE }
        }
    }
}

/// Live registers before every instruction of a function.
pub fn registers(
    functions: &Functions,
    function: &Function,
    graph: &DiGraph<u32, ()>,
    nodes: &BTreeMap<u32, NodeIndex>,
    conditions: &BTreeMap<u32, u8>,
) -> BTreeMap<u32, Live> {
    let effect = |address: &u32| {
        let effect = effect_at(functions, function, *address);
        // A conditional instruction may leave all registers unchanged.
        let sets = if conditions.contains_key(address) { Live::NONE } else { effect.sets };
        (*address, Effect { sets, ..effect })
    };
    let effects: BTreeMap<u32, Effect> = nodes.keys().map(effect).collect();
    let mut live: BTreeMap<u32, Live> = nodes.keys().map(|address| (*address, Live::NONE)).collect();
    let mut changes = true;
    while changes {
        changes = false;
        for (address, node) in nodes.iter().rev() {
            let after = graph.neighbors(*node).fold(Live::NONE, |all, next| all.and(live[&graph[next]]));
            let Effect { uses, sets } = effects[address];
            let before = after.less(sets).and(uses);
            changes |= live.insert(*address, before) != Some(before);
        }
    }
    live
}
