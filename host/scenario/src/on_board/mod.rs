//! Tests with the controller on a board: an image for each seed's nominal joint, a board for each run, and a twin run
//! on the host that must agree in every bit. Rivals run on the host.
//!
//! `request` is the user's choice of boards, `runs` has a run for each role. In the role `observer` the board runs
//! observer and compensation behind `port`, and the plant stays on the host. In the role `loop` everything runs on the
//! board along a `trajectory`, and the metrics are computed from its `twin`.

mod faults;
mod port;
mod request;
mod runs;
#[cfg(test)]
mod same_faults;
mod trajectory;
mod twin;

use joint_file::JointFile;
use link::messages::{Role, RunMode, RunSettings, Statistics};
use model_core::controller::design::{NominalPlant, control_source};
pub use request::BoardRequest;
use request::{check_request, check_test};

use super::case::{Case, read_controller_joint};
use super::execution::{RunSpec, Watch};
use super::file::TestFile;
use super::plant::PlantName;
use super::record::BoardRun;
use super::rig::RunError;
use super::run_history::RunHistory;
use super::suite::{Suite, Test};
use board::connection::Connection;
use board::device::emulator;
use board::device::image;
use board::device::image::{Control, Image, role_name};
use board::device::tick_time::RateCheck;
use board::device::toolchain::Toolchain;
use board::session::{BoardHelp, Expected, Session, command_timeout};
use board::transport::Port;
use board::twin::tables_digest;
use report::command_line::quoted;
use report::failure::{Failure, Outcome};
use report::progress::Progress;

/// Control periods between samples of the whole loop; the digest covers every period.
const DECIMATION: u16 = 100;

/// Boards with toolchain and connection.
pub struct Boards<'w> {
    request: BoardRequest<'w>,
    toolchain: Option<Toolchain>,
    version: String,
}

/// History of a run on a board, and its record.
type BoardResult = Result<(RunHistory, BoardRun), RunError>;

/// Joints and settings of a run.
struct RunJoints {
    texts: [String; 2],
    nominal: JointFile,
    truth: JointFile,
    control: Control,
}

/// Control settings of the image of a test's controller.
fn control(file: &TestFile, case: &Case) -> Outcome<Control> {
    Ok(Control {
        bandwidth: Some(case.bandwidth(file)?),
        peak_torque: file.peak_torque,
        output_encoder: file.output_encoder,
        ..Control::with_defaults(case.nominal_surroundings.control_rate)
    })
}

impl<'w> Boards<'w> {
    /// Finds toolchain and emulator before any run, and removes tests that no board can run.
    pub fn prepare(
        request: BoardRequest<'w>,
        suite: &mut Suite,
        plant: PlantName,
        progress: &Progress,
    ) -> Outcome<Self> {
        check_request(&request, plant)?;
        suite.keep(|test| check_test(&request, test))?;
        let say = |line: &str| progress.print_message(line);
        let version = match request.port {
            // Opens and closes the port, so that a missing port is reported before the build.
            Some(path) => Port::open(path, request.baud.unwrap_or(request.board.baud_rate())).map(|_| String::new())?,
            None => {
                progress.stage("finding the emulator");
                emulator::ensure(&say)?
            }
        };
        let toolchain = if request.no_build {
            None
        } else {
            progress.stage("preparing the toolchain");
            Some(Toolchain::prepare(&say)?)
        };
        progress.clear();
        Ok(Self { request, toolchain, version })
    }

    /// Returns true if each run can have a board of its own.
    pub fn are_emulated(&self) -> bool {
        self.request.port.is_none()
    }

    /// Name of role and board, for the record.
    pub fn label(&self) -> String {
        let place = self.request.port.unwrap_or("emulated");
        format!("{} on {} ({place})", role_name(self.request.role), self.request.board.name())
    }

    /// Command-line arguments that select these boards again.
    pub fn arguments(&self) -> String {
        let BoardRequest { role, port, baud, board, no_build, force, mode } = self.request;
        let mut arguments = format!("--role {}", role_name(role));
        if let Some(port) = port {
            arguments += &format!(" --port {} --board {}", quoted(port), quoted(&board.argument));
        }
        if let Some(baud) = baud {
            arguments += &format!(" --baud {baud}");
        }
        if no_build {
            arguments += " --no-build";
        }
        if force {
            arguments += " --force";
        }
        match mode {
            Some(RunMode::Lockstep) => arguments + " --mode lockstep",
            Some(RunMode::Realtime) => arguments + " --mode realtime",
            None => arguments,
        }
    }

    /// Runs a case on a board and on the host; fails if the runs differ in any bit. The role `observer`, whose plant is
    /// on the host, shows itself in a live view under a name.
    pub fn run(&self, test: &Test, case: &Case, seed: u64, spec: RunSpec, watch: Watch<'_>) -> BoardResult {
        let pair = self.pair(test, case)?;
        match self.request.role {
            Role::Loop => self.run_loop(test, case, seed, &pair),
            Role::Observer | Role::Plant => self.run_observer(test, case, seed, spec, &pair, watch),
        }
    }

    fn pair(&self, test: &Test, case: &Case) -> Outcome<RunJoints> {
        let nominal_text = case.nominal_text()?;
        // In the role `observer` the image knows only the nominal joint.
        let truth_text =
            if self.request.role == Role::Loop { case.truth_text().to_owned() } else { nominal_text.clone() };
        let rate = case.nominal_surroundings.control_rate;
        let (mut nominal, mut truth) = (read_controller_joint(&nominal_text)?, read_controller_joint(&truth_text)?);
        [&mut nominal, &mut truth].into_iter().for_each(|joint| joint.surroundings.control_rate = rate);
        let control = Control { forced: self.request.force, ..control(&test.file, case)? };
        Ok(RunJoints { texts: [truth_text, nominal_text], nominal, truth, control })
    }

    /// Builds the image, connects to the board and starts the run.
    fn session(&self, pair: &RunJoints) -> Outcome<(Session<'static>, String)> {
        let request = &self.request;
        // Checked before the build, and also if the board keeps its image.
        RateCheck::new(&pair.truth.parameters, request.board, request.role)
            .check_unless_forced(pair.control.rate, request.force)?;
        let image = || {
            let build = |toolchain: &Toolchain| {
                let texts = pair.texts.each_ref().map(String::as_str);
                image::build_control_image(toolchain, texts, request.board, request.role, &pair.control, &|_| {})
            };
            self.toolchain.as_ref().map(build).transpose()
        };
        let connection = match request.port {
            Some(path) => Connection::on_port(path, request.baud.unwrap_or(request.board.baud_rate()), image)?,
            None => {
                let image = image()?.ok_or_else(|| Failure::new("the emulated board needs an image"))?;
                Connection::in_emulator(&self.version, image)?
            }
        };
        let expected = self.expected(pair, connection.image.as_ref())?;
        let sha256 = connection.image.map(|image| image.sha256).unwrap_or_default();
        let mut session = Session::new(connection.line, connection.supervisor);
        session.connect(&expected, connection.timeout)?;
        session.reset(self.settings(pair.control.rate))?;
        Ok((session, sha256))
    }

    fn expected(&self, pair: &RunJoints, image: Option<&Image>) -> Outcome<Expected> {
        let RunJoints { nominal, truth, control, .. } = pair;
        let request = control.request();
        let board = self.request.board;
        let nominal = NominalPlant { joint: &nominal.parameters, surroundings: &nominal.surroundings, request };
        let source = control_source(&truth.parameters, &truth.surroundings, &nominal, &board.processor())
            .map_err(|error| Failure::new(format!("joint `{}`: {error}", truth.parameters.name)))?;
        let probe = &board.description.probe_name;
        Ok(Expected {
            joint: truth.parameters.name.to_string(),
            digest: tables_digest(&truth.parameters, board.chip(), control.rate)?,
            tick_rate: control.rate,
            planets: truth.parameters.geometry.planets,
            role: self.request.role,
            control_digest: Some(source.digest),
            help: match (image, self.request.port) {
                (_, None) => BoardHelp::Rebuild,
                (Some(Image { elf, .. }), Some(_)) => {
                    let elf = elf.display();
                    BoardHelp::FlashBuilt(format!(
                        "probe-rs download --chip {probe} {elf} && probe-rs reset --chip {probe}"
                    ))
                }
                (None, Some(_)) => BoardHelp::Flash("run without --no-build, which builds and names it".to_owned()),
            },
        })
    }

    fn settings(&self, rate: u32) -> RunSettings {
        let role = self.request.role;
        let real = self.request.port.is_some();
        let usual = if real && role == Role::Loop { RunMode::Realtime } else { RunMode::Lockstep };
        let mode = self.request.mode.unwrap_or(usual);
        let command_timeout = command_timeout(rate, !real);
        let decimation = if role == Role::Loop { DECIMATION } else { 1 };
        RunSettings { mode, decimation, command_timeout, from_memory: false }
    }

    fn board_run(&self, image: String, same_periods: u32, statistics: Option<&Statistics>) -> BoardRun {
        let figure = |of: &dyn Fn(&Statistics) -> u32| statistics.map_or(0, of);
        BoardRun {
            role: role_name(self.request.role).to_owned(),
            elf_sha256: image,
            same_periods,
            computation_mean: figure(&|statistics| statistics.computation.mean),
            computation_most: figure(&|statistics| statistics.computation.max),
            period_counts: figure(&|statistics| statistics.period),
            overruns: figure(&|statistics| statistics.overruns),
            stack_bytes: figure(&|statistics| statistics.stack_used),
        }
    }
}

#[cfg(test)]
mod tests {
    use model_core::controller::ControllerDesign;

    use super::*;
    use crate::file;

    /// Seen to fail for `peak_torque_N_m` while the image did not get it.
    #[test]
    fn image_and_twin_tables_agree() {
        let text = joint_file::preset("q1").expect("a preset");
        let tables = |keys: &str| {
            let test = file::read(&format!("profile = \"T2\"\n[controller]\n{keys}")).expect("a good file");
            let mut case = Case::new(&test, text, 1, None).expect("a case");
            case.round_nominal().expect("a joint file");
            let designed = case.design(&test).expect("a controller");
            let nominal = NominalPlant {
                joint: &case.nominal,
                surroundings: &case.nominal_surroundings,
                request: control(&test, &case).expect("a bandwidth").request(),
            };
            let image = ControllerDesign::for_plant(&nominal).expect("a controller");
            assert_eq!(format!("{:?}", image.compensation), format!("{:?}", designed.compensation), "{keys}");
            assert_eq!(format!("{:?}", image.observer), format!("{:?}", designed.observer), "{keys}");
            format!("{:?}{:?}", image.compensation, image.observer)
        };
        let usual = tables("");
        for keys in ["peak_torque_N_m = 3.0", "bandwidth_rad_per_s = 40", "output_encoder = false"] {
            assert_ne!(tables(keys), usual, "{keys} does nothing");
        }
    }
}
