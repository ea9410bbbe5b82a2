//! Metrics of a point of the grid and their text form: equal bytes for equal joints. `sim::statistics` computes them.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::sim::arguments::MotionArguments;
use crate::sim::plan::SimulationPlan;
use crate::sim::scheme::SchemeName;
use crate::sim::statistics::{MeshStatistics, Statistics};
use crate::sim::stepping::{self, RunEnd};
use joint_file::named::Loaded;
use report::failure::Outcome;

/// A column of the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Metric {
    /// Greatest minus least sun-planet deflection, largest over all planets [um]
    SunDeflectionPeakToPeakUm,
    /// RMS of the sun-planet deflection about its mean, largest over all planets [um]
    SunDeflectionRmsUm,
    /// Greatest minus least ring-planet deflection, largest over all planets [um]
    RingDeflectionPeakToPeakUm,
    /// RMS of the ring-planet deflection about its mean, largest over all planets [um]
    RingDeflectionRmsUm,
    /// Share of time with teeth separated, mean over all meshes
    SeparatedShare,
    /// Share of time on the back side, mean over all meshes
    BackSideShare,
    /// Landings of all meshes in a second
    ImpactsPerS,
    /// Greatest mesh force [N]
    #[value(name = "peak_force_N")]
    #[serde(rename = "peak_force_N")]
    PeakForceN,
    /// Mesh periods after which the motion repeats; 0 if it does not within 32
    Period,
}

impl Metric {
    /// Name of the column.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Result of a point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointResult {
    /// `ok`, `diverged` or `refused`.
    pub status: &'static str,
    /// Values of the metrics as text; empty unless `ok`.
    pub values: Vec<String>,
    /// Reason for a refusal.
    pub remark: Option<String>,
}

/// Computes a point; `None` if the user stops the run.
pub fn compute(
    loaded: Outcome<Loaded>,
    motion: &MotionArguments,
    scheme: SchemeName,
    metrics: &[Metric],
) -> Option<PointResult> {
    let without = |status, remark| PointResult { status, values: vec![String::new(); metrics.len()], remark };
    let mut statistics = Statistics::default();
    let followed = loaded.and_then(|loaded| SimulationPlan::new(loaded, motion)).and_then(|plan| {
        stepping::simulate(&plan.run, scheme, 0.0, &mut |snapshot| {
            if snapshot.tick >= plan.settle {
                statistics.add_tick(snapshot);
            }
            Ok(())
        })
    });
    match followed {
        Err(failure) => Some(without("refused", Some(failure.to_string()))),
        Ok(RunEnd::Stopped) => None,
        Ok(RunEnd::Diverged(_)) => Some(without("diverged", None)),
        Ok(RunEnd::Whole) => {
            let meshes = statistics.meshes();
            let values = metrics.iter().map(|metric| value(*metric, &meshes, &statistics)).collect();
            Some(PointResult { status: "ok", values, remark: None })
        }
    }
}

fn value(metric: Metric, meshes: &[MeshStatistics], statistics: &Statistics) -> String {
    let (sun, ring) = meshes.split_at(meshes.len() / 2);
    let greatest =
        |meshes: &[MeshStatistics], of: fn(&MeshStatistics) -> f64| meshes.iter().map(of).fold(0.0, f64::max);
    let mean = |of: fn(&MeshStatistics) -> f64| meshes.iter().map(of).sum::<f64>() / meshes.len() as f64;
    let number = match metric {
        Metric::SunDeflectionPeakToPeakUm => 1e6 * greatest(sun, |mesh| mesh.deflection_peak_to_peak_m),
        Metric::SunDeflectionRmsUm => 1e6 * greatest(sun, |mesh| mesh.deflection_rms_m),
        Metric::RingDeflectionPeakToPeakUm => 1e6 * greatest(ring, |mesh| mesh.deflection_peak_to_peak_m),
        Metric::RingDeflectionRmsUm => 1e6 * greatest(ring, |mesh| mesh.deflection_rms_m),
        Metric::SeparatedShare => mean(|mesh| mesh.separated_share),
        Metric::BackSideShare => mean(|mesh| mesh.back_side_share),
        Metric::ImpactsPerS => meshes.iter().map(|mesh| mesh.impacts_per_s).sum(),
        Metric::PeakForceN => greatest(meshes, |mesh| mesh.peak_force_N),
        Metric::Period => return statistics.period().unwrap_or(0).to_string(),
    };
    format!("{number:.9e}")
}
