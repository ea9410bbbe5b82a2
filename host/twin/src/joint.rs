//! One joint behind its drive: plant with faults, drive, server of the protocol, supply, and optionally observer and
//! compensation in the drive.

use std::f64::consts::TAU;
use std::path::Path;

use board::device::board::Board;
use board::device::image::default_drive_rate;
use drives::drive::{Feedback, Sensors, SetPoint, VirtualPower};
use drives::{Drive, Settings, Turns};
use live::{Description, Sample};
use model_core::compensation::design::good_bandwidth;
use model_core::compensation::{Compensation, Stage};
use model_core::observer::{MAPPED, Observer, Samples, Source};
use report::failure::{Failure, Outcome};
use scenario::case::{Case, Designed};
use scenario::controller::ControllerName;
use scenario::execution::{RunSpec, setup};
use scenario::faults::check_broken_tooth;
use scenario::file::Fault;
use scenario::live_view::{description, true_sample};
use scenario::plant::PlantName;
use scenario::port::Translator;
use scenario::rig::{Rig, RunError};
use scenario::suite::{self, Choice, Test};
use virtual_drive::DriveDesign;

use crate::image::{ImageJoint, ImageTables};
use crate::mapping;
use crate::mode::{ActiveMode, Mode};
use crate::protocol::{DriveName, Server};

/// Joint as it was asked for: its identifier on the bus, and its case.
pub struct Prepared {
    /// Identifier of the drive.
    pub id: u8,
    /// Name of the joint or test file.
    pub name: String,
    test: Test,
    case: Case,
    designed: Option<Designed>,
    image: Option<ImageTables>,
}

/// Choices that all joints share.
#[derive(Debug, Clone)]
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
    /// Board whose image the joint is to equal; `None` for the plant.
    pub image: Option<Board>,
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
    plant: Plant<'d>,
    mode: Option<ActiveMode>,
    /// Planets, ratio and rated torque of the true joint.
    description: Description,
    seed: u64,
}

/// Joint in front of the drive.
enum Plant<'d> {
    /// Plant of a test with its faults.
    Rig(Box<TestPlant<'d>>),
    /// Joint of a firmware image.
    Image(ImageJoint<'d>),
}

/// Plant of a test, and its way to observer and compensation.
struct TestPlant<'d> {
    rig: Rig,
    case: &'d Case,
    model: PlantName,
    translator: Translator,
    compensated: Option<Compensated<'d>>,
    /// Angle zero of the joint on the scale of the raw output encoder [turns].
    output_zero: f64,
}

#[cfg(test)]
impl Choices {
    /// Choices of tests for a plant.
    pub fn of_plant(plant: PlantName) -> Self {
        Self {
            drive: DriveName::Moteus,
            plant,
            seed: 1,
            compensation: false,
            is_calibrated: true,
            supply: 48.0,
            image: None,
        }
    }
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
        let mut case = Case::new(&test.file, &test.joint.text, choices.seed, test.motion.as_ref())?;
        if let Some(board) = &choices.image {
            check_for_image(&test, &case)?;
            case.truth.surroundings.control_rate = default_drive_rate(&case.truth.parameters, board);
        }
        let designed = choices.compensation.then(|| case.design(&test.file)).transpose()?;
        let image = choices.image.as_ref().map(|board| ImageTables::new(&case, board)).transpose()?;
        Ok(Self { id, name: path.display().to_string(), test, case, designed, image })
    }

    /// Joint at rest before its first period.
    pub fn start(&self, choices: &Choices) -> Outcome<Joint<'_>> {
        let settings = choices.drive.settings(self.settings(choices)?);
        Ok(Joint {
            id: self.id,
            name: self.name.clone(),
            drive: Drive::new(settings),
            server: choices.drive.server(self.id, &settings),
            model: choices.drive.model(&settings),
            power: VirtualPower::new(choices.supply),
            plant: match &self.image {
                Some(tables) => Plant::Image(tables.start()),
                None => Plant::Rig(Box::new(self.test_plant(choices)?)),
            },
            mode: None,
            description: description(self.id, &self.name, &self.case.truth.parameters),
            seed: choices.seed,
        })
    }

    fn test_plant(&self, choices: &Choices) -> Outcome<TestPlant<'_>> {
        let Self { test, case, designed, .. } = self;
        let spec = RunSpec { controller: ControllerName::Off, plant: choices.plant, without_gap: false };
        let rig = Rig::new(&setup(&test.file, case, choices.seed, spec))?;
        let around = &case.truth.surroundings;
        let turns = [around.motor_encoder, around.output_encoder].map(|encoder| encoder.counts_per_turn);
        Ok(TestPlant {
            rig,
            case,
            model: choices.plant,
            translator: scenario::execution::translator(&test.file, case),
            compensated: designed.as_ref().map(|designed| Compensated {
                observer: Observer::new(&designed.observer),
                compensation: Compensation::new(&designed.compensation),
                state: CompensatedState::default(),
            }),
            output_zero: case.zeros.counts(turns.map(u64::cast_signed))[1] as f64 / turns[1] as f64,
        })
    }

    /// Settings of a drive that fits the joint.
    fn settings(&self, choices: &Choices) -> Outcome<Settings> {
        let (file, truth) = (&self.test.file, &self.case.truth);
        let bandwidth = match &choices.image {
            Some(_) => good_bandwidth(&truth.parameters, &truth.surroundings)
                .map_err(|error| Failure::new(format!("joint `{}` has no drive: {error}", truth.parameters.name)))?,
            None => self.case.bandwidth(file)?,
        };
        let design = DriveDesign::new(&truth.parameters, &truth.surroundings, bandwidth, file.output_encoder);
        Ok(design.settings(choices.drive.peak_current(), choices.supply, choices.is_calibrated))
    }
}

impl Joint<'_> {
    /// Runs one control period.
    pub fn step(&mut self) -> Result<(), RunError> {
        let now = self.time();
        if let Some(mode) = &self.mode {
            mode.command(&mut self.drive, now);
        }
        let Self { drive, power, plant, .. } = self;
        match plant {
            Plant::Rig(plant) => plant.step(drive, power),
            Plant::Image(joint) => {
                joint.step(drive, power);
                Ok(())
            }
        }
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
        let target = feedback.target.minus(self.drive.origin());
        let wanted = if follows && feedback.output_position.is_some() { radians(target) } else { f64::NAN };
        Sample { wanted, ..self.truth() }
    }

    /// State of observer and compensation, if they act in the drive.
    pub fn compensated(&self) -> Option<CompensatedState> {
        match &self.plant {
            Plant::Rig(plant) => plant.compensated.as_ref().map(|compensated| compensated.state),
            Plant::Image(_) => None,
        }
    }

    /// Time of the joint [s].
    pub fn time(&self) -> f64 {
        match &self.plant {
            Plant::Rig(plant) => plant.rig.plant().joint().time,
            Plant::Image(joint) => joint.time(),
        }
    }

    /// Control period [s].
    pub fn period(&self) -> f64 {
        match &self.plant {
            Plant::Rig(plant) => plant.rig.period(),
            Plant::Image(joint) => joint.period(),
        }
    }

    /// Seed of faults that are injected while the joint runs.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// True for the joint of an image.
    pub fn is_of_image(&self) -> bool {
        matches!(self.plant, Plant::Image(_))
    }

    /// Rejects faults that the plant cannot have.
    pub fn check_faults(&self, faults: &[Fault]) -> Outcome<()> {
        let help = "start the twin with --plant reference";
        match &self.plant {
            Plant::Rig(plant) => check_broken_tooth(faults, &plant.case.truth.parameters, plant.model, help),
            Plant::Image(_) => Ok(()),
        }
    }

    /// Plant with its faults; `None` for the joint of an image, which has none.
    pub fn rig(&mut self) -> Option<&mut Rig> {
        match &mut self.plant {
            Plant::Rig(plant) => Some(&mut plant.rig),
            Plant::Image(_) => None,
        }
    }

    /// True state, with the angle of the link on the scale of the raw output encoder.
    pub fn truth(&self) -> Sample {
        match &self.plant {
            Plant::Rig(plant) => plant.truth(),
            Plant::Image(joint) => joint.truth(),
        }
    }
}

/// Rejects a test file whose faults or loads the joint of an image would leave out.
fn check_for_image(test: &Test, case: &Case) -> Outcome<()> {
    let left_out = [("faults", !test.file.faults.is_empty()), ("loads on the link", !case.disturbances.is_empty())];
    left_out.iter().find(|(_, has)| *has).map_or(Ok(()), |(things, _)| {
        Err(Failure::new(format!("{} has {things}, and the joint of an image has none", test.name))
            .with_help(format!("leave --image out, or name the joint file {} alone", test.file.joint)))
    })
}

impl TestPlant<'_> {
    /// Runs one control period with the drive.
    fn step(&mut self, drive: &mut Drive, power: &mut VirtualPower) -> Result<(), RunError> {
        let begun = self.rig.begin_period();
        let samples = self.translator.samples(&begun.seen);
        let is_new = begun.seen.motor.period == begun.seen.period;
        let mut sensors = Sensors {
            motor_counts: is_new.then_some(samples.motor.counts),
            output_counts: samples.output.map(|reading| reading.counts),
            motor_torque: begun.torques.air_gap as f32,
            ..Sensors::default()
        };
        power.read(&mut sensors);
        let torque = self.drive_step(drive, &sensors, &samples);
        self.translator.note(torque);
        self.rig.end_period(begun.time, f64::from(torque))?;
        self.rig.check_motion(begun.time)?;
        let motor_speed = self.rig.plant().joint().motor_speed as f32;
        let air_gap = self.rig.plant().torques().air_gap as f32;
        power.step(drive.settings(), air_gap, motor_speed);
        Ok(())
    }

    /// Torque of the motor for this period [N m].
    fn drive_step(&mut self, drive: &mut Drive, sensors: &Sensors, samples: &Samples) -> f32 {
        let Some(Compensated { observer, compensation, state }) = &mut self.compensated else {
            return drive.step(sensors, None);
        };
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

    fn truth(&self) -> Sample {
        let (joint, torques) = (self.rig.plant().joint(), self.rig.plant().torques());
        let link = joint.link_angle + TAU * self.output_zero;
        Sample { link, ..true_sample(joint, &torques, self.rig.half_backlash(), f64::NAN) }
    }
}

/// Converts an angle to f64 [rad]. The angle's own conversion is f32, which has a resolution of 0.06 mrad at a hundred turns.
fn radians(angle: Turns) -> f64 {
    TAU * (angle.to_bits() as f64 / f64::powi(2.0, 32))
}

#[cfg(test)]
mod tests {
    use report::workspace::workspace;

    use super::*;

    /// In f32, 1000.1 turns in radians are a multiple of 0.5 mrad.
    #[test]
    fn target_keeps_resolution_after_many_turns() {
        let choices = Choices::of_plant(PlantName::Core);
        let prepared = Prepared::load(1, Path::new("q1"), &choices).expect("a preset");
        let mut joint = prepared.start(&choices).expect("it is designed");
        for _ in 0..3 {
            joint.set_mode(Mode::Position { turns: 1000.1 });
            joint.step().expect("it runs");
        }
        let error = joint.live_sample().wanted - TAU * 1000.1;
        assert!(error.abs() < 1e-6, "{error}");
    }

    /// Drive and compensation count the angle from different readings without an output encoder.
    #[test]
    fn hold_by_motor_encoder_alone_moves_nothing() {
        for seed in 1..4 {
            let choices = Choices { compensation: true, seed, ..Choices::of_plant(PlantName::Core) };
            let prepared =
                Prepared::load(1, &workspace().join("hil/motor-only.toml"), &choices).expect("a test without one");
            let mut joint = prepared.start(&choices).expect("it is designed");
            joint.step().expect("it runs");
            let start = joint.truth().link;
            joint.set_mode(Mode::Hold);
            for _ in 0..5000 {
                joint.step().expect("it runs");
                let moved = joint.truth().link - start;
                assert!(moved.abs() < 0.01, "seed {seed}: {moved} rad");
            }
        }
    }

    #[test]
    fn image_refuses_faults_and_loads_of_file() {
        let board = Board::parse("odrive-3.6").expect("a board");
        let choices = Choices { image: Some(board), ..Choices::of_plant(PlantName::Core) };
        let load = |file: &Path| Prepared::load(1, file, &choices).map(|_| ());
        for (file, what) in [("hil/encoder-frozen.toml", "faults"), ("hil/disturbed-hold.toml", "loads on the link")] {
            let refused = load(&workspace().join(file)).expect_err(file);
            assert!(refused.message().contains(what), "{refused}");
            assert!(refused.help().is_some_and(|help| help.contains("--image")), "{refused}");
        }
        load(Path::new("q1")).expect("a joint has neither");
    }
}
