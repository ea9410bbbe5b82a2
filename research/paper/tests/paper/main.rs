//! Short form of the study of the paper: set P's known numbers, window edges, exponents by two methods and by closed form, a second
//! integrator, and user errors. The whole study with its bounds is `joint paper` itself.

mod command;
mod regimes;
mod windows;

use paper::numerics::attractor::{Attractor, Effort, find};
use paper::numerics::integrator::EventIntegrator;
use paper::{Arguments, StudyJoint, StudyPlan};

/// Effort sufficient for classes and points; exponents of periodic motion are accurate to 1e-3.
const SHORT: Effort =
    Effort { transient: 200, longest_transient: 500, alignment: 40, points: 150, chaotic_periods: 150 };

#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

/// Plan of a command line.
fn plan(words: &[&str]) -> report::failure::Outcome<StudyPlan> {
    let line = <Line as clap::Parser>::try_parse_from(["paper"].iter().chain(words)).expect("a command line");
    StudyPlan::new(&line.arguments)
}

/// Preset or file as a joint of the study.
fn subject(file: &str, omega: Option<&str>) -> StudyJoint {
    let mut words = vec![file];
    words.extend(omega.iter().flat_map(|omega| ["--omega", omega]));
    plan(&words).expect("a good plan").subjects.remove(0)
}

/// Attractor of the motion from rest at a half-backlash [um].
fn from_rest(subject: &StudyJoint, half_backlash: f64, effort: &Effort) -> Attractor {
    let system = subject.system(half_backlash / 1e6).expect("it can be studied");
    find(&mut EventIntegrator::from_rest(&system), effort).expect("it runs")
}
