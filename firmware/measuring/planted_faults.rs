#![cfg_attr(target_os = "none", no_std, no_main)]
//! A tick with everything that is forbidden in a tick: an index that may fail, recursion, a call through a pointer and
//! a large stack. It tests the check of the linked image and is never run.

#[cfg(target_os = "none")]
mod faults {
    use core::hint::black_box;

    use cortex_m_rt::{entry, exception};
    use firmware::measuring;

    #[entry]
    fn main() -> ! {
        measuring::finish()
    }

    #[exception]
    fn SysTick() {
        may_panic(black_box(3));
        takes_stack();
        calls_itself(black_box(5));
        through_a_pointer(black_box(takes_stack));
    }

    #[inline(never)]
    fn may_panic(index: usize) {
        black_box(black_box([1_u32, 2, 3])[index]);
    }

    #[inline(never)]
    fn takes_stack() {
        black_box([0_u8; 3000]);
    }

    #[inline(never)]
    fn calls_itself(left: u32) {
        if left > 0 {
            calls_itself(left - 1);
            black_box(left);
        }
    }

    #[inline(never)]
    fn through_a_pointer(call: fn()) {
        call();
        black_box(call);
    }
}

/// Empty on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
