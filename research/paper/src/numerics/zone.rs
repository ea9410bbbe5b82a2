//! Which branch of the force law a mesh is on, and what comes after it. The branches are those of the two damping laws
//! with the sharp dead zone; when a branch ends is found from its guards by `first_root`.

use parameters::DampingLaw;

use super::system::MeshConstants;

/// A branch on which the force is a linear function of deflection and rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Zone {
    /// No backlash and damping that always acts: there is only one branch.
    Joined,
    /// Within the dead zone.
    Free,
    /// Overlap on a flank that pushes; +1 drive side, -1 back side.
    Push(Side),
    /// Overlap on a flank that parts faster than it can push (law `contact`).
    Slack(Side),
}

/// A flank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Drive,
    Back,
}

/// What a branch leaves of the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Branch {
    /// 1 where the spring is in its line of force.
    pub spring: f64,
    /// 1 where the damper is.
    pub damper: f64,
    /// 1 where that line acts, 0 where it is only watched.
    pub acts: f64,
    /// Taken off the deflection: the overlap is what is left.
    pub offset: f64,
}

/// What happened to a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guard {
    /// The deflection passed +b, whichever way.
    DriveEdge,
    /// The deflection passed -b, whichever way.
    BackEdge,
    /// The line of force passed zero while the teeth overlap.
    NoForce,
}

impl Side {
    pub fn sign(self) -> f64 {
        match self {
            Self::Drive => 1.0,
            Self::Back => -1.0,
        }
    }
}

impl Zone {
    /// The zone of a deflection and its rate, with the stiffness of that moment.
    pub fn of(mesh: &MeshConstants, law: DampingLaw, deflection: f64, rate: f64, stiffness: f64) -> Self {
        if law == DampingLaw::Paper && mesh.half_backlash == 0.0 {
            return Self::Joined;
        }
        let side = match deflection {
            d if d > mesh.half_backlash => Side::Drive,
            d if d < -mesh.half_backlash => Side::Back,
            _ => return Self::Free,
        };
        let overlap = deflection - side.sign() * mesh.half_backlash;
        let pushes = side.sign() * (stiffness * overlap + mesh.damping * rate) > 0.0;
        if law == DampingLaw::Paper || pushes { Self::Push(side) } else { Self::Slack(side) }
    }

    /// The branch of the force that holds here.
    pub fn branch(self, mesh: &MeshConstants, law: DampingLaw) -> Branch {
        match self {
            Self::Joined => Branch { spring: 1.0, damper: 1.0, acts: 1.0, offset: 0.0 },
            Self::Free => {
                let acts = if law == DampingLaw::Paper { 1.0 } else { 0.0 };
                Branch { spring: 0.0, damper: acts, acts, offset: 0.0 }
            }
            Self::Push(side) => {
                Branch { spring: 1.0, damper: 1.0, acts: 1.0, offset: side.sign() * mesh.half_backlash }
            }
            Self::Slack(side) => {
                Branch { spring: 1.0, damper: 1.0, acts: 0.0, offset: side.sign() * mesh.half_backlash }
            }
        }
    }

    /// What is watched here: each guard with the sign under which it stays positive as long as the zone holds.
    pub fn guards(self, law: DampingLaw) -> &'static [(Guard, f64)] {
        use Guard::{BackEdge, DriveEdge, NoForce};
        match (self, law) {
            (Self::Joined, _) => &[],
            (Self::Free, _) => &[(DriveEdge, -1.0), (BackEdge, 1.0)],
            (Self::Push(Side::Drive), DampingLaw::Paper) => &[(DriveEdge, 1.0)],
            (Self::Push(Side::Back), DampingLaw::Paper) => &[(BackEdge, -1.0)],
            // Under `contact` the force always vanishes before the teeth part.
            (Self::Push(Side::Drive), DampingLaw::Contact) => &[(NoForce, 1.0)],
            (Self::Push(Side::Back), DampingLaw::Contact) => &[(NoForce, -1.0)],
            (Self::Slack(Side::Drive), _) => &[(DriveEdge, 1.0), (NoForce, -1.0)],
            (Self::Slack(Side::Back), _) => &[(BackEdge, -1.0), (NoForce, 1.0)],
        }
    }

    /// The zone after one of its guards fell.
    pub fn after(self, guard: Guard) -> Self {
        match (self, guard) {
            (Self::Free, Guard::DriveEdge) => Self::Push(Side::Drive),
            (Self::Free, Guard::BackEdge) => Self::Push(Side::Back),
            (Self::Push(side), Guard::NoForce) => Self::Slack(side),
            (Self::Slack(side), Guard::NoForce) => Self::Push(side),
            _ => Self::Free,
        }
    }
}
