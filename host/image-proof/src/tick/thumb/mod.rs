//! Part of the Thumb-2 instruction set that determines control flow and the stack pointer: lengths, branches, calls,
//! returns and every form that writes `sp`. Other instructions are not distinguished. Encodings are those of the
//! ARMv7-M Architecture Reference Manual, chapters A5 to A7.

/// Control flow after an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Next instruction.
    Next,
    /// Branch to an address, or next instruction if the condition does not hold.
    Branch(u32),
    /// Unconditional branch to an address.
    Jump(u32),
    /// Call of an address.
    Call(u32),
    /// Call of an address in a register.
    CallRegister,
    /// Jump to an address in a register or in memory.
    JumpRegister,
    /// Jump through a table whose address is in a register, or that follows the instruction.
    Table {
        /// Size of an entry [byte].
        width: u32,
        /// Register with the table's address; 15 if the table follows.
        base: u16,
    },
    /// Return to the caller.
    Return,
    /// Stop: the processor faults or waits for a debugger.
    Trap,
}

/// Effect on the stack pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StackEffect {
    /// Stack pointer unchanged.
    Same,
    /// Stack grows [byte].
    Grow(u32),
    /// Stack shrinks [byte].
    Shrink(u32),
    /// Stack pointer set to a value that this instruction does not show.
    Unknown,
}

/// Decoded instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instruction {
    /// Size, 2 or 4 [byte].
    pub size: u32,
    /// Control flow.
    pub flow: Flow,
    /// Effect on the stack pointer.
    pub stack: StackEffect,
    /// Register that is loaded with a nearby address, and the address.
    pub address_of: Option<(u16, u32)>,
    /// Number of following instructions that become conditional.
    pub conditional_next: u32,
}

const SP: u16 = 13;
const LR: u16 = 14;
const PC: u16 = 15;

/// Decodes the instruction at an address; `second` is the half word after it, if there is one.
pub fn decode(address: u32, first: u16, second: u16) -> Instruction {
    let size = if first >> 11 >= 0b11101 { 4 } else { 2 };
    let (flow, stack) = match size {
        2 => (flow_of_short(address, first), stack_of_short(first)),
        _ => (flow_of_long(address, first, second), stack_of_long(first, second)),
    };
    let address_of = address_of(address, first, second);
    let conditional_next =
        if first & 0xff00 == 0xbf00 && first & 0xf != 0 { 4 - (first & 0xf).trailing_zeros() } else { 0 };
    Instruction { size, flow, stack, address_of, conditional_next }
}

/// Register and address of the three forms of `adr`.
fn address_of(address: u32, first: u16, second: u16) -> Option<(u16, u32)> {
    let here = (address + 4) & !3;
    match first & 0xfbff {
        0xf20f => Some((second >> 8 & 15, here + twelve(first, second))),
        0xf2af => Some((second >> 8 & 15, here - twelve(first, second))),
        _ if first & 0xf800 == 0xa000 => Some((first >> 8 & 7, here + 4 * u32::from(first & 0xff))),
        _ => None,
    }
}

/// Destination of the short forms of `add` and `mov` that reach all registers.
fn high_destination(first: u16) -> Option<u16> {
    matches!(first & 0xff00, 0x4400 | 0x4600).then_some(first & 7 | first >> 4 & 8)
}

fn flow_of_short(address: u32, first: u16) -> Flow {
    let to = |offset: i32| address.wrapping_add(4).wrapping_add_signed(offset);
    match first {
        _ if first & 0xff87 == 0x4700 => match first >> 3 & 15 {
            LR => Flow::Return,
            _ => Flow::JumpRegister,
        },
        _ if first & 0xff87 == 0x4780 => Flow::CallRegister,
        _ if high_destination(first) == Some(PC) => Flow::JumpRegister,
        _ if first & 0xff00 == 0xde00 || first & 0xff00 == 0xbe00 => Flow::Trap,
        _ if first & 0xff00 == 0xdf00 => Flow::Next,
        _ if first & 0xf000 == 0xd000 => Flow::Branch(to(extend(u32::from(first & 0xff) << 1, 9))),
        _ if first & 0xf800 == 0xe000 => Flow::Jump(to(extend(u32::from(first & 0x7ff) << 1, 12))),
        _ if first & 0xf500 == 0xb100 => {
            Flow::Branch(to(i32::from(first >> 9 & 1) << 6 | i32::from(first >> 3 & 31) << 1))
        }
        _ if first & 0xff00 == 0xbd00 => Flow::Return,
        _ => Flow::Next,
    }
}

fn stack_of_short(first: u16) -> StackEffect {
    let words = 4 * u32::from(first & 0x7f);
    match first {
        _ if first & 0xfe00 == 0xb400 => StackEffect::Grow(4 * (first & 0x1ff).count_ones()),
        _ if first & 0xfe00 == 0xbc00 => StackEffect::Shrink(4 * (first & 0x1ff).count_ones()),
        _ if first & 0xff80 == 0xb000 => StackEffect::Shrink(words),
        _ if first & 0xff80 == 0xb080 => StackEffect::Grow(words),
        _ if high_destination(first) == Some(SP) => StackEffect::Unknown,
        _ => StackEffect::Same,
    }
}

fn flow_of_long(address: u32, first: u16, second: u16) -> Flow {
    let base = first & 15;
    let to = |offset: i32| address.wrapping_add(4).wrapping_add_signed(offset);
    let is_load_multiple = first & 0xfe50 == 0xe810;
    let is_load_word = first & 0xff70 == 0xf850;
    match first {
        _ if first & 0xf800 == 0xf000 && second & 0x8000 != 0 => match second & 0xd000 {
            0xd000 => Flow::Call(to(far(first, second))),
            0x9000 => Flow::Jump(to(far(first, second))),
            0x8000 if first >> 6 & 15 < 14 => Flow::Branch(to(near(first, second))),
            _ if first & 0xfff0 == 0xf7f0 && second & 0xf000 == 0xa000 => Flow::Trap,
            _ => Flow::Next,
        },
        _ if first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000 => {
            Flow::Table { width: 1 + u32::from(second >> 4 & 1), base }
        }
        _ if is_load_multiple && second & 0x8000 != 0 => {
            if base == SP {
                Flow::Return
            } else {
                Flow::JumpRegister
            }
        }
        _ if is_load_word && second >> 12 == PC => match (base, second & 0xfff) {
            // ldr pc, [sp], #4
            (SP, 0xb04) => Flow::Return,
            _ => Flow::JumpRegister,
        },
        _ => Flow::Next,
    }
}

fn stack_of_long(first: u16, second: u16) -> StackEffect {
    let base = first & 15;
    let destination = second >> 8 & 15;
    let by =
        |up: bool, bytes: u16| if up { StackEffect::Shrink(bytes.into()) } else { StackEffect::Grow(bytes.into()) };
    let writes_back = first & 0x20 != 0;
    let up = first & 0x80 != 0;
    match first {
        // ldm, stm; ldrd, strd
        _ if first & 0xfe40 == 0xe800 && base == SP && writes_back => by(up, 4 * second.count_ones() as u16),
        _ if first & 0xfe40 == 0xe840 && base == SP && writes_back => by(up, 4 * (second & 0xff)),
        // vldm, vstm
        _ if first & 0xfe00 == 0xec00 && base == SP && writes_back => by(up, 4 * (second & 0xff)),
        // ldr, str of any width with an 8-bit offset
        _ if first & 0xfe80 == 0xf800 && base == SP && second & 0x900 == 0x900 => {
            by(second & 0x200 != 0, second & 0xff)
        }
        _ if first & 0xff70 == 0xf850 && second >> 12 == SP => StackEffect::Unknown,
        // Data processing: shifted register, then constant
        _ if first & 0xfe00 == 0xea00 && destination == SP => StackEffect::Unknown,
        _ if first & 0xf800 == 0xf000 && second & 0x8000 == 0 && destination == SP => {
            let (coded, plain) = (expand(first, second), twelve(first, second));
            match first & 0xfbef {
                0xf10d => StackEffect::Shrink(coded),
                0xf1ad => StackEffect::Grow(coded),
                0xf20d => StackEffect::Shrink(plain),
                0xf2ad => StackEffect::Grow(plain),
                _ => StackEffect::Unknown,
            }
        }
        // msr to the stack pointers
        _ if first & 0xffe0 == 0xf380 && second & 0xff00 == 0x8800 && matches!(second & 0xff, 8 | 9) => {
            StackEffect::Unknown
        }
        _ => StackEffect::Same,
    }
}

/// Sign extension of a number from a width in bits.
fn extend(value: u32, bits: u32) -> i32 {
    ((value << (32 - bits)) as i32) >> (32 - bits)
}

/// Offset of `bl` and of `b.w` without a condition.
fn far(first: u16, second: u16) -> i32 {
    let (first, second) = (u32::from(first), u32::from(second));
    let sign = first >> 10 & 1;
    let (high, low) = ((second >> 13 ^ sign ^ 1) & 1, (second >> 11 ^ sign ^ 1) & 1);
    extend(sign << 24 | high << 23 | low << 22 | (first & 0x3ff) << 12 | (second & 0x7ff) << 1, 25)
}

/// Offset of `b.w` with a condition.
fn near(first: u16, second: u16) -> i32 {
    let (first, second) = (u32::from(first), u32::from(second));
    let (sign, high, low) = (first >> 10 & 1, second >> 11 & 1, second >> 13 & 1);
    extend(sign << 20 | high << 19 | low << 18 | (first & 0x3f) << 12 | (second & 0x7ff) << 1, 21)
}

/// Plain 12-bit constant.
fn twelve(first: u16, second: u16) -> u32 {
    u32::from(first >> 10 & 1) << 11 | u32::from(second >> 12 & 7) << 8 | u32::from(second & 0xff)
}

/// Modified 12-bit constant.
fn expand(first: u16, second: u16) -> u32 {
    let code = twelve(first, second);
    let byte = code & 0xff;
    match code >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (byte | 0x80).rotate_right(code >> 7),
    }
}

#[cfg(test)]
mod tests;
