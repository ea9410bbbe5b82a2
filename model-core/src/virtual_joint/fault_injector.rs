//! Application of faults between a virtual joint and its controller, on a board and in its twin on the host, in integer
//! arithmetic. `fault` describes the faults; faults of teeth and late readings are not supported.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::numbers::random::splitmix64;
use crate::observer::{Reading, Samples};
use crate::virtual_joint::fault::{EncoderShaft, Fault, FaultKind, FixedPoint};
use crate::virtual_joint::tables::SurroundingsTable;

/// Largest number of faults in a run on a board: eight of the user's, and the zeros of both encoders.
pub const MAX_FAULTS: usize = 10;

/// Fault with its state.
#[derive(Debug, Clone, Copy)]
struct ActiveFault<T: Real> {
    fault: Fault<FixedPoint<T>>,
    random: u64,
    /// `frozen_angle`: angle at which the encoder froze. `last_angle`: angle in the last period, for missing counts
    /// [2^-32 turns].
    frozen_angle: Option<u32>,
    last_angle: Option<u32>,
    /// Uncounted motion, in 2^-32 of 2^-32 turns.
    uncounted: i64,
}

/// Faults of a run on a board, or of its twin on the host; initially empty.
///
/// Encoder of the link that freezes in the hundredth period, and a motor limited to 0.2 N m all the time:
///
/// ```
/// use model_core::gears::{Tables, design::design};
/// use model_core::virtual_joint::fault::{Fault, FaultKind, EncoderShaft};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings, fault_injector::FaultInjector};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let (mut joint, mut faults) = (VirtualJoint::new(&gears, &around), FaultInjector::default());
/// assert!(faults.add(Fault { start: 100, end: u32::MAX, seed: 1, kind: FaultKind::Frozen(EncoderShaft::Link) }));
/// assert!(faults.add(Fault { start: 0, end: u32::MAX, seed: 2, kind: FaultKind::Saturation(0.2) }));
/// let mut seen = faults.apply_to_samples(joint.samples(), &around);
/// for _ in 0..2000 {
///     joint.advance(faults.apply_to_torque(1.0), 0.0);
///     seen = faults.apply_to_samples(joint.samples(), &around);
/// }
/// assert!(joint.acting().air_gap < 0.21);
/// assert_eq!(seen.motor, joint.samples().motor);
/// assert!(seen.output.unwrap().counts + 100 < joint.samples().output.unwrap().counts);
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct FaultInjector<T: Real> {
    all: [Option<ActiveFault<T>>; MAX_FAULTS],
    period: u32,
    /// Last commanded torque: a motor with another torque does not report it.
    last_command: T,
    /// Last reading of the motor encoder.
    motor: Option<Reading>,
}

impl<T: Real> Default for FaultInjector<T> {
    fn default() -> Self {
        Self { all: [None; MAX_FAULTS], period: 0, last_command: T::ZERO, motor: None }
    }
}

impl<T: Real> FaultInjector<T> {
    /// Adds a fault. Returns `false` if there is no room.
    pub fn add(&mut self, fault: Fault<FixedPoint<T>>) -> bool {
        let Some(place) = self.all.iter_mut().find(|place| place.is_none()) else { return false };
        *place = Some(ActiveFault { fault, random: fault.seed, frozen_angle: None, last_angle: None, uncounted: 0 });
        true
    }

    /// Applies the faults to the samples, which the controller receives; begins the period.
    pub fn apply_to_samples(&mut self, samples: Samples<T>, table: &SurroundingsTable<T>) -> Samples<T> {
        let Self { all, period, last_command, motor } = self;
        if all.iter().all(Option::is_none) {
            return samples;
        }
        let [motor_encoder, output_encoder] = &table.encoders;
        let output = samples.output;
        let mut seen =
            [(samples.motor, motor_encoder, true), (output.unwrap_or_default(), output_encoder, output.is_some())];
        for active in all.iter_mut().flatten() {
            let on = *period >= active.fault.start && *period < active.fault.end;
            for (shaft, (reading, encoder, received)) in
                [EncoderShaft::Motor, EncoderShaft::Link].into_iter().zip(&mut seen)
            {
                // Whole turns are 2^32, so that angles wrap without further code.
                let angle = encoder.angle(reading.counts);
                reading.counts = encoder.counts(active.read(shaft, angle, on));
                *received &= !active.drops_reading(shaft, on);
            }
        }
        let [(fresh, _, motor_received), (output, _, output_received)] = seen;
        if motor_received || motor.is_none() {
            *motor = Some(fresh);
        }
        let motor = motor.unwrap_or(fresh);
        let limit = table.current.limit;
        Samples {
            motor,
            output: output_received.then_some(output),
            torque: clamp(*last_command, -limit, limit),
            ..samples
        }
    }

    /// Torque of the motor for a command; ends the period.
    pub fn apply_to_torque(&mut self, command: T) -> T {
        let period = self.period;
        self.period = period.saturating_add(1);
        self.last_command = if command.is_finite() { command } else { T::ZERO };
        let acting =
            self.all.iter().flatten().filter(|active| period >= active.fault.start && period < active.fault.end);
        acting.fold(command, |torque, active| match active.fault.kind {
            FaultKind::TorqueBias(ratio, offset) => torque + torque * ratio + offset,
            FaultKind::Saturation(limit) => clamp(torque, -limit, limit),
            _ => torque,
        })
    }
}

impl<T: Real> ActiveFault<T> {
    /// Angle that an encoder reads with this fault [2^-32 turns].
    fn read(&mut self, shaft: EncoderShaft, angle: u32, on: bool) -> u32 {
        match self.fault.kind {
            FaultKind::Frozen(of) if of == shaft => {
                self.frozen_angle = if on { self.frozen_angle.or(Some(angle)) } else { None };
                self.frozen_angle.unwrap_or(angle)
            }
            FaultKind::Offset(of, offset) if of == shaft && on => angle.wrapping_add(offset as u32),
            FaultKind::Noise(of, deviation) if of == shaft && on => {
                // The sum of twelve uniform numbers from -1/2 to 1/2 has a variance of one: the quarters of three
                // words, in 2^-16.
                let quarters = |word: u64| (0..4).map(move |place| i64::from((word >> (16 * place)) as i16));
                let sum: i64 = (0..3).flat_map(|_| quarters(splitmix64(&mut self.random))).sum();
                angle.wrapping_add((sum.wrapping_mul(deviation.into()) >> 16) as u32)
            }
            FaultKind::Eccentric(of, amplitude) if of == shaft && on => {
                angle.wrapping_add((amplitude * sine_cosine::<T>(angle).0).to_i64() as u32)
            }
            FaultKind::MissingCounts(of, share) if of == shaft => {
                let moved = angle.wrapping_sub(self.last_angle.unwrap_or(angle)) as i32;
                self.last_angle = Some(angle);
                if on {
                    self.uncounted = self.uncounted.wrapping_add(i64::from(moved).wrapping_mul(share.into()));
                }
                angle.wrapping_sub((self.uncounted >> 32) as u32)
            }
            _ => angle,
        }
    }

    /// Returns true if a reading is lost.
    fn drops_reading(&mut self, shaft: EncoderShaft, on: bool) -> bool {
        match self.fault.kind {
            FaultKind::LostReadings(of, share) if of == shaft && on => self.uniform_u32() < share,
            _ => false,
        }
    }

    /// Upper half of a random word.
    fn uniform_u32(&mut self) -> u32 {
        (splitmix64(&mut self.random) >> 32) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::virtual_joint::tables::{CurrentLoopTable, EncoderErrorTable, FrictionTable, encoder_phase};

    /// Counts of an encoder's turn.
    const TURN: u32 = 4096;

    fn table() -> SurroundingsTable<f32> {
        let encoder = EncoderErrorTable { turn: TURN, errors: [0.0; 2], lag: 0.0, phase: encoder_phase(TURN.into()) };
        let friction = FrictionTable { coulomb: 0.0, viscous: 0.0, rise: 0.0, per_speed: 0.0, stop: 0.0 };
        SurroundingsTable {
            period: 1e-3,
            clock_ticks: 1,
            turn: core::f32::consts::TAU,
            ratio: [6, 1],
            gear: 6.0,
            units_per_radian: 1.0,
            motor_rate: [0.0; 3],
            link_rate: [0.0; 3],
            current: CurrentLoopTable { delay: 0, rise: 1.0, lacking: 0.0, gain: 1.0, limit: 2.0 },
            cogging_torque: 0.0,
            cogging_periods: 0,
            motor_friction: friction.clone(),
            load_friction: friction,
            losses: [0.0; 2],
            half_backlash: [0.0; 5],
            sun_torque: 0.0,
            to_link: [0.0; 3],
            weight: 0.0,
            encoders: [encoder.clone(), encoder],
        }
    }

    fn samples(motor: u32, link: u32) -> Samples<f32> {
        let reading = |counts| Reading { counts, ..Reading::default() };
        Samples { motor: reading(motor), output: Some(reading(link)), ..Samples::default() }
    }

    /// Returns the link's counts in the periods of a fault from period 1 to 3, while the link turns by 10 counts.
    fn link_counts(kind: FaultKind<FixedPoint<f32>>) -> [Option<u32>; 5] {
        let mut faults = FaultInjector::default();
        assert!(faults.add(Fault { start: 1, end: 3, seed: 1, kind }));
        core::array::from_fn(|period| {
            let seen = faults.apply_to_samples(samples(7, 100 + 10 * period as u32), &table());
            faults.apply_to_torque(0.0);
            assert_eq!(seen.motor.counts, 7, "the other encoder");
            seen.output.map(|reading| reading.counts)
        })
    }

    #[test]
    fn frozen_encoder_repeats_the_counts_of_its_start() {
        let counts = link_counts(FaultKind::Frozen(EncoderShaft::Link));
        assert_eq!(counts, [100, 110, 110, 130, 140].map(Some));
    }

    #[test]
    fn offset_adds_to_the_counts_while_it_lasts() {
        let count = i32::try_from((1_u64 << 32) / u64::from(TURN)).expect("a count");
        let counts = link_counts(FaultKind::Offset(EncoderShaft::Link, -5 * count));
        assert_eq!(counts, [100, 105, 115, 130, 140].map(Some));
    }

    #[test]
    fn missing_counts_stay_missing() {
        let counts = link_counts(FaultKind::MissingCounts(EncoderShaft::Link, 1 << 31));
        assert_eq!(counts, [100, 105, 110, 120, 130].map(Some));
    }

    #[test]
    fn lost_readings_of_the_link_are_absent() {
        let counts = link_counts(FaultKind::LostReadings(EncoderShaft::Link, u32::MAX));
        assert_eq!(counts, [Some(100), None, None, Some(130), Some(140)]);
    }

    #[test]
    fn lost_readings_of_the_motor_repeat_the_last() {
        let mut faults = FaultInjector::default();
        let kind = FaultKind::LostReadings(EncoderShaft::Motor, u32::MAX);
        assert!(faults.add(Fault { start: 1, end: 2, seed: 1, kind }));
        let counts = [7, 8, 9].map(|motor| {
            let seen = faults.apply_to_samples(samples(motor, 0), &table());
            faults.apply_to_torque(0.0);
            seen.motor.counts
        });
        assert_eq!(counts, [7, 7, 9]);
    }

    #[test]
    fn torque_faults_act_on_the_torque_but_not_on_its_report() {
        let mut faults = FaultInjector::default();
        let fault = |kind| Fault { start: 0, end: 2, seed: 1, kind };
        assert!(faults.add(fault(FaultKind::TorqueBias(0.5, 0.25))) && faults.add(fault(FaultKind::Saturation(1.0))));
        assert_eq!([0.25, 4.0, 4.0].map(|command| faults.apply_to_torque(command)), [0.625, 1.0, 4.0]);
        assert_eq!(faults.apply_to_samples(samples(0, 0), &table()).torque, 2.0, "the command within the limit");
    }

    #[test]
    fn command_that_is_no_number_is_reported_as_zero() {
        let mut faults = FaultInjector::default();
        assert!(faults.add(Fault { start: 0, end: 9, seed: 1, kind: FaultKind::Saturation(1.0) }));
        faults.apply_to_torque(f32::NAN);
        assert_eq!(faults.apply_to_samples(samples(0, 0), &table()).torque, 0.0);
    }

    #[test]
    fn fault_beyond_the_last_place_is_refused() {
        let mut faults = FaultInjector::<f32>::default();
        let fault = Fault { start: 0, end: 1, seed: 1, kind: FaultKind::Saturation(1.0) };
        assert!((0..MAX_FAULTS).all(|_| faults.add(fault)) && !faults.add(fault));
    }
}
