//! `joint identify`: estimates a joint's backlash, compliance, damping, friction and encoder errors from a recorded
//! reversal test, each with its interval, and writes a patched joint file.
//!
//! The crate `log-reader` reads logs into columns and resamples angles at even times. `log` turns columns into samples,
//! `sampling` checks their rate. `prior` holds the values of the joint file. `rows` selects the moments at which a
//! flank carries, smoothed by `kernel`. `twist` and `friction` are fitted to these moments by `regression`;
//! `load_sharing` models the reduction of the gap by planets out of phase. `balances` compare torque with inertias for
//! `contradictions` and `scales`. `findings` are the results, made of `estimate`s; `page`, `pictures` and `patch` write
//! them. `virtual_test` simulates a log without hardware. `quasi_static` handles slow logs, `output_locked` logs of a
//! joint with a clamped output, `output_only` logs without the motor's angle; the last two read their columns through
//! `one_encoder`.

mod arguments;
mod balances;
mod contradictions;
mod estimate;
pub mod findings;
mod friction;
mod harmonic;
mod kernel;
mod load_sharing;
mod log;
pub mod memory;
mod one_encoder;
mod output_locked;
mod output_only;
pub mod page;
mod patch;
mod pictures;
mod prior;
mod quasi_static;
mod refusal;
mod regression;
mod results;
mod rows;
mod sampling;
mod scales;
#[cfg(test)]
mod schema;
mod statistics;
mod twist;
pub mod virtual_test;

pub use arguments::Arguments;
use findings::{Finding, Record};
use log::Log;
use page::{FINDINGS, JOINT, REPORT};
use prior::{Losses, PriorModel};
pub use quasi_static::Options;
use results::Results;
use rows::Rows;
use scales::{ScaleUncertainty, Scales};
use twist::Twist;

use joint_file::named::{self, Loaded};
use joint_file::warnings;
use std::path::Path;

use log_reader::column_map::{self, MappedJoint};
use log_reader::columns;
use log_reader::resolution::resolution;
use parameters::AbsoluteEncoder;
use report::document::{html, terminal};
use report::failure::{EXIT_INTERRUPTED, Failure, Outcome};
use report::folder::{self, Folder};
use report::number::ESTIMATE;
use report::output;
use report::progress::Progress;
use report::write::write_text;

/// Kernel box for the friction fit, which needs exact accelerations and no bandwidth [s].
const FRICTION_BOX: f64 = 4e-3;

/// Shortest kernel box of the twist fit [s]; at most 1/BOXES_PER_SWING of the swing's period.
const SHORTEST_BOX: f64 = 1e-3;
const BOXES_PER_SWING: f64 = 6.0;
/// The box grows by BOX_GROWTH up to LONGEST_BOX [s] until the reliability of the fit exceeds RELIABILITY_TARGET: with
/// a short box, encoder quantisation dominates the accelerations.
const BOX_GROWTH: f64 = 1.4;
const LONGEST_BOX: f64 = 8e-3;
const RELIABILITY_TARGET: f64 = 0.9;
/// Least reliability of a fit that is used.
const RELIABILITY_MIN: f64 = 0.5;

/// Fits in succession; each removes the angle errors of the previous one from the accelerations.
const CORRECTION_ROUNDS: usize = 4;

/// Result of the fits of one log.
struct Identified {
    log: Log,
    /// Values of the joint file, with the inertias corrected by the log.
    prior: PriorModel,
    rows: Rows,
    twist: Twist,
    findings: Vec<Finding>,
}

impl Identified {
    fn into_results(self) -> Results {
        let assumptions = assumptions(&self);
        let Self { log, prior, rows, twist, findings } = self;
        Results {
            duration: log.time.last().copied().unwrap_or_default(),
            crossings: rows.crossings,
            figures: vec![pictures::loop_of(&log, &rows, &twist, &prior), pictures::time_history(&log, &twist)],
            findings,
            assumptions,
        }
    }
}

/// Folder above the results of several joints: one folder per log, one below it per joint.
const RESULTS_FOLDER: &str = "joint-out/identify";

/// Identifies the joint of a log, or every joint of a column map, or simulates a log; returns the printed result.
pub fn run(arguments: &Arguments, progress: &Progress) -> Outcome<String> {
    let joints = column_map::joints(arguments.map.as_deref())?;
    if joints.is_empty() || arguments.map_joint.is_some() {
        return run_one(arguments, progress);
    }
    if arguments.json.is_some() {
        return Err(Failure::new("--json holds the findings of a single joint, but the map has several")
            .with_help("omit it, as each joint's folder has findings.json; or choose a joint with --map-joint NAME"));
    }
    let log = arguments.log.file_stem().unwrap_or_default();
    let out = arguments.out.clone().unwrap_or_else(|| Path::new(RESULTS_FOLDER).join(log));
    let (mut text, mut refused): (String, Vec<(String, Failure)>) = (String::new(), Vec::new());
    for MappedJoint { name, file } in joints {
        let joint = file.unwrap_or_else(|| arguments.joint.clone());
        let own = Arguments { joint, out: Some(out.join(&name)), map_joint: Some(name.clone()), ..arguments.clone() };
        match run_one(&own, progress) {
            Ok(found) => text += &format!("{name}\n{found}\n"),
            Err(failure) if failure.exit_code() == EXIT_INTERRUPTED => return Err(failure),
            Err(failure) => refused.push((name, failure)),
        }
    }
    if refused.is_empty() {
        return Ok(text);
    }
    // Findings of the other joints are printed before the failure.
    output::print(&text)?;
    let messages: Vec<String> =
        refused.iter().map(|(name, failure)| format!("{name}: {}", failure.message())).collect();
    let helps = refused.iter().filter_map(|(name, failure)| Some(format!("{name}: {}", failure.full_help()?)));
    Err(Failure::new(messages.join("; ")).with_help(helps.collect::<Vec<_>>().join("\n")))
}

fn run_one(arguments: &Arguments, progress: &Progress) -> Outcome<String> {
    if arguments.slow.quasi_static {
        return slow_log(arguments, progress);
    }
    if arguments.column.iter().any(|(own, _)| own == columns::DIFFERENCE) {
        return Err(Failure::new(format!("only --quasi-static reads a column {}", columns::DIFFERENCE))
            .with_help("add --quasi-static for a slow log, or name the motor's own column"));
    }
    let loaded = named::load_with(&arguments.joint, &arguments.set)?;
    warnings::print(&loaded);
    if arguments.simulate {
        return simulate(arguments, &loaded, progress);
    }
    let prior = PriorModel::new(&loaded, arguments)?;
    folder::check_files(&[("json", arguments.json.as_deref())], &[&arguments.log, &arguments.joint])?;
    let folder = Folder::choose(arguments.out.as_deref(), "identify", &prior.name, &[REPORT, JOINT, FINDINGS])?;
    progress.stage("fitting");
    let results = if arguments.output_locked {
        output_locked::identify(arguments, &loaded, &prior)?
    } else if arguments.output_only {
        output_only::identify(arguments, &loaded, &prior)?
    } else {
        identify(arguments, &prior)?.into_results()
    };
    let name = arguments.log.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let patched = patch::patch(&loaded, &prior, &results.findings, &name)?;
    let record = Record {
        schema: "joint-identify/1",
        joint: &prior.name,
        log: &name,
        duration_s: results.duration,
        crossings: results.crossings,
        assumptions: &results.assumptions,
        findings: &results.findings,
    };
    let document = page::document(&record, &loaded.text, results.figures);
    let json = output::json("findings", &record)?;
    folder.make()?;
    folder.write_text(REPORT, &html(&document))?;
    folder.write_text(JOINT, &patched)?;
    folder.write_text(FINDINGS, &json)?;
    arguments.json.as_ref().map_or(Ok(()), |path| output::write_json(path, &json))?;
    progress.clear();
    let [report, joint] = [REPORT, JOINT].map(|name| folder.file(name));
    Ok(format!("{}\nreport: {}\njoint file: {}\n", terminal(&document), report.display(), joint.display()))
}

fn slow_log(arguments: &Arguments, progress: &Progress) -> Outcome<String> {
    let Arguments { log, topic, out, json, slow, .. } = arguments;
    let map = arguments.column_map()?;
    let common =
        quasi_static::Common { log, topic: topic.as_deref(), map: &map, out: out.as_deref(), json: json.as_ref() };
    quasi_static::run(common, slow, progress)
}

fn identify(arguments: &Arguments, prior: &PriorModel) -> Outcome<Identified> {
    let path = arguments.log.as_path();
    let read = Log::read(arguments, prior)?;
    let at_path = |failure: Failure| failure.while_doing(path.display());
    if prior.equivalent && read.output_torque.is_none() {
        return Err(at_path(Failure::new(
            "an equivalent gear cannot be identified from the motor's torque: in simulated logs the intervals \
                 missed the true values",
        ))
        .with_help(
            "log the torque between gear and link as output_torque_N_m, or record a slow log: --quasi-static finds lost \
             motion, hysteresis and friction",
        ));
    }
    let shortest = SHORTEST_BOX.min(prior.swing_period() / BOXES_PER_SWING);
    contradictions::check_angles(&read, prior)
        .and_then(|()| contradictions::check_torques(&read, prior, shortest))
        .map_err(at_path)?;
    let (length, mut rows, mut twist) = first_fit(&read, prior, shortest).map_err(at_path)?;
    let mut log = read.clone();
    let mut known = prior.clone();
    for round in 0..CORRECTION_ROUNDS {
        // Higher harmonics of the encoder errors are sought after the low ones are removed.
        while let Some(harmonic) = (round > 0).then(|| twist.strongest_harmonic(&log, &known)).flatten() {
            known.harmonics.push(harmonic);
            let Some(better) = twist::fit(&log, &rows, &known) else { break };
            twist = better;
        }
        if let Some((open, with_losses)) = fit_losses(&log, &rows, &known) {
            (known, twist) = (open, with_losses);
        }
        let prior = &known;
        let errors: [&dyn Fn(f64) -> f64; 3] = [
            &|angle| twist.error(twist::MOTOR_MAP, angle, prior),
            &|angle| twist.error(twist::OUTPUT_MAP, angle, prior),
            &|angle| twist.error(twist::TEETH, angle, prior),
        ];
        let corrected = read.with_errors_removed(errors, twist.solution.values[twist::SKEW], prior);
        let mut seen = Rows::new(&corrected, prior, length);
        twist.exclude_flights(&corrected, &mut seen, prior);
        let Some(better) = twist::fit(&corrected, &seen, prior) else { break };
        (log, rows, twist) = (corrected, seen, better);
    }
    // The estimated losses enter the joint's model until model and log agree.
    let mut prior = known;
    for _ in 0..CORRECTION_ROUNDS {
        if prior.losses != Losses::Unknown {
            break;
        }
        let (more, deviation) = twist.excess_loss(&prior);
        prior = prior.with_estimated_losses(more, deviation);
        rows = Rows::new(&log, &prior, length);
        twist.exclude_flights(&log, &mut rows, &prior);
        twist = twist::fit(&log, &rows, &prior).unwrap_or(twist);
    }
    contradictions::check_offsets(&log, &rows, &prior)
        .and_then(|()| contradictions::check_age(&twist, &prior))
        .and_then(|()| contradictions::check_filter(&log, &twist, &prior))
        .map_err(at_path)?;
    let mut uncertainty = None;
    if log.output_torque.is_some() {
        let factors = balances::sensor_factors([&rows, &Rows::new(&log, &prior, FRICTION_BOX)], &prior);
        contradictions::check_sensor(&prior, factors)
            .and_then(|()| contradictions::check_symmetry(&log, &prior))
            .map_err(at_path)?;
        let found = Scales::from_sensor(&prior, factors);
        (log, prior) = found.apply(&log, &prior);
        rows = Rows::new(&log, &prior, length);
        twist.exclude_flights(&log, &mut rows, &prior);
        twist = twist::fit_exact_torque(&log, &rows, &prior).unwrap_or(twist);
        uncertainty = Some(ScaleUncertainty { scales: found, compliance_by_inertia: 0.0 });
    }
    if let Some(free) = twist::fit_free_torque(&log, &rows, &prior) {
        contradictions::check_ringing(&log, &prior, &free.solution)
            .and_then(|()| contradictions::check_symmetry(&log, &prior))
            .map_err(at_path)?;
        let found = Scales::new(&log, &prior, &free.solution);
        (log, prior) = found.apply(&log, &prior);
        rows = Rows::new(&log, &prior, length);
        twist.exclude_flights(&log, &mut rows, &prior);
        twist = twist::fit_exact_torque(&log, &rows, &prior).unwrap_or(twist);
        let with_larger_motor = found.with_largest_motor_inertia(&prior);
        let mut seen = Rows::new(&log, &with_larger_motor, length);
        twist.exclude_flights(&log, &mut seen, &with_larger_motor);
        let moved = twist::fit_exact_torque(&log, &seen, &with_larger_motor);
        let compliance_by_inertia = moved.map_or(f64::NAN, |moved| moved.compliance() / twist.compliance() - 1.0);
        uncertainty = Some(ScaleUncertainty { scales: found, compliance_by_inertia });
    }
    let slow = Rows::new(&log, &prior, FRICTION_BOX);
    let findings = findings::gather(&log, [&rows, &slow], &twist, &prior, uncertainty.as_ref());
    contradictions::check_frictions(&findings).map_err(at_path)?;
    let findings: Vec<Finding> = findings.into_iter().map(Finding::with_clamped_friction).collect();
    if !findings.iter().any(Finding::adds_information) {
        return Err(at_path(Failure::new("nothing is identifiable from this log"))
            .with_help("record more reversals, with torques well above the friction and of different strength"));
    }
    Ok(Identified { log, prior, rows, twist, findings })
}

/// Fits with unknown losses; `None` unless the joint file alone stated the losses and the log determines them. A joint
/// without friction and losses is ideal and stays ideal.
fn fit_losses(log: &Log, rows: &Rows, known: &PriorModel) -> Option<(PriorModel, Twist)> {
    if known.losses == Losses::Unknown || known.is_ideal() {
        return None;
    }
    let open = known.with_losses(Losses::Unknown);
    let with_losses = twist::fit(log, rows, &open).filter(|with_losses| with_losses.determines_losses(&open))?;
    Some((open, with_losses))
}

/// Fits with the shortest kernel box at which encoder quantisation does not dominate the accelerations, or else with
/// the most reliable box.
fn first_fit(log: &Log, prior: &PriorModel, shortest: f64) -> Outcome<(f64, Rows, Twist)> {
    let mut best: Option<(f64, Rows, Twist)> = None;
    let mut refused = None;
    let mut length = shortest;
    while length < LONGEST_BOX {
        let rows = Rows::new(log, prior, length);
        match refusal::check(log, &rows, prior) {
            Ok(()) => {
                let fitted = twist::fit(log, &rows, prior);
                let reliability = fitted.as_ref().map_or(0.0, |twist| twist.solution.reliability);
                if best.as_ref().is_none_or(|(_, _, best)| reliability > best.solution.reliability) {
                    best = fitted.map(|twist| (length, rows, twist)).or(best);
                }
                if reliability > RELIABILITY_TARGET {
                    break;
                }
            }
            // A longer box may succeed where quantisation hides the reversals. The refusal of the shortest box is kept:
            // the user can act on it.
            Err(failure) => refused = refused.or(Some(failure)),
        }
        length *= BOX_GROWTH;
    }
    best.filter(|(_, _, best)| best.solution.reliability > RELIABILITY_MIN).ok_or_else(|| {
        refused.unwrap_or_else(|| {
            Failure::new("the moments at which a flank carries do not determine a fit")
                .with_help("record more reversals with torques of different strength, or use finer encoders")
        })
    })
}

/// Assumptions behind the numbers, a sentence each.
fn assumptions(identified: &Identified) -> Vec<String> {
    let Identified { log, prior, twist, .. } = identified;
    let mut list = vec![
        format!(
            "Ratio {} / {} by whole {}; levers, inertias and efficiency as in the joint file.",
            prior.teeth[1],
            prior.teeth[0],
            if prior.equivalent { "turns" } else { "teeth" }
        ),
        format!("Encoders of {} (motor) and {} (output).", resolution(prior.motor_turn), resolution(prior.output_turn)),
        "Motor and torque are read within 2 us of each other; the intervals include this.".to_owned(),
        if prior.equivalent {
            "An equivalent gear: tooth errors, preload and hysteresis are not estimated.".to_owned()
        } else {
            "Half-backlash is the mean over all meshes: a log cannot tell sun and ring apart.".to_owned()
        },
    ];
    list.extend(log.notes.iter().cloned());
    list.extend(prior.harmonics.iter().enumerate().map(|(place, harmonic)| {
        let encoder = if harmonic.encoder == twist::MOTOR_MAP { "motor" } else { "output" };
        let size = ESTIMATE.write(twist.harmonic_amplitude(place).to_degrees());
        format!("The {encoder} encoder has an error of {size} deg, {} times a turn; it is subtracted.", harmonic.order)
    }));
    if log.variance_shares(prior).is_some() {
        list.push("The angles are unquantised, as from a simulation, and are taken as exact.".to_owned());
    }
    if prior.sharing.is_some() {
        list.push(
            "Planets mesh out of phase, so that tooth errors reduce the gap. The reduction follows from \
                 transmission_error_um of the joint file, known within half its value and 1 um; the intervals include \
                 this."
                .to_owned(),
        );
    }
    list.push(if log.output_torque.is_some() {
        format!(
            "The torque was measured at the output. Standard deviations: 0.5 % of its scale, {:.1} % of the motor \
                 torque's scale, {:.1} % of the inertias of motor and link each; the log determines three ratios of \
                 the four.",
            100.0 * prior.torque_error,
            100.0 * prior.inertia_error
        )
    } else {
        format!(
            "Standard deviations: {:.1} % of the torque's scale, {:.1} % of the inertias of motor and link each. \
                 The log determines ratios of the three; the intervals include the rest.",
            100.0 * prior.torque_error,
            100.0 * prior.inertia_error
        )
    });
    list
}

fn simulate(arguments: &Arguments, loaded: &Loaded, progress: &Progress) -> Outcome<String> {
    folder::check_file("simulate", &arguments.log, &[&arguments.joint])?;
    // The existing file may be a recorded test that cannot be repeated.
    if arguments.log.exists() {
        return Err(Failure::new(format!("--simulate would overwrite {}", arguments.log.display()))
            .with_help("name a new file, or remove this one if it is not needed"));
    }
    let mut file = loaded.file.clone();
    let around = &mut file.surroundings;
    for (encoder, bits) in
        [(&mut around.motor_encoder, arguments.motor_bits), (&mut around.output_encoder, arguments.output_bits)]
    {
        encoder.counts_per_turn = bits.map_or(encoder.counts_per_turn, AbsoluteEncoder::counts_of_bits);
    }
    progress.run("testing", 1000_u32);
    let recording =
        virtual_test::record(&file, arguments.seed, &|share| progress.set_position((1000.0 * share) as u32))?;
    write_text(&arguments.log, &recording.csv(arguments.with_output_torque))?;
    progress.clear();
    let seconds = recording.samples.len() as f64 / recording.rate;
    Ok(format!("log: {} ({seconds:.2} s of joint {})\n", arguments.log.display(), file.parameters.name))
}
