//! Settings of the observer, in addition to the joint: data-sheet figures with their uncertainties, and checks of their
//! ranges.

use super::thresholds::LEARNING_DESIGN;
use core::f64::consts::TAU;

use crate::gears::design::DesignError;
use crate::observer::tables::MOST_DELAY;
use parameters::{AbsoluteEncoder, Surroundings};

/// Ticks of the samples' clock per control period.
pub const CLOCK_TICKS: u32 = 1000;

/// Torque limit above which a motor counts as unlimited [N m].
pub(crate) const NO_LIMIT: f64 = 1e3;

/// Fewest counts per turn of a motor encoder: three Hall sensors on four pole pairs have 24. With 12 counts the gap is
/// never valid, on a gear whose lost motion spans 2 or 4 counts (measured: C1 with 60 and 120 arcmin, motion T2).
const FEWEST_COUNTS: u32 = 24;

/// Fewest counts per turn that are accepted for any backlash.
const COUNTS_OF_ANY_GAP: u32 = 64;

/// Data-sheet figures of an encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderSettings {
    /// Counts per turn of its shaft; any number.
    pub counts_per_turn: u32,
    /// Modulus of the raw counts, which run from 0 to `wraps_at` - 1; 0 stands for 2^32. Equals the counts per turn for
    /// a single-turn absolute encoder.
    pub wraps_at: u32,
    /// True if the encoder knows its position in the turn at power-up. Otherwise offset and error maps are estimated
    /// anew after every start.
    pub absolute: bool,
    /// Expected standard deviation of the once- and of the twice-per-turn error; zero without such errors [rad].
    pub harmonic_error: f64,
}

/// Settings of the observer, in addition to the joint. The joint's half-backlash and compliance are initial guesses.
#[derive(Debug, Clone, PartialEq)]
pub struct ObserverSettings {
    /// Control rate [Hz].
    pub control_rate: u32,
    /// Rate of the clock of all time stamps [Hz].
    pub clock_rate: u32,
    /// Encoder on the motor.
    pub motor_encoder: EncoderSettings,
    /// Encoder on the link; `None` on joints without an output encoder.
    pub output_encoder: Option<EncoderSettings>,
    /// Largest speed of the motor [rad/s].
    pub fastest_motor: f64,
    /// Delay from a torque command to its first effect [control periods].
    pub torque_delay: f64,
    /// Time constant of the current loop after the delay [s].
    pub torque_lag: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// Standard deviation of the torque noise, over the torque [-].
    pub torque_noise_ratio: f64,
    /// Prior standard deviation of the motor's bias, and of its dry friction [N m].
    pub torque_uncertainty: f64,
    /// Standard deviation of cogging and torque ripple of the motor [N m].
    pub torque_ripple: f64,
    /// Cogging periods per motor turn.
    pub cogging_periods: u32,
    /// Efficiency of the gears while the motor drives; losses are proportional to the torque [-].
    pub efficiency: f64,
    /// Prior standard deviation of the half-backlash, over its guess [-].
    pub backlash_uncertainty: f64,
    /// Prior standard deviation of the compliance, over its guess [-].
    pub compliance_uncertainty: f64,
    /// Expected delay of output readings not covered by their time stamps, minus that of the motor readings [s].
    pub skew: f64,
    /// Prior standard deviation of the skew [s].
    pub skew_uncertainty: f64,
}

impl ObserverSettings {
    /// Rejects settings out of range; `gap` is the lost motion at the motor [rad].
    pub(super) fn check(&self, gap: f64) -> Result<(), DesignError> {
        let within = |what, given: f64, min: f64, max: f64, must_be| {
            if given >= min && given <= max { Ok(()) } else { Err(DesignError::OutOfRange { what, given, must_be }) }
        };
        // A learning interval contains at least one period.
        within(
            "the control rate",
            self.control_rate.into(),
            1.0 / LEARNING_DESIGN.interval,
            1e5,
            "from 1000 to 100000 Hz",
        )?;
        within("the clock rate of the observer's samples", self.clock_rate.into(), 1e4, 4e9, "10 kHz or more")?;
        self.check_counts(gap)?;
        for encoder in [Some(self.motor_encoder), self.output_encoder].into_iter().flatten() {
            within("the harmonic error of an encoder", encoder.harmonic_error, 0.0, 0.1, "from 0 to 0.1 rad")?;
            let wraps_at = if encoder.wraps_at == 0 { 4_294_967_296.0 } else { f64::from(encoder.wraps_at) };
            let must_be = "a whole number of turns, or 0 for 2^32";
            let whole = encoder.wraps_at == 0 || encoder.wraps_at % encoder.counts_per_turn == 0;
            within("where an encoder's counts wrap", if whole { wraps_at } else { -1.0 }, 1.0, 4.3e9, must_be)?;
        }
        within("the motor's fastest speed", self.fastest_motor, 0.1, 1e5, "positive, in rad/s")?;
        within("the torque delay", self.torque_delay, 0.0, MOST_DELAY as f64 - 1.0, "from 0 to 3 control periods")?;
        within("the current loop's lag", self.torque_lag, 0.0, 0.1, "from 0 to 0.1 s")?;
        within("the motor's torque limit", self.torque_limit, 1e-6, 1e6, "positive and finite")?;
        within("the torque noise", self.torque_noise_ratio, 0.0, 1.0, "from 0 to 1")?;
        within("the torque uncertainty", self.torque_uncertainty, 1e-9, 1e6, "positive and finite")?;
        within("the torque ripple", self.torque_ripple, 0.0, 1e6, "zero or more, and finite")?;
        within("the cogging's periods in a turn", self.cogging_periods.into(), 1.0, 1e5, "from 1 to 100000")?;
        within("the efficiency", self.efficiency, 0.1, 1.0, "from 0.1 to 1")?;
        within("the uncertainty of the backlash", self.backlash_uncertainty, 1e-6, 10.0, "from 1e-6 to 10")?;
        within("the uncertainty of the compliance", self.compliance_uncertainty, 1e-6, 10.0, "from 1e-6 to 10")?;
        within("the skew", self.skew, -0.1, 0.1, "from -0.1 to 0.1 s")?;
        within("the uncertainty of the skew", self.skew_uncertainty, 0.0, 0.1, "from 0 to 0.1 s")
    }

    /// Rejects encoders with too few or too many counts. A motor encoder with few counts detects the flanks as long as
    /// a count is less than the lost motion at the motor: Hall sensors with 24 counts need 15 deg of lost motion.
    fn check_counts(&self, gap: f64) -> Result<(), DesignError> {
        let within = |what, counts: u32, min, must_be| {
            let is_in_range = (min..=1 << 24).contains(&counts);
            if is_in_range { Ok(()) } else { Err(DesignError::OutOfRange { what, given: counts.into(), must_be }) }
        };
        let motor = self.motor_encoder.counts_per_turn;
        let min = if TAU < gap * f64::from(motor) { FEWEST_COUNTS } else { COUNTS_OF_ANY_GAP };
        let must_be = "from 64 to 2^24, or from 24 on where a count is less than the lost motion at the motor: \
                       take an encoder of more counts, or state a larger backlash if the gear has it";
        within("the number of counts in a turn of the motor encoder", motor, min, must_be)?;
        self.output_encoder.map_or(Ok(()), |encoder| {
            let what = "the number of counts in a turn of the output encoder";
            within(what, encoder.counts_per_turn, COUNTS_OF_ANY_GAP, "from 64 to 2^24")
        })
    }
}

/// Derives the observer's settings from the joint's surroundings.
pub fn observer_settings(of: &Surroundings) -> ObserverSettings {
    // The check of the settings rejects counts that do not fit.
    let counts = |encoder: &AbsoluteEncoder| u32::try_from(encoder.counts_per_turn).unwrap_or(u32::MAX);
    let encoder = |encoder: &AbsoluteEncoder| EncoderSettings {
        counts_per_turn: counts(encoder),
        wraps_at: counts(encoder),
        absolute: true,
        harmonic_error: encoder.once_per_turn_error.max(encoder.twice_per_turn_error),
    };
    let limit = of.torque_limit.min(NO_LIMIT);
    ObserverSettings {
        control_rate: of.control_rate,
        clock_rate: CLOCK_TICKS * of.control_rate,
        motor_encoder: encoder(&of.motor_encoder),
        output_encoder: Some(encoder(&of.output_encoder)),
        fastest_motor: of.speed_limit,
        // The observer receives the torque of the previous period.
        torque_delay: (of.delay - 1.0).max(0.0),
        torque_lag: of.current_lag,
        torque_limit: limit,
        torque_noise_ratio: of.torque_noise_ratio,
        torque_uncertainty: 0.02 * limit,
        torque_ripple: of.cogging_torque,
        cogging_periods: of.cogging_periods_per_turn,
        efficiency: of.efficiency,
        backlash_uncertainty: 0.5,
        compliance_uncertainty: 0.3,
        skew: 0.0,
        skew_uncertainty: 60e-6,
    }
}
