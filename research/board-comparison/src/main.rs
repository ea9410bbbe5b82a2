#![cfg_attr(target_os = "none", no_std, no_main)]
//! The comparison of fixed-step methods on the emulated core: each job moves a case by a method and prints the instructions of its steps
//! and the digest of its last state. The host generates the jobs and knows the expected digests.

#[cfg(target_os = "none")]
mod comparison {
    use core::hint::black_box;

    use baselines::moving::{self, Core, GapModel, GearedJoint, SteppedModel};
    use baselines::peer::Start;
    use baselines::plant::Plant;
    use baselines::scheme::Scheme;
    use baselines::two_mass::TwoMass;
    use cortex_m::peripheral::Peripherals;
    use cortex_m_rt::entry;
    use firmware::measuring::{self, InstructionCounter};
    use model_core::gears::{Model, State, Tables};

    /// All jobs, as `run(runner)`.
    mod jobs {
        #![allow(clippy::all, clippy::excessive_precision, reason = "generated numbers")]
        include!(env!("COMPARISON_JOBS"));
    }

    /// Torques from a tick of the case on [N m].
    pub struct Change {
        tick: u32,
        drive: f32,
        load: f32,
    }

    /// Steps of a job, their rate, torques and restarts.
    pub struct StepSchedule {
        steps: u32,
        /// Step rate [Hz].
        rate: u32,
        /// Tick rate [Hz].
        tick_rate: u32,
        torques: &'static [Change],
        /// Ticks at whose beginning the next start is used.
        restarts: &'static [u32],
    }

    /// Sample rates for which instructions are summed as well: control rates of joints [Hz].
    const SAMPLE_RATES: [u32; 3] = [10_000, 20_000, 40_000];

    /// Largest sum of instructions within a sample.
    #[derive(Clone, Copy)]
    struct Sample {
        steps: u32,
        done: u32,
        sum: u32,
        most: u32,
    }

    impl Sample {
        fn new(rate: u32, sample_rate: u32) -> Self {
            let steps = if rate.is_multiple_of(sample_rate) { rate / sample_rate } else { 0 };
            Self { steps, done: 0, sum: 0, most: 0 }
        }

        fn add(&mut self, count: u32) {
            if self.steps == 0 {
                return;
            }
            (self.done, self.sum) = (self.done + 1, self.sum + count);
            if self.done == self.steps {
                self.most = self.most.max(self.sum);
                (self.done, self.sum) = (0, 0);
            }
        }
    }

    /// Runs jobs, counts their instructions and prints the results.
    pub struct JobRunner {
        counter: InstructionCounter,
    }

    impl JobRunner {
        /// Runs the core with the scheme of its tables.
        pub fn core<const N: usize>(
            &self,
            job: u32,
            tables: &Tables<f32, N>,
            starts: &[State<f32, N>],
            schedule: &StepSchedule,
        ) {
            self.run(job, schedule, &mut Core::new(Model::new(black_box(tables)), black_box(starts)));
        }

        /// Runs a baseline.
        pub fn peer<const N: usize, S: Scheme<f32, N>>(
            &self,
            job: u32,
            plant: &Plant<f32, N>,
            starts: &[Start<f32, N>],
            schedule: &StepSchedule,
        ) {
            if let Some(mut whole) = GearedJoint::<f32, N, S>::new(black_box(plant), black_box(starts)) {
                self.run(job, schedule, &mut whole);
            }
        }

        /// Runs the two-mass model from displacements and their rates.
        pub fn two_mass(&self, job: u32, model: &TwoMass<f32>, starts: &[[f32; 2]], schedule: &StepSchedule) {
            self.run(job, schedule, &mut GapModel::new(black_box(model), black_box(starts)));
        }

        fn run<M: SteppedModel<f32>>(&self, job: u32, schedule: &StepSchedule, moving: &mut M) {
            let begins = |tick: u32| (u64::from(tick) * u64::from(schedule.rate)).div_ceil(schedule.tick_rate.into());
            let (mut sum, mut most) = (0_u64, 0);
            let mut samples = SAMPLE_RATES.map(|sample_rate| Sample::new(schedule.rate, sample_rate));
            let steps = moving::StepSchedule {
                steps: black_box(schedule.steps).into(),
                restarts: black_box(schedule.restarts).iter().map(|tick| begins(*tick)),
                changes: black_box(schedule.torques)
                    .iter()
                    .map(|change| (begins(change.tick), change.drive, change.load)),
            };
            let step = |moving: &mut M| {
                let count = self.counter.count(|| call(moving));
                sum += u64::from(count);
                most = most.max(count);
                samples.iter_mut().for_each(|sample| sample.add(count));
            };
            let digest = moving::follow(moving, steps, |_| (), step);
            let [slow, middle, fast] = samples.map(|sample| sample.most);
            measuring::print_line(format_args!(
                "{job},{},{sum},{most},{slow},{middle},{fast},{digest:016x}",
                schedule.steps
            ));
        }
    }

    /// Call that is not inlined, so that no code moves out of the count.
    #[inline(never)]
    fn call<M: SteppedModel<f32>>(moving: &mut M) {
        moving.step();
    }

    #[entry]
    fn main() -> ! {
        if let Some(core) = Peripherals::take() {
            jobs::run(&JobRunner { counter: InstructionCounter::start(core.SYST) });
        }
        measuring::finish()
    }
}

/// Nothing runs on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
