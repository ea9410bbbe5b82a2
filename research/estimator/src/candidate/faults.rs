//! Faults of the encoders: one table of hypotheses, one of actions.
//!
//! Each hypothesis has a cumulative sum of log-likelihood ratios against a sound encoder, zero at least; the first that
//! passes [`FOUND`] is acted on.
//!
//! | hypothesis | what a period adds | action |
//! |---|---|---|
//! | a sensor is frozen | the counts that its shaft must have gone, if it has gone none; otherwise back to zero | it is given up |
//! | a sensor has jumped | half the square of an innovation that comes at once, if the next readings bear it out | it is given up |
//! | the deflection is where no teeth let it be | half its normalised square beyond, at most [`MOST`], over what repeats; as much less inside | whichever stands still is given up, else the output |
//!
//! What a shaft must have gone is bounded by what may brake it: this is physics of the joint and of no filter's covariance.

use model_core::observer::ObserverTables;
use model_core::observer::tables::StopTable;

use super::filters::Sensed;
use crate::runs::Stands;

/// Log-likelihood ratio from which on a hypothesis is acted on: one false alarm in some 10^5 independent chances.
const FOUND: f64 = 12.0;
/// The most that one reading may add.
const MOST: f64 = 4.0;
/// Readings of the deflection that say the same.
const ALIKE: f64 = 10.0;
/// Counts that a reading jumps by before it may be one.
const JUMP: f64 = 8.0;
/// Counts that rounding hides of what a shaft has gone.
const ROUNDING: f64 = 2.0;
/// Periods, twice, in which a torque acts before that speed follows it.
const LAG: f64 = 12.0;
/// Periods over which a shaft's speed is taken.
const SPEED: f64 = 8.0;

/// One encoder's own hypotheses.
#[derive(Debug, Clone, Copy, Default)]
struct Sensor {
    /// The speed is known.
    began: bool,
    /// Mean counts in a period, and mean deviation from that, before it stood still.
    rate: f64,
    noise: f64,
    /// Readings that stood still.
    still: f64,
    /// Sum of what it must have gone and has not.
    frozen: f64,
    /// Sum of what jumped, counts by which it is away, and readings since.
    jumped: f64,
    away: f64,
    since: u8,
}

/// What bounds a shaft's course in a period.
struct Bounds<'t> {
    stops: &'t StopTable<f64>,
    /// Half of the counts by which torques slow it down in a period, for each period.
    brake: f64,
    /// Counts in a period by which teeth carry it on whatever it runs into, at a rate.
    carried: f64,
    /// Counts by which teeth may throw it at once.
    throw: f64,
}

impl Sensor {
    /// One reading: the shaft went on by so many counts.
    fn step(&mut self, by: f64, bounds: &Bounds<'_>) -> bool {
        if !std::mem::replace(&mut self.began, true) {
            self.rate = by;
            return false;
        }
        let beyond = by - self.rate;
        let jump = JUMP + 4.0 * self.noise + bounds.throw;
        if self.since > 0 || beyond.abs() > jump {
            self.away += beyond;
            self.since += 1;
            if self.away.abs() < JUMP / 2.0 {
                (self.away, self.since, self.jumped) = (0.0, 0, 0.0);
            } else {
                self.jumped += MOST.min(0.5 * (self.away / (1.0 + self.noise)).powi(2));
            }
            return self.jumped >= FOUND;
        }
        if by == 0.0 {
            self.still += 1.0;
            if self.still > f64::from(bounds.stops.forgotten) {
                self.rate = 0.0;
            }
            // What is said of the speed lags behind by some periods in which torques brake.
            let sure = |rate: f64| if rate < 1.0 { 0.0 } else { (rate - LAG * bounds.brake).max(0.0) };
            let stopped = (1.0 - self.still * bounds.stops.per_stops).max(0.0) * sure(self.rate.abs());
            let stopped = if self.still > f64::from(bounds.stops.stop) { 0.0 } else { stopped };
            let least = self.still * (stopped.max(sure(bounds.carried)) - self.still * bounds.brake);
            // Two thirds of what is lacking speak as e to that power.
            self.frozen = (least - ROUNDING - 4.0 * self.noise) * FOUND / (ROUNDING + 1.0);
            return self.frozen >= FOUND && self.still >= 3.0;
        }
        let beyond = by / (self.still + 1.0) - self.rate;
        (self.still, self.frozen) = (0.0, 0.0);
        self.rate += beyond / SPEED;
        self.noise += (beyond.abs() - self.noise) / (4.0 * SPEED);
        false
    }
}

/// What the deflection says of it.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Deflection beyond the flank and the wind-up of the force, towards which it is [m].
    pub beyond: f64,
    /// Variance of that [m^2].
    pub variance: f64,
    /// What wear may explain, and dynamics [m].
    pub margin: f64,
}

/// What is known of the sensors' faults.
#[derive(Debug, Clone, Copy, Default)]
pub struct Faults {
    motor: Sensor,
    output: Sensor,
    beyond: f64,
    /// Motor and output are given up.
    given_up: [bool; 2],
    /// Periods for which one that was given up has made sense, and moved.
    sensible: f64,
    moved: f64,
    /// The same in which it was where teeth let it be.
    agreed: f64,
    /// Periods for which it has been given up.
    gone: f64,
}

/// What came of a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Found {
    /// Nothing.
    Nothing,
    /// An encoder that was given up is used again; what was learnt holds.
    Back,
    /// It is used again, and it is elsewhere.
    Elsewhere,
}

impl Faults {
    /// What is stood on.
    pub fn stands(&self) -> Stands {
        match self.given_up {
            [true, _] => Stands::Nothing,
            [_, true] => Stands::MotorOnly,
            _ => Stands::Both,
        }
    }

    /// One period; `place` is from the counts alone while an encoder is given up.
    pub fn step(&mut self, tables: &ObserverTables<f64>, sensed: &Sensed, place: &Place, torque: f64) -> Found {
        let table = &tables.supervisor;
        let [motor_by, output_by] = sensed.went.map(|by| by as f64);
        let per_output = table.motor_counts;
        if self.gone == 0.0 {
            let link = (self.output.rate * per_output).abs();
            let motor = Bounds {
                stops: &table.motor,
                brake: table.motor_brake * (torque + table.motor_drag),
                carried: (link - (self.motor.rate.abs() - link).abs()).max(0.0),
                throw: 2.0 * self.motor.rate.abs().max(link),
            };
            let output = Bounds { stops: &table.output, brake: table.output_brake, carried: 0.0, throw: 0.0 };
            let motor_fails = self.motor.step(motor_by, &motor);
            let output_fails = sensed.innovations[1].is_some() && self.output.step(output_by, &output);
            let z = (place.beyond - place.margin) / place.variance.sqrt();
            let add = (0.5 * z * z.abs()).clamp(-MOST, MOST) / ALIKE;
            self.beyond = (self.beyond + add).max(0.0);
            let unmoved = self.motor.still > f64::from(table.motor_unmoved_after) && self.output.still < self.motor.still;
            self.given_up = [
                motor_fails || self.beyond >= FOUND && unmoved,
                !motor_fails && (output_fails || self.beyond >= FOUND && !unmoved),
            ];
            if self.given_up != [false; 2] {
                if std::env::var_os("TELL").is_some() {
                    eprintln!("{:?} beyond {:.1} place {place:?} m {:?} o {:?}", self.given_up, self.beyond, self.motor, self.output);
                }
                (self.gone, self.sensible, self.moved, self.agreed) = (1.0, 0.0, 0.0, 0.0);
            }
            return Found::Nothing;
        }
        self.gone += 1.0;
        let [motor_gone, _] = self.given_up;
        let by = if motor_gone { motor_by } else { output_by };
        let other = if motor_gone { output_by * per_output } else { motor_by / per_output };
        // It turns as the other does, gap aside.
        let makes_sense = (by - other).abs() < JUMP + 2.0 * other.abs();
        self.sensible = if makes_sense { self.sensible + 1.0 } else { 0.0 };
        self.moved = if makes_sense { self.moved + f64::from(u8::from(by != 0.0)) } else { 0.0 };
        let allowed = place.beyond < place.margin;
        self.agreed = if makes_sense && allowed { self.agreed + 1.0 } else { 0.0 };
        let [soon, late] = if motor_gone {
            [table.motor_trusted_after, table.motor_slipped_after].map(f64::from)
        } else {
            let periods = f64::from(table.trusted_after) * f64::from(tables.learner.periods);
            [periods, 3.0 * periods]
        };
        let turned = self.moved > 0.1 * soon;
        if turned && self.agreed >= soon || self.sensible >= late && turned {
            if std::env::var_os("TELL").is_some() {
                eprintln!("back: {allowed} {place:?} after {}", self.gone);
            }
            let found = if allowed { Found::Back } else { Found::Elsewhere };
            *self = Self { motor: Sensor::default(), output: Sensor::default(), ..Self::default() };
            return found;
        }
        Found::Nothing
    }
}
