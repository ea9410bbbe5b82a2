//! Payloads: each field is described once, for both directions. All fields are little endian.

use crate::scale;

/// Value of a field.
pub(super) trait Field: Sized {
    /// Reads the value at a byte of the payload; missing bytes are zero.
    fn read(data: &[u8; 8], at: usize) -> Self;

    /// Writes the value at a byte of the payload.
    fn write(self, data: &mut [u8; 8], at: usize);
}

impl<const N: usize> Field for [u8; N] {
    fn read(data: &[u8; 8], at: usize) -> Self {
        let mut bytes = [0; N];
        bytes.iter_mut().zip(data.iter().skip(at)).for_each(|(byte, from)| *byte = *from);
        bytes
    }

    fn write(self, data: &mut [u8; 8], at: usize) {
        data.iter_mut().skip(at).zip(self).for_each(|(to, byte)| *to = byte);
    }
}

macro_rules! numbers {
    ($($number:ty)*) => {$(
        impl Field for $number {
            fn read(data: &[u8; 8], at: usize) -> Self {
                Self::from_le_bytes(Field::read(data, at))
            }

            fn write(self, data: &mut [u8; 8], at: usize) {
                self.to_le_bytes().write(data, at);
            }
        }
    )*};
}

numbers!(u8 u16 i16 u32 i32 u64 f32);

/// Value in a field of 16 bits with the unit 0.001.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Milli(pub f32);

impl Field for Milli {
    fn read(data: &[u8; 8], at: usize) -> Self {
        Self(f32::from(i16::read(data, at)) / 1e3)
    }

    fn write(self, data: &mut [u8; 8], at: usize) {
        // The cast saturates; NaN gives zero.
        (scale::round(self.0 * 1e3) as i16).write(data, at);
    }
}

/// Payload of a message.
pub(super) trait Payload: Sized {
    /// Bytes of an encoded payload.
    const LENGTH: usize;
    /// Fewest bytes of a payload that is accepted; missing fields are zero.
    const MIN_LENGTH: usize;

    /// Encodes.
    fn pack(self) -> [u8; 8];

    /// Decodes a payload that was filled up with zeros.
    fn unpack(data: &[u8; 8]) -> Self;

    /// Decodes; `None` for a payload that is too short.
    fn decode(data: &[u8]) -> Option<Self> {
        let mut filled = [0; 8];
        filled.iter_mut().zip(data).for_each(|(to, byte)| *to = *byte);
        (data.len() >= Self::MIN_LENGTH).then(|| Self::unpack(&filled))
    }
}

/// Payloads as `Name [length, fewest bytes] { field: kind = first byte }`.
macro_rules! payloads {
    ($($(#[$doc:meta])* $name:ident [$length:literal, $min:literal] {
        $($(#[$field_doc:meta])* $field:ident: $kind:ty = $at:literal,)*
    })*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Default, PartialEq)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $kind,)*
        }

        impl Payload for $name {
            const LENGTH: usize = $length;
            const MIN_LENGTH: usize = $min;

            #[allow(unused_mut, reason = "an empty payload has no field")]
            fn pack(self) -> [u8; 8] {
                let mut data = [0; 8];
                $(self.$field.write(&mut data, $at);)*
                data
            }

            #[allow(unused_variables, reason = "an empty payload has no field")]
            fn unpack(data: &[u8; 8]) -> Self {
                Self { $($field: Field::read(data, $at),)* }
            }
        }
    )*};
}

payloads! {
    /// Payload without a field.
    Empty [0, 0] {}

    /// Versions of protocol, hardware and firmware.
    Version [8, 8] {
        /// Version of the protocol.
        protocol: u8 = 0,
        /// Product line, version and variant of the hardware.
        hardware: [u8; 3] = 1,
        /// Major, minor and revision of the firmware.
        firmware: [u8; 3] = 4,
        /// Zero for a released firmware.
        unreleased: u8 = 7,
    }

    /// Heartbeat of firmware 0.5.
    LegacyHeartbeat [8, 8] {
        /// Errors of the axis, [`super::codes::axis_error`].
        axis_error: u32 = 0,
        /// State, [`super::codes::axis_state`].
        state: u8 = 4,
        /// One while the motor has an error.
        motor_error: u8 = 5,
        /// One while the encoder has an error.
        encoder_error: u8 = 6,
        /// Bit 0: error of the controller; bit 7: trajectory done.
        controller_flags: u8 = 7,
    }

    /// Heartbeat of firmware 0.6.
    Heartbeat [8, 7] {
        /// Active errors and disarm reason, [`super::codes::error`].
        axis_error: u32 = 0,
        /// State, [`super::codes::axis_state`].
        state: u8 = 4,
        /// Result of the last procedure, [`super::codes::procedure_result`].
        procedure_result: u8 = 5,
        /// One once the trajectory is done.
        trajectory_done: u8 = 6,
    }

    /// Errors of firmware 0.6, [`super::codes::error`].
    Errors [8, 8] {
        /// Errors that keep the axis from arming.
        active: u32 = 0,
        /// Errors that disarmed the axis last.
        disarm_reason: u32 = 4,
    }

    /// Errors of the motor, [`super::codes::motor_error`]. The DBC describes the lower 32 bits.
    MotorError [8, 8] {
        /// Errors.
        errors: u64 = 0,
    }

    /// Errors of encoder, estimator or controller, [`super::codes::encoder_error`], [`super::codes::controller_error`].
    PartError [8, 4] {
        /// Errors.
        errors: u32 = 0,
    }

    /// Access to a parameter, or the answer to it.
    ParameterAccess [8, 4] {
        /// 0 to read, 1 to write; 0 in an answer.
        opcode: u8 = 0,
        /// Endpoint.
        endpoint: u16 = 1,
        /// Value in the type of the endpoint.
        value: [u8; 4] = 4,
    }

    /// Node and serial number of an axis.
    Address [8, 7] {
        /// Node.
        node_id: u8 = 0,
        /// Serial number.
        serial_number: [u8; 6] = 1,
        /// Connection, 0 without one.
        connection: u8 = 7,
    }

    /// Node of an axis.
    NodeId [8, 4] {
        /// Node.
        node_id: u32 = 0,
    }

    /// Requested state.
    RequestedState [8, 4] {
        /// State, [`super::codes::axis_state`].
        state: u32 = 0,
    }

    /// Estimates of angle and speed.
    Estimates [8, 8] {
        /// Angle [turns].
        position: f32 = 0,
        /// Speed [turns/s].
        velocity: f32 = 4,
    }

    /// Counts of an encoder.
    EncoderCount [8, 8] {
        /// Counts with all turns.
        shadow: i32 = 0,
        /// Counts within a turn.
        in_turn: i32 = 4,
    }

    /// Modes of the controller.
    ControllerMode [8, 8] {
        /// Control mode, [`super::codes::control_mode`].
        control: u32 = 0,
        /// Input mode, [`super::codes::input_mode`].
        input: u32 = 4,
    }

    /// Input of the position loop.
    InputPosition [8, 4] {
        /// Angle of the motor [turns].
        position: f32 = 0,
        /// Feed-forward speed of the motor [turns/s].
        velocity: Milli = 4,
        /// Feed-forward torque of the motor [N m].
        torque: Milli = 6,
    }

    /// Input of the speed loop.
    InputVelocity [8, 4] {
        /// Speed of the motor [turns/s].
        velocity: f32 = 0,
        /// Feed-forward torque of the motor [N m].
        torque: f32 = 4,
    }

    /// Input torque.
    InputTorque [8, 4] {
        /// Torque of the motor [N m].
        torque: f32 = 0,
    }

    /// Limits.
    Limits [8, 8] {
        /// Largest speed of the motor [turns/s].
        velocity: f32 = 0,
        /// Largest current [A].
        current: f32 = 4,
    }

    /// Largest speed of a trajectory.
    TrajectoryVelocity [8, 4] {
        /// Speed of the motor [turns/s].
        velocity: f32 = 0,
    }

    /// Largest accelerations of a trajectory.
    TrajectoryAcceleration [8, 8] {
        /// Acceleration of the motor [turns/s^2].
        acceleration: f32 = 0,
        /// Deceleration of the motor [turns/s^2].
        deceleration: f32 = 4,
    }

    /// Inertia.
    Inertia [8, 4] {
        /// Torque over acceleration of the motor [N m/(turns/s^2)].
        inertia: f32 = 0,
    }

    /// Currents.
    Currents [8, 8] {
        /// Commanded torque-producing current [A].
        setpoint: f32 = 0,
        /// Measured torque-producing current [A].
        measured: f32 = 4,
    }

    /// Temperatures.
    Temperatures [8, 8] {
        /// Power stage [deg C].
        inverter: f32 = 0,
        /// Winding [deg C].
        motor: f32 = 4,
    }

    /// Reboot; an empty payload reboots as well.
    Reboot [1, 0] {
        /// Action, [`super::codes::reboot`].
        action: u8 = 0,
    }

    /// Bus.
    Bus [8, 8] {
        /// Voltage [V].
        voltage: f32 = 0,
        /// Current [A].
        current: f32 = 4,
    }

    /// Clearing of errors; an empty payload clears as well.
    ClearErrors [1, 0] {
        /// One to blink the lamp.
        identify: u8 = 0,
    }

    /// Count to be set.
    LinearCount [8, 4] {
        /// Counts of the encoder with all turns.
        position: i32 = 0,
    }

    /// Angle to be set.
    AbsolutePosition [8, 4] {
        /// Angle of the motor [turns].
        position: f32 = 0,
    }

    /// Gain of the position loop.
    PositionGain [8, 4] {
        /// Gain [1/s].
        gain: f32 = 0,
    }

    /// Gains of the speed loop.
    VelocityGains [8, 8] {
        /// Gain at the motor [N m/(turns/s)].
        gain: f32 = 0,
        /// Integral gain at the motor [N m/turn].
        integrator: f32 = 4,
    }

    /// Request for the voltage of a pin.
    AdcRequest [1, 1] {
        /// Number of the pin.
        pin: u8 = 0,
    }

    /// Voltage of a pin.
    AdcVoltage [8, 4] {
        /// Voltage [V].
        voltage: f32 = 0,
    }

    /// Torques of the motor.
    Torques [8, 8] {
        /// Commanded torque [N m].
        target: f32 = 0,
        /// Torque by the measured current [N m].
        estimate: f32 = 4,
    }

    /// Powers.
    Powers [8, 8] {
        /// Electrical power into the motor [W].
        electrical: f32 = 0,
        /// Mechanical power of the rotor [W].
        mechanical: f32 = 4,
    }
}
