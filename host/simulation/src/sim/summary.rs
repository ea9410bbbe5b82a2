//! Result of `joint sim` as data, as JSON in the schema `joint-sim/2`.

use model_core::gears::design::Substeps;
use serde::Serialize;

use super::comparison::{Comparison, Row};
use super::energy::Balance;
use super::result::SimulationResult;
use super::scheme::SchemeName;
use super::statistics::MeshStatistics;
use report::contacts::mesh_name;

/// Name and version of the schema; the version rises when a field changes its meaning or is removed.
const SCHEMA: &str = "joint-sim/2";

/// All figures of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "units are written as they are")]
pub struct SimulationSummary {
    /// `joint-sim/2`.
    pub schema: &'static str,
    /// Path or preset of the joint file.
    pub file: String,
    /// Name of the joint.
    pub joint: String,
    /// Values changed on the command line.
    pub set: Vec<String>,
    /// Name of the scheme.
    pub scheme: &'static str,
    /// `f32` or `f64`.
    pub scalar: &'static str,
    /// Board whose step is used; absent if the accuracy decides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub board: Option<String>,
    /// Method of the sub-steps of a tick in which contacts change: `corrected` or `leapfrog`; null for schemes with a
    /// single method.
    pub method: Option<&'static str>,
    /// Number of sub-steps; null for the reference, which chooses its own steps.
    pub substeps: Option<u32>,
    /// Step rate [Hz].
    pub tick_rate_Hz: u32,
    /// Finished ticks.
    pub ticks: u32,
    /// Requested ticks.
    pub of_ticks: u32,
    /// Time before the figures [s].
    pub settle_s: f64,
    /// Torques in words.
    pub torques: String,
    /// `rest`, `centred` or `seated`.
    pub start: &'static str,
    /// Time at which the state stopped being finite [s].
    pub diverged_at_s: Option<f64>,
    /// Every mesh, sun-planet first.
    pub meshes: Vec<Mesh>,
    /// Landings of all meshes in a second.
    pub impacts_per_s: f64,
    /// Mesh periods after which the motion repeats; null if it does not within 32.
    pub period: Option<usize>,
    /// Root of the power outside the mesh frequency over the root of the power at it, sun-planet deflection of planet
    /// 1.
    pub non_fundamental_over_fundamental: Option<f64>,
    /// Frequency of the strongest line in the spectrum of that deflection [Hz].
    pub strongest_frequency_Hz: Option<f64>,
    /// Energy balance.
    pub energy: Option<Balance>,
    /// Comparison of all schemes, if requested.
    pub schemes: Option<Vec<Row>>,
    /// End of the compared time [s].
    pub compared_until_s: Option<f64>,
}

/// One mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Mesh {
    /// Name, such as `sun–planet 1`.
    pub name: String,
    /// Figures of the mesh.
    #[serde(flatten)]
    pub figures: MeshStatistics,
}

impl SimulationSummary {
    /// Summary of a result; `set` are the values changed on the command line.
    pub fn new(result: &SimulationResult<'_>, set: &[String]) -> Self {
        let (plan, spectrum) = (result.plan, result.spectrum.as_ref());
        let meshes = result.statistics.meshes();
        let substeps = plan.run.substeps(result.scheme);
        let count = meshes.len();
        Self {
            schema: SCHEMA,
            file: plan.name.clone(),
            joint: plan.parameters().name.to_string(),
            set: set.to_vec(),
            scheme: result.scheme.name(),
            scalar: if plan.run.double || result.scheme == SchemeName::Reference { "f64" } else { "f32" },
            board: plan.board.clone(),
            method: substeps.filter(|_| result.scheme == SchemeName::Realtime).map(Substeps::method),
            substeps: substeps.map(Substeps::count),
            tick_rate_Hz: plan.run.tick_rate,
            ticks: result.ticks,
            of_ticks: plan.run.ticks,
            settle_s: f64::from(plan.settle) / f64::from(plan.run.tick_rate),
            torques: plan.torques_name.clone(),
            start: plan.start_name.name(),
            diverged_at_s: result.end.diverged_at(plan.run.tick_rate),
            impacts_per_s: meshes.iter().map(|mesh| mesh.impacts_per_s).sum(),
            meshes: meshes
                .into_iter()
                .enumerate()
                .map(|(mesh, figures)| Mesh { name: mesh_name(mesh, count), figures })
                .collect(),
            period: result.statistics.period(),
            non_fundamental_over_fundamental: spectrum
                .and_then(|spectrum| spectrum.non_fundamental_ratio(plan.mesh_frequency())),
            strongest_frequency_Hz: spectrum.map(|spectrum| spectrum.greatest().0),
            energy: result.balance(),
            schemes: result.comparison.as_ref().map(|comparison| comparison.rows.clone()),
            compared_until_s: result.comparison.as_ref().map(Comparison::predictable_until),
        }
    }

    /// Share of time with teeth separated, mean over meshes.
    pub fn separated_share(&self) -> f64 {
        let count = self.meshes.len().max(1) as f64;
        self.meshes.iter().map(|mesh| mesh.figures.separated_share).sum::<f64>() / count
    }

    /// Sub-steps as text, equal on every page.
    pub fn substeps_in_words(&self) -> String {
        let place = self.board.as_ref().map_or("as accuracy asks for".to_owned(), |board| format!("on {board}"));
        match (self.substeps, self.method) {
            (None, _) => "steps of its own".to_owned(),
            (Some(count), None) => format!("{count} sub-steps, {place}"),
            (Some(count), Some(method)) => format!("{count} {method} sub-steps, {place}"),
        }
    }

    /// Greatest mesh force [N].
    pub fn peak_force(&self) -> f64 {
        self.meshes.iter().map(|mesh| mesh.figures.peak_force_N).fold(0.0, f64::max)
    }
}
