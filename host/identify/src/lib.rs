//! `joint identify`: from a recorded reversal test to a joint's backlash, compliance, damping, friction and encoder
//! errors, each with its interval, and to a patched joint file.
//!
//! Logs are read into columns and angles at even times by the crate `log-reader`. `log` turns them into samples, checked by `sampling`.
//! `prior` says what the joint file knows; `rows`
//! are the moments at which a flank carries, smoothed by `kernel`; `load_sharing` is what planets out of phase take of the gap; `twist` and `friction` are fitted to them by `regression`;
//! `balances` hold torque against inertias, for `contradictions` and for `scales`. `findings` is what comes of it, with its
//! `estimate`s; `page`, `pictures` and `patch` show it. `virtual_test` makes a log without hardware.
//! `quasi_static` reads slow logs by itself, `output_locked` those of a joint whose output is held, `output_only` those
//! without the motor's angle; the latter two read their columns by `one_encoder`.

mod arguments;
mod balances;
mod contradictions;
mod estimate;
pub mod findings;
mod friction;
mod higher;
mod kernel;
pub mod learnt;
mod load_sharing;
mod log;
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
use scales::{Doubt, Scales};
use twist::Twist;

use joint_file::named::{self, Loaded};
use joint_file::warned;
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

/// Box of the kernel for frictions, which need no quick motion but exact accelerations [s].
const SLOW_BOX: f64 = 4e-3;

/// Box of the kernel for everything else: at most this long [s], and a sixth of the swing's period...
const QUICK_BOX: f64 = 1e-3;
const SWING_PARTS: f64 = 6.0;
/// ... but longer, step by step, if the encoders' counts then are most of what an acceleration shows.
const LONGER: f64 = 1.4;
const LONGEST_BOX: f64 = 8e-3;
const RELIABLE: f64 = 0.9;
/// Below this they are most of it.
const LEAST_RELIABLE: f64 = 0.5;

/// Fits one after the other, each with the errors by angle of the last taken off the accelerations.
const ROUNDS: usize = 4;

/// What a log has shown.
struct Identified {
    log: Log,
    /// What was known before, with the inertias that were found.
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

/// Folder of the results of several joints, each in a folder of its own below that of the log.
const SEVERAL: &str = "joint-out/identify";

/// Identifies the joint of a log, or each of several by a map, or makes a log of one, and prints the result.
pub fn run(arguments: &Arguments, progress: &Progress) -> Outcome<String> {
    let joints = column_map::joints(arguments.map.as_deref())?;
    if joints.is_empty() || arguments.map_joint.is_some() {
        return run_one(arguments, progress);
    }
    if arguments.json.is_some() {
        return Err(Failure::new("--json takes the findings of one joint, and the map has several").with_help(
            "leave it out, each joint's folder has findings.json; or choose a joint with --map-joint NAME",
        ));
    }
    let log = arguments.log.file_stem().unwrap_or_default();
    let out = arguments.out.clone().unwrap_or_else(|| Path::new(SEVERAL).join(log));
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
    // What was found of the others is not lost.
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
    warned::tell(&loaded);
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
    let in_the_file = |failure: Failure| failure.while_doing(path.display());
    if prior.equivalent && read.output_torque.is_none() {
        return Err(in_the_file(Failure::new(
            "an equivalent gear is not identified by its motor's torque: intervals missed in simulated logs",
        ))
        .with_help(
            "log the torque between gear and link as output_torque_N_m, or record a slow log: --quasi-static finds lost \
             motion, hysteresis and friction",
        ));
    }
    let shortest = QUICK_BOX.min(prior.swing() / SWING_PARTS);
    contradictions::angles(&read, prior)
        .and_then(|()| contradictions::torques(&read, prior, shortest))
        .map_err(in_the_file)?;
    let (length, mut rows, mut twist) = first_fit(&read, prior, shortest).map_err(in_the_file)?;
    let mut log = read.clone();
    let mut known = prior.clone();
    for round in 0..ROUNDS {
        // An error that comes often a turn is looked for once the others are taken off.
        while let Some(higher) = (round > 0).then(|| twist.more_often_a_turn(&log, &known)).flatten() {
            known.higher.push(higher);
            let Some(better) = twist::fit(&log, &rows, &known) else { break };
            twist = better;
        }
        if let Some((open, told)) = told_losses(&log, &rows, &known) {
            (known, twist) = (open, told);
        }
        let prior = &known;
        let errors: [&dyn Fn(f64) -> f64; 3] = [
            &|angle| twist.error(twist::MOTOR_MAP, angle, prior),
            &|angle| twist.error(twist::OUTPUT_MAP, angle, prior),
            &|angle| twist.error(twist::TEETH, angle, prior),
        ];
        let corrected = read.without(errors, twist.solution.values[twist::SKEW], prior);
        let mut seen = Rows::new(&corrected, prior, length);
        twist.leave_out_flights(&corrected, &mut seen, prior);
        let Some(better) = twist::fit(&corrected, &seen, prior) else { break };
        (log, rows, twist) = (corrected, seen, better);
    }
    // What is told goes into the joint's model until the log agrees with it.
    let mut prior = known;
    for _ in 0..ROUNDS {
        if prior.losses != Losses::Open {
            break;
        }
        let (more, deviation) = twist.loss(&prior);
        prior = prior.with_losses_told(more, deviation);
        rows = Rows::new(&log, &prior, length);
        twist.leave_out_flights(&log, &mut rows, &prior);
        twist = twist::fit(&log, &rows, &prior).unwrap_or(twist);
    }
    contradictions::offsets(&log, &rows, &prior)
        .and_then(|()| contradictions::age(&twist, &prior))
        .and_then(|()| contradictions::filter(&log, &twist, &prior))
        .map_err(in_the_file)?;
    let mut doubt = None;
    if log.output_torque.is_some() {
        let factors = balances::by_the_sensor([&rows, &Rows::new(&log, &prior, SLOW_BOX)], &prior);
        contradictions::sensor(&prior, factors)
            .and_then(|()| contradictions::one_as_the_other(&log, &prior))
            .map_err(in_the_file)?;
        let found = Scales::of_measured(&prior, factors);
        (log, prior) = found.apply(&log, &prior);
        rows = Rows::new(&log, &prior, length);
        twist.leave_out_flights(&log, &mut rows, &prior);
        twist = twist::fit_with_this_torque(&log, &rows, &prior).unwrap_or(twist);
        doubt = Some(Doubt { scales: found, by_inertia: 0.0 });
    }
    if let Some(free) = twist::fit_with_any_torque(&log, &rows, &prior) {
        contradictions::ringing(&log, &prior, &free.solution)
            .and_then(|()| contradictions::one_as_the_other(&log, &prior))
            .map_err(in_the_file)?;
        let found = Scales::new(&log, &prior, &free.solution);
        (log, prior) = found.apply(&log, &prior);
        rows = Rows::new(&log, &prior, length);
        twist.leave_out_flights(&log, &mut rows, &prior);
        twist = twist::fit_with_this_torque(&log, &rows, &prior).unwrap_or(twist);
        let heavier = found.with_most_of_the_motor(&prior);
        let mut seen = Rows::new(&log, &heavier, length);
        twist.leave_out_flights(&log, &mut seen, &heavier);
        let moved = twist::fit_with_this_torque(&log, &seen, &heavier);
        let by_inertia = moved.map_or(f64::NAN, |moved| moved.compliance() / twist.compliance() - 1.0);
        doubt = Some(Doubt { scales: found, by_inertia });
    }
    let slow = Rows::new(&log, &prior, SLOW_BOX);
    let findings = findings::gather(&log, [&rows, &slow], &twist, &prior, doubt.as_ref());
    contradictions::frictions(&findings).map_err(in_the_file)?;
    let findings: Vec<Finding> = findings.into_iter().map(Finding::settled).collect();
    if !findings.iter().any(Finding::is_news) {
        return Err(in_the_file(Failure::new("nothing is identifiable from this log"))
            .with_help("record more reversals, with torques well above the friction and of different strength"));
    }
    Ok(Identified { log, prior, rows, twist, findings })
}

/// The fit in which losses are unknown, if they are known by the joint file only and the log tells them. A joint without
/// any friction and losses is an ideal one, and stays it.
fn told_losses(log: &Log, rows: &Rows, known: &PriorModel) -> Option<(PriorModel, Twist)> {
    if known.losses == Losses::Open || known.is_ideal() {
        return None;
    }
    let open = known.with_losses(Losses::Open);
    let told = twist::fit(log, rows, &open).filter(|told| told.tells_losses(&open))?;
    Some((open, told))
}

/// The fit with the shortest box of the kernel at which encoder counts are not most of what an acceleration shows; the best
/// there is if they always are.
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
                if reliability > RELIABLE {
                    break;
                }
            }
            // A longer box may see what quantisation hides; the reason for the shortest is the one that a user can act on.
            Err(failure) => refused = refused.or(Some(failure)),
        }
        length *= LONGER;
    }
    best.filter(|(_, _, best)| best.solution.reliability > LEAST_RELIABLE).ok_or_else(|| {
        refused.unwrap_or_else(|| {
            Failure::new("the moments at which a flank carries do not determine a fit")
                .with_help("record more reversals with torques of different strength, or take finer encoders")
        })
    })
}

/// What the numbers take for granted.
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
        "Readings of motor and torque at the same time within 2 us: that is in the intervals.".to_owned(),
        if prior.equivalent {
            "An equivalent gear: errors of teeth, preload and hysteresis are not looked for.".to_owned()
        } else {
            "Half-backlash is the mean over all meshes: a log cannot tell sun and ring apart.".to_owned()
        },
    ];
    list.extend(log.told.iter().cloned());
    list.extend(prior.higher.iter().enumerate().map(|(place, higher)| {
        let encoder = if higher.encoder == twist::MOTOR_MAP { "motor" } else { "output" };
        let size = ESTIMATE.write(twist.higher(place).to_degrees());
        format!("The {encoder} encoder has an error of {size} deg that comes {} times a turn: taken out.", higher.order)
    }));
    if log.smoothness(prior).is_some() {
        list.push("Angles that no encoder has read, as a simulation writes them: taken as exact.".to_owned());
    }
    if prior.sharing.is_some() {
        list.push(
            "Planets mesh out of phase, so that errors of the teeth take a part of the gap: by transmission_error_um of the joint \
             file, known within a half and 1 um; that is in the intervals."
                .to_owned(),
        );
    }
    list.push(if log.output_torque.is_some() {
        format!(
            "Torque measured at the output, its scale expected to be right within 0.5 %, that of the motor's torque within {:.1} %, \
             inertias of motor and link within {:.1} % each (one standard deviation); the log shows three ratios of the four.",
            100.0 * prior.torque_error,
            100.0 * prior.inertia_error
        )
    } else {
        format!(
            "Torque's scale expected to be right within {:.1} %, inertias of motor and link within {:.1} % each (one standard \
             deviation); the log shows ratios of the three, and what it does not show is in the intervals.",
            100.0 * prior.torque_error,
            100.0 * prior.inertia_error
        )
    });
    list
}

fn simulate(arguments: &Arguments, loaded: &Loaded, progress: &Progress) -> Outcome<String> {
    folder::check_file("simulate", &arguments.log, &[&arguments.joint])?;
    // What lies there may be a recorded test, which nobody can make again.
    if arguments.log.exists() {
        return Err(Failure::new(format!("--simulate would write over {}", arguments.log.display()))
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
