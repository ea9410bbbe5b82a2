//! Length of CAN frames on the wire, by ISO 11898-1: every field, and a stuff bit after five equal bits.

use drives::Frame;
use drives::frame::{Id, Kind};

use crate::wires::{Time, cycles};

/// Bits between two frames.
pub const PAUSE: u64 = 3;
/// Bits of an error frame: two flags of six bits and the delimiter.
pub const ERROR_FRAME: u64 = 20;
/// Bits after the checksum of a classical frame: its delimiter, acknowledgement with delimiter, end of frame.
const TAIL: u64 = 1 + 2 + 7;

/// Duration of a frame, from its start to the end of its last field.
pub fn duration(frame: &Frame, bitrate: u64, data_bitrate: Option<u64>) -> Time {
    match frame.kind {
        Kind::Classic | Kind::Remote => cycles(classic_bits(frame), bitrate),
        Kind::Flexible(switches) => {
            let (slow, fast) = flexible_bits(frame);
            let fast_rate = data_bitrate.filter(|_| switches).unwrap_or(bitrate);
            cycles(slow, bitrate) + cycles(fast, fast_rate)
        }
    }
}

/// Bits of a field, the highest first.
fn push(bits: &mut Vec<bool>, value: u32, count: u32) {
    bits.extend((0..count).rev().map(|place| value >> place & 1 == 1));
}

/// Bits of a frame up to the length code.
fn header(frame: &Frame) -> Vec<bool> {
    let mut bits = vec![false];
    let remote = u32::from(frame.kind == Kind::Remote);
    let is_flexible = matches!(frame.kind, Kind::Flexible(_));
    match frame.id {
        Id::Standard(id) => {
            push(&mut bits, id.as_raw().into(), 11);
            push(&mut bits, remote << 1, 2);
        }
        Id::Extended(id) => {
            push(&mut bits, id.as_raw() >> 18, 11);
            push(&mut bits, 0b11, 2);
            push(&mut bits, id.as_raw() & 0x3_ffff, 18);
            push(&mut bits, remote, 1);
        }
    }
    match (is_flexible, frame.id) {
        // FDF, reserved, BRS.
        (true, _) => push(&mut bits, 0b101, 3),
        (false, Id::Standard(_)) => push(&mut bits, 0, 1),
        (false, Id::Extended(_)) => push(&mut bits, 0, 2),
    }
    bits
}

/// Checksum of 15 bits, polynomial 0x4599.
fn checksum(bits: &[bool]) -> u32 {
    bits.iter().fold(0, |sum, bit| {
        let next = *bit != (sum >> 14 & 1 == 1);
        (sum << 1 & 0x7fff) ^ if next { 0x4599 } else { 0 }
    })
}

/// Number of stuff bits.
fn stuffed(bits: &[bool]) -> u64 {
    let (mut count, mut run, mut last) = (0, 0, None);
    for bit in bits {
        run = if last == Some(*bit) { run + 1 } else { 1 };
        last = Some(*bit);
        if run == 5 {
            // The stuff bit has the other level, and begins a run itself.
            (count, run, last) = (count + 1, 1, Some(!*bit));
        }
    }
    count
}

fn classic_bits(frame: &Frame) -> u64 {
    let mut bits = header(frame);
    push(&mut bits, frame.length() as u32, 4);
    frame.data().iter().for_each(|byte| push(&mut bits, (*byte).into(), 8));
    let sum = checksum(&bits);
    push(&mut bits, sum, 15);
    bits.len() as u64 + stuffed(&bits) + TAIL
}

/// Bits at the first and at the second rate. The checksum has a stuff bit before it and after each fourth bit.
fn flexible_bits(frame: &Frame) -> (u64, u64) {
    let start = header(frame);
    let mut all = start.clone();
    // ESI, length code.
    push(&mut all, 0, 5);
    frame.data().iter().for_each(|byte| push(&mut all, (*byte).into(), 8));
    let sum_bits = if frame.length() > 16 { 4 + 21 } else { 4 + 17 };
    let fixed_stuff = 1 + sum_bits / 4;
    let slow = start.len() as u64 + stuffed(&start);
    let fast = (all.len() - start.len()) as u64 + stuffed(&all) - stuffed(&start) + sum_bits + fixed_stuff;
    (slow + TAIL, fast)
}

#[cfg(test)]
mod tests {
    use super::*;
    use drives::frame::{extended, standard};

    fn bits(id: impl Into<Id>, data: &[u8]) -> u64 {
        classic_bits(&Frame::classic(id.into(), data).unwrap())
    }

    /// 44 bits and the data without stuff bits, less the pause of three; 11-bit frames have at most 24 stuff bits.
    #[test]
    fn lengths_within_known_bounds() {
        for data in [[0x55; 8], [0; 8], [0xff; 8], [0xf8; 8]] {
            assert!((108..=108 + 24).contains(&bits(standard(0x2aa), &data)), "{data:?}");
            assert!((128..=128 + 29).contains(&bits(extended(0x0aaa_aaaa), &data)), "{data:?}");
        }
        assert!((44..=44 + 8).contains(&bits(standard(0x2aa), &[])));
    }

    #[test]
    fn five_equal_bits_are_stuffed() {
        assert_eq!(stuffed(&[true; 5]), 1);
        assert_eq!(stuffed(&[true; 4]), 0);
        // The stuff bit and four bits of its level make the next one.
        assert_eq!(stuffed(&[true, true, true, true, true, false, false, false, false]), 2);
    }

    #[test]
    fn second_rate_shortens_data() {
        let frame = Frame::flexible(extended(0x8001), &[0x55; 48], 0).unwrap();
        let slow = duration(&frame, 1_000_000, None);
        let fast = duration(&frame, 1_000_000, Some(5_000_000));
        assert!(fast * 3 < slow, "{slow} {fast}");
    }
}
