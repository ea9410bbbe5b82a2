//! `joint replay`: runs a joint's observer, the code that a board runs, over the counts and torques of a log. The log
//! of a run of `joint hil TEST` contains the observer's inputs, and the replay is compared with the run in every bit.
//! For any other log the estimates are shown.
//!
//! `arguments` is the command line. `samples` converts columns to an observer's samples, `wiring` checks the log
//! against the joint file, `pass` collects the observer's estimates, `recorded` are the estimates logged by a run.
//! `history` writes the estimates as CSV and MCAP, `record` is the JSON, `page` and `pictures` show it.

mod arguments;
mod history;
mod page;
mod pass;
mod pictures;
mod record;
mod recorded;
mod samples;
#[cfg(test)]
mod schema;
mod wiring;

use std::collections::BTreeMap;
use std::path::Path;

pub use arguments::ReplayArguments;
use model_core::observer::design::{ObserverSettings, design_observer, observer_settings};
use model_core::observer::{MAPPED, Memory, Observer, ObserverTables};
use pass::Pass;
pub use record::ReplayRecord;
use recorded::Recorded;
use samples::ReplaySamples;
use scenario::controller_log::{self, ObserverOrigin};

use identify::memory::Content;
use joint_file::named::{self, Loaded};
use joint_file::warnings;
use log_reader::column_map::ColumnMap;
use log_reader::log_file::LogFile;
use report::document::{html, terminal};
use report::failure::{Failure, Outcome};
use report::folder::{self, Folder};
use report::output;
use report::progress::Progress;

/// Files of the results.
const REPORT: &str = "report.html";
const RECORD: &str = "record.json";
const CSV: &str = "estimates.csv";
const LOG: &str = "estimates.mcap";

/// Observer before its first samples.
struct InitialObserver {
    tables: ObserverTables<f32>,
    memory: Option<Memory>,
}

impl InitialObserver {
    fn observer(&self) -> Outcome<Observer<'_, f32, MAPPED>> {
        let mut observer = Observer::new(&self.tables);
        if let Some(memory) = &self.memory {
            observer.load(memory).map_err(|error| Failure::new(format!("the observer's initial memory: {error}")))?;
        }
        Ok(observer)
    }
}

/// Replays a log, writes the results and returns the printed text; fails if a run is not repeated.
pub fn run(arguments: &ReplayArguments, progress: &Progress) -> Outcome<String> {
    let path = arguments.log.as_path();
    let map =
        ColumnMap::new(arguments.map.as_deref(), arguments.map_joint.as_deref(), &arguments.column, &arguments.unit)?;
    let read: Vec<&Path> = [Some(path), arguments.joint.as_deref()].into_iter().flatten().collect();
    folder::check_files(&[("json", arguments.json.as_deref())], &read)?;
    progress.stage("reading");
    let file = LogFile::open(path)?;
    let remarks = file.remarks();
    let origin = ObserverOrigin::from_remarks(&remarks).filter(|_| arguments.repeats_run());
    let loaded = load(arguments, origin.as_ref(), remarks.get(samples::RUN_REMARK))?;
    let settings = settings(&loaded, origin.as_ref(), arguments.motor_only);
    let tables = design(&loaded, &settings)?;
    let at_path = |failure: Failure| failure.while_doing(path.display());
    let start = InitialObserver { tables, memory: origin.as_ref().and_then(|origin| origin.memory) };
    let topic = origin.as_ref().map(|_| controller_log::TOPIC).or(arguments.topic.as_deref());
    let samples =
        ReplaySamples::read(&file, topic, &map, &loaded, &settings, &|rate| design_at_rate(arguments, rate).err())?;
    let recorded = match &origin {
        Some(_) => Some(Recorded::read(&file).map_err(at_path)?),
        None => None,
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = Folder::choose(arguments.out.as_deref(), "replay", &name, &[REPORT, RECORD, CSV, LOG])?;

    progress.stage("replaying");
    let (mut pass, mut agreement) = (Pass::new(&samples), recorded.as_ref().map(Recorded::comparison));
    let mut observer = start.observer()?;
    for index in 0..samples.len() {
        let estimates = *observer.step(&samples.at(index));
        pass.add(index, &estimates);
        if let Some(agreement) = &mut agreement {
            agreement.compare(index, &estimates);
        }
    }
    let learnt = Content::read(&observer.save(), &loaded).map_or_else(|_| Vec::new(), Content::into_values);
    let repeated = agreement.map(recorded::Agreement::result);
    let wiring = wiring::check(&loaded.file.parameters, &settings, &samples)?;
    let record = ReplayRecord::new(&name, &loaded, &samples, &pass, learnt, repeated, wiring);

    folder.make()?;
    let document = page::document(&record, &loaded.text, pictures::all(&pass, &record));
    folder.write_text(REPORT, &html(&document))?;
    let json = output::json("replay", &record)?;
    folder.write_text(RECORD, &json)?;
    let every = arguments.every.map_or_else(|| samples.default_thinning(), |every| every.get().into());
    let remarks_of_run = remarks.contains_key(samples::RUN_REMARK);
    let remarks: BTreeMap<String, String> = [("log", name.clone()), ("joint", record.joint.clone())]
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect();
    // The observer runs again for each file instead of keeping all estimates in memory.
    let observer = start.observer()?;
    folder.write_with(CSV, |out| history::write_csv(out, &samples, observer, every))?;
    let observer = start.observer()?;
    folder.write_with(LOG, |out| history::write_mcap(out, &samples, observer, every, remarks))?;
    arguments.json.as_ref().map_or(Ok(()), |path| output::write_json(path, &json))?;
    progress.clear();
    let text = format!("{}\nreport: {}\n", terminal(&document), folder.file(REPORT).display());
    match record.repeats.as_ref().filter(|repeats| !repeats.every_bit) {
        None if remarks_of_run => Ok(text),
        None => match wiring::reject_contradictions(&record.wiring) {
            Ok(()) => Ok(text),
            Err(failure) => {
                output::print(&text)?;
                Err(failure)
            }
        },
        Some(repeats) => {
            output::print(&text)?;
            Err(Failure::check_failed(repeats.sentence())
                .with_help("the counts or torques of the log were changed, or another version of the program wrote it"))
        }
    }
}

/// Loads the joint file of the observer.
fn load(arguments: &ReplayArguments, origin: Option<&ObserverOrigin>, controller: Option<&String>) -> Outcome<Loaded> {
    if let Some(origin) = origin {
        return named::read_changed(arguments.log.display().to_string(), origin.joint_file.clone(), &[]);
    }
    let Some(joint) = &arguments.joint else {
        if let Some(controller) = controller {
            return Err(samples::missing_samples(controller).while_doing(arguments.log.display()));
        }
        let log = arguments.log.display();
        return Err(Failure::new(format!("{log} does not say which joint it is of"))
            .with_help(format!("name a joint file or preset: joint replay {log} JOINT")));
    };
    let loaded = named::load_with(joint, &arguments.set)?;
    warnings::print(&loaded);
    Ok(loaded)
}

fn design(loaded: &Loaded, settings: &ObserverSettings) -> Outcome<ObserverTables<f32>> {
    let joint = &loaded.file.parameters;
    design_observer::<f32>(joint, settings)
        .map_err(|error| Failure::new(format!("no observer can be designed for joint `{}`: {error}", joint.name)))
}

/// Designs the observer of the joint file for another control rate.
fn design_at_rate(arguments: &ReplayArguments, rate: f64) -> Outcome<ObserverTables<f32>> {
    let joint = arguments.joint.as_deref().ok_or_else(|| Failure::new("the rate of a run is that of its log"))?;
    let changes: Vec<String> = arguments.set.iter().cloned().chain([format!("control_rate_Hz={rate:.0}")]).collect();
    let loaded = named::load_with(joint, &changes)?;
    design(&loaded, &settings(&loaded, None, arguments.motor_only))
}

fn settings(loaded: &Loaded, origin: Option<&ObserverOrigin>, motor_only: bool) -> ObserverSettings {
    let mut settings = observer_settings(&loaded.file.surroundings);
    if motor_only || origin.is_some_and(|origin| !origin.output_encoder) {
        settings.output_encoder = None;
    }
    settings
}
