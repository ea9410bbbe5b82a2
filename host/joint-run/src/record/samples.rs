//! Sampled motion in columns: of the board, of the reference, and the error between them. Columns load straight into a
//! data frame; `docs/reference/report-schema.md` explains them.

use report::contacts::Contact;
use serde::{Deserialize, Deserializer, Serialize};

use super::sample::MotionSample;

/// Sampled motion; all columns have one length. Non-finite values are `null` in JSON.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Samples {
    /// Steps since the reset.
    pub tick: Vec<u32>,
    /// Board time [s].
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f64>>"))]
    pub time_s: Vec<f64>,
    /// Motor (sun) angle [rad].
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f64>>"))]
    pub motor_angle_rad: Vec<f64>,
    /// Link angle [rad].
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f64>>"))]
    pub link_angle_rad: Vec<f64>,
    /// Motor angle over the ratio, less the link angle, from the small remainders, so that nothing cancels [rad].
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f64>>"))]
    pub twist_rad: Vec<f64>,
    /// Rate of the rigid-body carrier angle [rad/s].
    #[serde(rename = "carrier_speed_rad_per_s", deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f32>>"))]
    pub carrier_speed: Vec<f32>,
    /// Gap coordinate along the line of action [m].
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f32>>"))]
    pub gap_m: Vec<f32>,
    /// Wind-up between carrier and link along the line of action [m].
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f32>>"))]
    pub wind_up_m: Vec<f32>,
    /// Mesh deflections [m], one column per mesh: sun-planet of every planet, then ring-planet.
    #[serde(deserialize_with = "columns_null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Vec<Option<f32>>>"))]
    pub deflection_m: Vec<Vec<f32>>,
    /// Contact states in the order of the deflections.
    pub contact: Vec<Vec<Contact>>,
    /// Running digest over the whole state after every step so far, 16 hexadecimal digits; empty for a reference.
    pub state_digest: Vec<String>,
    /// Computation time of the step [s]; empty for a reference.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f64>>"))]
    pub computation_s: Vec<f64>,
}

/// Stretch of the run at every tick, beyond the capacity of the line.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CloseUp {
    /// Method of the computation and reason to trust it, such as "host twin, equal to the board bit for bit".
    pub method: String,
    /// Motion of the stretch.
    pub samples: Samples,
}

/// f64 reference for the run's torques.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Reference {
    /// Method of the computation and its tolerance.
    pub method: String,
    /// Motion of the reference; columns without values are empty.
    pub samples: Samples,
    /// Distances of the board's samples from the reference.
    pub errors: Vec<ErrorSeries>,
}

/// Distance of one quantity from the reference, relative to the quantity's standard deviation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ErrorSeries {
    /// Name of the quantity, such as `gap`.
    pub quantity: String,
    /// Times of the values [s].
    pub time_s: Vec<f64>,
    /// Board less reference, over the standard deviation of the reference [%].
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(test, schemars(with = "Vec<Option<f64>>"))]
    pub error_percent: Vec<f64>,
    /// Bound on the root mean square [%].
    pub bound_percent: f64,
}

impl Samples {
    /// Empty samples of a joint with this number of meshes.
    pub fn new(meshes: usize) -> Self {
        Self { deflection_m: vec![Vec::new(); meshes], contact: vec![Vec::new(); meshes], ..Self::default() }
    }

    /// Adds a sample. Missing meshes become NaN and separated, so that all columns keep one length.
    pub fn push(&mut self, sample: &MotionSample, tick_rate: u32, ratio: f64) {
        self.tick.push(sample.tick);
        self.time_s.push(f64::from(sample.tick) / f64::from(tick_rate));
        self.motor_angle_rad.push(ratio * sample.carrier_angle + sample.motor_offset);
        self.link_angle_rad.push(sample.carrier_angle + sample.link_offset);
        self.twist_rad.push(sample.motor_offset / ratio - sample.link_offset);
        self.carrier_speed.push(sample.carrier_speed);
        self.gap_m.push(sample.gap);
        self.wind_up_m.push(sample.wind_up);
        for (mesh, column) in self.deflection_m.iter_mut().enumerate() {
            column.push(sample.deflections.get(mesh).copied().unwrap_or(f32::NAN));
        }
        for (mesh, column) in self.contact.iter_mut().enumerate() {
            column.push(sample.contacts.get(mesh).copied().unwrap_or(Contact::Separated));
        }
        if let Some(digest) = sample.state_digest {
            self.state_digest.push(format!("{digest:016x}"));
        }
        if let Some(computation) = sample.computation {
            self.computation_s.push(computation);
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.tick.len()
    }

    /// Returns true without samples.
    pub fn is_empty(&self) -> bool {
        self.tick.is_empty()
    }
}

/// Reads null as NaN, which JSON lacks.
fn null_is_nan<'de, D: Deserializer<'de>, F: Deserialize<'de> + From<f32>>(
    deserializer: D,
) -> Result<Vec<F>, D::Error> {
    let values = Vec::<Option<F>>::deserialize(deserializer)?;
    Ok(values.into_iter().map(|value| value.unwrap_or_else(|| F::from(f32::NAN))).collect())
}

/// Reads null as NaN in every column.
fn columns_null_is_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Vec<f32>>, D::Error> {
    let columns = Vec::<Vec<Option<f32>>>::deserialize(deserializer)?;
    let filled = |column: Vec<Option<f32>>| column.into_iter().map(|value| value.unwrap_or(f32::NAN)).collect();
    Ok(columns.into_iter().map(filled).collect())
}

#[cfg(test)]
mod tests {
    use link::messages::Sample;

    use super::*;

    fn board_sample() -> Sample {
        Sample {
            tick: 40,
            state_digest: 0xab,
            carrier_turns: -2,
            carrier_fraction: 1 << 30,
            carrier_speed: 1.5,
            motor_offset: 6e-3,
            link_offset: -1e-3,
            gap: 8e-5,
            wind_up: 2e-6,
            deflections: [1e-5, 2e-5, 3e-5, 4e-5].into_iter().collect(),
            contacts: 0b10_01_00_01,
            computation: 1680,
        }
    }

    #[test]
    fn board_sample_is_in_si() {
        let mut samples = Samples::new(4);
        samples.push(&MotionSample::from_board(&board_sample(), 168_000_000), 20_000, 6.0);
        let carrier = -1.75 * core::f64::consts::TAU;
        assert_eq!(samples.time_s, [2e-3]);
        assert!((samples.motor_angle_rad[0] - (6.0 * carrier + 6e-3)).abs() < 1e-9);
        assert!((samples.link_angle_rad[0] - (carrier - 1e-3)).abs() < 1e-9);
        assert!((samples.twist_rad[0] - 2e-3).abs() < 1e-9);
        assert_eq!(samples.state_digest, ["00000000000000ab"]);
        assert_eq!(samples.computation_s, [1e-5]);
        assert_eq!(samples.deflection_m[3], [4e-5]);
        let states: Vec<Contact> = samples.contact.iter().map(|column| column[0]).collect();
        assert_eq!(states, [Contact::DriveSide, Contact::Separated, Contact::DriveSide, Contact::BackSide]);
    }

    #[test]
    fn columns_keep_one_length() {
        let mut samples = Samples::new(6);
        samples.push(&MotionSample::from_board(&board_sample(), 168_000_000), 20_000, 6.0);
        assert!(samples.deflection_m.iter().all(|column| column.len() == 1));
        assert!(samples.deflection_m[5][0].is_nan());
    }
}
