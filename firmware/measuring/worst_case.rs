#![cfg_attr(target_os = "none", no_std, no_main)]
//! Counts the instructions of one step from many states, random and adversarial, for every joint of this image. The
//! crate `stimuli` generates the states.

#[cfg(target_os = "none")]
mod measurement {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use firmware::measuring::{self, InstructionCounter, Visitor, measured};
    use model_core::gears::{Model, Tables, Torques};
    use stimuli::outcome::Class;
    use stimuli::states::{Kind, Trial, Trials};

    const SEED: u64 = 1;

    /// Counts of one kind of trials.
    #[derive(Clone, Copy)]
    struct Count {
        trials: u32,
        sum: u64,
        most: u32,
        /// First trial with the most instructions.
        trial: u32,
    }

    impl Count {
        const NONE: Self = Self { trials: 0, sum: 0, most: 0, trial: 0 };

        fn add(&mut self, trial: u32, instructions: u32) {
            self.trials += 1;
            self.sum += u64::from(instructions);
            if instructions > self.most {
                (self.most, self.trial) = (instructions, trial);
            }
        }
    }

    struct Search {
        counter: InstructionCounter,
    }

    #[inline(never)]
    fn step<const N: usize>(model: &mut Model<'_, f32, N>, torques: Torques<f32>) {
        model.step(torques);
    }

    /// Instructions of the call of a step, which are subtracted.
    #[inline(never)]
    fn no_step<const N: usize>(model: &mut Model<'_, f32, N>, torques: Torques<f32>) {
        black_box((model, torques));
    }

    impl Visitor for Search {
        fn joint<const N: usize>(&mut self, name: &str, tables: &'static Tables<f32, N>) {
            let (mut trials, mut model) = (Trials::new(tables, SEED), Model::new(tables));
            let (mut classes, mut kinds) = ([Count::NONE; Class::ALL.len()], [Count::NONE; Kind::ALL.len()]);
            let mut worst: Option<(u32, Trial<N>)> = None;
            let mut worst_finite = 0;
            for trial_number in 0..stimuli::states::count(N) {
                let trial = trials.make();
                model.set_state(trial.state);
                let before = model.outputs();
                let calling = self.counter.count(|| no_step(black_box(&mut model), black_box(trial.torques)));
                let called = self.counter.count(|| step(black_box(&mut model), black_box(trial.torques)));
                let instructions = called.saturating_sub(calling);
                let class = Class::of(&before, &model.outputs());
                if worst.is_none_or(|(most, _)| instructions > most) {
                    worst = Some((instructions, trial));
                }
                // Non-finite states stay non-finite: nearby states add nothing.
                let is_worst = class != Class::NotFinite && instructions > worst_finite;
                if is_worst {
                    worst_finite = instructions;
                }
                trials.stepped(&trial, model.state(), is_worst);
                classes[class as usize].add(trial_number, instructions);
                kinds[trial.kind as usize].add(trial_number, instructions);
            }
            measuring::print_line(format_args!(
                "joint;{name};{N};{};{};{SEED}",
                tables.substeps, tables.verlet.substeps
            ));
            for (class, count) in Class::ALL.iter().zip(classes) {
                print_count("class", class.name(), count);
            }
            for (kind, count) in Kind::ALL.iter().zip(kinds) {
                print_count("kind", kind.name(), count);
            }
            if let Some((_, trial)) = worst {
                measuring::print_line(format_args!("state;{trial:?}"));
            }
        }
    }

    fn print_count(sort: &str, name: &str, Count { trials, sum, most, trial }: Count) {
        measuring::print_line(format_args!("{sort};{name};{trials};{sum};{most};{trial}"));
    }

    #[entry]
    fn main() -> ! {
        // Always available: the only user in this image, called once.
        if let Some(core) = cortex_m::Peripherals::take() {
            measured::visit(&mut Search { counter: InstructionCounter::start(core.SYST) });
        }
        measuring::finish()
    }
}

/// Empty on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
