//! Dry friction with presliding: the LuGre model (C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of
//! systems with friction", IEEE Transactions on Automatic Control 40(3), 1995).
//!
//! The bristles of a shaft at speed v have the deflection z. With the dry friction g(v) of the law without presliding,
//! including Stribeck rise and load-dependent losses,
//!
//! ```text
//! z' = v - sigma_0 |v| z / g(v)   (L1)
//! friction = sigma_0 z + sigma_1 z' + viscous v   (L2)
//! ```
//!
//! sigma_0 = F_c / d, with the dry friction at speed F_c and the stated displacement d. In steady motion sigma_0 z =
//! g(v), so that the friction at speed equals that of the law without presliding. sigma_1 = 2 zeta sqrt(sigma_0 J)
//! damps the shaft's inertia J on its bristles with zeta = 0.5 (assumed; no data sheet states it). sigma_1 |v| is
//! limited to g(v), which keeps the friction passive and below 3 g(v) (H. Olsson, "Control systems with friction", Lund
//! 1996).
//!
//! Within a part of a period v is constant: (L1) is solved exactly, and (L2) is averaged over the part.
//!
//! Equations: (R4) in docs/theory/real-joints.md.

use parameters::Friction;

use super::friction::{Shaft, dry_friction};

/// Damping ratio of a shaft on its bristles [-]. Assumed.
const DAMPING_RATIO: f64 = 0.5;

/// Longest part of a period relative to sqrt(J / sigma_0) for which a constant speed is accurate enough.
const LONGEST_PART: f64 = 0.3;

/// Bristles of one shaft.
#[derive(Debug, Clone)]
pub(super) struct Bristles {
    /// sigma_0 [N m/rad].
    stiffness: f64,
    /// sigma_1 [N m s/rad].
    damping: f64,
    /// z [rad].
    deflection: f64,
}

impl Bristles {
    /// Returns the bristles of a shaft with dry friction and presliding, else `None`.
    pub fn new(friction: &Friction, presliding: f64, inertia: f64) -> Option<Self> {
        (presliding > 0.0 && friction.coulomb > 0.0).then(|| {
            let stiffness = friction.coulomb / presliding;
            Self { stiffness, damping: 2.0 * DAMPING_RATIO * (stiffness * inertia).sqrt(), deflection: 0.0 }
        })
    }

    /// Smallest presliding displacement that parts of this length can follow [rad].
    pub fn least_presliding(friction: &Friction, inertia: f64, part: f64) -> f64 {
        friction.coulomb * part * part / (inertia * LONGEST_PART * LONGEST_PART)
    }

    /// Returns the mean torque against the motion over the part [N m]; advances the bristles.
    pub fn friction(&mut self, shaft: &Shaft, friction: &Friction, extra: f64) -> f64 {
        let (speed, part) = (shaft.speed, shaft.part);
        let viscous = friction.viscous * speed;
        let dry = dry_friction(friction, speed) + extra;
        if dry <= 0.0 {
            self.deflection = 0.0;
            return viscous;
        }
        // Travel of the shaft relative to the bristles' relaxation length g / sigma_0.
        let lengths = self.stiffness * speed.abs() * part / dry;
        let before = self.deflection;
        if lengths < 1e-12 {
            self.deflection += speed * part;
            return viscous + self.stiffness * 0.5 * (before + self.deflection) + self.damping * speed;
        }
        let end = dry.copysign(speed) / self.stiffness;
        let gone = -(-lengths).exp_m1();
        self.deflection = before + (end - before) * gone;
        let mean = end + (before - end) * gone / lengths;
        let damping = self.damping.min(dry / speed.abs());
        viscous + self.stiffness * mean + damping * (self.deflection - before) / part
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const PART: f64 = 1e-5;
    const INERTIA: f64 = 0.15;
    const PRESLIDING: f64 = 0.2e-3;

    fn coulomb() -> Friction {
        Friction { coulomb: 0.3, ..Friction::default() }
    }

    fn bristles(friction: &Friction) -> Bristles {
        Bristles::new(friction, PRESLIDING, INERTIA).expect("there are bristles")
    }

    fn shaft(speed: f64) -> Shaft {
        Shaft { speed, driving_torque: 0.0, inertia: INERTIA, part: PART }
    }

    /// Integrates (L1) and (L2) by Heun's method with a hundredth of the part; speeds are linear between parts.
    fn integrated(friction: &Friction, speeds: impl Fn(f64) -> f64, parts: u32) -> Vec<f64> {
        let stiffness = friction.coulomb / PRESLIDING;
        let sigma = 2.0 * 0.5 * (stiffness * INERTIA).sqrt();
        let rate = |v: f64, z: f64| {
            let rise = friction.stribeck_rise_ratio * (-v.abs() / friction.stribeck_speed.max(1e-9)).exp();
            v - stiffness * v.abs() * z / (friction.coulomb * (1.0 + rise))
        };
        let (mut z, step) = (0.0, PART / 100.0);
        let one = |part: u32| {
            let mut sum = 0.0;
            for index in 0..100 {
                let time = f64::from(part) * PART + f64::from(index) * step;
                let (v, next) = (speeds(time), speeds(time + step));
                let first = rate(v, z);
                let second = rate(next, z + step * first);
                let mean = 0.5 * (first + second);
                sum += stiffness * (z + 0.5 * step * mean) + sigma * mean + friction.viscous * 0.5 * (v + next);
                z += step * mean;
            }
            sum / 100.0
        };
        (0..parts).map(one).collect()
    }

    #[test]
    fn friction_matches_independent_integration() {
        let friction = Friction { coulomb: 0.3, viscous: 0.1, stribeck_rise_ratio: 0.2, stribeck_speed: 0.05 };
        // Slow enough that sigma_1 is never limited, far enough to break away.
        let speed = |time: f64| 0.001 * TAU * 2.0 * (TAU * 2.0 * time).cos();
        let expected = integrated(&friction, speed, 50_000);
        let mut bristles = bristles(&friction);
        let mut worst = 0.0_f64;
        for (part, expected) in expected.into_iter().enumerate() {
            let found = bristles.friction(&shaft(speed((part as f64 + 0.5) * PART)), &friction, 0.0);
            worst = worst.max((found - expected).abs());
        }
        assert!(worst < 2e-4 * 0.36, "{worst} N m apart");
    }

    #[test]
    fn slow_cycle_loses_presliding_energy() {
        let friction = coulomb();
        for amplitude in [0.1e-3, 0.3e-3, 2e-3] {
            let mut bristles = bristles(&friction);
            // Two cycles of 20 s: the first leads into the loop.
            let (mut loss, rate, part) = (0.0, TAU * 0.05, 1e-4);
            for index in 0..400_000_u32 {
                let speed = amplitude * rate * (rate * (f64::from(index) + 0.5) * part).cos();
                let torque = bristles.friction(&Shaft { part, ..shaft(speed) }, &friction, 0.0);
                loss += if index >= 200_000 { torque * speed * part } else { 0.0 };
            }
            let carried = amplitude - PRESLIDING * (amplitude / PRESLIDING).tanh();
            let expected = 4.0 * friction.coulomb * carried;
            // The bristles' damper loses a little, too.
            assert!((0.999..1.02).contains(&(loss / expected)), "{amplitude} rad: {loss} J for {expected} J");
        }
    }

    #[test]
    fn small_displacement_has_presliding_stiffness() {
        let friction = coulomb();
        let mut bristles = bristles(&friction);
        let torque = (0..1000).map(|_| bristles.friction(&shaft(1e-4), &friction, 0.0)).last().expect("some");
        // 1 urad at 1e-4 rad/s, and the damper.
        let damper = (friction.coulomb / PRESLIDING * INERTIA).sqrt() * 1e-4;
        assert!(((torque - damper) / (friction.coulomb / PRESLIDING * 1e-6) - 1.0).abs() < 0.01, "{torque} N m");
    }

    #[test]
    fn fast_reversal_stays_below_triple_friction() {
        let friction = coulomb();
        let mut bristles = bristles(&friction);
        for part in 0..1000 {
            let speed = if part / 100 % 2 == 0 { 100.0 } else { -100.0 };
            let torque = bristles.friction(&shaft(speed), &friction, 0.0);
            assert!(torque.abs() <= 3.0 * 0.3 + 1e-12, "{torque} N m");
        }
    }

    #[test]
    fn no_bristles_without_dry_friction() {
        assert!(Bristles::new(&Friction::default(), PRESLIDING, INERTIA).is_none());
        assert!(Bristles::new(&coulomb(), 0.0, INERTIA).is_none());
    }
}
