//! Files of a study: report, record, pictures and tables in one folder, each written atomically.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::pictures::{self, Picture};
use super::record::{Class, Reading, StudyRecord};
use report::document::{Document, html};
use report::failure::Outcome;
use report::folder::{Folder, file_part};
use report::output;

const REPORT: &str = "report.html";
const RECORD: &str = "study.json";
/// All files that a study may write; the attractors determine the pictures.
pub const ALL: [&str; 10] = [
    REPORT,
    RECORD,
    "attractors.csv",
    "dead-zone-error.csv",
    "stiffness.csv",
    "poincare-points-*.csv",
    "bifurcation-*.csv",
    "bifurcation-*.svg",
    "attractor-*.svg",
    "figure-*.svg",
];

/// Writes all files, and the record to an additional file if requested; returns the path of the report.
pub fn write(folder: &Folder, json: Option<&Path>, record: &StudyRecord, document: &Document) -> Outcome<PathBuf> {
    // The requested file comes first, so that no later failure can lose it.
    json.map_or(Ok(()), |path| output::write_json_record(path, record))?;
    folder.write_record(RECORD, record)?;
    for (name, table) in tables(record) {
        folder.write_text(&format!("{name}.csv"), &table)?;
    }
    for Picture { name, figure } in all_pictures(record) {
        folder.write_text(&format!("{name}.svg"), &figure.to_file())?;
    }
    folder.write_text(REPORT, &html(document))?;
    Ok(folder.file(REPORT))
}

fn all_pictures(record: &StudyRecord) -> Vec<Picture> {
    let mut all = vec![pictures::stiffness(record)];
    all.extend(pictures::dead_zone(record));
    for reading in &record.readings {
        all.extend(reading.attractors.iter().flat_map(|attractor| pictures::regime(reading, attractor)));
        all.extend(reading.sweeps.iter().map(|sweep| pictures::diagram(reading, sweep)));
    }
    all
}

/// Name and text of every table.
fn tables(record: &StudyRecord) -> Vec<(String, String)> {
    let mut tables =
        vec![("attractors".to_owned(), attractors(&record.readings)), dead_zone(record), stiffness(record)];
    for reading in &record.readings {
        let joint = file_part(&reading.joint);
        tables.push((format!("poincare-points-{joint}"), poincare(reading)));
        for sweep in &reading.sweeps {
            let mut text = "half_backlash_um,class,period,exponent,x_sp\n".to_owned();
            for point in &sweep.points {
                let (class, period) = class_columns(point.class);
                for x_sp in &point.x_sp {
                    // Writing to a string cannot fail.
                    let b = micrometres(point.half_backlash_m);
                    let _ = writeln!(text, "{b},{class},{period},{:.6},{x_sp}", point.exponent);
                }
            }
            tables.push((format!("bifurcation-{joint}-{}", sweep.start), text));
        }
    }
    tables
}

/// Length in micrometres, without the rounding noise of the conversion to metres.
fn micrometres(length: f64) -> f64 {
    (length * 1e12).round() / 1e6
}

fn class_columns(class: Class) -> (&'static str, String) {
    match class {
        Class::Periodic(period) => ("periodic", period.to_string()),
        Class::Chaotic => ("chaotic", String::new()),
        Class::Unsettled => ("unsettled", String::new()),
    }
}

fn attractors(readings: &[Reading]) -> String {
    let mut text = "joint,half_backlash_um,class,period,distinct_points,points_looked_at,exponent_by_tangent_vector,\
                    exponent_by_two_trajectories,exponent_between_planets,non_fundamental_ratio,peak_to_peak,\
                    drive_side_percent,separated_percent,back_side_percent,reference_distance\n"
        .to_owned();
    let optional = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6e}"));
    for reading in readings {
        for found in &reading.attractors {
            let (class, period) = class_columns(found.class);
            let [drive, separated, back] = found.contact_percent;
            let _ = writeln!(
                text,
                "{},{},{class},{period},{},{},{:.6},{:.6},{},{:.6},{:.6},{drive:.3},{separated:.3},{back:.3},{}",
                reading.joint,
                micrometres(found.half_backlash_m),
                found.distinct_points,
                found.points_looked_at,
                found.exponent_by_tangent_vector,
                found.exponent_by_two_trajectories,
                optional(found.exponent_between_planets),
                found.non_fundamental_ratio,
                found.peak_to_peak,
                optional(found.reference_distance),
            );
        }
    }
    text
}

fn poincare(reading: &Reading) -> String {
    let mut text = "half_backlash_um,x_sp,x_sc,x_sp_rate,x_sc_rate\n".to_owned();
    for found in &reading.attractors {
        for [x_sp, x_sc, x_sp_rate, x_sc_rate] in &found.poincare_points {
            let b = micrometres(found.half_backlash_m);
            let _ = writeln!(text, "{b},{x_sp:.9},{x_sc:.9},{x_sp_rate:.9},{x_sc_rate:.9}");
        }
    }
    text
}

fn dead_zone(record: &StudyRecord) -> (String, String) {
    let mut text = "sharpness,largest_error_corrected,largest_error_printed\n".to_owned();
    for error in &record.dead_zone.errors {
        let _ = writeln!(text, "{:.6},{:.6e},{:.6e}", error.sharpness, error.corrected, error.printed);
    }
    ("dead-zone-error".to_owned(), text)
}

fn stiffness(record: &StudyRecord) -> (String, String) {
    let wave = &record.stiffness;
    let mut text = "phase_periods,rectangular,first_harmonic,eight_harmonics\n".to_owned();
    for (index, phase) in wave.phase.iter().enumerate() {
        let values = [wave.rectangular[index], wave.first_harmonic[index], wave.eight_harmonics[index]];
        let _ = writeln!(text, "{phase:.6},{:.6},{:.6},{:.6}", values[0], values[1], values[2]);
    }
    ("stiffness".to_owned(), text)
}
