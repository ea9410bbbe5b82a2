//! Drive on CAN: an image answers as its twin on this host in every frame, hears a stop on a full bus, and comes back
//! from bus-off.

use board::device::board::Board as Described;
use board::device::image::{DriveOnBus, default_drive_rate};
use drives::Frame;
use drives::frame::standard;

use super::can_client::{Client, Mode, Order};
use super::{clean, load};
use crate::boards::{Subject, USUAL_COST, usual_surroundings};
use crate::can_bus::CanBus;
use crate::can_twin::DriveOf;
use crate::cpu::Board;
use crate::images::{JOINT, canopen_drive, drive_of};
use crate::wires::{MICROSECOND, Time};

/// Millisecond.
const MILLISECOND: Time = 1000 * MICROSECOND;
/// Time after which a client of either kind knows the mode.
const UNTIL_KNOWN: Time = 120 * MILLISECOND;

/// Session with a board.
struct Session<'a> {
    board: Board<'a>,
    client: Client,
    /// Frames that the client has read.
    read: usize,
}

impl Session<'_> {
    fn start(subject: &Subject) -> Result<Self, String> {
        Self::start_at(subject, USUAL_COST)
    }

    /// Starts a board with another cost of an instruction [thousandths of a cycle].
    fn start_at(subject: &Subject, cost: u64) -> Result<Self, String> {
        let client = Client::of(drive_of(&subject.board).ok_or("the board is no drive")?.maker);
        let board = subject.start_at(usual_surroundings(&subject.board), cost)?;
        let mut session = Self { board, client, read: 0 };
        session.run(20 * MILLISECOND)?;
        Ok(session)
    }

    fn bus(&mut self) -> &mut CanBus {
        &mut self.board.machine_mut().wires.can
    }

    /// Runs the board, which must not break a rule.
    fn run(&mut self, duration: Time) -> Result<(), String> {
        self.board.machine_mut().attention = true;
        self.board.run_for(duration);
        clean(&self.board)
    }

    fn order(&mut self, order: Order) {
        let frames = self.client.frames(order);
        self.bus().to_board.extend(frames);
    }

    /// Frames since the last call.
    fn heard(&mut self) -> Vec<Frame> {
        let read = self.read;
        let frames = self.bus().to_others[read..].to_vec();
        self.read += frames.len();
        frames
    }

    /// Mode that the drive reports.
    fn mode(&mut self, when: &str) -> Result<Mode, String> {
        self.heard();
        // The last part is short, since some drives stop without a command for 100 ms.
        self.run(UNTIL_KNOWN)?;
        self.asked_mode(when)
    }

    /// Mode that the drive reports at once, or reported since the last call.
    fn asked_mode(&mut self, when: &str) -> Result<Mode, String> {
        self.order(Order::Read);
        self.run(3 * MILLISECOND)?;
        let frames = self.heard();
        let mut modes = frames.iter().filter_map(|frame| self.client.mode(frame));
        modes.next_back().ok_or_else(|| format!("{when} none of {} frames has the mode", frames.len()))
    }

    fn expect(&mut self, expected: Mode, when: &str) -> Result<(), String> {
        match self.mode(when)? {
            found if found == expected => Ok(()),
            found => Err(format!("{when} the drive is {found:?}, not {expected:?}")),
        }
    }

    /// Moves for a number of steps of 2 ms, reading all the time.
    fn travel(&mut self, steps: u16) -> Result<(), String> {
        for step in 0..steps {
            self.order(Order::Move(step));
            self.order(Order::Read);
            // A frame of others is no affair of the drive.
            let foreign = self.client.foreign(step);
            self.bus().to_board.extend(foreign);
            self.run(2 * MILLISECOND)?;
        }
        Ok(())
    }

    /// Compares every frame so far with the twin's.
    fn compare(&mut self, subject: &Subject) -> Result<usize, String> {
        let drive = drive_of(&subject.board).ok_or("the board is no drive")?;
        compare(&self.board, subject, &drive)
    }

    fn lost_nothing(&mut self) -> Result<(), String> {
        let (overruns, taken) = (self.bus().overruns, self.bus().taken.len());
        if overruns > 0 { Err(format!("{overruns} frames beside {taken} were lost in the FIFO")) } else { Ok(()) }
    }
}

/// Compares every frame of a board with the twin's.
fn compare(board: &Board<'_>, subject: &Subject, drive: &DriveOnBus) -> Result<usize, String> {
    let mut joint =
        joint_file::read(joint_file::preset(JOINT).ok_or("no such joint")?).map_err(|_| "a broken preset")?;
    joint.surroundings.control_rate = default_drive_rate(&joint.parameters, &subject.board);
    let processor = subject.board.processor();
    let twin = DriveOf { maker: drive.maker.word, id: drive.id, joint: &joint, processor };
    let bus = &board.machine().wires.can;
    let in_order = bus.to_others.iter().zip(&bus.handed).all(|(sent, (_, handed))| sent == handed);
    if !in_order {
        return Err("the board sends frames in another order than the core hands them over".into());
    }
    twin.compare(bus)
}

/// A client enables the drive, moves it, reads, stops it and enables it again.
pub fn equals_twin(subject: &Subject) -> Result<String, String> {
    let mut session = Session::start(subject)?;
    session.expect(Mode::Off, "after power-up")?;
    session.order(Order::Enable);
    session.travel(75)?;
    if session.asked_mode("while it moves")? != Mode::On {
        return Err("the drive was not enabled".into());
    }
    session.order(Order::Stop);
    if session.mode("after the stop")? == Mode::On {
        return Err("the drive goes on after the stop".into());
    }
    session.order(Order::Clear);
    session.expect(Mode::Off, "after the errors were cleared")?;
    session.lost_nothing()?;
    let (count, ticks) = (session.compare(subject)?, session.bus().ticks);
    Ok(format!("{count} frames in {ticks} ticks, each the twin's"))
}

/// A bus that is full of foreign frames, beside ticks as long as counted, which fill the FIFO: nothing is lost, and a
/// stop is heard.
pub fn hears_in_a_flood(subject: &Subject) -> Result<String, String> {
    let mut session = Session::start_at(subject, load::cost(subject.board.chip()))?;
    session.order(Order::Enable);
    session.travel(60)?;
    if session.asked_mode("before the flood")? != Mode::On {
        return Err("the drive was not enabled".into());
    }
    let foreign: Vec<Frame> = (0..600).filter_map(|count| session.client.foreign(count)).collect();
    session.bus().to_board.extend(foreign);
    session.run(10 * MILLISECOND)?;
    let stop = session.client.frames(Order::Stop);
    session.bus().send_first(stop);
    session.run(40 * MILLISECOND)?;
    if session.mode("after the stop in the flood")? == Mode::On {
        return Err("the stop is not heard".into());
    }
    session.lost_nothing()?;
    let taken = session.bus().taken.len();
    session.compare(subject)?;
    Ok(format!("{taken} frames taken, none lost, and a stop among them"))
}

/// Nobody acknowledges; another node destroys frames until bus-off; the bus is held. Afterwards the drive answers.
pub fn recovers(subject: &Subject) -> Result<String, String> {
    let mut session = Session::start(subject)?;
    session.bus().acknowledges = false;
    session.order(Order::Read);
    session.run(30 * MILLISECOND)?;
    session.bus().acknowledges = true;
    session.expect(Mode::Off, "after a bus without another node")?;
    session.bus().destroys = 34;
    // Frames of the drive's own, or answers, until as many were destroyed as lead to bus-off.
    for _ in 0..40 {
        session.order(Order::Read);
        session.run(10 * MILLISECOND)?;
    }
    let left = session.bus().destroys;
    if left > 0 {
        return Err(format!("of 34 frames that were to be destroyed, {left} were never tried"));
    }
    session.expect(Mode::Off, "after bus-off")?;
    session.bus().is_held = true;
    session.run(20 * MILLISECOND)?;
    session.bus().is_held = false;
    session.expect(Mode::Off, "after a bus that was held")?;
    session.order(Order::Enable);
    session.travel(60)?;
    if session.asked_mode("at the end")? != Mode::On {
        return Err("the drive cannot be enabled at the end".into());
    }
    session.compare(subject)?;
    Ok(format!("{} ticks", session.bus().ticks))
}

/// Error code of CiA 402 for a controller that was off the bus, in an emergency frame of node 1.
const BUS_OFF: (u32, [u8; 2]) = (0x81, [0x40, 0x81]);

/// A drive on CANopen reports bus-off by one emergency frame, and every frame is the twin's.
pub fn reports_bus_off(subject: &Subject) -> Result<String, String> {
    let mut board = subject.start()?;
    let read = Frame::classic(standard(0x601), &[0x40, 0x00, 0x10, 0, 0, 0, 0, 0]).ok_or("no frame")?;
    let run = |board: &mut Board<'_>, reads: usize, destroys: u32| {
        board.machine_mut().wires.can.destroys = destroys;
        for _ in 0..reads {
            board.machine_mut().wires.can.to_board.push_back(read.clone());
            board.machine_mut().attention = true;
            board.run_for(10 * MILLISECOND);
            clean(board)?;
        }
        let bus = &board.machine().wires.can;
        let is_report = |frame: &&Frame| frame.raw_id() == BUS_OFF.0 && frame.data().starts_with(&BUS_OFF.1);
        Ok::<usize, String>(bus.to_others.iter().filter(is_report).count())
    };
    if run(&mut board, 20, 0)? > 0 {
        return Err("bus-off is reported on a bus without errors".into());
    }
    match run(&mut board, 20, 34)? {
        1 => {}
        count => return Err(format!("bus-off is reported {count} times")),
    }
    let drive = canopen_drive(&subject.board).ok_or("the board is no drive")?;
    let count = compare(&board, subject, &drive)?;
    Ok(format!("{count} frames, each the twin's, among them the report"))
}

/// Returns whether a board has an image of a drive.
pub fn is_for(board: &Described) -> bool {
    board.description.can_line().is_ok()
}
