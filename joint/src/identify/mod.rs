//! `joint identify`: from a recorded reversal test to a joint's backlash, compliance, damping, friction and encoder errors,
//! each with its interval, and to a patched joint file. Learning on board is the observer's business.
//!
//! `columns` reads a file, `log` turns it into checked samples, `plan` says what the joint file knows;
//! `rows` are the moments at which a flank carries, smoothed by `kernel`; `twist` and `friction` are fitted to them by
//! `regression`; `findings` is what comes of it, with its `estimate`s; `table`, `page`, `pictures` and `patch` show it. `virtual_test` makes a
//! log without hardware.

mod arguments;
mod columns;
mod estimate;
pub mod findings;
mod friction;
mod kernel;
mod log;
mod page;
mod patch;
mod pictures;
mod plan;
mod refusal;
mod regression;
mod rows;
mod table;
mod twist;
pub mod virtual_test;

use std::path::Path;

pub use arguments::Arguments;
use findings::Finding;
use log::Log;
use plan::Plan;
use rows::Rows;
use serde::Serialize;
use twist::Twist;

use crate::check::{self, Loaded};
use crate::failure::{Failure, Outcome};
use crate::hil::Progress;
use crate::output;
use crate::record::write_text;
use crate::sim::files::Folder;

/// Box of the kernel for frictions, which need no quick motion but exact accelerations [s].
const SLOW_BOX: f64 = 4e-3;

/// Fits one after the other, each with the errors by angle of the last taken off the accelerations.
const ROUNDS: usize = 3;

/// What identification leaves behind as JSON.
#[derive(Debug, Serialize)]
struct Findings<'a> {
    schema: &'static str,
    joint: &'a str,
    log: &'a str,
    duration_s: f64,
    crossings: usize,
    assumptions: &'a [String],
    findings: &'a [Finding],
}

/// What a log has shown.
struct Identified {
    log: Log,
    rows: Rows,
    twist: Twist,
    findings: Vec<Finding>,
}

/// Identifies a joint, or makes a log of one.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    Progress::during(|progress| run_once(arguments, progress))
}

fn run_once(arguments: &Arguments, progress: &Progress) -> Outcome<()> {
    let loaded = check::load_with(&arguments.joint, &arguments.set)?;
    if arguments.simulate {
        return simulate(arguments, &loaded, progress);
    }
    let plan = Plan::new(&loaded, arguments);
    progress.stage("fitting");
    let identified = identify(&arguments.log, &plan)?;
    let folder = Folder::prepare(arguments.out.as_deref(), "identify", &plan.name)?;
    let name = arguments.log.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stated = |finding: &Finding| {
        let value = joints::value(&loaded.text, finding.key.as_deref()?).ok()??;
        Some(value.to_owned())
    };
    let patched = patch::patch(&loaded, &plan, &identified.findings, &name)?;
    let assumptions = assumptions(&plan, &identified.log);
    let Identified { log, rows, twist, findings } = &identified;
    let page = page::render(&page::Content {
        joint: &plan.name,
        log: &name,
        duration: log.time.last().copied().unwrap_or_default(),
        crossings: rows.crossings,
        findings,
        stated: &stated,
        figures: &[pictures::loop_of(log, rows, twist, &plan), pictures::course(log, twist)],
        assumptions: &assumptions,
    });
    let record = Findings {
        schema: "joint-identify/1",
        joint: &plan.name,
        log: &name,
        duration_s: log.time.last().copied().unwrap_or_default(),
        crossings: rows.crossings,
        assumptions: &assumptions,
        findings,
    };
    let json = output::json("findings", &record)?;
    let [report, joint] = [folder.file("report.html"), folder.file("joint.toml")];
    write_text(&report, &page)?;
    write_text(&joint, &patched)?;
    write_text(&folder.file("findings.json"), &json)?;
    arguments.json.as_ref().map_or(Ok(()), |path| write_text(path, &json))?;
    progress.clear();
    output::print(&table::render(findings, stated))?;
    output::print(&format!("\nreport: {}\njoint file: {}\n", report.display(), joint.display()))
}

fn identify(path: &Path, plan: &Plan) -> Outcome<Identified> {
    let read = Log::read(path, plan)?;
    let in_the_file = |failure: Failure| failure.while_doing(path.display());
    let mut log = read.clone();
    let mut rows = Rows::quick(&log, plan);
    refusal::check(&log, &rows, plan).map_err(in_the_file)?;
    let fit = |log: &Log, rows: &Rows| {
        twist::fit(log, rows, plan).ok_or_else(|| {
            in_the_file(Failure::new("the moments at which a flank carries do not determine a fit"))
                .with_help("record more reversals with torques of different strength")
        })
    };
    let mut twist = fit(&log, &rows)?;
    for _ in 0..ROUNDS {
        let errors: [&dyn Fn(f64) -> f64; 3] =
            [&|angle| twist.error(twist::MOTOR_MAP, angle), &|angle| twist.error(twist::OUTPUT_MAP, angle), &|angle| {
                twist.error(twist::TEETH, angle)
            }];
        log = read.without(errors, twist.solution.values[twist::SKEW], plan);
        rows = Rows::quick(&log, plan);
        twist = fit(&log, &rows)?;
    }
    let slow = Rows::new(&log, plan, SLOW_BOX);
    let findings = findings::gather(&log, &rows, &slow, &twist, plan);
    if findings.iter().all(|finding| finding.value.is_none()) {
        return Err(in_the_file(Failure::new("nothing is identifiable from this log"))
            .with_help("record more reversals, with torques well above the friction and of different strength"));
    }
    Ok(Identified { log, rows, twist, findings })
}

/// What the numbers take for granted.
fn assumptions(plan: &Plan, log: &Log) -> Vec<String> {
    let mut list = vec![
        format!(
            "Ratio {} / {} by whole teeth; levers, inertias and efficiency as in the joint file.",
            plan.teeth[1], plan.teeth[0]
        ),
        format!("Encoders of {} bits (motor) and {} bits (output).", plan.motor_bits, plan.output_bits),
        "Motor's inertia right within 1.5 %, readings of motor and torque at the same time within 2 us: both are in the \
         intervals."
            .to_owned(),
        "Half-backlash is the mean over all meshes: a log cannot tell sun and ring apart.".to_owned(),
    ];
    list.push(if log.output_torque.is_some() {
        "Torque measured at the output; its own error is not in the intervals.".to_owned()
    } else {
        format!(
            "Motor torque as logged, its scale expected to be right within {:.1} % (one standard deviation); what the log does \
             not show of it is in the intervals.",
            100.0 * plan.torque_error
        )
    });
    list
}

fn simulate(arguments: &Arguments, loaded: &Loaded, progress: &Progress) -> Outcome<()> {
    let mut file = loaded.file.clone();
    if let Some(train) = file.drive_train.as_mut() {
        train.motor_encoder.bits = arguments.motor_bits.unwrap_or(train.motor_encoder.bits);
        train.output_encoder.bits = arguments.output_bits.unwrap_or(train.output_encoder.bits);
    }
    progress.run("testing", 1000);
    let line = progress.handle();
    let recording = virtual_test::record(&file, arguments.seed, &|share| line.at((1000.0 * share) as u32))?;
    write_text(&arguments.log, &recording.csv(arguments.with_output_torque))?;
    progress.clear();
    let seconds = recording.samples.len() as f64 / recording.rate;
    output::print(&format!("log: {} ({seconds:.2} s of joint {})\n", arguments.log.display(), file.parameters.name))
}
