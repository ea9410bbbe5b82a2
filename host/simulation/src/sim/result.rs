//! Result of a simulation: samples, statistics, energy balance, spectrum.

use super::comparison::Comparison;
use super::energy::{Balance, EnergyAccount};
use super::files::HistoryFiles;
use super::live_view;
use super::plan::SimulationPlan;
use super::scheme::SchemeName;
use super::snapshot::Snapshot;
use super::statistics::Statistics;
use super::stepping::{self, RunEnd};
use live::Feed;
use report::failure::Outcome;
use report::progress::Progress;
use report::spectrum::Spectrum;

/// Ticks between two updates of the progress line.
pub const PROGRESS_INTERVAL: u32 = 1024;

/// A finished run, complete or not.
pub struct SimulationResult<'a> {
    /// Plan of the run.
    pub plan: &'a SimulationPlan,
    /// Scheme.
    pub scheme: SchemeName,
    /// End of the run.
    pub end: RunEnd,
    /// Finished ticks.
    pub ticks: u32,
    /// Stored samples.
    pub samples: Vec<Snapshot>,
    /// Statistics after settling.
    pub statistics: Statistics,
    /// Energy balance, if it was computed.
    pub energy: Option<EnergyAccount<'a>>,
    /// Spectrum of the first deflection after settling.
    pub spectrum: Option<Spectrum>,
    /// Comparison of all schemes, if requested.
    pub comparison: Option<Comparison>,
}

impl<'a> SimulationResult<'a> {
    /// Runs a plan by a scheme; every `every`-th tick is stored and written, every tick is shown live.
    pub fn simulate(
        plan: &'a SimulationPlan,
        scheme: SchemeName,
        every: u32,
        with_energy: bool,
        files: &mut HistoryFiles<'_>,
        mut live: Option<&mut Feed>,
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
            if let Some(feed) = &mut live {
                feed.publish(snapshot.time, || live_view::sample(&run.joint, snapshot));
            }
            if snapshot.tick >= settle {
                statistics.add_tick(snapshot);
            }
            if let Some(account) = &mut energy {
                account.add_tick(snapshot);
            }
            if snapshot.tick.is_multiple_of(PROGRESS_INTERVAL) {
                progress.set_position(snapshot.tick);
            }
            Ok(())
        })?;
        let mut result =
            Self { plan, scheme, end, ticks, samples, statistics, energy, spectrum: None, comparison: None };
        let deflection = |snapshot: &Snapshot| snapshot.teeth.first().map_or(f64::NAN, |teeth| teeth.deflection);
        let signal: Vec<f64> = result.settled().iter().map(deflection).collect();
        result.spectrum = Spectrum::new(&signal, f64::from(run.tick_rate) / f64::from(every));
        Ok(result)
    }

    /// Samples after settling.
    pub fn settled(&self) -> &[Snapshot] {
        &self.samples[self.samples.partition_point(|snapshot| snapshot.tick < self.plan.settle)..]
    }

    /// Energy balance.
    pub fn balance(&self) -> Option<Balance> {
        self.energy.as_ref().and_then(EnergyAccount::balance)
    }
}
