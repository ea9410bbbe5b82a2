//! Effect of an instruction on registers and memory, as far as values can be followed. Control flow is in
//! `tick::thumb`. Encodings are those of the ARMv7-M Architecture Reference Manual, chapters A5 to A7; an encoding
//! missing here is rejected by the bound, never guessed.

/// Core register, 0 to 15.
pub type Register = u8;
/// Single-precision register, 0 to 31; a double occupies two.
pub type Single = u8;

/// Kind of shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shift {
    /// Left shift.
    Left,
    /// Logical right shift.
    Right,
    /// Arithmetic right shift.
    Arithmetic,
    /// Rotation.
    Rotate,
    /// Rotation by one through the carry.
    RotateThroughCarry,
}

/// Last operand of a computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand {
    /// Constant, with the carry of its expansion.
    Constant(u32, Option<bool>),
    /// Register shifted by a constant; a shift by zero keeps the carry.
    Shifted(Register, Shift, u8),
    /// Register shifted by another register.
    ShiftedBy(Register, Shift, Register),
}

/// Kind of computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Arithmetic {
    And,
    Clear,
    Or,
    OrNot,
    Exclusive,
    Add,
    AddCarry,
    SubtractCarry,
    Subtract,
    ReverseSubtract,
    Move,
    Not,
}

/// Address of a memory access.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address {
    /// Base register; for 15, the address of the next instruction but one, rounded down to a word.
    pub base: Register,
    /// Offset from the base.
    pub offset: Offset,
    /// True if the offset is added before the access.
    pub before: bool,
    /// True if the sum is written back to the base.
    pub write_back: bool,
}

/// Offset from a base.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offset {
    /// Constant offset.
    Constant(i32),
    /// Register times a power of two.
    Register(Register, u8),
}

/// Rearrangement of a 32-bit word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Rearrangement {
    LeadingZeros,
    ReverseBits,
    ReverseBytes,
    /// Rearrangement whose value is not followed.
    Unfollowed,
}

/// Arithmetic of single-precision registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Floating {
    Add,
    Subtract,
    Multiply,
    /// Product, negated.
    NegatedMultiply,
    /// Product added to the destination.
    MultiplyAccumulate,
    Divide,
    SquareRoot,
    Absolute,
    Negate,
    Copy,
    Convert,
}

/// Effect of an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// No effect that is followed: hints, barriers, branches.
    Nothing,
    /// Start of an `it` block: first condition and mask.
    If(u8, u8),
    /// Computation; without a destination it only sets flags.
    Compute {
        /// Kind of computation.
        what: Arithmetic,
        /// Destination.
        to: Option<Register>,
        /// First operand.
        first: Register,
        /// Second operand.
        second: Operand,
        /// Effect on the flags.
        flags: Flags,
    },
    /// Replacement of a register's upper half.
    MoveTop(Register, u16),
    /// to = first * second, plus or minus a third register.
    Multiply {
        /// Destination.
        to: Register,
        /// First factor.
        first: Register,
        /// Second factor.
        second: Register,
        /// Third register; the product is added to it, or subtracted from it (`true`).
        third: Option<(Register, bool)>,
        /// Effect on the flags.
        flags: Flags,
    },
    /// Long multiplication into two registers.
    MultiplyLong {
        /// Destination, low and high.
        to: [Register; 2],
        /// Factors.
        factors: [Register; 2],
        /// True for signed factors.
        signed: bool,
        /// True if the product is added to the destination.
        accumulates: bool,
    },
    /// to = first / second.
    Divide {
        /// Destination.
        to: Register,
        /// Dividend and divisor.
        of: [Register; 2],
        /// True for signed operands.
        signed: bool,
    },
    /// Byte or half word, rotated, extended, and added to a register.
    Extend {
        /// Destination.
        to: Register,
        /// Source.
        from: Register,
        /// Register that is added.
        plus: Option<Register>,
        /// Rotation to the right [bit].
        rotation: u8,
        /// Width, 8 or 16 [bit].
        bits: u8,
        /// True for sign extension.
        signed: bool,
    },
    /// Bit field of a register (`ubfx`, `sbfx`).
    Extract {
        /// Destination.
        to: Register,
        /// Source.
        from: Register,
        /// Lowest bit.
        low: u8,
        /// Width [bit].
        width: u8,
        /// True for sign extension.
        signed: bool,
    },
    /// Bit field inserted into a register (`bfi`), zeros without a source (`bfc`).
    Insert {
        /// Destination.
        to: Register,
        /// Source.
        from: Option<Register>,
        /// Lowest bit.
        low: u8,
        /// Width [bit].
        width: u8,
    },
    /// Rearranged word: kind, destination, source.
    Rearrange(Rearrangement, Register, Register),
    /// Load of one register.
    Load {
        /// Destination.
        to: Register,
        /// Size, 1, 2 or 4 [byte].
        bytes: u8,
        /// True for sign extension.
        signed: bool,
        /// Address.
        at: Address,
    },
    /// Store of one register.
    Store {
        /// Source.
        from: Register,
        /// Size, 1, 2 or 4 [byte].
        bytes: u8,
        /// Address.
        at: Address,
        /// Register for the result of an exclusive store.
        success: Option<Register>,
    },
    /// Load of two words.
    LoadPair([Register; 2], Address),
    /// Store of two words.
    StorePair([Register; 2], Address),
    /// Load or store of a list of registers.
    Multiple {
        /// True for a load.
        loads: bool,
        /// Base register.
        base: Register,
        /// Bit mask of the registers.
        list: u16,
        /// True if the addresses lie below the base.
        down: bool,
        /// True if the base is updated.
        write_back: bool,
    },
    /// Load or store of consecutive single-precision registers.
    MultipleSingle {
        /// True for a load.
        loads: bool,
        /// Base register.
        base: Register,
        /// First register.
        first: Single,
        /// Number of registers.
        count: u8,
        /// Offset from the base, before the access.
        offset: i32,
        /// Change of the base, if it is updated.
        write_back: Option<i32>,
    },
    /// Core register copied to a single-precision one.
    ToSingle(Single, Register),
    /// Single-precision register copied to a core register.
    FromSingle(Register, Single),
    /// Two core registers copied to two single-precision ones.
    ToSingles(Single, [Register; 2]),
    /// Two single-precision registers copied to two core registers.
    FromSingles([Register; 2], Single),
    /// Constant for a single-precision register, by its bits.
    SingleConstant(Single, u32),
    /// Single-precision arithmetic: kind, destination, operands.
    Float(Floating, Single, [Single; 2]),
    /// Comparison with another register or with zero.
    CompareSingle(Single, Option<Single>),
    /// Copy of the floating-point flags to the core's flags.
    FlagsFromSingle,
    /// Registers, by a mask, whose values become unknown.
    Clobber(u16),
    /// Unknown instruction.
    Unknown,
}

/// Effect of an instruction on the flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flags {
    /// Flags unchanged.
    Kept,
    /// Flags set.
    Set,
    /// Flags set outside of an `it` block only.
    SetOutside,
}

/// Decodes an instruction; `second` is the half word after the first.
pub fn operation(first: u16, second: u16) -> Operation {
    if first >> 11 < 0b11101 { decode_short(first) } else { decode_long(first, second) }
}

fn bits(value: u16, low: u32, count: u32) -> u8 {
    (value >> low & ((1 << count) - 1)) as u8
}

fn compute(what: Arithmetic, to: Register, first: Register, second: Operand, flags: Flags) -> Operation {
    Operation::Compute { what, to: Some(to), first, second, flags }
}

fn compare(what: Arithmetic, first: Register, second: Operand) -> Operation {
    Operation::Compute { what, to: None, first, second, flags: Flags::Set }
}

fn unshifted(register: Register) -> Operand {
    Operand::Shifted(register, Shift::Left, 0)
}

/// Shift by a constant, from its encoding.
fn shifted(register: Register, kind: u8, amount: u8) -> Operand {
    match (kind, amount) {
        (0, _) => Operand::Shifted(register, Shift::Left, amount),
        (1, 0) => Operand::Shifted(register, Shift::Right, 32),
        (1, _) => Operand::Shifted(register, Shift::Right, amount),
        (2, 0) => Operand::Shifted(register, Shift::Arithmetic, 32),
        (2, _) => Operand::Shifted(register, Shift::Arithmetic, amount),
        (_, 0) => Operand::Shifted(register, Shift::RotateThroughCarry, 1),
        _ => Operand::Shifted(register, Shift::Rotate, amount),
    }
}

fn shift_kind(code: u8) -> Shift {
    [Shift::Left, Shift::Right, Shift::Arithmetic, Shift::Rotate][usize::from(code & 3)]
}

fn at(base: Register, offset: i32) -> Address {
    Address { base, offset: Offset::Constant(offset), before: true, write_back: false }
}

fn decode_short(first: u16) -> Operation {
    use Arithmetic::{Add, AddCarry, And, Clear, Exclusive, Move, Not, Or, ReverseSubtract, Subtract, SubtractCarry};
    let (low, middle, high) = (bits(first, 0, 3), bits(first, 3, 3), bits(first, 6, 3));
    let (eight, upper) = (u32::from(first & 0xff), bits(first, 8, 3));
    let five = i32::from(bits(first, 6, 5));
    let constant = |value: u32| Operand::Constant(value, None);
    let outside = Flags::SetOutside;
    match first >> 11 {
        code @ 0..=2 => compute(Move, low, 0, shifted(middle, code as u8, bits(first, 6, 5)), outside),
        3 => {
            let second = if first & 0x400 == 0 { unshifted(high) } else { constant(high.into()) };
            compute(if first & 0x200 == 0 { Add } else { Subtract }, low, middle, second, outside)
        }
        4 => compute(Move, upper, 0, constant(eight), outside),
        5 => compare(Subtract, upper, constant(eight)),
        6 => compute(Add, upper, upper, constant(eight), outside),
        7 => compute(Subtract, upper, upper, constant(eight), outside),
        8 if first & 0x400 == 0 => {
            let by = |kind| compute(Move, low, 0, Operand::ShiftedBy(low, kind, middle), outside);
            let own = |what| compute(what, low, low, unshifted(middle), outside);
            match bits(first, 6, 4) {
                0 => own(And),
                1 => own(Exclusive),
                2 => by(Shift::Left),
                3 => by(Shift::Right),
                4 => by(Shift::Arithmetic),
                5 => own(AddCarry),
                6 => own(SubtractCarry),
                7 => by(Shift::Rotate),
                8 => compare(And, low, unshifted(middle)),
                9 => compute(ReverseSubtract, low, middle, constant(0), outside),
                10 => compare(Subtract, low, unshifted(middle)),
                11 => compare(Add, low, unshifted(middle)),
                12 => own(Or),
                13 => Operation::Multiply { to: low, first: low, second: middle, third: None, flags: outside },
                14 => own(Clear),
                _ => compute(Not, low, 0, unshifted(middle), outside),
            }
        }
        8 => {
            let (to, from) = (low | bits(first, 7, 1) << 3, bits(first, 3, 4));
            match bits(first, 8, 2) {
                0 => compute(Add, to, to, unshifted(from), Flags::Kept),
                1 => compare(Subtract, to, unshifted(from)),
                2 => compute(Move, to, 0, unshifted(from), Flags::Kept),
                // bx, blx
                _ => Operation::Nothing,
            }
        }
        9 => Operation::Load { to: upper, bytes: 4, signed: false, at: at(15, 4 * eight as i32) },
        10 | 11 => {
            let at = Address { base: middle, offset: Offset::Register(high, 0), before: true, write_back: false };
            let load = |bytes, signed| Operation::Load { to: low, bytes, signed, at };
            let store = |bytes| Operation::Store { from: low, bytes, at, success: None };
            match bits(first, 9, 3) {
                0 => store(4),
                1 => store(2),
                2 => store(1),
                3 => load(1, true),
                4 => load(4, false),
                5 => load(2, false),
                6 => load(1, false),
                _ => load(2, true),
            }
        }
        code @ 12..=19 => {
            let (to, at, bytes) = match code {
                12 | 13 => (low, at(middle, 4 * five), 4),
                14 | 15 => (low, at(middle, five), 1),
                16 | 17 => (low, at(middle, 2 * five), 2),
                _ => (upper, at(13, 4 * eight as i32), 4),
            };
            match code % 2 {
                0 => Operation::Store { from: to, bytes, at, success: None },
                _ => Operation::Load { to, bytes, signed: false, at },
            }
        }
        // adr: `machine` resolves register 15.
        20 => compute(Add, upper, 15, constant(4 * eight), Flags::Kept),
        21 => compute(Add, upper, 13, constant(4 * eight), Flags::Kept),
        22 | 23 => miscellaneous(first),
        24 | 25 => {
            let (base, list) = (upper, first & 0xff);
            let loads = first & 0x800 != 0;
            let write_back = !loads || list & 1 << base == 0;
            Operation::Multiple { loads, base, list, down: false, write_back }
        }
        _ => Operation::Nothing,
    }
}

fn miscellaneous(first: u16) -> Operation {
    let (low, middle) = (bits(first, 0, 3), bits(first, 3, 3));
    let words = 4 * u32::from(first & 0x7f);
    let stack = |what| compute(what, 13, 13, Operand::Constant(words, None), Flags::Kept);
    let extend = |bits, signed| Operation::Extend { to: low, from: middle, plus: None, rotation: 0, bits, signed };
    let multiple = |loads, more| Operation::Multiple {
        loads,
        base: 13,
        list: first & 0xff | (first & 0x100) << more,
        down: !loads,
        write_back: true,
    };
    match bits(first, 4, 8) {
        code if code & 0xf8 == 0 => stack(Arithmetic::Add),
        code if code & 0xf8 == 8 => stack(Arithmetic::Subtract),
        0x20..=0x23 => extend(16, true),
        0x24..=0x27 => extend(8, true),
        0x28..=0x2b => extend(16, false),
        0x2c..=0x2f => extend(8, false),
        0x40..=0x5f => multiple(false, 6),
        0xc0..=0xdf => multiple(true, 7),
        0xa0..=0xa3 => Operation::Rearrange(Rearrangement::ReverseBytes, low, middle),
        0xa4..=0xaf => Operation::Rearrange(Rearrangement::Unfollowed, low, middle),
        0xf0..=0xff if first & 0xf != 0 => Operation::If(bits(first, 4, 4), bits(first, 0, 4)),
        // cbz and cbnz, whose register `longest` reads; cps, hints. A breakpoint is a trap in `tick::thumb`.
        _ => Operation::Nothing,
    }
}

fn decode_long(first: u16, second: u16) -> Operation {
    match first {
        _ if first & 0xfe40 == 0xe800 => {
            let list = second & 0xdfff;
            let (down, loads) = (first & 0x180 == 0x100, first & 0x10 != 0);
            Operation::Multiple { loads, base: bits(first, 0, 4), list, down, write_back: first & 0x20 != 0 }
        }
        _ if first & 0xfe40 == 0xe840 => double_or_exclusive(first, second),
        _ if first & 0xfe00 == 0xea00 => {
            let amount = bits(second, 12, 3) << 2 | bits(second, 6, 2);
            data_processing(first, second, shifted(bits(second, 0, 4), bits(second, 4, 2), amount))
        }
        _ if first & 0xec00 == 0xec00 => floating(first, second),
        _ if first & 0xf800 == 0xf000 && second & 0x8000 != 0 => control(first, second),
        _ if first & 0xfa00 == 0xf000 => {
            let (value, carry) = expand(first, second);
            data_processing(first, second, Operand::Constant(value, carry))
        }
        _ if first & 0xfa00 == 0xf200 => plain_constant(first, second),
        _ if first & 0xfe00 == 0xf800 => load_or_store(first, second),
        _ if first & 0xff00 == 0xfa00 => register_processing(first, second),
        _ if first & 0xff00 == 0xfb00 => multiply(first, second),
        _ => Operation::Unknown,
    }
}

/// Double and exclusive accesses; table branches are in `tick::frame`.
fn double_or_exclusive(first: u16, second: u16) -> Operation {
    let (base, rt, rd) = (bits(first, 0, 4), bits(second, 12, 4), bits(second, 8, 4));
    let offset = 4 * i32::from(second & 0xff);
    let load = |bytes, offset| Operation::Load { to: rt, bytes, signed: false, at: at(base, offset) };
    let store =
        |bytes, offset, success| Operation::Store { from: rt, bytes, at: at(base, offset), success: Some(success) };
    match first & 0xfff0 {
        0xe840 => store(4, offset, rd),
        0xe850 => load(4, offset),
        0xe8c0 if second & 0xe0 == 0x40 => store(1 + bits(second, 4, 1), 0, bits(second, 0, 4)),
        0xe8d0 if second & 0xe0 == 0x40 => load(1 + bits(second, 4, 1), 0),
        0xe8d0 if second & 0xe0 == 0 => Operation::Nothing,
        _ if first & 0x120 == 0 => Operation::Unknown,
        _ => {
            let offset = if first & 0x80 == 0 { -offset } else { offset };
            let (before, write_back) = (first & 0x100 != 0, first & 0x20 != 0);
            let at = Address { base, offset: Offset::Constant(offset), before, write_back };
            if first & 0x10 == 0 { Operation::StorePair([rt, rd], at) } else { Operation::LoadPair([rt, rd], at) }
        }
    }
}

/// Data processing with a shifted register or an expanded constant.
fn data_processing(first: u16, second: u16, operand: Operand) -> Operation {
    use Arithmetic::{
        Add, AddCarry, And, Clear, Exclusive, Move, Not, Or, OrNot, ReverseSubtract, Subtract, SubtractCarry,
    };
    let (base, to, sets) = (bits(first, 0, 4), bits(second, 8, 4), first & 0x10 != 0);
    let flags = if sets { Flags::Set } else { Flags::Kept };
    let only_compares = to == 15 && sets;
    let what = match bits(first, 5, 4) {
        0 => And,
        1 => Clear,
        2 if base == 15 => Move,
        2 => Or,
        3 if base == 15 => Not,
        3 => OrNot,
        4 => Exclusive,
        // Packing of half words is not followed.
        6 => return Operation::Clobber(1 << to),
        8 => Add,
        10 => AddCarry,
        11 => SubtractCarry,
        13 => Subtract,
        14 => ReverseSubtract,
        _ => return Operation::Unknown,
    };
    match what {
        And | Exclusive | Add | Subtract if only_compares => compare(what, base, operand),
        _ => compute(what, to, base, operand, flags),
    }
}

/// Value and carry of a modified 12-bit constant.
fn expand(first: u16, second: u16) -> (u32, Option<bool>) {
    let code = u32::from(bits(first, 10, 1)) << 11 | u32::from(bits(second, 12, 3)) << 8 | u32::from(second & 0xff);
    let byte = code & 0xff;
    match code >> 8 {
        0 => (byte, None),
        1 => (byte << 16 | byte, None),
        2 => (byte << 24 | byte << 8, None),
        3 => (byte << 24 | byte << 16 | byte << 8 | byte, None),
        _ => {
            let value = (byte | 0x80).rotate_right(code >> 7);
            (value, Some(value >> 31 != 0))
        }
    }
}

fn plain_constant(first: u16, second: u16) -> Operation {
    let (base, to) = (bits(first, 0, 4), bits(second, 8, 4));
    let twelve = u32::from(bits(first, 10, 1)) << 11 | u32::from(bits(second, 12, 3)) << 8 | u32::from(second & 0xff);
    let low = bits(second, 12, 3) << 2 | bits(second, 6, 2);
    let last = bits(second, 0, 5);
    let constant = Operand::Constant(twelve, None);
    match bits(first, 4, 5) {
        0 => compute(Arithmetic::Add, to, base, constant, Flags::Kept),
        10 => compute(Arithmetic::Subtract, to, base, constant, Flags::Kept),
        4 => {
            let value = u32::from(base) << 12 | twelve;
            compute(Arithmetic::Move, to, 0, Operand::Constant(value, None), Flags::Kept)
        }
        12 => Operation::MoveTop(to, u16::from(base) << 12 | twelve as u16),
        16 | 18 | 24 | 26 => Operation::Clobber(1 << to),
        code @ (20 | 28) => Operation::Extract { to, from: base, low, width: last + 1, signed: code == 20 },
        22 if last >= low => {
            let from = (base != 15).then_some(base);
            Operation::Insert { to, from, low, width: last - low + 1 }
        }
        _ => Operation::Unknown,
    }
}

/// Branches, hints, barriers, special registers.
fn control(first: u16, second: u16) -> Operation {
    match first {
        // mrs
        _ if first & 0xffe0 == 0xf3e0 && second & 0xd000 == 0x8000 => Operation::Clobber(1 << bits(second, 8, 4)),
        _ => Operation::Nothing,
    }
}

fn load_or_store(first: u16, second: u16) -> Operation {
    let (base, rt) = (bits(first, 0, 4), bits(second, 12, 4));
    let (loads, bytes, signed) = (first & 0x10 != 0, 1 << bits(first, 5, 2), first & 0x100 != 0);
    let twelve = i32::from(second & 0xfff);
    if bytes > 4 {
        return Operation::Unknown;
    }
    // pld, pli
    if loads && rt == 15 && bytes < 4 {
        return Operation::Nothing;
    }
    let at = if loads && base == 15 {
        at(15, if first & 0x80 == 0 { -twelve } else { twelve })
    } else if first & 0x80 != 0 {
        at(base, twelve)
    } else if second & 0x800 != 0 {
        let eight = i32::from(second & 0xff);
        let offset = Offset::Constant(if second & 0x200 == 0 { -eight } else { eight });
        Address { base, offset, before: second & 0x400 != 0, write_back: second & 0x100 != 0 }
    } else if second & 0xfc0 == 0 {
        let offset = Offset::Register(bits(second, 0, 4), bits(second, 4, 2));
        Address { base, offset, before: true, write_back: false }
    } else {
        return Operation::Unknown;
    };
    match loads {
        true => Operation::Load { to: rt, bytes, signed, at },
        false => Operation::Store { from: rt, bytes, at, success: None },
    }
}

/// Data processing between registers.
fn register_processing(first: u16, second: u16) -> Operation {
    let (base, to, other) = (bits(first, 0, 4), bits(second, 8, 4), bits(second, 0, 4));
    let code = bits(first, 4, 4);
    match bits(second, 4, 4) {
        0 if code < 8 => {
            let flags = if code & 1 == 0 { Flags::Kept } else { Flags::Set };
            compute(Arithmetic::Move, to, 0, Operand::ShiftedBy(base, shift_kind(code >> 1), other), flags)
        }
        8..=15 if matches!(code, 0 | 1 | 4 | 5) => Operation::Extend {
            to,
            from: other,
            plus: (base != 15).then_some(base),
            rotation: 8 * bits(second, 4, 2),
            bits: if code < 2 { 16 } else { 8 },
            signed: code & 1 == 0,
        },
        8 if code == 11 => Operation::Rearrange(Rearrangement::LeadingZeros, to, other),
        10 if code == 9 => Operation::Rearrange(Rearrangement::ReverseBits, to, other),
        8 if code == 9 => Operation::Rearrange(Rearrangement::ReverseBytes, to, other),
        _ => Operation::Clobber(1 << to),
    }
}

fn multiply(first: u16, second: u16) -> Operation {
    let (one, other) = (bits(first, 0, 4), bits(second, 0, 4));
    let (third, to) = (bits(second, 12, 4), bits(second, 8, 4));
    let long =
        |signed, accumulates| Operation::MultiplyLong { to: [third, to], factors: [one, other], signed, accumulates };
    match (bits(first, 4, 4), bits(second, 4, 4)) {
        (0, 0) => {
            let third = (third != 15).then_some((third, false));
            Operation::Multiply { to, first: one, second: other, third, flags: Flags::Kept }
        }
        (0, 1) => Operation::Multiply { to, first: one, second: other, third: Some((third, true)), flags: Flags::Kept },
        (1..=7, _) => Operation::Clobber(1 << to),
        (8, 0) => long(true, false),
        (10, 0) => long(false, false),
        (9, 15) => Operation::Divide { to, of: [one, other], signed: true },
        (11, 15) => Operation::Divide { to, of: [one, other], signed: false },
        (12, 0) => long(true, true),
        (14, 0) => long(false, true),
        (12..=14, _) => Operation::Clobber(1 << to | 1 << third),
        _ => Operation::Unknown,
    }
}

/// Single-precision register, or the first half of a double.
fn single_register(upper: u8, lower: u8, is_double: bool) -> Single {
    if is_double { (lower << 4 | upper) << 1 } else { upper << 1 | lower }
}

fn floating(first: u16, second: u16) -> Operation {
    let is_double = second & 0x100 != 0;
    let base = bits(first, 0, 4);
    let rt = bits(second, 12, 4);
    let d = single_register(rt, bits(first, 6, 1), is_double);
    let n = single_register(base, bits(second, 7, 1), false);
    let m = single_register(bits(second, 0, 4), bits(second, 5, 1), false);
    let loads = first & 0x10 != 0;
    if second & 0xe00 != 0xa00 {
        return Operation::Unknown;
    }
    match first {
        _ if first & 0xffe0 == 0xec40 => {
            let to = single_register(bits(second, 0, 4), bits(second, 5, 1), is_double);
            match loads {
                true => Operation::FromSingles([rt, base], to),
                false => Operation::ToSingles(to, [rt, base]),
            }
        }
        _ if first & 0xfe00 == 0xec00 => {
            let offset = 4 * i32::from(second & 0xff);
            // vldr, vstr
            if first & 0x120 == 0x100 {
                let offset = if first & 0x80 == 0 { -offset } else { offset };
                let count = if is_double { 2 } else { 1 };
                return Operation::MultipleSingle { loads, base, first: d, count, offset, write_back: None };
            }
            let down = first & 0x80 == 0;
            if down && first & 0x120 != 0x120 || !down && first & 0x100 != 0 || second & 0xff > 32 {
                return Operation::Unknown;
            }
            let signed = if down { -offset } else { offset };
            let write_back = (first & 0x20 != 0).then_some(signed);
            let count = if is_double { second as u8 & 0xfe } else { second as u8 };
            Operation::MultipleSingle { loads, base, first: d, count, offset: signed.min(0), write_back }
        }
        _ if first & 0xff00 == 0xee00 && second & 0x10 == 0x10 => match (first & 0xffe0, is_double) {
            (0xee00, false) if loads => Operation::FromSingle(rt, n),
            (0xee00, false) => Operation::ToSingle(n, rt),
            // Half of a double.
            (0xee00 | 0xee20, true) => {
                let half = single_register(base, bits(second, 7, 1), true) + bits(first, 5, 1);
                if loads { Operation::FromSingle(rt, half) } else { Operation::ToSingle(half, rt) }
            }
            (0xeee0, false) if first & 0xf == 1 && loads && rt == 15 => Operation::FlagsFromSingle,
            (0xeee0, false) if first & 0xf == 1 && loads => Operation::Clobber(1 << rt),
            // vmsr: changes rounding and subnormal modes; no followed value depends on them.
            (0xeee0, false) if first & 0xf == 1 => Operation::Nothing,
            _ => Operation::Unknown,
        },
        // Doubles are only moved on this core.
        _ if first & 0xff00 == 0xee00 && !is_double => {
            let other = second & 0x40 != 0;
            let float = |what| Operation::Float(what, d, [n, m]);
            let one = |what| Operation::Float(what, d, [m, m]);
            match first & 0xffb0 {
                0xee00 | 0xee10 | 0xee90 | 0xeea0 => float(Floating::MultiplyAccumulate),
                0xee20 if other => float(Floating::NegatedMultiply),
                0xee20 => float(Floating::Multiply),
                0xee30 if other => float(Floating::Subtract),
                0xee30 => float(Floating::Add),
                0xee80 if !other => float(Floating::Divide),
                0xeeb0 if !other => {
                    let code = u32::from(base << 4 | bits(second, 0, 4));
                    let exponent = if code & 0x40 == 0 { 0x4000_0000 } else { 0x3e00_0000 };
                    Operation::SingleConstant(d, (code & 0x80) << 24 | exponent | (code & 0x3f) << 19)
                }
                0xeeb0 => match (base, second & 0x80 != 0) {
                    (0, false) => one(Floating::Copy),
                    (0, true) => one(Floating::Absolute),
                    (1, false) => one(Floating::Negate),
                    (1, true) => one(Floating::SquareRoot),
                    (4, _) => Operation::CompareSingle(d, Some(m)),
                    (5, _) => Operation::CompareSingle(d, None),
                    // Half precision changes a part of the register; all of it becomes unknown.
                    (2 | 3 | 8 | 12 | 13, _) => one(Floating::Convert),
                    // Fixed point, in place.
                    (10 | 11 | 14 | 15, _) => Operation::Float(Floating::Convert, d, [d, d]),
                    _ => Operation::Unknown,
                },
                _ => Operation::Unknown,
            }
        }
        _ => Operation::Unknown,
    }
}
