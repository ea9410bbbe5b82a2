//! Change of the standard test by a wrong assumption: motion T2 of `joint hil` on the core's own plant, with a joint
//! that has 0.5 or 1.5 times the value while its controllers use the file.
//!
//! A single run is no measure: the landing of the teeth is chaotic, and a link heavier by a thousandth changes the
//! figure of a run by up to 10 %. The median of a few runs, each against its own noise, changes by some percent.
//! Controllers are designed once for all runs of a believed joint: a design takes half as long as a run.

use std::time::{Duration, Instant};

use rayon::prelude::*;
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;
use scenario::case::{Case, Designed};
use scenario::controller::ControllerName;
use scenario::execution::{RunSpec, execute_designed};
use scenario::file::{self, TestFile};
use scenario::plant::PlantName;
use scenario::rig::RunError;
use scenario::values::MetricValues;

use crate::lines::{Figures, Line};

/// Test file of the motion; controllers begin with the file's own backlash.
const TEST_FILE: &str = "profile = \"T2\"\n[controller]\nrivals = []\nwidth_guess_ratio = 1.0\n";
/// Metric of the test, in mrad.
const METRIC_NAME: &str = "rms_mrad";
/// Key whose change by a thousandth shows the effect of chance.
const CHANCE_KEY: &str = "bodies.link_inertia_kg_m2";
const CHANCE_FACTORS: [f64; 2] = [0.999, 1.001];
/// Deadline of a run; a run of six seconds takes about one.
const RUN_DEADLINE: Duration = Duration::from_secs(600);
/// Keys that a controller has to know.
const KNOWN_KEYS: [&str; 2] = ["bits", "control_rate_Hz"];

/// Measures every assumed line with `seeds` seeds, and returns the results of the file itself.
pub fn measure(text: &str, lines: &mut [Line], seeds: u64, progress: &Progress) -> Outcome<Figures> {
    let tried: Vec<&mut Line> = lines.iter_mut().filter(|line| line.is_assumed()).collect();
    progress.run("measuring the assumptions", 3 + 2 * tried.len() as u64);
    let refused = |why: String| {
        Failure::new(format!("the standard test cannot be run on this joint: {why}"))
            .with_help("a figure of the data sheet may be in another unit; `joint new --help` states the units")
    };
    let test = StandardTest { text, seeds, designed: design(&test_file("").map_err(refused)?, text).map_err(refused)? };
    let of_file = test.figures("").map_err(refused)?;
    progress.advance(1);
    let by_chance =
        CHANCE_FACTORS.map(|factor| test.figures(&format!("[plant]\n{CHANCE_KEY} = {{ times = {factor} }}\n")));
    let mut chance = 0.0;
    for moved in by_chance {
        chance = f64::max(chance, relative_change(&moved.map_err(Failure::new)?, &of_file));
    }
    progress.advance(2);
    tried.into_par_iter().for_each(|line| {
        if interruption::requested() {
            return;
        }
        line.moved = Some(test.moved(line, &of_file));
        progress.advance(2);
    });
    match interruption::requested() {
        true => Err(Failure::interrupted("stopped by the user")),
        false => Ok(Figures { of_file: median(of_file.into_iter()), chance, seeds }),
    }
}

/// Standard test with the joint file that the controllers use.
struct StandardTest<'t> {
    text: &'t str,
    seeds: u64,
    /// Controllers for the file. A design takes the lost motion from the true joint; no assumption changes it.
    designed: Designed,
}

impl StandardTest<'_> {
    /// Larger of both relative changes.
    fn moved(&self, line: &Line, of_file: &[f64]) -> Result<f64, String> {
        let values = line.wrong_values().ok_or("it is no number")?;
        let is_known = KNOWN_KEYS.contains(&line.key);
        let section = if is_known { "known" } else { "plant" };
        let tried = values.map(|value| {
            let changes = format!("[{section}]\n{} = {value}\n", line.path());
            let changed = if is_known { self.figures_with_known_change(&changes) } else { self.figures(&changes) };
            changed.map(|changed| relative_change(&changed, of_file))
        });
        match tried {
            [Ok(less), Ok(more)] => Ok(less.max(more)),
            [Err(why), _] => Err(format!("the smaller of two wrong values cannot be tried: {why}")),
            [_, Err(why)] => Err(format!("the larger of two wrong values cannot be tried: {why}")),
        }
    }

    /// Results of all seeds with a changed joint [mrad], or the reason for a failure in one line.
    fn figures(&self, changes: &str) -> Result<Vec<f64>, String> {
        self.figures_under(&test_file(changes)?, &self.designed)
    }

    /// Results of all seeds with a changed joint known to the controllers [mrad].
    fn figures_with_known_change(&self, changes: &str) -> Result<Vec<f64>, String> {
        let file = test_file(changes)?;
        let designed = design(&file, self.text)?;
        self.figures_under(&file, &designed)
    }

    fn figures_under(&self, file: &TestFile, designed: &Designed) -> Result<Vec<f64>, String> {
        (1..=self.seeds).into_par_iter().map(|seed| figure_of_run(file, self.text, seed, designed)).collect()
    }
}

/// Test file with changes to its joint, or their fault in one line.
fn test_file(changes: &str) -> Result<TestFile, String> {
    file::read(&format!("{TEST_FILE}{changes}"))
        .map_err(|problems| problems.first().map_or_else(String::new, ToString::to_string))
}

/// Designs observer and compensation for the believed joint.
fn design(file: &TestFile, text: &str) -> Result<Designed, String> {
    Case::new(file, text, 1, None).and_then(|case| case.design(file)).map_err(|failure| first_line(&failure))
}

/// First line of a failure.
fn first_line(failure: &Failure) -> String {
    failure.message().lines().next().unwrap_or_default().to_owned()
}

/// Relative change: the median over seeds, each against its own noise, so that a single outlier does not count [-].
fn relative_change(changed: &[f64], of_file: &[f64]) -> f64 {
    (median(changed.iter().zip(of_file).map(|(changed, before)| changed / before)) - 1.0).abs()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        even if even % 2 == 0 => 0.5 * (values[middle - 1] + values[middle]),
        _ => values[middle],
    }
}

/// Result of one run [mrad].
fn figure_of_run(file: &TestFile, text: &str, seed: u64, designed: &Designed) -> Result<f64, String> {
    let case = Case::new(file, text, seed, None).map_err(|failure| first_line(&failure))?;
    let spec = RunSpec { controller: ControllerName::Preview, plant: PlantName::Core, without_gap: false };
    let deadline = Instant::now() + RUN_DEADLINE;
    let history = execute_designed(file, &case, seed, spec, deadline, designed).map_err(|error| match error {
        RunError::Refused(failure) => first_line(&failure),
        other => other.to_string(),
    })?;
    let values = MetricValues::compute(file, &case, &history, None);
    let figure = values.available().find(|(metric, _)| metric.name() == METRIC_NAME).map(|(_, value)| value);
    figure.filter(|figure| *figure > 0.0).ok_or_else(|| "the run has no figure".to_owned())
}

#[cfg(test)]
mod tests {
    use super::{median, relative_change};

    /// A single outlier does not change the median of the relative changes.
    #[test]
    fn relative_change_ignores_outlier() {
        assert_eq!(median([3.0, 1.0, 2.0].into_iter()), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0].into_iter()), 2.5);
        let before = [1.0, 2.0, 4.0, 8.0];
        assert!((relative_change(&[0.8, 1.6, 3.2, 800.0], &before) - 0.2).abs() < 1e-12);
    }
}
