#![cfg_attr(target_os = "none", no_std, no_main)]
//! The core in somebody else's firmware: their motor-control loop, their panic handler, their chip's vendor table, no
//! HAL, and nothing of this package but the tables that its build script wrote. Take `model-core` as a dependency and
//! write the tables in your own build script: those of the model by `model_core::gears::design::rust_source`, those of
//! the observer by `model_core::observer::design::observer_source`. Once a control period the observer is given what the
//! loop has measured anyway, encoder counts and torque, and says where the gap is; the model, stepped beside it, says
//! what the gears do under these torques.

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

    /// Motor torque [N m] that swings the joint to and fro through its gap.
    const SWING: f32 = 0.5;
    /// Control periods that it acts one way.
    const HALF_SWING: u32 = 2000;
    /// Part of it that is left while the teeth are known to be on their way: a soft landing.
    const IN_THE_GAP: f32 = 0.25;

    /// What stands for encoders and current loop, so that this runs anywhere: a virtual joint. Yours are drivers.
    struct Motor(VirtualJoint<'static, f32, { joint::PLANETS }>);

    impl Motor {
        /// Counts of both encoders with their times, and the torque that was commanded last.
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
            // Yours waits here for its timer.
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

/// There is nothing to run on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
