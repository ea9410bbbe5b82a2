//! Largest Lyapunov exponent, by a tangent vector and by two trajectories: the mean rate at which neighbouring trajectories diverge, per
//! unit of dimensionless time.

use super::integrator::{EventIntegrator, State};
use super::system::StudyError;

/// Distance of the second trajectory, over b_c: far above the truncation of the steps, far below the motion.
const DISTANCE: f64 = 1e-7;

/// Growth of a vector that is normalised once a period.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Growth {
    /// Logarithm of the unnormalised length, after each period.
    logarithms: Vec<f64>,
}

impl Growth {
    /// Adds a period with a growth of `factor`.
    pub fn add(&mut self, factor: f64) {
        let before = self.logarithms.last().copied().unwrap_or(0.0);
        // Contraction to zero is treated as contraction by a large factor.
        self.logarithms.push(before + factor.max(f64::MIN_POSITIVE).ln());
    }

    /// Mean growth rate per unit of time, for growth with random fluctuations, as in chaos.
    pub fn mean(&self, period: f64) -> f64 {
        self.logarithms.last().map_or(f64::NAN, |last| last / self.logarithms.len() as f64 / period)
    }

    /// Growth rate per unit of time: slope of the straight line through all logarithms. A tangent vector that turns while it shrinks
    /// oscillates about this line, which disturbs the mean far more.
    pub fn exponent(&self, period: f64) -> f64 {
        let count = self.logarithms.len() as f64;
        let middle = 0.5 * (count - 1.0);
        let (mut along, mut square) = (0.0, 0.0);
        for (index, logarithm) in self.logarithms.iter().enumerate() {
            let from_middle = index as f64 - middle;
            along += from_middle * logarithm;
            square += from_middle * from_middle;
        }
        along / square / period
    }
}

/// Tangent vector without symmetry: every coordinate takes part, each differently.
pub fn generic(coordinates: usize) -> State {
    let mut state = State::default();
    for index in 0..coordinates {
        state.position[index] = 1.0 / (1.0 + index as f64);
        state.rate[index] = 0.7 - 0.3 * index as f64;
    }
    normalise(&mut state);
    state
}

/// Normalises a vector and returns its length.
pub fn normalise(vector: &mut State) -> f64 {
    let length = length(vector);
    for value in vector.position.iter_mut().chain(&mut vector.rate) {
        *value /= length;
    }
    length
}

fn length(vector: &State) -> f64 {
    vector.position.iter().chain(&vector.rate).map(|value| value * value).sum::<f64>().sqrt()
}

/// Advances a motion by one period and adds the growth of its first tangent vector.
pub fn measured_period(motion: &mut EventIntegrator<'_>, growth: &mut Growth) -> Result<(), StudyError> {
    motion.period()?;
    growth.add(motion.tangents().first_mut().map_or(1.0, normalise));
    Ok(())
}

/// Growth of the distance of two trajectories, over `periods` after `skipped` periods in which their difference finds its direction.
pub fn two_trajectories(motion: &EventIntegrator<'_>, skipped: u32, periods: u32) -> Result<Growth, StudyError> {
    let system = motion.system();
    let mut first = EventIntegrator::new(system, motion.state());
    let mut difference = generic(system.coordinates());
    let mut growth = Growth::default();
    for period in 0..skipped + periods {
        let mut second = EventIntegrator::new(system, moved(&first.state(), &difference, DISTANCE));
        first.period()?;
        second.period()?;
        difference = moved(&second.state(), &first.state(), -1.0);
        let factor = normalise(&mut difference) / DISTANCE;
        if period >= skipped {
            growth.add(factor);
        }
    }
    Ok(growth)
}

/// `state` plus `factor` times `direction`.
fn moved(state: &State, direction: &State, factor: f64) -> State {
    let mut moved = *state;
    for (value, along) in moved.position.iter_mut().zip(&direction.position) {
        *value += factor * along;
    }
    for (value, along) in moved.rate.iter_mut().zip(&direction.rate) {
        *value += factor * along;
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform growth has its exponent.
    #[test]
    fn uniform_growth_has_its_exponent() {
        let mut growth = Growth::default();
        (0..50).for_each(|_| growth.add(0.5));
        assert!((growth.exponent(2.0) - 0.5_f64.ln() / 2.0).abs() < 1e-14);
        assert!((growth.mean(2.0) - 0.5_f64.ln() / 2.0).abs() < 1e-14);
    }

    /// The exponent of a turning vector follows its trend.
    #[test]
    fn turning_vector_has_the_trend_exponent() {
        let mut growth = Growth::default();
        let wave = |k: u32| (1.0 + 0.9 * (f64::from(k) * 1.3).cos()).ln();
        (0..300).for_each(|k| growth.add((-0.1 + wave(k + 1) - wave(k)).exp()));
        assert!((growth.exponent(1.0) + 0.1).abs() < 2e-4, "{}", growth.exponent(1.0));
    }
}
