//! An experiment: one estimator in place of the observer's many deciders, scored beside it on the same recorded runs.
//!
//! ```text
//! cargo run --release -p estimator -- --keep FOLDER hil/t2.toml=1-4 hil/s1.toml=1-4
//! ```

mod candidate;
mod closed;
mod runs;
mod score;

use std::path::PathBuf;
use std::process::ExitCode;

use candidate::{Candidate, Variant};
use clap::Parser;
use model_core::observer::{MAPPED, Observer};
use rayon::prelude::*;
use report::failure::Outcome;
use runs::Recording;
use score::{Figures, HEADS, cells, score};

/// Scores present observer and candidate on the runs of test files.
#[derive(Debug, Parser)]
struct Arguments {
    /// Where recorded runs are kept.
    #[arg(long)]
    keep: PathBuf,
    /// Variants of the candidate, by name.
    #[arg(long, value_delimiter = ',', default_value = "base")]
    variant: Vec<String>,
    /// Only the candidate's lines.
    #[arg(long)]
    brief: bool,
    /// Each seed by itself.
    #[arg(long)]
    each: bool,
    /// Writes what both said of each run there, thinned, as text.
    #[arg(long)]
    trace: Option<PathBuf>,
    /// Both in the loop, in turn, in place of offline.
    #[arg(long = "loop")]
    in_loop: bool,
    /// Runs `none`, `present` or `candidate` ten times over the recordings and says only how many periods that were: for a
    /// count of instructions from outside.
    #[arg(long)]
    cost: Option<String>,
    /// FILE=SEED or FILE=FROM-TO.
    tests: Vec<String>,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{}", failure.message());
            ExitCode::FAILURE
        }
    }
}

/// Both in the loop: medians and worst of all seeds.
fn in_loop(arguments: &Arguments) -> Outcome<()> {
    println!("| file | seeds | by | RMS mrad, median, worst | peak mrad, median, worst | mesh force N, median, worst |");
    println!("|---|---|---|---|---|---|");
    for named in &arguments.tests {
        let (path, stem, from, to) = parts(named);
        let test = runs::test(&path)?;
        let variants = std::iter::once(None).chain(arguments.variant.iter().map(Some));
        for name in variants {
            let variant = name.map(|name| Variant::of(name));
            let all: Vec<closed::Loop> =
                (from..=to).into_par_iter().map(|seed| closed::run(&test, seed, variant)).collect::<Outcome<_>>()?;
            let cell = |of: &dyn Fn(&closed::Loop) -> f64| {
                let mut values: Vec<f64> = all.iter().map(of).collect();
                values.sort_by(f64::total_cmp);
                format!("{:.3} {:.3}", values[values.len() / 2], values.last().copied().unwrap_or(f64::NAN))
            };
            println!(
                "| {stem} | {from}-{to} | {} | {} | {} | {} |",
                name.map_or("present", String::as_str),
                cell(&|one| one.rms),
                cell(&|one| one.peak),
                cell(&|one| one.force)
            );
        }
    }
    Ok(())
}

/// What is counted from outside.
fn cost(arguments: &Arguments, of: &str) -> Outcome<()> {
    for named in &arguments.tests {
        let (path, stem, from, _) = parts(named);
        let test = runs::test(&path)?;
        let recording = runs::record(&test, &stem, from, &arguments.keep)?;
        let present = runs::present_tables(&test, from)?;
        let mut sum = 0.0;
        for _ in 0..10 {
            let mut observer = Observer::<f32, MAPPED>::new(&present);
            let mut candidate = Candidate::new(&recording.tables, Variant::of("base"));
            for step in &recording.steps {
                sum += match of {
                    "present" => f64::from(observer.step(&step.samples).gap.value),
                    "candidate" => candidate.step(&step.samples).gap,
                    _ => f64::from(step.samples.torque),
                };
            }
        }
        println!("{of}: {} periods, {sum:e}", 10 * recording.steps.len());
    }
    Ok(())
}

/// Path, stem, first and last seed of a test as it is named.
fn parts(named: &str) -> (PathBuf, String, u64, u64) {
    let (path, seeds) = named.split_once('=').unwrap_or((named, "1"));
    let (from, to) = seeds.split_once('-').unwrap_or((seeds, seeds));
    let path = PathBuf::from(path);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    (path, stem, from.parse().unwrap_or(1), to.parse().unwrap_or(1))
}

fn run(arguments: &Arguments) -> Outcome<()> {
    if arguments.in_loop {
        return in_loop(arguments);
    }
    if let Some(of) = &arguments.cost {
        return cost(arguments, of);
    }
    println!("| file | seeds | by | {} |", HEADS.join(" | "));
    println!("|{}", "---|".repeat(HEADS.len() + 3));
    for named in &arguments.tests {
        let (path, stem, from, to) = parts(named);
        let seeds = format!("{from}-{to}");
        let test = runs::test(&path)?;
        let one = |seed: u64| -> Outcome<Vec<Figures>> {
            let recording = runs::record(&test, &stem, seed, &arguments.keep)?;
            let present = score(&recording, recording.steps.iter().map(|step| step.present));
            let tried = arguments.variant.iter().map(|name| {
                let mut candidate = Candidate::new(&recording.tables, Variant::of(name));
                score(&recording, recording.steps.iter().map(|step| candidate.step(&step.samples)))
            });
            let figures = std::iter::once(present).chain(tried).collect();
            if let Some(folder) = &arguments.trace {
                trace(&recording, arguments.variant.first().map_or("base", String::as_str), folder);
            }
            Ok(figures)
        };
        let all: Vec<Vec<Figures>> = (from..=to).into_par_iter().map(one).collect::<Outcome<_>>()?;
        let names: Vec<&str> = std::iter::once("present").chain(arguments.variant.iter().map(String::as_str)).collect();
        for (index, name) in names.iter().enumerate().skip(usize::from(arguments.brief)) {
            let of: Vec<Figures> = all.iter().map(|figures| figures[index].clone()).collect();
            println!("| {stem} | {seeds} | {name} | {} |", cells(&of).join(" | "));
        }
        if arguments.each {
            for (figures, seed) in all.iter().zip(from..) {
                for (one, name) in figures.iter().zip(&names) {
                    println!("| - {stem} | {seed} | {name} | {} |", cells(std::slice::from_ref(one)).join(" | "));
                }
            }
        }
    }
    Ok(())
}

/// What both said, a line for each millisecond, in um.
fn trace(recording: &Recording, variant: &str, folder: &std::path::Path) {
    let mut candidate = Candidate::new(&recording.tables, Variant::of(variant));
    let mut text = String::from("time gap force b | present gap sd side b | candidate gap sd side b valid | p- p0 p+\n");
    for (index, step) in recording.steps.iter().enumerate() {
        let said = candidate.step(&step.samples);
        if index % std::env::var("EVERY").map_or(10, |every| every.parse().unwrap_or(10)) != 0 {
            continue;
        }
        let (truth, present) = (&step.truth, &step.present);
        let um = |value: f64| 1e6 * value;
        text += &format!(
            "{:.4} {:7.1} {:7.1} {:5.1} | {:7.1} {:5.1} {:2} {:5.1} {} | {:7.1} {:5.1} {:2} {:5.1} {} {:?} | {}\n",
            truth.time,
            um(truth.gap),
            truth.force,
            um(truth.half_backlash),
            um(present.gap),
            um(present.gap_variance.sqrt()),
            present.side,
            um(present.width),
            u8::from(present.gap_valid),
            um(said.gap),
            um(said.gap_variance.sqrt()),
            said.side,
            um(said.width),
            u8::from(said.gap_valid),
            said.stands,
            candidate.inside()
        );
    }
    let _ = std::fs::write(folder.join(format!("{}-{}.txt", recording.file, recording.seed)), text);
}
