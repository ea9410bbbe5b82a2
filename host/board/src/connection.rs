//! Connection to an emulated or real board: the serial line, its supervisor (Ctrl-C, the emulator's process), the
//! timeout of the first answer, and the firmware image if it was built here.

use std::time::{Duration, Instant};

use super::session::{ANSWER_TIMEOUT, Supervisor};
use super::transport::{Line, Port, Socket};
use crate::device::board::Board;
use crate::device::emulator::{self, Emulator};
use crate::device::image::Image;
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;

/// Longest boot of the emulator on a busy machine; a process that ends earlier is reported at once.
const BOOT_TIMEOUT: Duration = Duration::from_secs(10);
/// Longest time from the emulator closing its line to the end of its process.
const EXIT_TIMEOUT: Duration = Duration::from_millis(500);

/// Open connection to a board.
pub struct Connection {
    /// Serial line.
    pub line: Box<dyn Line>,
    /// Supervisor polled by the session while it waits; owns the emulator.
    pub supervisor: Box<dyn Supervisor>,
    /// Longest wait for the board's first message.
    pub timeout: Duration,
    /// Version and machine of the emulator, or port and speed.
    pub transport: String,
    /// Image, if it was built here.
    pub image: Option<Image>,
}

impl Connection {
    /// Connects to the board behind a port. The port is opened before the image is built.
    pub fn on_port(path: &str, baud: u32, image: impl FnOnce() -> Outcome<Option<Image>>) -> Outcome<Self> {
        let port = Port::open(path, baud)?;
        Ok(Self {
            line: Box::new(port),
            supervisor: Box::new(RealBoard),
            timeout: ANSWER_TIMEOUT,
            transport: format!("{path} at {baud} baud"),
            image: image()?,
        })
    }

    /// Starts the emulator with an image; `version` goes into `transport`.
    pub fn in_emulator(version: &str, image: Image) -> Outcome<Self> {
        let (emulator, stream) = Emulator::start(&image.elf)?;
        let line = Socket::new(stream, "the emulated board")
            .map_err(|error| Failure::new(format!("the emulator's serial line cannot be used: {error}")))?;
        Ok(Self {
            line: Box::new(line),
            supervisor: Box::new(EmulatedBoard(emulator)),
            timeout: BOOT_TIMEOUT,
            transport: format!("{version}, -M {}, -icount {}", emulator::MACHINE, emulator::CLOCK),
            image: Some(image),
        })
    }

    /// Finds the emulator, builds the image for it and starts it.
    pub fn emulated(progress: &Progress, build: impl FnOnce(&Board) -> Outcome<Image>) -> Outcome<Self> {
        progress.stage("finding the emulator");
        let version = emulator::ensure(&|line| progress.print_message(line))?;
        let image = build(&Board::emulated())?;
        progress.stage("booting the emulated board");
        Self::in_emulator(&version, image)
    }
}

/// Supervisor of a real board, whose loss only the line shows.
struct RealBoard;

impl Supervisor for RealBoard {
    fn interrupted(&self) -> bool {
        interruption::requested()
    }
}

/// Supervisor of the emulated board; dropping it kills the emulator.
struct EmulatedBoard(Emulator);

impl Supervisor for EmulatedBoard {
    fn interrupted(&self) -> bool {
        interruption::requested()
    }

    fn gone(&mut self) -> Option<String> {
        let deadline = Instant::now() + EXIT_TIMEOUT;
        while Instant::now() < deadline {
            if let Err(failure) = self.0.check() {
                return Some(failure.message().to_owned());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        None
    }
}
