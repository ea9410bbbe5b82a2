//! Drives by name: their servers, their settings, and the wires that their clients use.

use clap::ValueEnum;
use drives::bus::{CanServer, SerialServer};
use drives::{Settings, feetech};
use virtual_drive::maker::{self, Maker, damiao_type, robstride_model};
use wires::WireName;

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

/// Runs an expression for the maker of a drive on a CAN bus, as type `$maker`, or another for a serial bus.
macro_rules! for_maker {
    ($drive:expr, $maker:ident => $on_can:expr, $on_serial:expr) => {
        match $drive {
            DriveName::Moteus => for_maker!(@ $maker = maker::Moteus, $on_can),
            DriveName::Odrive => for_maker!(@ $maker = maker::Odrive, $on_can),
            DriveName::Odrive3 => for_maker!(@ $maker = maker::Odrive3, $on_can),
            DriveName::Damiao => for_maker!(@ $maker = maker::Damiao, $on_can),
            DriveName::Cybergear => for_maker!(@ $maker = maker::Cybergear, $on_can),
            DriveName::Robstride => for_maker!(@ $maker = maker::Robstride, $on_can),
            DriveName::Cia402 => for_maker!(@ $maker = maker::Cia402, $on_can),
            DriveName::Feetech => $on_serial,
        }
    };
    (@ $maker:ident = $type:ty, $on_can:expr) => {{
        type $maker = $type;
        $on_can
    }};
}

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
        for_maker!(self, M => M::SUPPLY, 12.0)
    }

    /// Largest current of the motor [A]: the maker's, and the current that an STS3215 draws when it stands still.
    pub fn peak_current(self) -> f32 {
        for_maker!(self, M => M::PEAK_CURRENT, 2.7)
    }

    /// True for a drive on a serial bus.
    pub fn is_serial(self) -> bool {
        self == Self::Feetech
    }

    /// Largest identifier of the drive on its bus.
    pub fn max_id(self) -> u8 {
        for_maker!(self, M => M::MAX_ID, 253)
    }

    /// Settings with the maker's defaults.
    pub fn settings(self, settings: Settings) -> Settings {
        for_maker!(self, M => M::settings(settings), feetech::settings(settings))
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
        for_maker!(
            self,
            M => Server::Can(Box::new(M::server(id, settings))),
            Server::Serial(Box::new(feetech::Server::new(id, settings)))
        )
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
