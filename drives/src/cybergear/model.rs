//! Models: ranges of fields and parameters, and the indices that differ between the makers' tables.

use core::f32::consts::PI;

use super::wire::Field;

/// Model of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// Xiaomi CyberGear.
    CyberGear,
    /// RobStride 00.
    RobStride00,
    /// RobStride 01.
    RobStride01,
    /// RobStride 02.
    RobStride02,
    /// RobStride 03.
    RobStride03,
    /// RobStride 04.
    RobStride04,
    /// RobStride 05.
    RobStride05,
    /// RobStride 06.
    RobStride06,
}

/// Data sheet of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// Angle of the output [rad].
    pub angle: Field,
    /// Speed of the output [rad/s].
    pub speed: Field,
    /// Torque at the output [N m].
    pub torque: Field,
    /// Stiffness kp [N m/rad].
    pub kp: Field,
    /// Damping kd [N m s/rad].
    pub kd: Field,
    /// Largest current of the winding [A].
    pub current: f32,
    /// Temperature of the winding that is a fault [deg C].
    pub max_temperature: f32,
    /// Temperature of the winding that is a warning [deg C].
    pub warning_temperature: f32,
    /// Index of the first of CAN_ID, CAN_MASTER, CAN_TIMEOUT.
    pub(super) can_index: u16,
    /// Index of the torque at the output.
    pub(super) torque_index: u16,
    /// Index of the second encoder's counts.
    pub(super) second_counts_index: Option<u16>,
    /// Index of the second encoder's angle.
    pub(super) second_angle_index: Option<u16>,
    /// True for a table of observations with another row before 0x3011.
    pub(super) is_shifted: bool,
}

impl Sheet {
    const ROBSTRIDE: Self = Self {
        angle: Field::around_zero(4.0 * PI),
        speed: Field::around_zero(33.0),
        torque: Field::around_zero(14.0),
        kp: Field::up_to(500.0),
        kd: Field::up_to(5.0),
        current: 16.0,
        max_temperature: 145.0,
        warning_temperature: 135.0,
        can_index: 0x200A,
        torque_index: 0x302C,
        second_counts_index: None,
        second_angle_index: None,
        is_shifted: false,
    };

    const fn strong(speed: f32, torque: f32, current: f32) -> Self {
        Self {
            speed: Field::around_zero(speed),
            torque: Field::around_zero(torque),
            kp: Field::up_to(5000.0),
            kd: Field::up_to(100.0),
            current,
            can_index: 0x2009,
            ..Self::ROBSTRIDE
        }
    }

    const fn small(speed: f32, torque: f32, current: f32) -> Self {
        Self { speed: Field::around_zero(speed), torque: Field::around_zero(torque), current, ..Self::ROBSTRIDE }
    }
}

impl Model {
    /// All models.
    pub const ALL: [Self; 8] = [
        Self::CyberGear,
        Self::RobStride00,
        Self::RobStride01,
        Self::RobStride02,
        Self::RobStride03,
        Self::RobStride04,
        Self::RobStride05,
        Self::RobStride06,
    ];

    /// True for the RobStride models.
    pub fn is_robstride(self) -> bool {
        self != Self::CyberGear
    }

    /// Data sheet.
    pub const fn sheet(self) -> Sheet {
        match self {
            Self::CyberGear => Sheet {
                // The manual's text has 4 pi, its program and the clients have 12.5.
                angle: Field::around_zero(12.5),
                max_temperature: 80.0,
                warning_temperature: 75.0,
                torque_index: 0x302D,
                ..Sheet::small(30.0, 12.0, 23.0)
            },
            Self::RobStride00 => Sheet { second_angle_index: Some(0x3039), ..Sheet::small(33.0, 14.0, 16.0) },
            Self::RobStride01 => Sheet { torque_index: 0x302D, ..Sheet::small(44.0, 17.0, 23.0) },
            Self::RobStride02 => {
                Sheet { second_angle_index: Some(0x3033), max_temperature: 135.0, ..Sheet::small(44.0, 17.0, 16.0) }
            }
            Self::RobStride03 => Sheet { second_angle_index: Some(0x3044), ..Sheet::strong(20.0, 60.0, 43.0) },
            Self::RobStride04 => Sheet {
                second_counts_index: Some(0x3007),
                second_angle_index: Some(0x3034),
                is_shifted: true,
                ..Sheet::strong(15.0, 120.0, 90.0)
            },
            Self::RobStride05 => {
                Sheet { second_angle_index: Some(0x3049), max_temperature: 135.0, ..Sheet::small(50.0, 5.5, 11.0) }
            }
            Self::RobStride06 => Sheet {
                torque_index: 0x302D,
                second_counts_index: Some(0x3007),
                second_angle_index: Some(0x3044),
                ..Sheet::strong(50.0, 36.0, 57.0)
            },
        }
    }
}
