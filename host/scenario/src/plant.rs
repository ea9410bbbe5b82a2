//! The joint that a run closes its loop around: the fine-step f64 reference, or the core's own fixed step, each inside the
//! same drive train. Faults of the teeth reach either through one trait.

use clap::ValueEnum;
use model_core::gears::design::design;
use model_core::gears::{Kinematics, Mechanics, Model, Scales, State, Tables, Torques};
use parameters::{ContactState, JointParameters};
use reference::drive_train::{Disturbance, DriveTrain, DriveTrainParameters, JointModel, Stepping};
use reference::joint::{Observation, Reference, ReferenceError, RelativeState, Start, Work};

use board::target::image::DEFAULT_TICK_RATE;
use report::failure::{Failure, Outcome};
use simulation::sim::snapshot::Reader;

/// Which model of the joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlantName {
    /// The fine-step f64 plant that shares nothing with the core but the parameters; bars are stated on it
    Reference,
    /// The core's own f32 step, as a board runs it
    Core,
}

impl PlantName {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Reference => "reference",
            Self::Core => "core",
        }
    }
}

/// A joint whose teeth can change.
pub trait Teeth: JointModel {
    /// From now on every mesh has this half-backlash [m].
    fn set_half_backlash(&mut self, half_backlash: f64);
    /// From now on the sun-planet mesh of one planet has this mean stiffness [N/m].
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

/// Half-backlash of a joint, mean over the planets [m].
pub fn half_backlash(joint: &JointParameters) -> f64 {
    joint.sun_planet.half_backlash.iter().sum::<f64>() / joint.geometry.planets as f64
}

/// A drive train with a joint of either kind inside.
pub type Plant = DriveTrain<Box<dyn Teeth>>;

/// A joint at rest in the middle of its gap, with what surrounds it; the reference is stepped fast.
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

/// A joint from a start of its own, with what surrounds it; the core's own step begins at rest in the middle of its gap,
/// whatever the start.
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
    let inside: Box<dyn Teeth> = match name {
        PlantName::Reference => Box::new(Reference::start(joint, start).map_err(|error| refused(&error))?),
        PlantName::Core => {
            let control_rate = f64::from(train.surroundings.control_rate);
            // As on a board: whole ticks in a control period, as near to the usual rate as that allows.
            train.parts_per_period = (f64::from(DEFAULT_TICK_RATE) / control_rate).round().max(1.0) as u32;
            let rate = (control_rate * f64::from(train.parts_per_period)).round() as u32;
            match joint.geometry.planets {
                1 => Box::new(CoreJoint::<1>::new(joint, rate)?),
                3 => Box::new(CoreJoint::<3>::new(joint, rate)?),
                4 => Box::new(CoreJoint::<4>::new(joint, rate)?),
                _ => Box::new(CoreJoint::<5>::new(joint, rate)?),
            }
        }
    };
    DriveTrain::around(inside, joint, train, disturbances, seed).map_err(|error| refused(&error))
}

/// The core's fixed step as a joint in motion.
struct CoreJoint<const N: usize> {
    joint: JointParameters,
    tables: Tables<f32, N>,
    state: State<f32, N>,
    ticks: u32,
    /// Damping between carrier and link [N m s/rad].
    compliance_damping: f64,
}

impl<const N: usize> CoreJoint<N> {
    fn new(joint: &JointParameters, tick_rate: u32) -> Outcome<Self> {
        let tables = design(joint, tick_rate).map_err(|error| {
            Failure::new(format!("joint `{}` cannot be designed for {tick_rate} Hz: {error}", joint.name))
                .with_help("--plant reference needs no such design")
        })?;
        let lever = joint.geometry.carrier_base_radius();
        let compliance_damping = joint.compliance.map_or(0.0, |compliance| {
            let sun = joint.bodies.sun_equivalent_mass + joint.rotor_equivalent_mass();
            let planets = N as f64 * joint.bodies.planet_equivalent_mass;
            let geared = 4.0 * sun + planets + joint.carrier_equivalent_mass();
            let link = joint.link_equivalent_mass();
            let reduced = geared * link / (geared + link) * lever * lever;
            2.0 * compliance.damping_ratio * (compliance.stiffness * reduced).sqrt()
        });
        Ok(Self { joint: joint.clone(), tables, state: State::REST, ticks: 0, compliance_damping })
    }

    fn model(&self) -> Model<'_, f32, N> {
        let mut model = Model::new(&self.tables);
        model.set_state(self.state);
        model
    }

    /// Rate of an angle that differs from its rigid share by these gains of planets, gap and wind-up [rad/s].
    fn offset_rate(&self, gains: &[f32; 3]) -> f64 {
        let rate = &self.state.rate;
        let planets = rate.planets.iter().map(|rate| f64::from(*rate)).sum::<f64>();
        let rates = [planets, rate.gap.into(), rate.wind_up.into()];
        let sum: f64 = gains.iter().zip(rates).map(|(gain, rate)| f64::from(*gain) * rate).sum();
        sum * Scales::new(&self.joint).frequency
    }
}

impl<const N: usize> Teeth for CoreJoint<N> {
    fn set_half_backlash(&mut self, half_backlash: f64) {
        let mut joint = self.joint.clone();
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.half_backlash.iter_mut().for_each(|value| *value = half_backlash);
        }
        // Scales do not depend on the backlash, so the state stands; a joint that was designed once is again.
        if let Ok(tables) = design(&joint, self.tables.tick_rate) {
            (self.joint, self.tables) = (joint, tables);
        }
    }

    fn set_sun_planet_stiffness(&mut self, _: usize, _: f64) {
        // The core's planets share their stiffness: a plan with such a fault is refused before it runs.
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
