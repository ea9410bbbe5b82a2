//! Partially known processor state: registers, flags and memory, each value a number or unknown. An instruction
//! propagates known values and makes all others unknown, so that the real state is always among the possible ones.
//! Floating-point values are followed only if the result does not depend on the modes of the unit.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::live::RegisterSet;
use super::operation::{
    Address, Arithmetic, Flags, Floating, Offset, Operand, Operation, Rearrangement, Register, Shift, Single,
};

/// Negative, zero, carry, overflow.
pub type ConditionFlags = [Option<bool>; 4];

/// Read-only data of the image.
pub trait Constants {
    /// Byte that is never written.
    fn byte(&self, address: u32) -> Option<u8>;
}

/// Known bytes of writable memory, by words: value and mask of the known bytes.
type Memory = BTreeMap<u32, (u32, u32)>;

/// Partially known state of the processor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    registers: [Option<u32>; 15],
    singles: [Option<u32>; 32],
    flags: ConditionFlags,
    float_flags: ConditionFlags,
    memory: Rc<Memory>,
}

/// Evaluates a condition code; `None` if it is unknown.
pub fn condition_holds(condition: u8, [negative, zero, carry, overflow]: ConditionFlags) -> Option<bool> {
    let and = |one: Option<bool>, other: Option<bool>| match (one, other) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    };
    let not = |flag: Option<bool>| flag.map(|flag| !flag);
    let same = negative.zip(overflow).map(|(negative, overflow)| negative == overflow);
    let positive = match condition >> 1 {
        0 => zero,
        1 => carry,
        2 => negative,
        3 => overflow,
        4 => and(carry, not(zero)),
        5 => same,
        6 => and(not(zero), same),
        _ => return Some(true),
    };
    if condition & 1 == 0 { positive } else { not(positive) }
}

fn joined<T: PartialEq>(one: Option<T>, other: Option<T>) -> Option<T> {
    if one == other { one } else { None }
}

impl Machine {
    /// State in which only the stack pointer is known.
    pub fn with_stack(pointer: u32) -> Self {
        let mut machine = Self {
            registers: [None; 15],
            singles: [None; 32],
            flags: [None; 4],
            float_flags: [None; 4],
            memory: Rc::default(),
        };
        machine.registers[13] = Some(pointer);
        machine
    }

    /// Flags of the core.
    pub fn flags(&self) -> ConditionFlags {
        self.flags
    }

    /// Value of a core register, if known.
    pub fn register(&self, register: Register) -> Option<u32> {
        self.registers.get(usize::from(register)).copied().flatten()
    }

    /// Sets a core register.
    pub fn set(&mut self, register: Register, value: Option<u32>) {
        if let Some(place) = self.registers.get_mut(usize::from(register)) {
            *place = value;
        }
    }

    fn single(&self, single: Single) -> Option<u32> {
        self.singles.get(usize::from(single)).copied().flatten()
    }

    fn set_single(&mut self, single: Single, value: Option<u32>) {
        if let Some(place) = self.singles.get_mut(usize::from(single)) {
            *place = value;
        }
    }

    /// Keeps only the values that another state knows equally.
    pub fn join(&mut self, other: &Self) {
        for (own, others) in self.registers.iter_mut().zip(&other.registers) {
            *own = joined(*own, *others);
        }
        for (own, others) in self.singles.iter_mut().zip(&other.singles) {
            *own = joined(*own, *others);
        }
        for (own, others) in [(&mut self.flags, &other.flags), (&mut self.float_flags, &other.float_flags)] {
            for (own, others) in own.iter_mut().zip(others) {
                *own = joined(*own, *others);
            }
        }
        if Rc::ptr_eq(&self.memory, &other.memory) {
            return;
        }
        let both = self.memory.iter().filter_map(|(address, (value, mask))| {
            let (others, theirs) = other.memory.get(address)?;
            let differs = value ^ others;
            let same = (0..4).map(|byte| 0xff << (8 * byte)).filter(|byte| differs & byte == 0);
            let mask = mask & theirs & same.fold(0, |all, byte| all | byte);
            (mask != 0).then_some((*address, (value & mask, mask)))
        });
        self.memory = Rc::new(both.collect());
    }

    /// Number of values in which two states differ, and which a join would lose.
    pub fn distance(&self, other: &Self) -> usize {
        let differ = |one: &[Option<u32>], other: &[Option<u32>]| one.iter().zip(other).filter(|(a, b)| a != b).count();
        let registers = differ(&self.registers, &other.registers) + differ(&self.singles, &other.singles);
        if Rc::ptr_eq(&self.memory, &other.memory) {
            return registers;
        }
        let alone = |one: &Memory, other: &Memory| {
            one.iter().filter(|(address, value)| other.get(address) != Some(value)).count()
        };
        registers + alone(&self.memory, &other.memory) + alone(&other.memory, &self.memory)
    }

    /// Forgets memory below the stack pointer, so that states that differ only there merge.
    pub fn drop_dead_stack(&mut self, lowest: u32) {
        let Some(pointer) = self.registers[13] else { return };
        if pointer > lowest && self.memory.range(lowest..pointer).next().is_some() {
            Rc::make_mut(&mut self.memory).retain(|address, _| !(lowest..pointer).contains(address));
        }
    }

    /// Forgets the registers that are not live.
    pub fn keep_registers(&mut self, live: RegisterSet) {
        for (register, value) in (0..).zip(&mut self.registers).filter(|(register, _)| *register != 13) {
            if !live.has_core(register) {
                *value = None;
            }
        }
        for (single, value) in (0..).zip(&mut self.singles) {
            if !live.has_single(single) {
                *value = None;
            }
        }
        let [flags, float_flags] = live.has_flags();
        if !flags {
            self.flags = [None; 4];
        }
        if !float_flags {
            self.float_flags = [None; 4];
        }
    }

    fn read(&self, address: Option<u32>, bytes: u8, constants: &dyn Constants) -> Option<u32> {
        let address = address?;
        (0..u32::from(bytes)).try_fold(0, |value, index| {
            let at = address.wrapping_add(index);
            let byte = self.byte(at).or_else(|| constants.byte(at).map(u32::from))?;
            Some(value | byte << (8 * index))
        })
    }

    fn byte(&self, address: u32) -> Option<u32> {
        let (value, mask) = self.memory.get(&(address & !3))?;
        let shift = 8 * (address & 3);
        (mask >> shift & 1 != 0).then_some(value >> shift & 0xff)
    }

    /// Writes memory; an unknown address makes all memory unknown.
    pub fn write(&mut self, address: Option<u32>, bytes: u8, value: Option<u32>) {
        let Some(address) = address else {
            self.memory = Rc::default();
            return;
        };
        let memory = Rc::make_mut(&mut self.memory);
        for index in 0..u32::from(bytes) {
            let at = address.wrapping_add(index);
            let shift = 8 * (at & 3);
            let (old, mask) = memory.get(&(at & !3)).copied().unwrap_or((0, 0));
            let bits = 0xff << shift;
            let byte = value.map(|value| value >> (8 * index) & 0xff);
            let (new, mask) = match byte {
                Some(byte) => (old & !bits | byte << shift, mask | bits),
                None => (old & !bits, mask & !bits),
            };
            if mask == 0 {
                memory.remove(&(at & !3));
            } else {
                memory.insert(at & !3, (new, mask));
            }
        }
    }

    /// Executes an instruction at address `here`; in an `it` block short forms set no flags.
    pub fn execute(&mut self, operation: &Operation, here: u32, inside_it: bool, constants: &dyn Constants) {
        let pc = here.wrapping_add(4);
        let sets = |flags: &Flags| match flags {
            Flags::Kept => false,
            Flags::Set => true,
            Flags::SetOutside => !inside_it,
        };
        match *operation {
            Operation::Nothing | Operation::If(..) | Operation::Unknown => {}
            Operation::Compute { what, to, first, second, ref flags } => {
                let first = if first == 15 { Some(pc & !3) } else { self.register(first) };
                let (second, carry) = self.operand(second, pc);
                let (value, new) = self.compute(what, first, second, carry);
                if let Some(to) = to {
                    self.set(to, value);
                }
                if sets(flags) {
                    self.flags = new;
                }
            }
            Operation::MoveTop(to, top) => {
                self.set(to, self.register(to).map(|value| value & 0xffff | u32::from(top) << 16));
            }
            Operation::Multiply { to, first, second, third, ref flags } => {
                let product = self.register(first).zip(self.register(second)).map(|(one, two)| one.wrapping_mul(two));
                let value = match third {
                    None => product,
                    Some((third, takes)) => product.zip(self.register(third)).map(|(product, third)| match takes {
                        false => third.wrapping_add(product),
                        true => third.wrapping_sub(product),
                    }),
                };
                self.set(to, value);
                if sets(flags) {
                    let [_, _, carry, overflow] = self.flags;
                    self.flags = [value.map(|value| value >> 31 != 0), value.map(|value| value == 0), carry, overflow];
                }
            }
            Operation::MultiplyLong { to, factors, signed, accumulates } => {
                let [one, other] = factors.map(|factor| self.register(factor));
                let product = one.zip(other).map(|(one, other)| match signed {
                    true => (i64::from(one as i32) * i64::from(other as i32)) as u64,
                    false => u64::from(one) * u64::from(other),
                });
                let [low, high] = to.map(|register| self.register(register).map(u64::from));
                let held = low.zip(high).map(|(low, high)| high << 32 | low);
                let sum = if accumulates { product.zip(held).map(|(a, b)| a.wrapping_add(b)) } else { product };
                self.set(to[0], sum.map(|sum| sum as u32));
                self.set(to[1], sum.map(|sum| (sum >> 32) as u32));
            }
            Operation::Divide { to, of, signed } => {
                let [dividend, divisor] = of.map(|register| self.register(register));
                let quotient = dividend.zip(divisor).map(|(dividend, divisor)| match (signed, divisor) {
                    (_, 0) => 0,
                    (true, _) => (dividend as i32).wrapping_div(divisor as i32) as u32,
                    (false, _) => dividend / divisor,
                });
                self.set(to, quotient);
            }
            Operation::Extend { to, from, plus, rotation, bits, signed } => {
                let value = self.register(from).map(|value| {
                    let value = value.rotate_right(rotation.into());
                    extended(value, bits, signed)
                });
                let value = match plus {
                    None => value,
                    Some(plus) => value.zip(self.register(plus)).map(|(value, plus)| value.wrapping_add(plus)),
                };
                self.set(to, value);
            }
            Operation::Extract { to, from, low, width, signed } => {
                self.set(to, self.register(from).map(|value| extended(value >> low, width, signed)));
            }
            Operation::Insert { to, from, low, width } => {
                let mask = (u32::MAX >> (32 - u32::from(width.clamp(1, 32)))) << low;
                let source = from.map_or(Some(0), |from| self.register(from));
                let value = self.register(to).zip(source).map(|(old, source)| old & !mask | source << low & mask);
                self.set(to, value);
            }
            Operation::Rearrange(what, to, from) => {
                let value = self.register(from).and_then(|value| match what {
                    Rearrangement::LeadingZeros => Some(value.leading_zeros()),
                    Rearrangement::ReverseBits => Some(value.reverse_bits()),
                    Rearrangement::ReverseBytes => Some(value.swap_bytes()),
                    Rearrangement::Unfollowed => None,
                });
                self.set(to, value);
            }
            Operation::Load { to, bytes, signed, at } => {
                let value = self.read(self.access_address(&at, pc), bytes, constants);
                let value = value.map(|value| extended(value, 8 * bytes, signed));
                self.move_base(&at);
                self.set(to, value);
            }
            Operation::Store { from, bytes, at, success } => {
                let value = self.register(from);
                self.write(self.access_address(&at, pc), bytes, value);
                self.move_base(&at);
                if let Some(success) = success {
                    self.set(success, None);
                }
            }
            Operation::LoadPair(to, at) => {
                let place = self.access_address(&at, pc);
                let values = [0, 4].map(|offset| self.read(place.map(|p| p.wrapping_add(offset)), 4, constants));
                self.move_base(&at);
                for (to, value) in to.into_iter().zip(values) {
                    self.set(to, value);
                }
            }
            Operation::StorePair(from, at) => {
                let place = self.access_address(&at, pc);
                for (from, offset) in from.into_iter().zip([0, 4]) {
                    self.write(place.map(|place| place.wrapping_add(offset)), 4, self.register(from));
                }
                self.move_base(&at);
            }
            Operation::Multiple { loads, base, list, down, write_back } => {
                let bytes = 4 * list.count_ones();
                let start = self.register(base).map(|start| if down { start.wrapping_sub(bytes) } else { start });
                let mut place = start;
                for register in (0..16).filter(|register| list >> register & 1 != 0) {
                    if !loads {
                        self.write(place, 4, self.register(register));
                    }
                    place = place.map(|place| place.wrapping_add(4));
                }
                if write_back {
                    self.set(base, if down { start } else { place });
                }
                place = start;
                for register in (0..16).filter(|register| loads && list >> register & 1 != 0) {
                    let value = self.read(place, 4, constants);
                    self.set(register, value);
                    place = place.map(|place| place.wrapping_add(4));
                }
            }
            Operation::MultipleSingle { loads, base, first, count, offset, write_back } => {
                let base_now = if base == 15 { Some(pc & !3) } else { self.register(base) };
                for index in 0..count {
                    let moved = offset.wrapping_add(4 * i32::from(index));
                    let place = base_now.map(|base| base.wrapping_add_signed(moved));
                    let single = first.saturating_add(index);
                    if loads {
                        let value = self.read(place, 4, constants);
                        self.set_single(single, value);
                    } else {
                        self.write(place, 4, self.single(single));
                    }
                }
                if let Some(by) = write_back {
                    self.set(base, base_now.map(|base| base.wrapping_add_signed(by)));
                }
            }
            Operation::ToSingle(to, from) => self.set_single(to, self.register(from)),
            Operation::FromSingle(to, from) => self.set(to, self.single(from)),
            Operation::ToSingles(to, from) => {
                for (to, from) in (to..).zip(from) {
                    self.set_single(to, self.register(from));
                }
            }
            Operation::FromSingles(to, from) => {
                for (to, from) in to.into_iter().zip(from..) {
                    self.set(to, self.single(from));
                }
            }
            Operation::SingleConstant(to, value) => self.set_single(to, Some(value)),
            Operation::Float(what, to, of) => {
                let value = float(what, of.map(|single| self.single(single)));
                self.set_single(to, value);
            }
            Operation::CompareSingle(one, other) => {
                let other = other.map_or(Some(0), |other| self.single(other));
                let [one, other] = [self.single(one), other].map(|value| value.and_then(mode_independent));
                self.float_flags = match one.zip(other).map(|(one, other)| one.partial_cmp(&other)) {
                    Some(Some(order)) => [order.is_lt(), order.is_eq(), order.is_ge(), false].map(Some),
                    // An unordered comparison sets carry and overflow; it is not followed.
                    _ => [None; 4],
                };
            }
            Operation::FlagsFromSingle => self.flags = self.float_flags,
            Operation::Clobber(registers) => {
                (0..15).filter(|register| registers >> register & 1 != 0).for_each(|register| self.set(register, None));
            }
        }
    }

    /// Value and carry of the last operand.
    fn operand(&self, operand: Operand, pc: u32) -> (Option<u32>, Option<bool>) {
        let carry = self.flags[2];
        let value = |register: Register| if register == 15 { Some(pc) } else { self.register(register) };
        let (register, shift, amount) = match operand {
            Operand::Constant(value, new) => return (Some(value), new.or(carry)),
            Operand::Shifted(register, shift, amount) => (register, shift, Some(u32::from(amount))),
            Operand::ShiftedBy(register, shift, by) => (register, shift, self.register(by).map(|by| by & 0xff)),
        };
        let Some((value, amount)) = value(register).zip(amount) else {
            // An unshifted register leaves the carry unchanged.
            return (None, if amount == Some(0) { carry } else { None });
        };
        if amount == 0 {
            return (Some(value), carry);
        }
        let wide = u64::from(value);
        match shift {
            Shift::Left if amount > 32 => (Some(0), Some(false)),
            Shift::Left => {
                let shifted = wide << amount;
                (Some(shifted as u32), Some(shifted >> 32 & 1 != 0))
            }
            Shift::Right if amount > 32 => (Some(0), Some(false)),
            Shift::Right => (Some((wide >> amount) as u32), Some(wide >> (amount - 1) & 1 != 0)),
            Shift::Arithmetic => {
                let (amount, signed) = (amount.min(32), i64::from(value as i32));
                (Some((signed >> amount) as u32), Some(signed >> (amount - 1) & 1 != 0))
            }
            Shift::Rotate => {
                let rotated = value.rotate_right(amount % 32);
                (Some(rotated), Some(rotated >> 31 != 0))
            }
            Shift::RotateThroughCarry => (carry.map(|carry| value >> 1 | u32::from(carry) << 31), Some(value & 1 != 0)),
        }
    }

    fn compute(
        &self,
        what: Arithmetic,
        first: Option<u32>,
        second: Option<u32>,
        carry: Option<bool>,
    ) -> (Option<u32>, ConditionFlags) {
        let overflow = self.flags[3];
        let logical = |value: Option<u32>| {
            (value, [value.map(|value| value >> 31 != 0), value.map(|value| value == 0), carry, overflow])
        };
        let both = first.zip(second);
        // Sum as in the manual: x + y + carry.
        let sum = |one: Option<u32>, other: Option<u32>, carry: Option<bool>| {
            let Some(((one, other), carry)) = one.zip(other).zip(carry) else { return (None, [None; 4]) };
            let unsigned = u64::from(one) + u64::from(other) + u64::from(carry);
            let signed = i64::from(one as i32) + i64::from(other as i32) + i64::from(carry);
            let value = unsigned as u32;
            let flags = [value >> 31 != 0, value == 0, u64::from(value) != unsigned, i64::from(value as i32) != signed];
            (Some(value), flags.map(Some))
        };
        let not = |value: Option<u32>| value.map(|value| !value);
        match what {
            // A zero operand makes the conjunction zero.
            Arithmetic::And if first == Some(0) || second == Some(0) => logical(Some(0)),
            Arithmetic::And => logical(both.map(|(one, other)| one & other)),
            Arithmetic::Clear => logical(both.map(|(one, other)| one & !other)),
            Arithmetic::Or => logical(both.map(|(one, other)| one | other)),
            Arithmetic::OrNot => logical(both.map(|(one, other)| one | !other)),
            Arithmetic::Exclusive => logical(both.map(|(one, other)| one ^ other)),
            Arithmetic::Move => logical(second),
            Arithmetic::Not => logical(not(second)),
            Arithmetic::Add => sum(first, second, Some(false)),
            Arithmetic::AddCarry => sum(first, second, self.flags[2]),
            Arithmetic::Subtract => sum(first, not(second), Some(true)),
            Arithmetic::SubtractCarry => sum(first, not(second), self.flags[2]),
            Arithmetic::ReverseSubtract => sum(not(first), second, Some(true)),
        }
    }

    /// Address of an access.
    fn access_address(&self, at: &Address, pc: u32) -> Option<u32> {
        if at.base == 15 {
            let Offset::Constant(by) = at.offset else { return None };
            return Some((pc & !3).wrapping_add_signed(by));
        }
        let base = self.register(at.base);
        if at.before { base.and_then(|base| self.with_offset(base, at.offset)) } else { base }
    }

    fn with_offset(&self, base: u32, offset: Offset) -> Option<u32> {
        match offset {
            Offset::Constant(by) => Some(base.wrapping_add_signed(by)),
            Offset::Register(register, shift) => Some(base.wrapping_add(self.register(register)? << shift)),
        }
    }

    fn move_base(&mut self, at: &Address) {
        if !at.before || at.write_back {
            let moved = self.register(at.base).and_then(|base| self.with_offset(base, at.offset));
            self.set(at.base, moved);
        }
    }
}

/// Lowest bits of a word, zero-extended or sign-extended.
fn extended(value: u32, bits: u8, signed: bool) -> u32 {
    let left = 32 - u32::from(bits.clamp(1, 32));
    match signed {
        true => ((value << left) as i32 >> left) as u32,
        false => value << left >> left,
    }
}

/// Value that is equal in every mode of the unit: zero or normal.
fn mode_independent(bits: u32) -> Option<f32> {
    let value = f32::from_bits(bits);
    (value == 0.0 || value.is_normal()).then_some(value)
}

fn float(what: Floating, [one, other]: [Option<u32>; 2]) -> Option<u32> {
    let result = match what {
        Floating::Copy => return one,
        Floating::Absolute => return one.map(|bits| bits & 0x7fff_ffff),
        Floating::Negate => return one.map(|bits| bits ^ 0x8000_0000),
        Floating::Add => mode_independent(one?)? + mode_independent(other?)?,
        Floating::Subtract => mode_independent(one?)? - mode_independent(other?)?,
        Floating::Multiply => mode_independent(one?)? * mode_independent(other?)?,
        Floating::NegatedMultiply => -(mode_independent(one?)? * mode_independent(other?)?),
        Floating::Divide => mode_independent(one?)? / mode_independent(other?)?,
        Floating::SquareRoot | Floating::MultiplyAccumulate | Floating::Convert => return None,
    };
    mode_independent(result.to_bits()).map(f32::to_bits)
}
