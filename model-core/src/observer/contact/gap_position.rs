//! Contact detection by deflection and mesh force, once the half-gap is known well enough, and the gap coordinate:
//!
//! ```text
//! (O8)  X = d_t  for |d_t| < c;   X = sign(d_t) (c + (κ_m/κ) (|d_t| - c))  beyond an edge
//! (O10) y = |d_t| - c,   F_b = F + g (side y/κ - F)
//! ```
//!
//! Symbols: d_t = `deflection`, c = `half_gap`, κ_m/κ = `mesh_share`, y = `excess`, F = `force`, F_b =
//! `combined_force`, g = `weight`, 1/κ = `stiffness`. X is `gap_coordinate` without the transmission error.

use super::force_contact::with_hysteresis;
use crate::gears::Flank;
use crate::numbers::Real;

/// Deflection within the gap and its thresholds.
#[derive(Debug, Clone, Copy)]
pub struct GapPosition<T: Real> {
    /// Deflection d_t without the transmission error, wind-up included [m].
    pub deflection: T,
    /// Travel of the deflection within the measurement lag; zero if the rate is within noise [m].
    pub travel: T,
    /// Half-gap c [m].
    pub half_gap: T,
    /// Deviation of the deflection from an edge by noise and parameter errors: two standard deviations [m].
    pub blur: T,
    /// Distance from an edge within which a light contact is assumed [m].
    pub near: T,
    /// Stiffness, 1 over the compliance [N/m].
    pub stiffness: T,
    /// Weight of the deflection in the combined mesh force; the motor side's force has the rest [-].
    pub weight: T,
}

impl<T: Real> GapPosition<T> {
    /// Returns flank in contact and combined mesh force [N], from the motor side's force and the standard deviation of
    /// the combined force [N].
    pub fn contact(&self, before: Option<Flank>, force: T, deviation: T) -> (Option<Flank>, T) {
        let (contact, combined_force, _) = self.detect(before, force, deviation);
        (contact, combined_force)
    }

    /// Returns contact and mesh force for a controller. Teeth at rest within noise of a flank are reported as touching,
    /// however light the force, unless the force pulls the teeth off: a controller could not act otherwise, and no
    /// parameter is estimated from this contact. Teeth that have crossed the gap and have not settled are reported as
    /// touching within `near` of the flank, also when bouncing, unless the motor side's force, with the standard
    /// deviation `motor_side_deviation`, pulls the teeth off.
    pub fn reported_contact(
        &self,
        before: Option<Flank>,
        force: T,
        [motor_side_deviation, deviation]: [T; 2],
        settled: bool,
    ) -> (Option<Flank>, T) {
        let (contact, combined_force, excess) = self.detect(before, force, deviation);
        if contact.is_some() {
            return (contact, combined_force);
        }
        let nearer_flank = self.nearer_flank();
        let pull_off = |force: T| if nearer_flank == Flank::Drive { -force } else { force };
        let is_touching = if settled {
            excess > -self.blur && pull_off(combined_force) < deviation
        } else {
            // Fast teeth (`travel` not zero) are excluded: `travel` predicts their landing.
            self.travel == T::ZERO && excess > -self.near && pull_off(force) < motor_side_deviation
        };
        (is_touching.then_some(nearer_flank), combined_force)
    }

    /// Returns contact, combined force, and deflection beyond the nearer edge.
    fn detect(&self, before: Option<Flank>, force: T, deviation: T) -> (Option<Flank>, T, T) {
        let excess = self.deflection.abs() - self.half_gap;
        let nearer_flank = self.nearer_flank();
        let (signed_excess, travel) =
            if nearer_flank == Flank::Drive { (excess, self.travel) } else { (-excess, -self.travel) };
        let combined_force = force + self.weight * (signed_excess * self.stiffness - force);
        // Teeth that reach an edge within the measurement lag count as touching.
        let is_landing = travel > T::ZERO && excess + travel > T::ZERO;
        let contact = if is_landing && before.is_none_or(|before| before == nearer_flank) {
            Some(nearer_flank)
        } else if excess < -self.blur {
            None
        } else {
            // Teeth at one flank cannot touch the other, whatever the sign of the force.
            with_hysteresis(before, combined_force, T::TWO * deviation, deviation).filter(|felt| *felt == nearer_flank)
        };
        (contact, combined_force, excess)
    }

    /// Returns the nearer flank; the back flank at exactly zero deflection.
    fn nearer_flank(&self) -> Flank {
        if self.deflection > T::ZERO { Flank::Drive } else { Flank::Back }
    }

    /// Gap coordinate without the transmission error (O8): beyond an edge only the meshes' share of the compliance
    /// remains [m]. Independent of the force.
    pub fn gap_coordinate(&self, mesh_share: T) -> T {
        let excess = self.deflection.abs() - self.half_gap;
        if excess < T::ZERO {
            self.deflection
        } else {
            let gap_coordinate = self.half_gap + mesh_share * excess;
            if self.deflection > T::ZERO { gap_coordinate } else { -gap_coordinate }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRIVE: Option<Flank> = Some(Flank::Drive);
    const BACK: Option<Flank> = Some(Flank::Back);

    /// Teeth at rest at a deflection [um] in a gap of 2 x 80 um, with a blur of 10 um; only the motor side gives force.
    fn at(deflection: f32) -> GapPosition<f32> {
        GapPosition {
            deflection: deflection * 1e-6,
            travel: 0.0,
            half_gap: 80e-6,
            blur: 10e-6,
            near: 4e-6,
            stiffness: 5e6,
            weight: 0.0,
        }
    }

    #[test]
    fn teeth_inside_gap_touch_nothing() {
        assert_eq!(at(69.0).contact(None, 100.0, 1.0).0, None);
        assert_eq!(at(-69.0).contact(BACK, -100.0, 1.0).0, None);
    }

    #[test]
    fn teeth_within_blur_touch_under_force() {
        assert_eq!(at(71.0).contact(None, 2.1, 1.0).0, DRIVE);
        assert_eq!(at(71.0).contact(None, 1.9, 1.0).0, None);
        assert_eq!(at(-71.0).contact(None, -2.1, 1.0).0, BACK);
    }

    #[test]
    fn force_of_far_flank_is_ignored() {
        assert_eq!(at(85.0).contact(None, -100.0, 1.0).0, None);
    }

    #[test]
    fn teeth_that_land_within_lag_touch() {
        let landing = GapPosition { travel: 20e-6, ..at(65.0) };
        assert_eq!(landing.contact(None, 0.0, 1.0).0, DRIVE);
        assert_eq!(GapPosition { travel: 10e-6, ..landing }.contact(None, 0.0, 1.0).0, None);
        assert_eq!(GapPosition { travel: -20e-6, ..landing }.contact(None, 0.0, 1.0).0, None);
    }

    #[test]
    fn landing_does_not_replace_other_flank() {
        let landing = GapPosition { travel: 20e-6, ..at(65.0) };
        assert_eq!(landing.contact(BACK, 0.0, 1.0).0, None);
        assert_eq!(landing.contact(DRIVE, 0.0, 1.0).0, DRIVE);
    }

    #[test]
    fn combined_force_follows_weight() {
        let wound_up = at(100.0);
        let (_, force) = wound_up.contact(None, 40.0, 1.0);
        assert_eq!(force, 40.0);
        let (_, force) = GapPosition { weight: 1.0, ..wound_up }.contact(None, 40.0, 1.0);
        assert!((force - 100.0).abs() < 0.01, "20 um of 5 N/um: {force}");
        let (_, force) = GapPosition { weight: 1.0, ..at(-100.0) }.contact(None, -40.0, 1.0);
        assert!((force + 100.0).abs() < 0.01, "{force}");
    }

    #[test]
    fn settled_teeth_near_flank_are_reported() {
        assert_eq!(at(75.0).reported_contact(None, 0.0, [1.0; 2], true).0, DRIVE);
        assert_eq!(at(69.0).reported_contact(None, 0.0, [1.0; 2], true).0, None);
        assert_eq!(at(75.0).reported_contact(None, -1.1, [1.0; 2], true).0, None, "pulled off");
        assert_eq!(at(-75.0).reported_contact(None, 1.1, [1.0; 2], true).0, None, "pulled off");
    }

    #[test]
    fn bouncing_teeth_are_reported_within_near() {
        assert_eq!(at(77.0).reported_contact(None, 0.0, [1.0; 2], false).0, DRIVE);
        assert_eq!(at(75.0).reported_contact(None, 0.0, [1.0; 2], false).0, None);
        let leaving = GapPosition { travel: -1e-6, ..at(77.0) };
        assert_eq!(leaving.reported_contact(None, 0.0, [1.0; 2], false).0, None);
    }

    #[test]
    fn gap_coordinate_leaves_wind_up_out() {
        assert_eq!(at(50.0).gap_coordinate(0.1), 50e-6);
        assert!((at(100.0).gap_coordinate(0.1) - 82e-6).abs() < 1e-10);
        assert!((at(-100.0).gap_coordinate(0.1) + 82e-6).abs() < 1e-10);
    }

    #[test]
    fn deflection_of_nan_is_no_contact() {
        assert_eq!(at(f32::NAN).contact(None, 0.0, 1.0).0, None);
        assert_eq!(at(f32::NAN).reported_contact(DRIVE, 0.0, [1.0; 2], true).0, None);
    }
}
