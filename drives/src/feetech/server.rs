//! Servo on the bus: instructions and their answers.

use heapless::Vec;

use super::Mode;
use super::packet::{BROADCAST, Instruction, MAX_PARAMETERS, Packet, Receiver};
use super::queue::{PING_SLOT, Queue, periods};
use super::servo::{MIDDLE, Servo};
use super::table;
use crate::bus::SerialServer;
use crate::drive::{Drive, Settings};

/// Time after which the bytes of a packet that does not end are dropped [s].
const PACKET_TIME: f32 = 0.02;
/// Time that a reboot takes [s].
const REBOOT_TIME: f32 = 0.8;
/// Most bytes of a read: more than the table has, less than a client takes for a broken packet.
const MAX_READ: u8 = 240;
/// Bit rates by their index [bit/s].
const BAUD_RATES: [u32; 8] = [1_000_000, 500_000, 250_000, 128_000, 115_200, 76_800, 57_600, 38_400];

/// Answer to an instruction.
enum Answer {
    /// No answer.
    Silence,
    /// Status without parameters, if the response level wants it.
    Acknowledge,
    /// Status with this number of bytes from this address on, whatever the response level.
    Data(u8, u8),
}

/// Servo on the bus.
#[derive(Debug, Clone)]
pub struct Server {
    servo: Servo,
    receiver: Receiver,
    queue: Queue,
    /// Write that waits for an action: address and bytes.
    registered: Option<(u8, Vec<u8, MAX_PARAMETERS>)>,
    /// Time since the last byte [control periods].
    idle: u32,
    /// Rest of a reboot [control periods].
    asleep: u32,
}

impl Server {
    /// Servo with an identifier, of 0 to 253, on the drive that has these settings.
    pub fn new(id: u8, settings: &Settings) -> Self {
        Self {
            servo: Servo::new(id, *settings),
            receiver: Receiver::default(),
            queue: Queue::default(),
            registered: None,
            idle: 0,
            asleep: 0,
        }
    }

    /// Identifier.
    pub fn id(&self) -> u8 {
        self.servo.memory.get(&table::ID) as u8
    }

    /// Bit rate that a client set [bit/s].
    pub fn baud_rate(&self) -> u32 {
        let index = self.servo.memory.get(&table::BAUD).unsigned_abs() as usize;
        BAUD_RATES.get(index).copied().unwrap_or(1_000_000)
    }

    /// Mode.
    pub fn mode(&self) -> Mode {
        self.servo.mode()
    }

    /// Error bits, see [`super::error`].
    pub fn status(&self) -> u8 {
        self.servo.protection.status()
    }

    /// Executes an instruction for this servo.
    fn execute(&mut self, packet: &Packet, drive: &mut Drive) -> Answer {
        match (Instruction::decode(packet.code), packet.parameters()) {
            (Some(Instruction::Ping), _) => return Answer::Data(0, 0),
            (Some(Instruction::Read), &[address, length]) if length <= MAX_READ => {
                return Answer::Data(address, length);
            }
            (Some(Instruction::Write), &[address, ref data @ ..]) => self.servo.write(address, data, drive),
            (Some(Instruction::RegisterWrite), &[address, ref data @ ..]) => {
                self.registered = Vec::from_slice(data).ok().map(|data| (address, data));
            }
            (Some(Instruction::Action), _) => {
                if let Some((address, data)) = self.registered.take() {
                    self.servo.write(address, &data, drive);
                }
            }
            (Some(Instruction::Recovery), _) => {
                self.servo.memory.recover();
                self.servo.configure(drive);
            }
            (Some(Instruction::Reboot), _) => {
                self.reboot(drive);
                return Answer::Silence;
            }
            (Some(Instruction::Backup), _) => self.servo.memory.back_up(),
            (Some(Instruction::Reset), _) => self.servo.reset_turns(drive),
            (Some(Instruction::Calibrate), []) => self.servo.calibrate(MIDDLE, drive),
            (Some(Instruction::Calibrate), &[low, high]) => {
                self.servo.calibrate(u16::from_le_bytes([low, high]).into(), drive);
            }
            _ => return Answer::Silence,
        }
        let is_registered = self.registered.is_some();
        self.servo.memory.set(&table::REGISTERED, is_registered.into());
        Answer::Acknowledge
    }

    /// Executes an instruction for every servo.
    fn execute_broadcast(&mut self, packet: &Packet, drive: &mut Drive, send: &mut dyn FnMut(&[u8])) {
        let id = self.id();
        match (Instruction::decode(packet.code), packet.parameters()) {
            (Some(Instruction::Ping), _) => {
                let wait = periods(PING_SLOT * f32::from(id), drive.settings().period);
                self.answer(id, &[], wait, send);
            }
            (Some(Instruction::SyncRead), &[address, length, ref ids @ ..]) if length <= MAX_READ => {
                match ids.iter().position(|other| *other == id) {
                    Some(0) => self.answer_read(id, address, length, drive, send),
                    Some(place) => self.queue.wait(ids.get(..place).unwrap_or_default(), address, length),
                    None => {}
                }
            }
            (Some(Instruction::SyncWrite), &[address, length, ref blocks @ ..]) => {
                let mut blocks = blocks.chunks_exact(usize::from(length) + 1);
                if let Some([_, data @ ..]) = blocks.find(|block| block.first() == Some(&id)) {
                    self.servo.write(address, data, drive);
                }
            }
            _ => {
                self.execute(packet, drive);
            }
        }
    }

    /// Answers with the bytes from an address on, after the return delay.
    fn answer_read(&mut self, id: u8, address: u8, length: u8, drive: &Drive, send: &mut dyn FnMut(&[u8])) {
        self.servo.publish(drive);
        let content: Vec<u8, MAX_PARAMETERS> = self.servo.memory.read(address, length).collect();
        let delay = periods(self.servo.memory.quantity(&table::RETURN_DELAY), drive.settings().period);
        self.answer(id, &content, delay, send);
    }

    /// Sends a status packet after a delay [control periods].
    fn answer(&mut self, id: u8, content: &[u8], delay: u32, send: &mut dyn FnMut(&[u8])) {
        let Some(packet) = Packet::new(id, self.status(), content) else { return };
        if delay == 0 {
            send(&packet.to_bytes());
        } else {
            self.queue.delay(packet.to_bytes(), delay);
        }
    }

    fn reboot(&mut self, drive: &mut Drive) {
        self.servo.restart(drive);
        self.registered = None;
        self.asleep = periods(REBOOT_TIME, drive.settings().period);
    }

    fn handle(&mut self, packet: &Packet, drive: &mut Drive, send: &mut dyn FnMut(&[u8])) {
        let id = self.id();
        if packet.id != id && packet.id != BROADCAST {
            if let Some((address, length)) = self.queue.note(packet) {
                self.answer_read(self.id(), address, length, drive, send);
            }
            return;
        }
        self.queue.clear();
        if packet.id == BROADCAST {
            self.execute_broadcast(packet, drive, send);
            return;
        }
        // A servo whose identifier was just changed answers under the old one.
        match self.execute(packet, drive) {
            Answer::Data(address, length) => self.answer_read(id, address, length, drive, send),
            Answer::Acknowledge if self.servo.memory.get(&table::STATUS_LEVEL) != 0 => {
                self.answer_read(id, 0, 0, drive, send);
            }
            Answer::Acknowledge | Answer::Silence => {}
        }
    }
}

impl SerialServer for Server {
    fn receive(&mut self, byte: u8, drive: &mut Drive, send: &mut dyn FnMut(&[u8])) {
        if self.asleep > 0 {
            return;
        }
        self.idle = 0;
        self.queue.hear();
        if let Some(packet) = self.receiver.receive(byte) {
            self.handle(&packet, drive, send);
        }
    }

    fn tick(&mut self, drive: &mut Drive, send: &mut dyn FnMut(&[u8])) {
        self.servo.tick(drive);
        self.asleep = self.asleep.saturating_sub(1);
        let period = drive.settings().period;
        self.idle = self.idle.saturating_add(1);
        if self.idle >= periods(PACKET_TIME, period) {
            self.receiver.reset();
        }
        if let Some((address, length)) = self.queue.tick(period) {
            self.answer_read(self.id(), address, length, drive, send);
        } else if let Some(bytes) = self.queue.due() {
            send(&bytes);
        }
    }
}
