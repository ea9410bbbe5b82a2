#![cfg_attr(target_os = "none", no_std, no_main)]
//! Counts the instructions of the roles that control, tick by tick, in a motion with reversals, pushes and a silent
//! output encoder: the work of each role's tick, and the observer alone, with and without error maps.

#[cfg(target_os = "none")]
mod measurement {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use firmware::measuring::{self, InstructionCounter};
    use firmware::observer::Observing;
    use firmware::plant::Plant;
    use firmware::port::Direct;
    use firmware::tables::{JOINT_NAME, TABLES};
    use firmware::whole_loop::WholeLoop;
    use firmware::work::Work;
    use link::controller::Exchange;
    use link::messages::Command;
    use link::virtual_joint::{Knot, WireTrajectory};
    use model_core::controller::Controller;
    use model_core::numbers::phase::sine_cosine;
    use model_core::observer::{MAPPED, Observer, PLAIN, Samples};
    use model_core::virtual_joint::VirtualJoint;

    mod control {
        #![allow(dead_code, clippy::excessive_precision, reason = "generated numbers")]
        include!(concat!(env!("OUT_DIR"), "/control.rs"));
    }

    /// Control periods: enough to estimate every parameter and to meet every flank some twenty times.
    const PERIODS: u32 = 30_000;
    /// Periods between two knots of the motion.
    const SEGMENT: u32 = 50;
    /// Periods without output encoder: a tenth of a second in the middle.
    const SILENT: core::ops::Range<u32> = 15_000..16_000;
    /// Amplitude [turns] and rate [1/s] of the motion.
    const MOTION: [f32; 2] = [0.05, 1.0];

    /// Instructions of one role.
    struct Count {
        name: &'static str,
        /// RAM [byte].
        bytes: usize,
        sum: u64,
        most: u32,
        at: u32,
    }

    impl Count {
        const fn of<W>(name: &'static str, _work: &W) -> Self {
            Self { name, bytes: size_of::<W>(), sum: 0, most: 0, at: 0 }
        }

        fn add(&mut self, period: u32, instructions: u32) {
            self.sum += u64::from(instructions);
            if instructions > self.most {
                (self.most, self.at) = (instructions, period);
            }
        }

        fn tell(&self) {
            measuring::print_line(format_args!(
                "role;{};{JOINT_NAME};{PERIODS};{};{};{};{}",
                self.name, self.sum, self.most, self.at, self.bytes
            ));
        }
    }

    #[inline(never)]
    fn step(work: &mut impl Work) {
        work.step();
    }

    #[inline(never)]
    fn observe<const P: usize>(observer: &mut Observer<'_, f32, P>, samples: &Samples<f32>) {
        observer.step(samples);
    }

    /// Set-points from a period on: a sine by its first three powers, with a push of alternating sign.
    fn knot(tick: u32) -> Knot {
        let [amplitude, rate] = MOTION;
        let turn = control::SURROUNDINGS.turn;
        let phase = (control::SURROUNDINGS.period * tick as f32 * rate * 4_294_967_296.0) as u64 as u32;
        let (sine, cosine) = sine_cosine::<f32>(phase);
        let speed = turn * rate;
        let powers = [
            amplitude * sine,
            amplitude * speed * cosine,
            -0.5 * amplitude * speed * speed * sine,
            -amplitude * speed * speed * speed * cosine / 6.0,
            0.0,
            0.0,
        ];
        let load_torque = if (tick / 1700).is_multiple_of(2) { 1.0 } else { -1.0 };
        Knot { tick, load_torque, trajectory: WireTrajectory::Position((0, powers), Some((0, powers))) }
    }

    fn controller() -> Direct<'static> {
        Direct(Controller::with_tables(&control::OBSERVER, &control::COMPENSATION))
    }

    #[entry]
    fn main() -> ! {
        // Always available: the only user in this image, called once.
        if let Some(core) = cortex_m::Peripherals::take() {
            measure(&InstructionCounter::start(core.SYST));
        }
        measuring::finish()
    }

    fn measure(counter: &InstructionCounter) {
        let mut joint = VirtualJoint::new(&TABLES, &control::SURROUNDINGS);
        let mut shadow = Plant::new(&TABLES);
        let mut observing = Observing::new(controller(), true);
        let mut looping = WholeLoop::new(&TABLES, &control::SURROUNDINGS, controller());
        let mut plain = Observer::<f32, PLAIN>::new(&control::OBSERVER);
        let mut mapped = Observer::<f32, MAPPED>::new(&control::OBSERVER);
        let mut counts = [
            Count::of("plant", &shadow),
            Count::of("observer", &observing),
            Count::of("loop", &looping),
            Count::of("observer alone without error maps", &plain),
            Count::of("observer alone with error maps", &mapped),
        ];
        let mut now = knot(0);
        for tick in 0..PERIODS {
            if tick.is_multiple_of(SEGMENT) {
                now = knot(tick);
                looping.take(now);
            }
            let elapsed = control::SURROUNDINGS.period * (tick - now.tick) as f32;
            let command = model_core::controller::trajectory::Trajectory::from(now.trajectory)
                .at(elapsed, control::SURROUNDINGS.turn);
            let mut samples = joint.samples();
            if SILENT.contains(&tick) {
                samples.output = None;
            }
            observing.take(Exchange::new(tick, &samples, &command));
            let [of_plant, of_observer, of_loop, of_plain, of_mapped] = &mut counts;
            of_observer.add(tick, counter.count(|| step(black_box(&mut observing))));
            of_loop.add(tick, counter.count(|| step(black_box(&mut looping))));
            of_plain.add(tick, counter.count(|| observe(black_box(&mut plain), &samples)));
            of_mapped.add(tick, counter.count(|| observe(black_box(&mut mapped), &samples)));
            joint.advance(observing.sample(tick, 0).shaped.torque, now.load_torque);
            let acting = joint.acting();
            shadow.take(Command { tick, drive_torque: acting.drive, load_torque: acting.load });
            of_plant.add(tick, counter.count(|| step(black_box(&mut shadow))));
        }
        counts.iter().for_each(Count::tell);
    }
}

/// Empty on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
