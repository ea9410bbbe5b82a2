//! What the compensation needs as plain numbers, made by `design::compensation`. Angles, torques and inertias are felt
//! at the link; how the numbers come about is left to the design.

use crate::real::Real;

/// Tables of the compensation of one joint at one control rate and bandwidth.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensationTables<T: Real> {
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Control period [s].
    pub period: T,
    /// Motor turns over link turns as a whole-number fraction.
    pub ratio: [i32; 2],
    /// The same as a number.
    pub gear: T,
    /// Its inverse.
    pub inverse_gear: T,
    /// Inverse of the ratio's denominator.
    pub inverse_denominator: T,
    /// A whole turn [rad].
    pub turn: T,
    /// 1 / (r_c cos alpha): from half-backlash to half the lost motion [1/m].
    pub inverse_lever: T,
    /// What turns with the motor while the gap is open, felt at the link [kg m^2].
    pub motor_inertia: T,
    /// The rest [kg m^2].
    pub load_inertia: T,
    /// Its inverse.
    pub inverse_load_inertia: T,
    /// Spring of the loop [N m/rad].
    pub position_gain: T,
    /// Damper of the loop [N m s/rad].
    pub damping_gain: T,
    /// Integral of the loop over one period [N m/rad].
    pub integral_gain: T,
    /// Spring of the loop while the motor is alone [N m/rad].
    pub free_position_gain: T,
    /// Its damper [N m s/rad].
    pub free_damping_gain: T,
    /// Share of what was cut off by the limit that the integral gives back each period.
    pub back_calculation: T,
    /// Largest torque [N m].
    pub torque_limit: T,
    /// Half-backlash to start from [m].
    pub half_backlash: T,
    /// How far ahead set-points are wanted [s].
    pub lead: T,
    /// Duration of a crossing [s].
    pub crossing: T,
    /// Planned torque beyond which a change of sign counts [N m].
    pub hysteresis: T,
    /// Feedback torque below which no flank is changed for it [N m].
    pub doubt: T,
    /// Rise of the contact law after a landing, in one period.
    pub landing_rise: T,
    /// Speed of the search for a flank that was not where it was thought [rad/s].
    pub seek_speed: T,
    /// Learner of the load: growth of variances in one period (even part, friction), variance of a reading.
    pub load_learner: [T; 3],
    /// Inverse of the speed at which friction has its full size [s/rad].
    pub friction_slope: T,
    /// Share of the half-gap that has to open before the loss of contact is believed.
    pub opening: T,
    /// Periods after which a doubled patience is halved again.
    pub calm: u32,
}
