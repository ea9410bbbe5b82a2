//! List of the effects of real joints, their keys in joint files, and the effects present in given surroundings.

use crate::surroundings::{AbsoluteEncoder, Surroundings};

/// Effect of real joints; a model without the effect refuses the effect by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// [`Payload`](crate::Payload).
    Payload,
    /// [`PayloadStep`](crate::PayloadStep).
    PayloadStep,
    /// [`Presliding`](crate::Presliding) of the motor.
    MotorPresliding,
    /// [`Presliding`](crate::Presliding) of the link.
    LoadPresliding,
    /// [`Hysteresis`](crate::Hysteresis).
    Hysteresis,
    /// [`WidthVariation`](crate::WidthVariation) once a turn of the link.
    WidthPerLinkTurn,
    /// [`WidthVariation`](crate::WidthVariation) once a turn of the motor.
    WidthPerMotorTurn,
    /// [`Drift`](crate::Drift) of the frictions.
    FrictionDrift,
    /// [`Drift`](crate::Drift) of the half-backlash.
    WidthDrift,
    /// [`crate::TorqueErrors::ripple_ratio`].
    TorqueRipple,
    /// [`crate::TorqueErrors::resolution_ratio`].
    TorqueResolution,
    /// [`crate::TorqueErrors::saturation_ratio`].
    TorqueSaturation,
    /// [`Surroundings::control_jitter_ratio`].
    ControlJitter,
    /// Noise of an encoder.
    EncoderNoise,
    /// [`SubdivisionalError`](crate::SubdivisionalError), first harmonic.
    SubdivisionFirst,
    /// [`SubdivisionalError`](crate::SubdivisionalError), second harmonic.
    SubdivisionSecond,
    /// Missing readings of an encoder.
    MissingFrames,
    /// Jitter of the age of an encoder's readings.
    AgeJitter,
}

impl Effect {
    /// All effects.
    pub const ALL: [Self; 18] = [
        Self::Payload,
        Self::PayloadStep,
        Self::MotorPresliding,
        Self::LoadPresliding,
        Self::Hysteresis,
        Self::WidthPerLinkTurn,
        Self::WidthPerMotorTurn,
        Self::FrictionDrift,
        Self::WidthDrift,
        Self::TorqueRipple,
        Self::TorqueResolution,
        Self::TorqueSaturation,
        Self::ControlJitter,
        Self::EncoderNoise,
        Self::SubdivisionFirst,
        Self::SubdivisionSecond,
        Self::MissingFrames,
        Self::AgeJitter,
    ];

    /// Returns the key of the effect in a joint file.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Payload => "payload_inertia_share",
            Self::PayloadStep => "payload_step_ratio",
            Self::MotorPresliding => "motor_presliding_mrad",
            Self::LoadPresliding => "load_presliding_mrad",
            Self::Hysteresis => "hysteresis_stiffness_share",
            Self::WidthPerLinkTurn => "width_once_per_link_turn_ratio",
            Self::WidthPerMotorTurn => "width_once_per_motor_turn_ratio",
            Self::FrictionDrift => "friction_drift_ratio_per_s",
            Self::WidthDrift => "width_drift_ratio_per_s",
            Self::TorqueRipple => "torque_ripple_ratio",
            Self::TorqueResolution => "torque_resolution_ratio",
            Self::TorqueSaturation => "torque_saturation_ratio",
            Self::ControlJitter => "control_jitter_ratio",
            Self::EncoderNoise => "noise_counts",
            Self::SubdivisionFirst => "subdivisional_error_deg",
            Self::SubdivisionSecond => "subdivisional_second_error_deg",
            Self::MissingFrames => "missing_frames_share",
            Self::AgeJitter => "age_jitter_us",
        }
    }
}

impl Surroundings {
    /// Returns the size of an effect in SI; 0 if the effect is absent.
    pub fn size(&self, effect: Effect) -> f64 {
        let encoders = [&self.motor_encoder, &self.output_encoder];
        let either = |of: fn(&AbsoluteEncoder) -> f64| encoders.map(of).into_iter().fold(0.0, f64::max);
        match effect {
            Effect::Payload => self.payload.inertia_share,
            Effect::PayloadStep => self.payload_step.ratio - 1.0,
            Effect::MotorPresliding => self.presliding.motor,
            Effect::LoadPresliding => self.presliding.load,
            Effect::Hysteresis => self.hysteresis.stiffness_share,
            Effect::WidthPerLinkTurn => self.width.per_link_turn,
            Effect::WidthPerMotorTurn => self.width.per_motor_turn,
            Effect::FrictionDrift => self.drift.friction,
            Effect::WidthDrift => self.drift.width,
            Effect::TorqueRipple => self.torque_errors.ripple_ratio,
            Effect::TorqueResolution => self.torque_errors.resolution_ratio,
            Effect::TorqueSaturation => self.torque_errors.saturation_ratio,
            Effect::ControlJitter => self.control_jitter_ratio,
            Effect::EncoderNoise => either(|encoder| encoder.noise_counts),
            Effect::SubdivisionFirst => either(|encoder| encoder.subdivision.first),
            Effect::SubdivisionSecond => either(|encoder| encoder.subdivision.second),
            Effect::MissingFrames => either(|encoder| encoder.missing_share),
            Effect::AgeJitter => either(|encoder| encoder.age_jitter),
        }
    }

    /// Iterates over the effects that are present.
    pub fn effects(&self) -> impl Iterator<Item = Effect> + '_ {
        Effect::ALL.into_iter().filter(|effect| self.size(*effect) != 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Drift, Presliding, SubdivisionalError, TorqueErrors, WidthVariation};

    #[test]
    fn ideal_surroundings_have_no_effect() {
        assert_eq!(Surroundings::ideal().effects().count(), 0);
    }

    #[test]
    fn stated_effects_are_listed_once() {
        let mut around = Surroundings::ideal();
        around.payload.inertia_share = 0.3;
        around.payload_step.ratio = 0.5;
        around.presliding = Presliding { motor: 1e-3, load: 1e-4 };
        around.hysteresis.stiffness_share = 0.2;
        around.width = WidthVariation { per_link_turn: 0.1, per_motor_turn: 0.1 };
        around.drift = Drift { friction: -1e-3, width: 1e-3 };
        around.torque_errors =
            TorqueErrors { ripple_ratio: 0.02, resolution_ratio: 0.01, saturation_ratio: 0.1, ..Default::default() };
        around.control_jitter_ratio = 0.05;
        around.motor_encoder.noise_counts = 1.0;
        around.output_encoder.subdivision = SubdivisionalError { periods_per_turn: 4, first: 1e-4, second: 1e-4 };
        around.output_encoder.missing_share = 0.01;
        around.output_encoder.age_jitter = 1e-4;
        assert!(around.effects().eq(Effect::ALL));
    }
}
