//! Contact detection by deflection and mesh force (O10), once the half-gap is known well enough, and the gap coordinate
//! (O8). Symbols: d_t = `deflection`, c = `half_gap`, 1/κ = `stiffness`, g = `weight`, y = `beyond`, F_b = `both`.

use super::by_force::with_hysteresis;
use crate::gears::Flank;
use crate::numbers::Real;

/// Deflection within the gap and its thresholds.
#[derive(Debug, Clone, Copy)]
pub struct ByPosition<T: Real> {
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

impl<T: Real> ByPosition<T> {
    /// Returns flank in contact and combined mesh force [N], from the motor side's force and the standard deviation of
    /// the combined force [N].
    pub fn contact(&self, before: Option<Flank>, force: T, deviation: T) -> (Option<Flank>, T) {
        let (contact, both, _) = self.all(before, force, deviation);
        (contact, both)
    }

    /// Returns contact and mesh force for a controller. Teeth at rest within noise of a flank are reported as touching,
    /// however light the force, unless the force pulls the teeth off: a controller could not act otherwise, and no
    /// parameter is estimated from this contact. Teeth that have crossed the gap and have not settled are reported as
    /// touching within `near` of the flank, also when bouncing, unless the motor side's force, with the standard
    /// deviation `alone`, pulls the teeth off.
    pub fn reported(
        &self,
        before: Option<Flank>,
        force: T,
        [alone, deviation]: [T; 2],
        settled: bool,
    ) -> (Option<Flank>, T) {
        let (contact, both, beyond) = self.all(before, force, deviation);
        if contact.is_some() {
            return (contact, both);
        }
        let nearer = self.nearer();
        let off = |force: T| if nearer == Flank::Drive { -force } else { force };
        let rests = if settled {
            beyond > -self.blur && off(both) < deviation
        } else {
            // Fast teeth (`travel` not zero) are excluded: `travel` predicts their landing.
            self.travel == T::ZERO && beyond > -self.near && off(force) < alone
        };
        (rests.then_some(nearer), both)
    }

    /// Returns contact, combined force, and deflection beyond the nearer edge.
    fn all(&self, before: Option<Flank>, force: T, deviation: T) -> (Option<Flank>, T, T) {
        let beyond = self.deflection.abs() - self.half_gap;
        let nearer = self.nearer();
        let (bent, travel) = if nearer == Flank::Drive { (beyond, self.travel) } else { (-beyond, -self.travel) };
        let both = force + self.weight * (bent * self.stiffness - force);
        // Teeth that reach an edge within the measurement lag count as touching.
        let lands = travel > T::ZERO && beyond + travel > T::ZERO;
        let contact = if lands && before.is_none_or(|before| before == nearer) {
            Some(nearer)
        } else if beyond < -self.blur {
            None
        } else {
            // Teeth at one flank cannot touch the other, whatever the sign of the force.
            with_hysteresis(before, both, T::TWO * deviation, deviation).filter(|felt| *felt == nearer)
        };
        (contact, both, beyond)
    }

    /// Returns the nearer flank; the back flank at exactly zero deflection.
    fn nearer(&self) -> Flank {
        if self.deflection > T::ZERO { Flank::Drive } else { Flank::Back }
    }

    /// Gap coordinate without the transmission error (O8): beyond an edge only the meshes' share of the compliance
    /// remains [m]. Independent of the force.
    pub fn gap(&self, mesh_share: T) -> T {
        let beyond = self.deflection.abs() - self.half_gap;
        if beyond < T::ZERO {
            self.deflection
        } else {
            let gap = self.half_gap + mesh_share * beyond;
            if self.deflection > T::ZERO { gap } else { -gap }
        }
    }
}
