//! A board in a thread: the firmware's test board behind any byte stream, with line faults on demand. The thread is its
//! clock.

#[path = "../../../../firmware/tests/test_board/mod.rs"]
mod test_board;

use std::io::{ErrorKind, Read, Write};
use std::sync::atomic::Ordering::Relaxed;
use std::thread::JoinHandle;

use firmware::observer::Observing;
use firmware::port::Direct;
use firmware::protocol::Protocol;
use firmware::work::Work;
use link::framing::{Receiver, encode};
use link::messages::{FromBoard, ToBoard, Trip};
use model_core::controller::Controller;
use parameters::JointParameters;
pub use test_board::Flash;
use test_board::TestBoard;

/// Step rate [Hz].
pub const TICK_RATE: u32 = 20_000;

/// Most ticks between two reads of the line.
const TICKS: u32 = 200;

/// Most ticks between two messages of the host: half of the timeout on a real line.
const TICKS_UNHEARD: u32 = TICK_RATE / 20;

/// Fault of the board or of its line.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Misbehaviour {
    /// No fault.
    #[default]
    None,
    /// Hangs up at a tick.
    HangsUpAt(u32),
    /// Sends nothing more from a tick on, but keeps the line open.
    FallsSilentAt(u32),
    /// Sends garbage before its first message, and half a frame at a tick.
    HalfFrameAt(u32),
    /// Sends only random bytes.
    OnlyGarbage,
    /// Receives messages but sends nothing.
    Mute,
    /// Reports this protocol version.
    Protocol(u16),
    /// Reports a role that the host does not know.
    AnotherRole,
    /// Reports another digest.
    AnotherDigest,
    /// Drops the batch with this number.
    LosesBatch(u16),
    /// Applies every torque a tick late.
    LateTorques,
    /// Reports a fault at a tick.
    TripAt(u32, Trip),
    /// Ignores the schedule with this number.
    LosesSchedule(u16),
    /// Reports overruns.
    Overruns(u32),
}

/// Joint of the board's image.
pub fn joint() -> JointParameters {
    joint_file::read(joint_file::preset("q1").expect("the default preset")).expect("a good preset").parameters
}

/// Starts a board that simulates the joint on a stream with a short read timeout; the board ends with the stream.
pub fn start<S: Read + Write + Send + 'static>(stream: S, misbehaviour: Misbehaviour) -> JoinHandle<()> {
    std::thread::spawn(move || {
        // The board ends with the line.
        let _ = serve(stream, TestBoard::new(), misbehaviour);
    })
}

/// Starts a board with an observer on a stream, with the given flash.
pub fn start_observer<S: Read + Write + Send + 'static>(
    stream: S,
    controller: impl FnOnce() -> Controller<'static, f32> + Send + 'static,
    flash: Flash,
) {
    std::thread::spawn(move || {
        let mut work = Observing::new(Direct(controller()), true);
        // A bad memory is ignored.
        let _ = flash.kept().map(|memory| work.remember(&memory));
        let _ = serve(stream, TestBoard::with_flash(work, flash), Misbehaviour::None);
    });
}

/// Error: the line is closed, or the board hangs up.
struct Gone;

/// Runs a board on a stream. The board's clock waits for the host, which may be slow, so that no run is starved.
fn serve<W: Work>(
    mut stream: impl Read + Write,
    mut board: TestBoard<W>,
    mut misbehaviour: Misbehaviour,
) -> Result<(), Gone>
where
    W::Protocol: Protocol<Command: 'static, Sample: 'static> + 'static,
{
    let (mut receiver, mut scheduled, mut buffer) = (Receiver::new(), false, [0; 512]);
    let mut unheard = 0;
    if matches!(misbehaviour, Misbehaviour::HalfFrameAt(_)) {
        stream.write_all(&[0x55, 0xaa, 0x01, 0x00, 0x13, 0x37]).map_err(|_| Gone)?;
    }
    loop {
        let count = match stream.read(&mut buffer) {
            Ok(0) => return Err(Gone),
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(_) => return Err(Gone),
        };
        for message in buffer[..count].iter().filter_map(|&byte| receiver.push::<ToBoard>(byte)) {
            scheduled = matches!(message, ToBoard::Schedule(_));
            unheard = 0;
            if misbehaviour.changes_received() {
                misbehaviour.received(message).iter().for_each(|message| board.send(message));
            }
        }
        if !misbehaviour.changes_received() {
            board.send_bytes(&buffer[..count]);
        }
        board.settle();
        let left = board.progress.horizon.load(Relaxed).saturating_sub(board.progress.steps.load(Relaxed));
        let ticks = if scheduled { left.min(TICKS) } else { TICKS }.min(TICKS_UNHEARD - unheard);
        board.run(ticks);
        unheard += ticks;
        for message in board.said() {
            stream.write_all(&misbehaviour.sent(message)?).map_err(|_| Gone)?;
        }
    }
}

impl Misbehaviour {
    /// Returns true if messages are decoded and changed on the way to the board; otherwise the bytes pass unchanged.
    fn changes_received(&self) -> bool {
        matches!(self, Self::LosesSchedule(_) | Self::LateTorques)
    }

    /// Message that reaches the board, if any.
    fn received(&self, message: ToBoard) -> Option<ToBoard> {
        match (self, message) {
            (Self::LosesSchedule(number), ToBoard::Schedule(schedule)) if schedule.sequence == *number => None,
            (Self::LateTorques, ToBoard::Schedule(mut schedule)) => {
                schedule.commands.iter_mut().for_each(|command| command.tick += 1);
                Some(ToBoard::Schedule(schedule))
            }
            (_, message) => Some(message),
        }
    }

    /// Bytes on the line for a message of the board.
    fn sent(&mut self, mut message: FromBoard) -> Result<Vec<u8>, Gone> {
        let sampled = match &message {
            FromBoard::Samples(batch) => batch.samples.last().map(|sample| sample.tick),
            _ => None,
        };
        let reached = |tick: u32| sampled.is_some_and(|sampled| sampled >= tick);
        let mut bytes = Vec::new();
        match self.clone() {
            Self::HangsUpAt(tick) if reached(tick) => return Err(Gone),
            Self::FallsSilentAt(tick) if reached(tick) => *self = Self::Mute,
            Self::HalfFrameAt(tick) if reached(tick) => {
                let frame = frame(&FromBoard::Tripped(Trip::BadDigest))?;
                bytes.extend(&frame[..frame.len() / 2]);
                bytes.push(0);
                *self = Self::None;
            }
            Self::TripAt(tick, trip) if reached(tick) => {
                bytes.extend(frame(&FromBoard::Tripped(trip))?);
                *self = Self::None;
            }
            _ => {}
        }
        match (&*self, &mut message) {
            (Self::Mute, _) => return Ok(Vec::new()),
            (Self::OnlyGarbage, _) => return Ok(vec![0xa5, 0x5a, 0x11, 0x00, 0x22]),
            (Self::LosesBatch(number), FromBoard::Samples(batch)) if batch.sequence == *number => {
                return Ok(Vec::new());
            }
            (Self::AnotherRole, FromBoard::Hello(_)) => {
                return frame(&(0u32, link::PROTOCOL_VERSION, [0u8, 1, 0], 9u32, "cook", 0u64));
            }
            (Self::AnotherDigest, FromBoard::Hello(hello)) => hello.joint_digest = !hello.joint_digest,
            (Self::Protocol(version), FromBoard::Hello(hello)) => hello.protocol = *version,
            (Self::Overruns(count), FromBoard::Statistics(statistics)) => statistics.overruns = *count,
            _ => {}
        }
        bytes.extend(frame(&message)?);
        Ok(bytes)
    }
}

fn frame<M: serde::Serialize>(message: &M) -> Result<Vec<u8>, Gone> {
    encode(message).map(|frame| frame.to_vec()).map_err(|_| Gone)
}
