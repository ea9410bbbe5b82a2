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
    /// `frozen_angle`: angle at which the encoder froze. `last_angle`: angle in the last period, for missing counts [2^-32 turns].
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
