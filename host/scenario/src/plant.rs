//! Plant of a run: the fine-step f64 reference or the core's own fixed step, each inside the same drive train. Faults
//! of the teeth reach both through one trait.

use clap::ValueEnum;
use model_core::gears::design::design;
use model_core::gears::{Kinematics, Mechanics, Model, Relative, Scales, State, Tables, Torques};
use parameters::{ContactState, Effect, JointParameters, Surroundings};
use reference::drive_train::{Disturbance, DriveTrain, DriveTrainParameters, JointModel, Stepping};
use reference::joint::{Observation, Reference, ReferenceError, RelativeState, Start, Work};

use board::device::image::DEFAULT_TICK_RATE;
use report::failure::{Failure, Outcome};
use simulation::sim::snapshot::Reader;

/// Model of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlantName {
    /// Fine-step f64 plant that shares nothing with the core but the parameters; bounds are stated on it
    Reference,
    /// Fixed f32 step of the core, as a board runs it
    Core,
}

impl PlantName {
    /// Word in files and commands.
    pub fn word(self) -> &'static str {
        match self {
            Self::Reference => "reference",
            Self::Core => "core",
        }
    }
}

/// A joint whose teeth can change.
pub trait Teeth: JointModel {
    /// Sets the half-backlash of every mesh [m].
    fn set_half_backlash(&mut self, half_backlash: f64);
    /// Sets the mean stiffness of the sun-planet mesh of one planet [N/m].
    fn set_sun_planet_stiffness(&mut self, planet: usize, mean_stiffness: f64);
}

impl Teeth for Reference {
    fn set_half_backlash(&mut self, half_backlash: f64) {
        Reference::set_half_backlash(self, half_backlash);
    }

    fn set_sun_planet_stiffness(&mut self, planet: usize, mean_stiffness: f64) {
        Reference::set_sun_planet_stiffness(self, planet, mean_stiffness);
    }
}

/// A drive train with a joint of either kind.
pub type Plant = DriveTrain<Box<dyn Teeth>>;

/// Joint at rest in the middle of its gap with its drive train; the reference uses the fixed step.
pub fn plant(
    name: PlantName,
    joint: &JointParameters,
    train: &DriveTrainParameters,
    disturbances: Vec<Disturbance>,
    seed: u64,
) -> Outcome<Plant> {
    let centred = Start::Relative(RelativeState::centred(joint.geometry.planets));
    plant_from(name, joint, &centred, train, disturbances, seed).map(|plant| plant.stepped(Stepping::Fixed))
}

/// Joint with its drive train in a given initial state.
pub fn plant_from(
    name: PlantName,
    joint: &JointParameters,
    start: &Start,
    train: &DriveTrainParameters,
    disturbances: Vec<Disturbance>,
    seed: u64,
) -> Outcome<Plant> {
    let refused =
        |error: &dyn std::fmt::Display| Failure::new(format!("joint `{}` cannot be run: {error}", joint.name));
    let mut train = train.clone();
    reject_effects(name, &train.surroundings)?;
    let inside: Box<dyn Teeth> = match name {
        PlantName::Reference => {
            let hysteresis = train.surroundings.hysteresis;
            let reference = Reference::start(joint, start).map_err(|error| refused(&error))?;
            Box::new(reference.with_hysteresis(hysteresis.stiffness_share, hysteresis.torque))
        }
        PlantName::Core => {
            let control_rate = f64::from(train.surroundings.control_rate);
            // A board has whole ticks in a control period, at a rate close to the default tick rate.
            train.parts_per_period = (f64::from(DEFAULT_TICK_RATE) / control_rate).round().max(1.0) as u32;
            let rate = (control_rate * f64::from(train.parts_per_period)).round() as u32;
            match joint.geometry.planets {
                1 => Box::new(CoreJoint::<1>::new(joint, start, rate)?),
                3 => Box::new(CoreJoint::<3>::new(joint, start, rate)?),
                4 => Box::new(CoreJoint::<4>::new(joint, start, rate)?),
                _ => Box::new(CoreJoint::<5>::new(joint, start, rate)?),
            }
        }
    };
    DriveTrain::around(inside, joint, train, disturbances, seed).map_err(|error| refused(&error))
}

/// State of the core's step for an initial state.
fn core_state<const N: usize>(
    joint: &JointParameters,
    tables: &Tables<f32, N>,
    start: &RelativeState,
) -> State<f32, N> {
    let scales = Scales::new(joint);
    let scaled = |planets: &[f64], gap: f64, wind_up: f64, unit: f64| Relative {
        planets: std::array::from_fn(|planet| (planets.get(planet).copied().unwrap_or(0.0) / unit) as f32),
        gap: (gap / unit) as f32,
        wind_up: (wind_up / unit) as f32,
    };
    let deflections = scaled(&start.sun_planet, start.gap, start.wind_up, scales.length);
    let speed_unit = scales.length * scales.frequency;
    let rates = scaled(&start.sun_planet_rate, start.gap_rate, start.wind_up_rate, speed_unit);
    State::from_deflections(tables, &deflections, &rates, start.rigid_speed as f32)
}

/// Rejects effects that the plant does not model.
pub fn reject_effects(name: PlantName, surroundings: &Surroundings) -> Outcome<()> {
    let why = |effect: Effect| match effect {
        Effect::Hysteresis => Some("its spring between carrier and link has no loss but damping"),
        Effect::PayloadStep => Some("its inertias are tables"),
        Effect::ControlJitter => Some("it is stepped by whole ticks"),
        _ => None,
    };
    let lacking = surroundings.effects().find_map(|effect| Some((effect, why(effect)?)));
    match lacking.filter(|_| name == PlantName::Core) {
        Some((effect, why)) => {
            let message = format!("the core's joint cannot have `{}`: {why}", effect.key());
            Err(Failure::new(message).with_help("run it with --plant reference, with --host or --role observer"))
        }
        None => Ok(()),
    }
}

/// Change of the half-backlash after which the core's joint is designed again [-]. Between designs the gap is wrong by
/// at most half of it.
const DESIGN_STEP: f64 = 0.005;

/// The core's fixed step as a joint in motion.
struct CoreJoint<const N: usize> {
    /// Joint with its original or set half-backlash.
    joint: JointParameters,
    /// Half-backlash of the tables over the joint's.
    backlash_scale: f64,
    tables: Tables<f32, N>,
    state: State<f32, N>,
    ticks: u32,
    /// Damping between carrier and link [N m s/rad].
    compliance_damping: f64,
}

impl<const N: usize> CoreJoint<N> {
    fn new(joint: &JointParameters, start: &Start, tick_rate: u32) -> Outcome<Self> {
        let tables: Tables<f32, N> = design(joint, tick_rate).map_err(|error| {
            Failure::new(format!("joint `{}` cannot be designed for {tick_rate} Hz: {error}", joint.name))
                .with_help("--plant reference needs no such design")
        })?;
        let compliance_damping = compliance_damping(joint);
        let state = match start {
            Start::Still => State::REST,
            Start::Relative(start) => core_state(joint, &tables, start),
        };
        Ok(Self { joint: joint.clone(), tables, state, ticks: 0, compliance_damping, backlash_scale: 1.0 })
    }

    fn model(&self) -> Model<'_, f32, N> {
        let mut model = Model::new(&self.tables);
        model.set_state(self.state);
        model
    }

    /// Designs the tables for the current joint. Scales do not depend on the backlash, so the state remains valid. The
    /// design cannot fail for a joint that was designed before.
    fn redesign(&mut self) {
        let mut joint = self.joint.clone();
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.half_backlash.iter_mut().for_each(|value| *value *= self.backlash_scale);
        }
        if let Ok(tables) = design(&joint, self.tables.tick_rate) {
            self.tables = tables;
        }
    }

    /// Rate of an angle relative to its rigid part, for given gains of planets, gap and wind-up [rad/s].
    fn offset_rate(&self, gains: &[f32; 3]) -> f64 {
        let rate = &self.state.rate;
        let planets = rate.planets.iter().map(|rate| f64::from(*rate)).sum::<f64>();
        let rates = [planets, rate.gap.into(), rate.wind_up.into()];
        let sum: f64 = gains.iter().zip(rates).map(|(gain, rate)| f64::from(*gain) * rate).sum();
        sum * Scales::new(&self.joint).frequency
    }
}

/// Damping between carrier and link [N m s/rad].
fn compliance_damping(joint: &JointParameters) -> f64 {
    joint.compliance.map_or(0.0, |compliance| {
        let lever = joint.geometry.carrier_base_radius();
        let sun = joint.bodies.sun_equivalent_mass + joint.rotor_equivalent_mass();
        let planets = joint.geometry.planets as f64 * joint.bodies.planet_equivalent_mass;
        let geared = 4.0 * sun + planets + joint.carrier_equivalent_mass();
        let link = joint.link_equivalent_mass();
        let reduced = geared * link / (geared + link) * lever * lever;
        2.0 * compliance.damping_ratio * (compliance.stiffness * reduced).sqrt()
    })
}

impl<const N: usize> Teeth for CoreJoint<N> {
    fn set_half_backlash(&mut self, half_backlash: f64) {
        let mut joint = self.joint.clone();
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.half_backlash.iter_mut().for_each(|value| *value = half_backlash);
        }
        self.joint = joint;
        self.redesign();
    }

    fn set_sun_planet_stiffness(&mut self, _: usize, _: f64) {
        // The core's planets share their stiffness; a test with this fault is rejected before it runs.
    }
}

impl<const N: usize> JointModel for CoreJoint<N> {
    fn advance(&mut self, time: f64, drive: f64, load: f64, _: Stepping) -> Result<(), ReferenceError> {
        let until = (time * f64::from(self.tables.tick_rate)).round() as u32;
        let mut model = self.model();
        for _ in self.ticks..until {
            model.step(Torques { drive: drive as f32, load: load as f32 });
        }
        self.state = *model.state();
        self.ticks = until;
        Ok(())
    }

    fn scale_half_backlash(&mut self, factor: f64) {
        if (factor - self.backlash_scale).abs() > DESIGN_STEP {
            self.backlash_scale = factor;
            self.redesign();
        }
    }

    /// Valid only at rest in the middle of the gap, where the rigid body is at zero for any inertia; a payload step is
    /// rejected.
    fn set_link_inertia(&mut self, link_inertia: f64) {
        self.joint.link_inertia = link_inertia;
        self.compliance_damping = compliance_damping(&self.joint);
        self.redesign();
    }

    fn observe(&self) -> Observation {
        let joint = &self.joint;
        let moment = Reader::new(joint, &self.tables).read(self.ticks, &self.model());
        let lever = joint.geometry.carrier_base_radius();
        let (wind_up, wind_up_rate) = (moment.wind_up / lever, moment.wind_up_rate / lever);
        let stiffness = joint.compliance.map_or(0.0, |compliance| compliance.stiffness);
        let units = &self.tables.units;
        let link_speed = moment.carrier_speed + self.offset_rate(&units.link_offset);
        let rigid_motor_speed = joint.geometry.ratio_by_radii() * moment.carrier_speed;
        let lists =
            |value: &dyn Fn(usize) -> f64| [0, 1].map(|kind| (0..N).map(|planet| value(kind * N + planet)).collect());
        let contacts = [0, 1].map(|kind| {
            (0..N).map(|planet| moment.teeth[kind * N + planet].contact).collect::<heapless::Vec<ContactState, _>>()
        });
        let link_angle = moment.link_angle();
        Observation {
            time: moment.time,
            motor_angle: moment.motor_angle(joint),
            motor_speed: rigid_motor_speed + self.offset_rate(&units.motor_offset),
            carrier_angle: link_angle + wind_up,
            carrier_speed: link_speed + wind_up_rate,
            link_angle,
            link_speed,
            rigid_turns: moment.carrier_angle / std::f64::consts::TAU,
            rigid_speed: moment.carrier_speed,
            motor_offset: moment.motor_offset,
            link_offset: moment.link_offset,
            gap: moment.gap,
            gap_rate: moment.gap_rate,
            wind_up: moment.wind_up,
            wind_up_rate: moment.wind_up_rate,
            deflections: lists(&|mesh| moment.teeth[mesh].deflection),
            deflection_rates: lists(&|mesh| moment.teeth[mesh].rate),
            mesh_forces: lists(&|mesh| moment.teeth[mesh].force),
            contacts,
            wind_up_torque: stiffness * wind_up + self.compliance_damping * wind_up_rate,
            kinetic_energy: 0.0,
            elastic_energy: 0.0,
            work: Work::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use parameters::{Friction, Hysteresis, Payload, PayloadStep, WidthVariation};

    use reference::joint::mean_half_backlash;

    use super::*;

    fn q1() -> JointParameters {
        joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint").parameters
    }

    fn plant_of(name: PlantName, surroundings: Surroundings, pushes: Vec<Disturbance>) -> Outcome<Plant> {
        let train = DriveTrainParameters {
            effect_phases: reference::drive_train::EffectPhases {
                width: [std::f64::consts::FRAC_PI_2, 0.0],
                ..Default::default()
            },
            ..surroundings.into()
        };
        plant(name, &q1(), &train, pushes, 1)
    }

    #[test]
    fn core_rejects_missing_effects() {
        type Lacking = (&'static str, fn(&mut Surroundings));
        let lacking: [Lacking; 3] = [
            ("`hysteresis_stiffness_share`", |of| of.hysteresis = Hysteresis { stiffness_share: 0.2, torque: 1.0 }),
            ("`payload_step_ratio`", |of| of.payload_step = PayloadStep { time: 1.0, ratio: 3.0 }),
            ("`control_jitter_ratio`", |of| of.control_jitter_ratio = 0.05),
        ];
        for (key, change) in lacking {
            let mut surroundings = Surroundings::ideal();
            change(&mut surroundings);
            assert!(plant_of(PlantName::Reference, surroundings, Vec::new()).is_ok(), "{key}");
            let refused = plant_of(PlantName::Core, surroundings, Vec::new()).err().expect("it is refused");
            assert!(refused.message().contains(key), "{refused}");
            assert!(refused.help().is_some_and(|help| help.contains("--plant reference")), "{refused}");
        }
    }

    #[test]
    fn payload_swings_alike_on_plants() {
        let surroundings = Surroundings {
            payload: Payload { inertia_share: 0.5, frequency: 12.0, damping_ratio: 0.02 },
            ..Surroundings::ideal()
        };
        let push = |start, torque| Disturbance::Pulse { start, duration: 2e-3, torque };
        let speeds = |name| -> Vec<f64> {
            let pushes = vec![push(0.0, 1.0), push(0.004, -1.0)];
            let mut plant = plant_of(name, surroundings, pushes).expect("a plant");
            let step = |_| {
                plant.advance(0.0).expect("it runs");
                plant.joint().link_speed
            };
            (0..5000).map(step).collect()
        };
        let (core, reference) = (speeds(PlantName::Core), speeds(PlantName::Reference));
        let most = reference.iter().map(|speed| speed.abs()).fold(0.0, f64::max);
        let apart = core.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.02 * most, "{apart} of {most} rad/s");
    }

    #[test]
    fn backlash_varies_alike_on_plants() {
        let surroundings = Surroundings {
            width: WidthVariation { per_link_turn: 0.3, per_motor_turn: 0.0 },
            load_friction: Friction { coulomb: 5.0, ..Friction::default() },
            motor_friction: Friction { viscous: 2e-2, ..Friction::default() },
            ..Surroundings::ideal()
        };
        for name in [PlantName::Core, PlantName::Reference] {
            let mut plant = plant_of(name, surroundings, Vec::new()).expect("a plant");
            let mut end = |push: f64| {
                (0..1500).for_each(|_| plant.advance(push).expect("it runs"));
                plant.joint().gap
            };
            let width = end(0.2) - end(-0.2);
            let expected = 1.3 * 4.0 * mean_half_backlash(&q1());
            assert!((width / expected - 1.0).abs() < 0.015, "{name:?}: {width} m for {expected} m");
        }
    }
}
