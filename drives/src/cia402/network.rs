//! Network of the server: management, heartbeat, guarding, and monitoring of the master.

use super::dictionary::{self as object, Address, Direction, PDO_COUNT};
use super::nmt::{Monitor, Nmt, NmtCommand};
use super::state::State;
use super::{Server, fault, pdo, sdo};
use crate::drive::Drive;
use crate::frame::Send;

/// Time from power-up or reset to the boot-up frame [us]. A master that waits for the frame after its reset command must
/// have begun to wait.
const BOOT_TIME: u64 = 50_000;

impl Server {
    pub(super) fn manage(&mut self, data: &[u8], drive: &mut Drive) {
        let [code, node] = *data else { return };
        let Some(command) = NmtCommand::from_code(code).filter(|_| node == 0 || node == self.node) else { return };
        let is_break = !matches!(command, NmtCommand::Start | NmtCommand::EnterPreOperational);
        if is_break && self.nmt != Nmt::Initialising {
            self.abort_connection(fault::COMMUNICATION, drive);
        }
        match command {
            NmtCommand::Start => self.set_nmt(Nmt::Operational),
            NmtCommand::Stop => self.set_nmt(Nmt::Stopped),
            NmtCommand::EnterPreOperational => self.set_nmt(Nmt::PreOperational),
            NmtCommand::ResetNode => {
                drive.restart();
                self.restart();
            }
            NmtCommand::ResetCommunication => self.reset_communication(),
        }
    }

    pub(super) fn set_nmt(&mut self, nmt: Nmt) {
        if nmt == Nmt::Operational && self.nmt != nmt {
            self.receive = [pdo::Receive::NONE; PDO_COUNT];
            self.transmit = [pdo::Transmit::NONE; PDO_COUNT];
        }
        self.nmt = nmt;
    }

    /// Restarts the communication: parameters below 2000h are those after power-up.
    pub(super) fn reset_communication(&mut self) {
        self.set_initial_values(|entry| entry.address.index < 0x2000);
        (self.heartbeat, self.guarding) = (Monitor::NONE, Monitor::NONE);
        self.return_from_loss(true);
        self.transfer = sdo::Transfer::Idle;
        self.nmt = Nmt::Initialising;
        self.initialised_from = self.now;
    }

    pub(super) fn answer_remote(&mut self, id: u16, drive: &Drive, send: Send<'_>) {
        if id == 0x700 + u16::from(self.node) && self.stored(object::PRODUCER_HEARTBEAT) == 0 {
            let state = self.nmt as u8 | u8::from(self.toggle) << 7;
            self.toggle = !self.toggle;
            self.send(0x700, &[state], send);
            let was_lost = self.guarding.feed(self.now);
            self.return_from_loss(was_lost);
        }
        if self.nmt == Nmt::Operational {
            let number = (0..PDO_COUNT).find(|number| self.pdo_id(Direction::Transmit, *number) == Some(id));
            if number.is_some() {
                self.due_pdos(pdo::Trigger::Remote, number, drive).for_each(send);
            }
        }
    }

    /// Node and time [ms] of the monitored heartbeat.
    pub(super) fn consumer(&self) -> (u16, u32) {
        let consumer = self.stored(object::CONSUMER_HEARTBEAT);
        ((consumer >> 16) as u16, consumer & 0xFFFF)
    }

    pub(super) fn return_from_loss(&mut self, was_lost: bool) {
        if was_lost && self.state != State::Fault && core::mem::take(&mut self.is_alone) {
            self.clear_error();
        }
    }

    /// Reacts to a lost connection by 1029h:01 and 6007h, and reports it by an error code.
    pub(super) fn lose_connection(&mut self, code: u16, drive: &mut Drive) {
        self.is_alone = true;
        match self.stored(object::COMMUNICATION_ERROR_BEHAVIOUR) {
            0 if self.nmt == Nmt::Operational => self.set_nmt(Nmt::PreOperational),
            2 => self.set_nmt(Nmt::Stopped),
            _ => {}
        }
        if !self.abort_connection(code, drive) {
            self.raise(code);
        }
    }

    /// Monitors the master and the RPDOs.
    pub(super) fn monitor(&mut self, drive: &mut Drive) {
        let life_time = self.stored(object::GUARD_TIME) * self.stored(object::LIFE_TIME_FACTOR);
        let heartbeat_time = self.consumer().1;
        if self.heartbeat.expires(self.now, heartbeat_time) | self.guarding.expires(self.now, life_time) {
            self.lose_connection(fault::LIFE_GUARD, drive);
        }
        for number in 0..PDO_COUNT {
            let time = self.stored(Address::new(Direction::Receive.parameters(number), 5));
            let now = self.now;
            let Some(pdo) = self.receive.get_mut(number) else { continue };
            let silence = pdo.seen.map_or(0, |seen| now.saturating_sub(seen));
            if time > 0 && silence > 1000 * u64::from(time) && self.nmt == Nmt::Operational {
                pdo.seen = None;
                if !self.abort_connection(fault::PDO_TIMEOUT, drive) {
                    self.raise(fault::PDO_TIMEOUT);
                }
            }
        }
    }

    pub(super) fn send_heartbeat(&mut self, send: Send<'_>) {
        let time = 1000 * u64::from(self.stored(object::PRODUCER_HEARTBEAT));
        if self.nmt == Nmt::Initialising {
            if self.now < self.initialised_from + BOOT_TIME {
                return;
            }
            self.nmt = Nmt::PreOperational;
            self.send(0x700, &[Nmt::Initialising as u8], send);
        } else if time > 0 && self.now.saturating_sub(self.heartbeat_sent) >= time {
            self.heartbeat_sent = self.now;
            self.send(0x700, &[self.nmt as u8], send);
        }
    }
}
