//! One joint behind its drive: plant with faults, drive, server of the protocol, supply, and optionally observer and
//! compensation in the drive.

use std::path::Path;

use drives::drive::{Feedback, Gains, Sensors, SetPoint, VirtualPower};
use drives::turns::Ratio;
use drives::{Drive, Settings, Turns};
use joint_file::sheet;
use live::{Description, Sample};
use model_core::compensation::{Compensation, Stage};
use model_core::gears::Kinematics;
use model_core::observer::{MAPPED, Observer, Samples, Source};
use report::failure::{Failure, Outcome};
use scenario::case::{Case, Designed};
use scenario::controller::ControllerName;
use scenario::execution::{RunSpec, setup};
use scenario::live_view::{description, true_sample};
use scenario::plant::PlantName;
use scenario::port::Translator;
use scenario::rig::{Rig, RunError};
use scenario::suite::{self, Choice, Test};

use crate::mapping;
use crate::mode::{ActiveMode, Mode};
use crate::protocol::{DriveName, Server};

/// Bandwidth of the speed from the encoders, in a control period [rad]: a compromise of lag and quantisation.
const ENCODER_BANDWIDTH_PERIODS: f32 = 0.2;
/// Largest crossover of the speed loop with the rotor alone, as in the gap, over the bandwidth of its speed [-]: keeps
/// 50 degrees of phase.
const ROTOR_CROSSOVER_RATIO: f32 = 0.25;
/// Largest bandwidth of the drive's position loop [rad/s]. Assumed: a drive that nobody tuned for the joint.
const MAX_BANDWIDTH: f64 = 40.0;

/// Joint as it was asked for: its identifier on the bus, and its case.
pub struct Prepared {
    /// Identifier of the drive.
    pub id: u8,
    /// Name of the joint or test file.
    pub name: String,
    test: Test,
    case: Case,
    designed: Option<Designed>,
}

/// Choices that all joints share.
#[derive(Debug, Clone, Copy)]
pub struct Choices {
    /// Drive.
    pub drive: DriveName,
    /// Plant.
    pub plant: PlantName,
    /// Seed.
    pub seed: u64,
    /// True for observer and compensation in the drive.
    pub compensation: bool,
    /// True for a drive that is calibrated.
    pub is_calibrated: bool,
    /// Voltage of the supply [V].
    pub supply: f32,
}

/// Observer and compensation of a drive.
struct Compensated<'d> {
    observer: Observer<'d, f32, MAPPED>,
    compensation: Compensation<'d, f32>,
    state: CompensatedState,
}

/// State of observer and compensation.
#[derive(Debug, Clone, Copy, Default)]
pub struct CompensatedState {
    /// Encoders that the observer uses.
    pub source: Source,
    /// Estimated half-backlash [m].
    pub half_backlash: f32,
    /// Stage of the compensation.
    pub stage: Stage,
    /// True while plain control acts because the loop hunted.
    pub is_stepped_back: bool,
}

/// Joint in motion.
pub struct Joint<'d> {
    /// Identifier of the drive.
    pub id: u8,
    /// Name of the joint or test file.
    pub name: String,
    /// Drive.
    pub drive: Drive,
    /// Server of the drive's protocol.
    pub server: Server,
    /// Model of the drive, if the maker has several.
    pub model: Option<String>,
    /// Supply and temperatures.
    pub power: VirtualPower,
    rig: Rig,
    translator: Translator,
    compensated: Option<Compensated<'d>>,
    mode: Option<ActiveMode>,
    /// Planets, ratio and rated torque of the true joint.
    description: Description,
    /// Angle zero of the joint on the scale of the raw output encoder [turns].
    output_zero: f64,
    seed: u64,
}

/// True state of a joint, beside what its drive reports.
#[derive(Debug, Clone, Copy)]
pub struct Truth {
    /// Angle of the link on the scale of the raw output encoder [rad].
    pub link: f64,
    /// Speed of the link [rad/s].
    pub link_speed: f64,
    /// Angle of the motor [rad].
    pub motor: f64,
    /// Gap coordinate [m].
    pub gap: f64,
    /// Half-backlash of every mesh [m].
    pub half_backlash: f64,
    /// Net force between the flanks at the motor's side [N].
    pub mesh_force: f64,
    /// Torque that brakes the link [N m].
    pub load_torque: f64,
    /// Torque in the air gap of the motor [N m].
    pub motor_torque: f64,
}

impl Prepared {
    /// Reads a joint file, preset or test file and draws its case.
    pub fn load(id: u8, path: &Path, choices: &Choices) -> Outcome<Self> {
        let test = if suite::holds_tests(path) && joint_file::preset(&path.display().to_string()).is_none() {
            if path.is_dir() {
                return Err(Failure::new(format!("{} is a folder", path.display()))
                    .with_help("name one joint file, preset or test file"));
            }
            let mut suite = suite::load(path, Choice::Full, choices.plant)?;
            suite.tests.pop().ok_or_else(|| Failure::new(format!("{} has no test", path.display())))?
        } else {
            // A motion without a load of its own, so that the joint stays as its file has it.
            let text = format!("joint = {:?}\n[profile]\nkind = \"sine\"\n", path.display().to_string());
            suite::from_text(&path.display().to_string(), &text, Path::new(""), choices.plant)?
        };
        let case = Case::new(&test.file, &test.joint.text, choices.seed, test.motion.as_ref())?;
        let designed = choices.compensation.then(|| case.design(&test.file)).transpose()?;
        Ok(Self { id, name: path.display().to_string(), test, case, designed })
    }

    /// Joint at rest before its first period.
    pub fn start(&self, choices: &Choices) -> Outcome<Joint<'_>> {
        let Self { id, test, case, designed, .. } = self;
        let spec = RunSpec { controller: ControllerName::Off, plant: choices.plant, without_gap: false };
        let rig = Rig::new(&setup(&test.file, case, choices.seed, spec))?;
        let around = &case.truth.surroundings;
        let turns = [around.motor_encoder, around.output_encoder].map(|encoder| encoder.counts_per_turn);
        let settings = choices.drive.settings(self.settings(choices)?);
        Ok(Joint {
            id: *id,
            name: self.name.clone(),
            drive: Drive::new(settings),
            server: choices.drive.server(*id, &settings),
            model: choices.drive.model(&settings),
            power: VirtualPower::new(choices.supply),
            rig,
            translator: scenario::execution::translator(case),
            compensated: designed.as_ref().map(|designed| Compensated {
                observer: Observer::new(&designed.observer),
                compensation: Compensation::new(&designed.compensation),
                state: CompensatedState::default(),
            }),
            mode: None,
            description: description(*id, &self.name, &case.truth.parameters),
            output_zero: case.zeros.counts(turns.map(u64::cast_signed))[1] as f64 / turns[1] as f64,
            seed: choices.seed,
        })
    }

    /// Settings of a drive that fits the joint. Its largest current gives the joint's largest torque, which gives the
    /// torque constant; the rated torque heats the winding by its rated rise.
    fn settings(&self, choices: &Choices) -> Outcome<Settings> {
        let (joint, around) = (&self.case.truth.parameters, &self.case.truth.surroundings);
        let ratio = joint.geometry.ratio_by_teeth();
        let inertia = sheet::inertia_at_link(joint) as f32;
        let encoder_bandwidth = ENCODER_BANDWIDTH_PERIODS * around.control_rate as f32;
        let rotor_share = (joint.rotor_inertia * ratio * ratio) as f32 / inertia;
        let in_the_gap = ROTOR_CROSSOVER_RATIO * encoder_bandwidth * rotor_share.min(1.0);
        let bandwidth = (self.case.bandwidth(&self.test.file)?.min(MAX_BANDWIDTH) as f32).min(in_the_gap);
        let rated = (joint.rated_output_torque / ratio) as f32;
        let torque_limit = around.torque_limit.min(1e6) as f32;
        let torque_constant = torque_limit / choices.drive.peak_current();
        Ok(Settings {
            ratio: Ratio::new(ratio),
            period: 1.0 / around.control_rate as f32,
            motor_counts_per_turn: around.motor_encoder.counts_per_turn as u32,
            output_counts_per_turn: self
                .test
                .file
                .output_encoder
                .then_some(around.output_encoder.counts_per_turn as u32),
            encoder_bandwidth,
            max_silent_periods: around.control_rate / 100,
            torque_constant,
            resistance: VirtualPower::resistance(rated, torque_constant),
            torque_limit,
            max_velocity: (around.speed_limit / ratio) as f32,
            overspeed: 1.5 * (around.speed_limit / ratio) as f32,
            min_voltage: 0.5 * choices.supply,
            max_voltage: 1.25 * choices.supply,
            gains: Gains::for_inertia(inertia, bandwidth),
            integral_limit: torque_limit * ratio as f32,
            is_calibrated: choices.is_calibrated,
            ..Settings::default()
        })
    }
}

impl Joint<'_> {
    /// Runs one control period.
    pub fn step(&mut self) -> Result<(), RunError> {
        let begun = self.rig.begin_period();
        let samples = self.translator.samples(&begun.seen);
        let is_new = begun.seen.motor.period == begun.seen.period;
        let mut sensors = Sensors {
            motor_counts: is_new.then_some(samples.motor.counts),
            output_counts: samples.output.map(|reading| reading.counts),
            motor_torque: begun.torques.air_gap as f32,
            ..Sensors::default()
        };
        self.power.read(&mut sensors);
        if let Some(mode) = &self.mode {
            mode.command(&mut self.drive, begun.time);
        }
        let torque = self.drive_step(&sensors, &samples);
        self.translator.note(torque);
        self.rig.end_period(begun.time, f64::from(torque))?;
        self.rig.check_motion(begun.time)?;
        let motor_speed = self.rig.plant().joint().motor_speed as f32;
        let air_gap = self.rig.plant().torques().air_gap as f32;
        self.power.step(self.drive.settings(), air_gap, motor_speed);
        Ok(())
    }

    /// Torque of the motor for this period [N m].
    fn drive_step(&mut self, sensors: &Sensors, samples: &Samples) -> f32 {
        let Self { drive, compensated, .. } = self;
        let Some(Compensated { observer, compensation, state }) = compensated else { return drive.step(sensors, None) };
        let estimates = *observer.step(samples);
        (state.source, state.half_backlash) = (estimates.source, estimates.half_backlash.value);
        if drive.set_point().is_none() {
            compensation.restart();
        }
        let (origin, ratio) = (drive.origin(), drive.settings().ratio.to_f32());
        let mut follow = |set_point: &SetPoint, _: &Feedback| {
            let command = mapping::command(set_point, Turns::ZERO.minus(origin))?;
            let output = compensation.step(&estimates, &command);
            (state.stage, state.is_stepped_back) = (output.stage, output.stepped_back);
            Some(output.torque * ratio)
        };
        drive.step(sensors, Some(&mut follow))
    }

    /// Commands the drive in place of its client from now on, or gives it back.
    pub fn set_mode(&mut self, mode: Mode) {
        let now = self.time();
        self.mode = mode.start(&mut self.drive, now, self.mode);
    }

    /// Word of the mode.
    pub fn mode(&self) -> &'static str {
        self.mode.as_ref().map_or(Mode::Client.word(), ActiveMode::word)
    }

    /// Description for the live view.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// State for the live view. The drive's target counts as the desired angle of the link while the drive follows one
    /// and an output encoder gives both angles one zero.
    pub fn live_sample(&self) -> Sample {
        let feedback = self.drive.feedback();
        let follows = matches!(
            self.drive.set_point(),
            Some(SetPoint::Position(_) | SetPoint::Velocity { .. } | SetPoint::Impedance { .. })
        );
        let target = f64::from(feedback.target.minus(self.drive.origin()).to_rad());
        let wanted = if follows && feedback.output_position.is_some() { target } else { f64::NAN };
        let (joint, torques) = (self.rig.plant().joint(), self.rig.plant().torques());
        let sample = true_sample(joint, &torques, self.rig.half_backlash(), wanted);
        Sample { link: self.truth().link, ..sample }
    }

    /// Time of the joint [s].
    pub fn time(&self) -> f64 {
        self.rig.plant().joint().time
    }

    /// Control period [s].
    pub fn period(&self) -> f64 {
        self.rig.period()
    }

    /// State of observer and compensation, if they act in the drive.
    pub fn compensated(&self) -> Option<CompensatedState> {
        self.compensated.as_ref().map(|compensated| compensated.state)
    }

    /// Seed of faults that are injected while the joint runs.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Plant with its faults.
    pub fn rig(&mut self) -> &mut Rig {
        &mut self.rig
    }

    /// True state.
    pub fn truth(&self) -> Truth {
        let (joint, torques) = (self.rig.plant().joint(), self.rig.plant().torques());
        Truth {
            link: joint.link_angle + std::f64::consts::TAU * self.output_zero,
            link_speed: joint.link_speed,
            motor: joint.motor_angle,
            gap: joint.gap,
            half_backlash: self.rig.half_backlash(),
            mesh_force: joint.sun_force(),
            load_torque: torques.load_friction + torques.gravity + torques.disturbance,
            motor_torque: torques.air_gap,
        }
    }
}
