//! Effects of real joints beyond friction, cogging, lag and skew, as plain data in SI, absent by default. Equations:
//! docs/theory/real-joints.md, implemented in the reference (`host/reference/src/drive_train`).

/// Part of the link's inertia on a spring, such as a payload in a soft gripper.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Payload {
    /// Inertia on the spring over the link's inertia; 0 is a rigid link [-].
    pub inertia_share: f64,
    /// Natural frequency of the payload on a held link, undamped [Hz].
    pub frequency: f64,
    /// Damping ratio of the payload on a held link [-].
    pub damping_ratio: f64,
}

/// Sudden change of the link's inertia and weight: a payload is gripped or released.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PayloadStep {
    /// Time of the change [s].
    pub time: f64,
    /// Ratio of inertia and weight after the change to inertia and weight before; 1 for no change [-].
    pub ratio: f64,
}

impl Default for PayloadStep {
    fn default() -> Self {
        Self { time: 0.0, ratio: 1.0 }
    }
}

/// Presliding of dry friction: displacement of a shaft before the full dry friction acts. 0 for none: friction sticks at
/// once.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Presliding {
    /// Displacement of the motor at which its bristles carry the dry friction at speed [rad].
    pub motor: f64,
    /// Displacement of the link at which its bristles carry the dry friction at speed [rad].
    pub load: f64,
}

/// Part of the stiffness between carrier and link that slips, as in bolted flanges, bearings and harmonic drives.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hysteresis {
    /// Stiffness that slips over the stiffness between carrier and link; 0 is a spring without loss [-].
    pub stiffness_share: f64,
    /// Torque at which the slipping part slips [N m].
    pub torque: f64,
}

/// Variation of the backlash around a turn, as in eccentric gears.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WidthVariation {
    /// Amplitude once a turn of the link over the half-backlash [-].
    pub per_link_turn: f64,
    /// Amplitude once a turn of the motor over the half-backlash [-].
    pub per_motor_turn: f64,
}

/// Linear change over time by warming up or wear.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Drift {
    /// Change of the dry frictions of motor and link over their values at time zero [1/s].
    pub friction: f64,
    /// Change of the half-backlash over its value at time zero [1/s].
    pub width: f64,
}

/// Errors of the motor torque that depend on the torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueErrors {
    /// Amplitude of the ripple over the torque [-].
    pub ripple_ratio: f64,
    /// Periods of the ripple in a turn of the motor.
    pub ripple_periods_per_turn: u32,
    /// Step of the torque command over the torque limit; 0 is a command without steps [-].
    pub resolution_ratio: f64,
    /// Relative loss of torque at the torque limit; the relative loss grows with the square of the torque [-].
    pub saturation_ratio: f64,
}

impl Default for TorqueErrors {
    fn default() -> Self {
        Self { ripple_ratio: 0.0, ripple_periods_per_turn: 6, resolution_ratio: 0.0, saturation_ratio: 0.0 }
    }
}

/// Error of an encoder within one period of the scale, caused by interpolation.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SubdivisionalError {
    /// Periods of the first harmonic in a turn; the second harmonic has twice as many.
    pub periods_per_turn: u32,
    /// Amplitude of the first harmonic [rad].
    pub first: f64,
    /// Amplitude of the second harmonic [rad].
    pub second: f64,
}
