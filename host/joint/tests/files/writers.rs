//! Every command that writes files, as short as possible. Images and FMUs are left out, since they need a compiler.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::command::{Ended, QUICK_ROWS, joint, text, write_short_log};
use crate::pseudo_terminal;
use crate::thread_board::{self, Misbehaviour};

/// Input files of the commands, created once.
static INPUTS: LazyLock<PathBuf> = LazyLock::new(inputs);

/// A test file that runs in a fraction of a second.
const TEST: &str = "duration_s = 0.2\nsettle_s = 0.1\nprofile = \"T2\"\n[controller]\nrivals = []\n";
const SWEEP: [&str; 6] = ["sweep", "paper", "--vary", "half_backlash_um=0:150:5", "--duration", "0.01"];

fn inputs() -> PathBuf {
    // A static temporary folder would never be removed, so the inputs lie in the build's folder.
    let inputs = Path::new(env!("CARGO_TARGET_TMPDIR")).join("inputs-of-writers");
    let path = |name: &str| inputs.join(name);
    let _ = fs::remove_dir_all(&inputs);
    fs::create_dir_all(&inputs).expect("room");
    fs::write(path("test.toml"), TEST).expect("room");
    write_short_log(&path("log.csv"), QUICK_ROWS);
    fs::write(path("sweeps.csv"), sweeps()).expect("room");
    fs::write(path("still.csv"), still()).expect("room");
    inputs
}

/// Log of slow sweeps in both directions, with a width of 100 counts.
fn sweeps() -> String {
    let row = |sample: i32| {
        let (sweep, place) = (sample / 100 % 2, sample % 100);
        let motor = 20 * if sweep == 0 { place } else { 100 - place };
        format!("{sample},{motor},{}\n", motor + 100 * sweep)
    };
    "time_s,motor_counts,output_counts\n".to_owned() + &(0..600).map(row).collect::<String>()
}

/// Log of half a second of a joint that hardly moves, one row each control period.
fn still() -> String {
    let row = |row: i32| format!("{},{},{row},0.1\n", 1e-4 * f64::from(row), 3 * row / 4);
    "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned() + &(0..5000).map(row).collect::<String>()
}

/// Options of a data sheet.
const SHEET: [&str; 14] = [
    "--ratio",
    "9",
    "--lost-motion-arcmin",
    "15",
    "--stiffness-Nm-per-arcmin",
    "1.8",
    "--rated-torque-Nm",
    "8",
    "--rotor-inertia-kg-cm2",
    "0.32",
    "--no-load-torque-Nm",
    "0.05",
    "--efficiency",
    "0.94",
];

/// A command that writes files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Writer {
    Sim,
    Sweep,
    Tests,
    Board,
    Identify,
    SlowLog,
    Replay,
    Simulate,
    Check,
    Budget,
    New,
    Tables,
}

/// A command line, and the port of a board, open as long as the command runs.
pub struct Line {
    pub words: Vec<String>,
    _port: Option<File>,
}

impl Writer {
    /// Commands that write to the folder of `--out`.
    pub const TO_FOLDERS: [Self; 8] =
        [Self::Sim, Self::Sweep, Self::Tests, Self::Board, Self::Identify, Self::SlowLog, Self::Replay, Self::Tables];

    /// Returns true for commands that take a second or more; a short run of the test repeats them less often.
    pub fn is_slow(self) -> bool {
        self == Self::Simulate
    }

    /// Returns the file that the command writes, for commands that never overwrite a file: whenever that file exists,
    /// it is complete.
    pub fn writes_once(self) -> Option<&'static str> {
        match self {
            Self::Simulate => Some("log.csv"),
            Self::New => Some("elbow.toml"),
            _ => None,
        }
    }

    /// Command line that writes to a folder, or to a file in the folder.
    pub fn line(self, out: &Path) -> Line {
        let input = |name: &str| INPUTS.join(name).to_string_lossy().into_owned();
        let file = |name: &str| out.join(name).to_string_lossy().into_owned();
        let port = (self == Self::Board).then(|| board(&out.with_extension("port")));
        let words: Vec<String> = match self {
            Self::Sim => words(&["sim", "l1", "--duration", "0.02", "--no-energy"]),
            Self::Sweep => words(&SWEEP),
            Self::Tests => words(&["hil", &input("test.toml"), "--host"]),
            Self::Board => {
                let path = out.with_extension("port");
                words(&["hil", "q1", "--port", text(&path), "--no-build", "--no-reference", "--duration", "0.1"])
            }
            Self::Identify => words(&["identify", &input("log.csv")]),
            Self::SlowLog => words(&["identify", &input("sweeps.csv"), "--quasi-static"]),
            Self::Replay => words(&["replay", &input("still.csv"), "q1"]),
            Self::Simulate => words(&["identify", &file("log.csv"), "--simulate"]),
            Self::Check => words(&["check", "q1", "--json", &file("check.json")]),
            Self::Budget => words(&["budget", "q1", "--json", &file("budget.json")]),
            Self::Tables => words(&["tables", "l1"]),
            Self::New => [&["new", &file("elbow"), "--no-measure"][..], &SHEET]
                .concat()
                .iter()
                .map(ToString::to_string)
                .collect(),
        };
        let mut line = Line { words, _port: port };
        if Self::TO_FOLDERS.contains(&self) {
            line.words.extend(["--out".to_owned(), text(out).to_owned()]);
        }
        line
    }

    /// Runs the command to its end.
    pub fn run(self, out: &Path) -> Ended {
        joint(&self.line(out).words())
    }
}

impl Line {
    pub fn words(&self) -> Vec<&str> {
        self.words.iter().map(String::as_str).collect()
    }
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(ToString::to_string).collect()
}

/// Starts a new board for every run. All runs use one name of the port, since records contain it.
fn board(port: &Path) -> File {
    let (master, slave, path) = pseudo_terminal::pair();
    let _ = fs::remove_file(port);
    std::os::unix::fs::symlink(path, port).expect("room");
    // The thread ends with the test's process: a pseudo-terminal stays open while one side is open.
    drop(thread_board::start(master, Misbehaviour::None));
    slave
}

/// Creates an empty folder for results below another folder.
pub fn empty_folder(place: &Path) -> PathBuf {
    let out = place.join("out");
    if out.exists() {
        fs::remove_dir_all(&out).expect("it is ours");
    }
    fs::create_dir(&out).expect("room");
    out
}
