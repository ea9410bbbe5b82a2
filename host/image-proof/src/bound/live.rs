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
pub struct RegisterSet(u64);

const FLAGS: RegisterSet = RegisterSet(1 << 48);
const FLOAT_FLAGS: RegisterSet = RegisterSet(1 << 49);
/// Registers that may hold a callee's arguments.
const ARGUMENTS: RegisterSet = RegisterSet(0x200f | 0xffff << 16);
/// Registers that a callee may change.
const CALLER_SAVED: RegisterSet = RegisterSet(0x500f | 0xffff << 16 | 3 << 48);

impl RegisterSet {
    /// All registers.
    pub const ALL: Self = Self(u64::MAX);
    /// No register.
    const NONE: Self = Self(0);

    fn core(register: Register) -> Self {
        Self(1 << (register & 15))
    }

    /// Set of one single-precision register.
    pub fn single(single: Single) -> Self {
        Self(1 << (16 + u32::from(single & 31)))
    }

    fn list(list: u16) -> Self {
        Self(list.into())
    }

    fn consecutive_singles(first: Single, count: u8) -> Self {
        (0..count).fold(Self::NONE, |row, index| row.union(Self::single(first.saturating_add(index))))
    }

    /// Union.
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Returns whether two sets intersect.
    pub fn intersects(self, other: Self) -> bool {
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
    pub uses: RegisterSet,
    /// Registers that are set as a whole.
    pub sets: RegisterSet,
}

/// Registers used and set by an operation.
pub fn effect(operation: &Operation) -> Effect {
    let core = RegisterSet::core;
    let address = |at: &Address| match at.offset {
        Offset::Constant(_) => core(at.base),
        Offset::Register(register, _) => core(at.base).union(core(register)),
    };
    let (uses, sets) = match *operation {
        Operation::Nothing | Operation::Unknown => (RegisterSet::NONE, RegisterSet::NONE),
        Operation::If(..) => (FLAGS, RegisterSet::NONE),
        Operation::Compute { what, to, first, second, flags } => {
            let operand = match second {
                Operand::Constant(..) => RegisterSet::NONE,
                Operand::Shifted(register, ..) => core(register),
                Operand::ShiftedBy(register, _, by) => core(register).union(core(by)),
            };
            let first =
                if matches!(what, Arithmetic::Move | Arithmetic::Not) { RegisterSet::NONE } else { core(first) };
            let carries = matches!(what, Arithmetic::AddCarry | Arithmetic::SubtractCarry)
                || matches!(second, Operand::Shifted(_, Shift::RotateThroughCarry, _));
            let flags_in = if carries { FLAGS } else { RegisterSet::NONE };
            let flags_out = if flags == Flags::Kept { RegisterSet::NONE } else { FLAGS };
            (operand.union(first).union(flags_in), to.map_or(RegisterSet::NONE, core).union(flags_out))
        }
        Operation::MoveTop(to, _) => (core(to), RegisterSet::NONE),
        Operation::Multiply { to, first, second, third, .. } => {
            (core(first).union(core(second)).union(third.map_or(RegisterSet::NONE, |(third, _)| core(third))), core(to))
        }
        Operation::MultiplyLong { to, factors, accumulates, .. } => {
            let to = core(to[0]).union(core(to[1]));
            let factors = core(factors[0]).union(core(factors[1]));
            (if accumulates { factors.union(to) } else { factors }, to)
        }
        Operation::Divide { to, of, .. } => (core(of[0]).union(core(of[1])), core(to)),
        Operation::Extend { to, from, plus, .. } => (core(from).union(plus.map_or(RegisterSet::NONE, core)), core(to)),
        Operation::Extract { to, from, .. } => (core(from), core(to)),
        Operation::Insert { to, from, .. } => (core(to).union(from.map_or(RegisterSet::NONE, core)), RegisterSet::NONE),
        Operation::Rearrange(_, to, from) => (core(from), core(to)),
        Operation::Load { to, ref at, .. } => (address(at), core(to)),
        Operation::Store { from, ref at, success, .. } => {
            (address(at).union(core(from)), success.map_or(RegisterSet::NONE, core))
        }
        Operation::LoadPair(to, ref at) => (address(at), core(to[0]).union(core(to[1]))),
        Operation::StorePair(from, ref at) => {
            (address(at).union(core(from[0])).union(core(from[1])), RegisterSet::NONE)
        }
        Operation::Multiple { loads: true, base, list, .. } => (core(base), RegisterSet::list(list)),
        Operation::Multiple { loads: false, base, list, .. } => {
            (core(base).union(RegisterSet::list(list)), RegisterSet::NONE)
        }
        Operation::MultipleSingle { loads: true, base, first, count, .. } => {
            (core(base), RegisterSet::consecutive_singles(first, count))
        }
        Operation::MultipleSingle { loads: false, base, first, count, .. } => {
            (core(base).union(RegisterSet::consecutive_singles(first, count)), RegisterSet::NONE)
        }
        Operation::ToSingle(to, from) => (core(from), RegisterSet::single(to)),
        Operation::FromSingle(to, from) => (RegisterSet::single(from), core(to)),
        Operation::ToSingles(to, from) => (core(from[0]).union(core(from[1])), RegisterSet::consecutive_singles(to, 2)),
        Operation::FromSingles(to, from) => (RegisterSet::consecutive_singles(from, 2), core(to[0]).union(core(to[1]))),
        Operation::SingleConstant(to, _) => (RegisterSet::NONE, RegisterSet::single(to)),
        Operation::Float(what, to, of) => {
            let of = RegisterSet::single(of[0]).union(RegisterSet::single(of[1]));
            (
                if what == Floating::MultiplyAccumulate { of.union(RegisterSet::single(to)) } else { of },
                RegisterSet::single(to),
            )
        }
        Operation::CompareSingle(one, other) => {
            (RegisterSet::single(one).union(other.map_or(RegisterSet::NONE, RegisterSet::single)), FLOAT_FLAGS)
        }
        Operation::FlagsFromSingle => (FLOAT_FLAGS, FLAGS),
        Operation::Clobber(registers) => (RegisterSet::NONE, RegisterSet::list(registers)),
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
            Effect { uses: RegisterSet::core((first & 7) as Register), sets: RegisterSet::NONE }
        }
        Some(Flow::Branch(_)) => Effect { uses: FLAGS, sets: RegisterSet::NONE },
        Some(Flow::Call(_) | Flow::CallRegister) => Effect { uses: own.uses.union(ARGUMENTS), sets: CALLER_SAVED },
        Some(Flow::Jump(to)) if (function.address..function.end).contains(&to) => own,
        Some(Flow::Table { .. }) => Effect {
            uses: RegisterSet::core((first & 15) as Register).union(RegisterSet::core((second & 15) as Register)),
            sets: RegisterSet::NONE,
        },
        Some(Flow::Jump(_) | Flow::JumpRegister | Flow::Return | Flow::Trap) => {
            Effect { uses: RegisterSet::ALL.without(FLAGS).without(FLOAT_FLAGS), sets: RegisterSet::NONE }
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
) -> BTreeMap<u32, RegisterSet> {
    let effect = |address: &u32| {
        let effect = effect_at(functions, function, *address);
        // A conditional instruction may leave all registers unchanged.
        let sets = if conditions.contains_key(address) { RegisterSet::NONE } else { effect.sets };
        (*address, Effect { sets, ..effect })
    };
    let effects: BTreeMap<u32, Effect> = nodes.keys().map(effect).collect();
    let mut live: BTreeMap<u32, RegisterSet> = nodes.keys().map(|address| (*address, RegisterSet::NONE)).collect();
    let mut changes = true;
    while changes {
        changes = false;
        for (address, node) in nodes.iter().rev() {
            let after = graph.neighbors(*node).fold(RegisterSet::NONE, |all, next| all.union(live[&graph[next]]));
            let Effect { uses, sets } = effects[address];
            let before = after.without(sets).union(uses);
            changes |= live.insert(*address, before) != Some(before);
        }
    }
    live
}
