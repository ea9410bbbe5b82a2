//! Branch of the force law of a mesh, and its successor. The branches are those of the two damping laws with the sharp dead zone;
//! `first_root` finds the end of a branch from its guards.

use parameters::DampingLaw;

use super::system::MeshConstants;

/// Branch on which the force is a linear function of deflection and rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Zone {
    /// No backlash and permanent damping: the only branch.
    Joined,
    /// Within the dead zone.
    Free,
    /// Overlap on a pushing flank; +1 drive side, -1 back side.
    Push(Side),
    /// Overlap on a flank that separates faster than it can push (law `contact`).
    Slack(Side),
}

/// A flank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Drive,
    Back,
}

/// Parts of the force law on a branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Branch {
    /// 1 where the force includes the spring.
    pub spring: f64,
    /// 1 where the force includes the damper.
    pub damper: f64,
    /// 1 where the force acts, 0 where it is only monitored.
    pub acts: f64,
    /// Offset subtracted from the deflection, which leaves the overlap.
    pub offset: f64,
}

/// Event of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guard {
    /// The deflection passed +b, in either direction.
    DriveEdge,
    /// The deflection passed -b, in either direction.
    BackEdge,
    /// The force passed zero while the teeth overlap.
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
    /// Zone of a deflection and its rate, with the stiffness at this moment.
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

    /// Branch of the force in this zone.
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

    /// Guards of this zone, each with the sign under which it stays positive as long as the zone holds.
    pub fn guards(self, law: DampingLaw) -> &'static [(Guard, f64)] {
        use Guard::{BackEdge, DriveEdge, NoForce};
        match (self, law) {
            (Self::Joined, _) => &[],
            (Self::Free, _) => &[(DriveEdge, -1.0), (BackEdge, 1.0)],
            (Self::Push(Side::Drive), DampingLaw::Paper) => &[(DriveEdge, 1.0)],
            (Self::Push(Side::Back), DampingLaw::Paper) => &[(BackEdge, -1.0)],
            // With the law `contact` the force always vanishes before the teeth separate.
            (Self::Push(Side::Drive), DampingLaw::Contact) => &[(NoForce, 1.0)],
            (Self::Push(Side::Back), DampingLaw::Contact) => &[(NoForce, -1.0)],
            (Self::Slack(Side::Drive), _) => &[(DriveEdge, 1.0), (NoForce, -1.0)],
            (Self::Slack(Side::Back), _) => &[(BackEdge, -1.0), (NoForce, 1.0)],
        }
    }

    /// Zone after one of its guards fell.
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
