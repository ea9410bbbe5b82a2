//! The observer's parameters by recursive least squares, each deflection weighted; bias and friction of the motor likewise.
//! In f64 a full covariance serves as well as factors.

use std::fmt::{self, Display, Formatter};

use model_core::observer::ObserverTables;
use model_core::observer::tables::{ContactTable, MOST_PARAMETERS};

use super::filters::Sensed;

/// Number of parameters.
pub const P: usize = MOST_PARAMETERS;
/// Where they stand.
pub const HALF_GAP: usize = 0;
/// The offset.
pub const OFFSET: usize = 1;
/// The compliance.
pub const COMPLIANCE: usize = 2;
/// Sine and cosine of the transmission error.
pub const ERROR: usize = 4;

/// Updates over which normalised innovations are taken.
const SURPRISES: f64 = 2.0;
/// Mean of normalised innovations squared beyond which the joint is no longer the one that was learnt.
const SURPRISED: f64 = 9.0;

/// Least half-gap that is believed, over the guess: nothing comes back from none at all.
const LEAST: f64 = 0.25;
/// Blocks within which a second surprise is no wear.
const DOUBTED: f64 = 64.0;

/// How a deflection is learnt.
#[derive(Debug, Clone, Copy)]
pub struct How {
    /// Surprises widen the covariance.
    pub inflate: bool,
    /// The half-gap's first.
    pub wear_first: bool,
    /// But only where it seems wider.
    pub no_growth: bool,
    /// Variance of the force's noise that is taken back from what it tells of the compliance; zero for none [N^2].
    pub force_noise: f64,
}

/// Regressors of open teeth, and sine and cosine of the mesh phase.
pub fn regressors(sensed: &Sensed) -> ([f64; P], [f64; 2]) {
    let mut free = [0.0; P];
    free[OFFSET] = 1.0;
    free[3] = sensed.link_speed;
    let [motor, output, mesh] = sensed.phases;
    for (index, phase) in [motor, output].into_iter().enumerate() {
        let places = [phase.sin(), phase.cos(), (2.0 * phase).sin(), (2.0 * phase).cos()];
        free[6 + 4 * index..10 + 4 * index].copy_from_slice(&places);
    }
    (free, [mesh.sin(), mesh.cos()])
}

/// The same with touching teeth.
pub fn touching(free: &[f64; P], side: f64, force: f64, mesh: &[f64; 2]) -> [f64; P] {
    let mut regressors = *free;
    regressors[HALF_GAP] = side;
    regressors[COMPLIANCE] = force;
    regressors[ERROR..ERROR + 2].copy_from_slice(mesh);
    regressors
}

/// Parameters with their covariance.
#[derive(Debug, Clone)]
pub struct Learner {
    values: [f64; P],
    covariance: [[f64; P]; P],
    prior: [f64; P],
    /// Least half-gap that is believed [m].
    least: f64,
    /// Compliance of the meshes alone [m/N].
    stiffest: f64,
    surprise: f64,
    /// Blocks since the half-gap was doubted.
    doubted: f64,
    /// Motor bias and friction.
    pub bias: Bias,
}

impl Learner {
    /// What was designed.
    pub fn new(tables: &ObserverTables<f64>) -> Self {
        let prior = tables.learner.deviation.map(|deviation| deviation * deviation);
        let mut learner = Self {
            values: tables.learner.mean,
            covariance: [[0.0; P]; P],
            prior,
            least: LEAST * tables.learner.mean[HALF_GAP],
            stiffest: tables.learner.mesh_compliance,
            surprise: 1.0,
            doubted: f64::INFINITY,
            bias: Bias::new(&tables.contact),
        };
        learner.reopen();
        learner
    }

    /// As unsure as beforehand.
    fn reopen(&mut self) {
        self.covariance = [[0.0; P]; P];
        for (index, prior) in self.prior.iter().enumerate() {
            self.covariance[index][index] = *prior;
        }
    }

    /// An encoder has slipped: the offset is further on by so much [m], and nothing is known of it.
    pub fn move_to(&mut self, by: f64) {
        self.values[OFFSET] += by;
        for index in 0..P {
            (self.covariance[OFFSET][index], self.covariance[index][OFFSET]) = (0.0, 0.0);
        }
        self.covariance[OFFSET][OFFSET] = self.prior[OFFSET];
    }

    /// A parameter.
    pub fn value(&self, index: usize) -> f64 {
        self.values[index]
    }

    /// What parameters make of regressors [m].
    pub fn deflection(&self, regressors: &[f64; P]) -> f64 {
        self.values.iter().zip(regressors).map(|(value, regressor)| value * regressor).sum()
    }

    /// Its variance [m^2].
    pub fn variance(&self, regressors: &[f64; P]) -> f64 {
        self.gain(regressors).iter().zip(regressors).map(|(gain, regressor)| gain * regressor).sum()
    }

    /// Shift of both flanks [m].
    pub fn transmission_error(&self, mesh: &[f64; 2]) -> f64 {
        self.values[ERROR] * mesh[0] + self.values[ERROR + 1] * mesh[1]
    }

    fn gain(&self, regressors: &[f64; P]) -> [f64; P] {
        let mut gain = [0.0; P];
        for (value, row) in gain.iter_mut().zip(&self.covariance) {
            *value = row.iter().zip(regressors).map(|(entry, regressor)| entry * regressor).sum();
        }
        gain
    }

    /// Learns a deflection [m] whose noise has this variance [m^2], and which is this share of a whole one.
    pub fn learn(&mut self, regressors: &[f64; P], deflection: f64, noise: f64, share: f64, how: How) {
        let innovation = deflection - self.deflection(regressors);
        let mut gain = self.gain(regressors);
        let known: f64 = gain.iter().zip(regressors).map(|(gain, regressor)| gain * regressor).sum();
        self.doubted += share;
        if how.inflate {
            // One deflection by itself is surer than its weight says, which is for all that repeats.
            let normalised = innovation * innovation / (known + noise * share);
            self.surprise += share * (normalised.min(10.0 * SURPRISED) - self.surprise) / SURPRISES;
            if self.surprise > SURPRISED {
                // Teeth wear, but they do not grow; if that is not it, something else has moved.
                let twice = !how.wear_first || self.doubted < DOUBTED;
                let wider = regressors[HALF_GAP] * innovation > 0.0;
                let which: &[usize] = match (twice, wider || !how.no_growth) {
                    (true, _) => &[HALF_GAP, OFFSET],
                    (false, true) => &[HALF_GAP],
                    (false, false) => &[OFFSET],
                };
                self.widen(innovation * innovation, which);
                self.doubted = 0.0;
                gain = self.gain(regressors);
                self.surprise = 1.0;
            }
        }
        let known: f64 = gain.iter().zip(regressors).map(|(gain, regressor)| gain * regressor).sum();
        let total = known + noise;
        for (value, gain) in self.values.iter_mut().zip(&gain) {
            *value += gain * innovation / total;
        }
        for (row, of_row) in self.covariance.iter_mut().zip(&gain) {
            for (entry, of_column) in row.iter_mut().zip(&gain) {
                *entry -= of_row * of_column / total;
            }
        }
        if how.force_noise > 0.0 {
            self.compensate(how.force_noise / total.min(noise));
        }
        self.values[HALF_GAP] = self.values[HALF_GAP].max(self.least);
        self.values[COMPLIANCE] = self.values[COMPLIANCE].max(self.stiffest);
    }

    /// Takes back what noise of a force has told of the compliance: so much information [N^2/m^2].
    fn compensate(&mut self, information: f64) {
        let mut gain = [0.0; P];
        gain.iter_mut().zip(&self.covariance).for_each(|(gain, row)| *gain = row[COMPLIANCE]);
        let part = information * gain[COMPLIANCE];
        if part > 0.5 || self.covariance[COMPLIANCE][COMPLIANCE] > 0.9 * self.prior[COMPLIANCE] {
            return;
        }
        let by = information * self.values[COMPLIANCE] / (1.0 - part);
        self.values.iter_mut().zip(&gain).for_each(|(value, gain)| *value += by * gain);
        for (row, of_row) in self.covariance.iter_mut().zip(&gain) {
            for (entry, of_column) in row.iter_mut().zip(&gain) {
                *entry += of_row * of_column * information / (1.0 - part);
            }
        }
    }

    /// Parameters may have changed by so much [m^2].
    fn widen(&mut self, by: f64, which: &[usize]) {
        for index in which {
            let entry = &mut self.covariance[*index][*index];
            *entry = (*entry + by).min(self.prior[*index].max(*entry));
        }
    }

    /// A learning interval passes.
    pub fn age(&mut self, tables: &ObserverTables<f64>) {
        for (index, prior) in self.prior.iter().enumerate() {
            let entry = &mut self.covariance[index][index];
            *entry = (*entry * (1.0 + tables.learner.forgetting)).min(prior.max(*entry));
        }
        self.bias.age(&tables.contact);
    }
}

impl Display for Learner {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "o {:.1} k {:.2e} bias {:.1} friction {:.1} surprise {:.1}",
            1e6 * self.values[OFFSET],
            self.values[COMPLIANCE],
            self.bias.bias,
            self.bias.friction,
            self.surprise
        )
    }
}

/// Bias and dry friction of the motor as force, by the observer's own least squares, weighted.
#[derive(Debug, Clone, Copy)]
pub struct Bias {
    /// [N].
    pub bias: f64,
    /// [N].
    pub friction: f64,
    variance: [f64; 3],
}

impl Bias {
    fn new(table: &ContactTable<f64>) -> Self {
        Self { bias: 0.0, friction: 0.0, variance: [table.bias_prior, table.bias_prior, 0.0] }
    }

    /// Mesh force of what the motor side loses [N].
    pub fn force(&self, tables: &ObserverTables<f64>, lost: f64, direction: f64) -> f64 {
        let net = lost - self.bias - self.friction * direction;
        let contact = &tables.contact;
        let loss = if net * direction > 0.0 { contact.loss_driving } else { contact.loss_driven };
        net + net * direction.abs() * loss
    }

    /// Variance of both together for a direction [N^2].
    pub fn variance_at(&self, direction: f64) -> f64 {
        let [bias, friction, both] = self.variance;
        bias + direction * (2.0 * both + direction * friction)
    }

    /// What stays wrong of forces that were learnt from, as variance of a deflection and of a flank [m^2].
    pub fn lasting(&self, tables: &ObserverTables<f64>, compliance: f64, direction: f64) -> [f64; 2] {
        let ripple = 0.5 * tables.contact.ripple_variance;
        let [_, friction, _] = self.variance;
        [self.variance_at(direction) + ripple, 0.5 * direction * direction * friction + ripple]
            .map(|force| force * compliance * compliance)
    }

    /// Takes in what the motor side loses in the open gap.
    pub fn learn(&mut self, table: &ContactTable<f64>, lost: f64, direction: f64, weight: f64, gated: bool) {
        let [bias, friction, both] = self.variance;
        let (from_bias, from_friction) = (bias + direction * both, both + direction * friction);
        let expected = table.bias_noise / weight + from_bias + direction * from_friction;
        let innovation = lost - self.bias - self.friction * direction;
        let alone = table.bias_noise + from_bias + direction * from_friction;
        if gated && innovation * innovation > 16.0 * alone {
            return;
        }
        let gains = [from_bias / expected, from_friction / expected];
        self.bias = (self.bias + gains[0] * innovation).clamp(-table.bias_limit, table.bias_limit);
        self.friction = (self.friction + gains[1] * innovation).clamp(0.0, table.bias_limit);
        self.variance =
            [bias - gains[0] * from_bias, friction - gains[1] * from_friction, both - gains[0] * from_friction];
    }

    fn age(&mut self, table: &ContactTable<f64>) {
        for variance in self.variance.iter_mut().take(2) {
            if *variance < table.bias_prior {
                *variance += table.bias_drift;
            }
        }
    }
}
