//! Tables of observer, compensation and a virtual joint's surroundings as Rust source for a build script; control roles
//! link these tables into flash. Numbers are printed so that they read back to the same bits.

use std::format;
use std::string::String;

use crate::compensation::design::{CompensationSettings, compensation_settings, design_compensation, good_bandwidth};
use crate::controller::ControllerDesign;
use crate::gears::design::{DesignError, Effort, Processor, design_scheme};
use crate::gears::{Scheme, Tables};
use crate::numbers::digest;
use crate::observer::design::{
    ObserverSettings, design_observer, design_usual_probe, observer_settings, observer_text,
};
use crate::virtual_joint::SurroundingsTable;
use crate::virtual_joint::design::design_surroundings;
use crate::wiring::WiringTable;
use crate::wiring::design::design_wiring;
use parameters::{JointParameters, ParameterError, PlantParameters, Surroundings};

/// Requirements on a controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlRequest {
    /// Bandwidth of the loop [rad/s]; if left out, [`good_bandwidth`] of the plant.
    pub bandwidth: Option<f64>,
    /// Largest torque through the teeth in position mode, referred to the link [N m]; if left out, the motor's
    /// torque at its limit, at most twice the rated torque.
    pub peak_torque: Option<f64>,
    /// True if the observer reads the output encoder.
    pub output_encoder: bool,
}

impl ControlRequest {
    /// Requirements of a controller with all sensors and no additional limits.
    pub const USUAL: Self = Self { bandwidth: None, peak_torque: None, output_encoder: true };
}

/// Nominal plant of the design, and the requirements on the controller.
#[derive(Debug, Clone, Copy)]
pub struct NominalPlant<'t> {
    /// Joint; its backlash may be a guess.
    pub joint: &'t JointParameters,
    /// Surroundings of the joint.
    pub surroundings: &'t Surroundings,
    /// Requirements on the controller.
    pub request: ControlRequest,
}

impl NominalPlant<'_> {
    /// Bandwidth of the loop [rad/s]: as requested, otherwise [`good_bandwidth`] of the plant.
    pub fn bandwidth(&self) -> Result<f64, DesignError> {
        match self.request.bandwidth {
            Some(asked) => Ok(asked),
            None => good_bandwidth(self.joint, self.surroundings),
        }
    }

    /// Settings of the compensation's design.
    pub fn compensation_settings(&self) -> Result<CompensationSettings, DesignError> {
        let usual = compensation_settings(self.surroundings, self.bandwidth()?);
        Ok(CompensationSettings { peak_torque: self.request.peak_torque, ..usual })
    }
}

/// Tables as Rust source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControlSource {
    /// Text of a module: the statics `OBSERVER`, `PROBE`, `COMPENSATION` and `SURROUNDINGS` and the constant
    /// `CONTROL_DIGEST`.
    pub text: String,
    /// Value of `CONTROL_DIGEST`: a digest over the numbers of the statics.
    pub digest: u64,
}

impl ControllerDesign<f32> {
    /// Designs observer, width probe and compensation of `joint`, such as a joint file, with [`ControlRequest::USUAL`].
    /// The controller is to be called `rate` times a second [Hz].
    ///
    /// ```
    /// use model_core::{Controller, ControllerDesign};
    ///
    /// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
    /// let design = ControllerDesign::new(&q1, 10_000)?;
    /// let mut controller = Controller::new(&design);
    /// # assert_eq!(design.observer.control_rate, 10_000);
    /// # Ok::<(), model_core::gears::design::DesignError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Names a parameter or a rate that no controller can be designed for.
    pub fn new<'t>(joint: impl Into<PlantParameters<'t>>, rate: u32) -> Result<Self, DesignError> {
        let PlantParameters { joint, surroundings } = joint.into();
        let surroundings = &Surroundings { control_rate: rate, ..*surroundings };
        Self::for_plant(&NominalPlant { joint, surroundings, request: ControlRequest::USUAL })
    }

    /// Designs the controller for the nominal plant at the rate of its surroundings.
    pub fn for_plant(nominal: &NominalPlant<'_>) -> Result<Self, DesignError> {
        let settings = settings(nominal);
        Ok(Self {
            observer: design_observer(nominal.joint, &settings)?,
            probe: design_usual_probe(nominal.joint, &settings)?,
            compensation: design_compensation(nominal.joint, &nominal.compensation_settings()?)?,
        })
    }
}

/// Table of the wiring check for the nominal plant.
pub fn wiring_table(nominal: &NominalPlant<'_>) -> Result<WiringTable<f32>, DesignError> {
    design_wiring(nominal.joint, &settings(nominal))
}

/// Settings of the observer for the nominal plant.
fn settings(nominal: &NominalPlant<'_>) -> ObserverSettings {
    let mut settings = observer_settings(nominal.surroundings);
    if !nominal.request.output_encoder {
        settings.output_encoder = None;
    }
    settings
}

/// Source of the controller's tables for the nominal plant and of the joint's true surroundings.
pub fn control_source(
    joint: &JointParameters,
    around: &Surroundings,
    nominal: &NominalPlant<'_>,
    processor: &Processor,
) -> Result<ControlSource, DesignError> {
    let ControllerDesign { observer, probe, compensation } = ControllerDesign::for_plant(nominal)?;
    let observer = observer_text(&observer, probe.as_ref());
    let surroundings: SurroundingsTable<f32> = match joint.geometry.planets {
        1 => surroundings::<1>(joint, around, processor)?,
        3 => surroundings::<3>(joint, around, processor)?,
        4 => surroundings::<4>(joint, around, processor)?,
        5 => surroundings::<5>(joint, around, processor)?,
        given => return Err(ParameterError::PlanetCount { given }.into()),
    };
    let statics = format!(
        "{observer}\n\
         /// Tables of the compensation.\n\
         pub static COMPENSATION: model_core::compensation::tables::CompensationTables<f32> = {{\n\
         use model_core::compensation::tables::*;\n{compensation:#?}\n}};\n\
         /// What surrounds the virtual joint.\n\
         pub static SURROUNDINGS: model_core::virtual_joint::SurroundingsTable<f32> = {{\n\
         use model_core::virtual_joint::tables::*;\n{surroundings:#?}\n}};\n"
    );
    let digest = digest_of(&statics);
    let text = format!(
        "{statics}/// Digest over the numbers of these tables.\n\
         pub const CONTROL_DIGEST: u64 = {digest:#x};\n"
    );
    Ok(ControlSource { text, digest })
}

/// Digest over all values in the statics: numbers in their order, `true`, `false` and `None`, but no names. Every field
/// counts under any name.
fn digest_of(statics: &str) -> u64 {
    let words = statics.split(|character: char| character.is_whitespace() || "{}()[],:;=".contains(character));
    let is_value = |word: &&str| {
        word.starts_with(|first: char| first == '-' || first.is_ascii_digit())
            || ["true", "false", "None"].contains(word)
    };
    let bytes = words.filter(is_value).flat_map(|word| word.bytes().chain([b'\n']));
    bytes.fold(digest::START, |running, byte| digest::chain(running, byte.into()))
}

fn surroundings<const N: usize>(
    joint: &JointParameters,
    of: &Surroundings,
    processor: &Processor,
) -> Result<SurroundingsTable<f32>, DesignError> {
    let tables: Tables<f32, N> = design_scheme(joint, of.control_rate, Scheme::Realtime, Effort::Within(*processor))?;
    design_surroundings(joint, of, &tables)
}

#[cfg(test)]
mod tests {
    use super::digest_of;

    #[test]
    fn a_digest_is_of_every_value_in_its_order_and_of_no_name() {
        let of = digest_of("static A: B<f32> = B { first: 1.5e-7, second: [-2, 3], third: true, fourth: None };");
        assert_eq!(of, digest_of("static A: C<f32> = C { one: 1.5e-7, two: [-2, 3], three: true, four: None };"));
        for other in [
            "static A: B<f32> = B { first: 1.5e-8, second: [-2, 3], third: true, fourth: None };",
            "static A: B<f32> = B { first: 1.5e-7, second: [3, -2], third: true, fourth: None };",
            "static A: B<f32> = B { first: 1.5e-7, second: [-2, 3], third: false, fourth: None };",
            "static A: B<f32> = B { first: 1.5e-7, second: [-23], third: true, fourth: None };",
        ] {
            assert_ne!(of, digest_of(other), "{other}");
        }
    }
}
