//! Replay of a recording through the observer, and the errors of its estimates.

use model_core::gears::Kinematics;
use std::f64::consts::TAU;

use crate::recording::PeriodSample;
use model_core::numbers::Real;
use model_core::observer::design::{EncoderSettings, ObserverSettings};
use model_core::observer::{Estimates, Observer, ObserverTables, Reading, Samples};
use parameters::{AbsoluteEncoder, ContactState, JointParameters};
use reference::drive_train::{DriveTrainParameters, ErrorPhases};

/// Rate of the samples' clock [Hz].
pub const CLOCK_RATE: u32 = 10_000_000;

/// Settings from the data sheet of a drive train: sizes, but no phases or signs of errors.
pub fn settings(train: &DriveTrainParameters) -> ObserverSettings {
    let around = &train.surroundings;
    let encoder = |encoder: &AbsoluteEncoder| EncoderSettings {
        counts_per_turn: encoder.counts_per_turn as u32,
        wraps_at: encoder.counts_per_turn as u32,
        absolute: true,
        harmonic_error: encoder.once_per_turn_error.max(encoder.twice_per_turn_error),
    };
    ObserverSettings {
        control_rate: around.control_rate,
        clock_rate: CLOCK_RATE,
        motor_encoder: encoder(&around.motor_encoder),
        output_encoder: Some(encoder(&around.output_encoder)),
        fastest_motor: 300.0,
        torque_delay: around.delay,
        torque_lag: around.current_lag,
        torque_limit: around.torque_limit.min(1e3),
        torque_noise_ratio: around.torque_noise_ratio,
        torque_uncertainty: (0.015 * around.torque_limit).hypot(around.motor_friction.coulomb),
        torque_ripple: around.cogging_torque,
        cogging_periods: around.cogging_periods_per_turn,
        efficiency: around.efficiency,
        backlash_uncertainty: 0.5,
        compliance_uncertainty: 0.3,
        skew: 50e-6,
        skew_uncertainty: 30e-6,
    }
}

/// Samples of a recorded period.
pub fn samples<T: Real>(settings: &ObserverSettings, moment: &PeriodSample, period: usize) -> Samples<T> {
    let time = (period as u64 * u64::from(settings.clock_rate / settings.control_rate)) as u32;
    let counts = |counts: i64, encoder: EncoderSettings| {
        let range = if encoder.wraps_at == 0 { 1 << 32 } else { i64::from(encoder.wraps_at) };
        counts.rem_euclid(range) as u32
    };
    Samples {
        time,
        motor: Reading { counts: counts(moment.motor_counts, settings.motor_encoder), time },
        output: settings.output_encoder.map(|encoder| Reading { counts: counts(moment.output_counts, encoder), time }),
        torque: T::from_f64(moment.command),
    }
}

/// Errors of one replay from a time on.
#[derive(Debug, Clone, Default)]
pub struct ObserverErrors {
    /// RMS error of the gap, over the gap 4b.
    pub gap: f64,
    /// Largest error of the gap, over the gap 4b.
    pub gap_worst: f64,
    /// Share of the periods outside the bands in which the reported contact is right.
    pub contact: f64,
    /// Landings that the observer did not report.
    pub missed: usize,
    /// Number of landings.
    pub landings: usize,
    /// Sorted delays of reported landings [s].
    pub delays: Vec<f64>,
    /// RMS error of the load torque, over the motor's torque limit at the output.
    pub load_torque: f64,
    /// RMS error of the transmitted torque, over the motor's torque limit at the output.
    pub mesh_torque: f64,
    /// Time from the first force on both flanks until the width is right to 5 % for good [s].
    pub width_after: f64,
    /// Relative error of the width at the end.
    pub width: f64,
    /// Mean of squared gap errors over their variances, while the gap is valid.
    pub nees: f64,
    /// Share of the periods with a valid gap.
    pub valid: f64,
    /// RMS error of the gap while it is valid, over the gap 4b.
    pub gap_valid: f64,
}

impl ObserverErrors {
    /// Delay that a part of the landings stays below [s].
    pub fn delay(&self, part: f64) -> f64 {
        self.delays.get((part * self.delays.len() as f64) as usize).copied().unwrap_or(0.0)
    }

    /// Worse value of each figure.
    pub fn worse(&self, other: &Self) -> Self {
        Self {
            gap: self.gap.max(other.gap),
            gap_worst: self.gap_worst.max(other.gap_worst),
            contact: if self.landings == 0 { other.contact } else { self.contact.min(other.contact) },
            missed: self.missed + other.missed,
            landings: self.landings + other.landings,
            delays: {
                let mut delays = [self.delays.as_slice(), &other.delays].concat();
                delays.sort_by(f64::total_cmp);
                delays
            },
            load_torque: self.load_torque.max(other.load_torque),
            mesh_torque: self.mesh_torque.max(other.mesh_torque),
            width_after: self.width_after.max(other.width_after),
            width: self.width.abs().max(other.width.abs()),
            nees: self.nees.max(other.nees),
            valid: if self.landings == 0 { other.valid } else { self.valid.min(other.valid) },
            gap_valid: self.gap_valid.max(other.gap_valid),
        }
    }
}

/// Replays a recording and returns its errors from `from` seconds on. `watch` sees every estimate.
pub fn replay<const P: usize>(
    joint: &JointParameters,
    tables: &ObserverTables<f64>,
    settings: &ObserverSettings,
    log: &[PeriodSample],
    from: f64,
    mut watch: impl FnMut(usize, &PeriodSample, &Estimates<f64>),
) -> ObserverErrors {
    let mut observer = Observer::<f64, P>::new(tables);
    let largest_of = |errors: &[f64]| errors.iter().fold(0.0, |greatest: f64, error| greatest.max(error.abs()));
    let [of_sun, of_ring] = [&joint.sun_planet, &joint.ring_planet].map(|mesh| largest_of(&mesh.transmission_error));
    let flank_shift = of_sun + of_ring;
    let half_backlash = joint.sun_planet.half_backlash[0];
    let gap = 4.0 * half_backlash;
    let rated_force = joint.rated_output_torque / (2.0 * joint.geometry.carrier_base_radius());
    let largest = settings.torque_limit * joint.geometry.ratio_by_teeth();
    let lever = 2.0 * joint.geometry.carrier_base_radius();
    let period = 1.0 / f64::from(settings.control_rate);
    let first = (from / period) as usize;
    let mut sums = [0.0; 5];
    let mut valid = 0;
    let mut worst: f64 = 0.0;
    let (mut right, mut judged) = (0_usize, 0_usize);
    let mut width_wrong_at = 0;
    let (mut touched, mut both_touched_at) = ([false; 2], 0);
    let mut width = 0.0;
    let mut landing: Option<(usize, ContactState)> = None;
    let mut side_before = ContactState::Separated;
    let mut delays = Vec::new();
    let mut missed = 0;
    for (k, moment) in log.iter().enumerate() {
        let estimates = *observer.step(&samples(settings, moment, k));
        watch(k, moment, &estimates);
        width = estimates.half_backlash.value / half_backlash - 1.0;
        if moment.sun_force.abs() > 0.05 * rated_force {
            touched[usize::from(moment.sun_force > 0.0)] = true;
        }
        if touched != [true; 2] {
            both_touched_at = k;
        }
        if width.abs() > 0.05 {
            width_wrong_at = k;
        }
        if k < first {
            continue;
        }
        let error = (estimates.gap.value - moment.gap) / gap;
        sums[0] += error * error;
        worst = worst.max(error.abs());
        sums[1] += ((estimates.load_torque.value - moment.load_torque) / largest).powi(2);
        sums[2] += ((estimates.mesh_torque.value - moment.sun_force * lever) / largest).powi(2);
        if estimates.gap.valid {
            valid += 1;
            sums[3] += (error * gap).powi(2) / estimates.gap.variance.max(1e-30);
            sums[4] += error * error;
        }
        let side = if moment.sun_force > 0.0 {
            ContactState::DriveSide
        } else if moment.sun_force < 0.0 {
            ContactState::BackSide
        } else {
            ContactState::Separated
        };
        // No side is counted within 5 % of the gap from an edge, or below 5 % of the rated force.
        let clear = if side == ContactState::Separated {
            moment.gap.abs() < 0.45 * gap
        } else {
            moment.sun_force.abs() > 0.05 * rated_force
        };
        if clear {
            judged += 1;
            right += usize::from(side == estimates.reported_contact);
        }
        // A landing is the first force above the band on the flank opposite to the last one. Bumps of a single planet before the others
        // have closed their gaps do not count.
        let at_flank = moment.gap * moment.sun_force > 0.0 && moment.gap.abs() > 0.5 * gap - flank_shift;
        if at_flank && moment.sun_force.abs() > 0.05 * rated_force && side != side_before {
            if side_before != ContactState::Separated {
                missed += usize::from(landing.is_some());
                landing = Some((k, side));
            }
            side_before = side;
        }
        if let Some((since, _)) = landing.filter(|(_, side)| estimates.reported_contact == *side) {
            delays.push((k - since) as f64 * period);
            landing = None;
        }
    }
    delays.sort_by(f64::total_cmp);
    let counted = (log.len() - first) as f64;
    let mean = |sum: f64| (sum / counted).sqrt();
    ObserverErrors {
        gap: mean(sums[0]),
        gap_worst: worst,
        contact: right as f64 / judged.max(1) as f64,
        missed,
        landings: delays.len() + missed,
        delays,
        load_torque: mean(sums[1]),
        mesh_torque: mean(sums[2]),
        width_after: (width_wrong_at + 1).saturating_sub(both_touched_at) as f64 * period,
        width,
        nees: sums[3] / f64::from(valid.max(1)),
        valid: f64::from(valid) / counted,
        gap_valid: (sums[4] / f64::from(valid.max(1))).sqrt(),
    }
}

/// Readings of other encoders on a recorded motion: the true angles at the control periods, delayed by the skew at the present speed.
pub fn with_encoders(log: &[PeriodSample], train: &DriveTrainParameters) -> Vec<PeriodSample> {
    let read = |[angle, speed]: [f64; 2], encoder: &AbsoluteEncoder, phases: ErrorPhases| {
        let angle = angle - encoder.skew * speed;
        let error = encoder.once_per_turn_error * (angle + phases.once_per_turn).sin()
            + encoder.twice_per_turn_error * (2.0 * angle + phases.twice_per_turn).sin();
        ((angle + error) / TAU * encoder.counts_per_turn as f64).floor() as i64
    };
    log.iter()
        .map(|moment| PeriodSample {
            motor_counts: read(moment.motor, &train.surroundings.motor_encoder, train.motor_error_phases),
            output_counts: read(moment.link, &train.surroundings.output_encoder, train.output_error_phases),
            ..*moment
        })
        .collect()
}
