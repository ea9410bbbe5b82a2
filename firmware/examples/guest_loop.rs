#![cfg_attr(target_os = "none", no_std, no_main)]
//! Use of the core in other firmware with its own motor-control loop, panic handler and vector table; without HAL, and
//! of this package only with the tables written by its build script. Depend on `model-core` and write the tables in
//! your own build script: those of the model by `model_core::gears::design::rust_source`, those of the observer by
//! `model_core::observer::design::observer_source`. Once per control period the observer takes the loop's encoder
//! counts and torque and estimates the gap coordinate; the model, stepped in parallel, simulates the gears under these
//! torques.

#[cfg(target_os = "none")]
mod guest {
    use core::hint::black_box;
    use core::panic::PanicInfo;

    use cortex_m_rt::entry;
    use model_core::gears::{Model, Torques};
    use model_core::observer::{MAPPED, Observer, Samples};
    use model_core::virtual_joint::VirtualJoint;
    use parameters::ContactState;
    #[cfg(family = "stm32f4")]
    use stm32f4 as _;
    #[cfg(family = "stm32g4")]
    use stm32g4 as _;
    #[cfg(family = "stm32h7")]
    use stm32h7 as _;

    #[allow(dead_code, clippy::all, reason = "generated numbers; the name of the joint is of no use here")]
    mod joint {
        include!(concat!(env!("OUT_DIR"), "/tables.rs"));
    }

    #[allow(
        dead_code,
        clippy::excessive_precision,
        reason = "generated numbers; the compensation's are of no use here"
    )]
    mod control {
        include!(concat!(env!("OUT_DIR"), "/control.rs"));
    }

    /// Motor torque that swings the joint to and fro through its gap [N m].
    const SWING: f32 = 0.5;
    /// Control periods per direction of the torque.
    const HALF_SWING: u32 = 2000;
    /// Share of the torque while the teeth cross the gap: a soft landing.
    const IN_THE_GAP: f32 = 0.25;

    /// Virtual joint in place of encoders and current loop, so that the example runs anywhere; replace it by drivers.
    struct Motor(VirtualJoint<'static, f32, { joint::PLANETS }>);

    impl Motor {
        /// Returns counts of both encoders with their times, and the last commanded torque.
        fn measure(&self) -> Samples<f32> {
            self.0.samples()
        }

        /// Commands a torque for the next period [N m].
        fn command(&mut self, torque: f32) {
            self.0.advance(torque, 0.0);
        }
    }

    #[entry]
    fn main() -> ! {
        let mut motor = Motor(VirtualJoint::new(&joint::TABLES, &control::SURROUNDINGS));
        let mut model = Model::new(&joint::TABLES);
        let mut observer = Observer::<f32, MAPPED>::new(&control::OBSERVER);
        let mut period = 0_u32;
        loop {
            // A real loop waits for its timer here.
            let estimates = observer.step(&motor.measure());
            let swing = if (period / HALF_SWING).is_multiple_of(2) { SWING } else { -SWING };
            let open = estimates.contact_valid && estimates.reported_contact == ContactState::Separated;
            let torque = if open { IN_THE_GAP * swing } else { swing };
            motor.command(torque);
            model.step(Torques { drive: torque, load: estimates.load_torque.value });
            black_box((estimates.gap, estimates.half_backlash, model.outputs().carrier_speed));
            period = period.wrapping_add(1);
        }
    }

    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        loop {
            cortex_m::asm::bkpt();
        }
    }
}

/// Empty on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
