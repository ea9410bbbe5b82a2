//! Results as JUnit XML, for a lab's test server: a suite for each file, a case for each assertion; a file that could
//! not run is a skipped case. Assertions share their runs, so the cases of a file share its time equally and their
//! times add up to the suite's. Details without a JUnit element are in the JSON.

use std::fmt::Write;

use super::record::{NotRun, TestRecord, TestsRecord};
use report::checks::{Bound, Verdict};
use report::escape;

/// The whole document.
pub fn render(record: &TestsRecord) -> String {
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let tests = record.tests.iter().map(case_count).sum::<usize>() + record.not_run.len();
    let failed: usize = record.tests.iter().map(|test| test.failed().count()).sum();
    let errors = record.tests.iter().filter(|test| test.broken.is_some()).count();
    // The number of skipped cases stands with each suite: the schema of Jenkins allows it only there. Writing to a
    // string cannot fail.
    let _ = writeln!(
        xml,
        "<testsuites name=\"joint hil\" tests=\"{tests}\" failures=\"{failed}\" errors=\"{errors}\" time=\"{:.3}\">",
        record.seconds
    );
    record.tests.iter().for_each(|test| suite(&mut xml, test, &record.date));
    record.not_run.iter().for_each(|not_run| skipped_suite(&mut xml, not_run, &record.date));
    xml += "</testsuites>\n";
    xml
}

/// Number of cases of a test. A test that broke off, or asserts nothing, has a case of its own.
fn case_count(test: &TestRecord) -> usize {
    test.assertions.len() + usize::from(test.broken.is_some() || test.assertions.is_empty())
}

fn suite(xml: &mut String, test: &TestRecord, date: &str) {
    let name = escaped(&test.file);
    let errors = usize::from(test.broken.is_some());
    let failed = test.failed().count();
    let time = test.seconds / case_count(test) as f64;
    let _ = writeln!(
        xml,
        "  <testsuite name=\"{name}\" tests=\"{}\" failures=\"{failed}\" errors=\"{errors}\" skipped=\"0\" time=\"{:.3}\" timestamp=\"{}\">",
        case_count(test),
        test.seconds,
        escaped(date)
    );
    if test.broken.is_some() || test.assertions.is_empty() {
        let _ = write!(xml, "    <testcase classname=\"{name}\" name=\"runs to its end\" time=\"{time:.3}\"");
        match &test.broken {
            Some(why) => {
                let _ = writeln!(
                    xml,
                    ">\n      <error type=\"broken off\" message=\"{}\"/>\n    </testcase>",
                    escaped(why)
                );
            }
            None => *xml += "/>\n",
        }
    }
    for assertion in &test.assertions {
        let bound = match assertion.bound {
            Bound::AtMost(bound) => format!("<= {bound}"),
            Bound::AtLeast(bound) => format!(">= {bound}"),
            Bound::Exactly(bound) => format!("== {bound}"),
            Bound::None => String::new(),
        };
        let title = escaped(&format!("{} ({}) {bound}", assertion.name, assertion.aggregate));
        let _ = write!(xml, "    <testcase classname=\"{name}\" name=\"{title}\" time=\"{time:.3}\"");
        if assertion.verdict == Verdict::Failed {
            let figure = assertion.figure.map_or("none".to_owned(), |figure| figure.to_string());
            let seed = assertion.seed.map_or(String::new(), |seed| format!(", seed {seed}"));
            let message = escaped(&format!("{figure} {}{seed}. {}", assertion.unit, assertion.note));
            let _ = writeln!(xml, ">\n      <failure type=\"bound\" message=\"{message}\"/>\n    </testcase>");
        } else {
            *xml += "/>\n";
        }
    }
    let _ = writeln!(xml, "    <system-out>{}</system-out>\n  </testsuite>", escaped(&test.replay));
}

fn skipped_suite(xml: &mut String, not_run: &NotRun, date: &str) {
    let NotRun { file, why, remedy } = not_run;
    let (name, date) = (escaped(file), escaped(date));
    let message = escaped(&remedy.as_ref().map_or(why.clone(), |remedy| format!("{why} ({remedy})")));
    let _ = writeln!(
        xml,
        "  <testsuite name=\"{name}\" tests=\"1\" failures=\"0\" errors=\"0\" skipped=\"1\" time=\"0\" timestamp=\"{date}\">\n    \
         <testcase classname=\"{name}\" name=\"runs to its end\" time=\"0\">\n      <skipped type=\"not run\" message=\"{message}\"/>\n    </testcase>\n  \
         </testsuite>"
    );
}

fn escaped(text: &str) -> String {
    escape::escaped_xml(&escape::escaped(text)).replace(['\t', '\r'], " ")
}
