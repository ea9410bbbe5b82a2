//! What a bootloader may leave behind that jumped to the image, where a reset would leave nothing: interrupts that are on or
//! pending, and SysTick. All of it goes before anything else runs, since some would lead to a vector that the image does not serve,
//! and a role without a tick has none for SysTick. Vectors and clock are set right by the start of the board and of its chip.

// Before memory is set up there is no sound Rust: the start-up code of `cortex-m-rt` calls this by its name.
core::arch::global_asm!(
    ".section .text.__pre_init, \"ax\", %progbits",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "cpsid i",
    // SysTick off.
    "movw r0, #0xe010",
    "movt r0, #0xe000",
    "movs r1, #0",
    "str r1, [r0]",
    // Every interrupt off (ICER), none of them pending (ICPR).
    "movw r0, #0xe180",
    "movt r0, #0xe000",
    "mvns r1, r1",
    "movs r2, #8",
    "1:",
    "str r1, [r0, #0x100]",
    "str r1, [r0], #4",
    "subs r2, #1",
    "bne 1b",
    // Nor SysTick nor PendSV (ICSR).
    "movw r0, #0xed04",
    "movt r0, #0xe000",
    "mov r1, #0x0a000000",
    "str r1, [r0]",
    "bx lr",
    ".size __pre_init, . - __pre_init",
);
