//! Content of a memory file: the observer's parameters with their covariances, in the units of the joint file. The
//! observer defines the byte layout (`model_core::observer`).

use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::tables::LeverTable;
use model_core::observer::{MAPPED, Memory, MemoryError, Observer, ObserverTables, memory_numbers};
use serde::Serialize;

use crate::estimate::NORMAL_QUANTILE;
use crate::findings::{Finding, angles};
use crate::page;
use joint_file::named::Loaded;
use report::document::{Document, terminal};

/// A parameter counts as estimated if its standard deviation is below this share of the prior one.
const ESTIMATED_SHARE: f64 = 0.9;

/// Bias and friction, their variances and their covariance.
const MOTOR_NUMBERS: usize = 5;

/// Memory of a known joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Content {
    /// Name and version of the format.
    schema: &'static str,
    /// Name of the joint.
    joint: String,
    /// True if the output encoder took part in the estimation.
    output_encoder: bool,
    /// Estimated parameters.
    values: Vec<Finding>,
}

/// Parameter with its standard deviation and the prior standard deviation.
#[derive(Debug, Clone, Copy)]
struct StoredParameter {
    value: f64,
    deviation: f64,
    before: f64,
}

impl Content {
    /// Reads a memory, with the checks of the joint's observer.
    pub fn read(memory: &Memory, loaded: &Loaded) -> Result<Self, MemoryError> {
        let joint = &loaded.file.parameters;
        let mut refused = MemoryError::OtherJoint;
        for output_encoder in [true, false] {
            let mut settings = observer_settings(&loaded.file.surroundings);
            if !output_encoder {
                settings.output_encoder = None;
            }
            // No memory belongs to a joint without an observer.
            let Ok(tables) = design_observer::<f32>(joint, &settings) else { continue };
            match Observer::<f32, MAPPED>::new(&tables).load(memory) {
                Ok(()) => {
                    let values = values(&Numbers::new(memory), &tables, joint.equivalent_gear().is_some());
                    let joint = joint.name.to_string();
                    return Ok(Self { schema: "joint-memory/1", joint, output_encoder, values });
                }
                Err(error) => refused = error,
            }
        }
        Err(refused)
    }

    /// Values beside those of the joint file, as terminal text.
    pub fn text(&self, name: &str, loaded: &Loaded) -> String {
        let with = if self.output_encoder { "both encoders" } else { "the motor's encoder alone" };
        let line = format!("{name}: learnt of joint {} with {with}", self.joint);
        let blocks = page::findings(&self.values, &loaded.text);
        terminal(&Document { title: name.to_owned(), line: line.into(), blocks, ..Document::default() })
    }

    /// All values.
    pub fn into_values(self) -> Vec<Finding> {
        self.values
    }

    /// Value by the name of its finding.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|finding| finding.name == name)?.value
    }
}

/// Numbers of a memory, in their order.
struct Numbers(Vec<f64>);

impl Numbers {
    fn new(memory: &Memory) -> Self {
        Self(memory_numbers(memory).map(f64::from).collect())
    }

    fn at(&self, index: usize) -> f64 {
        self.0.get(index).copied().unwrap_or_default()
    }

    /// Parameter by its index. The memory holds the covariance as U D U^T: each column down to its diagonal, in prior
    /// standard deviations.
    fn parameter(&self, tables: &ObserverTables<f32>, index: usize) -> StoredParameter {
        let column = |j: usize| MAPPED + j * (j + 1) / 2;
        let part = |j: usize| {
            let factor = if j == index { 1.0 } else { self.at(column(j) + index) };
            self.at(column(j) + j) * factor * factor
        };
        let variance: f64 = (index..MAPPED).map(part).sum();
        let before = f64::from(tables.learner.deviation[index]);
        StoredParameter { value: self.at(index), deviation: variance.max(0.0).sqrt() * before, before }
    }

    /// Torque bias (index 0) or dry friction (index 1) of the motor, as a force.
    fn motor_parameter(&self, tables: &ObserverTables<f32>, index: usize) -> StoredParameter {
        let first = MAPPED + MAPPED * (MAPPED + 1) / 2;
        let before = f64::from(tables.contact.bias_prior).sqrt();
        StoredParameter { value: self.at(first + index), deviation: self.at(first + 2 + index).max(0.0).sqrt(), before }
    }

    /// Inertia of the link over the designed inertia; the memory holds the inverse.
    fn inertia_ratio(&self, tables: &ObserverTables<f32>) -> StoredParameter {
        let first = MAPPED + MAPPED * (MAPPED + 1) / 2 + MOTOR_NUMBERS;
        let [mobility, variance] = [self.at(first), self.at(first + 1)];
        let value = 1.0 / mobility;
        StoredParameter {
            value,
            deviation: variance.max(0.0).sqrt() * value * value,
            before: f64::from(tables.inertia.prior).sqrt(),
        }
    }
}

impl StoredParameter {
    /// Converts to another unit.
    fn scaled(self, factor: f64) -> Self {
        let size = factor.abs();
        Self { value: self.value * factor, deviation: self.deviation * size, before: self.before * size }
    }

    /// Amplitude of a sine and a cosine part.
    fn size(along: Self, across: Self) -> Self {
        let value = along.value.hypot(across.value);
        let deviation = along.deviation.max(across.deviation);
        Self { value, deviation, before: along.before }
    }

    fn finding(self, name: &str, unit: &str, key: &str, note: &str) -> Finding {
        let is_estimated = self.deviation < ESTIMATED_SHARE * self.before;
        let reach = NORMAL_QUANTILE * self.deviation;
        Finding {
            name: name.to_owned(),
            unit: unit.to_owned(),
            key: (!key.is_empty()).then(|| key.to_owned()),
            value: is_estimated.then_some(self.value),
            interval: is_estimated.then_some([self.value - reach, self.value + reach]),
            note: if is_estimated { note.to_owned() } else { "not learnt".to_owned() },
            repeats: false,
        }
    }
}

/// Findings of a memory; an equivalent gear has a lost motion and no tooth errors.
fn values(numbers: &Numbers, tables: &ObserverTables<f32>, equivalent: bool) -> Vec<Finding> {
    let LeverTable { sun, per_sun, per_output, .. } = &tables.levers;
    let [sun, per_sun, per_output] = [sun, per_sun, per_output].map(|lever| f64::from(*lever));
    let parameter = |index: usize| numbers.parameter(tables, index);
    let motor = |index: usize| numbers.motor_parameter(tables, index).scaled(sun);
    let width = if equivalent {
        // The gap is twice the twist on the lever of the link.
        let lost_motion = parameter(0).scaled(2e3 * per_output);
        lost_motion.finding("lost motion at the output", "mrad", "equivalent_gear.lost_motion_mrad", "")
    } else {
        parameter(0).scaled(0.5e6).finding("half-backlash b", "um", "mesh.half_backlash_um", "")
    };
    let mut values = vec![
        width,
        parameter(2).scaled(1e6 * per_output * per_output).finding("compliance at the output", "urad/(N m)", "", ""),
        parameter(1).scaled(1e3 * per_output).finding("encoder offset at the output", "mrad", "", ""),
        parameter(3).scaled(1e6 * per_output).finding(
            "output encoder: age of a reading",
            "us",
            "drive_train.output_encoder.skew_us",
            "",
        ),
        motor(0).finding("torque bias of the motor", "N m", "", ""),
        motor(1).finding(
            "dry friction of the motor",
            "N m",
            "drive_train.motor_coulomb_friction_N_m",
            "as far as it does not grow with the load",
        ),
        numbers.inertia_ratio(tables).finding("inertia of the link over the joint file's", "-", "", ""),
    ];
    let of_teeth = ("gears: error along the line of action".to_owned(), "um", String::new(), 4, 1e6);
    let mut maps = if equivalent { Vec::new() } else { vec![of_teeth] };
    for (encoder, first, lever) in [("motor", 6, per_sun), ("output", 10, per_output)] {
        for (order, word) in [(0, "once"), (1, "twice")] {
            let (name, key) = angles::names(encoder, word);
            maps.push((name, "deg", key, first + 2 * order, lever.to_degrees()));
        }
    }
    values.extend(maps.into_iter().map(|(name, unit, key, first, factor)| {
        let [along, across] = [first, first + 1].map(|index| parameter(index).scaled(factor));
        let phase = across.value.atan2(along.value).to_degrees();
        let size = StoredParameter::size(along, across);
        let note = if size.value > NORMAL_QUANTILE * size.deviation {
            format!("phase at count zero {phase:.1} deg")
        } else {
            "may well be zero".to_owned()
        };
        let mut finding = size.finding(&name, unit, &key, &note);
        finding.interval = finding.interval.map(|ends| ends.map(|end| end.max(0.0)));
        finding
    }));
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fresh memory holds the designed inertia with its prior deviation.
    #[test]
    fn memory_initial_inertia_is_prior() {
        let loaded = joint_file::named::load(std::path::Path::new("q1")).expect("a preset");
        let settings = observer_settings(&loaded.file.surroundings);
        let tables = design_observer::<f32>(&loaded.file.parameters, &settings).expect("tables");
        let memory = Observer::<f32, MAPPED>::new(&tables).save();
        let StoredParameter { value, deviation, before } = Numbers::new(&memory).inertia_ratio(&tables);
        assert_eq!((value, deviation), (1.0, before));
        assert!(before > 0.0);
    }
}
