//! Contact by deflection and mesh force together, once the half-gap is known well enough.

use super::by_force::with_hysteresis;
use crate::gears::Flank;
use crate::numbers::Real;

/// Where the deflection is in the gap, and what weighs it against the force.
#[derive(Debug, Clone, Copy)]
pub struct ByPosition<T: Real> {
    /// Deflection less the transmission error, with the wind-up still in it [m].
    pub deflection: T,
    /// How far it goes on while what is measured lags behind; zero where that is within noise [m].
    pub travel: T,
    /// Half-gap [m].
    pub half_gap: T,
    /// Distance from an edge of the gap that noise and what is not learnt yet can make [m].
    pub blur: T,
    /// Distance from an edge within which light contact is taken for granted [m].
    pub near: T,
    /// 1 over the compliance [N/m].
    pub stiffness: T,
    /// Weight of the deflection in the mesh force, beside the motor side's force [-].
    pub weight: T,
}

impl<T: Real> ByPosition<T> {
    /// The flank that touches and the mesh force [N], from the motor side's force and the standard deviation of both
    /// together [N].
    pub fn contact(&self, before: Option<Flank>, force: T, deviation: T) -> (Option<Flank>, T) {
        let (contact, both, _) = self.all(before, force, deviation);
        (contact, both)
    }

    /// The same for a controller: teeth that rest within noise of a flank are reported as touching it, however light
    /// their force, unless it pulls them off. Nothing can be learnt from that, but nothing would be done otherwise. Teeth
    /// that come across the gap and have not settled yet may touch as soon as they are `near`, and again when they bounce:
    /// then it takes a force of the motor side's, whose standard deviation is `alone`, to say that they do not.
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
            // Fast ones are there in a moment: that is seen as soon as it happens.
            self.travel == T::ZERO && beyond > -self.near && off(force) < alone
        };
        (rests.then_some(nearer), both)
    }

    /// Contact, force, and deflection beyond the nearer edge.
    fn all(&self, before: Option<Flank>, force: T, deviation: T) -> (Option<Flank>, T, T) {
        let beyond = self.deflection.abs() - self.half_gap;
        let nearer = self.nearer();
        let (bent, travel) = if nearer == Flank::Drive { (beyond, self.travel) } else { (-beyond, -self.travel) };
        let both = force + self.weight * (bent * self.stiffness - force);
        // Teeth about to meet count as met: what is measured lags behind them by that much.
        let lands = travel > T::ZERO && beyond + travel > T::ZERO;
        let contact = if lands && before.is_none_or(|before| before == nearer) {
            Some(nearer)
        } else if beyond < -self.blur {
            None
        } else {
            // Whatever the force: teeth at one flank do not touch the other.
            with_hysteresis(before, both, T::TWO * deviation, deviation).filter(|felt| *felt == nearer)
        };
        (contact, both, beyond)
    }

    /// The nearer flank; the back flank in the very middle.
    fn nearer(&self) -> Flank {
        if self.deflection > T::ZERO { Flank::Drive } else { Flank::Back }
    }

    /// Gap coordinate less the transmission error, with the wind-up taken out: beyond an edge only the part of the
    /// compliance is left that the meshes have [m]. Needs no force.
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
