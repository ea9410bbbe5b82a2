//! Reports of synthetic runs: required content in every situation. The emulator tests have real runs.

mod synthetic;

use std::fs;
use std::path::Path;

use joint_run::files::{self, write_to};
use joint_run::page::{picture, render, write_picture};
use joint_run::record::{Completeness, ErrorSeries, RunRecord};
use report::checks::{Bound, Check, Source, Verdict};
use report::contacts::Contact;
use report::folder::Folder;
use report::write::{write_record, write_text};

/// Keeps a report for inspection by a person.
fn keep_for_looking(name: &str, text: &str) {
    if let Some(folder) = std::env::var_os("REPORT_LOOK") {
        fs::write(Path::new(&folder).join(name), text).expect("REPORT_LOOK names a folder");
    }
}

/// Position of a text in a page.
fn place(page: &str, text: &str) -> usize {
    page.find(text).unwrap_or_else(|| panic!("`{text}` is not in the page"))
}

#[test]
fn complete_run_shows_everything() {
    let page = render(&synthetic::record());
    keep_for_looking("good.html", &page);
    for text in
        ["PASSED", "Drive torque", "Motor and link angle", "Gap coordinate", "sun–planet meshes", "ring–planet 3"]
    {
        place(&page, text);
    }
    for text in
        ["Computation time of the tick", "deadline", "f64 reference", "Error against", "3b1f0c55d7ae2a41", "rustc"]
    {
        place(&page, text);
    }
    for text in
        ["profile firmware", "--profile reversals --seed 1", "no clock controller", "bit for bit", "8f3a41c07d925be6"]
    {
        place(&page, text);
    }
    assert!(!page.contains("INCOMPLETE"));
}

#[test]
fn page_needs_no_network_or_script() {
    let page = render(&synthetic::record());
    for text in ["<script", "<link", "@import", "url(", " src=", " href="] {
        assert!(!page.contains(text), "{text}");
    }
    // The URL of the SVG name space is never fetched.
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("://"));
}

#[test]
fn page_size_is_limited() {
    let mut record = synthetic::record();
    let noisy = |index: usize| if index.is_multiple_of(3) { Contact::BackSide } else { Contact::DriveSide };
    for (mesh, column) in record.samples.contact.iter_mut().enumerate() {
        *column = (0..column.len()).map(|index| noisy(index / (mesh + 2))).collect();
    }
    let bytes = render(&record).len();
    assert!(bytes < 3_000_000, "{bytes} bytes");
}

#[test]
fn failed_checks_come_first() {
    let mut record = synthetic::record();
    record.checks.push(Check::not_run("Reference", "%", Bound::AtMost(1.0), "the run was cut short"));
    record.checks.push(Check::new("Lost samples of the line", 3.0, "", Bound::Exactly(0.0), Source::Board));
    assert!(!record.passed());
    let page = render(&record);
    keep_for_looking("failed.html", &page);
    assert!(page.contains("1 CHECK FAILED"));
    assert!(place(&page, "Lost samples of the line") < place(&page, "the run was cut short"));
    assert!(place(&page, "the run was cut short") < place(&page, "Steps equal to the host twin"));
}

#[test]
fn emulated_timing_is_marked() {
    let mark = "<span class=\"emulated\">EMULATED</span>";
    let mut record = synthetic::record();
    let page = render(&record);
    for text in ["Longest computation", "Time [µs]", "Idle share", "Deepest stack", "<h2>Timing", "Count", "Overruns"]
    {
        let after = &page[place(&page, text)..];
        assert!(after[..160].contains(mark), "{text} is not marked: {}", &after[..160]);
    }
    for caption in page.split("<figcaption>").skip(1) {
        assert!(caption.split("</figcaption>").next().is_some_and(|text| text.contains(mark)), "{caption:.200}");
    }
    record.identity.emulated = false;
    assert!(!render(&record).contains("EMULATED"), "a real board's figures are not the emulator's");
}

#[test]
fn interrupted_run_says_so_first() {
    let mut record = synthetic::record();
    record.completeness = Completeness::Interrupted { reason: "the port was closed".into(), tick: 41_220 };
    record.timing = None;
    record.checks.clear();
    let page = render(&record);
    keep_for_looking("incomplete.html", &page);
    assert!(page.contains("INCOMPLETE") && page.contains("41220") && page.contains("the port was closed"));
    assert!(place(&page, "the port was closed") < place(&page, "<h2>Checks"));
    assert!(!record.passed());
}

#[test]
fn run_without_samples_gives_page() {
    let page = render(&synthetic::empty());
    keep_for_looking("empty.html", &page);
    assert!(page.contains("No sample was received") && page.contains("INCOMPLETE") && page.ends_with("</html>"));
    assert_eq!(picture(&synthetic::empty()), None);
}

#[test]
fn non_finite_state_keeps_pictures() {
    let mut record = synthetic::record();
    for index in (0..record.samples.len()).step_by(5) {
        record.samples.gap_m[index] = f32::NAN;
        record.samples.twist_rad[index] = f64::INFINITY;
        record.samples.deflection_m[0][index] = f32::NEG_INFINITY;
        record.samples.time_s[index + 1] = f64::NAN;
    }
    record.samples.motor_angle_rad.fill(f64::NAN);
    let page = render(&record);
    for svg in page.split("<svg").skip(1) {
        let svg = svg.split("</svg>").next().unwrap_or_default();
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("-2147483648"), "a number is broken");
        assert!(svg.contains("polyline"), "a picture is missing: {svg:.200}");
    }
}

#[test]
fn user_text_is_escaped() {
    let mut record = synthetic::record();
    let nasty = "<script>alert(1)</script>&\"'";
    record.identity.joint = nasty.into();
    record.settings.profile = nasty.into();
    record.log[0].text = nasty.into();
    record.log[0].level = "\" onload=\"x".into();
    record.checks[0].note = nasty.into();
    record.checks[0].unit = "<b>".into();
    let reference = record.reference.as_mut().expect("the made-up run has one");
    reference.errors[0].quantity = nasty.into();
    let page = render(&record);
    assert!(!page.contains("<script") && !page.contains("<b>") && !page.contains("\" onload=\"x"));
    assert!(page.contains("&lt;script&gt;"));
}

#[test]
fn record_survives_json() {
    let record = synthetic::record();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.json");
    write_record(&path, &record).expect("the folder is writable");
    let text = fs::read_to_string(&path).expect("it was written");
    let again: RunRecord = serde_json::from_str(&text).expect("it is the same schema");
    assert_eq!(again, record);
    assert_eq!(fs::read_dir(folder.path()).expect("it is there").count(), 1, "no temporary file is left");
}

/// A report that cannot be written does not affect the record.
#[test]
fn failed_report_keeps_record() {
    let record = synthetic::record();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let prepared = Folder::prepare(Some(folder.path()), "hil", "Q1", &files::ALL_FILES).expect("an empty folder");
    fs::create_dir(prepared.file("report.html")).expect("the folder is writable");
    let failure = write_to(&prepared, &record).expect_err("a folder stands in the way");
    assert!(failure.message().contains("report.html"), "{failure}");
    assert!(failure.help().is_some_and(|help| help.contains("folder")));
    assert!(fs::metadata(prepared.file("record.json")).is_ok_and(|file| file.len() > 1000));
}

#[test]
#[cfg(unix)]
fn special_file_is_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("socket");
    let _socket = std::os::unix::net::UnixListener::bind(&path).expect("sockets are supported");
    write_record(&path, &synthetic::record()).expect_err("a socket cannot be opened as a file");
    assert!(fs::metadata(&path).is_ok_and(|there| there.file_type().is_socket()));
}

#[test]
fn folder_in_the_way_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.json");
    fs::create_dir(&path).expect("the folder is writable");
    let failure = write_record(&path, &synthetic::record()).expect_err("a folder stands in the way");
    assert!(failure.help().is_some_and(|help| help.contains("a file in it")), "{failure}");
    assert!(path.is_dir());
}

#[test]
#[cfg(unix)]
fn failed_write_keeps_old_file() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (old, link) = (folder.path().join("old.html"), folder.path().join("link.html"));
    fs::write(&old, "old").expect("the folder is writable");
    symlink(&old, &link).expect("links are supported");
    // A folder with the temporary file's name prevents writing beside the target.
    fs::create_dir(folder.path().join(format!(".old.html.joint-{}.tmp", std::process::id())))
        .expect("the name is free");
    write_text(&link, &render(&synthetic::record())).expect_err("the name is taken");
    assert_eq!(fs::read_to_string(&old).expect("it is there"), "old");
    fs::remove_dir(folder.path().join(format!(".old.html.joint-{}.tmp", std::process::id()))).expect("it is empty");
    write_text(&link, &render(&synthetic::record())).expect("nothing is in the way");
    assert!(fs::symlink_metadata(&link).is_ok_and(|link| link.is_symlink()), "a link stays a link");
    assert!(fs::read_to_string(&old).is_ok_and(|page| page.contains("</html>")));
}

#[test]
fn picture_is_small_and_standalone() {
    let svg = picture(&synthetic::record()).expect("the made-up run crosses the gap");
    keep_for_looking("joint.svg", &svg);
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains("<style>"));
    assert!(svg.contains("EMULATED") && svg.contains("ELF 3b1f0c55d7ae"), "a picture says where it comes from");
    assert!(svg.len() < 150_000, "{} bytes", svg.len());
    let failure = write_picture(&synthetic::empty(), Path::new("none.svg")).expect_err("nothing was recorded");
    assert!(failure.message().contains("none.svg") && failure.help().is_some(), "{failure}");
}

#[test]
fn compared_quantities_are_drawn() {
    let mut record = synthetic::record();
    let errors = &mut record.reference.as_mut().expect("the made-up run has one").errors;
    let one = errors[0].clone();
    errors.extend((2..=7).map(|number| ErrorSeries { quantity: format!("quantity {number}"), ..one.clone() }));
    let page = render(&record);
    keep_for_looking("errors.html", &page);
    (2..=7).for_each(|number| assert!(page.contains(&format!("quantity {number}: RMS 0.0202 %"))));
}

#[test]
fn synthetic_run_passes() {
    assert!(synthetic::record().passed());
    assert!(synthetic::record().checks.iter().all(|check| check.verdict != Verdict::Failed));
}
