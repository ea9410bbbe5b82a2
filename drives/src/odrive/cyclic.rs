//! Cyclic messages.

use super::Firmware;

/// Most cyclic messages of a line.
pub(super) const COUNT: usize = 10;

/// Period of the heartbeat [ms], both lines.
const HEARTBEAT: u32 = 100;
/// Period of the encoder estimates [ms], both lines.
const ENCODER_ESTIMATES: u32 = 10;

/// Message that is sent by itself.
#[derive(Debug, Clone, Copy)]
struct Message {
    command: u8,
    /// Period [ms]; 0 for none.
    rate: u32,
    /// Control periods since the last one.
    elapsed: u32,
}

/// All cyclic messages.
#[derive(Debug, Clone)]
pub(super) struct Cyclic([Message; COUNT]);

impl Cyclic {
    /// Messages of a line at their default rates.
    pub fn new(firmware: Firmware) -> Self {
        // Firmware 0.6 has nine; the last one of its list is never sent.
        let commands = match firmware {
            Firmware::V0_5 => [0x01, 0x09, 0x03, 0x04, 0x1d, 0x05, 0x0a, 0x14, 0x15, 0x17],
            Firmware::V0_6 => [0x01, 0x09, 0x00, 0x14, 0x03, 0x15, 0x17, 0x1c, 0x1d, u8::MAX],
        };
        Self(commands.map(|command| {
            let rate = match command {
                0x01 => HEARTBEAT,
                0x09 => ENCODER_ESTIMATES,
                _ => 0,
            };
            Message { command, rate, elapsed: 0 }
        }))
    }

    /// Period of a message [ms]; `None` for a message that is not cyclic.
    pub fn rate(&self, command: u8) -> Option<u32> {
        self.0.iter().find(|message| message.command == command).map(|message| message.rate)
    }

    /// Sets the period of a message [ms]; 0 turns it off.
    pub fn set_rate(&mut self, command: u8, rate: u32) {
        if let Some(message) = self.0.iter_mut().find(|message| message.command == command) {
            message.rate = rate;
        }
    }

    /// Advances by a control period [s]; returns the messages that are due.
    pub fn step(&mut self, period: f32) -> [Option<u8>; COUNT] {
        self.0.each_mut().map(|message| {
            if message.rate == 0 {
                return None;
            }
            let periods = (message.rate as f32 * 1e-3 / period.max(f32::MIN_POSITIVE) + 0.5) as u32;
            message.elapsed = message.elapsed.saturating_add(1);
            let is_due = message.elapsed >= periods;
            if is_due {
                message.elapsed = 0;
            }
            is_due.then_some(message.command)
        })
    }
}
