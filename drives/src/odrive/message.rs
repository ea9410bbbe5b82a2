//! Messages: which identifier carries which payload on which firmware line.

use super::Firmware;
use super::payload::*;
use crate::frame::{Frame, Kind, standard};

/// Bits of the command in an identifier.
const COMMAND_BITS: u32 = 5;
/// Largest node.
pub const MAX_NODE: u8 = 0x3f;

/// Identifier of a command at a node.
pub fn identifier(node_id: u8, command: u8) -> u16 {
    u16::from(node_id & MAX_NODE) << COMMAND_BITS | u16::from(command & 0x1f)
}

/// Node and command of a classical frame with an identifier of 11 bits.
pub(super) fn address(frame: &Frame) -> Option<(u8, u8)> {
    let id = frame.standard_id().filter(|_| !matches!(frame.kind, Kind::Flexible(_)))?;
    Some(((id >> COMMAND_BITS) as u8, (id & 0x1f) as u8))
}

/// Firmware lines that have a message.
#[derive(Clone, Copy, PartialEq)]
enum Lines {
    V05,
    V06,
    Both,
}

impl Lines {
    fn have(self, firmware: Firmware) -> bool {
        match self {
            Self::Both => true,
            Self::V05 => firmware == Firmware::V0_5,
            Self::V06 => firmware == Firmware::V0_6,
        }
    }
}

/// Messages as `lines identifier Variant(Payload)`.
macro_rules! messages {
    ($(#[$doc:meta])* $name:ident {
        $($(#[$variant_doc:meta])* $lines:ident $id:literal $variant:ident($payload:ty),)*
    }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum $name {
            $($(#[$variant_doc])* $variant($payload),)*
        }

        impl $name {
            /// Frame of the message; `None` if the firmware line does not have the message.
            pub fn encode(&self, firmware: Firmware, node_id: u8) -> Option<Frame> {
                let (lines, id, data, length) = match *self {
                    $(Self::$variant(payload) => (Lines::$lines, $id, payload.pack(), <$payload>::LENGTH),)*
                };
                let frame = Frame::classic(standard(identifier(node_id, id)), data.get(..length)?);
                frame.filter(|_| lines.have(firmware))
            }

            /// Message of an identifier's lower 5 bits; `None` if the line has no such message or the data is too short.
            pub(super) fn decode_data(firmware: Firmware, command: u8, data: &[u8]) -> Option<Self> {
                $(
                    if command == $id && Lines::$lines.have(firmware) {
                        return <$payload>::decode(data).map(Self::$variant);
                    }
                )*
                None
            }

            /// Node and message of a data frame.
            pub fn decode(firmware: Firmware, frame: &Frame) -> Option<(u8, Self)> {
                let (node_id, command) = address(frame).filter(|_| frame.kind == Kind::Classic)?;
                Some((node_id, Self::decode_data(firmware, command, frame.data())?))
            }
        }
    };
}

messages! {
    /// Message to a drive.
    Command {
        /// Stops with an error.
        Both 0x02 Estop(Empty),
        /// Reads or writes a parameter.
        V06 0x04 Parameter(ParameterAccess),
        /// Changes the node.
        V05 0x06 SetNodeId(NodeId),
        /// Gives a node to a serial number.
        V06 0x06 SetAddress(Address),
        /// Requests a state.
        Both 0x07 SetState(RequestedState),
        /// Sets the modes of the controller.
        Both 0x0b SetControllerMode(ControllerMode),
        /// Sets the input of the position loop.
        Both 0x0c SetInputPosition(InputPosition),
        /// Sets the input of the speed loop.
        Both 0x0d SetInputVelocity(InputVelocity),
        /// Sets the input torque.
        Both 0x0e SetInputTorque(InputTorque),
        /// Sets the limits.
        Both 0x0f SetLimits(Limits),
        /// Starts the calibration of the cogging torque.
        V05 0x10 StartAnticogging(Empty),
        /// Sets the largest speed of trajectories.
        Both 0x11 SetTrajectoryVelocity(TrajectoryVelocity),
        /// Sets the largest accelerations of trajectories.
        Both 0x12 SetTrajectoryAcceleration(TrajectoryAcceleration),
        /// Sets the inertia of the feed-forward torque.
        Both 0x13 SetInertia(Inertia),
        /// Reboots.
        Both 0x16 Reboot(Reboot),
        /// Clears all errors.
        Both 0x18 ClearErrors(ClearErrors),
        /// Sets the present counts.
        V05 0x19 SetLinearCount(LinearCount),
        /// Sets the present angle.
        V06 0x19 SetAbsolutePosition(AbsolutePosition),
        /// Sets the gain of the position loop.
        Both 0x1a SetPositionGain(PositionGain),
        /// Sets the gains of the speed loop.
        Both 0x1b SetVelocityGains(VelocityGains),
        /// Requests the voltage of a pin.
        V05 0x1c RequestAdcVoltage(AdcRequest),
        /// Enters the boot loader.
        V06 0x1f EnterDfuMode(Empty),
    }
}

messages! {
    /// Message from a drive.
    Report {
        /// Versions.
        V06 0x00 Version(Version),
        /// Heartbeat of firmware 0.5.
        V05 0x01 LegacyHeartbeat(LegacyHeartbeat),
        /// Heartbeat of firmware 0.6.
        V06 0x01 Heartbeat(Heartbeat),
        /// Errors of the motor.
        V05 0x03 MotorError(MotorError),
        /// Active errors and disarm reason.
        V06 0x03 Errors(Errors),
        /// Errors of the encoder.
        V05 0x04 EncoderError(PartError),
        /// Errors of the sensorless estimator.
        V05 0x05 SensorlessError(PartError),
        /// Value of a parameter.
        V06 0x05 Parameter(ParameterAccess),
        /// Node and serial number.
        V06 0x06 Address(Address),
        /// Angle and speed of the motor.
        Both 0x09 EncoderEstimates(Estimates),
        /// Counts of the encoder.
        V05 0x0a EncoderCount(EncoderCount),
        /// Currents.
        Both 0x14 Currents(Currents),
        /// Angle and speed of the sensorless estimator.
        V05 0x15 SensorlessEstimates(Estimates),
        /// Temperatures.
        V06 0x15 Temperatures(Temperatures),
        /// Voltage and current of the bus.
        Both 0x17 Bus(Bus),
        /// Voltage of a pin.
        V05 0x1c AdcVoltage(AdcVoltage),
        /// Torques of the motor.
        V06 0x1c Torques(Torques),
        /// Errors of the controller.
        V05 0x1d ControllerError(PartError),
        /// Powers.
        V06 0x1d Powers(Powers),
    }
}
