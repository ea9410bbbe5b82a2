//! Which flank touches: from the mesh force alone, with hysteresis and persistence, and from force and gap coordinate
//! together. What is made of it is left to the observer.

use super::motion::magnitude;
use crate::numbers::Real;
use parameters::ContactState;

/// Periods for which the force must say the same before contact by force follows it.
const PERSISTENCE: u8 = 3;

/// Contact by force alone.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ByForce {
    pub state: ContactState,
    wanted: ContactState,
    held: u8,
}

impl ByForce {
    /// `deviation` is the standard deviation of the force; it takes two of it to make contact and one to keep it.
    pub fn step<T: Real>(&mut self, force: T, deviation: T) -> ContactState {
        let wanted = with_hysteresis(self.state, force, T::TWO * deviation, deviation);
        self.held = if wanted == self.wanted { self.held.saturating_add(1) } else { 1 };
        self.wanted = wanted;
        if self.held >= PERSISTENCE {
            self.state = wanted;
        }
        self.state
    }
}

/// Contact with force `on` makes, `off` keeps.
pub(super) fn with_hysteresis<T: Real>(state: ContactState, force: T, on: T, off: T) -> ContactState {
    let drive = if state == ContactState::DriveSide { off } else { on };
    let back = if state == ContactState::BackSide { off } else { on };
    if force > drive {
        ContactState::DriveSide
    } else if -force > back {
        ContactState::BackSide
    } else {
        ContactState::Separated
    }
}

/// What the position says of the teeth, once the width is known well enough.
#[derive(Debug, Clone, Copy)]
pub(super) struct ByPosition<T: Real> {
    /// Gap coordinate less the transmission error, with the wind-up still in it [m].
    pub way: T,
    /// How far it goes on while what is measured lags behind; zero where that is within noise [m].
    pub soon: T,
    /// Half-gap [m].
    pub half_gap: T,
    /// Distance from an edge that noise and ignorance can make [m].
    pub blur: T,
    /// Distance from an edge within which light contact is taken for granted [m].
    pub near: T,
    /// 1 over the compliance [N/m].
    pub stiffness: T,
    /// Weight of the position in the force beside the motor side's.
    pub weight: T,
}

impl<T: Real> ByPosition<T> {
    /// Contact and mesh force, from the motor side's force and the standard deviation of both together.
    pub fn contact(&self, before: ContactState, force: T, deviation: T) -> (ContactState, T) {
        let (contact, both, _) = self.all(before, force, deviation);
        (contact, both)
    }

    /// The same for a controller: teeth that rest within noise of a flank are reported as touching it, however light
    /// their force, unless it pulls them off. Nothing can be learnt from that, but nothing would be done otherwise. Teeth
    /// that come across the gap and have not settled yet may touch as soon as they are `near`, and again when they bounce:
    /// then it takes a force of the motor side's, whose standard deviation is `alone`, to say that they do not.
    pub fn reported(
        &self,
        before: ContactState,
        force: T,
        [alone, deviation]: [T; 2],
        settled: bool,
    ) -> (ContactState, T) {
        let (contact, both, beyond) = self.all(before, force, deviation);
        if contact != ContactState::Separated {
            return (contact, both);
        }
        let drives = self.way > T::ZERO;
        let off = |force: T| if drives { -force } else { force };
        let rests = if settled {
            beyond > -self.blur && off(both) < deviation
        } else {
            // Fast ones are there in a moment: that is seen as soon as it happens.
            self.soon == T::ZERO && beyond > -self.near && off(force) < alone
        };
        (if rests { flank(drives) } else { contact }, both)
    }

    /// Contact, force, and way beyond the nearer edge.
    fn all(&self, before: ContactState, force: T, deviation: T) -> (ContactState, T, T) {
        let beyond = magnitude(self.way) - self.half_gap;
        let drives = self.way > T::ZERO;
        let (bent, soon) = if drives { (beyond, self.soon) } else { (-beyond, -self.soon) };
        let both = force + self.weight * (bent * self.stiffness - force);
        // Teeth about to meet count as met: what is measured lags behind them by that much.
        let lands = soon > T::ZERO && beyond + soon > T::ZERO;
        let contact = if lands && (before == flank(drives) || before == ContactState::Separated) {
            flank(drives)
        } else if beyond < -self.blur {
            ContactState::Separated
        } else {
            // Whatever the force: teeth at one flank do not touch the other.
            let felt = with_hysteresis(before, both, T::TWO * deviation, deviation);
            if felt == flank(drives) { felt } else { ContactState::Separated }
        };
        (contact, both, beyond)
    }

    /// Gap coordinate less the transmission error, with the wind-up taken out: beyond an edge only the part of the
    /// compliance is left that the meshes have. Needs no force.
    pub fn gap(&self, mesh_share: T) -> T {
        let beyond = magnitude(self.way) - self.half_gap;
        if beyond < T::ZERO {
            self.way
        } else {
            let gap = self.half_gap + mesh_share * beyond;
            if self.way > T::ZERO { gap } else { -gap }
        }
    }
}

/// The flank on a side.
fn flank(drives: bool) -> ContactState {
    if drives { ContactState::DriveSide } else { ContactState::BackSide }
}

/// Contact on a side: 1, -1, or 0 for none.
pub(super) fn on<T: Real>(side: T) -> ContactState {
    if side > T::ZERO {
        ContactState::DriveSide
    } else if side < T::ZERO {
        ContactState::BackSide
    } else {
        ContactState::Separated
    }
}

/// Sign of a contact: 1, 0 or -1.
pub(super) fn sign<T: Real>(contact: ContactState) -> T {
    match contact {
        ContactState::DriveSide => T::ONE,
        ContactState::Separated => T::ZERO,
        ContactState::BackSide => -T::ONE,
    }
}
