//! How far a wrong assumption moves the standard test: motion T2 of `joint hil` on the core's own plant, with a joint that
//! has half the value, or half as much again, while its controllers believe the file.
//!
//! One run is no measure: where the teeth land is a matter of chance, and a link that is heavier by a thousandth moves the
//! figure of a run by up to 10 %. The median of a few runs, each against its own noise, moves by some percent. Controllers are
//! designed once for all runs of a joint that they believe in: a design takes half as long as a run.

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

/// The motion; controllers begin with the file's own backlash.
const TEST: &str = "profile = \"T2\"\n[controller]\nrivals = []\nwidth_guess_ratio = 1.0\n";
/// The metric of it, in mrad.
const METRIC: &str = "rms_mrad";
/// What moves nothing but chance, and so tells how much that is.
const CHANCE: &str = "bodies.link_inertia_kg_m2";
const A_THOUSANDTH: [f64; 2] = [0.999, 1.001];
/// A run of six seconds takes about one.
const LONGEST: Duration = Duration::from_secs(600);
/// What a controller cannot do without knowing.
const KNOWN: [&str; 2] = ["bits", "control_rate_Hz"];

/// Measures every assumed line by so many seeds, and gives the figures of the file itself.
pub fn measure(text: &str, lines: &mut [Line], seeds: u64, progress: &Progress) -> Outcome<Figures> {
    let tried: Vec<&mut Line> = lines.iter_mut().filter(|line| line.is_assumed()).collect();
    progress.run("trying what is assumed", 3 + 2 * tried.len() as u64);
    let refused = |why: String| {
        Failure::new(format!("the standard test cannot be run on this joint: {why}"))
            .with_help("a figure of the data sheet may be in another unit; `joint new --help` says which is meant")
    };
    let test = StandardTest { text, seeds, designed: design(&test_file("").map_err(refused)?, text).map_err(refused)? };
    let of_file = test.figures("").map_err(refused)?;
    progress.advance(1);
    let nothing = A_THOUSANDTH.map(|factor| test.figures(&format!("[plant]\n{CHANCE} = {{ times = {factor} }}\n")));
    let mut chance = 0.0;
    for moved in nothing {
        chance = f64::max(chance, move_of(&moved.map_err(Failure::new)?, &of_file));
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

/// The test with the joint file that controllers believe.
struct StandardTest<'t> {
    text: &'t str,
    seeds: u64,
    /// Controllers for that file. No assumption changes the lost motion, which a design takes from the true joint.
    designed: Designed,
}

impl StandardTest<'_> {
    /// The larger of both moves, over the figure.
    fn moved(&self, line: &Line, of_file: &[f64]) -> Result<f64, String> {
        let values = line.wrong_values().ok_or("it is no number")?;
        let is_known = KNOWN.contains(&line.key);
        let section = if is_known { "known" } else { "plant" };
        let tried = values.map(|value| {
            let changes = format!("[{section}]\n{} = {value}\n", line.path());
            let changed = if is_known { self.figures_of_known(&changes) } else { self.figures(&changes) };
            changed.map(|changed| move_of(&changed, of_file))
        });
        match tried {
            [Ok(less), Ok(more)] => Ok(less.max(more)),
            [Err(why), _] => Err(format!("the smaller of two wrong values cannot be tried: {why}")),
            [_, Err(why)] => Err(format!("the larger of two wrong values cannot be tried: {why}")),
        }
    }

    /// The figures of all seeds with a changed joint [mrad], or why there are none, in one line.
    fn figures(&self, changes: &str) -> Result<Vec<f64>, String> {
        self.figures_under(&test_file(changes)?, &self.designed)
    }

    /// The figures of all seeds with a changed joint, and controllers that know of the changes [mrad].
    fn figures_of_known(&self, changes: &str) -> Result<Vec<f64>, String> {
        let file = test_file(changes)?;
        let designed = design(&file, self.text)?;
        self.figures_under(&file, &designed)
    }

    fn figures_under(&self, file: &TestFile, designed: &Designed) -> Result<Vec<f64>, String> {
        (1..=self.seeds).into_par_iter().map(|seed| figure_of_run(file, self.text, seed, designed)).collect()
    }
}

/// The test with changes to its joint, or what is wrong with them, in one line.
fn test_file(changes: &str) -> Result<TestFile, String> {
    file::read(&format!("{TEST}{changes}"))
        .map_err(|problems| problems.first().map_or_else(String::new, ToString::to_string))
}

/// Observer and compensation for the joint that controllers believe in.
fn design(file: &TestFile, text: &str) -> Result<Designed, String> {
    Case::new(file, text, 1, None).and_then(|case| case.design(file)).map_err(|failure| told(&failure))
}

/// A failure in one line.
fn told(failure: &Failure) -> String {
    failure.message().lines().next().unwrap_or_default().to_owned()
}

/// How far figures have moved: the median over seeds, each against its own noise, so that a single run that went astray
/// does not count for the value that was tried [-].
fn move_of(changed: &[f64], of_file: &[f64]) -> f64 {
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

/// The figure of one run [mrad].
fn figure_of_run(file: &TestFile, text: &str, seed: u64, designed: &Designed) -> Result<f64, String> {
    let case = Case::new(file, text, seed, None).map_err(|failure| told(&failure))?;
    let spec = RunSpec { controller: ControllerName::Preview, plant: PlantName::Core, without_gap: false };
    let deadline = Instant::now() + LONGEST;
    let history = execute_designed(file, &case, seed, spec, deadline, designed).map_err(|error| match error {
        RunError::Refused(failure) => told(&failure),
        other => other.to_string(),
    })?;
    let values = MetricValues::compute(file, &case, &history, None);
    let figure = values.available().find(|(metric, _)| metric.name() == METRIC).map(|(_, value)| value);
    figure.filter(|figure| *figure > 0.0).ok_or_else(|| "the run has no figure".to_owned())
}

#[cfg(test)]
mod tests {
    use super::{median, move_of};

    #[test]
    fn one_run_that_goes_astray_moves_nothing() {
        assert_eq!(median([3.0, 1.0, 2.0].into_iter()), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0].into_iter()), 2.5);
        let before = [1.0, 2.0, 4.0, 8.0];
        assert!((move_of(&[0.8, 1.6, 3.2, 800.0], &before) - 0.2).abs() < 1e-12);
    }
}
