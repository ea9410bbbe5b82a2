//! The two flanks of a tooth gap, and the sign that each has in the equations.

use parameters::ContactState;

use crate::numbers::Real;

/// A flank of the teeth. Where none touches, or where it is not known which, there is no `Flank`: `None`. Numbered as
/// [`ContactState`] is, so that one becomes the other without a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flank {
    /// The motor drives the load forwards: deflection, force and torque are positive.
    Drive = 1,
    /// The other one: they are negative.
    Back = 2,
}

impl Flank {
    /// The flank that a contact state names.
    pub fn touched(contact: ContactState) -> Option<Self> {
        match contact {
            ContactState::DriveSide => Some(Self::Drive),
            ContactState::Separated => None,
            ContactState::BackSide => Some(Self::Back),
        }
    }

    /// The flank that a deflection, force or torque points to; neither for zero.
    pub fn towards<T: Real>(value: T) -> Option<Self> {
        if value > T::ZERO {
            Some(Self::Drive)
        } else if value < T::ZERO {
            Some(Self::Back)
        } else {
            None
        }
    }

    /// 1 on the drive flank, -1 on the back flank.
    pub fn sign<T: Real>(self) -> T {
        match self {
            Self::Drive => T::ONE,
            Self::Back => -T::ONE,
        }
    }

    /// The other flank.
    pub fn opposite(self) -> Self {
        match self {
            Self::Drive => Self::Back,
            Self::Back => Self::Drive,
        }
    }
}

/// 1 on the drive flank, -1 on the back flank, 0 on neither.
pub fn sign<T: Real>(flank: Option<Flank>) -> T {
    flank.map_or(T::ZERO, Flank::sign)
}

/// The contact state of a flank that touches, or of none.
pub fn contact_state(flank: Option<Flank>) -> ContactState {
    match flank {
        Some(Flank::Drive) => ContactState::DriveSide,
        None => ContactState::Separated,
        Some(Flank::Back) => ContactState::BackSide,
    }
}
