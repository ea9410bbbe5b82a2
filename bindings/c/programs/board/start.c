/*
 * Start-up of a Cortex-M4F or M7 without the vendor's files: vectors, memory, the floating-point unit, and output through
 * the emulator's semihosting. For the emulator only.
 */
#include "../say.h"

#include <stddef.h>
#include <stdint.h>

extern uint32_t stack_top, data_load, data_begin, data_end, bss_begin, bss_end;

int main(void);
void start(void);
void SysTick_Handler(void);

enum { SYS_OPEN = 1, SYS_WRITE = 5, SYS_EXIT = 0x18 };

static uintptr_t semihosting(uintptr_t operation, const void *argument) {
    register uintptr_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void say(const char *text) {
    static uintptr_t console = 0;
    size_t length = 0;
    if (console == 0) {
        const uintptr_t open[3] = {(uintptr_t)":tt", 4, 3};
        console = semihosting(SYS_OPEN, open);
    }
    while (text[length] != 0) {
        length++;
    }
    {
        const uintptr_t write[3] = {console, (uintptr_t)text, length};
        (void)semihosting(SYS_WRITE, write);
    }
}

void end(int status) {
    /* ADP_Stopped_ApplicationExit, or a run-time error. */
    (void)semihosting(SYS_EXIT, (const void *)(uintptr_t)(status == 0 ? 0x20026 : 0x20023));
    for (;;) {
    }
}

static void fault(void) {
    say("a fault stopped the program\n");
    end(1);
}

/* Default for programs without a tick. */
__attribute__((weak)) void SysTick_Handler(void) {}

__attribute__((section(".vectors"), used)) static void (*const vectors[15])(void) = {
    start, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, SysTick_Handler,
};

void start(void) {
    uint32_t *from = &data_load, *to;
    /* CPACR: the floating-point unit is off after reset. */
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm__ volatile("dsb\n isb" ::: "memory");
    for (to = &data_begin; to < &data_end; to++) {
        *to = *from++;
    }
    for (to = &bss_begin; to < &bss_end; to++) {
        *to = 0;
    }
    end(main());
}
