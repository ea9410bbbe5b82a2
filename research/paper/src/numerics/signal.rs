//! X_sp over whole mesh periods, evenly sampled, and figures derived from it: peak to peak, content outside the mesh frequency, shares of
//! contact.

use std::f64::consts::TAU;

use parameters::ContactState;

use super::integrator::{EventIntegrator, Segment, contact, deflection};
use super::system::StudyError;

/// Samples of one period: extremes between them are missed by less than 1e-4 of the amplitude.
pub const SAMPLES: usize = 256;

/// Shares of time over all meshes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactShares {
    /// Contact on the drive side.
    pub drive_side: f64,
    /// No contact.
    pub separated: f64,
    /// Contact on the back side.
    pub back_side: f64,
}

/// Sun-planet mesh of planet 0 over a whole number of periods, [`SAMPLES`] each.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Time between two samples.
    pub interval: f64,
    /// X_sp.
    pub position: Vec<f64>,
    /// X_sp'.
    pub rate: Vec<f64>,
    /// Contact shares of all meshes.
    pub contact: ContactShares,
}

impl Signal {
    /// Records the next `periods` of a motion.
    pub fn record(motion: &mut EventIntegrator<'_>, periods: u32) -> Result<Self, StudyError> {
        let system = motion.system();
        let interval = system.period() / SAMPLES as f64;
        let mut signal = Self { interval, position: Vec::new(), rate: Vec::new(), contact: ContactShares::default() };
        let mut counts = [0_u64; 3];
        for _ in 0..periods {
            let mut next = 0;
            motion.period_with(|segment: &Segment<'_>| {
                while next < SAMPLES && next as f64 * interval < segment.to {
                    let time = next as f64 * interval;
                    let state = segment.at(time);
                    let (position, rate) = deflection(system, &state, 0, time);
                    signal.position.push(position);
                    signal.rate.push(rate);
                    for mesh in 0..system.meshes() {
                        let state = contact(system, mesh, deflection(system, &state, mesh, time).0);
                        counts[match state {
                            ContactState::DriveSide => 0,
                            ContactState::Separated => 1,
                            ContactState::BackSide => 2,
                        }] += 1;
                    }
                    next += 1;
                }
            })?;
        }
        let all = counts.iter().sum::<u64>().max(1) as f64;
        let [drive_side, separated, back_side] = counts.map(|count| count as f64 / all);
        signal.contact = ContactShares { drive_side, separated, back_side };
        Ok(signal)
    }

    /// Largest less least value.
    pub fn peak_to_peak(&self) -> f64 {
        let extremes = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = self.position.iter().fold(extremes, |(low, high), x| (low.min(*x), high.max(*x)));
        high - low
    }

    /// RMS of the content that is neither mean nor at the mesh frequency, over RMS at the mesh frequency. Exact over whole cycles, whatever
    /// the period.
    pub fn non_fundamental_ratio(&self) -> f64 {
        let count = self.position.len() as f64;
        let mean = self.position.iter().sum::<f64>() / count;
        let (mut sine, mut cosine, mut square) = (0.0, 0.0, 0.0);
        for (index, value) in self.position.iter().enumerate() {
            let phase = TAU * (index % SAMPLES) as f64 / SAMPLES as f64;
            sine += (value - mean) * phase.sin();
            cosine += (value - mean) * phase.cos();
            square += (value - mean) * (value - mean);
        }
        let fundamental = 2.0 * (sine * sine + cosine * cosine) / (count * count);
        ((square / count - fundamental).max(0.0) / fundamental).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Content outside the mesh frequency is related to the content at the mesh frequency.
    #[test]
    fn ratio_of_other_content_is_exact() {
        // Amplitude 2 at the mesh frequency, 1 at a third of it, and a mean.
        let phase = |index: usize| TAU * index as f64 / SAMPLES as f64;
        let position = (0..3 * SAMPLES).map(|i| 4.0 + 2.0 * phase(i).cos() + (phase(i) / 3.0).sin()).collect();
        let signal = Signal { interval: 0.01, position, rate: Vec::new(), contact: ContactShares::default() };
        assert!((signal.non_fundamental_ratio() - 0.5).abs() < 1e-12, "{}", signal.non_fundamental_ratio());
    }
}
