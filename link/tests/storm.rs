//! Millions of arbitrary bytes: noise, changed, cut or repeated frames, floods. The receiver accepts sent frames only,
//! the scanner reports the frames that the receiver accepts, and both keep working.
//!
//! Good frames are known without decoding: bytes between two zero bytes that equal a sent frame. A bad frame passes a
//! CRC-32 once in 2^32. 1e9 bytes contain 2.4e7 bad frames, so that 0.006 would be accepted by chance; with this seed
//! none is. The work per byte is bounded by construction: a nonzero byte costs a few instructions, a zero at most a
//! pass over the bytes since the last zero, of which at most `MAX_FRAME` are kept.

use std::collections::HashSet;

use link::framing::{MAX_FRAME, Receiver, encode};
use link::messages::{Command, RunMode, RunSettings, Schedule, ToBoard};
use link::scanner::Scanner;
use model_core::numbers::random::splitmix64;

/// Number of bytes, unless `DECODER_BYTES` sets it.
const SHORT: u64 = 1_000_000;

struct Draw(u64);

impl Draw {
    fn below(&mut self, end: u32) -> u32 {
        (((splitmix64(&mut self.0) >> 32) * u64::from(end)) >> 32) as u32
    }

    fn message(&mut self) -> ToBoard {
        match self.below(5) {
            0 => ToBoard::Hello { protocol: self.below(1 << 16) as u16 },
            1 => ToBoard::Stop,
            2 => ToBoard::Statistics { reset: self.below(2) == 0 },
            3 => ToBoard::Reset(RunSettings {
                mode: RunMode::Realtime,
                decimation: self.below(300) as u16,
                command_timeout: self.below(u32::MAX),
                from_memory: false,
            }),
            _ => {
                let commands = (0..self.below(25))
                    .map(|_| Command {
                        tick: self.below(u32::MAX),
                        drive_torque: self.below(1 << 20) as f32,
                        load_torque: -0.25,
                    })
                    .collect();
                ToBoard::Schedule(Schedule { sequence: self.below(1 << 16) as u16, horizon: 7, commands })
            }
        }
    }

    /// Returns some bytes; adds the sent frames among them to the list.
    fn piece(&mut self, sent: &mut HashSet<Vec<u8>>) -> Vec<u8> {
        let mut frame = encode(&self.message()).expect("a message that fits").to_vec();
        let count = 1 + self.below(2 * MAX_FRAME as u32);
        match self.below(10) {
            0 => return (0..count).map(|_| self.below(256) as u8).collect(),
            // Noise of few values: short frames, with runs that look like lengths.
            1 => return (0..count).map(|_| self.below(9) as u8).collect(),
            2 => return vec![0; count as usize],
            3 => return (0..count).map(|_| 1 + self.below(255) as u8).collect(),
            _ => {}
        }
        sent.insert(frame[..frame.len() - 1].to_vec());
        let place = self.below(frame.len() as u32) as usize;
        match self.below(6) {
            0 => frame[place] ^= 1 << self.below(8),
            1 => drop(frame.drain(place..)),
            2 => drop(frame.drain(..place)),
            3 => frame.insert(place, self.below(256) as u8),
            4 => frame = frame.repeat(2),
            _ => {}
        }
        frame
    }
}

#[test]
fn storm_of_bytes_yields_sent_messages() {
    let bytes = std::env::var("DECODER_BYTES").map_or(SHORT, |count| count.parse().expect("a number of bytes"));
    let (mut draw, mut receiver, mut scanner) = (Draw(1), Receiver::new(), Scanner::new());
    let (mut sent, mut frame) = (HashSet::new(), Vec::new());
    let (mut passed, mut taken, mut dropped) = (0, 0_u64, 0_u32);
    while passed < bytes {
        let piece = draw.piece(&mut sent);
        passed += piece.len() as u64;
        for byte in piece {
            let (message, scanned) = (receiver.push::<ToBoard>(byte), scanner.push(byte));
            if byte != 0 {
                frame.push(byte);
                assert!(message.is_none() && scanned.is_none());
                continue;
            }
            let good = sent.contains(&frame);
            assert_eq!((message.is_some(), scanned.is_some()), (good, good), "after {passed} bytes: {frame:?}");
            assert_eq!(message == Some(ToBoard::Stop), scanned.is_some_and(ToBoard::is_stop));
            taken += u64::from(good);
            dropped += u32::from(!good && !frame.is_empty());
            frame.clear();
        }
        // A frame extends at most into the next piece.
        if frame.is_empty() {
            sent.clear();
        }
    }
    println!("{passed} bytes: {taken} frames taken, {dropped} dropped");
    assert_eq!(receiver.dropped().frames, dropped);
    assert!(taken > passed / 2000 && u64::from(dropped) > passed / 2000, "the storm is worth its name");
}
