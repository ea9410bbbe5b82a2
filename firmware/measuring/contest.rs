#![cfg_attr(target_os = "none", no_std, no_main)]
//! The comparison of fixed-step methods on the emulated core: each job moves a case by a method and says what a step took
//! and the digest of where it came to. The jobs are written by the host, which knows the right digests.

#[cfg(target_os = "none")]
mod contest {
    use core::hint::black_box;

    use cortex_m::peripheral::Peripherals;
    use cortex_m_rt::entry;
    use firmware::measuring::{self, InstructionCounter};
    use model_core::digest;
    use model_core::realtime::{Model, State, Torques};
    use model_core::tables::Tables;
    use peers::peer::{Peer, Start};
    use peers::plant::Plant;
    use peers::scheme::Scheme;
    use peers::two_mass::{TwoMass, TwoMassPeer};

    /// Every job, as `run(race)`.
    mod jobs {
        #![allow(clippy::all, clippy::excessive_precision, reason = "generated numbers")]
        include!(env!("CONTEST_JOBS"));
    }

    /// Torques from a tick of the case on [N m].
    pub struct Change {
        tick: u32,
        drive: f32,
        load: f32,
    }

    /// How far, how fast, and under what torques.
    pub struct Way {
        steps: u32,
        /// Steps in a second.
        rate: u32,
        /// Ticks in a second.
        tick_rate: u32,
        torques: &'static [Change],
    }

    /// Samples in a second within which the work is summed too: control rates of joints.
    const SAMPLE_RATES: [u32; 3] = [10_000, 20_000, 40_000];

    /// Greatest sum of instructions within a sample.
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

    /// Counts and tells.
    pub struct Race {
        counter: InstructionCounter,
    }

    /// Something that moves in steps.
    trait Moving {
        fn set_torques(&mut self, drive: f32, load: f32);
        fn step(&mut self);
        fn digest(&self) -> u64;
    }

    impl Race {
        /// The core, by the scheme of its tables.
        pub fn core<const N: usize>(&self, job: u32, tables: &Tables<f32, N>, start: &State<f32, N>, way: &Way) {
            let mut model = Model::new(black_box(tables));
            model.set_state(*black_box(start));
            self.run(job, way, &mut Core { model, torques: Torques { drive: 0.0, load: 0.0 } });
        }

        /// A peer.
        pub fn peer<const N: usize, S: Scheme<f32, N>>(
            &self,
            job: u32,
            plant: &Plant<f32, N>,
            start: &Start<f32, N>,
            way: &Way,
        ) {
            self.run(job, way, &mut Peer::<f32, N, S>::new(black_box(plant), black_box(start)));
        }

        /// The model of two masses, from a displacement and its rate.
        pub fn two_mass(&self, job: u32, model: &TwoMass<f32>, place: f32, rate: f32, way: &Way) {
            self.run(job, way, &mut TwoMassPeer::new(black_box(model), black_box(place), black_box(rate)));
        }

        fn run<M: Moving>(&self, job: u32, way: &Way, moving: &mut M) {
            let mut changes = black_box(way.torques).iter().peekable();
            let begins = |tick: u32| (u64::from(tick) * u64::from(way.rate)).div_ceil(way.tick_rate.into());
            let (mut sum, mut most) = (0_u64, 0);
            let mut samples = SAMPLE_RATES.map(|sample_rate| Sample::new(way.rate, sample_rate));
            for step in 0..black_box(way.steps) {
                while let Some(change) = changes.next_if(|change| begins(change.tick) <= step.into()) {
                    moving.set_torques(change.drive, change.load);
                }
                let count = self.counter.count(|| call(moving));
                sum += u64::from(count);
                most = most.max(count);
                samples.iter_mut().for_each(|sample| sample.add(count));
            }
            let [slow, middle, fast] = samples.map(|sample| sample.most);
            let digest = moving.digest();
            measuring::say(format_args!("{job},{},{sum},{most},{slow},{middle},{fast},{digest:016x}", way.steps));
        }
    }

    /// A call that is not inlined, so that nothing moves out of the count.
    #[inline(never)]
    fn call<M: Moving>(moving: &mut M) {
        moving.step();
    }

    struct Core<'a, const N: usize> {
        model: Model<'a, f32, N>,
        torques: Torques<f32>,
    }

    impl<const N: usize> Moving for Core<'_, N> {
        fn set_torques(&mut self, drive: f32, load: f32) {
            self.torques = Torques { drive, load };
        }

        #[inline(always)]
        fn step(&mut self) {
            self.model.step(self.torques);
        }

        fn digest(&self) -> u64 {
            self.model.state_digest()
        }
    }

    impl<const N: usize, S: Scheme<f32, N>> Moving for Peer<'_, f32, N, S> {
        fn set_torques(&mut self, drive: f32, load: f32) {
            Peer::set_torques(self, drive, load);
        }

        #[inline(always)]
        fn step(&mut self) {
            Peer::step(self);
        }

        fn digest(&self) -> u64 {
            self.motion().digest()
        }
    }

    impl Moving for TwoMassPeer<'_, f32> {
        fn set_torques(&mut self, drive: f32, load: f32) {
            TwoMassPeer::set_torques(self, drive, load);
        }

        #[inline(always)]
        fn step(&mut self) {
            TwoMassPeer::step(self);
        }

        fn digest(&self) -> u64 {
            digest::chain(digest::START, self.link_offset().to_bits().into())
        }
    }

    #[entry]
    fn main() -> ! {
        if let Some(core) = Peripherals::take() {
            jobs::run(&Race { counter: InstructionCounter::start(core.SYST) });
        }
        measuring::finish()
    }
}

/// There is nothing to run on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
