//! SPI slave: a good transfer is answered in the next one, also after every kind of bad transfer.

use firmware::port::spi::FRAME_BYTES as FRAME;
use link::controller::{Answered, Exchange, Motion, SetPoint};
use link::framing::{sealed, unsealed};

use super::clean;
use crate::boards::{Subject, pin};
use crate::cpu::Board;
use crate::talk::Talk;
use crate::wires::{MICROSECOND, Pin, SECOND, Time};

/// Pause of the master between two transfers: a control period at 5 kHz, less the transfer.
const BETWEEN: Time = 120 * MICROSECOND;
/// Time of a byte at 21 MHz.
const BYTE: Time = SECOND / 21_000_000 * 8;

/// SPI master in front of the slave.
struct Master<'a> {
    talk: Talk<'a>,
    select: Pin,
    spi: u32,
    tick: u32,
}

impl Master<'_> {
    /// Transfers bytes and returns the received ones.
    fn transfer(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.select(false);
        self.talk.hear(2 * MICROSECOND);
        let start = self.talk.board.borrow().now();
        {
            let mut board = self.talk.board.borrow_mut();
            let machine = board.machine_mut();
            let master = &mut machine.wires.master;
            (master.spi, master.byte) = (self.spi, BYTE);
            master.to_slave = bytes.iter().copied().collect();
            master.received.clear();
            master.next = (!bytes.is_empty()).then_some(start + BYTE);
            machine.attention = true;
        }
        self.talk.hear(BYTE * (bytes.len() as Time + 2));
        self.select(true);
        self.talk.hear(BETWEEN);
        std::mem::take(&mut self.talk.board.borrow_mut().machine_mut().wires.master.received)
    }

    fn select(&mut self, level: bool) {
        let mut board = self.talk.board.borrow_mut();
        board.machine_mut().wires.driven.insert(self.select, level);
        board.machine_mut().attention = true;
    }

    /// Valid frame with the next tick.
    fn good(&mut self) -> [u8; FRAME] {
        let point = Motion { position: (0, 0.0), speed: 0.0, acceleration: 0.0 };
        let exchange = Exchange {
            tick: self.tick,
            time: self.tick.wrapping_mul(200),
            motor: (100 + self.tick, self.tick.wrapping_mul(200)),
            output: Some((1000, self.tick.wrapping_mul(200))),
            torque: 0.0,
            set_point: SetPoint::Position { now: point, ahead: None },
            wants_estimates: true,
        };
        self.tick += 1;
        let mut frame = [0; FRAME];
        // Sealing cannot fail: the firmware's tests check that the longest exchange fits a frame.
        let _ = sealed(&exchange, &mut frame);
        frame
    }

    /// Makes two good transfers; the second must carry the answer to the first.
    fn is_answered(&mut self) -> Result<(), String> {
        let frame = self.good();
        self.transfer(&frame);
        let asked = self.tick;
        let frame = self.good();
        let back = self.transfer(&frame);
        let answered: Option<Answered> = unsealed(&back);
        match answered {
            Some(answered) if answered.tick == asked => Ok(()),
            Some(answered) => Err(format!("the answer to tick {asked} is that to {}", answered.tick)),
            None => Err(format!(
                "no answer to tick {asked}: {} bytes came, {:02x?}...",
                back.len(),
                &back[..back.len().min(8)]
            )),
        }
    }
}

fn master<'a>(subject: &Subject, board: Board<'a>) -> Result<Master<'a>, String> {
    let talk = Talk::new(board);
    let slave = subject.board.description.spi_slave.as_ref().ok_or("the board is no slave")?;
    let select = pin(slave.select.pin);
    let spi = slave.unit.trim_start_matches("SPI").parse().map_err(|_| format!("unit {}", slave.unit))?;
    let mut master = Master { talk, select, spi, tick: 0 };
    master.select(true);
    master.talk.hear(20_000 * MICROSECOND);
    Ok(master)
}

/// A started board answers transfers.
pub fn serves(subject: &Subject, board: Board<'_>) -> Result<String, String> {
    let mut master = master(subject, board)?;
    let outcome = (0..3).try_for_each(|_| master.is_answered());
    clean(&master.talk.board.borrow())?;
    outcome?;
    Ok("3 transfers answered".into())
}

/// Good transfers with all kinds of bad ones between them.
pub fn transfers(subject: &Subject) -> Result<String, String> {
    let mut master = master(subject, subject.start()?)?;
    for _ in 0..20 {
        let outcome = master.is_answered();
        clean(&master.talk.board.borrow())?;
        outcome?;
    }
    let mut bad = 0;
    for length in [0, 1, 2, 3, 4, 5, 100, FRAME - 2, FRAME - 1] {
        let frame = master.good();
        master.transfer(&frame[..length]);
        bad += 1;
        master.is_answered().map_err(|why| format!("after a transfer of {length} bytes: {why}"))?;
    }
    for place in [0, 100, FRAME - 1] {
        let mut frame = master.good();
        frame[place] ^= 0x10;
        master.transfer(&frame);
        let next = master.good();
        let back = master.transfer(&next);
        if unsealed::<Answered>(&back).is_some() {
            return Err(format!("a frame that is damaged at byte {place} is answered"));
        }
        bad += 1;
        master.is_answered().map_err(|why| format!("after a damaged frame: {why}"))?;
    }
    clean(&master.talk.board.borrow())?;
    Ok(format!("20 good ones and {bad} bad ones, each answered by the next good one"))
}

/// Transfers that are too long by any number of bytes are rejected.
pub fn too_long(subject: &Subject) -> Result<String, String> {
    let mut master = master(subject, subject.start()?)?;
    master.is_answered()?;
    let extra = [1, 2, 3, 4, 5, 8, 100, FRAME, 1000];
    let mut taken = Vec::new();
    for more in extra {
        let frame = master.good();
        let long: Vec<u8> = frame.iter().copied().chain((0..more).map(|byte| byte as u8)).collect();
        master.transfer(&long);
        let next = master.good();
        let back = master.transfer(&next);
        if unsealed::<Answered>(&back).is_some() {
            taken.push(more);
        }
        master.is_answered().map_err(|why| format!("after a transfer {more} bytes too long: {why}"))?;
    }
    clean(&master.talk.board.borrow())?;
    match taken.is_empty() {
        true => Ok(format!("{} lengths", extra.len())),
        false => Err(format!("transfers that are too long by {taken:?} bytes are taken as good")),
    }
}
