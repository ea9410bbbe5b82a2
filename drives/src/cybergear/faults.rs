//! Faults: bits of the feedback, bits of the fault frame.

use super::model::Model;
use crate::drive::{Drive, Fault};

/// Faults of the feedback frame, bit 0 being bit 16 of the identifier.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Flags(pub u8);

impl Flags {
    /// Bus voltage too low.
    pub const UNDER_VOLTAGE: u8 = 1;
    /// Current too high.
    pub const OVER_CURRENT: u8 = 1 << 1;
    /// Temperature too high.
    pub const OVER_TEMPERATURE: u8 = 1 << 2;
    /// Magnetic encoder.
    pub const ENCODER: u8 = 1 << 3;
    /// Hall encoder of CyberGear; blocked rotor of RobStride.
    pub const HALL_OR_STALL: u8 = 1 << 4;
    /// Encoder not calibrated.
    pub const NOT_CALIBRATED: u8 = 1 << 5;
    /// All bits.
    pub(super) const ALL: u8 = 0x3F;

    /// Bits of a drive.
    pub(super) fn new(model: Model, drive: &Drive) -> Self {
        let encoder = if model.is_robstride() { Self::ENCODER } else { Self::HALL_OR_STALL };
        let fault = match drive.fault() {
            Some(Fault::UnderVoltage) => Self::UNDER_VOLTAGE,
            Some(Fault::OverTemperature) => Self::OVER_TEMPERATURE,
            Some(Fault::MotorEncoder) => Self::ENCODER,
            Some(Fault::OutputEncoder) => encoder,
            Some(Fault::NotCalibrated) => Self::NOT_CALIBRATED,
            _ => 0,
        };
        let uncalibrated = if drive.is_calibrated() { 0 } else { Self::NOT_CALIBRATED };
        Self(fault | uncalibrated)
    }

    /// True if a bit is set.
    pub fn has(self, bit: u8) -> bool {
        self.0 & bit != 0
    }
}

/// Bits of the fault frame.
pub(super) mod bit {
    pub const OVER_TEMPERATURE: u32 = 1;
    pub const DRIVER: u32 = 1 << 1;
    pub const UNDER_VOLTAGE: u32 = 1 << 2;
    pub const OVER_VOLTAGE: u32 = 1 << 3;
    pub const NOT_CALIBRATED: u32 = 1 << 7;
    /// Warning.
    pub const WARM: u32 = 1;
}

/// Fault word of a drive. A lost encoder has no bit of its own; its feedback bit tells it from the driver chip.
pub(super) fn fault_word(drive: &Drive) -> u32 {
    match drive.fault() {
        None | Some(Fault::Watchdog) => 0,
        Some(Fault::OverTemperature) => bit::OVER_TEMPERATURE,
        Some(Fault::UnderVoltage) => bit::UNDER_VOLTAGE,
        Some(Fault::OverVoltage) => bit::OVER_VOLTAGE,
        Some(Fault::NotCalibrated) => bit::NOT_CALIBRATED,
        Some(_) => bit::DRIVER,
    }
}

/// Warning word of a drive.
pub(super) fn warning_word(model: Model, drive: &Drive) -> u32 {
    let sheet = model.sheet();
    // The warning keeps its distance if a client sets another limit.
    let distance = sheet.max_temperature - sheet.warning_temperature;
    let is_warm = drive.feedback().sensors.motor_temperature >= drive.settings().max_temperature - distance;
    if is_warm { bit::WARM } else { 0 }
}
