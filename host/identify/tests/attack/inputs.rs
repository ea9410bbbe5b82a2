//! Valid files of every kind, and their readers.

use std::fmt::Write as _;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use board::profile::{LONGEST_RUN, TorqueProfile};
use identify::{Arguments, Options};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use reference::closed_loop::MotionProfile;
use replay::ReplayArguments;
use report::failure::{EXIT_BAD_INPUT, EXIT_CHECK_FAILED, Failure};
use report::progress::Progress;
use report::seeds::Seeds;
use scenario::plant::PlantName;
use scenario::{TestGroup, TestRequest, suite};

/// Number of MCAP packings.
pub const PACKINGS: usize = 5;
/// Rows of a log: few enough to be rejected as too short after reading.
const ROWS: usize = 40;
/// Reason for the rejection of the valid logs.
const TOO_SHORT: &str = "the log is too short";

/// Kind of a file.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// Joint file.
    Joint,
    /// Test file.
    Test,
    /// Motion beside a test file.
    Motion,
    /// Torque profile.
    Torques,
    /// Log for `joint identify`.
    CsvLog,
    /// Log for the quasi-static mode of `joint identify`.
    SlowLog,
    /// Log as MCAP, in one of the packings.
    McapLog(usize),
    /// Message definition of the MCAP log alone.
    Definition,
    /// Log of a run, for `joint replay`.
    Run,
}

/// Returns true for bytes that a faulty reader would fail on.
pub type Fault = fn(&[u8]) -> bool;

/// Every kind of file.
pub fn all() -> impl Iterator<Item = Kind> {
    let packed = (0..PACKINGS).map(Kind::McapLog);
    [Kind::Joint, Kind::Test, Kind::Motion, Kind::Torques, Kind::CsvLog, Kind::SlowLog, Kind::Definition, Kind::Run]
        .into_iter()
        .chain(packed)
}

const MOTION: &str = "time_s,position_rad,load_torque_N_m\n0,0,0\n0.5,0.1,1\n1,0.3,2\n2.5,0.2,-1\n4,0,0\n";
const TORQUES: &str = "time_s,motor_torque_Nm,load_torque_Nm\n0,0,0\n0.5,1,6\n1,2,3\n2,-2,-3\n";
const TEST: &str = "title = \"attack\"\njoint = \"q1\"\nseeds = [1, 2]\nduration_s = 4\nsettle_s = 1.5\ntimeout_s = 60\n\
                    [known]\nmotor_coulomb_friction_N_m = 0.02\n[plant]\nhalf_backlash_um = [30, 50]\n\
                    [profile]\nkind = \"sine\"\namplitude_rad = 0.3\nfrequency_Hz = 1.5\n\
                    [controller]\nmode = \"preview\"\nbandwidth_rad_per_s = 60\nwidth_guess_ratio = [0.5, 1.5]\n\
                    rivals = [\"motor_pid\"]\n\
                    [[disturbance]]\nkind = \"pulse\"\nstart_s = 2\nlength_s = 0.1\ntorque_N_m = 3\n\
                    [[fault]]\nkind = \"encoder_offset\"\nstart_s = 2\ncounts = 40\n\
                    [assert]\nrms_mrad = \"<= 100\"\n";
const WITH_MOTION: &str = "[profile]\nkind = \"csv\"\nfile = \"motion.csv\"\n";
const DEFINITION: &str = "std_msgs/Header header\nfloat64[] position\nint64[2] raw\nfloat64 torque\nPart[<=3] parts\n===\n\
                    MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n===\nMSG: a/Part\nuint8 one\n";

impl Kind {
    /// Valid file of this kind.
    pub fn valid(self) -> Vec<u8> {
        match self {
            Self::Joint => joint_file::preset("q1").unwrap_or_default().into(),
            Self::Test => TEST.into(),
            Self::Motion => MOTION.into(),
            Self::Torques => TORQUES.into(),
            Self::CsvLog => csv().into(),
            Self::SlowLog => sweeps().into(),
            Self::McapLog(packing) => mcap(packing, DEFINITION.as_bytes()),
            Self::Definition => DEFINITION.into(),
            Self::Run => run_log().unwrap_or_default(),
        }
    }

    /// Reads a file as a command does. A failure must be bad input with a message; accepted content must satisfy the
    /// assumptions of the code behind the reader.
    pub fn read(self, bytes: &[u8]) -> Result<(), String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let file = |name: &str, bytes: &[u8]| -> Result<PathBuf, String> {
            let path = folder.path().join(name);
            fs::write(&path, bytes).map_err(|error| error.to_string())?;
            Ok(path)
        };
        match self {
            Self::Joint => accepted(joint_file::named::load(&file("joint.toml", bytes)?)).map(drop),
            Self::Test => {
                accepted(suite::load(&file("test.toml", bytes)?, suite::Choice::Full, PlantName::Core)).map(drop)
            }
            Self::Motion => {
                file("motion.csv", bytes)?;
                match accepted(suite::from_text("test.toml", WITH_MOTION, folder.path(), PlantName::Core))? {
                    Some(test) => followed(&test),
                    None => Ok(()),
                }
            }
            Self::Torques => {
                let joint = joint_file::read(joint_file::preset("q1").unwrap_or_default());
                let joint = joint.map_err(|_| "the preset cannot be read")?.parameters;
                let path = file("torques.csv", bytes)?;
                let profile = accepted(TorqueProfile::load(&path.display().to_string(), &joint, 20_000, None))?;
                let finite = |profile: &TorqueProfile| {
                    profile.commands.iter().all(|one| one.drive_torque.is_finite() && one.load_torque.is_finite())
                };
                if profile.as_ref().is_none_or(finite) { Ok(()) } else { Err("a torque is not finite".to_owned()) }
            }
            Self::SlowLog => {
                let log = file("log.csv", bytes)?;
                accepted(identify::run(&slow(&log, folder.path()), &Progress::new())).map(drop)
            }
            Self::CsvLog => identified(&file("log.csv", bytes)?, folder.path()),
            Self::McapLog(_) => identified(&file("log.mcap", bytes)?, folder.path()),
            Self::Definition => identified(&file("log.mcap", &mcap(0, bytes))?, folder.path()),
            Self::Run => match replay(&file("log.mcap", bytes)?, folder.path()) {
                // A differing count or estimate is no rejection: the replay reports that the run is not reproduced.
                Err(failure) if failure.exit_code() == EXIT_CHECK_FAILED => Ok(()),
                outcome => accepted(outcome).map(drop),
            },
        }
    }

    /// Reason for a rejection, except the shortness that all logs have here.
    pub fn refusal(self, bytes: &[u8]) -> Option<String> {
        let folder = tempfile::tempdir().ok()?;
        let path = folder.path().join("log");
        match self {
            Self::CsvLog | Self::SlowLog | Self::McapLog(_) => fs::write(&path, bytes).ok()?,
            Self::Definition => fs::write(&path, mcap(0, bytes)).ok()?,
            Self::Run => {
                fs::write(&path, bytes).ok()?;
                return replay(&path, folder.path()).err().map(|failure| failure.to_string());
            }
            _ => return None,
        }
        let arguments = if matches!(self, Self::SlowLog) { slow } else { arguments };
        let why = identify::run(&arguments(&path, folder.path()), &Progress::new()).err()?.message().to_owned();
        (!why.contains(TOO_SHORT)).then_some(why)
    }

    /// Faults that a reader of this kind of file may have, by their triggers.
    pub fn planted_faults(self) -> Vec<(&'static str, Fault)> {
        match self {
            Self::McapLog(_) | Self::Run => vec![
                ("a length beyond the file", |bytes| bytes.windows(8).any(|eight| eight == u64::MAX.to_le_bytes())),
                ("no end", |bytes| !bytes.ends_with(b"\x89MCAP0\r\n")),
            ],
            _ => vec![
                ("a number beyond all bounds", |bytes| bytes.windows(5).any(|five| five == b"1e300")),
                ("nothing but a beginning", |bytes| bytes.len() < 20),
                ("a depth beyond all bounds", |bytes| {
                    bytes.windows(500).any(|many| many.iter().all(|byte| *byte == b'['))
                }),
                ("no text", |bytes| std::str::from_utf8(bytes).is_err()),
            ],
        }
    }
}

/// Accepted content; `None` if it was rejected as bad input.
fn accepted<T>(outcome: Result<T, Failure>) -> Result<Option<T>, String> {
    match outcome {
        Ok(read) => Ok(Some(read)),
        Err(failure) if failure.exit_code() == EXIT_BAD_INPUT && !failure.to_string().is_empty() => Ok(None),
        Err(failure) => Err(format!("not a refusal of bad input: {failure}")),
    }
}

fn followed(test: &suite::Test) -> Result<(), String> {
    let motion = test.motion.as_ref().ok_or("there is no motion")?;
    if !(0.0..=LONGEST_RUN).contains(&test.file.duration) {
        return Err(format!("a run of {} s", test.file.duration));
    }
    for row in motion.rows() {
        let at = motion.at(row.time);
        if !(at.position.is_finite() && at.speed.is_finite() && at.acceleration.is_finite()) {
            return Err(format!("{at:?} at {} s", row.time));
        }
    }
    Ok(())
}

fn identified(log: &Path, folder: &Path) -> Result<(), String> {
    accepted(identify::run(&arguments(log, folder), &Progress::new())).map(drop)
}

fn replay(log: &Path, folder: &Path) -> Result<String, Failure> {
    let arguments = ReplayArguments {
        log: log.to_owned(),
        joint: None,
        set: Vec::new(),
        motor_only: false,
        topic: None,
        column: Vec::new(),
        unit: Vec::new(),
        map: None,
        map_joint: None,
        every: None,
        out: Some(folder.join("out")),
        json: None,
    };
    replay::run(&arguments, &Progress::new())
}

/// Log of a very short run; cached for the processes of all cases, and made again after a build.
fn run_log() -> Option<Vec<u8>> {
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join("attacked-run.mcap");
    let changed = |path: &Path| fs::metadata(path).and_then(|file| file.modified()).ok();
    if changed(&kept) > changed(&std::env::current_exe().ok()?) {
        return fs::read(&kept).ok();
    }
    let bytes = new_run_log()?;
    // A rename keeps the file whole while other processes write it too.
    let growing = kept.with_extension(std::process::id().to_string());
    fs::write(&growing, &bytes).and_then(|()| fs::rename(&growing, &kept)).ok()?;
    Some(bytes)
}

fn new_run_log() -> Option<Vec<u8>> {
    let folder = tempfile::tempdir().ok()?;
    let path = folder.path().join("test.toml");
    let test = "duration_s = 0.02\nsettle_s = 0.01\nprofile = \"T2\"\n[controller]\nrivals = []\nfrom_memory = true\n";
    fs::write(&path, test).ok()?;
    let group = TestGroup { path, choice: suite::Choice::Full, plant: PlantName::Core, boards: None };
    let request = TestRequest {
        groups: vec![group],
        seed: Some(Seeds { first: 1, last: 1 }),
        full: false,
        save_memories: false,
        name: "test".to_owned(),
        out: Some(folder.path().join("out")),
        json: None,
        junit: None,
        live: Default::default(),
        tasks: None,
    };
    scenario::run(&request, &Progress::new()).ok()?;
    let mut logs = fs::read_dir(folder.path().join("out/runs")).ok()?;
    fs::read(logs.next()?.ok()?.path()).ok()
}

fn arguments(log: &Path, folder: &Path) -> Arguments {
    let column = [("motor_counts", "raw[0]"), ("output_counts", "raw[1]"), ("motor_torque_N_m", "torque")];
    let is_mcap = fs::read(log).is_ok_and(|bytes| bytes.starts_with(b"\x89MCAP"));
    let column =
        column.into_iter().filter(|_| is_mcap).map(|(own, theirs)| (own.to_owned(), theirs.to_owned())).collect();
    Arguments {
        log: log.to_owned(),
        topic: None,
        column,
        unit: Vec::new(),
        map: None,
        map_joint: None,
        joint: "q1".into(),
        set: Vec::new(),
        motor_bits: None,
        output_bits: None,
        torque_error: None,
        inertia_error: 1.5,
        simulate: false,
        seed: 1,
        with_output_torque: false,
        output_locked: false,
        output_only: false,
        out: Some(folder.join("out")),
        json: None,
        slow: Options::default(),
    }
}

fn slow(log: &Path, folder: &Path) -> Arguments {
    Arguments { slow: Options { quasi_static: true, ..Options::default() }, ..arguments(log, folder) }
}

/// Three sweeps each way over a width of 200 counts.
fn sweeps() -> String {
    let mut text = "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned();
    for row in 0..300 {
        let (sweep, place) = (row / 50 % 2, row % 50);
        let motor = 40 * if sweep == 0 { place } else { 50 - place };
        let _ = writeln!(text, "{},{motor},{},{}", row as f64 * 0.1, motor + 200 * sweep, 1 - 2 * sweep);
    }
    text
}

fn csv() -> String {
    let mut text = "time_s,motor_counts,output_counts,motor_torque_N_m\n".to_owned();
    for row in 0..ROWS {
        let _ = writeln!(text, "{:.4},{},{},{}", row as f64 * 1e-4, row * 12, row * 16, 1.5);
    }
    text
}

/// Log with messages of the form `DEFINITION`, under the message definition `form`.
fn mcap(packing: usize, form: &[u8]) -> Vec<u8> {
    let plain = WriteOptions::new().compression(None);
    // Without checksums a change reaches the reader of messages.
    let unchecked = |options: WriteOptions| options.calculate_chunk_crcs(false).calculate_data_section_crc(false);
    let options = match packing {
        0 => unchecked(plain),
        1 => plain,
        2 => unchecked(plain.use_chunks(false)),
        3 => unchecked(WriteOptions::new().compression(Some(Compression::Lz4))),
        _ => unchecked(WriteOptions::new().compression(Some(Compression::Zstd))),
    };
    let mut out = Cursor::new(Vec::new());
    let written = options.create(&mut out).and_then(|mut writer| {
        let schema = writer.add_schema("lab/Drive", "ros2msg", form)?;
        let channel = writer.add_channel(schema, "/drive", "cdr", &Default::default())?;
        for row in 0..ROWS {
            let time = 100_000 * row as u64;
            let header =
                MessageHeader { channel_id: channel, sequence: row as u32, log_time: time, publish_time: time };
            writer.write_to_known_channel(&header, &message(row))?;
        }
        writer.finish()
    });
    written.map(|_| out.into_inner()).unwrap_or_default()
}

/// Written by hand from the rules: every number is aligned to its size behind the header.
fn message(row: usize) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(0_i32.to_le_bytes());
    bytes.extend((100_000 * row as u32).to_le_bytes());
    // Frame of four letters; one position, aligned to eight.
    bytes.extend([4, 0, 0, 0, b'b', b'a', b's', 0, 1, 0, 0, 0]);
    bytes.extend([0; 4]);
    bytes.extend(0.25_f64.to_le_bytes());
    for count in [row * 12, row * 16] {
        bytes.extend((count as i64).to_le_bytes());
    }
    bytes.extend(1.5_f64.to_le_bytes());
    bytes.extend([1, 0, 0, 0, 7]);
    bytes
}
