//! The page `docs/drive-in-five-minutes.md` as its reader follows it: its scripts run against its twins, and print what
//! the page shows. Runs in real time differ in small figures, so that numbers are compared within a tolerance.

use std::fs;
use std::path::Path;

use report::workspace::workspace;
use tempfile::TempDir;

use crate::command::folder;
use crate::environment::Environment;
use crate::once_more_if_failed;
use crate::twin::Twin;

/// Largest difference of two angles of the output [turns]: friction stops each motion at another place.
const TOLERANCE: f64 = 0.004;
/// Turns of the rotor, in which an ODrive has its angles, in a turn of the output.
const RATIO: f64 = 6.0;
/// Paths of the page, which a test replaces by those of its twin.
const PORT: &str = "/tmp/q1";
const CONTROL: &str = "/tmp/q1.sock";
/// Keys whose values depend on the moment.
const MOMENTARY: [&str; 3] = ["'time_s':", "'state':", "'gap_um':"];

/// Twin that the page started, with the packages of its client.
struct Running {
    twin: Twin,
    environment: Environment,
    /// Largest difference of two angles [turns].
    tolerance: f64,
}

impl Running {
    /// Twin of a command, which must announce itself as the page shows.
    fn start(command: &str, shown: &str) -> Self {
        let words: Vec<&str> = command.split_whitespace().collect();
        let ["cargo", "joint", "twin", "q1", "--drive", drive, "--link", PORT, "--control", CONTROL] = words[..] else {
            panic!("the test has no twin for `{command}`")
        };
        let twin = Twin::start(drive, &["q1"]);
        let announced = twin.announcement().replace(twin.control(), CONTROL).replace(twin.port(), PORT);
        assert!(shown.starts_with(&announced), "$ {command}\n{announced}\nbut the page has\n{shown}");
        let tolerance = if drive == "odrive" { RATIO * TOLERANCE } else { TOLERANCE };
        Self { twin, environment: Environment::new(drive), tolerance }
    }

    /// Output of `python SCRIPT [ARGUMENT]`.
    fn python(&self, command: &str, place: &Path) -> String {
        let (script, argument) = command.split_once(' ').unwrap_or((command, ""));
        let text = fs::read_to_string(place.join(script)).expect("the page has the script before it runs");
        let quoted = |path: &str| format!("{path:?}");
        let text = text.replace(&quoted(CONTROL), &quoted(self.twin.control()));
        let text = text.replace(&quoted(PORT), &quoted(self.twin.port()));
        let own = place.join("own.py");
        fs::write(&own, text).expect("written");
        let arguments = [argument.trim_matches('\'')];
        self.environment.output(&own, if argument.is_empty() { &[] } else { &arguments }).1
    }
}

#[test]
fn page_of_five_minutes_prints_what_it_shows() {
    once_more_if_failed(run_page);
}

fn run_page() {
    let page = fs::read_to_string(workspace().join("docs/drive-in-five-minutes.md")).expect("the page");
    let place: TempDir = folder();
    let (mut running, mut commands) = (None, 0);
    let mut parts = page.split("```");
    while let (Some(before), Some(block)) = (parts.next(), parts.next()) {
        let (language, text) = block.split_once('\n').expect("a fence has lines");
        match language {
            "python" => {
                let quoted = before.split('`').rfind(|word| word.ends_with(".py")).expect("the script has a name");
                fs::write(place.path().join(quoted), text).expect("written");
            }
            "console" => {
                for entry in text.split("$ ").filter(|entry| !entry.is_empty()) {
                    let (command, shown) = entry.split_once('\n').expect("a command is a line");
                    commands += 1;
                    if let Some(command) = command.strip_prefix("python ") {
                        let running: &Running = running.as_ref().expect("the page starts the twin first");
                        let printed = running.python(command, place.path());
                        let is_alike = is_alike(shown, &printed, running.tolerance);
                        assert!(is_alike, "$ python {command}\n{printed}\nbut the page has\n{shown}");
                    } else {
                        // The twin before it ends first.
                        drop(running.take());
                        running = Some(Running::start(command, shown));
                    }
                }
            }
            _ => {}
        }
    }
    assert!(commands > 10, "{commands} commands");
}

/// True if an output is that of the page: its last lines after a line `...`, numbers within the tolerance.
fn is_alike(shown: &str, printed: &str, tolerance: f64) -> bool {
    let (shown, mut printed): (Vec<&str>, Vec<&str>) = (shown.lines().collect(), printed.lines().collect());
    let shown = match shown.as_slice() {
        ["...", rest @ ..] => {
            printed.drain(..printed.len().saturating_sub(rest.len()));
            rest
        }
        all => all,
    };
    shown.len() == printed.len()
        && shown.iter().zip(&printed).all(|(shown, printed)| are_alike(shown, printed, tolerance))
}

fn are_alike(shown: &str, printed: &str, tolerance: f64) -> bool {
    let [shown, printed] = [shown, printed].map(|line| line.split_whitespace().collect::<Vec<_>>());
    let number = |word: &str| word.trim_matches([',', '{', '}']).parse::<f64>().ok();
    let before = |index: usize| index.checked_sub(1).map_or("", |before| shown[before].trim_start_matches('{'));
    shown.len() == printed.len()
        && (0..shown.len()).all(|index| match (number(shown[index]), number(printed[index])) {
            _ if MOMENTARY.contains(&before(index)) => true,
            (Some(shown), Some(printed)) => (shown - printed).abs() <= tolerance,
            _ => shown[index] == printed[index],
        })
}

#[test]
fn outputs_differ_by_words_and_by_large_numbers() {
    let is_alike = |shown: &str, printed: &str| is_alike(shown, printed, 0.004);
    assert!(is_alike("...\nmotor +0.1000  fault 0\n", "a\nb\nmotor +0.1030  fault 0\n"));
    assert!(is_alike("{'time_s': 1.0, 'fault': None}\n", "{'time_s': 7.5, 'fault': None}\n"));
    assert!(!is_alike("motor +0.1000  fault 0\n", "motor +0.1050  fault 0\n"));
    assert!(!is_alike("motor +0.1000  fault 0\n", "motor +0.1000  fault 40\n"));
    assert!(!is_alike("{'fault': None}\n", "{'fault': 'Watchdog'}\n"));
    assert!(!is_alike("one\n", "one\ntwo\n"));
}
