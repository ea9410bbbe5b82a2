//! The result of a simulation: samples, statistics, energy balance, spectrum.

use super::comparison::Comparison;
use super::energy::{Balance, EnergyAccount};
use super::files::HistoryFiles;
use super::plan::SimulationPlan;
use super::scheme::SchemeName;
use super::snapshot::Snapshot;
use super::statistics::Statistics;
use super::stepping::{self, RunEnd};
use report::failure::Outcome;
use report::progress::Progress;
use report::spectrum::Spectrum;

/// The progress line moves once in so many ticks.
pub const PROGRESS: u32 = 1024;

/// A run that has ended, complete or not.
pub struct SimulationResult<'a> {
    /// What was asked.
    pub plan: &'a SimulationPlan,
    /// Which scheme.
    pub scheme: SchemeName,
    /// How it ended.
    pub end: RunEnd,
    /// Ticks done.
    pub ticks: u32,
    /// Kept samples.
    pub samples: Vec<Snapshot>,
    /// Counted after settling.
    pub statistics: Statistics,
    /// The energy balance, if it was computed.
    pub energy: Option<EnergyAccount<'a>>,
    /// Of the first deflection after settling.
    pub spectrum: Option<Spectrum>,
    /// All schemes, if they were asked for.
    pub comparison: Option<Comparison>,
}

impl<'a> SimulationResult<'a> {
    /// Runs a plan by a scheme; every so many ticks a sample is kept and written.
    pub fn of(
        plan: &'a SimulationPlan,
        scheme: SchemeName,
        every: u32,
        with_energy: bool,
        files: &mut HistoryFiles<'_>,
        progress: &Progress,
    ) -> Outcome<Self> {
        let (run, settle) = (&plan.run, plan.settle);
        let mut samples = Vec::new();
        let mut statistics = Statistics::default();
        let mut energy = with_energy.then(|| EnergyAccount::open(&run.joint, run.tick_rate, run.ticks)).flatten();
        let mut ticks = 0;
        let end = stepping::simulate(run, scheme, 0.0, &mut |snapshot| {
            ticks = snapshot.tick;
            if snapshot.tick.is_multiple_of(every) {
                files.write(snapshot)?;
                samples.push(snapshot.clone());
            }
            if snapshot.tick >= settle {
                statistics.take(snapshot);
            }
            if let Some(account) = &mut energy {
                account.take(snapshot);
            }
            if snapshot.tick.is_multiple_of(PROGRESS) {
                progress.at(snapshot.tick);
            }
            Ok(())
        })?;
        let mut result =
            Self { plan, scheme, end, ticks, samples, statistics, energy, spectrum: None, comparison: None };
        let deflection = |snapshot: &Snapshot| snapshot.teeth.first().map_or(f64::NAN, |teeth| teeth.deflection);
        let signal: Vec<f64> = result.settled().iter().map(deflection).collect();
        result.spectrum = Spectrum::of(&signal, f64::from(run.tick_rate) / f64::from(every));
        Ok(result)
    }

    /// Samples that count.
    pub fn settled(&self) -> &[Snapshot] {
        &self.samples[self.samples.partition_point(|snapshot| snapshot.tick < self.plan.settle)..]
    }

    /// The balance of energy.
    pub fn balance(&self) -> Option<Balance> {
        self.energy.as_ref().and_then(EnergyAccount::balance)
    }
}
