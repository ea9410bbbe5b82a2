//! Estimates logged by a run and their comparison with a replay: the digest of every control period, and the logged
//! values.

use std::collections::BTreeMap;

use model_core::observer::Estimates;
use scenario::controller_log::{ESTIMATES_DIGEST, PERIOD, TOPIC};
use scenario::estimate_fields::{estimates_digest, fields};
use scenario::log_file;

use crate::record::{Difference, Repeats, ValueDifference};
use log_reader::columns::Columns;
use log_reader::log_file::LogFile;
use report::failure::{Failure, Outcome};

/// Estimates logged by a run.
pub struct Recorded {
    digests: Vec<u32>,
    time: Vec<f64>,
    /// Rows of values by their control period.
    rows: BTreeMap<u32, usize>,
    values: Columns,
}

impl Recorded {
    /// Reads the log of a run.
    pub fn read(file: &LogFile) -> Outcome<Self> {
        let controller = file.topic(TOPIC)?;
        let whole = |columns: &Columns, name: &str| -> Outcome<Vec<u32>> {
            Ok(columns.named(&[name])?.1.into_iter().map(|value| value as u32).collect())
        };
        let periods = whole(&controller, PERIOD)?;
        if let Some((row, period)) = (0..).zip(&periods).find(|(row, period)| row != *period) {
            let message = match row {
                0 => {
                    format!("the run begins at control period {period}: the log lacks the observer's earlier samples")
                }
                _ => format!("control periods {row} to {} of the run are missing", period.saturating_sub(1)),
            };
            return Err(Failure::new(message)
                .with_help("use the whole log; or name the joint too, to estimate from the rest of the log"));
        }
        let values = file.topic(log_file::TOPIC)?;
        let rows = whole(&values, PERIOD)?.into_iter().zip(0..).collect();
        Ok(Self { digests: whole(&controller, ESTIMATES_DIGEST)?, time: controller.time()?, rows, values })
    }

    /// Begins a comparison.
    pub fn comparison(&self) -> Agreement<'_> {
        Agreement { recorded: self, periods: 0, differing: 0, first: None, values: None }
    }

    /// Values of a period that differ from the recorded ones; `None` without recorded values.
    fn differences(&self, period: usize, estimates: &Estimates<f32>) -> Option<Vec<ValueDifference>> {
        let row = *self.rows.get(&u32::try_from(period).ok()?)?;
        let of = |field: scenario::estimate_fields::EstimateField| {
            let recorded = *self.values.column(&field.name.to_ascii_lowercase())?.get(row)?;
            let replayed = field.value(estimates);
            let name = field.name.to_owned();
            (recorded.to_bits() != replayed.to_bits()).then_some(ValueDifference { name, recorded, replayed })
        };
        Some(fields().filter_map(of).collect())
    }
}

/// Comparison in progress.
pub struct Agreement<'r> {
    recorded: &'r Recorded,
    periods: usize,
    differing: usize,
    first: Option<usize>,
    /// First logged values that differ.
    values: Option<(usize, Vec<ValueDifference>)>,
}

impl Agreement<'_> {
    /// Compares the estimates of a period.
    pub fn compare(&mut self, period: usize, estimates: &Estimates<f32>) {
        self.periods += 1;
        let differs = self.recorded.digests.get(period) != Some(&estimates_digest(estimates));
        if differs {
            self.differing += 1;
            self.first = self.first.or(Some(period));
        }
        if (differs || self.recorded.rows.contains_key(&(period as u32)))
            && self.values.is_none()
            && let Some(values) = self.recorded.differences(period, estimates).filter(|values| !values.is_empty())
        {
            // A value that differs under an equal digest was changed in the log itself.
            if !differs {
                self.differing += 1;
                self.first = self.first.or(Some(period));
            }
            self.values = Some((period, values));
        }
    }

    /// Result of the comparison.
    pub fn result(self) -> Repeats {
        let time = |period: usize| self.recorded.time.get(period).copied().unwrap_or_default();
        let missing = self.recorded.digests.len().saturating_sub(self.periods);
        let (values_period, values) = self.values.unwrap_or_default();
        Repeats {
            every_bit: self.differing == 0 && missing == 0,
            periods: self.periods,
            differing_periods: self.differing + missing,
            first_difference: self.first.map(|period| Difference {
                period,
                time_s: time(period),
                values_period: (!values.is_empty()).then_some(values_period),
                values_time_s: (!values.is_empty()).then(|| time(values_period)),
                values,
            }),
        }
    }
}
