//! Classes of ticks by the change of the contact set, for reports of worst cases. The class follows from the outputs of
//! the joint before and after the tick.

use model_core::gears::Outputs;
use parameters::ContactState;

/// Change of the contact set in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// Every mesh touches on its drive side before and after the tick.
    DriveSide,
    /// Every mesh touches on its back side before and after the tick.
    BackSide,
    /// No mesh touches before or after the tick.
    Apart,
    /// The meshes differ in contact, and no mesh changes in the tick.
    Mixed,
    /// Some meshes change their contact in the tick.
    SomeChanged,
    /// Every mesh changes its contact in the tick.
    AllChanged,
    /// A deflection or the wind-up is not finite before or after the tick.
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
