//! Classes of ticks by the change of the contact set, for reports of worst cases; determined from the outputs before
//! and after.

use model_core::gears::Outputs;
use parameters::ContactState;

/// Change of the contact set in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// Drive sides in contact, before and after.
    DriveSide,
    /// Back sides in contact, before and after.
    BackSide,
    /// All teeth apart, before and after.
    Apart,
    /// Mixed contact, unchanged.
    Mixed,
    /// Some meshes changed.
    SomeChanged,
    /// Every mesh changed.
    AllChanged,
    /// Non-finite numbers.
    NotFinite,
}

impl Class {
    /// All classes.
    pub const ALL: [Self; 7] = [
        Self::DriveSide,
        Self::BackSide,
        Self::Apart,
        Self::Mixed,
        Self::SomeChanged,
        Self::AllChanged,
        Self::NotFinite,
    ];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::DriveSide => "drive side held",
            Self::BackSide => "back side held",
            Self::Apart => "apart",
            Self::Mixed => "mixed, unchanged",
            Self::SomeChanged => "some meshes changed",
            Self::AllChanged => "every mesh changed",
            Self::NotFinite => "not finite",
        }
    }

    /// Returns the class of a tick.
    pub fn of<const N: usize>(before: &Outputs<f32, N>, after: &Outputs<f32, N>) -> Self {
        let finite = |outputs: &Outputs<f32, N>| {
            outputs.deflections.iter().flatten().all(|value| value.is_finite()) && outputs.wind_up.is_finite()
        };
        if !finite(before) || !finite(after) {
            return Self::NotFinite;
        }
        let pairs = || before.contacts.iter().flatten().zip(after.contacts.iter().flatten());
        let all = |state: ContactState| pairs().all(|(before, after)| *before == state && *after == state);
        match pairs().filter(|(before, after)| before != after).count() {
            0 if all(ContactState::DriveSide) => Self::DriveSide,
            0 if all(ContactState::BackSide) => Self::BackSide,
            0 if all(ContactState::Separated) => Self::Apart,
            0 => Self::Mixed,
            changed if changed == 2 * N => Self::AllChanged,
            _ => Self::SomeChanged,
        }
    }
}
