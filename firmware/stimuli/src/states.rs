//! Single states for trials of a step, random and adversarial: every contact set, all meshes crossing at once, grazing
//! and exact touch, speeds that cross the whole gap in a tick, numbers at the limits of their range, states reached by
//! the joint itself, and variations of the worst states so far.

use core::array;

use model_core::gears::{Model, Relative, RigidBody, State, Tables, Torques};

use crate::random::Random;
use crate::torque::{NONE, TorqueScale};

/// Origin of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Any contact set at moderate speeds.
    AnySet,
    /// Every mesh inside its gap, fast enough to cross it within the tick.
    AllCrossing,
    /// Teeth that touch exactly, or as nearly as floating point allows, with little speed.
    Grazing,
    /// Speeds of many gaps per tick, different for each mesh.
    Fast,
    /// Zeros, denormal and huge numbers, infinities, NaN.
    Extreme,
    /// State reached by the joint itself.
    Reached,
    /// Variation of the worst state so far.
    Mutated,
}

impl Kind {
    /// All origins.
    pub const ALL: [Self; 7] =
        [Self::AnySet, Self::AllCrossing, Self::Grazing, Self::Fast, Self::Extreme, Self::Reached, Self::Mutated];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::AnySet => "any contact set",
            Self::AllCrossing => "all crossing at once",
            Self::Grazing => "grazing, touching",
            Self::Fast => "many gaps a tick",
            Self::Extreme => "ends of the random",
            Self::Reached => "reached by itself",
            Self::Mutated => "worst so far, changed",
        }
    }
}

/// State and torques of a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial<const N: usize> {
    /// Origin of the trial.
    pub kind: Kind,
    /// State before the tick.
    pub state: State<f32, N>,
    /// Torques of the tick.
    pub torques: Torques<f32>,
}

/// Numbers at the limits of their range.
const EXTREMES: [f32; 12] = [
    0.0,
    -0.0,
    f32::from_bits(1),
    -f32::MIN_POSITIVE / 2.0,
    1e-30,
    -1e-12,
    1e9,
    -1e20,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

/// Generator of trials for a joint.
pub struct Trials<'a, const N: usize> {
    tables: &'a Tables<f32, N>,
    random: Random,
    /// Length of a tick, in dimensionless time.
    tick: f32,
    /// Greatest half-backlash; 1 for a joint without backlash.
    half_gap: f32,
    size: TorqueScale,
    reached: State<f32, N>,
    torques: Torques<f32>,
    worst: Option<Trial<N>>,
}

impl<'a, const N: usize> Trials<'a, N> {
    /// Returns the generator of a seed.
    pub fn new(tables: &'a Tables<f32, N>, seed: u64) -> Self {
        let widest = tables.meshes.iter().flatten().fold(0.0, |most: f32, mesh| most.max(mesh.half_backlash));
        Self {
            tables,
            random: Random::new(seed),
            tick: tables.substep * tables.substeps as f32,
            half_gap: if widest > 0.0 { widest } else { 1.0 },
            size: TorqueScale::of(tables),
            reached: State::REST,
            torques: NONE,
            worst: None,
        }
    }

    /// Returns the next trial.
    pub fn make(&mut self) -> Trial<N> {
        let kind = Kind::ALL[self.random.below(Kind::ALL.len() as u32) as usize];
        match (kind, self.worst) {
            (Kind::Reached, _) => self.continue_reached(),
            (Kind::Mutated, Some(worst)) => self.mutate(worst),
            (Kind::Mutated, None) => self.random_trial(Kind::AnySet),
            _ => self.random_trial(kind),
        }
    }

    /// Records the result of a trial; later variations start from the last worst trial.
    pub fn stepped(&mut self, trial: &Trial<N>, after: &State<f32, N>, is_worst: bool) {
        if trial.kind == Kind::Reached {
            self.reached = if after.is_finite() { *after } else { State::REST };
        }
        if is_worst {
            self.worst = Some(*trial);
        }
    }

    /// Continues from the last state of the joint; one trial in a hundred draws new torques.
    fn continue_reached(&mut self) -> Trial<N> {
        if self.random.below(100) == 0 {
            self.torques = self.size.any(&mut self.random);
        }
        Trial { kind: Kind::Reached, state: self.reached, torques: self.torques }
    }

    fn random_trial(&mut self, kind: Kind) -> Trial<N> {
        let (rigid, phase) = (self.rigid(), self.random.bits());
        let mut state = State { rigid, phase, ..State::REST };
        // Imposed errors at this phase: coordinate less deflection of each mesh.
        let mut model = Model::new(self.tables);
        model.set_state(state);
        let length = self.tables.units.length;
        let errors = model.outputs().deflections.map(|family| family.map(|deflection| -deflection / length));

        let leap = self.half_gap / self.tick * self.magnitude(-1, 1);
        let way = if self.random.below(2) == 0 { leap } else { -leap };
        let sun: [f32; N] = array::from_fn(|i| errors[0][i] + self.deflection(kind, 0, i));
        let chosen = self.random.below(N as u32) as usize;
        let ring = self.deflection(kind, 1, chosen);
        state.position = Relative {
            planets: sun,
            gap: sun[chosen] + errors[1][chosen] + ring,
            wind_up: self.random.signed() * self.half_gap,
        };
        let near = |random: &mut Random, value: f32| value * (1.0 + 0.2 * random.signed());
        state.rate = match kind {
            Kind::AllCrossing => Relative {
                planets: array::from_fn(|_| near(&mut self.random, way)),
                gap: near(&mut self.random, 2.0 * way),
                wind_up: near(&mut self.random, way),
            },
            Kind::Grazing => self.rates(1e-6),
            Kind::Fast => self.rates(10.0 * self.half_gap / self.tick),
            _ => self.rates(0.2 * self.half_gap / self.tick),
        };
        let mut trial = Trial { kind, state, torques: self.torques() };
        if kind == Kind::Extreme {
            for_each_number(&mut trial, |value| {
                if self.random.below(3) == 0 {
                    *value = EXTREMES[self.random.below(EXTREMES.len() as u32) as usize];
                }
            });
        }
        trial
    }

    /// Changes one to all numbers of a trial, most of them slightly.
    fn mutate(&mut self, worst: Trial<N>) -> Trial<N> {
        let mut trial = Trial { kind: Kind::Mutated, ..worst };
        let one_in = 1 + self.random.below(8);
        let width = self.magnitude(-5, 0);
        for_each_number(&mut trial, |value| {
            if self.random.below(one_in) == 0 {
                *value *= 1.0 + width * self.random.signed();
            }
        });
        if self.random.below(4) == 0 {
            trial.state.phase = self.random.bits();
            trial.state.rigid.fraction = self.random.bits();
        }
        trial
    }

    fn deflection(&mut self, kind: Kind, family: usize, planet: usize) -> f32 {
        let half = self.tables.meshes[family][planet].half_backlash;
        let side = if self.random.below(2) == 0 { half } else { -half };
        match kind {
            Kind::Grazing => match self.random.below(4) {
                0 => side,
                1 => side.next_up(),
                2 => side.next_down(),
                _ => side + 1e-5 * self.half_gap * self.random.signed(),
            },
            Kind::AllCrossing => 1.2 * half * self.random.signed(),
            _ => match self.random.below(3) {
                0 => half * self.random.signed(),
                _ => side + self.half_gap * self.random.signed() * self.magnitude(-4, 0),
            },
        }
    }

    fn rates(&mut self, most: f32) -> Relative<f32, N> {
        // In some trials the whole joint is at rest.
        let most = if self.random.below(8) == 0 { 0.0 } else { most };
        let mut any = || most * self.random.signed();
        Relative { planets: array::from_fn(|_| any()), gap: any(), wind_up: any() }
    }

    fn rigid(&mut self) -> RigidBody {
        let speed = match self.random.below(8) {
            0 => 0,
            1 => i64::MAX,
            2 => i64::MIN,
            // Up to a few turns per second, or up to a turn in two ticks.
            3..=5 => (self.random.bits() as i64) >> 14,
            _ => self.random.bits() as i64,
        };
        RigidBody { turns: self.random.bits() as i32, fraction: self.random.bits(), speed }
    }

    fn torques(&mut self) -> Torques<f32> {
        let scale = match self.random.below(8) {
            0 => 0.0,
            1 => 1e3,
            2 => 1e-6,
            _ => 1.0,
        };
        Torques {
            drive: self.size.drive * scale * self.random.signed(),
            load: self.size.load * scale * self.random.signed(),
        }
    }

    /// Returns a magnitude from 10^`from` to 10^`to`.
    fn magnitude(&mut self, from: i32, to: i32) -> f32 {
        let power = from + self.random.below(to.abs_diff(from)) as i32;
        let factor = if power < 0 { 0.1 } else { 10.0 };
        (0..power.unsigned_abs()).fold(1.0 + 9.0 * self.random.fraction(), |size, _| size * factor)
    }
}

/// Visits every real number of a trial.
fn for_each_number<const N: usize>(trial: &mut Trial<N>, mut show: impl FnMut(&mut f32)) {
    for relative in [&mut trial.state.position, &mut trial.state.rate] {
        relative.planets.iter_mut().for_each(&mut show);
        show(&mut relative.gap);
        show(&mut relative.wind_up);
    }
    show(&mut trial.torques.drive);
    show(&mut trial.torques.load);
}

/// Number of trials for a joint with `planets` planets: a million for the usual three, else as many as a minute allows.
pub const fn count(planets: usize) -> u32 {
    if planets == 3 { 1_000_000 } else { 200_000 }
}
