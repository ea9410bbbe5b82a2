//! A case moved by a method at a rate, in f32 as on a board or in f64: readings at the samples that coincide with steps, and the digest
//! that a board must reach.

use std::f64::consts::TAU;

use baselines::clock::Clock;
use baselines::etd1::Etd1;
use baselines::euler::SemiImplicitEuler;
use baselines::instant::Rotor;
use baselines::motion::{Coordinates, PeerState};
use baselines::moving::{self, Core, GapModel, GearedJoint, StepSchedule, SteppedModel};
use baselines::peer::Start;
use baselines::plant::Plant;
use baselines::runge_kutta::RungeKutta4;
use baselines::scheme::Scheme as PeerScheme;
use baselines::trapezoid::Trapezoid;
use baselines::two_mass::{Contact, TwoMass};
use model_core::gears::design::{DesignError, Effort, Processor, design_scheme};
use model_core::gears::{Kinematics, Model, Relative, Scales, Scheme, State, Tables};
use model_core::numbers::Real;
use parameters::{Excitation, JointParameters};

use crate::case::Case;
use crate::method::{Method, SHARPNESS};
use crate::reading::{Reading, ReadingModel};
use crate::start::InitialState;
use crate::trajectory::Restart;

/// Result of a run.
#[derive(Debug, Clone)]
pub struct Run {
    /// Readings with the index of the reference's sample.
    pub readings: Vec<(usize, Reading)>,
    /// Digest over the last state, and the last before every restart.
    pub digest: u64,
    /// Measured time of the steps [s].
    pub seconds: f64,
}

/// Number of steps of a case at a rate.
pub fn steps(case: &Case, rate: u32) -> u64 {
    (case.duration() * f64::from(rate)).floor() as u64
}

/// Torques by steps of a method at a rate: (first step, drive, load).
pub fn torques_by_step(case: &Case, rate: u32) -> Vec<(u64, f64, f64)> {
    let step = |tick: u64| (tick * u64::from(rate)).div_ceil(u64::from(case.tick_rate));
    case.torques.iter().map(|segment| (step(segment.from_tick), segment.drive_torque, segment.load_torque)).collect()
}

/// Number of sub-steps for the design's choice for half of a board's processor, Verlet sub-steps included.
pub const AS_DESIGNED: u32 = 0;

/// Half of an STM32F405, and one and a half times as much in the worst case.
const HALF: Processor = Processor { share: 0.75, ..Processor::STM32F405 };

/// Tables of the core's step for a tick rate and a number of sub-steps a tick.
pub fn tables<T: Real, const N: usize>(
    joint: &JointParameters,
    rate: u32,
    substeps: u32,
) -> Result<Tables<T, N>, DesignError> {
    let effort = if substeps == AS_DESIGNED { Effort::Within(HALF) } else { Effort::Substeps(substeps) };
    design_scheme(joint, rate, Scheme::Realtime, effort)
}

/// Plant of the baselines for a method at a rate.
pub fn plant<T: Real, const N: usize>(joint: &JointParameters, method: Method, rate: u32) -> Plant<T, N> {
    let mut plant = Plant::new(joint, f64::from(rate));
    if method == Method::RungeKutta4Tanh {
        plant.law = plant.law.smoothed();
        plant.sharpness = T::from_f64(SHARPNESS);
    }
    plant
}

/// First steps of a method, at a rate, after the restarts of a case.
pub fn restarts_by_step(case: &Case, rate: u32) -> impl Iterator<Item = u64> {
    case.restarts.iter().map(move |tick| (tick * u64::from(rate)).div_ceil(u64::from(case.tick_rate)))
}

/// Moves a case at `rate` steps a second, reset at each restart of the case; only the core's step uses `substeps`. `N` must be the joint's
/// number of planets. `clock` [s] is read before the first step and after the last.
pub fn run<T: Real, const N: usize>(
    case: &Case,
    restarts: &[Restart],
    method: Method,
    (rate, substeps): (u32, u32),
    clock: &dyn Fn() -> f64,
) -> Result<Run, DesignError> {
    let starts = InitialState::<N>::all(&case.joint, &case.start, restarts);
    Ok(match method {
        Method::Realtime => {
            let tables: Tables<T, N> = tables(&case.joint, rate, substeps)?;
            let starts: Vec<_> = starts.iter().map(|start| start.state(&case.joint, &tables)).collect();
            let reading_model = ReadingModel::new(&case.joint);
            let read = |state: &State<T, N>| read_core(case, rate, &reading_model, state);
            let mut core = Core::new(Model::new(&tables), &starts);
            follow(case, rate, clock, &mut core, |core| *core.model.state(), read)
        }
        Method::PaperEtd1 => whole::<T, N, Etd1<T>>(case, method, rate, clock, &starts),
        Method::RungeKutta4 | Method::RungeKutta4Tanh => {
            whole::<T, N, RungeKutta4<T, N>>(case, method, rate, clock, &starts)
        }
        Method::Euler => whole::<T, N, SemiImplicitEuler>(case, method, rate, clock, &starts),
        Method::Trapezoid => whole::<T, N, Trapezoid<T, N>>(case, method, rate, clock, &starts),
        Method::TwoMassSpring => two_mass::<T, N>(case, Contact::SpringDamper, rate, clock, &starts),
        Method::TwoMassRestitution => two_mass::<T, N>(case, Contact::Restitution, rate, clock, &starts),
    })
}

fn whole<T: Real, const N: usize, S: PeerScheme<T, N>>(
    case: &Case,
    method: Method,
    rate: u32,
    clock: &dyn Fn() -> f64,
    starts: &[InitialState<N>],
) -> Run {
    let plant = plant(&case.joint, method, rate);
    let starts: Vec<Start<T, N>> = starts.iter().map(|start| start.peer(&case.joint, f64::from(rate))).collect();
    let reading_model = ReadingModel::new(&case.joint);
    // Angle of the rigid carrier with whole turns, and the clock's place at the last reading.
    let (mut carrier, mut last) = (0.0, 0_u64);
    let read = |(motion, clock): &(PeerState<T, N>, Clock<T>)| {
        let wide = |values: &Coordinates<T, N>| Coordinates {
            planets: values.planets.map(Real::to_f64),
            gap: values.gap.to_f64(),
            wind_up: values.wind_up.to_f64(),
        };
        let motion = PeerState { position: wide(&motion.position), rate: wide(&motion.rate) };
        if let Some(place) = clock.carrier() {
            carrier += TAU * place.wrapping_sub(last) as i64 as f64 / TURN;
            last = place;
        }
        let now = clock.now();
        let phase = Rotor { sine: now.sine.to_f64(), cosine: now.cosine.to_f64(), rate: now.rate.to_f64() };
        reading_model.read(&motion, &phase, carrier)
    };
    let mut whole = GearedJoint::<T, N, S>::new(&plant, &starts).expect("a case has a start");
    follow(case, rate, clock, &mut whole, |whole| (*whole.peer.motion(), *whole.peer.clock()), read)
}

fn two_mass<T: Real, const N: usize>(
    case: &Case,
    contact: Contact,
    rate: u32,
    clock: &dyn Fn() -> f64,
    starts: &[InitialState<N>],
) -> Run {
    let model = TwoMass::<T>::new(&case.joint, f64::from(rate), contact);
    let carriers: Vec<_> =
        starts.iter().map(|start| RigidCarrier::new(&case.joint, TAU * start.turns, start.speed, rate)).collect();
    let place_and_rate = |start: &InitialState<N>| <[f64; 2]>::from(start.two_mass(&case.joint)).map(T::from_f64);
    let starts: Vec<[T; 2]> = starts.iter().map(place_and_rate).collect();
    let mut carried =
        TwoMassWithCarrier { gap: GapModel::new(&model, &starts), carrier: carriers[0].clone(), carriers };
    // Link angle and mesh force.
    let moment = |it: &TwoMassWithCarrier<'_, T>| {
        let TwoMassWithCarrier { gap: GapModel { peer, .. }, carrier, .. } = it;
        (carrier.angle + peer.link_offset().to_f64(), peer.mesh_force().to_f64().abs())
    };
    let read = |&(link_angle, mesh_force): &(f64, f64)| Reading { deflections: Vec::new(), link_angle, mesh_force };
    follow(case, rate, clock, &mut carried, moment, read)
}

/// Runs a model: `moment` records the data of a reading, and `read` computes the readings in order once the clock has stopped.
fn follow<T: Real, M: SteppedModel<T>, X>(
    case: &Case,
    rate: u32,
    clock: &dyn Fn() -> f64,
    moving: &mut M,
    moment: impl Fn(&M) -> X,
    mut read: impl FnMut(&X) -> Reading,
) -> Run {
    let schedule = StepSchedule {
        steps: steps(case, rate),
        restarts: restarts_by_step(case, rate),
        changes: torques_by_step(case, rate)
            .into_iter()
            .map(|(step, drive, load)| (step, T::from_f64(drive), T::from_f64(load))),
    };
    // Steps that coincide with a sample of the reference.
    let divisor = greatest_common_divisor(rate, case.sample_rate);
    let (every, stride) = (u64::from(rate / divisor), (case.sample_rate / divisor) as usize);
    let mut moments = Vec::with_capacity((schedule.steps / every) as usize + 1);
    let mut until_sample = 0;
    let look = |moving: &M| {
        if until_sample == 0 {
            moments.push(moment(moving));
            until_sample = every;
        }
        until_sample -= 1;
    };
    let start = clock();
    let digest = moving::follow(moving, schedule, look, M::step);
    let seconds = clock() - start;
    let readings = moments.iter().enumerate().map(|(index, moment)| (index * stride, read(moment))).collect();
    Run { readings, digest, seconds }
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// Reading of a state of the core.
fn read_core<T: Real, const N: usize>(
    case: &Case,
    rate: u32,
    reading_model: &ReadingModel<N>,
    state: &State<T, N>,
) -> Reading {
    let wide = |values: &Relative<T, N>| Coordinates {
        planets: values.planets.map(Real::to_f64),
        gap: values.gap.to_f64(),
        wind_up: values.wind_up.to_f64(),
    };
    let motion = PeerState { position: wide(&state.position), rate: wide(&state.rate) };
    let turns = |part: u64| TAU * (part as f64 / TURN);
    let carrier = TAU * f64::from(state.rigid.turns) + turns(state.rigid.fraction);
    let speed = TAU * state.rigid.speed as f64 / TURN * f64::from(rate);
    let teeth = case.joint.geometry.ring_teeth;
    let frequency = Scales::new(&case.joint).frequency;
    let (angle, rate, carrier) = match case.joint.excitation {
        Excitation::Time { mesh_frequency } => (turns(state.phase), mesh_frequency, 0.0),
        Excitation::Angle => {
            (turns(state.rigid.fraction.wrapping_mul(teeth.into())), f64::from(teeth) * speed, carrier)
        }
    };
    let (sine, cosine) = angle.sin_cos();
    reading_model.read(&motion, &Rotor { sine, cosine, rate: rate / frequency }, carrier)
}

/// One turn, 2^64.
const TURN: f64 = 18_446_744_073_709_551_616.0;

/// Two-mass model with the rigid carrier that it lacks, and the carrier's state at each restart.
struct TwoMassWithCarrier<'a, T: Real> {
    gap: GapModel<'a, T>,
    carrier: RigidCarrier,
    carriers: Vec<RigidCarrier>,
}

impl<T: Real> SteppedModel<f64> for TwoMassWithCarrier<'_, T> {
    fn restart(&mut self, count: usize) {
        self.gap.restart(count);
        self.carrier = self.carriers[count].clone();
    }

    fn set_torques(&mut self, drive: f64, load: f64) {
        self.gap.set_torques(T::from_f64(drive), T::from_f64(load));
        self.carrier.set_torques(drive, load);
    }

    fn step(&mut self) {
        self.gap.step();
        self.carrier.step();
    }

    fn digest(&self) -> u64 {
        self.gap.digest()
    }
}

/// Exact rigid motion beside a model without it; zero where the phase is prescribed.
#[derive(Clone)]
struct RigidCarrier {
    angle: f64,
    speed: f64,
    acceleration: f64,
    gains: [f64; 2],
    step: f64,
}

impl RigidCarrier {
    fn new(joint: &JointParameters, angle: f64, speed: f64, rate: u32) -> Self {
        let (sun_lever, lever) = (joint.geometry.sun_base_radius, joint.geometry.carrier_base_radius());
        let mass = model_core::gears::design::dynamics::MovingMasses::new(joint).rigid(joint.geometry.planets);
        let counts = matches!(joint.excitation, Excitation::Angle);
        let gains = [2.0 / (sun_lever * mass * lever), 1.0 / (lever * mass * lever)];
        Self {
            angle: if counts { angle } else { 0.0 },
            speed: if counts { speed } else { 0.0 },
            acceleration: 0.0,
            gains: if counts { gains } else { [0.0; 2] },
            step: 1.0 / f64::from(rate),
        }
    }

    fn set_torques(&mut self, drive: f64, load: f64) {
        self.acceleration = self.gains[0] * drive - self.gains[1] * load;
    }

    fn step(&mut self) {
        self.angle += self.step * (self.speed + 0.5 * self.step * self.acceleration);
        self.speed += self.step * self.acceleration;
    }
}
