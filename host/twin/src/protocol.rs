//! Drives by name: their servers, their settings, and the wires that their clients use.

use clap::ValueEnum;
use drives::bus::{CanServer, SerialServer};
use drives::cybergear::Model;
use drives::{Settings, cia402, cybergear, damiao, feetech, moteus, odrive};

use crate::wire::WireName;

/// Drive by the name of its maker or profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DriveName {
    /// moteus: CAN FD, registers
    Moteus,
    /// ODrive Pro, S1, Micro (firmware 0.6): CANSimple
    Odrive,
    /// ODrive 3.6 (firmware 0.5): CANSimple
    Odrive3,
    /// Damiao: MIT frame
    Damiao,
    /// Xiaomi CyberGear: 29-bit identifiers
    Cybergear,
    /// RobStride 00 to 04: 29-bit identifiers
    Robstride,
    /// Feetech STS3215: serial bus
    Feetech,
    /// CiA 402 on CANopen
    Cia402,
}

/// Identifier of the answers of Damiao drives, beside the drive's own in the low bits: as most clients have it.
const DAMIAO_FEEDBACK: u16 = 0x10;

/// RobStride models that a joint may get.
const ROBSTRIDES: [Model; 4] = [Model::RobStride00, Model::RobStride02, Model::RobStride03, Model::RobStride04];

/// Server of a drive on its kind of bus.
pub enum Server {
    /// CAN bus.
    Can(Box<dyn CanServer>),
    /// Serial bus.
    Serial(Box<dyn SerialServer>),
}

impl DriveName {
    /// Word on the command line.
    pub fn word(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Wire that most clients of the drive use.
    pub fn usual_wire(self) -> WireName {
        match self {
            Self::Moteus => WireName::Fdcanusb,
            Self::Feetech => WireName::Serial,
            _ => WireName::Slcan,
        }
    }

    /// Voltage of a usual supply [V].
    pub fn usual_supply(self) -> f32 {
        match self {
            Self::Feetech => 12.0,
            Self::Damiao | Self::Cybergear => 24.0,
            _ => 48.0,
        }
    }

    /// Largest current of the motor [A]: of the data sheets of CyberGear and RobStride 02, and the current that an
    /// STS3215 draws when it stands still; the others are assumed.
    pub fn peak_current(self) -> f32 {
        match self {
            Self::Feetech => 2.7,
            Self::Cybergear | Self::Robstride => 23.0,
            _ => 40.0,
        }
    }

    /// True for a drive on a serial bus.
    pub fn is_serial(self) -> bool {
        self == Self::Feetech
    }

    /// Largest identifier of the drive on its bus.
    pub fn max_id(self) -> u8 {
        match self {
            Self::Moteus => 127,
            Self::Odrive | Self::Odrive3 => 62,
            Self::Damiao => 15,
            Self::Cybergear | Self::Robstride | Self::Cia402 => 127,
            Self::Feetech => 253,
        }
    }

    /// Settings with the maker's defaults.
    pub fn settings(self, settings: Settings) -> Settings {
        match self {
            Self::Moteus => moteus::settings(settings),
            Self::Odrive | Self::Odrive3 => odrive::settings(settings),
            Self::Damiao => damiao::settings(settings),
            Self::Cybergear => cybergear::settings(Model::CyberGear, settings),
            Self::Robstride => cybergear::settings(robstride_model(&settings), settings),
            Self::Feetech => feetech::settings(settings),
            Self::Cia402 => cia402::settings(settings),
        }
    }

    /// Model of the drive whose fields have room for the joint's torque; `None` if the maker has one form only.
    pub fn model(self, settings: &Settings) -> Option<String> {
        match self {
            Self::Damiao => Some(damiao_type(settings).0.to_owned()),
            Self::Robstride => Some(format!("{:?}", robstride_model(settings))),
            _ => None,
        }
    }

    /// Server of a drive with an identifier and settings.
    pub fn server(self, id: u8, settings: &Settings) -> Server {
        match self {
            Self::Moteus => Server::Can(Box::new(moteus::Server::new(id))),
            Self::Odrive => Server::Can(Box::new(odrive::Server::new(id, odrive::Firmware::V0_6))),
            Self::Odrive3 => Server::Can(Box::new(odrive::Server::new(id, odrive::Firmware::V0_5))),
            Self::Damiao => {
                let ranges = damiao_type(settings).1;
                Server::Can(Box::new(damiao::Server::new(id.into(), DAMIAO_FEEDBACK | u16::from(id), ranges)))
            }
            Self::Cybergear => Server::Can(Box::new(cybergear::Server::new(id, Model::CyberGear))),
            Self::Robstride => Server::Can(Box::new(cybergear::Server::new(id, robstride_model(settings)))),
            Self::Feetech => Server::Serial(Box::new(feetech::Server::new(id, settings))),
            Self::Cia402 => Server::Can(Box::new(cia402::Server::new(id))),
        }
    }

    /// Line of Python that connects the usual client to a port.
    pub fn client(self, wire: WireName, port: &str) -> String {
        let bus = match wire {
            WireName::Socketcand => {
                format!("can.Bus(interface=\"socketcand\", host=\"127.0.0.1\", port={port}, channel=\"can0\")")
            }
            _ => format!("can.Bus(interface=\"slcan\", channel=\"{port}\", bitrate=1000000, sleep_after_open=0)"),
        };
        match (self, wire) {
            (Self::Moteus, WireName::Fdcanusb) => format!("moteus.Fdcanusb(\"{port}\")"),
            (Self::Moteus, WireName::Slcan) => format!(
                "moteus.PythonCan(interface=\"slcan\", channel=\"{port}\", bitrate=1000000, sleep_after_open=0)"
            ),
            (Self::Damiao, WireName::Slcan) => format!("DaMiaoController(channel=\"{port}\", bustype=\"slcan\")"),
            (Self::Cybergear, WireName::Slcan) => format!("CyberGear(interface=\"slcan\", channel=\"{port}\")"),
            (Self::Feetech, _) => format!("PortHandler(\"{port}\")"),
            (Self::Cia402, WireName::Slcan) => {
                format!("canopen.Network().connect(interface=\"slcan\", channel=\"{port}\", bitrate=1000000)")
            }
            _ => bus,
        }
    }
}

/// Largest torque of the joint's output [N m].
fn peak_torque(settings: &Settings) -> f32 {
    settings.torque_limit * settings.ratio.to_f32()
}

/// Damiao type with the smallest torque range that the joint fits into; else the one with the largest.
fn damiao_type(settings: &Settings) -> (&'static str, damiao::mit::Ranges) {
    smallest_that_fits(damiao::MOTOR_TYPES[0], &damiao::MOTOR_TYPES, |(_, ranges)| ranges.torque, settings)
}

/// RobStride model with the smallest torque range that the joint fits into; else the one with the largest.
fn robstride_model(settings: &Settings) -> Model {
    smallest_that_fits(ROBSTRIDES[0], &ROBSTRIDES, |model| model.sheet().torque.high, settings)
}

/// Model whose torque range is the smallest that holds the joint's; else the one with the largest range.
fn smallest_that_fits<M: Copy>(first: M, models: &[M], torque: fn(&M) -> f32, settings: &Settings) -> M {
    let needed = peak_torque(settings);
    models.iter().copied().fold(first, |best, model| {
        let (range, best_range) = (torque(&model), torque(&best));
        let is_better = if best_range < needed { range > best_range } else { range >= needed && range < best_range };
        if is_better { model } else { best }
    })
}
