//! Instructions with their disassembly by `objdump`.

use super::*;

fn at(address: u32, first: u16, second: u16) -> (u32, Flow, StackEffect) {
    let Instruction { size, flow, stack, .. } = decode(address, first, second);
    (size, flow, stack)
}

/// Branches, calls and returns are distinguished.
#[test]
fn control_flow_decoded() {
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

/// Every instruction that moves the stack pointer is found.
#[test]
fn stack_pointer_changes_decoded() {
    assert_eq!(at(0, 0xb5f0, 0), (2, Flow::Next, StackEffect::Grow(20))); // push {r4-r7, lr}
    assert_eq!(at(0, 0xbcf0, 0), (2, Flow::Next, StackEffect::Shrink(16))); // pop {r4-r7}
    assert_eq!(at(0, 0xb082, 0), (2, Flow::Next, StackEffect::Grow(8))); // sub sp, #8
    assert_eq!(at(0, 0xb002, 0), (2, Flow::Next, StackEffect::Shrink(8))); // add sp, #8
    assert_eq!(at(0, 0xe92d, 0x4ff0), (4, Flow::Next, StackEffect::Grow(36))); // stmdb sp!, {r4-r11, lr}
    assert_eq!(at(0, 0xed2d, 0x8b10), (4, Flow::Next, StackEffect::Grow(64))); // vpush {d8-d15}
    assert_eq!(at(0, 0xecbd, 0x8b10), (4, Flow::Next, StackEffect::Shrink(64))); // vpop {d8-d15}
    assert_eq!(at(0, 0xf84d, 0x8d04), (4, Flow::Next, StackEffect::Grow(4))); // str.w r8, [sp, #-4]!
    assert_eq!(at(0, 0xf85d, 0x8b04), (4, Flow::Next, StackEffect::Shrink(4))); // ldr.w r8, [sp], #4
    assert_eq!(at(0, 0xf5ad, 0x7d00), (4, Flow::Next, StackEffect::Grow(512))); // sub.w sp, sp, #512
    assert_eq!(at(0, 0xf50d, 0x7d00), (4, Flow::Next, StackEffect::Shrink(512))); // add.w sp, sp, #512
    assert_eq!(at(0, 0xf6ad, 0x0d04), (4, Flow::Next, StackEffect::Grow(2052))); // subw sp, sp, #2052
    assert_eq!(at(0, 0x46a5, 0), (2, Flow::Next, StackEffect::Unknown)); // mov sp, r4
    assert_eq!(at(0, 0xf1a7, 0x0d08), (4, Flow::Next, StackEffect::Unknown)); // sub.w sp, r7, #8
    assert_eq!(at(0, 0xf380, 0x8808), (4, Flow::Next, StackEffect::Unknown)); // msr MSP, r0
}

/// Instructions that only read the stack pointer have no effect on the stack.
#[test]
fn stack_pointer_reads_ignored() {
    assert_eq!(at(0, 0xa802, 0).2, StackEffect::Same); // add r0, sp, #8
    assert_eq!(at(0, 0x4668, 0).2, StackEffect::Same); // mov r0, sp
    assert_eq!(at(0, 0xf8dd, 0x0010).2, StackEffect::Same); // ldr.w r0, [sp, #16]
    assert_eq!(at(0, 0xe9cd, 0x0102).2, StackEffect::Same); // strd r0, r1, [sp, #8]
    assert_eq!(at(0, 0xed9d, 0x0a02).2, StackEffect::Same); // vldr s0, [sp, #8]
    assert_eq!(at(0, 0xf10d, 0x0010).2, StackEffect::Same); // add.w r0, sp, #16
}

/// The forms of `adr` give register and address.
#[test]
fn nearby_table_address_decoded() {
    let address_of = |first, second| decode(0x1002, first, second).address_of;
    assert_eq!(address_of(0xa103, 0), Some((1, 0x1010))); // add r1, pc, #12
    assert_eq!(address_of(0xf20f, 0x0310), Some((3, 0x1014))); // addw r3, pc, #16
    assert_eq!(address_of(0xf2af, 0x0204), Some((2, 0x1000))); // subw r2, pc, #4
    assert_eq!(address_of(0xf20d, 0x0310), None); // addw r3, sp, #16
    assert_eq!(decode(0, 0xe8d1, 0xf010).flow, Flow::Table { width: 2, base: 1 }); // tbh [r1, r0, lsl #1]
}

/// The mask of an `it` gives the number of conditional instructions.
#[test]
fn it_block_length_decoded() {
    assert_eq!(decode(0, 0xbf08, 0).conditional_next, 1); // it eq
    assert_eq!(decode(0, 0xbf1c, 0).conditional_next, 2); // itt ne
    assert_eq!(decode(0, 0xbf15, 0).conditional_next, 4); // itete ne
    assert_eq!(decode(0, 0xbf00, 0).conditional_next, 0); // nop
}
