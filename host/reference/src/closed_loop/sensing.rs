//! Encoder processing of a controller without an observer: angles from counts, speeds from tracking filters with the commanded
//! torque as input. Encoder errors are not corrected.

use std::f64::consts::TAU;

/// Tracker of motor angle and speed: a third-order observer of the free rotor with a torque disturbance and a triple
/// pole.
#[derive(Debug, Clone)]
pub struct MotorTracker {
    period: f64,
    per_count: f64,
    inertia: f64,
    gains: [f64; 3],
    angle: f64,
    speed: f64,
    disturbance: f64,
    started: bool,
}

impl MotorTracker {
    /// Tracker with a triple pole at `pole` [rad/s], for a rotor of `inertia` [kg m^2].
    pub fn new(counts_per_turn: u64, inertia: f64, pole: f64, period: f64) -> Self {
        // Discrete poles at exp(-pole period): gains by matching the characteristic polynomial of the sampled chain.
        let z = (-pole * period).exp();
        let gains =
            [1.0 - z * z * z, 1.5 * (1.0 - z) * (1.0 - z) * (1.0 + z) / period, (1.0 - z).powi(3) / (period * period)];
        Self {
            period,
            per_count: TAU / counts_per_turn as f64,
            inertia,
            gains,
            angle: 0.0,
            speed: 0.0,
            disturbance: 0.0,
            started: false,
        }
    }

    /// Takes a reading and the torque since the last reading; returns angle [rad] and speed [rad/s].
    pub fn step(&mut self, counts: i64, torque: f64) -> (f64, f64) {
        let measured = (counts as f64 + 0.5) * self.per_count;
        if !self.started {
            self.started = true;
            self.angle = measured;
        }
        let acceleration = torque / self.inertia + self.disturbance;
        let predicted = self.angle + self.period * self.speed + 0.5 * self.period * self.period * acceleration;
        let error = measured - predicted;
        self.angle = predicted + self.gains[0] * error;
        self.speed += self.period * acceleration + self.gains[1] * error;
        self.disturbance += self.gains[2] * error;
        (self.angle, self.speed)
    }
}

/// Tracker of link angle and speed: a third-order observer without torque input.
#[derive(Debug, Clone)]
pub struct LinkTracker(MotorTracker);

impl LinkTracker {
    /// Tracker with a triple pole at `pole` [rad/s].
    pub fn new(counts_per_turn: u64, pole: f64, period: f64) -> Self {
        Self(MotorTracker::new(counts_per_turn, 1.0, pole, period))
    }

    /// Takes a reading; returns angle [rad] and speed [rad/s].
    pub fn step(&mut self, counts: i64) -> (f64, f64) {
        self.0.step(counts, 0.0)
    }
}
