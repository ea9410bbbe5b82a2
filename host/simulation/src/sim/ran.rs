//! A run with all that was gathered of it on its way: samples, statistics, books of energy, spectrum. Figures, tables and
//! pictures are made from it elsewhere.

use super::comparison::Comparison;
use super::energy::{Balance, EnergyBook};
use super::files::HistoryFiles;
use super::follow::{self, End};
use super::moment::Moment;
use super::plan::Plan;
use super::scheme::SchemeName;
use super::statistics::Statistics;
use report::failure::Outcome;
use report::progress::Progress;
use report::spectrum::Spectrum;

/// The progress line moves once in so many ticks.
pub const PROGRESS: u32 = 1024;

/// A run that is over, one way or the other.
pub struct Ran<'a> {
    /// What was asked.
    pub plan: &'a Plan,
    /// Which scheme.
    pub scheme: SchemeName,
    /// How it ended.
    pub end: End,
    /// Ticks done.
    pub ticks: u32,
    /// Kept samples.
    pub samples: Vec<Moment>,
    /// Counted after settling.
    pub statistics: Statistics,
    /// The books, if they were kept.
    pub energy: Option<EnergyBook<'a>>,
    /// Of the first deflection after settling.
    pub spectrum: Option<Spectrum>,
    /// All schemes, if they were asked for.
    pub comparison: Option<Comparison>,
}

impl<'a> Ran<'a> {
    /// Runs a plan by a scheme; every so many ticks a sample is kept and written.
    pub fn of(
        plan: &'a Plan,
        scheme: SchemeName,
        every: u32,
        with_energy: bool,
        files: &mut HistoryFiles<'_>,
        progress: &Progress,
    ) -> Outcome<Self> {
        let (run, settle) = (&plan.run, plan.settle);
        let mut samples = Vec::new();
        let mut statistics = Statistics::default();
        let mut energy = with_energy.then(|| EnergyBook::open(&run.joint, run.tick_rate, run.ticks)).flatten();
        let mut ticks = 0;
        let end = follow::follow(run, scheme, 0.0, &mut |moment| {
            ticks = moment.tick;
            if moment.tick.is_multiple_of(every) {
                files.write(moment)?;
                samples.push(moment.clone());
            }
            if moment.tick >= settle {
                statistics.take(moment);
            }
            if let Some(book) = &mut energy {
                book.take(moment);
            }
            if moment.tick.is_multiple_of(PROGRESS) {
                progress.at(moment.tick);
            }
            Ok(())
        })?;
        let mut ran = Self { plan, scheme, end, ticks, samples, statistics, energy, spectrum: None, comparison: None };
        let deflection = |moment: &Moment| moment.teeth.first().map_or(f64::NAN, |teeth| teeth.deflection);
        let signal: Vec<f64> = ran.settled().iter().map(deflection).collect();
        ran.spectrum = Spectrum::of(&signal, f64::from(run.tick_rate) / f64::from(every));
        Ok(ran)
    }

    /// Samples that count.
    pub fn settled(&self) -> &[Moment] {
        &self.samples[self.samples.partition_point(|moment| moment.tick < self.plan.settle)..]
    }

    /// The balance of energy.
    pub fn balance(&self) -> Option<Balance> {
        self.energy.as_ref().and_then(EnergyBook::balance)
    }
}
