//! As much of the Thumb-2 instruction set as tells where control goes and what becomes of the stack pointer: lengths,
//! branches, calls, returns and every form that writes `sp`. All other instructions are one and the same here. Encodings
//! are those of the ARMv7-M Architecture Reference Manual, chapters A5 to A7.

/// Where control goes after an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// To the next instruction.
    Next,
    /// There, or to the next if the condition does not hold.
    Branch(u32),
    /// There.
    Jump(u32),
    /// There and back.
    Call(u32),
    /// Wherever a register says, and back.
    CallRegister,
    /// Wherever a register or a number in memory says.
    JumpRegister,
    /// To one of the places in a table whose address is in a register, or that follows.
    Table {
        /// Bytes of an entry.
        width: u32,
        /// The register; 15 if the table follows.
        base: u16,
    },
    /// To the caller.
    Return,
    /// Nowhere: the processor faults or waits for a debugger.
    Trap,
}

/// What becomes of the stack pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stack {
    /// Nothing.
    Same,
    /// The stack grows by so many bytes.
    Grow(u32),
    /// It shrinks by so many bytes.
    Shrink(u32),
    /// It is set to something that cannot be told from this instruction.
    Unknown,
}

/// One instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instruction {
    /// 2 or 4 bytes.
    pub size: u32,
    /// Where control goes.
    pub flow: Flow,
    /// What becomes of the stack pointer.
    pub stack: Stack,
    /// The register that it loads with the address of something near by, and that address.
    pub address_of: Option<(u16, u32)>,
    /// How many of the following instructions it makes conditional.
    pub conditional_next: u32,
}

const SP: u16 = 13;
const LR: u16 = 14;
const PC: u16 = 15;

/// Reads the instruction at an address; `second` is the halfword after it, if there is one.
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

/// The three forms of `adr`.
fn address_of(address: u32, first: u16, second: u16) -> Option<(u16, u32)> {
    let here = (address + 4) & !3;
    match first & 0xfbff {
        0xf20f => Some((second >> 8 & 15, here + twelve(first, second))),
        0xf2af => Some((second >> 8 & 15, here - twelve(first, second))),
        _ if first & 0xf800 == 0xa000 => Some((first >> 8 & 7, here + 4 * u32::from(first & 0xff))),
        _ => None,
    }
}

/// Destination of the forms of `add` and `mov` that take all registers.
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

fn stack_of_short(first: u16) -> Stack {
    let words = 4 * u32::from(first & 0x7f);
    match first {
        _ if first & 0xfe00 == 0xb400 => Stack::Grow(4 * (first & 0x1ff).count_ones()),
        _ if first & 0xfe00 == 0xbc00 => Stack::Shrink(4 * (first & 0x1ff).count_ones()),
        _ if first & 0xff80 == 0xb000 => Stack::Shrink(words),
        _ if first & 0xff80 == 0xb080 => Stack::Grow(words),
        _ if high_destination(first) == Some(SP) => Stack::Unknown,
        _ => Stack::Same,
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

fn stack_of_long(first: u16, second: u16) -> Stack {
    let base = first & 15;
    let destination = second >> 8 & 15;
    let by = |up: bool, bytes: u16| if up { Stack::Shrink(bytes.into()) } else { Stack::Grow(bytes.into()) };
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
        _ if first & 0xff70 == 0xf850 && second >> 12 == SP => Stack::Unknown,
        // Data processing: shifted register, then constant
        _ if first & 0xfe00 == 0xea00 && destination == SP => Stack::Unknown,
        _ if first & 0xf800 == 0xf000 && second & 0x8000 == 0 && destination == SP => {
            let (coded, plain) = (expand(first, second), twelve(first, second));
            match first & 0xfbef {
                0xf10d => Stack::Shrink(coded),
                0xf1ad => Stack::Grow(coded),
                0xf20d => Stack::Shrink(plain),
                0xf2ad => Stack::Grow(plain),
                _ => Stack::Unknown,
            }
        }
        // msr to the stack pointers
        _ if first & 0xffe0 == 0xf380 && second & 0xff00 == 0x8800 && matches!(second & 0xff, 8 | 9) => Stack::Unknown,
        _ => Stack::Same,
    }
}

/// Sign extension of a number of so many bits.
fn extend(value: u32, bits: u32) -> i32 {
    ((value << (32 - bits)) as i32) >> (32 - bits)
}

/// Offset of `bl` and of `b.w` without condition.
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

/// The constant of twelve bits, as it stands.
fn twelve(first: u16, second: u16) -> u32 {
    u32::from(first >> 10 & 1) << 11 | u32::from(second >> 12 & 7) << 8 | u32::from(second & 0xff)
}

/// The constant of twelve bits, as the expanding forms mean it.
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
mod tests {
    use super::*;

    fn at(address: u32, first: u16, second: u16) -> (u32, Flow, Stack) {
        let Instruction { size, flow, stack, .. } = decode(address, first, second);
        (size, flow, stack)
    }

    /// Each with what `objdump` prints for it.
    #[test]
    fn branches_calls_and_returns_are_told_apart() {
        let flow = |first, second| decode(0x1000, first, second).flow;
        assert_eq!(flow(0xd0fe, 0), Flow::Branch(0x1000)); // beq.n 1000
        assert_eq!(flow(0xe7fe, 0), Flow::Jump(0x1000)); // b.n 1000
        assert_eq!(flow(0xb118, 0), Flow::Branch(0x100a)); // cbz r0, 100a
        assert_eq!(flow(0xbb08, 0), Flow::Branch(0x1046)); // cbnz r0, 1046
        assert_eq!(flow(0xf7ff, 0xfffe), Flow::Call(0x1000)); // bl 1000
        assert_eq!(flow(0xf000, 0xb800), Flow::Jump(0x1004)); // b.w 1004
        assert_eq!(flow(0xf43f, 0xaffe), Flow::Branch(0x1000)); // beq.w 1000
        assert_eq!(flow(0x4770, 0), Flow::Return); // bx lr
        assert_eq!(flow(0x4718, 0), Flow::JumpRegister); // bx r3
        assert_eq!(flow(0x4798, 0), Flow::CallRegister); // blx r3
        assert_eq!(flow(0x468f, 0), Flow::JumpRegister); // mov pc, r1
        assert_eq!(flow(0xbd10, 0), Flow::Return); // pop {r4, pc}
        assert_eq!(flow(0xe8bd, 0x8ff0), Flow::Return); // ldmia.w sp!, {r4-r11, pc}
        assert_eq!(flow(0xf85d, 0xfb04), Flow::Return); // ldr.w pc, [sp], #4
        assert_eq!(flow(0xf8df, 0xf004), Flow::JumpRegister); // ldr.w pc, [pc, #4]
        assert_eq!(flow(0xe8df, 0xf000), Flow::Table { width: 1, base: 15 }); // tbb [pc, r0]
        assert_eq!(flow(0xe8df, 0xf011), Flow::Table { width: 2, base: 15 }); // tbh [pc, r1, lsl #1]
        assert_eq!(flow(0xdefe, 0), Flow::Trap); // udf #254
        assert_eq!(flow(0xf7f0, 0xa000), Flow::Trap); // udf.w #0
        assert_eq!(flow(0xf3ef, 0x8010), Flow::Next); // mrs r0, primask
        assert_eq!(flow(0xf3bf, 0x8f5f), Flow::Next); // dmb sy
    }

    #[test]
    fn every_way_to_move_the_stack_pointer_is_seen() {
        assert_eq!(at(0, 0xb5f0, 0), (2, Flow::Next, Stack::Grow(24))); // push {r4-r7, lr}
        assert_eq!(at(0, 0xbcf0, 0), (2, Flow::Next, Stack::Shrink(16))); // pop {r4-r7}
        assert_eq!(at(0, 0xb082, 0), (2, Flow::Next, Stack::Grow(8))); // sub sp, #8
        assert_eq!(at(0, 0xb002, 0), (2, Flow::Next, Stack::Shrink(8))); // add sp, #8
        assert_eq!(at(0, 0xe92d, 0x4ff0), (4, Flow::Next, Stack::Grow(36))); // stmdb sp!, {r4-r11, lr}
        assert_eq!(at(0, 0xed2d, 0x8b10), (4, Flow::Next, Stack::Grow(64))); // vpush {d8-d15}
        assert_eq!(at(0, 0xecbd, 0x8b10), (4, Flow::Next, Stack::Shrink(64))); // vpop {d8-d15}
        assert_eq!(at(0, 0xf84d, 0x8d04), (4, Flow::Next, Stack::Grow(4))); // str.w r8, [sp, #-4]!
        assert_eq!(at(0, 0xf85d, 0x8b04), (4, Flow::Next, Stack::Shrink(4))); // ldr.w r8, [sp], #4
        assert_eq!(at(0, 0xf5ad, 0x7d00), (4, Flow::Next, Stack::Grow(512))); // sub.w sp, sp, #512
        assert_eq!(at(0, 0xf50d, 0x7d00), (4, Flow::Next, Stack::Shrink(512))); // add.w sp, sp, #512
        assert_eq!(at(0, 0xf6ad, 0x0d04), (4, Flow::Next, Stack::Grow(2052))); // subw sp, sp, #2052
        assert_eq!(at(0, 0x46a5, 0), (2, Flow::Next, Stack::Unknown)); // mov sp, r4
        assert_eq!(at(0, 0xf1a7, 0x0d08), (4, Flow::Next, Stack::Unknown)); // sub.w sp, r7, #8
        assert_eq!(at(0, 0xf380, 0x8808), (4, Flow::Next, Stack::Unknown)); // msr MSP, r0
    }

    #[test]
    fn the_stack_pointer_may_be_used_without_being_moved() {
        assert_eq!(at(0, 0xa802, 0).2, Stack::Same); // add r0, sp, #8
        assert_eq!(at(0, 0x4668, 0).2, Stack::Same); // mov r0, sp
        assert_eq!(at(0, 0xf8dd, 0x0010).2, Stack::Same); // ldr.w r0, [sp, #16]
        assert_eq!(at(0, 0xe9cd, 0x0102).2, Stack::Same); // strd r0, r1, [sp, #8]
        assert_eq!(at(0, 0xed9d, 0x0a02).2, Stack::Same); // vldr s0, [sp, #8]
        assert_eq!(at(0, 0xf10d, 0x0010).2, Stack::Same); // add.w r0, sp, #16
    }

    #[test]
    fn the_address_of_a_table_near_by_is_found() {
        let address_of = |first, second| decode(0x1002, first, second).address_of;
        assert_eq!(address_of(0xa103, 0), Some((1, 0x1010))); // add r1, pc, #12
        assert_eq!(address_of(0xf20f, 0x0310), Some((3, 0x1014))); // addw r3, pc, #16
        assert_eq!(address_of(0xf2af, 0x0204), Some((2, 0x1000))); // subw r2, pc, #4
        assert_eq!(address_of(0xf20d, 0x0310), None); // addw r3, sp, #16
        assert_eq!(decode(0, 0xe8d1, 0xf010).flow, Flow::Table { width: 2, base: 1 }); // tbh [r1, r0, lsl #1]
    }

    #[test]
    fn a_condition_covers_as_many_instructions_as_its_mask_says() {
        assert_eq!(decode(0, 0xbf08, 0).conditional_next, 1); // it eq
        assert_eq!(decode(0, 0xbf1c, 0).conditional_next, 2); // itt ne
        assert_eq!(decode(0, 0xbf15, 0).conditional_next, 4); // itete ne
        assert_eq!(decode(0, 0xbf00, 0).conditional_next, 0); // nop
    }
}
