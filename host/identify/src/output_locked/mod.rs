//! `joint identify --output-locked`: lost motion, stiffness, half-backlash and friction from the motor's angle and
//! torque with a clamped output. The torque alternates slowly; on each flank the motor turns by
//!
//! ```text
//! theta = p_s + c T - c f d - c l d |T|                                                    (1)
//! ```
//!
//! with the angle theta of the motor over the ratio [rad], the motor's torque times the ratio T [N m], the flank s, the
//! direction d of the torque's change, the compliance c [rad/(N m)], the dry friction f [N m] and the lost share l of
//! the load. The lost motion is p_+ - p_-. `cycles` fits (1) to each cycle by least squares. The interval comes from
//! the scatter between cycles (Student), widened by the errors that all cycles share: steps and errors of the encoder,
//! cogging, curved flanks.

mod cycles;

use super::arguments::Arguments;
use super::estimate::{Estimate, NORMAL_QUANTILE};
use super::findings::gap::{Shown, static_findings};
use super::findings::{FOUND_INTERVAL_SHARE, Finding, finding};
use super::one_encoder;
use super::pictures::thinning;
use super::prior::PriorModel;
use super::results::Results;
use super::statistics::{mean, range_of};
use cycles::{Cycle, Cycles};
use joint_file::named::Loaded;
use log_reader::columns::{Columns, MOTOR, OUTPUT, TIMES};
use log_reader::resolution::resolution;
use log_reader::time_stamps;
use parameters::StiffnessWave;
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{TORQUE, Unit};

/// Largest motion of a clamped output over the motor's travel over the ratio: the gear's own compliance is far above
/// the clamp's.
const CLAMPED_TRAVEL_SHARE: f64 = 0.2;
/// Encoder error by angle allowed for any encoder [rad]; the joint file may state more.
const ENCODER_ERROR_MIN: f64 = 1e-3;
/// Ripple allowed for any torque, as a share of the largest torque; the joint file may state more cogging.
const TORQUE_RIPPLE_MIN: f64 = 0.01;
/// Delay allowed for the torque [s]; it looks like friction while the torque changes.
const TORQUE_DELAY_MAX: f64 = 1e-3;

/// Log of a joint with a clamped output.
struct ClampedLog {
    /// Time since the first sample [s].
    time: Vec<f64>,
    /// Motor angle over the ratio, less the output angle if it was logged [rad].
    twist: Vec<f64>,
    /// Motor torque times the ratio [N m].
    torque: Vec<f64>,
    /// Step of the encoders in the twist [rad].
    resolution: f64,
    /// True if the output was logged.
    has_output: bool,
    /// Changes to the rows, a sentence each.
    notes: Vec<String>,
}

/// Identifies a joint from a log with a clamped output.
pub fn identify(arguments: &Arguments, loaded: &Loaded, prior: &PriorModel) -> Outcome<Results> {
    let at_path = |failure: Failure| failure.while_doing(arguments.log.display());
    let log = ClampedLog::read(arguments, prior)?;
    let cycles = Cycles::fit(&log.time, &log.twist, &log.torque).map_err(at_path)?;
    let findings = findings(&log, &cycles, loaded, prior);
    if !findings.iter().any(Finding::adds_information) {
        return Err(at_path(
            Failure::new("nothing is identifiable from this log")
                .with_help("log more cycles of the torque, up to several times the friction, and a finer encoder"),
        ));
    }
    Ok(Results {
        duration: log.time.last().copied().unwrap_or_default(),
        crossings: cycles.crossings,
        assumptions: assumptions(&log, &cycles, prior),
        figures: vec![picture(&log, &cycles)],
        findings,
    })
}

impl ClampedLog {
    fn read(arguments: &Arguments, prior: &PriorModel) -> Outcome<Self> {
        let accepts = |columns: &Columns| columns.has_required_of([true, false]);
        arguments.read_log(prior.ratio(), accepts, |columns| Self::from_columns(columns, prior))
    }

    fn from_columns(columns: &mut Columns, prior: &PriorModel) -> Outcome<Self> {
        columns.remove_incomplete(&[&TIMES, &MOTOR, &OUTPUT, &["motor_torque_N_m"]])?;
        time_stamps::resolve(columns)?;
        let (motor, motor_count) =
            one_encoder::angle(columns, MOTOR, prior.motor_turn)?.ok_or_else(|| columns.missing_encoder("motor"))?;
        let output = one_encoder::angle(columns, OUTPUT, prior.output_turn)?;
        let time = one_encoder::rising_time(columns)?;
        let torque = one_encoder::torque_at_output(columns, prior.ratio())?;
        let mut twist: Vec<f64> = motor.iter().map(|angle| (angle - motor[0]) / prior.ratio()).collect();
        let mut resolution = motor_count / prior.ratio();
        if let Some((output, count)) = &output {
            let [moved, way] = [output, &twist].map(|angles| range_of(angles));
            if moved > CLAMPED_TRAVEL_SHARE * way + count {
                return Err(Failure::new(format!(
                    "the output is not held: it moves by {} rad, the motor over its ratio by {} rad",
                    ESTIMATE.write(moved),
                    ESTIMATE.write(way)
                ))
                .with_help("clamp the output, or leave --output-locked out"));
            }
            twist.iter_mut().zip(output).for_each(|(twist, angle)| *twist -= angle - output[0]);
            resolution += count;
        }
        Ok(Self { torque, notes: columns.notes().to_vec(), has_output: output.is_some(), time, twist, resolution })
    }
}

/// Mean of a parameter over the cycles, with the interval from their scatter.
fn of_cycles(cycles: &Cycles, parameter: impl Fn(&Cycle) -> f64) -> Estimate {
    Estimate::of_repeats(&cycles.all.iter().map(parameter).collect::<Vec<_>>())
}

fn findings(log: &ClampedLog, cycles: &Cycles, loaded: &Loaded, prior: &PriorModel) -> Vec<Finding> {
    let around = &prior.surroundings;
    let [least, most] = cycles.loads;
    let compliance = of_cycles(cycles, |cycle| cycle.compliance);
    let bent = mean(&cycles.all.iter().map(|cycle| cycle.curvature).collect::<Vec<_>>()).abs();
    let loss = mean(&cycles.all.iter().map(|cycle| cycle.loss).collect::<Vec<_>>());
    // The slope of an encoder error over the small travel is at most its amplitude times its periods per turn.
    let encoder = &around.motor_encoder;
    let by_encoder =
        (encoder.once_per_turn_error.abs() + 2.0 * encoder.twice_per_turn_error.abs()).max(ENCODER_ERROR_MIN);
    let ripple = (prior.ratio() * around.cogging_torque.abs()).max(TORQUE_RIPPLE_MIN * most);
    let turned = f64::from(around.cogging_periods_per_turn) * prior.ratio() * compliance.value.abs() * (most - least);
    let by_ripple = ripple * turned.min(2.0) / (most - least);
    let by_scale = NORMAL_QUANTILE * prior.torque_error;
    let shared = compliance.value * (by_encoder + by_ripple + 0.5 * loss * loss) + 0.5 * bent;
    let compliance = compliance.widened_by(shared).with_half_at_least(log.resolution / (most - least));
    let lost_motion = of_cycles(cycles, |cycle| cycle.lost_motion);
    let lost_motion = lost_motion
        .widened_by(by_encoder * (lost_motion.value + compliance.value * most))
        .widened_by(2.0 * compliance.value * ripple * turned.min(1.0) + bent * (least + most))
        .with_half_at_least(log.resolution);
    let compliance = compliance.with_independent_error(by_scale * compliance.value);
    // At one place of the turn a mesh is stiffer or softer than its mean, and tooth errors reduce the gap.
    let joint = &loaded.file.parameters;
    let (StiffnessWave::Harmonic { stiffness_ratio: wave } | StiffnessWave::Rectangular { stiffness_ratio: wave, .. }) =
        joint.sun_planet.stiffness_wave;
    let of_all_meshes = compliance.widened_by(prior.mesh_compliance * wave / (1.0 - wave));
    let errors = [&joint.sun_planet, &joint.ring_planet].map(|mesh| &mesh.transmission_error);
    let teeth = errors.into_iter().flatten().fold(0.0_f64, |most, error| most.max(error.abs())) / prior.lever;
    let half_gap = lost_motion.scaled(0.5).widened_by(if prior.equivalent { 0.0 } else { teeth });
    let shown = |estimate: Estimate| estimate.value > 0.0 && estimate.half < FOUND_INTERVAL_SHARE * estimate.value;
    let width = Shown {
        is_shown: shown(lost_motion),
        why: "the gap must be wider than the encoder's resolution, and the torque must reach several times the \
             friction in both directions",
    };
    let bend = Shown {
        is_shown: shown(of_all_meshes),
        why: "the torque must bend the joint by several counts of the encoder",
    };
    let mut findings = static_findings(prior, [half_gap, lost_motion.scaled(0.5), of_all_meshes], [width, bend]);
    if prior.sharing.is_some() {
        findings[0] = findings[0].clone().only_if(
            false,
            "planets mesh out of phase, so that tooth errors reduce the gap by an amount that one place of the \
                 turn does not show",
        );
    }
    let friction = of_cycles(cycles, |cycle| cycle.friction);
    let late = TORQUE_DELAY_MAX * cycles.torque_rate;
    let friction = friction
        .with_independent_error(by_scale * friction.value)
        .widened_by(ripple + late)
        .scaled(1.0 / prior.ratio());
    let known = friction.half < (FOUND_INTERVAL_SHARE * friction.value.abs()).max(0.02 * most / prior.ratio());
    let key = "drive_train.motor_coulomb_friction_N_m";
    findings.push(
        finding("dry friction of the motor", "N m", key, friction)
            .only_if(known, "the torque's ripple and its delay hide it: let the torque change more slowly")
            .not_negative(),
    );
    findings
}

/// Assumptions behind the numbers.
fn assumptions(log: &ClampedLog, cycles: &Cycles, prior: &PriorModel) -> Vec<String> {
    let mut list = vec![
        format!(
            "The output is held, as stated: {} cycles of torque, each up to {} N m at the output.",
            cycles.all.len(),
            ESTIMATE.write(cycles.loads[1])
        ),
        if log.has_output {
            "The motion of the output is subtracted: the compliance is the gear's alone.".to_owned()
        } else {
            "The output's encoder is not in the log: the compliance found includes the clamp's.".to_owned()
        },
        "All values are of one place of the turn: lock the output at other places to see how they vary.".to_owned(),
        format!(
            "The flanks are taken as straight from {} to {} N m; the intervals include their curvature.",
            ESTIMATE.write(cycles.loads[0]),
            ESTIMATE.write(cycles.loads[1])
        ),
        format!(
            "The torque's scale has a standard deviation of {:.1} %; the intervals of compliance and friction \
                 include it.",
            100.0 * prior.torque_error
        ),
        format!("Ratio {} / {}; motor encoder of {}.", prior.teeth[1], prior.teeth[0], resolution(prior.motor_turn)),
    ];
    list.extend(log.notes.iter().cloned());
    list
}

/// Twist over torque with the fitted flanks.
fn picture(log: &ClampedLog, cycles: &Cycles) -> Figure {
    let every = thinning(log.time.len());
    let points = log.torque.iter().copied().zip(log.twist.iter().copied()).step_by(every).collect();
    let parts: [fn(&Cycle) -> f64; 3] = [|cycle| cycle.compliance, |cycle| cycle.ends[0], |cycle| cycle.ends[1]];
    let [compliance, upper, lower] = parts.map(|part| of_cycles(cycles, part).value);
    let reach = cycles.loads[1];
    let flank = |end: f64, side: f64, label: &str| Mark::Line {
        points: vec![(0.0, end), (side * reach, end + side * reach * compliance)],
        ink: Ink::Text,
        label: label.into(),
        width: 2.0,
    };
    let marks = vec![
        Mark::Points { points, ink: Ink::First, label: "samples".into(), size: 2.0 },
        flank(upper, 1.0, "fit"),
        flank(lower, -1.0, ""),
    ];
    let unit = Unit::of_angle(range_of(&log.twist));
    let panel = Panel { height: 420, ..Panel::lines("Motor over ratio, output held", unit, marks) };
    let note = "The step between the flanks at no torque is the lost motion; friction makes the loop.".into();
    let range = (-1.05 * reach, 1.05 * reach);
    Figure { note, ..Figure::new("Twist over torque", "motor torque times ratio", TORQUE, range, vec![panel]) }
}
