//! Reduction of the gap by errors of the teeth. Planets whose meshes are out of phase do not touch at once: with errors
//! e_i of the sun's and ring's mesh together, the foremost planet carries first and the others after it deflects. Under
//! little torque half of the gap is therefore smaller than cut, by the mean over a mesh period of the foremost planet's
//! lead, and grows back with the torque:
//!
//! ```text
//! sum over planets of max(0, w - t_i) = F,   t_i = o_i + e_i,   F = T (1/K_sp + 1/K_rp) / (2 r_c cos(alpha))
//! ```
//!
//! w is the deflection of sun's and ring's mesh of a planet beyond the mean gap, o_i the excess of the planet's gap
//! over the mean gap, and T the torque on the joint. With even sharing w is F / n. The reduction is half of F / n - w
//! over the lever r_c cos(alpha).

use std::f64::consts::TAU;

use model_core::gears::{Kinematics, MeshPhasing};
use parameters::{JointParameters, MESH_KINDS};

/// Points per mesh period of the mean.
const PHASES_PER_PERIOD: usize = 24;
/// Standard deviation of the stated tooth errors: this share of the error, ...
const ERROR_DEVIATION_SHARE: f64 = 0.5;
/// ... at least this [m].
const ERROR_DEVIATION_MIN: f64 = 1e-6;
/// Reductions below this are neglected [m].
const REDUCTION_MIN: f64 = 1e-9;

/// Load sharing of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadSharing {
    /// Lever r_c cos(alpha) [m].
    lever: f64,
    /// Compliance of both meshes of a planet [m/N].
    compliance: f64,
    /// Thresholds t_i at each point of the mesh period, ascending [m].
    as_stated: Vec<Vec<f64>>,
    /// Thresholds for errors one standard deviation larger [m].
    with_excess: Vec<Vec<f64>>,
}

impl LoadSharing {
    /// Load sharing for these mesh stiffnesses; `None` if all planets touch at once.
    pub fn new(joint: &JointParameters, stiffnesses: [f64; 2]) -> Option<Self> {
        let planets = joint.geometry.planets;
        let gap = |planet: usize| MESH_KINDS.iter().map(|kind| joint.mesh(*kind).half_backlash[planet]).sum::<f64>();
        let mean = (0..planets).map(gap).sum::<f64>() / planets as f64;
        let thresholds = |more: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> {
            let at = |place: usize| {
                let phase = TAU * place as f64 / PHASES_PER_PERIOD as f64;
                let error = |planet: usize| -> f64 {
                    let of = |kind| {
                        more(joint.mesh(kind).transmission_error[planet])
                            * (phase + joint.error_phase(kind, planet)).sin()
                    };
                    MESH_KINDS.into_iter().map(of).sum()
                };
                let mut all: Vec<f64> = (0..planets).map(|planet| gap(planet) - mean + error(planet)).collect();
                all.sort_by(f64::total_cmp);
                all
            };
            (0..PHASES_PER_PERIOD).map(at).collect()
        };
        let more = |error: f64| error + (ERROR_DEVIATION_SHARE * error.abs()).max(ERROR_DEVIATION_MIN);
        let sharing = Self {
            lever: joint.geometry.carrier_base_radius(),
            compliance: stiffnesses.iter().map(|stiffness| stiffness.recip()).sum(),
            as_stated: thresholds(&|error| error),
            with_excess: thresholds(&more),
        };
        (sharing.lever * sharing.reduction(0.0).max(sharing.excess_reduction(0.0)) > REDUCTION_MIN).then_some(sharing)
    }

    /// Reduction of half of the lost motion under a torque of either sign [rad].
    pub fn reduction(&self, torque: f64) -> f64 {
        self.mean(&self.as_stated, torque)
    }

    /// Growth of the reduction if the tooth errors are larger by one standard deviation [rad].
    pub fn excess_reduction(&self, torque: f64) -> f64 {
        self.mean(&self.with_excess, torque) - self.reduction(torque)
    }

    fn mean(&self, thresholds: &[Vec<f64>], torque: f64) -> f64 {
        let force = torque.abs() * self.compliance / (2.0 * self.lever);
        let deficit = |thresholds: &Vec<f64>| force / thresholds.len() as f64 - deflection(thresholds, force);
        0.5 * thresholds.iter().map(deficit).sum::<f64>() / (thresholds.len() as f64 * self.lever)
    }
}

/// Solves sum of max(0, w - t) = force for w; the thresholds ascend.
fn deflection(thresholds: &[f64], force: f64) -> f64 {
    let mut sum = force;
    for (before, threshold) in thresholds.iter().enumerate() {
        if before > 0 && sum / before as f64 <= *threshold {
            return sum / before as f64;
        }
        sum += threshold;
    }
    sum / thresholds.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(changes: &[(&str, &str)]) -> JointParameters {
        let q1 = joint_file::preset("q1").expect("a preset").to_owned();
        let changed =
            changes.iter().fold(q1, |text, (key, value)| joint_file::change(&text, key, value).expect("a key"));
        joint_file::read(&changed).expect("a joint").parameters
    }

    /// Planets that touch one after the other act as springs with thresholds.
    #[test]
    fn deflection_of_successive_planets() {
        let thresholds = [-2.0, 1.0, 4.0];
        for (force, expected) in [(0.0, -2.0), (1.0, -1.0), (3.0, 1.0), (5.0, 2.0), (9.0, 4.0), (12.0, 5.0)] {
            assert!((deflection(&thresholds, force) - expected).abs() < 1e-12, "{force}");
        }
    }

    /// Planets in phase reduce no gap; out of phase the reduction falls with the load.
    #[test]
    fn gap_reduction_falls_with_load() {
        assert_eq!(LoadSharing::new(&joint(&[]), [1e8; 2]), None, "75 teeth on three planets");
        let four = [("planets", "4"), ("sun_teeth", "22"), ("planet_teeth", "34"), ("ring_teeth", "90")];
        let sharing = LoadSharing::new(&joint(&four), [1e8; 2]).expect("out of phase by a half");
        // Two planets against two: mean of |sin| over the sun's and ring's mesh together.
        let expected = 3e-6 * 2.0 / std::f64::consts::PI;
        let found = sharing.reduction(0.0) * sharing.lever;
        assert!((found / expected - 1.0).abs() < 0.01, "{found}");
        assert!(sharing.reduction(5.0) < 0.9 * sharing.reduction(0.0) && sharing.reduction(1e4) < 1e-9);
        assert!((sharing.excess_reduction(0.0) / sharing.reduction(0.0) - 0.5).abs() < 1e-9);
    }
}
