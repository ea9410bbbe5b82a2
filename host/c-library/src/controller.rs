//! Motor controller of `examples/c-motor-controller` on the core itself, operation by operation: equal digests show
//! that the C program computes the same bits, and the true state of the run gives the figures of test T2.

use model_core::compensation::{CommandRef, Compensation, ImpedancePoint, Motion, Position};
use model_core::gears::Tables;
use model_core::numbers::digest::chain;
use model_core::observer::{MAPPED, Observer};
use model_core::virtual_joint::VirtualJoint;
use report::failure::{Failure, Outcome};
use table_blob::{Blob, Gears};

/// Control mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Position control with compensation.
    Position,
    /// PID on the motor's position.
    WithoutCompensation,
    /// Spring and damper.
    Impedance,
}

/// State of the run before the torque of a period.
#[derive(Debug)]
pub struct PeriodState<'now> {
    /// Period since the start.
    pub period: u32,
    /// Reference position of the link [rad].
    pub wanted: f64,
    /// Plant with the true state.
    pub joint: &'now VirtualJoint<'now, f32, 3>,
    /// Tables of the plant's gears.
    pub gears: &'now Tables<f32, 3>,
    /// Commanded torque of the previous period [N m].
    pub command: f64,
}

const TURN: f32 = std::f32::consts::TAU;
const AMPLITUDE: f32 = 0.5;
const SECONDS: u32 = 5;
const TORQUE_CONSTANT: f32 = 0.125;
const INERTIA: f32 = 0.160;
const MOTOR_COUNTS: u32 = 1 << 14;
const MOTOR_ZERO: u32 = 4660;
const OUTPUT_COUNTS: u32 = 1 << 17;
const OUTPUT_ZERO: u32 = 39322;
const OUTPUT_ZERO_TURNS: f32 = OUTPUT_ZERO as f32 / OUTPUT_COUNTS as f32;

#[derive(Clone, Copy)]
struct Angle {
    cosine: f32,
    sine: f32,
}

impl Angle {
    fn from_radians(rad: f32) -> Self {
        let square = rad * rad;
        Self {
            sine: rad * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))),
            cosine: 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0))),
        }
    }

    fn rotated_by(self, by: Self) -> Self {
        Self {
            cosine: self.cosine * by.cosine - self.sine * by.sine,
            sine: self.sine * by.cosine + self.cosine * by.sine,
        }
    }

    fn turns(self) -> f32 {
        AMPLITUDE / TURN * (1.0 - self.cosine)
    }

    fn motion(self) -> Motion<f32> {
        Motion {
            position: Position { turns: 0, fraction: OUTPUT_ZERO_TURNS + self.turns() },
            speed: AMPLITUDE * TURN * self.sine,
            acceleration: AMPLITUDE * TURN * TURN * self.cosine,
        }
    }
}

/// Runs the controller, passes the state before every period to `show`, and returns the digest. The joint must have
/// three planets.
pub fn run(words: &[u64], mode: Mode, mut show: impl FnMut(&PeriodState<'_>)) -> Outcome<u64> {
    let invalid_tables = |error| Failure::new(format!("invalid tables: {error:?}"));
    let blob = Blob::open(words).map_err(invalid_tables)?;
    let (Gears::Three(gears), around) = blob.plant().map_err(invalid_tables)? else {
        return Err(Failure::new("the controller needs a joint with three planets"));
    };
    let (observer_tables, tables) =
        (blob.observer().map_err(invalid_tables)?, blob.compensation().map_err(invalid_tables)?);
    let mut joint = VirtualJoint::new(gears, around);
    let mut observer = Observer::<f32, MAPPED>::new(observer_tables);
    let mut compensation = Compensation::new(tables);
    let (rate, period_s, lead) = (blob.header().control_rate, observer_tables.period, tables.crossing.lead);
    let (ratio, pole) = (tables.gear.motor_per_link, blob.header().bandwidth);
    let limit = tables.limits.motor * tables.gear.link_per_motor;
    let (one_period, one_lead) = (Angle::from_radians(TURN * period_s), Angle::from_radians(TURN * lead));
    let mut motor_zero = None;
    let (mut phase, mut integral, mut reference, mut running) = (Angle::from_radians(0.0), 0.0_f32, 0.0_f32, 0);
    for period in 0..SECONDS * rate {
        let (now, ahead) = (phase.motion(), phase.rotated_by(one_lead).motion());
        let command = TORQUE_CONSTANT * reference;
        let wanted = f64::from(phase.turns()) * std::f64::consts::TAU;
        show(&PeriodState { period, wanted, joint: &joint, gears, command: command.into() });
        let mut samples = joint.samples();
        samples.torque = command;
        samples.motor.counts = (samples.motor.counts + MOTOR_ZERO) % MOTOR_COUNTS;
        if let Some(output) = &mut samples.output {
            output.counts = (output.counts + OUTPUT_ZERO) % OUTPUT_COUNTS;
        }
        let estimates = observer.step(&samples);
        let motor_zero = *motor_zero.get_or_insert_with(|| {
            let (motor, link) = (&estimates.motor, &estimates.link);
            (motor.turns as f32 + motor.fraction) / ratio - (link.turns as f32 + link.fraction)
        });
        let torque = match mode {
            Mode::Position => {
                let command = CommandRef::Position { now: &now, ahead: Some(&ahead) };
                compensation.step_by_reference(estimates, command).torque
            }
            Mode::Impedance => {
                let Motion { position, speed, .. } = now;
                let spring = ImpedancePoint { position, speed, torque: 0.0, stiffness: 100.0, damping: 3.0 };
                compensation.step_by_reference(estimates, CommandRef::Impedance(&spring)).torque
            }
            Mode::WithoutCompensation => {
                let motor = &estimates.motor;
                let position = (motor.turns as f32 + motor.fraction) / ratio - motor_zero;
                let error = TURN * (now.position.turns as f32 + now.position.fraction - position);
                let error_rate = now.speed - motor.speed / ratio;
                let link_torque = INERTIA
                    * (now.acceleration
                        + 3.0 * pole * error_rate
                        + 3.0 * pole * pole * error
                        + pole * pole * pole * integral);
                let torque = link_torque / ratio;
                if torque > limit {
                    limit
                } else if torque < -limit {
                    -limit
                } else {
                    integral += error * period_s;
                    torque
                }
            }
        };
        reference = torque / TORQUE_CONSTANT;
        joint.advance(TORQUE_CONSTANT * reference, 0.0);
        running = chain(chain(running, reference.to_bits().into()), joint.model().state_digest());
        phase = if (period + 1).is_multiple_of(rate) { Angle::from_radians(0.0) } else { phase.rotated_by(one_period) };
    }
    Ok(running)
}
