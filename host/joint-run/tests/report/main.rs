//! Reports of made-up runs: what a reader must find in them, whatever happened. Real runs are the emulator tests'.

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

/// Leaves a report where a person can look at it.
fn keep_for_looking(name: &str, text: &str) {
    if let Some(folder) = std::env::var_os("REPORT_LOOK") {
        fs::write(Path::new(&folder).join(name), text).expect("REPORT_LOOK names a folder");
    }
}

/// Where a text stands in a page.
fn place(page: &str, text: &str) -> usize {
    page.find(text).unwrap_or_else(|| panic!("`{text}` is not in the page"))
}

#[test]
fn a_good_run_shows_everything() {
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
fn a_page_needs_neither_network_nor_script() {
    let page = render(&synthetic::record());
    for text in ["<script", "<link", "@import", "url(", " src=", " href="] {
        assert!(!page.contains(text), "{text}");
    }
    // The name of the SVG name space is never fetched.
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("://"));
}

#[test]
fn a_page_stays_small_enough_to_send() {
    let mut record = synthetic::record();
    let noisy = |index: usize| if index.is_multiple_of(3) { Contact::BackSide } else { Contact::DriveSide };
    for (mesh, column) in record.samples.contact.iter_mut().enumerate() {
        *column = (0..column.len()).map(|index| noisy(index / (mesh + 2))).collect();
    }
    let bytes = render(&record).len();
    assert!(bytes < 3_000_000, "{bytes} bytes");
}

#[test]
fn failed_checks_lead() {
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
fn every_timing_figure_of_an_emulator_says_so() {
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
fn a_run_that_broke_off_says_so_first() {
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
fn a_run_without_samples_still_gives_a_page() {
    let page = render(&synthetic::empty());
    keep_for_looking("empty.html", &page);
    assert!(page.contains("No sample was received") && page.contains("INCOMPLETE") && page.ends_with("</html>"));
    assert_eq!(picture(&synthetic::empty()), None);
}

#[test]
fn a_state_that_is_not_finite_leaves_the_pictures_whole() {
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
fn what_a_user_named_cannot_become_markup() {
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
fn a_record_comes_back_from_its_json() {
    let record = synthetic::record();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.json");
    write_record(&path, &record).expect("the folder is writable");
    let text = fs::read_to_string(&path).expect("it was written");
    let again: RunRecord = serde_json::from_str(&text).expect("it is the same schema");
    assert_eq!(again, record);
    assert_eq!(fs::read_dir(folder.path()).expect("it is there").count(), 1, "no temporary file is left");
}

#[test]
fn a_report_that_cannot_be_written_costs_no_record() {
    let record = synthetic::record();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let prepared = Folder::prepare(Some(folder.path()), "hil", "Q1", &files::ALL).expect("an empty folder");
    fs::create_dir(prepared.file("report.html")).expect("the folder is writable");
    let failure = write_to(&prepared, &record).expect_err("a folder stands in the way");
    assert!(failure.message().contains("report.html"), "{failure}");
    assert!(failure.help().is_some_and(|help| help.contains("folder")));
    assert!(fs::metadata(prepared.file("record.json")).is_ok_and(|file| file.len() > 1000));
}

#[test]
#[cfg(unix)]
fn what_is_no_file_is_never_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("socket");
    let _socket = std::os::unix::net::UnixListener::bind(&path).expect("sockets are supported");
    write_record(&path, &synthetic::record()).expect_err("a socket cannot be opened as a file");
    assert!(fs::metadata(&path).is_ok_and(|there| there.file_type().is_socket()));
}

#[test]
fn a_folder_in_the_way_is_named_and_stays() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.json");
    fs::create_dir(&path).expect("the folder is writable");
    let failure = write_record(&path, &synthetic::record()).expect_err("a folder stands in the way");
    assert!(failure.help().is_some_and(|help| help.contains("a file in it")), "{failure}");
    assert!(path.is_dir());
}

#[test]
#[cfg(unix)]
fn a_write_that_fails_leaves_the_old_file() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (old, link) = (folder.path().join("old.html"), folder.path().join("link.html"));
    fs::write(&old, "old").expect("the folder is writable");
    symlink(&old, &link).expect("links are supported");
    // The temporary file's name is taken by a folder, so that nothing can be written beside the target.
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
fn a_document_gets_a_small_picture_of_its_own() {
    let svg = picture(&synthetic::record()).expect("the made-up run crosses the gap");
    keep_for_looking("joint.svg", &svg);
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains("<style>"));
    assert!(svg.contains("EMULATED") && svg.contains("ELF 3b1f0c55d7ae"), "a picture says where it comes from");
    assert!(svg.len() < 150_000, "{} bytes", svg.len());
    let failure = write_picture(&synthetic::empty(), Path::new("none.svg")).expect_err("nothing was recorded");
    assert!(failure.message().contains("none.svg") && failure.help().is_some(), "{failure}");
}

#[test]
fn every_compared_quantity_is_drawn() {
    let mut record = synthetic::record();
    let errors = &mut record.reference.as_mut().expect("the made-up run has one").errors;
    let one = errors[0].clone();
    errors.extend((2..=7).map(|number| ErrorSeries { quantity: format!("quantity {number}"), ..one.clone() }));
    let page = render(&record);
    keep_for_looking("errors.html", &page);
    (2..=7).for_each(|number| assert!(page.contains(&format!("quantity {number}: RMS 0.0202 %"))));
}

#[test]
fn verdicts_follow_from_figures() {
    assert!(synthetic::record().passed());
    assert!(synthetic::record().checks.iter().all(|check| check.verdict != Verdict::Failed));
}
