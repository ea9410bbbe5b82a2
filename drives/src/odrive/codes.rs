//! Numbers of states, modes, results and errors.

/// States of an axis.
pub mod axis_state {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const UNDEFINED: u8 = 0;
    pub const IDLE: u8 = 1;
    pub const STARTUP_SEQUENCE: u8 = 2;
    pub const FULL_CALIBRATION_SEQUENCE: u8 = 3;
    pub const MOTOR_CALIBRATION: u8 = 4;
    pub const ENCODER_OFFSET_CALIBRATION: u8 = 7;
    pub const CLOSED_LOOP_CONTROL: u8 = 8;
    pub const HOMING: u8 = 11;
}

/// Control modes.
pub mod control_mode {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const VOLTAGE_CONTROL: u32 = 0;
    pub const TORQUE_CONTROL: u32 = 1;
    pub const VELOCITY_CONTROL: u32 = 2;
    pub const POSITION_CONTROL: u32 = 3;
}

/// Input modes.
pub mod input_mode {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const INACTIVE: u32 = 0;
    pub const PASSTHROUGH: u32 = 1;
    pub const VEL_RAMP: u32 = 2;
    pub const POS_FILTER: u32 = 3;
    pub const MIX_CHANNELS: u32 = 4;
    pub const TRAP_TRAJ: u32 = 5;
    pub const TORQUE_RAMP: u32 = 6;
    pub const MIRROR: u32 = 7;
    pub const TUNING: u32 = 8;
}

/// Results of procedures (firmware 0.6).
pub mod procedure_result {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const SUCCESS: u8 = 0;
    pub const BUSY: u8 = 1;
    pub const CANCELLED: u8 = 2;
    pub const DISARMED: u8 = 3;
    pub const HOMING_WITHOUT_ENDSTOP: u8 = 12;
    pub const INVALID_STATE: u8 = 13;
    pub const NOT_CALIBRATED: u8 = 14;
}

/// Actions of a reboot (firmware 0.6).
pub mod reboot {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const REBOOT: u8 = 0;
    pub const SAVE_CONFIGURATION: u8 = 1;
    pub const ERASE_CONFIGURATION: u8 = 2;
    pub const ENTER_DFU_MODE: u8 = 3;
}

/// Errors (firmware 0.6).
pub mod error {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const MISSING_ESTIMATE: u32 = 0x8;
    pub const BAD_CONFIG: u32 = 0x10;
    pub const DC_BUS_OVER_VOLTAGE: u32 = 0x100;
    pub const DC_BUS_UNDER_VOLTAGE: u32 = 0x200;
    pub const CURRENT_LIMIT_VIOLATION: u32 = 0x1000;
    pub const MOTOR_OVER_TEMP: u32 = 0x2000;
    pub const INVERTER_OVER_TEMP: u32 = 0x4000;
    pub const VELOCITY_LIMIT_VIOLATION: u32 = 0x8000;
    pub const POSITION_LIMIT_VIOLATION: u32 = 0x1_0000;
    pub const WATCHDOG_TIMER_EXPIRED: u32 = 0x100_0000;
    pub const ESTOP_REQUESTED: u32 = 0x200_0000;
    pub const CALIBRATION_ERROR: u32 = 0x4000_0000;
}

/// Errors of an axis (firmware 0.5).
pub mod axis_error {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const INVALID_STATE: u32 = 0x1;
    pub const MOTOR_FAILED: u32 = 0x40;
    pub const ENCODER_FAILED: u32 = 0x100;
    pub const CONTROLLER_FAILED: u32 = 0x200;
    pub const WATCHDOG_TIMER_EXPIRED: u32 = 0x800;
    pub const MIN_ENDSTOP_PRESSED: u32 = 0x1000;
    pub const MAX_ENDSTOP_PRESSED: u32 = 0x2000;
    pub const ESTOP_REQUESTED: u32 = 0x4000;
    pub const HOMING_WITHOUT_ENDSTOP: u32 = 0x2_0000;
}

/// Errors of the motor (firmware 0.5).
pub mod motor_error {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const CURRENT_LIMIT_VIOLATION: u64 = 0x1000;
    pub const MOTOR_THERMISTOR_OVER_TEMP: u64 = 0x2_0000;
    pub const FET_THERMISTOR_OVER_TEMP: u64 = 0x4_0000;
    pub const SYSTEM_LEVEL: u64 = 0x100_0000;
}

/// Errors of an encoder (firmware 0.5).
pub mod encoder_error {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const ABS_SPI_COM_FAIL: u32 = 0x80;
}

/// Errors of the controller (firmware 0.5).
pub mod controller_error {
    #![allow(missing_docs, reason = "names of the maker")]
    pub const OVERSPEED: u32 = 0x1;
    pub const INVALID_INPUT_MODE: u32 = 0x2;
    pub const INVALID_MIRROR_AXIS: u32 = 0x8;
    pub const INVALID_ESTIMATE: u32 = 0x20;
}
