//! Validated request for a study: joints, mesh frequency, half-backlashes and expectations are checked before any computation.

use std::path::PathBuf;

use clap::ValueEnum;
use model_core::gears::{Mechanics, Scales};
use parameters::{Excitation, JointParameters};

use super::{expectation, grid};
use crate::numerics::attractor::Class;
use crate::numerics::system::{StudyError, System};
use joint_file::named::{self, Loaded};
use joint_file::warnings;
use report::failure::{Failure, Outcome};
use report::number::TYPED;

/// Half-backlashes of Figs 5-8 over that of the joint file: 0, 10, 60, 120 um where the file has 60.
const FIGURE_FACTORS: [f64; 4] = [0.0, 1.0 / 6.0, 1.0, 2.0];

/// End of the bifurcation diagram over the half-backlash of the joint file: 150 um where it has 60.
const DIAGRAM_END: f64 = 2.5;

/// Steps in the diagram: 0.5 um for the paper's joint.
const DIAGRAM_STEPS: u32 = 300;

/// Arguments of `joint paper`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint paper                                  the paper's joint, in both readings of its Table 1
  joint paper --sweep all                      bifurcation diagrams from rest, upward and downward
  joint paper joints/l1.toml --omega 0.8       another joint at omega/omega_n = 0.8
  joint paper mine.toml --b 0,20,40 --grid 0:80:0.5 --json mine.json

Exit code: 0 if every check held, 1 if one did not, 2 for bad input, 130 after Ctrl-C.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset [default: paper and paper_printed]
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Half-backlashes of the figures and the table of attractors, in um [default: 0, 1/6, 1 and 2 times the file's]
    #[arg(long = "b", value_name = "LIST", allow_hyphen_values = true)]
    pub half_backlash: Option<String>,
    /// Half-backlashes of the bifurcation diagram, in um [default: from 0 to 2.5 times the file's in 300 steps]
    #[arg(long, value_name = "FROM:TO:STEP", allow_hyphen_values = true)]
    pub grid: Option<String>,
    /// Mesh frequency omega/omega_n; needed where the file's mesh phase follows the joint's angle
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true)]
    pub omega: Option<f64>,
    /// Starts of the bifurcation diagram: from rest at each b, or from the last state at the b before
    #[arg(long, value_enum, default_value = "rest")]
    pub sweep: StartChoice,
    /// Classes that the attractors must have, in the order of --b: a period or `chaos`, such as 1,1,3,chaos
    #[arg(long, value_name = "LIST")]
    pub expect: Option<String>,
    /// Folder for report.html, study.json, pictures (SVG) and tables (CSV); a file that this command did not write is refused
    /// [default: joint-out/paper/<joint>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Writes the study as JSON to this file too ("-" is standard output, and all else on standard error)
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
}

/// Starts of the diagrams.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StartChoice {
    /// From rest at each b
    Rest,
    /// Upward in b
    Up,
    /// Downward in b
    Down,
    /// All three
    All,
}

/// Initial state of each point of a diagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepStart {
    /// Start at X = X' = 0.
    Rest,
    /// Last state at the next smaller b.
    Up,
    /// Last state at the next greater b.
    Down,
}

/// A joint to study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyJoint {
    /// Joint file.
    pub loaded: Loaded,
    /// Parameters, with the mesh frequency of the study.
    pub parameters: JointParameters,
    /// Torque on the sun [N m].
    pub drive_torque: f64,
    /// Balancing load torque [N m].
    pub load_torque: f64,
}

/// Plan of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyPlan {
    /// Joints.
    pub subjects: Vec<StudyJoint>,
    /// Half-backlashes of the attractors [m].
    pub values: Vec<f64>,
    /// Half-backlashes of the diagrams, rising [m].
    pub grid: Vec<f64>,
    /// Starts of the diagrams.
    pub starts: Vec<SweepStart>,
    /// Classes that the user expects of the attractors, if stated.
    pub expected: Option<Vec<Class>>,
    /// True for the paper's joint and settings, whose results are known.
    pub is_set_p: bool,
    /// Command line that repeats the study.
    pub replay: String,
}

impl StudyPlan {
    /// Reads all arguments.
    pub fn new(arguments: &Arguments) -> Outcome<Self> {
        let files = match &arguments.file {
            Some(file) => vec![file.clone()],
            None => vec!["paper".into(), "paper_printed".into()],
        };
        let subjects: Vec<StudyJoint> =
            files.iter().map(|file| StudyJoint::new(named::load(file)?, arguments.omega)).collect::<Outcome<_>>()?;
        subjects.iter().for_each(|subject| warnings::print(&subject.loaded));
        let own = subjects[0].half_backlash();
        if own == 0.0 && (arguments.half_backlash.is_none() || arguments.grid.is_none()) {
            return Err(Failure::new(format!("{} has no backlash to scale the study by", subjects[0].loaded.name))
                .with_help("state the half-backlashes: --b 0,10,60,120 --grid 0:150:0.5"));
        }
        let values = match &arguments.half_backlash {
            Some(text) => grid::list(text)?,
            None => FIGURE_FACTORS.map(|factor| factor * own).to_vec(),
        };
        let grid = match &arguments.grid {
            Some(text) => grid::grid(text)?,
            None => {
                let end = DIAGRAM_END * own;
                (0..=DIAGRAM_STEPS).map(|index| f64::from(index) * end / f64::from(DIAGRAM_STEPS)).collect()
            }
        };
        let expected = arguments.expect.as_deref().map(|text| expectation::list(text, values.len())).transpose()?;
        let starts = match arguments.sweep {
            StartChoice::Rest => vec![SweepStart::Rest],
            StartChoice::Up => vec![SweepStart::Up],
            StartChoice::Down => vec![SweepStart::Down],
            StartChoice::All => vec![SweepStart::Rest, SweepStart::Up, SweepStart::Down],
        };
        let is_set_p = arguments.file.is_none()
            && arguments.omega.is_none()
            && arguments.half_backlash.is_none()
            && arguments.grid.is_none();
        Ok(Self { subjects, values, grid, starts, expected, is_set_p, replay: arguments.replay() })
    }

    /// Name of the study, taken from its first joint.
    pub fn name(&self) -> &str {
        &self.subjects[0].parameters.name
    }
}

impl StudyJoint {
    fn new(loaded: Loaded, omega: Option<f64>) -> Outcome<Self> {
        if loaded.file.parameters.equivalent_gear().is_some() {
            return Err(Failure::new(format!(
                "{} is an equivalent gear: it has no teeth and therefore no mesh frequency",
                loaded.name
            ))
            .with_help("the paper's study is of planetary gears: name a joint file with [geometry] and [mesh]"));
        }
        let mut parameters = loaded.file.parameters.clone();
        if let Some(omega) = omega {
            if !(1e-3..=100.0).contains(&omega) {
                return Err(Failure::new(format!(
                    "--omega {} is not a usable mesh frequency over omega_n",
                    TYPED.write(omega)
                ))
                .with_help("give a ratio between 0.001 and 100, such as --omega 2.1, the paper's"));
            }
            parameters.excitation = Excitation::Time { mesh_frequency: omega * Scales::new(&parameters).frequency };
        }
        let drive_torque = loaded.file.profile.drive_torque;
        let load_torque = parameters.balanced_load_torque(drive_torque);
        let subject = Self { loaded, parameters, drive_torque, load_torque };
        // A joint that the study rejects is rejected here.
        subject.system(subject.half_backlash())?;
        Ok(subject)
    }

    /// Greatest half-backlash of the file [m].
    pub fn half_backlash(&self) -> f64 {
        let meshes = [&self.parameters.sun_planet, &self.parameters.ring_planet];
        meshes.iter().flat_map(|mesh| mesh.half_backlash.iter()).fold(0.0, |most, b| most.max(*b))
    }

    /// Joint with another half-backlash [m]; meshes that differ in the file keep their proportions.
    pub fn with_half_backlash(&self, half_backlash: f64) -> JointParameters {
        let mut parameters = self.parameters.clone();
        let own = self.half_backlash();
        for mesh in [&mut parameters.sun_planet, &mut parameters.ring_planet] {
            for value in &mut mesh.half_backlash {
                *value = if own > 0.0 { half_backlash * (*value / own) } else { half_backlash };
            }
        }
        parameters
    }

    /// Joint in the form that the study integrates.
    pub fn system(&self, half_backlash: f64) -> Outcome<System> {
        let parameters = self.with_half_backlash(half_backlash);
        System::new(&parameters, self.drive_torque, self.load_torque).map_err(|error| self.failure(error))
    }

    /// Error about this joint, with a remedy.
    pub fn failure(&self, error: StudyError) -> Failure {
        let help = match error {
            StudyError::SmoothDeadZone => "write dead_zone = \"sharp\" in [contact] of a copy of the file",
            StudyError::NoFrequency | StudyError::Standstill => {
                "state it over omega_n of eq. 18: --omega 2.1 is the paper's"
            }
            StudyError::TooStiff => "raise the mesh frequency: --omega",
            StudyError::NotFinite => {
                "a ripple near twice a natural frequency can cause this: raise the damping or change --omega"
            }
        };
        Failure::new(format!("{} cannot be studied: {error}", self.loaded.name)).with_help(help)
    }
}

impl SweepStart {
    /// Word for files and records.
    pub fn word(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Up => "up",
            Self::Down => "down",
        }
    }
}

impl Arguments {
    fn replay(&self) -> String {
        let mut words = vec!["joint paper".to_owned()];
        words.extend(self.file.iter().map(|file| file.display().to_string()));
        words.extend(self.half_backlash.iter().map(|list| format!("--b {list}")));
        words.extend(self.grid.iter().map(|grid| format!("--grid {grid}")));
        words.extend(self.omega.iter().map(|omega| format!("--omega {omega}")));
        if let Some(value) = self.sweep.to_possible_value().filter(|_| self.sweep != StartChoice::Rest) {
            words.push(format!("--sweep {}", value.get_name()));
        }
        words.extend(self.expect.iter().map(|list| format!("--expect {list}")));
        words.join(" ")
    }
}
