//! Host end of a modelled board's line: bytes are exchanged in the board's own time, which advances only while the host
//! listens. Equal runs are equal in every byte.

use std::cell::RefCell;
use std::io;
use std::rc::Rc;

use board::session::Supervisor;
use board::transport::Line;
use link::PROTOCOL_VERSION;
use link::framing::{Receiver, encode};
use link::messages::{FromBoard, Hello, RunSettings, ToBoard};

use crate::cpu::Board;
use crate::wires::{MICROSECOND, SECOND, Time};

/// Time slice of the board while the host waits.
const SLICE: Time = 200 * MICROSECOND;

/// Board with several owners.
pub type Shared<'a> = Rc<RefCell<Board<'a>>>;

/// Conversation by single messages.
pub struct Talk<'a> {
    /// Board.
    pub board: Shared<'a>,
    receiver: Receiver,
}

impl<'a> Talk<'a> {
    /// Conversation with a board.
    pub fn new(board: Board<'a>) -> Self {
        Self { board: Rc::new(RefCell::new(board)), receiver: Receiver::new() }
    }

    /// Sends a message after a zero byte, which ends an incomplete frame.
    pub fn say(&self, message: &ToBoard) {
        let frame = encode(message).unwrap_or_default();
        self.say_bytes(&[0]);
        self.say_bytes(&frame);
    }

    /// Sends bytes.
    pub fn say_bytes(&self, bytes: &[u8]) {
        let mut board = self.board.borrow_mut();
        let machine = board.machine_mut();
        machine.wires.line.to_board.extend(bytes);
        machine.attention = true;
    }

    /// Runs the board for a time and returns its messages.
    pub fn hear(&mut self, duration: Time) -> Vec<FromBoard> {
        let mut board = self.board.borrow_mut();
        board.run_for(duration);
        let bytes = std::mem::take(&mut board.machine_mut().wires.line.to_host);
        bytes.into_iter().filter_map(|byte| self.receiver.push(byte)).collect()
    }

    /// Waits for a message that `pick` accepts.
    pub fn wait<T>(&mut self, limit: Time, mut pick: impl FnMut(FromBoard) -> Option<T>) -> Option<T> {
        let end = self.board.borrow().now() + limit;
        while self.board.borrow().now() < end && self.board.borrow().machine().halted.is_none() {
            for message in self.hear(SLICE) {
                if let Some(found) = pick(message) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// Sends a message and waits for its answer.
    pub fn ask<T>(&mut self, message: &ToBoard, limit: Time, pick: impl FnMut(FromBoard) -> Option<T>) -> Option<T> {
        self.say(message);
        self.wait(limit, pick)
    }

    /// Sends hello messages until the board answers.
    pub fn call(&mut self, limit: Time) -> Option<Hello> {
        let tries = limit.div_ceil(SECOND / 10);
        (0..tries).find_map(|_| {
            self.ask(&ToBoard::Hello { protocol: PROTOCOL_VERSION }, SECOND / 10, |message| match message {
                FromBoard::Hello(hello) => Some(hello),
                _ => None,
            })
        })
    }

    /// Requests a run.
    pub fn start_run(&mut self, settings: RunSettings) -> Result<(), String> {
        let granted = self.ask(&ToBoard::Reset(settings), SECOND, |message| match message {
            FromBoard::Hello(_) => Some(()),
            _ => None,
        });
        granted.ok_or_else(|| "a run is not granted".into())
    }

    /// Line for a host session.
    pub fn line(&self) -> ModelLine<'a> {
        ModelLine(Rc::clone(&self.board))
    }
}

/// Line in the form of the host's session.
pub struct ModelLine<'a>(Shared<'a>);

impl Line for ModelLine<'_> {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut board = self.0.borrow_mut();
        let machine = board.machine_mut();
        machine.wires.line.to_board.extend(bytes);
        machine.attention = true;
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut board = self.0.borrow_mut();
        if board.machine().halted.is_some() {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        for _ in 0..50 {
            board.run_for(SLICE);
            if !board.machine().wires.line.to_host.is_empty() {
                break;
            }
        }
        let said = &mut board.machine_mut().wires.line.to_host;
        let count = said.len().min(buffer.len());
        for (place, byte) in buffer.iter_mut().zip(said.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn name(&self) -> &str {
        "the modelled board"
    }
}

/// Supervisor without a user; only a signal interrupts it.
pub struct Unattended;

impl Supervisor for Unattended {
    fn interrupted(&self) -> bool {
        report::interruption::requested()
    }
}
