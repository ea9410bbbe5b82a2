#![cfg_attr(target_os = "none", no_std, no_main)]
//! The core in somebody else's firmware: their loop, their panic handler, their chip's vendor table, no HAL, and
//! nothing of this package but the tables that its build script wrote. Take `model-core` as a dependency, write the
//! tables in your own build script by `model_core::gears::design::rust_source`, and step the model once a tick.

#[cfg(target_os = "none")]
mod guest {
    use core::hint::black_box;
    use core::panic::PanicInfo;

    use cortex_m_rt::entry;
    use model_core::gears::{Model, Torques};
    #[cfg(feature = "stm32f405")]
    use stm32f4 as _;
    #[cfg(feature = "stm32g474")]
    use stm32g4 as _;
    #[cfg(feature = "stm32h743")]
    use stm32h7 as _;

    #[allow(dead_code, clippy::all, reason = "generated numbers; the name of the joint is of no use here")]
    mod joint {
        include!(concat!(env!("OUT_DIR"), "/tables.rs"));
    }

    /// Sun torque [N m] that swings the joint to and fro through its gap.
    const SWING: f32 = 0.1;
    /// Ticks that it acts one way.
    const HALF_SWING: u32 = 200;

    #[entry]
    fn main() -> ! {
        let mut joint = Model::new(&joint::TABLES);
        let mut tick = 0_u32;
        loop {
            let drive = if (tick / HALF_SWING).is_multiple_of(2) { SWING } else { -SWING };
            joint.step(Torques { drive, load: 0.0 });
            black_box(joint.outputs().carrier_speed);
            tick = tick.wrapping_add(1);
        }
    }

    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        loop {
            cortex_m::asm::bkpt();
        }
    }
}

/// There is nothing to run on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
