//! Three modes and how likely they are: teeth on the back flank, free, on the drive flank.
//!
//! With d the deflection of the teeth, f the motor side's force, S_s the variance of the edge of flank s, R and N the
//! variances of one deflection and of the force, and F_0 what a force may be up to:
//!
//! ```text
//! flank s:  p(d, f) = N(d - s c - k f; S_s + R + k^2 N) Phi(s F / sd(F)) / F_0,   F = f + k N (d - s c - k f) / (S_s + R + k^2 N)
//! free:     p(d, f) = N(f; N) (Phi((c - d - v t) / sd) Phi((c + d + v t) / sd)) / (2 c)
//! p_next    ~ (M p)^(1 - 1/n) p(d, f)^(1/n)
//! ```
//!
//! n is the number of readings that say the same, so that what repeats counts once; M has the chance that teeth land or part
//! in a period.

use std::f64::consts::{PI, SQRT_2};

/// Part of all readings that belong to no mode: blows, and what nobody has thought of.
const ODD: f64 = 1e-3;

/// What a period, or an interval, shows.
#[derive(Debug, Clone, Copy)]
pub struct Evidence {
    /// Deflection of the teeth, wind-up left in [m].
    pub teeth: f64,
    /// Mesh force from the motor side [N].
    pub force: f64,
    /// [m].
    pub half_gap: f64,
    /// [m/N].
    pub compliance: f64,
    /// How far open teeth have gone on since what is measured [m].
    pub ahead: f64,
    /// How far they go until the next reading [m].
    pub step: f64,
    /// The deflection's rate, where it counts.
    pub rate: Option<Rate>,
    /// Variances of the edges by all that was learnt: back, drive [m^2].
    pub edges: [f64; 2],
    /// Variance of the deflection [m^2].
    pub deflection_variance: f64,
    /// Variance of the force [N^2].
    pub force_variance: f64,
    /// What a force may be up to [N].
    pub usual_force: f64,
    /// How far noise lets open teeth go until the next reading [m].
    pub speed: f64,
}

/// Rate of a deflection.
#[derive(Debug, Clone, Copy)]
pub struct Rate {
    /// Less what the force winds up [m/s].
    pub value: f64,
    /// Its standard deviation [m/s].
    pub deviation: f64,
    /// The rate that open teeth may well have [m/s].
    pub free: f64,
    /// Part of open teeth that turn round and are at rest for a moment: if that is one, rest says nothing, and only motion
    /// that they are open.
    pub may_rest: f64,
}

/// Probabilities: back, free, drive.
#[derive(Debug, Clone, Copy)]
pub struct Modes([f64; 3]);

impl Default for Modes {
    fn default() -> Self {
        Self([1.0 / 3.0; 3])
    }
}

impl Modes {
    /// Takes in a reading that says the same as `correlated` of them.
    pub fn step(&mut self, evidence: &Evidence, correlated: f64, kept: bool) {
        let share = 1.0 / correlated;
        let prior = self.on(evidence);
        let likelihood = evidence.likelihoods();
        let mut sum = 0.0;
        for (mode, (prior, likelihood)) in self.0.iter_mut().zip(prior.iter().zip(likelihood)) {
            let keeps = if kept { 1.0 } else { 1.0 - share };
            *mode = (keeps * prior.max(1e-9).ln() + share * likelihood).exp();
            sum += *mode;
        }
        self.0.iter_mut().for_each(|mode| *mode /= sum);
    }

    /// A reading later: teeth land as soon as they get there, and part as fast as they go.
    fn on(&self, evidence: &Evidence) -> [f64; 3] {
        let Evidence { teeth, half_gap, ahead, step, speed, .. } = *evidence;
        let way = 2.0 * half_gap.max(speed);
        let part = ((step.abs() + speed) / way).min(0.5);
        let lands = |side: f64| {
            let left = (half_gap - side * (teeth + ahead)).max(0.0);
            let goes = (side * step).max(0.0) + speed;
            (goes / (goes + left)).min(0.5)
        };
        let [back, free, drive] = self.0;
        let (to_back, to_drive) = (lands(-1.0), lands(1.0));
        [
            back * (1.0 - part) + free * to_back,
            free * (1.0 - to_back).max(0.0) * (1.0 - to_drive).max(0.0) + (back + drive) * part,
            drive * (1.0 - part) + free * to_drive,
        ]
    }

    /// Probabilities with sides.
    pub fn sides(&self) -> [(f64, f64); 3] {
        let [back, free, drive] = self.0;
        [(back, -1.0), (free, 0.0), (drive, 1.0)]
    }

    /// Probabilities of the flanks: back, drive.
    pub fn touching(&self) -> [f64; 2] {
        let [back, _, drive] = self.0;
        [back, drive]
    }

    /// The likeliest, with a flank counting so many times: to hold on to teeth that are free costs less than to let those go
    /// that touch.
    pub fn side(&self, lean: f64) -> i8 {
        let [back, free, drive] = self.0;
        if lean * drive > free && drive > back {
            1
        } else if lean * back > free {
            -1
        } else {
            0
        }
    }

    /// Force that the meshes pass on, as expected [N].
    pub fn force(&self, evidence: &Evidence) -> f64 {
        let [back, _, drive] = self.0;
        [(back, -1.0), (drive, 1.0)]
            .into_iter()
            .map(|(probability, side)| {
                let (_, force, _) = evidence.touching(side);
                probability * side * (side * force).max(0.0)
            })
            .sum()
    }
}

impl Evidence {
    /// Innovation's log-density on a flank, and force with its standard deviation.
    fn touching(&self, side: f64) -> (f64, f64, f64) {
        let edge = self.edges[usize::from(side > 0.0)];
        let deflection = edge + self.deflection_variance + self.ahead * self.ahead;
        let of_force = self.compliance * self.force_variance;
        let variance = deflection + self.compliance * of_force;
        let innovation = self.teeth - side * self.half_gap - self.compliance * self.force;
        let force = self.force + of_force * innovation / variance;
        let left = self.force_variance - of_force * of_force / variance;
        let odd = ODD / (4.0 * self.half_gap).max(1e-9);
        let density = (-0.5 * innovation * innovation / variance).exp() / (2.0 * PI * variance).sqrt() + odd;
        (density.ln(), force, left.max(0.0).sqrt())
    }

    /// Probability that the deflection is inside both edges.
    pub fn inside_both(&self) -> f64 {
        let place = self.teeth + self.ahead;
        let inside = |side: f64| {
            let edge = self.edges[usize::from(side > 0.0)] + self.deflection_variance + self.step * self.step;
            phi((self.half_gap - side * place) / edge.sqrt())
        };
        inside(1.0) * inside(-1.0)
    }

    /// Log-likelihoods of back, free, drive.
    fn likelihoods(&self) -> [f64; 3] {
        let flank = |side: f64| {
            let (density, force, deviation) = self.touching(side);
            let pressed = phi(side * force / deviation.max(1e-9)).max(1e-12);
            density + pressed.ln() - self.usual_force.ln()
        };
        let way = (2.0 * self.half_gap).max(1e-9);
        let free = ((self.inside_both() + 0.5 * ODD) / way).ln() + normal(self.force, self.force_variance);
        let [mut back, mut open, mut drive] = [flank(-1.0), free, flank(1.0)];
        if let Some(Rate { value, deviation, free, may_rest }) = self.rate {
            let noise = deviation * deviation;
            let rests = normal(value, noise);
            let moves = normal(value, noise + free * free);
            open += moves.max(rests + may_rest.max(1e-4).ln());
            back += rests.max(-20.0);
            drive += rests.max(-20.0);
        }
        [back, open, drive]
    }
}

/// Log of the normal density.
fn normal(value: f64, variance: f64) -> f64 {
    -0.5 * (value * value / variance + (2.0 * PI * variance).ln())
}

/// Normal distribution.
fn phi(value: f64) -> f64 {
    0.5 * erfc(-value / SQRT_2)
}

/// Complementary error function, to 1e-7 of itself.
fn erfc(value: f64) -> f64 {
    let size = value.abs();
    let part = 1.0 / (1.0 + 0.5 * size);
    let series = [
        1.00002368, 0.37409196, 0.09678418, -0.18628806, 0.27886807, -1.13520398, 1.48851587, -0.82215223, 0.17087277,
    ];
    let sum = series.iter().rev().fold(0.0, |sum, factor| (sum + factor) * part) - 1.26551223;
    let tail = part * (-size * size + sum).exp();
    if value >= 0.0 { tail } else { 2.0 - tail }
}
