//! Tests whose controller runs on a board: images for what each seed is told, a board for each run, and the same run here,
//! which must be the same in every bit. Rivals stay on the host, as always.
//!
//! `wish` is what was asked for, `runs` a run of each role: `observer` answers for observer and compensation through
//! `port`, the plant stays here; `loop` follows a `course` with everything on the board, and its figures are read off its
//! `twin`.

mod course;
mod faults;
mod port;
mod runs;
#[cfg(test)]
mod same_faults;
mod twin;
mod wish;

use joint_file::JointFile;
use link::messages::{Role, RunMode, RunSettings, Statistics};
use model_core::controller::design::{ControlRequest, NominalPlant, control_source};
pub use wish::BoardWish;
use wish::{can_be, may_run};

use super::case::Case;
use super::execution::Order;
use super::plant::PlantName;
use super::ran::Ran;
use super::record::BoardRun;
use super::rig::RunError;
use super::suite::{Suite, Test};
use board::bench::Bench;
use board::session::{Expected, Mend, Session};
use board::target::emulator;
use board::target::image;
use board::target::image::{Control, Image, word};
use board::target::toolchain::Toolchain;
use board::transport::Port;
use board::twin::tables_digest;
use report::failure::{Failure, Outcome};
use report::progress::Progress;

/// A sample of the whole loop every so many periods; the digest covers every period.
const DECIMATION: u16 = 100;
/// In real time a board without commands for so long goes to its safe state [s].
const COMMAND_TIMEOUT: f64 = 0.1;

/// Boards that can be built for and reached.
pub struct Boards<'w> {
    wish: BoardWish<'w>,
    toolchain: Option<Toolchain>,
    version: String,
}

/// What a run needs of its case.
struct Pair {
    texts: [String; 2],
    told: JointFile,
    truth: JointFile,
    control: Control,
}

impl<'w> Boards<'w> {
    /// Finds toolchain and emulator, so that what is missing is known before anything runs. Tests that no board can run
    /// are taken out.
    pub fn prepare(wish: BoardWish<'w>, suite: &mut Suite, plant: PlantName, progress: &Progress) -> Outcome<Self> {
        can_be(&wish, plant)?;
        suite.keep(|test| may_run(&wish, test))?;
        let say = |line: &str| progress.say(line);
        let version = match wish.port {
            // Opened and closed again: that it is not there should be known before an image is built.
            Some(path) => Port::open(path, wish.baud.unwrap_or(wish.board.baud_rate())).map(|_| String::new())?,
            None => {
                progress.stage("finding the emulator");
                emulator::ensure(&say)?
            }
        };
        let toolchain = if wish.no_build {
            None
        } else {
            progress.stage("preparing the toolchain");
            Some(Toolchain::prepare(&say)?)
        };
        progress.clear();
        Ok(Self { wish, toolchain, version })
    }

    /// Whether each run can have a board of its own.
    pub fn are_emulated(&self) -> bool {
        self.wish.port.is_none()
    }

    /// Where controllers run, for the record.
    pub fn label(&self) -> String {
        let place = self.wish.port.unwrap_or("emulated");
        format!("{} on {} ({place})", word(self.wish.role), self.wish.board.name())
    }

    /// The arguments that ask for them again.
    pub fn arguments(&self) -> String {
        let port = self.wish.port.map_or_else(String::new, |port| format!(" --port {port}"));
        format!("--role {}{port}", word(self.wish.role))
    }

    /// Tells the case's controllers what a joint file can say, to the last bit.
    pub fn tell(&self, case: &mut Case) -> Outcome<()> {
        let told = read(&case.told_text()?)?;
        case.tell(&told);
        Ok(())
    }

    /// Runs a case on a board and here; fails if they differ in any bit.
    pub fn run(&self, test: &Test, case: &Case, seed: u64, order: Order) -> Result<(Ran, BoardRun), RunError> {
        let pair = self.pair(test, case)?;
        match self.wish.role {
            Role::Loop => self.run_loop(test, case, seed, &pair),
            Role::Observer | Role::Plant => self.run_observer(test, case, seed, order, &pair),
        }
    }

    fn pair(&self, test: &Test, case: &Case) -> Outcome<Pair> {
        let told_text = case.told_text()?;
        // Where only the controller is on the board, its image knows no other joint.
        let truth_text = if self.wish.role == Role::Loop { case.truth_text().to_owned() } else { told_text.clone() };
        let rate = case.told_surroundings.control_rate;
        let (mut told, mut truth) = (read(&told_text)?, read(&truth_text)?);
        [&mut told, &mut truth].into_iter().for_each(|joint| joint.surroundings.control_rate = rate);
        let control = Control { rate, bandwidth: test.file.bandwidth, output_encoder: test.file.output_encoder };
        Ok(Pair { texts: [truth_text, told_text], told, truth, control })
    }

    /// Builds the image, finds the board and starts the run.
    fn session(&self, pair: &Pair) -> Outcome<(Session<'static>, String)> {
        let wish = &self.wish;
        let image = || {
            let build = |toolchain: &Toolchain| {
                let texts = pair.texts.each_ref().map(String::as_str);
                image::build_control_image(toolchain, texts, wish.board, wish.role, &pair.control, &|_| {})
            };
            self.toolchain.as_ref().map(build).transpose()
        };
        let bench = match wish.port {
            Some(path) => Bench::on_port(path, wish.baud.unwrap_or(wish.board.baud_rate()), image)?,
            None => {
                let image = image()?.ok_or_else(|| Failure::new("the emulated board needs an image"))?;
                Bench::in_emulator(&self.version, image)?
            }
        };
        let expected = self.expected(pair, bench.image.as_ref())?;
        let sha256 = bench.image.map(|image| image.sha256).unwrap_or_default();
        let mut session = Session::new(bench.line, bench.surroundings);
        session.connect(&expected, bench.patience)?;
        session.reset(self.settings(pair.control.rate))?;
        Ok((session, sha256))
    }

    fn expected(&self, pair: &Pair, image: Option<&Image>) -> Outcome<Expected> {
        let Pair { told, truth, control, .. } = pair;
        let request = ControlRequest { bandwidth: control.bandwidth, output_encoder: control.output_encoder };
        let board = self.wish.board;
        let told = NominalPlant { joint: &told.parameters, surroundings: &told.surroundings, request };
        let source = control_source(&truth.parameters, &truth.surroundings, &told, &board.processor())
            .map_err(|error| Failure::new(format!("joint `{}`: {error}", truth.parameters.name)))?;
        let chip = board.chip();
        Ok(Expected {
            joint: truth.parameters.name.to_string(),
            digest: tables_digest(&truth.parameters, board, control.rate)?,
            tick_rate: control.rate,
            planets: truth.parameters.geometry.planets,
            role: self.wish.role,
            control_digest: Some(source.digest),
            mend: match (image, self.wish.port) {
                (_, None) => Mend::Rebuild,
                (Some(Image { elf, .. }), Some(_)) => {
                    let elf = elf.display();
                    Mend::FlashBuilt(format!("probe-rs download --chip {chip} {elf} && probe-rs reset --chip {chip}"))
                }
                (None, Some(_)) => Mend::Flash("run without --no-build, which builds and names it".to_owned()),
            },
        })
    }

    fn settings(&self, rate: u32) -> RunSettings {
        let role = self.wish.role;
        let real = self.wish.port.is_some();
        let usual = if real && role == Role::Loop { RunMode::Realtime } else { RunMode::Lockstep };
        let mode = self.wish.mode.unwrap_or(usual);
        // The emulated clock runs as fast as it can while the board waits for the host.
        let timed = real || mode == RunMode::Realtime;
        let command_timeout = if timed { (COMMAND_TIMEOUT * f64::from(rate)).ceil() as u32 } else { u32::MAX };
        let decimation = if role == Role::Loop { DECIMATION } else { 1 };
        RunSettings { mode, decimation, command_timeout, from_memory: false }
    }

    fn board_run(&self, image: String, same_periods: u32, statistics: Option<&Statistics>) -> BoardRun {
        let figure = |of: &dyn Fn(&Statistics) -> u32| statistics.map_or(0, of);
        BoardRun {
            role: word(self.wish.role).to_owned(),
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

fn read(text: &str) -> Outcome<JointFile> {
    joint_file::read(text).map_err(|problems| {
        let first = problems.first().map_or_else(String::new, ToString::to_string);
        Failure::new(format!("the joint that a controller is told cannot be: {first}"))
    })
}
