//! A test file made concrete for one seed: the true joint and its surroundings, what controllers are told of them, the
//! motion, the pushes. Nothing runs here.

use std::path::Path;
use std::sync::Arc;

use joint_file::{JointFile, Problem, Severity};
use model_core::compensation::CompensationTables;
use model_core::compensation::design::{CompensationSettings, compensation_settings, design_compensation};
use model_core::observer::design::{design_observer, design_usual_probe, observer_settings};
use model_core::observer::{ObserverTables, ProbeTable};
use parameters::{JointParameters, Surroundings};
use reference::closed_loop::rivals::Knowledge;
use reference::closed_loop::{Profile as Standard, SharedProfile};
use reference::drive_train::{Disturbance, DriveTrainParameters};

use super::draw::{Quantity, Stream};
use super::file::{Change, Course, NewValue, TestFile};
use super::plant::half_backlash;
use super::pushes::disturbances;
use super::recorded::Recorded;
use super::surroundings::train;
use report::failure::{Failure, Outcome};

/// One seed of a test.
pub struct Case {
    /// The true joint.
    pub truth: JointFile,
    /// What truly surrounds it.
    pub train: DriveTrainParameters,
    /// What controllers are told of the joint; its backlash is guessed.
    pub told: JointParameters,
    /// What they are told of its surroundings.
    pub told_surroundings: Surroundings,
    /// Guessed over true half-backlash.
    pub width_guess: f64,
    /// Where the link shall be.
    pub motion: SharedProfile,
    /// What pushes it.
    pub disturbances: Vec<Disturbance>,
    /// Texts of the joint files: as controllers know the joint but for its backlash, and the truth.
    texts: [String; 2],
}

/// What observer and compensation are designed to for a case.
pub struct Designed {
    /// Tables of the observer.
    pub observer: ObserverTables<f32>,
    /// Tables of the compensation.
    pub compensation: CompensationTables<f32>,
    /// Table of the width probe, where one can be.
    pub probe: Option<ProbeTable<f32>>,
    /// Clock ticks in a control period.
    pub ticks: u32,
}

/// Takes one value of a range.
type Pick<'p> = dyn FnMut(&str, Quantity) -> f64 + 'p;

impl Case {
    /// The case of a seed. `text` is the joint file's.
    pub fn new(file: &TestFile, text: &str, seed: u64, motion: Option<&Recorded>) -> Outcome<Self> {
        let mut pick = |name: &str, quantity: Quantity| quantity.draw(&mut Stream::new(seed, name));
        let texts = texts(file, text, &mut pick).map_err(|problem| Failure::new(problem.to_string()))?;
        let read = |text: &str| {
            joint_file::read(text).map_err(|problems| {
                let message = problems.first().map_or_else(String::new, ToString::to_string);
                Failure::new(format!("the joint that seed {seed} draws cannot be: {message}"))
                    .with_help("narrow the ranges in [known] and [plant]")
            })
        };
        let [known, truth] = &texts;
        let (known, truth) = (read(known)?, read(truth)?);
        // What nobody has measured is wrong by half, one way or the other.
        let usual = Quantity::Exactly(if seed.is_multiple_of(2) { 0.5 } else { 1.5 });
        let width_guess = pick("width_guess_ratio", file.width_guess.unwrap_or(usual));
        let mut told = known.parameters.clone();
        let half_backlash = width_guess * half_backlash(&truth.parameters);
        for mesh in [&mut told.sun_planet, &mut told.ring_planet] {
            mesh.half_backlash.iter_mut().for_each(|value| *value = half_backlash);
        }
        let rated = known.parameters.rated_output_torque;
        Ok(Self {
            told,
            told_surroundings: known.surroundings,
            train: train(&truth.surroundings, seed),
            truth,
            width_guess,
            motion: course(file, motion, seed),
            disturbances: disturbances(file, motion, rated),
            texts,
        })
    }

    /// The joint file of the truth.
    pub fn truth_text(&self) -> &str {
        &self.texts[1]
    }

    /// The joint file that a controller is told.
    pub fn told_text(&self) -> Outcome<String> {
        let half_backlash = self.told.sun_planet.half_backlash.first().copied().unwrap_or_default();
        joint_file::change(&self.texts[0], "mesh.half_backlash_um", &format!("{:?}", 1e6 * half_backlash))
            .map_err(|refused| Failure::new(refused.message).with_help(refused.help))
    }

    /// Puts what a joint file says in the place of what controllers are told, so that a board that is built from the file
    /// is told the same to the last bit.
    pub fn tell(&mut self, told: &JointFile) {
        self.told = told.parameters.clone();
        self.told_surroundings = told.surroundings;
    }

    /// True half-backlash, mean over the planets [m].
    pub fn half_backlash(&self) -> f64 {
        half_backlash(&self.truth.parameters)
    }

    /// The same case with teeth that have no gap.
    pub fn joint_without_gap(&self) -> JointParameters {
        let mut joint = self.truth.parameters.clone();
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.half_backlash.iter_mut().for_each(|value| *value = 0.0);
        }
        joint
    }

    /// What rivals know: the truth, but for the width.
    pub fn knowledge(&self) -> Knowledge {
        Knowledge::of(&self.truth.parameters, &self.train, self.width_guess)
    }

    /// Designs observer and compensation from what they are told.
    pub fn design(&self, file: &TestFile) -> Outcome<Designed> {
        let mut settings = observer_settings(&self.told_surroundings);
        if !file.output_encoder {
            settings.output_encoder = None;
        }
        let refused = |what: &str, error: &dyn std::fmt::Display| {
            Failure::new(format!("no {what} can be designed for joint `{}`: {error}", self.told.name))
        };
        let observer = design_observer(&self.told, &settings).map_err(|error| refused("observer", &error))?;
        let compensation = design_compensation(&self.told, &self.settings_of_law(file))
            .map_err(|error| refused("compensation", &error))?;
        let probe = design_usual_probe(&self.told, &settings).map_err(|error| refused("width probe", &error))?;
        Ok(Designed { observer, compensation, probe, ticks: settings.clock_rate / settings.control_rate })
    }

    /// What a compensation is designed to, as a file asks for it.
    pub fn settings_of_law(&self, file: &TestFile) -> CompensationSettings {
        let usual = compensation_settings(&self.told_surroundings, file.bandwidth);
        CompensationSettings { peak_torque: file.peak_torque, ..usual }
    }
}

/// Tries the changes of a file at both ends of their ranges, so that what cannot be is found before anything runs.
pub fn check_changes(file: &TestFile, text: &str) -> Result<(), Vec<Problem>> {
    for end in [0, 1] {
        texts(file, text, &mut |_, quantity| quantity.ends()[end]).map_err(|problem| vec![problem])?;
    }
    Ok(())
}

/// The joint file as controllers know it, and as it truly is.
fn texts(file: &TestFile, text: &str, pick: &mut Pick<'_>) -> Result<[String; 2], Problem> {
    let rated = joint_file::read(text).map_or(1.0, |joint| joint.parameters.rated_output_torque);
    let mut known = text.to_owned();
    let of_profile =
        [("load_coulomb_friction_N_m", file.profile.friction), ("gravity_torque_N_m", file.profile.gravity)];
    for (key, share) in of_profile {
        if let Some(share) = share {
            known = joint_file::change(&known, key, &(share * rated).to_string())
                .map_err(|refused| problem(0..0, refused.message, refused.help))?;
        }
    }
    apply(&mut known, &file.known, "known", pick)?;
    let mut truth = known.clone();
    apply(&mut truth, &file.plant, "plant", pick)?;
    Ok([known, truth])
}

fn apply(text: &mut String, changes: &[Change], section: &str, pick: &mut Pick<'_>) -> Result<(), Problem> {
    for change in changes {
        let name = format!("{section}.{}", change.key);
        let value = match &change.value {
            NewValue::Text(text) => text.clone(),
            NewValue::Number(quantity) => typed(pick(&name, *quantity), *quantity),
            NewValue::Times(quantity) => {
                let stated = joint_file::value(text, &change.key).ok().flatten();
                let was: f64 = stated.and_then(|typed| typed.replace('_', "").parse().ok()).ok_or_else(|| {
                    let message = format!("the joint file does not state `{}` as one number", change.key);
                    problem(change.span.clone(), message, "give the new value itself, in place of { times = ... }")
                })?;
                (was * pick(&name, *quantity)).to_string()
            }
        };
        *text = joint_file::change(text, &change.key, &value)
            .map_err(|refused| problem(change.span.clone(), refused.message, refused.help))?;
        if let Err(problems) = joint_file::read(text) {
            let first = problems.into_iter().find(|problem| problem.severity == Severity::Error);
            let (message, help) = first.map_or_else(Default::default, |first| (first.message, first.help));
            return Err(problem(change.span.clone(), format!("the joint would be none: {message}"), help));
        }
    }
    Ok(())
}

/// A number for a key; whole numbers stay whole, since some keys want them.
fn typed(value: f64, quantity: Quantity) -> String {
    let whole = quantity.ends().iter().all(|end| end.fract() == 0.0 && end.abs() < 1e9);
    match quantity {
        Quantity::Exactly(_) if whole => format!("{value:.0}"),
        _ => value.to_string(),
    }
}

fn problem(span: std::ops::Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Problem {
    Problem { span, message: message.into(), help: help.into(), severity: Severity::Error }
}

/// The recorded motion of a file, if it has one.
pub fn recorded(file: &TestFile, folder: &Path) -> Outcome<Option<Recorded>> {
    match &file.profile.course {
        Course::File(name) => Recorded::read(&folder.join(name)).map(Some),
        _ => Ok(None),
    }
}

fn course(file: &TestFile, recorded: Option<&Recorded>, seed: u64) -> SharedProfile {
    match (&file.profile.course, recorded) {
        (_, Some(recorded)) => Arc::new(recorded.clone()),
        (Course::Sine(amplitude, frequency), _) => {
            Arc::new(Standard::Sine { amplitude: *amplitude, frequency: *frequency })
        }
        (Course::Random(amplitude, highest), _) => {
            Arc::new(Standard::Random { amplitude: *amplitude, highest: *highest, seed })
        }
        (Course::Steps(height, duration, rest), _) => {
            Arc::new(Standard::Steps { height: *height, duration: *duration, rest: *rest, seed })
        }
        (Course::Hold(angle), _) => Arc::new(Standard::Hold(*angle)),
        (Course::File(_), None) => Arc::new(Standard::Hold(0.0)),
    }
}
