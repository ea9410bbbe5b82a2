//! Joints: read from files, presets and texts, with values changed.

use std::path::PathBuf;

use joint_file::named::{self, Loaded};
use model_core::gears::Kinematics;
use pyo3::prelude::*;
use report::failure::{Failure, Outcome};

use crate::failure::result;
use crate::work;

/// Joint of a joint file.
#[pyclass(frozen, module = "lostmotion._native")]
pub struct Joint(pub Loaded);

/// Refusal of a key.
fn refused(refused: joint_file::Refused) -> Failure {
    Failure::new(refused.message).with_help(refused.help)
}

/// Remark behind a changed value in the text of a joint.
const REMARK: &str = "set in Python";

/// Reads a text under a name with values changed, each as "key=value".
fn read(name: String, mut text: String, changes: &[String]) -> Outcome<Joint> {
    for change in changes {
        let (key, value) = change.split_once('=').unwrap_or((change, ""));
        text = joint_file::change_with_remark(&text, key, value, REMARK)
            .map_err(|refused| Failure::new(format!("{change}: {}", refused.message)).with_help(refused.help))?;
    }
    let changed: String = changes.iter().map(|change| format!(" with {change}")).collect();
    let loaded = named::read_changed(format!("{name}{changed}"), text, &[])?;
    Ok(Joint(Loaded { name, ..loaded }))
}

#[pymethods]
impl Joint {
    /// Reads a path or a preset with values changed, each as "key=value".
    #[staticmethod]
    fn load(py: Python<'_>, file: PathBuf, changes: Vec<String>) -> PyResult<Self> {
        work::short(py, || named::text(&file).and_then(|(name, text)| read(name, text, &changes)))
    }

    /// Reads the text of a joint file.
    #[staticmethod]
    fn parse(py: Python<'_>, name: String, text: String, changes: Vec<String>) -> PyResult<Self> {
        work::short(py, || read(name, text, &changes))
    }

    /// Path, or name of the preset.
    #[getter]
    fn source(&self) -> &str {
        &self.0.name
    }

    /// Text of the joint file.
    #[getter]
    fn text(&self) -> &str {
        &self.0.text
    }

    /// Name that the joint file states.
    #[getter]
    fn name(&self) -> &str {
        &self.0.file.parameters.name
    }

    /// Number of planets; 1 for an equivalent gear.
    #[getter]
    fn planets(&self) -> usize {
        self.0.file.parameters.geometry.planets
    }

    /// Motor turns per turn of the link.
    #[getter]
    fn ratio(&self) -> f64 {
        self.0.file.parameters.geometry.ratio_by_teeth()
    }

    /// Control rate of the joint file [Hz].
    #[getter]
    fn control_rate(&self) -> u32 {
        self.0.file.surroundings.control_rate
    }

    /// Torque limit of the motor [N m].
    #[getter]
    fn torque_limit(&self) -> f64 {
        self.0.file.surroundings.torque_limit
    }

    /// Half-backlash of the sun's first mesh [m].
    #[getter]
    fn half_backlash(&self) -> f64 {
        self.0.file.parameters.sun_planet.half_backlash[0]
    }

    /// Counts per turn of the motor's encoder and of the output's.
    #[getter]
    fn counts_per_turn(&self) -> (u64, u64) {
        let surroundings = &self.0.file.surroundings;
        (surroundings.motor_encoder.counts_per_turn, surroundings.output_encoder.counts_per_turn)
    }

    /// Remarks on odd values that are usable: line, message and help.
    #[getter]
    fn warnings(&self) -> Vec<(usize, String, String)> {
        let line = |at: usize| 1 + self.0.text[..at].matches('\n').count();
        self.0.file.warnings.iter().map(|it| (line(it.span.start), it.message.clone(), it.help.clone())).collect()
    }

    /// Value of a key as typed, or None.
    fn value(&self, py: Python<'_>, key: &str) -> PyResult<Option<String>> {
        let found = joint_file::value(&self.0.text, key).map(|value| value.map(str::to_owned));
        result(py, found.map_err(refused))
    }

    fn __repr__(&self) -> String {
        format!("<Joint {} from {}>", self.0.file.parameters.name, self.0.name)
    }
}
