//! A connection to a board, emulated or real: the serial line, who watches over it (Ctrl-C, the emulator's process),
//! the timeout of the first answer, and the firmware image if it was built here.

use std::time::{Duration, Instant};

use super::session::{ANSWER_TIMEOUT, Supervisor};
use super::transport::{Line, Port, Socket};
use crate::device::board::Board;
use crate::device::emulator::{self, Emulator};
use crate::device::image::Image;
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;

/// The emulator needs this long to boot on a busy machine; if it ends meanwhile, that is noticed at once.
const BOOT_TIMEOUT: Duration = Duration::from_secs(10);
/// A process that has closed its line needs a moment to end.
const EXIT_TIMEOUT: Duration = Duration::from_millis(500);

/// A connection to a board.
pub struct Connection {
    /// The line.
    pub line: Box<dyn Line>,
    /// Polled by the session while it waits; owns the emulator.
    pub supervisor: Box<dyn Supervisor>,
    /// Longest wait for the board's first message.
    pub timeout: Duration,
    /// The emulator's version, or the port.
    pub transport: String,
    /// The image, if it was built here.
    pub image: Option<Image>,
}

impl Connection {
    /// The board behind a port, which is opened before its image is built.
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

    /// The emulator of a version with an image.
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

    /// The emulated board with an image that is built for it once the emulator is there.
    pub fn emulated(progress: &Progress, build: impl FnOnce(&Board) -> Outcome<Image>) -> Outcome<Self> {
        progress.stage("finding the emulator");
        let version = emulator::ensure(&|line| progress.print_message(line))?;
        let image = build(&Board::emulated())?;
        progress.stage("booting the emulated board");
        Self::in_emulator(&version, image)
    }
}

/// A real board: whether it is gone is known only from the line.
struct RealBoard;

impl Supervisor for RealBoard {
    fn interrupted(&self) -> bool {
        interruption::requested()
    }
}

/// The emulator, which is killed with its owner.
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
