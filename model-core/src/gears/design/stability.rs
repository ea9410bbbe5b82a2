//! Stability limits of a sub-step: spectral radius of the method on a damped oscillator; for corrected sub-steps over a
//! number of sub-steps after a cold start (`substep`). Backlash and ripple are neglected: they bend a stable motion but do
//! not make it grow.

/// Largest phase tested [rad], above the limit of any explicit method with two evaluations.
const LARGEST: f64 = 4.0;
/// Resolution of the tested phases [rad].
const GRID: f64 = 0.005;
/// Lower bound of the damping ratio [-]: without damping, the error of the method causes a growth that no real joint has.
const LEAST_DAMPING: f64 = 0.02;
/// Number of sub-steps after a cold start that makes the cold start irrelevant: limit of the warm start.
pub const WITHOUT_END: u32 = 64;
/// Fraction of the stability limit in use, because the damping of modes in contact is an estimate.
pub const MARGIN: f64 = 0.95;

/// Damped oscillator with the phase `phase` per sub-step, in units in which a sub-step lasts 1.
struct Oscillator {
    phase: f64,
    damping_ratio: f64,
}

impl Oscillator {
    /// Returns the acceleration in sixths, as in `gears::stages`.
    fn acceleration(&self, position: f64, rate: f64) -> f64 {
        -(self.phase * self.phase * position + 2.0 * self.damping_ratio * self.phase * rate) / 6.0
    }

    /// Returns position and rate after a tick: cold start of `gears::substep`, then sub-steps of `gears::stages`.
    fn tick(&self, mut position: f64, mut rate: f64, substeps: u32) -> [f64; 2] {
        let middle = |position: f64, rate: f64, now: f64, before: f64| {
            self.acceleration(position + 0.5 * rate + now - 0.25 * before, rate + 4.5 * now - 1.5 * before)
        };
        let mut now = self.acceleration(position, rate);
        let mut before = 2.0 * now - middle(position, rate, now, now);
        for _ in 0..substeps {
            let seen = middle(position, rate, now, before);
            position += rate + now + 2.0 * seen;
            let last = self.acceleration(position, rate + 6.0 * seen);
            rate += now + 4.0 * seen + last;
            (now, before) = (last, seen);
        }
        [position, rate]
    }

    /// Returns position in the middle and rate after a Verlet sub-step of `gears::light` in contact throughout.
    fn verlet(&self, middle: f64, rate: f64) -> [f64; 2] {
        let square = self.phase * self.phase;
        let damping = 2.0 * self.damping_ratio * self.phase;
        let yielding = square / 12.0 + 0.5 * damping;
        let rate = rate - (1.0 - yielding) * (square * middle + damping * rate);
        [middle + rate, rate]
    }
}

/// Returns the spectral radius of a linear map.
fn spectral_radius(map: impl Fn(f64, f64) -> [f64; 2]) -> f64 {
    let ([a, c], [b, d]) = (map(1.0, 0.0), map(0.0, 1.0));
    let (half_trace, determinant) = (0.5 * (a + d), a * d - b * c);
    let square = half_trace * half_trace - determinant;
    if square < 0.0 { libm::sqrt(determinant) } else { half_trace.abs() + libm::sqrt(square) }
}

/// Returns the largest phase up to which no motion grows [rad].
fn largest(damping_ratio: f64, growth: impl Fn(&Oscillator) -> f64) -> f64 {
    let damping_ratio = damping_ratio.max(LEAST_DAMPING);
    let phases = (1..).map(|step| GRID * f64::from(step)).take_while(|phase| *phase < LARGEST);
    phases.take_while(|phase| growth(&Oscillator { phase: *phase, damping_ratio }) <= 1.0).last().unwrap_or(GRID)
}

/// Returns the stability limit of a mode's phase per sub-step for `substeps` sub-steps after a cold start [rad].
pub fn largest_phase(damping_ratio: f64, substeps: u32) -> f64 {
    largest(damping_ratio, |oscillator| spectral_radius(|position, rate| oscillator.tick(position, rate, substeps)))
}

/// Returns the stability limit of a mode's phase per Verlet sub-step [rad].
pub fn largest_verlet_phase(damping_ratio: f64) -> f64 {
    largest(damping_ratio, |oscillator| spectral_radius(|middle, rate| oscillator.verlet(middle, rate)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_the_amplification_matrix() {
        // Computed independently from the matrix of the method, to three digits.
        for (substeps, damping_ratio, limit) in [(1, 0.05, 2.6), (2, 0.05, 2.74), (4, 0.05, 2.56), (4, 0.2, 2.03)] {
            let found = largest_phase(damping_ratio, substeps);
            assert!((found - limit).abs() < 0.03, "{substeps} sub-steps, damping ratio {damping_ratio}: {found}");
        }
    }

    #[test]
    fn more_damping_makes_longer_ticks_less_stable() {
        for substeps in [4, 8, 16] {
            let limits = [0.05, 0.1, 0.2, 0.4].map(|damping_ratio| largest_phase(damping_ratio, substeps));
            assert!(limits.is_sorted_by(|less, more| less > more), "{limits:?}");
        }
    }

    #[test]
    fn motion_decays_below_limit_grows_above() {
        let limit = largest_phase(0.05, 4);
        let after = |phase: f64| {
            let oscillator = Oscillator { phase, damping_ratio: 0.05 };
            (0..200).fold([1.0, 0.0], |[position, rate], _| oscillator.tick(position, rate, 4))[0].abs()
        };
        assert!(after(0.98 * limit) < 1.0 && after(1.02 * limit) > 1e3);
    }
}
