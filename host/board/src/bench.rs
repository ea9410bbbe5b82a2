//! What a run needs besides its plan: the image, and a line to a board, emulated or real.

use std::time::{Duration, Instant};

use super::session::{SILENCE, Surroundings};
use super::transport::{Line, Port, Socket};
use crate::target::board::Board;
use crate::target::emulator::{self, Emulator};
use crate::target::image::Image;
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;

/// The emulator needs this long to boot on a busy machine; if it ends meanwhile, that is noticed at once.
const BOOT: Duration = Duration::from_secs(10);
/// A process that has closed its line needs a moment to end.
const LAST_BREATH: Duration = Duration::from_millis(500);

/// A board on a line.
pub struct Bench {
    /// The line.
    pub line: Box<dyn Line>,
    /// What the session asks about its surroundings; owns the emulator.
    pub surroundings: Box<dyn Surroundings>,
    /// Longest wait for the board's first word.
    pub patience: Duration,
    /// The emulator's version, or the port.
    pub transport: String,
    /// The image, if it was built here.
    pub image: Option<Image>,
}

impl Bench {
    /// The board behind a port, which is opened before its image is built.
    pub fn on_port(path: &str, baud: u32, image: impl FnOnce() -> Outcome<Option<Image>>) -> Outcome<Self> {
        let port = Port::open(path, baud)?;
        Ok(Self {
            line: Box::new(port),
            surroundings: Box::new(RealBoard),
            patience: SILENCE,
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
            surroundings: Box::new(EmulatedBoard(emulator)),
            patience: BOOT,
            transport: format!("{version}, -M {}, -icount {}", emulator::MACHINE, emulator::CLOCK),
            image: Some(image),
        })
    }

    /// The emulated board with an image that is built for it once the emulator is there.
    pub fn emulated(progress: &Progress, build: impl FnOnce(Board) -> Outcome<Image>) -> Outcome<Self> {
        progress.stage("finding the emulator");
        let version = emulator::ensure(&|line| progress.say(line))?;
        let image = build(Board::Stm32f405)?;
        progress.stage("booting the emulated board");
        Self::in_emulator(&version, image)
    }
}

/// Nothing is known about a real board but what it says.
struct RealBoard;

impl Surroundings for RealBoard {
    fn interrupted(&self) -> bool {
        interruption::requested()
    }
}

/// The emulator, which is killed with its owner.
struct EmulatedBoard(Emulator);

impl Surroundings for EmulatedBoard {
    fn interrupted(&self) -> bool {
        interruption::requested()
    }

    fn gone(&mut self) -> Option<String> {
        let deadline = Instant::now() + LAST_BREATH;
        while Instant::now() < deadline {
            if let Err(failure) = self.0.check() {
                return Some(failure.message().to_owned());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        None
    }
}
