//! One case of a test file, for one seed: the true joint with its surroundings, the nominal joint for the controllers,
//! the motion, and the disturbance torques.

use std::collections::BTreeMap;
use std::sync::Arc;

use joint_file::{JointFile, Problem, Severity};
use model_core::compensation::CompensationTables;
use model_core::compensation::design::{
    CompensationSettings, compensation_settings, design_compensation, good_bandwidth,
};
use model_core::observer::design::{design_observer, design_usual_probe, observer_settings};
use model_core::observer::{Memory, ObserverTables, ProbeTable};
use parameters::{JointParameters, Surroundings};
use reference::closed_loop::rivals::Knowledge;
use reference::closed_loop::{Profile as Standard, SharedProfile};
use reference::drive_train::{Disturbance, DriveTrainParameters};
use reference::joint::mean_half_backlash;

use super::any_motion::{any_motion, real_motion};
use super::controller_log::ObserverOrigin;
use super::disturbances::disturbances;
use super::encoder_zeros::EncoderZeros;
use super::file::{Change, MotionProfile, NewValue, TestFile, Trajectory};
use super::random::{NumberOrRange, RandomStream};
use super::recorded::RecordedMotion;
use super::surroundings::train;
use report::failure::{Failure, Outcome};

/// One seed of a test.
pub struct Case {
    /// True joint.
    pub truth: JointFile,
    /// True drive train.
    pub train: DriveTrainParameters,
    /// Nominal joint, for which the controllers are designed; its backlash is a guess.
    pub nominal: JointParameters,
    /// Nominal surroundings.
    pub nominal_surroundings: Surroundings,
    /// Guessed over true half-backlash.
    pub width_guess: f64,
    /// Zeros of the encoders.
    pub zeros: EncoderZeros,
    /// Desired motion of the link.
    pub motion: SharedProfile,
    /// Disturbance torques on the link.
    pub disturbances: Vec<Disturbance>,
    /// Values that the seed drew, by key.
    pub drawn: BTreeMap<String, f64>,
    /// Texts of the joint files: nominal except for the backlash, and true.
    texts: [String; 2],
    /// True once the nominal joint equals its joint file in every bit.
    is_rounded: bool,
}

/// Designed tables of observer, compensation and width probe.
pub struct Designed {
    /// Tables of the observer.
    pub observer: ObserverTables<f32>,
    /// Tables of the compensation.
    pub compensation: CompensationTables<f32>,
    /// Table of the width probe, if the joint allows one.
    pub probe: Option<ProbeTable<f32>>,
    /// Clock ticks in a control period.
    pub ticks: u32,
}

/// Draws one value of a range.
type Draw<'p> = dyn FnMut(&str, NumberOrRange) -> f64 + 'p;

impl Case {
    /// Draws the case of a seed; `text` is the joint file's.
    pub fn new(file: &TestFile, text: &str, seed: u64, motion: Option<&RecordedMotion>) -> Outcome<Self> {
        let mut drawn = BTreeMap::new();
        let mut draw = |name: &str, quantity: NumberOrRange| {
            let mut stream = RandomStream::new(seed, name);
            // Bits and counts of an encoder are whole numbers.
            let whole = [".bits", ".counts_per_turn"].iter().any(|key| name.ends_with(key));
            let value = if whole { quantity.draw_whole(&mut stream) } else { quantity.draw(&mut stream) };
            if matches!(quantity, NumberOrRange::Between(..)) {
                drawn.insert(name.to_owned(), value);
            }
            value
        };
        let texts = joint_texts(file, text, &mut draw).map_err(|problem| Failure::new(problem.to_string()))?;
        let read = |text: &str| {
            joint_file::read(text).map_err(|problems| {
                let message = problems.first().map_or_else(String::new, ToString::to_string);
                Failure::new(format!("the joint that seed {seed} draws cannot be: {message}"))
                    .with_help("narrow the ranges in [known] and [plant]")
            })
        };
        let [known, truth] = &texts;
        let (known, truth) = (read(known)?, read(truth)?);
        // An unmeasured width is wrong by half, the sign depending on the seed.
        let usual = NumberOrRange::Exactly(if seed.is_multiple_of(2) { 0.5 } else { 1.5 });
        let width_guess = draw("width_guess_ratio", file.width_guess.unwrap_or(usual));
        let mut nominal = known.parameters.clone();
        let half_backlash = width_guess * mean_half_backlash(&truth.parameters);
        for mesh in [&mut nominal.sun_planet, &mut nominal.ring_planet] {
            mesh.half_backlash.iter_mut().for_each(|value| *value = half_backlash);
        }
        let rated = known.parameters.rated_output_torque;
        let train = train(&truth.surroundings, seed);
        let profile = match file.profile.trajectory {
            Trajectory::Any => any_motion(&Knowledge::of(&truth.parameters, &train, width_guess), &truth, seed),
            Trajectory::Real(motion) => {
                real_motion(motion, &Knowledge::of(&truth.parameters, &train, width_guess), &truth, seed)
            }
            _ => file.profile.clone(),
        };
        if matches!(file.profile.trajectory, Trajectory::Any | Trajectory::Real(_)) {
            drawn.extend(profile.drawn_values().into_iter().map(|(name, value)| (name.to_owned(), value)));
        }
        Ok(Self {
            zeros: EncoderZeros::draw(seed),
            nominal,
            nominal_surroundings: known.surroundings,
            train,
            truth,
            width_guess,
            motion: trajectory(&profile, motion, seed),
            disturbances: disturbances(file, &profile, motion, rated),
            drawn,
            texts,
            is_rounded: false,
        })
    }

    /// Text of the true joint file.
    pub fn truth_text(&self) -> &str {
        &self.texts[1]
    }

    /// Text of the nominal joint file, for which the controllers are designed.
    pub fn nominal_text(&self) -> Outcome<String> {
        let (key, value) = match self.nominal.equivalent_gear() {
            Some(gear) => ("equivalent_gear.lost_motion_mrad", 1e3 * gear.lost_motion),
            None => {
                let half_backlash = self.nominal.sun_planet.half_backlash.first().copied().unwrap_or_default();
                ("mesh.half_backlash_um", 1e6 * half_backlash)
            }
        };
        joint_file::change(&self.texts[0], key, &format!("{value:?}"))
            .map_err(|refused| Failure::new(refused.message).with_help(refused.help))
    }

    /// Data from which an observer of this case can repeat a run; `None` unless the joint file holds all of the nominal
    /// joint.
    pub fn observer_origin(&self, file: &TestFile, memory: Option<Memory>) -> Option<ObserverOrigin> {
        let joint_file = self.nominal_text().ok().filter(|_| self.is_rounded)?;
        Some(ObserverOrigin { joint_file, output_encoder: file.output_encoder, memory })
    }

    /// Rounds the nominal joint to the numbers of its joint file, so that the host and a board built from the file
    /// agree in every bit.
    pub fn round_nominal(&mut self) -> Outcome<()> {
        let nominal = read_controller_joint(&self.nominal_text()?)?;
        self.nominal = nominal.parameters;
        self.nominal_surroundings = nominal.surroundings;
        self.is_rounded = true;
        Ok(())
    }

    /// True half-backlash, mean over the planets [m].
    pub fn half_backlash(&self) -> f64 {
        mean_half_backlash(&self.truth.parameters)
    }

    /// True joint without backlash.
    pub fn joint_without_gap(&self) -> JointParameters {
        let mut joint = self.truth.parameters.clone();
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.half_backlash.iter_mut().for_each(|value| *value = 0.0);
        }
        joint
    }

    /// Knowledge of the rivals: the truth except for the width.
    pub fn knowledge(&self) -> Knowledge {
        Knowledge::of(&self.truth.parameters, &self.train, self.width_guess)
    }

    /// Designs observer and compensation for the nominal joint.
    pub fn design(&self, file: &TestFile) -> Outcome<Designed> {
        let mut settings = observer_settings(&self.nominal_surroundings);
        if !file.output_encoder {
            settings.output_encoder = None;
        }
        let observer =
            design_observer(&self.nominal, &settings).map_err(|error| self.design_error("observer", &error))?;
        let law = self.compensation_settings_for(file, self.bandwidth(file)?);
        let compensation =
            design_compensation(&self.nominal, &law).map_err(|error| self.design_error("compensation", &error))?;
        let probe =
            design_usual_probe(&self.nominal, &settings).map_err(|error| self.design_error("width probe", &error))?;
        Ok(Designed { observer, compensation, probe, ticks: settings.clock_rate / settings.control_rate })
    }

    /// Settings of the compensation's design, as the file asks.
    pub fn compensation_settings_for(&self, file: &TestFile, bandwidth: f64) -> CompensationSettings {
        let usual = compensation_settings(&self.nominal_surroundings, bandwidth);
        CompensationSettings { peak_torque: file.peak_torque, ..usual }
    }

    /// Bandwidth of all controllers of a test [rad/s]: the file's, or the default of the nominal joint.
    pub fn bandwidth(&self, file: &TestFile) -> Outcome<f64> {
        let good = || good_bandwidth(&self.nominal, &self.nominal_surroundings);
        file.bandwidth.map_or_else(good, Ok).map_err(|error| self.design_error("compensation", &error))
    }

    /// Error: the nominal joint cannot be designed for.
    fn design_error(&self, what: &str, error: &dyn std::fmt::Display) -> Failure {
        Failure::new(format!("no {what} can be designed for joint `{}`: {error}", self.nominal.name))
    }
}

/// Reads the joint file of a controller.
pub fn read_controller_joint(text: &str) -> Outcome<JointFile> {
    joint_file::read(text).map_err(|problems| {
        let first = problems.first().map_or_else(String::new, ToString::to_string);
        Failure::new(format!("the controller's nominal joint is not possible: {first}"))
    })
}

/// Checks the changes of a file at both ends of their ranges, before any run.
pub fn check_changes(file: &TestFile, text: &str) -> Result<(), Vec<Problem>> {
    for end in [0, 1] {
        joint_texts(file, text, &mut |_, quantity| quantity.ends()[end]).map_err(|problem| vec![problem])?;
    }
    Ok(())
}

/// Texts of the nominal and of the true joint file.
fn joint_texts(file: &TestFile, text: &str, draw: &mut Draw<'_>) -> Result<[String; 2], Problem> {
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
    apply_changes(&mut known, &file.known, "known", draw)?;
    let mut truth = known.clone();
    apply_changes(&mut truth, &file.plant, "plant", draw)?;
    Ok([known, truth])
}

/// Applies changes to the text of a joint file. Keys may depend on one another, so the joint is read after all changes;
/// only if it cannot be read is the first change found after which it cannot.
fn apply_changes(text: &mut String, changes: &[Change], section: &str, draw: &mut Draw<'_>) -> Result<(), Problem> {
    let before = text.clone();
    for change in changes {
        apply_change(text, change, section, draw)?;
    }
    if joint_file::read(text).is_ok() {
        return Ok(());
    }
    *text = before;
    let mut last = None;
    for change in changes {
        apply_change(text, change, section, draw)?;
        let problems = joint_file::read(text).err();
        let first = problems.and_then(|list| list.into_iter().find(|problem| problem.severity == Severity::Error));
        // A problem that a later change removes is not reported.
        last = first.map(|first| last.take().unwrap_or((change.span.clone(), first.message, first.help)));
    }
    last.map_or(Ok(()), |(span, message, help)| {
        Err(problem(span, format!("the changed joint is not valid: {message}"), help))
    })
}

fn apply_change(text: &mut String, change: &Change, section: &str, draw: &mut Draw<'_>) -> Result<(), Problem> {
    let name = format!("{section}.{}", change.key);
    let value = match &change.value {
        NewValue::Text(text) => text.clone(),
        NewValue::Number(quantity) => format_number(draw(&name, *quantity), *quantity),
        NewValue::Times(quantity) => {
            let stated = joint_file::value(text, &change.typed).ok().flatten();
            let was: f64 = stated.and_then(|typed| typed.replace('_', "").parse().ok()).ok_or_else(|| {
                let message = format!("the joint file does not state `{}` as one number", change.key);
                problem(change.span.clone(), message, "give the new value itself, in place of { times = ... }")
            })?;
            (was * draw(&name, *quantity)).to_string()
        }
    };
    *text = joint_file::change(text, &change.typed, &value)
        .map_err(|refused| problem(change.span.clone(), refused.message, refused.help))?;
    Ok(())
}

/// Formats a number for a key; whole numbers stay whole, as some keys require.
fn format_number(value: f64, quantity: NumberOrRange) -> String {
    let whole = quantity.ends().iter().all(|end| end.fract() == 0.0 && end.abs() < 1e9);
    match quantity {
        NumberOrRange::Exactly(_) if whole => format!("{value:.0}"),
        _ => value.to_string(),
    }
}

fn problem(span: std::ops::Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Problem {
    Problem { span, message: message.into(), help: help.into(), severity: Severity::Error }
}

fn trajectory(profile: &MotionProfile, recorded: Option<&RecordedMotion>, seed: u64) -> SharedProfile {
    match (&profile.trajectory, recorded) {
        (_, Some(recorded)) => Arc::new(recorded.clone()),
        (Trajectory::Sine(amplitude, frequency), _) => {
            Arc::new(Standard::Sine { amplitude: *amplitude, frequency: *frequency })
        }
        (Trajectory::Random(amplitude, highest), _) => {
            Arc::new(Standard::Random { amplitude: *amplitude, highest: *highest, seed })
        }
        (Trajectory::Steps(height, duration, rest), _) => {
            Arc::new(Standard::Steps { height: *height, duration: *duration, rest: *rest, seed })
        }
        (Trajectory::Walking(amplitude, frequency), _) => {
            Arc::new(Standard::Walking { amplitude: *amplitude, frequency: *frequency })
        }
        (Trajectory::Hold(angle), _) => Arc::new(Standard::Hold(*angle)),
        // A recording has been read, and a random motion drawn, before this point.
        (Trajectory::File(_) | Trajectory::Any | Trajectory::Real(_), None) => Arc::new(Standard::Hold(0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::Case;
    use crate::any_motion::{USABLE_TORQUE_SHARE, any_motion, available_torque, breakaway_torque, real_motion};
    use crate::file::{self, ProfileLoad, RealMotion, Trajectory};
    use reference::closed_loop::rivals::Knowledge;

    /// A hundred motions with their loads on preset Q1: all differ, and all are within the motor's torque.
    #[test]
    fn any_motions_within_torque_and_distinct() {
        let text = joint_file::preset("q1").expect("a preset");
        let test = file::read("profile = \"any\"").expect("a test file");
        let mut kinds = [0; 4];
        let mut before = Vec::new();
        for seed in 1..=100 {
            let case = Case::new(&test, text, seed, None).expect("a case");
            let joint = Knowledge::of(&case.truth.parameters, &case.train, case.width_guess);
            let inertia = joint.total_inertia * joint.ratio * joint.ratio;
            let profile = any_motion(&joint, &case.truth, seed);
            kinds[match profile.trajectory {
                Trajectory::Sine(..) => 0,
                Trajectory::Random(..) => 1,
                Trajectory::Steps(..) => 2,
                _ => 3,
            }] += 1;
            // Times after the start of a sine; the load may act at the worst time.
            let times = (1000..6000).map(|moment| f64::from(moment) * 1e-3);
            let accelerated = times.map(|time| inertia * case.motion.at(time).acceleration.abs()).fold(0.0, f64::max);
            let load = match profile.load {
                ProfileLoad::Wave(_, Some(torque), _) => torque,
                _ => 0.0,
            };
            let carried = if matches!(profile.trajectory, Trajectory::Hold(_)) {
                breakaway_torque(&joint, &case.truth)
            } else {
                0.0
            };
            let most = USABLE_TORQUE_SHARE * available_torque(&joint, &case.truth);
            assert!(
                accelerated + load - carried <= most * (1.0 + 1e-9),
                "seed {seed}: {accelerated} + {load} of {most}"
            );
            assert!(accelerated + load > 0.0, "seed {seed} asks for nothing");
            let numbers = profile.drawn_values();
            assert!(numbers != before, "seed {seed} is the one before it");
            before = numbers;
        }
        assert!(kinds.iter().all(|count| *count >= 10), "{kinds:?}");
    }

    #[test]
    fn seven_seeds_cover_real_motions() {
        let text = joint_file::preset("q1").expect("a preset");
        let light = "known.gravity_torque_N_m = 2\nplant.payload_step_ratio = 3";
        let test = file::read(&format!("profile = \"real\"\n{light}")).expect("a test file");
        for first in [1, 8, 700] {
            let mut kinds = Vec::new();
            for seed in first..first + 7 {
                let case = Case::new(&test, text, seed, None).expect("a case");
                let joint = Knowledge::of(&case.truth.parameters, &case.train, case.width_guess);
                let profile = real_motion(None, &joint, &case.truth, seed);
                kinds.push(RealMotion::for_seed(seed));
                let inertia = joint.total_inertia * 36.0 + 2.0 * case.truth.parameters.link_inertia;
                let times = (1000..8000).map(|moment| f64::from(moment) * 1e-3);
                let asked = times.map(|time| inertia * case.motion.at(time).acceleration.abs()).fold(0.0, f64::max);
                let load = match profile.load {
                    ProfileLoad::Stance(Some(torque), _) => torque,
                    _ => 0.0,
                };
                let room = USABLE_TORQUE_SHARE * available_torque(&joint, &case.truth);
                assert!(asked + load <= room * (1.0 + 1e-9), "seed {seed}, {profile:?}: {asked} + {load} of {room}");
                assert_eq!(asked + load > 0.0, !matches!(profile.trajectory, Trajectory::Hold(_)), "seed {seed}");
            }
            assert!(RealMotion::ALL.iter().all(|motion| kinds.contains(motion)), "{kinds:?}");
        }
    }

    #[test]
    fn stated_real_motion_is_used() {
        let text = joint_file::preset("q1").expect("a preset");
        let test = file::read("[profile]\nkind = \"real\"\nmotion = \"slow_sine\"").expect("a test file");
        for seed in 1..8 {
            let case = Case::new(&test, text, seed, None).expect("a case");
            assert_eq!(case.drawn.get("profile.sine.frequency_Hz"), Some(&0.15), "seed {seed}");
        }
    }
}
