//! The two models that a joint is exported as, and what FMI requires to be named alike in description, sources and binary.

use c_library::tables::{self, CTables};
use clap::ValueEnum;
use joint_file::JointFile;
use model_core::controller::design::ControlRequest;
use model_core::gears::Kinematics;
use model_core::numbers::digest::{START, chain};
use report::failure::{Failure, Outcome};

use crate::archive::File;
use crate::variables::{self, Variable};

/// Version of the standard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fmi {
    /// FMI 2.0
    #[value(name = "2")]
    Two,
    /// FMI 3.0
    #[value(name = "3")]
    Three,
}

/// Part of a joint that an FMU holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Content {
    /// Gears, motor, frictions, weight and encoders
    Plant,
    /// Observer and compensation
    Controller,
}

impl Content {
    /// Name on the command line and in the model's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plant => "plant",
            Self::Controller => "controller",
        }
    }
}

/// Mesh family as the plant's forces need it.
#[derive(Debug)]
pub struct MeshFacts {
    /// Name in C.
    pub name: &'static str,
    /// Mean stiffness [N/m].
    pub stiffness: f64,
    /// Half-backlash of every planet [m].
    pub half_backlash: Vec<f64>,
}

/// Model of a joint.
#[derive(Debug)]
pub struct Model {
    /// Version of the standard.
    pub fmi: Fmi,
    /// Part of the joint.
    pub content: Content,
    /// Name of the joint.
    pub joint: String,
    /// Identifier in C, and name of the binary.
    pub identifier: String,
    /// Tables.
    pub tables: CTables,
    /// Control rate [Hz].
    pub rate: u32,
    /// Ticks of the encoders' clock per control period.
    pub ticks: u32,
    /// Motor turns per turn of the link.
    pub ratio: f64,
    /// Meshes of sun and ring.
    pub meshes: [MeshFacts; 2],
    /// Variables.
    pub variables: Vec<Variable>,
}

impl Model {
    /// Designs the tables of a joint for a part of it.
    pub fn new(
        fmi: Fmi,
        content: Content,
        joint: &JointFile,
        request: ControlRequest,
        board: &board::device::board::Board,
    ) -> Outcome<Self> {
        let make = |plant| tables::make(joint, &tables::nominal(joint, request), plant, board);
        let tables = make(content == Content::Plant).map_err(|failure| {
            // The remedies of `joint tables` are not accepted by `joint export`.
            failure.with_help(match content {
                Content::Plant if make(false).is_ok() => {
                    "`--model controller` exports observer and compensation without the plant"
                }
                Content::Plant => {
                    "`joint check` shows the limits that follow from the file; change the control rate with `--rate`"
                }
                Content::Controller => {
                    "`joint check` shows the limits that follow from the file; change the requirements with `--rate` and `--bandwidth`"
                }
            })
        })?;
        let invalid = |error| {
            Failure::new(format!("invalid tables: {error:?}"))
                .with_help("this is a bug of `joint export`: report it with the joint file")
        };
        let blob = table_blob::Blob::open(&tables.words).map_err(invalid)?;
        let header = blob.header();
        let lead = blob.compensation().map_err(invalid)?.crossing.lead;
        let parameters = &joint.parameters;
        let mesh = |name, mesh: &parameters::Mesh| MeshFacts {
            name,
            stiffness: mesh.mean_stiffness,
            half_backlash: mesh.half_backlash.iter().copied().collect(),
        };
        Ok(Self {
            fmi,
            content,
            joint: parameters.name.to_string(),
            identifier: format!("{}_{}", tables.name, content.name()),
            rate: header.control_rate,
            ticks: header.clock_rate / header.control_rate,
            ratio: parameters.geometry.ratio_by_teeth(),
            meshes: [mesh("sun", &parameters.sun_planet), mesh("ring", &parameters.ring_planet)],
            variables: match content {
                Content::Plant => variables::of_plant(parameters.geometry.planets),
                Content::Controller => variables::of_controller(lead),
            },
            tables,
        })
    }

    /// Token by which description and binary are known to belong together: a digest of files. Lengths come first, so that
    /// no byte passes from a name to a content, or from one file to the next, unnoticed.
    pub fn token(&self, files: &[File]) -> String {
        let words = |file: &File| {
            let lengths = [file.name.len() as u64, file.bytes.len() as u64];
            let bytes = file.name.bytes().chain(file.bytes.iter().copied()).map(u64::from);
            lengths.into_iter().chain(bytes).collect::<Vec<_>>()
        };
        let digest = |start| files.iter().flat_map(words).fold(start, chain);
        let [high, low]: [u64; 2] = [digest(START), digest(!START)];
        let hex = format!("{high:016x}{low:016x}");
        format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
    }
}
