//! Makers of drives on a CAN bus: a type for each, with the server of its protocol and the settings of its drives.

use drives::bus::CanServer;
use drives::cybergear::{self, Model};
use drives::{Settings, cia402, damiao, moteus, odrive};

/// Identifier of the answers of Damiao drives, beside the drive's own in the low bits: as most clients have it.
const DAMIAO_FEEDBACK: u16 = 0x10;
/// Largest current of a motor whose maker's data sheet was not read [A]. Assumed.
const PEAK_CURRENT: f32 = 40.0;

/// RobStride models that a joint may get.
const ROBSTRIDES: [Model; 4] = [Model::RobStride00, Model::RobStride02, Model::RobStride03, Model::RobStride04];

/// Maker of a drive on a CAN bus.
pub trait Maker {
    /// Server of the protocol.
    type Server: CanServer;
    /// Voltage of a usual supply [V].
    const SUPPLY: f32 = 48.0;
    /// Largest current of the motor [A].
    const PEAK_CURRENT: f32 = PEAK_CURRENT;
    /// Largest identifier of the drive on its bus.
    const MAX_ID: u8;
    /// True for frames of CAN FD.
    const IS_FLEXIBLE: bool = false;

    /// Settings with the maker's defaults.
    fn settings(settings: Settings) -> Settings;

    /// Server of a drive with an identifier and settings.
    fn server(id: u8, settings: &Settings) -> Self::Server;
}

/// Maker by the word of command lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Name {
    /// Word.
    pub word: &'static str,
    /// Type of this module.
    pub type_name: &'static str,
    /// Largest identifier of the drive on its bus.
    pub max_id: u8,
    /// True for frames of CAN FD.
    pub is_flexible: bool,
}

impl Name {
    /// Finds a maker by its word.
    pub fn from_word(word: &str) -> Option<Self> {
        NAMES.into_iter().find(|name| name.word == word)
    }
}

const fn name<M: Maker>(word: &'static str, type_name: &'static str) -> Name {
    Name { word, type_name, max_id: M::MAX_ID, is_flexible: M::IS_FLEXIBLE }
}

/// moteus.
pub const MOTEUS: Name = name::<Moteus>("moteus", "Moteus");
/// ODrive 3.6.
pub const ODRIVE3: Name = name::<Odrive3>("odrive3", "Odrive3");

/// Makers by their words.
pub const NAMES: [Name; 7] = [
    MOTEUS,
    name::<Odrive>("odrive", "Odrive"),
    ODRIVE3,
    name::<Damiao>("damiao", "Damiao"),
    name::<Cybergear>("cybergear", "Cybergear"),
    name::<Robstride>("robstride", "Robstride"),
    name::<Cia402>("cia402", "Cia402"),
];

/// moteus: CAN FD, registers.
#[derive(Debug)]
pub struct Moteus;

impl Maker for Moteus {
    type Server = moteus::Server;
    /// Identifier 127 addresses every drive on the bus.
    const MAX_ID: u8 = 126;
    const IS_FLEXIBLE: bool = true;

    fn settings(settings: Settings) -> Settings {
        moteus::settings(settings)
    }

    fn server(id: u8, _: &Settings) -> moteus::Server {
        moteus::Server::new(id)
    }
}

/// ODrive Pro, S1 and Micro, firmware 0.6: CANSimple.
#[derive(Debug)]
pub struct Odrive;

impl Maker for Odrive {
    type Server = odrive::Server;
    const MAX_ID: u8 = 62;

    fn settings(settings: Settings) -> Settings {
        odrive::settings(settings)
    }

    fn server(id: u8, _: &Settings) -> odrive::Server {
        odrive::Server::new(id, odrive::Firmware::V0_6)
    }
}

/// ODrive 3.6, firmware 0.5: CANSimple.
#[derive(Debug)]
pub struct Odrive3;

impl Maker for Odrive3 {
    type Server = odrive::Server;
    const MAX_ID: u8 = 62;

    fn settings(settings: Settings) -> Settings {
        odrive::settings(settings)
    }

    fn server(id: u8, _: &Settings) -> odrive::Server {
        odrive::Server::new(id, odrive::Firmware::V0_5)
    }
}

/// Damiao: MIT frame.
#[derive(Debug)]
pub struct Damiao;

impl Maker for Damiao {
    type Server = damiao::Server;
    const SUPPLY: f32 = 24.0;
    const MAX_ID: u8 = 15;

    fn settings(settings: Settings) -> Settings {
        damiao::settings(settings)
    }

    fn server(id: u8, settings: &Settings) -> damiao::Server {
        let ranges = damiao_type(settings).1;
        damiao::Server::new(id.into(), DAMIAO_FEEDBACK | u16::from(id), ranges)
    }
}

/// Xiaomi CyberGear: identifiers of 29 bits.
#[derive(Debug)]
pub struct Cybergear;

impl Maker for Cybergear {
    type Server = cybergear::Server;
    const SUPPLY: f32 = 24.0;
    /// Data sheet of the CyberGear.
    const PEAK_CURRENT: f32 = 23.0;
    const MAX_ID: u8 = 127;

    fn settings(settings: Settings) -> Settings {
        cybergear::settings(Model::CyberGear, settings)
    }

    fn server(id: u8, _: &Settings) -> cybergear::Server {
        cybergear::Server::new(id, Model::CyberGear)
    }
}

/// RobStride 00 to 04: identifiers of 29 bits.
#[derive(Debug)]
pub struct Robstride;

impl Maker for Robstride {
    type Server = cybergear::Server;
    /// Data sheet of the RobStride 02.
    const PEAK_CURRENT: f32 = 23.0;
    const MAX_ID: u8 = 127;

    fn settings(settings: Settings) -> Settings {
        cybergear::settings(robstride_model(&settings), settings)
    }

    fn server(id: u8, settings: &Settings) -> cybergear::Server {
        cybergear::Server::new(id, robstride_model(settings))
    }
}

/// CiA 402 on CANopen.
#[derive(Debug)]
pub struct Cia402;

impl Maker for Cia402 {
    type Server = cia402::Server;
    const MAX_ID: u8 = 127;

    fn settings(settings: Settings) -> Settings {
        cia402::settings(settings)
    }

    fn server(id: u8, _: &Settings) -> cia402::Server {
        cia402::Server::new(id)
    }
}

/// Largest torque of the joint's output [N m].
fn peak_torque(settings: &Settings) -> f32 {
    settings.torque_limit * settings.ratio.to_f32()
}

/// Damiao type with the smallest torque range that the joint fits into; else the one with the largest.
pub fn damiao_type(settings: &Settings) -> (&'static str, damiao::mit::Ranges) {
    smallest_that_fits(&damiao::MOTOR_TYPES, |(_, ranges)| ranges.torque, settings)
}

/// RobStride model with the smallest torque range that the joint fits into; else the one with the largest.
pub fn robstride_model(settings: &Settings) -> Model {
    smallest_that_fits(&ROBSTRIDES, |model| model.sheet().torque.high, settings)
}

/// Model whose torque range is the smallest that holds the joint's; else the one with the largest range.
fn smallest_that_fits<M: Copy, const COUNT: usize>(
    models: &[M; COUNT],
    torque: fn(&M) -> f32,
    settings: &Settings,
) -> M {
    let needed = peak_torque(settings);
    let order = |one: &&M, other: &&M| torque(one).total_cmp(&torque(other));
    let smallest = models.iter().filter(|model| torque(model) >= needed).min_by(order);
    *smallest.or_else(|| models.iter().rev().max_by(order)).unwrap_or(&models[0])
}
