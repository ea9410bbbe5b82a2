//! Cleanup after a bootloader that jumped to the image without a reset: enabled or pending interrupts, SysTick, running
//! DMA. It runs first: an interrupt could reach a vector that the image does not serve, a role without tick has no
//! SysTick handler, and a transfer could overwrite statics. The start of board and chip sets vectors and clock.

/// Reset registers of the bus masters (peripherals that write to memory), and their bits; a one holds a master in
/// reset.
type Master = [u32; 2];

/// DMA1, DMA2, USB OTG HS: RM0090 7.3, RCC_AHB1RSTR.
#[cfg(family = "stm32f4")]
static MASTERS: [Master; 1] = [[0x4002_3810, 1 << 21 | 1 << 22 | 1 << 29]];

/// DMA1, DMA2, and the DMA request multiplexer: RM0440 7.4, RCC_AHB1RSTR.
#[cfg(family = "stm32g4")]
static MASTERS: [Master; 1] = [[0x4002_1028, 1 | 1 << 1 | 1 << 2]];

/// DMA1, DMA2, Ethernet, USB OTG 1 and 2; MDMA, DMA2D, SDMMC1; SDMMC2; BDMA: RM0433 8.7, RCC_AHB1RSTR, 3, 2 and 4.
#[cfg(family = "stm32h7")]
static MASTERS: [Master; 4] = [
    [0x5802_4480, 1 | 1 << 1 | 1 << 15 | 1 << 25 | 1 << 27],
    [0x5802_447c, 1 | 1 << 4 | 1 << 16],
    [0x5802_4484, 1 << 9],
    [0x5802_4488, 1 << 21],
];

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
    // SysTick and PendSV not pending (ICSR).
    "movw r0, #0xed04",
    "movt r0, #0xe000",
    "mov r1, #0x0a000000",
    "str r1, [r0]",
    // Bus masters: held in reset, then released.
    "movw r0, #:lower16:{masters}",
    "movt r0, #:upper16:{masters}",
    "movs r3, #{count}",
    "2:",
    "ldmia r0!, {{r1, r2}}",
    "str r2, [r1]",
    "movs r2, #0",
    "str r2, [r1]",
    "subs r3, #1",
    "bne 2b",
    "bx lr",
    ".size __pre_init, . - __pre_init",
    masters = sym MASTERS,
    count = const MASTERS.len(),
);
