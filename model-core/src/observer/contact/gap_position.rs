//! Contact detection by deflection and mesh force (O10), once the half-gap is known well enough, and the gap coordinate
//! (O8). Symbols: d_t = `deflection`, c = `half_gap`, 1/κ = `stiffness`, g = `weight`, y = `excess`, F_b = `combined_force`.

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
