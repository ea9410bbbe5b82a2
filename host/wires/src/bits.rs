//! Bits of a CAN frame on the wire (ISO 11898-1), as far as arbitration, collisions and the time on the bus need them.
//!
//! | part | bits |
//! |---|---|
//! | up to the control field | start 0; identifier 11, and with 29 bits SRR 1, IDE 1, 18 more; RTR or RRS, IDE, FDF, ... |
//! | length code, data | 4, 8 a byte |
//! | checksum | 15; CAN FD: stuff count 4, and 17 or 21 |
//! | end | delimiter 1, acknowledgement 2, end of frame 7 |
//!
//! After five equal bits the sender inserts one of the other value, up to the last bit of the checksum; in the checksum
//! of CAN FD every fifth bit is a stuff bit instead.

use drives::Frame;
use drives::frame::{Kind, length_code};

/// Delimiter of the checksum, acknowledgement with its delimiter, end of frame.
const END: u32 = 1 + 2 + 7;
/// Intermission between two frames, also after an error frame.
pub const INTERMISSION: u32 = 3;
/// Flags of all nodes after an error (6 to 12 bits), delimiter 8.
pub const ERROR_FRAME: u32 = 12 + 8;
/// Polynomial of the checksum of classical frames, of degree 15.
const POLYNOMIAL: u16 = 0x4599;

/// Bits of a frame from its start to the last one before the end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bits {
    /// Bits without stuff bits; true is recessive. Of CAN FD those before the checksum.
    sequence: Vec<bool>,
    /// First bit at the second bit rate.
    switch: Option<usize>,
    /// Bits of the checksum with fixed stuff bits.
    fixed: u32,
}

/// Time of a frame in bits at both bit rates.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Duration {
    /// Bits at the nominal bit rate.
    pub nominal: u32,
    /// Bits at the bit rate of the data.
    pub data: u32,
}

impl Bits {
    /// Bits of a frame.
    pub fn new(frame: &Frame) -> Self {
        let mut sequence = vec![false];
        let mut put = |value: u32, width: u32| (0..width).rev().for_each(|bit| sequence.push(value >> bit & 1 == 1));
        let is_remote = frame.kind == Kind::Remote;
        let is_flexible = matches!(frame.kind, Kind::Flexible(_));
        match frame.extended_id() {
            None => {
                put(frame.raw_id(), 11);
                put(is_remote.into(), 1);
                put(0, 1);
            }
            Some(id) => {
                put(id >> 18, 11);
                put(0b11, 2);
                put(id, 18);
                put(is_remote.into(), 1);
            }
        }
        // FDF; a classical frame has r0 there, and r1 before it with 29 bits.
        if is_flexible {
            put(0b10, 2);
        } else {
            put(0, if frame.extended_id().is_some() { 2 } else { 1 });
        }
        let switches = frame.kind == Kind::Flexible(true);
        if is_flexible {
            put(switches.into(), 1);
            // ESI: the sender is error active.
            put(0, 1);
        }
        put(length_code(frame.length()), 4);
        frame.data().iter().for_each(|byte| put((*byte).into(), 8));
        let after_switch = 5 + 8 * frame.data().len();
        let switch = switches.then(|| sequence.len() - after_switch);
        let fixed = match (is_flexible, frame.length()) {
            (false, _) => {
                let checksum = checksum(&sequence);
                (0..15).rev().for_each(|bit| sequence.push(checksum >> bit & 1 == 1));
                0
            }
            (true, ..=16) => stuffed_by_fours(4 + 17),
            (true, _) => stuffed_by_fours(4 + 21),
        };
        Self { sequence, switch, fixed }
    }

    /// Time on the bus, without the intermission after it.
    pub fn duration(&self) -> Duration {
        let switch = self.switch.unwrap_or(self.sequence.len());
        let (before, after) = self.stuff_bits(switch);
        let (first, rest) = (switch as u32 + before, (self.sequence.len() - switch) as u32 + after + self.fixed);
        match self.switch {
            None => Duration { nominal: first + rest + END, data: 0 },
            // The delimiter of the checksum has the second bit rate.
            Some(_) => Duration { nominal: first + END - 1, data: rest + 1 },
        }
    }

    /// Number of the first bit in which two frames differ; `None` if they are alike.
    pub fn difference(&self, other: &Self) -> Option<usize> {
        let both = self.sequence.iter().zip(&other.sequence);
        // Frames of different lengths differ in their length codes.
        both.into_iter().position(|(mine, its)| mine != its)
    }

    /// True for a recessive bit, which any dominant one hides.
    pub fn is_recessive(&self, bit: usize) -> bool {
        self.sequence.get(bit).copied().unwrap_or(true)
    }

    /// Stuff bits before and after a bit.
    fn stuff_bits(&self, switch: usize) -> (u32, u32) {
        let (mut run, mut last, mut counts) = (0, None, [0, 0]);
        for (index, bit) in self.sequence.iter().enumerate() {
            run = if last == Some(*bit) { run + 1 } else { 1 };
            last = Some(*bit);
            // The checksum of CAN FD begins with a stuff bit anyway.
            let is_before_fixed = self.fixed > 0 && index + 1 == self.sequence.len();
            if run == 5 && !is_before_fixed {
                // The stuff bit begins a run of its own value.
                (run, last) = (1, Some(!bit));
                counts[usize::from(index >= switch)] += 1;
            }
        }
        (counts[0], counts[1])
    }
}

/// Key of the arbitration: of two frames the one with the lower key wins.
pub fn priority(frame: &Frame) -> u32 {
    let remote = u32::from(frame.kind == Kind::Remote);
    match frame.extended_id() {
        None => frame.raw_id() << 21 | remote << 20,
        Some(id) => (id >> 18) << 21 | 0b11 << 19 | (id & 0x3_FFFF) << 1 | remote,
    }
}

/// Bits with a stuff bit before the first and after each four.
const fn stuffed_by_fours(bits: u32) -> u32 {
    bits + bits.div_ceil(4)
}

/// Checksum of a classical frame.
fn checksum(bits: &[bool]) -> u16 {
    bits.iter().fold(0, |checksum, bit| {
        let is_odd = (checksum >> 14 & 1 == 1) != *bit;
        let shifted = checksum << 1 & 0x7FFF;
        if is_odd { shifted ^ POLYNOMIAL } else { shifted }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use drives::frame::{extended, standard};

    #[test]
    fn frame_lengths_lie_between_the_bounds() {
        // 44 bits and 8 a byte with 11 bits, 64 with 29; a stuff bit after each four of 34 or 54.
        for (length, byte) in (0..=8).flat_map(|length| [0x00, 0x55, 0xFF].map(|byte| (length, byte))) {
            let data = vec![byte; length];
            let bits = |frame: Option<Frame>| Bits::new(&frame.unwrap()).duration();
            let [short, long] = [standard(0x123), extended(0x123_4567)].map(|id| bits(Frame::classic(id, &data)));
            let payload = 8 * length as u32;
            assert!((44 + payload..=44 + payload + (34 + payload - 1) / 4).contains(&short.nominal), "{short:?}");
            assert!((64 + payload..=64 + payload + (54 + payload - 1) / 4).contains(&long.nominal), "{long:?}");
            assert_eq!((short.data, long.data), (0, 0));
        }
    }

    #[test]
    fn zeros_are_stuffed_by_fives() {
        let frame = Frame::classic(standard(0), &[]).unwrap();
        // 34 zeros, since the checksum of zeros is zero.
        assert_eq!(Bits::new(&frame).duration().nominal, 34 + 6 + END);
    }

    #[test]
    fn checksum_of_a_known_frame() {
        // Remainder of x^15 by the polynomial is the polynomial itself.
        assert_eq!(checksum(&[true]), POLYNOMIAL);
        assert_eq!(checksum(&[true, false]), 0x4599 << 1 & 0x7FFF ^ POLYNOMIAL);
    }

    #[test]
    fn flexible_data_has_the_second_rate() {
        let frame = Frame::flexible(extended(0x8001), &[0x55; 64], 0).unwrap();
        let duration = Bits::new(&frame).duration();
        // 4 + 64 x 8 bits, ESI, 25 bits of the checksum with 7 stuff bits, delimiter; 0x55 needs no stuff bits.
        assert_eq!(duration.data, 1 + 4 + 512 + 25 + 7 + 1);
        assert!((35 + 9..35 + 9 + 8).contains(&duration.nominal), "{duration:?}");
        let slow = Frame::with_kind(extended(0x8001), Kind::Flexible(false), &[0x55; 64]).unwrap();
        assert_eq!(Bits::new(&slow).duration().data, 0);
    }

    #[test]
    fn arbitration_prefers_low_identifiers() {
        let key = |frame: Option<Frame>| priority(&frame.unwrap());
        let data = key(Frame::classic(standard(0x10), &[]));
        assert!(key(Frame::classic(standard(0x0F), &[])) < data);
        let remote = key(Frame::remote(standard(0x10), 0));
        assert!(data < remote && remote < key(Frame::classic(extended(0x10 << 18), &[])));
        // The same first 11 bits: a frame with 11 bits wins over one with 29.
        assert!(data < key(Frame::classic(extended(0x10 << 18), &[])));
        assert!(key(Frame::classic(extended(0x10 << 18), &[])) < key(Frame::classic(standard(0x11), &[])));
    }

    #[test]
    fn difference_is_the_first_bit() {
        let bits = |data: &[u8]| Bits::new(&Frame::classic(standard(1), data).unwrap());
        assert_eq!(bits(&[1, 2]).difference(&bits(&[1, 2])), None);
        // 1 + 11 + 3 + 4 bits before the data.
        assert_eq!(bits(&[0x80]).difference(&bits(&[0])), Some(19));
        assert!(bits(&[0x80]).is_recessive(19));
        assert_eq!(bits(&[]).difference(&bits(&[0])), Some(18));
    }
}
