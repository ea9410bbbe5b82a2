//! The two flanks of a tooth gap and their signs in the equations.

use parameters::ContactState;

use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Flank of the teeth. `Option<Flank>` is `None` if no flank touches or the flank is unknown. The discriminants equal those
/// of [`ContactState`], so that a conversion needs no branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flank {
    /// Drive flank: the motor drives the load forwards; deflection, force and torque are positive.
    Drive = 1,
    /// Back flank: deflection, force and torque are negative.
    Back = 2,
}
state_words! { enum Flank { Drive, Back } }

impl Flank {
    /// Returns the flank of a contact state; `None` if separated.
    pub fn touched(contact: ContactState) -> Option<Self> {
        match contact {
            ContactState::DriveSide => Some(Self::Drive),
            ContactState::Separated => None,
            ContactState::BackSide => Some(Self::Back),
        }
    }

    /// Returns the flank that a deflection, force or torque points to; `None` for zero or NaN.
    pub fn towards<T: Real>(value: T) -> Option<Self> {
        if value > T::ZERO {
            Some(Self::Drive)
        } else if value < T::ZERO {
            Some(Self::Back)
        } else {
            None
        }
    }

    /// Returns 1 for the drive flank, -1 for the back flank.
    pub fn sign<T: Real>(self) -> T {
        match self {
            Self::Drive => T::ONE,
            Self::Back => -T::ONE,
        }
    }

    /// Returns the opposite flank.
    pub fn opposite(self) -> Self {
        match self {
            Self::Drive => Self::Back,
            Self::Back => Self::Drive,
        }
    }
}

/// Returns 1 for the drive flank, -1 for the back flank, 0 for `None`.
pub fn sign<T: Real>(flank: Option<Flank>) -> T {
    flank.map_or(T::ZERO, Flank::sign)
}

/// Returns the contact state of a touching flank; `Separated` for `None`.
pub fn contact_state(flank: Option<Flank>) -> ContactState {
    match flank {
        Some(Flank::Drive) => ContactState::DriveSide,
        None => ContactState::Separated,
        Some(Flank::Back) => ContactState::BackSide,
    }
}
