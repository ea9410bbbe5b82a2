//! Numbers of a drive that fits a joint, and the settings that follow from them in f32 alone, so that board and host
//! have the same bits.

use drives::Settings;
use drives::drive::{Gains, VirtualPower};
use drives::turns::Ratio;

/// Bandwidth of the speed from the encoders, in a control period [rad]: a compromise of lag and quantisation.
const ENCODER_BANDWIDTH_PERIODS: f32 = 0.2;
/// Largest crossover of the speed loop with the rotor alone, as in the gap, over the bandwidth of its speed [-]: keeps
/// 50 degrees of phase.
const ROTOR_CROSSOVER_RATIO: f32 = 0.25;
/// Speed that is a fault, over the largest speed [-].
const OVERSPEED_RATIO: f32 = 1.5;
/// Lowest and highest voltage over that of the supply [-].
const VOLTAGE_RATIOS: (f32, f32) = (0.5, 1.25);
/// Control rate over the number of periods without a reading after which an encoder is lost [Hz]: 10 ms. Chosen.
const SILENCE_RATIO: u32 = 100;

/// Numbers of a joint from which the settings of its drive follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveDesign {
    /// Turns of the motor in a turn of the output, as a fraction.
    pub ratio: Ratio,
    /// Control periods in a second [Hz].
    pub control_rate: u32,
    /// Counts of the motor encoder in a turn.
    pub motor_counts_per_turn: u32,
    /// Counts of the output encoder in a turn; `None` without one.
    pub output_counts_per_turn: Option<u32>,
    /// Inertia of the joint at its output [kg m^2].
    pub inertia: f32,
    /// Inertia of the rotor over that of the joint, both at the output [-].
    pub rotor_share: f32,
    /// Wanted bandwidth of the position loop [rad/s].
    pub bandwidth: f32,
    /// Torque of the motor at the joint's rated torque [N m].
    pub rated_torque: f32,
    /// Largest torque of the motor [N m].
    pub torque_limit: f32,
    /// Largest speed of the output [rad/s].
    pub max_velocity: f32,
}

impl DriveDesign {
    /// Settings before those of a maker. The largest current [A] gives the largest torque of the joint, which gives the
    /// torque constant; the rated torque heats the winding by its rated rise. `supply` is the voltage without load [V].
    pub fn settings(&self, peak_current: f32, supply: f32, is_calibrated: bool) -> Settings {
        let rate = self.control_rate as f32;
        let encoder_bandwidth = ENCODER_BANDWIDTH_PERIODS * rate;
        let in_the_gap = ROTOR_CROSSOVER_RATIO * encoder_bandwidth * self.rotor_share.min(1.0);
        let torque_constant = self.torque_limit / peak_current;
        Settings {
            ratio: self.ratio,
            period: 1.0 / rate,
            motor_counts_per_turn: self.motor_counts_per_turn,
            output_counts_per_turn: self.output_counts_per_turn,
            encoder_bandwidth,
            max_silent_periods: self.control_rate / SILENCE_RATIO,
            torque_constant,
            resistance: VirtualPower::resistance(self.rated_torque, torque_constant),
            torque_limit: self.torque_limit,
            max_velocity: self.max_velocity,
            overspeed: OVERSPEED_RATIO * self.max_velocity,
            min_voltage: VOLTAGE_RATIOS.0 * supply,
            max_voltage: VOLTAGE_RATIOS.1 * supply,
            gains: Gains::for_inertia(self.inertia, self.bandwidth.min(in_the_gap)),
            integral_limit: self.torque_limit * self.ratio.to_f32(),
            is_calibrated,
            ..Settings::default()
        }
    }
}
