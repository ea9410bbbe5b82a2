//! Images under check, built by the host's own code so that they equal those that ship.

use std::collections::BTreeMap;

use board::device::board::Board;
use board::device::image::{
    self, CONTROL_RATE, DEFAULT_TICK_RATE, DriveOnBus, SPI_RATE, default_drive_rate, usual_maker,
};
use board::device::tick_time;
use board::device::toolchain::Toolchain;
use link::messages::Role;
use parameters::JointParameters;
use virtual_drive::maker::Name;

use crate::image::Image;

/// Joint of all images.
pub const JOINT: &str = "q1";

/// Kind of image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Work {
    /// Role `plant`.
    Plant,
    /// Role `observer`.
    Observer,
    /// Role `loop`.
    Loop,
    /// SPI slave.
    SpiSlave,
    /// Drive on CAN.
    Drive,
    /// Drive on CANopen.
    Canopen,
}

impl Work {
    /// Name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plant => "plant",
            Self::Observer => "observer",
            Self::Loop => "loop",
            Self::SpiSlave => "slave on SPI",
            Self::Drive => "drive on CAN",
            Self::Canopen => "drive on CANopen",
        }
    }
}

/// Parameters of the joint.
fn parameters() -> Result<JointParameters, String> {
    let preset = joint_file::preset(JOINT).ok_or("no such joint")?;
    Ok(joint_file::read(preset).map_err(|_| "a preset with problems")?.parameters)
}

/// Drive that the image of a board is: that of a board with CAN FD is a moteus, that of another one an ODrive 3.6.
pub fn drive_of(board: &Board) -> Option<DriveOnBus> {
    board.description.can_line().ok().map(|can| DriveOnBus { maker: usual_maker(can), id: 1 })
}

/// Drive that the CANopen image of a board is.
pub fn canopen_drive(board: &Board) -> Option<DriveOnBus> {
    board.description.can_line().ok().and_then(|_| Some(DriveOnBus { maker: Name::from_word("cia402")?, id: 1 }))
}

/// Images by board and kind.
pub struct Images {
    toolchain: Toolchain,
    built: BTreeMap<(String, Work), Image>,
}

impl Images {
    /// Prepares the toolchain; no image is built yet.
    pub fn prepare() -> Result<Self, String> {
        let toolchain = Toolchain::prepare(&|line| eprintln!("{line}")).map_err(|failure| failure.to_string())?;
        Ok(Self { toolchain, built: BTreeMap::new() })
    }

    /// Returns an image; it is built at the first request.
    pub fn get(&mut self, board: &Board, work: Work) -> Result<Image, String> {
        if let Some(image) = self.built.get(&(board.argument.clone(), work)) {
            return Ok(image.clone());
        }
        let (joint, quiet) = (image::preset_file(JOINT), |_: &str| {});
        let role = |role, rate| image::build_image(&self.toolchain, &joint, board, role, rate, false, &quiet);
        let built = match work {
            Work::Plant => role(Role::Plant, DEFAULT_TICK_RATE),
            Work::Observer => role(Role::Observer, CONTROL_RATE),
            // The highest common rate that fits the chip.
            Work::Loop => role(Role::Loop, tick_time::default_control_rate(&parameters()?, board, Role::Loop)),
            Work::Drive | Work::Canopen => {
                let drive = if work == Work::Drive { drive_of(board) } else { canopen_drive(board) };
                let drive = drive.ok_or("the board is no drive")?;
                image::build_drive(
                    &self.toolchain,
                    &joint,
                    board,
                    &drive,
                    default_drive_rate(&parameters()?, board),
                    false,
                    &quiet,
                )
            }
            Work::SpiSlave => image::build_spi_slave(&self.toolchain, &joint, board, SPI_RATE, false, &quiet),
        };
        let image = Image::read(&built.map_err(|failure| failure.to_string())?.elf)?;
        self.built.insert((board.argument.clone(), work), image.clone());
        Ok(image)
    }
}
