//! `joint image`: builds the firmware of a joint and prints the path of the image.

use std::path::PathBuf;

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use link::messages::Role;

use board::device::board::Board;
use board::device::image;
use board::device::prediction::{ORIGIN, Prediction};
use board::device::tick_time::{self, RateCheck};
use board::device::toolchain::Toolchain;
use joint_file::{named, warnings};
use parameters::JointParameters;
use report::failure::{Failure, Outcome};
use report::progress::Progress;
use report::{interruption, output};
use virtual_drive::maker::{NAMES, Name, ODRIVE3};

/// Arguments of `joint image`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint image                                 joint q1 for the olimex-h405, which the emulator stands for
  joint image --role observer                 observer and compensation for it, beside a motor controller
  joint image --role drive --board odrive-3.6              the joint behind an ODrive on the board's CAN bus
  joint image --role drive --drive moteus --id 2 --board moteus-r4
  joint image --role spi-observer --board nucleo-g474re    the same as a slave on that controller's SPI
  joint image joints/l1.toml --board nucleo-h743zi
  joint image --board my_board.toml           for a board of your own")]
pub struct Arguments {
    /// Board that the image is for: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT)]
    board: Board,
    #[command(flatten)]
    image: Image,
}

/// Contents of an image, besides its board.
#[derive(Debug, clap::Args)]
#[group(id = "image")]
pub struct Image {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(value_name = "FILE", default_value = "q1")]
    file: PathBuf,
    /// Role of the board
    #[arg(long, value_enum, default_value = "plant")]
    role: ImageRole,
    /// Maker of the drive in role drive [default: moteus on a board with a second bit rate, else odrive3]
    #[arg(long, value_name = "MAKER", value_parser = maker())]
    drive: Option<Name>,
    /// Identifier of the drive on its bus in role drive [default: 1]
    #[arg(long, value_name = "ID")]
    id: Option<u8>,
    /// Step rate in Hz; the control rate for every role but plant [default: 20000 for plant, 5000 for spi-observer,
    /// else 10000, or the next lower rate that the chip has time for]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..))]
    rate: Option<u32>,
    /// Builds even if the worst-case tick exceeds the period; every role but drive reports `forced` in its identity
    #[arg(long)]
    force: bool,
}

/// Role of a board, with the interface that the image uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ImageRole {
    /// Simulates the joint
    Plant,
    /// Observer and compensation beside a motor controller
    Observer,
    /// Joint, motor, observer and compensation
    Loop,
    /// Observer and compensation as a slave on SPI beside a motor controller on another chip; for boards whose file has
    /// [spi_slave]
    SpiObserver,
    /// Joint behind a finished drive on CAN, for clients of its maker; for boards whose file has [can]
    Drive,
}

/// Parser of a maker's word.
fn maker() -> impl TypedValueParser<Value = Name> {
    PossibleValuesParser::new(NAMES.map(|name| name.word))
        .try_map(|word| Name::from_word(&word).ok_or("there is no drive of this maker"))
}

impl ImageRole {
    /// Role in the protocol, or the one with the longer tick: a slave on SPI is an observer.
    pub fn role(self) -> Role {
        match self {
            Self::Plant => Role::Plant,
            Self::Observer | Self::SpiObserver => Role::Observer,
            // The drive runs the joint of the loop.
            Self::Loop | Self::Drive => Role::Loop,
        }
    }

    /// Default rate of an image in this role [Hz].
    pub fn default_rate(self, joint: &JointParameters, board: &Board) -> u32 {
        match self {
            Self::Plant => image::DEFAULT_TICK_RATE,
            Self::Observer | Self::Loop => tick_time::default_control_rate(joint, board, self.role()),
            Self::SpiObserver => image::SPI_RATE,
            Self::Drive => image::default_drive_rate(joint, board),
        }
    }

    /// Check of the rates of a joint on a board.
    pub fn rate_check<'a>(self, joint: &'a JointParameters, board: &'a Board) -> RateCheck<'a> {
        match self {
            Self::Drive => RateCheck::drive(joint, board),
            _ => RateCheck::new(joint, board, self.role()),
        }
    }

    /// Predicts whether an image in this role fits a board at a rate.
    pub fn predict(self, joint: &JointParameters, board: &Board, rate: u32) -> Prediction {
        Prediction::new(board, joint, &self.word(), self.role(), rate)
    }

    /// Word of the command line.
    fn word(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

impl Image {
    /// Rejects options that have no effect in the role.
    fn check_options(&self) -> Outcome<()> {
        let given = [("--drive", self.drive.is_some()), ("--id", self.id.is_some())];
        match given.into_iter().find(|(_, is_given)| *is_given && self.role != ImageRole::Drive) {
            None => Ok(()),
            Some((option, _)) => Err(Failure::new(format!("{option} is for the role drive, not {}", self.role.word()))
                .with_help(format!("add `--role drive`, or leave {option} out"))),
        }
    }

    /// Drive of the role `drive`, with the defaults of a board.
    fn drive_on(&self, board: &Board) -> image::DriveOnBus {
        let usual = board.description.can.as_ref().map_or(ODRIVE3, image::usual_maker);
        image::DriveOnBus { maker: self.drive.unwrap_or(usual), id: self.id.unwrap_or(1) }
    }
}

/// Builds an image and prints its path and size.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let built = build(&arguments.image, &arguments.board)?;
    let image::Image { elf, flash_bytes, ram_bytes, .. } = &built;
    output::print(&format!("{}\nflash {flash_bytes} B, RAM {ram_bytes} B\n", elf.display()))
}

/// Builds an image and shows the progress.
pub fn build(arguments: &Image, board: &Board) -> Outcome<image::Image> {
    arguments.check_options()?;
    let loaded = named::load(&arguments.file)?;
    warnings::print(&loaded);
    let file = image::joint_file(&arguments.file, &loaded.name);
    let (parameters, role) = (&loaded.file.parameters, arguments.role);
    let rate = arguments.rate.unwrap_or_else(|| role.default_rate(parameters, board));
    let progress = Progress::new();
    let say = |line: &str| progress.print_message(line);
    let predicted = role.predict(parameters, board, rate);
    if !predicted.has_room() {
        say(&format!("predicted for {}, from {ORIGIN}: {predicted}; building anyway", board.name()));
    }
    progress.stage("preparing the toolchain");
    let built = Toolchain::prepare(&say).and_then(|toolchain| {
        progress.stage("building the firmware");
        match role {
            ImageRole::SpiObserver => image::build_spi_slave(&toolchain, &file, board, rate, arguments.force, &say),
            ImageRole::Drive => {
                let drive = arguments.drive_on(board);
                image::build_drive(&toolchain, &file, board, &drive, rate, arguments.force, &say)
            }
            _ => image::build_image(&toolchain, &file, board, role.role(), rate, arguments.force, &say),
        }
    });
    progress.clear();
    interruption::explain(built)
}
