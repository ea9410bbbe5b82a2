#![cfg_attr(target_os = "none", no_std, no_main)]
//! The comparison of fixed-step methods on the emulated core: each job moves a case by a method and says what a step took
//! and the digest of where it came to. The jobs are written by the host, which knows the right digests.

#[cfg(target_os = "none")]
mod contest {
    use core::hint::black_box;

    use cortex_m::peripheral::Peripherals;
    use cortex_m_rt::entry;
    use firmware::measuring::{self, InstructionCounter};
    use model_core::gears::{Model, State, Tables, Torques};
    use model_core::numbers::digest;
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
        /// Ticks at whose beginning the next start is taken.
        restarts: &'static [u32],
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
        /// Puts it back to the so-many-th start.
        fn restart(&mut self, count: usize);
        fn set_torques(&mut self, drive: f32, load: f32);
        fn step(&mut self);
        fn digest(&self) -> u64;
    }

    impl Race {
        /// The core, by the scheme of its tables.
        pub fn core<const N: usize>(&self, job: u32, tables: &Tables<f32, N>, starts: &[State<f32, N>], way: &Way) {
            let model = Model::new(black_box(tables));
            let starts = black_box(starts);
            self.run(job, way, &mut Core { model, starts, torques: Torques { drive: 0.0, load: 0.0 } });
        }

        /// A peer.
        pub fn peer<const N: usize, S: Scheme<f32, N>>(
            &self,
            job: u32,
            plant: &Plant<f32, N>,
            starts: &[Start<f32, N>],
            way: &Way,
        ) {
            let (plant, starts) = (black_box(plant), black_box(starts));
            let Some(start) = starts.first() else { return };
            self.run(job, way, &mut Whole::<N, S> { peer: Peer::new(plant, start), plant, starts });
        }

        /// The model of two masses, from displacements and their rates.
        pub fn two_mass(&self, job: u32, model: &TwoMass<f32>, starts: &[[f32; 2]], way: &Way) {
            let (model, starts) = (black_box(model), black_box(starts));
            self.run(job, way, &mut Gap { peer: TwoMassPeer::new(model, 0.0, 0.0), model, starts });
        }

        fn run<M: Moving>(&self, job: u32, way: &Way, moving: &mut M) {
            let mut changes = black_box(way.torques).iter().peekable();
            let mut restarts = black_box(way.restarts).iter().zip(1..).peekable();
            let (mut drive, mut load) = (0.0, 0.0);
            let mut digest = digest::START;
            moving.restart(0);
            let begins = |tick: u32| (u64::from(tick) * u64::from(way.rate)).div_ceil(way.tick_rate.into());
            let (mut sum, mut most) = (0_u64, 0);
            let mut samples = SAMPLE_RATES.map(|sample_rate| Sample::new(way.rate, sample_rate));
            for step in 0..black_box(way.steps) {
                while let Some((_, count)) = restarts.next_if(|(tick, _)| begins(**tick) <= step.into()) {
                    digest = digest::chain(digest, moving.digest());
                    moving.restart(count);
                    moving.set_torques(drive, load);
                }
                while let Some(change) = changes.next_if(|change| begins(change.tick) <= step.into()) {
                    (drive, load) = (change.drive, change.load);
                    moving.set_torques(drive, load);
                }
                let count = self.counter.count(|| call(moving));
                sum += u64::from(count);
                most = most.max(count);
                samples.iter_mut().for_each(|sample| sample.add(count));
            }
            let [slow, middle, fast] = samples.map(|sample| sample.most);
            let digest = digest::chain(digest, moving.digest());
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
        starts: &'a [State<f32, N>],
        torques: Torques<f32>,
    }

    struct Whole<'a, const N: usize, S> {
        peer: Peer<'a, f32, N, S>,
        plant: &'a Plant<f32, N>,
        starts: &'a [Start<f32, N>],
    }

    struct Gap<'a> {
        peer: TwoMassPeer<'a, f32>,
        model: &'a TwoMass<f32>,
        starts: &'a [[f32; 2]],
    }

    impl<const N: usize> Moving for Core<'_, N> {
        fn restart(&mut self, count: usize) {
            if let Some(start) = self.starts.get(count) {
                self.model.set_state(*start);
            }
        }

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

    impl<const N: usize, S: Scheme<f32, N>> Moving for Whole<'_, N, S> {
        fn restart(&mut self, count: usize) {
            if let Some(start) = self.starts.get(count) {
                self.peer = Peer::new(self.plant, start);
            }
        }

        fn set_torques(&mut self, drive: f32, load: f32) {
            self.peer.set_torques(drive, load);
        }

        #[inline(always)]
        fn step(&mut self) {
            self.peer.step();
        }

        fn digest(&self) -> u64 {
            self.peer.motion().digest()
        }
    }

    impl Moving for Gap<'_> {
        fn restart(&mut self, count: usize) {
            if let Some([place, rate]) = self.starts.get(count) {
                self.peer = TwoMassPeer::new(self.model, *place, *rate);
            }
        }

        fn set_torques(&mut self, drive: f32, load: f32) {
            self.peer.set_torques(drive, load);
        }

        #[inline(always)]
        fn step(&mut self) {
            self.peer.step();
        }

        fn digest(&self) -> u64 {
            digest::chain(digest::START, self.peer.link_offset().to_bits().into())
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
