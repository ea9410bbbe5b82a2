//! Message RAM of an FDCAN: its parts, and frames as elements of a FIFO.

use drives::Frame;
use drives::frame::{Id, Kind, extended, standard};

use crate::register::bit;

/// Data lengths by code.
const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];
/// Byte that is sent where an element has less data than its frame: RM0433 56.3.
const FILLER: u8 = 0xcc;

/// FIFO in the message RAM.
#[derive(Debug, Clone, Copy)]
pub struct Fifo {
    /// Start [byte].
    pub start: u32,
    /// Elements.
    pub depth: usize,
    /// Element with its header [byte].
    pub element: u32,
}

impl Fifo {
    /// Start of an element [byte].
    pub fn place(self, index: usize) -> u32 {
        self.start + self.element * index as u32
    }

    /// Index of the element at a place, if it is in the FIFO.
    pub fn index(self, place: u32) -> Option<usize> {
        let index = (place.checked_sub(self.start)? / self.element) as usize;
        (index < self.depth).then_some(index)
    }
}

/// Part of the message RAM.
#[derive(Debug, Clone, Copy, Default)]
pub struct Part {
    /// Content.
    pub name: &'static str,
    /// Start [byte].
    pub start: u32,
    /// Size [byte].
    pub bytes: u32,
    /// Elements.
    pub count: u32,
    /// Most elements that the peripheral can have.
    pub most: u32,
}

/// Division of the message RAM.
#[derive(Debug, Clone, Copy)]
pub struct Parts {
    /// Receive FIFO 0.
    pub receive: Fifo,
    /// Transmit FIFO.
    pub send: Fifo,
    /// All parts that registers place.
    pub all: [Part; 7],
}

impl Parts {
    /// Faults of a division: parts that are too large, leave the RAM, or overlap.
    pub fn faults(&self, ram: u32) -> Vec<String> {
        let used: Vec<Part> = self.all.into_iter().filter(|part| part.count > 0).collect();
        let mut faults = Vec::new();
        for (place, part) in used.iter().enumerate() {
            let Part { name, start, bytes, count, most } = *part;
            if count > most {
                faults.push(format!("{name}: {count} elements, and {most} are allowed"));
            }
            if start + bytes > ram {
                faults.push(format!("{name}: the end is byte {:#x}, and the RAM ends at {ram:#x}", start + bytes));
            }
            let beside =
                used[..place].iter().filter(|other| start < other.start + other.bytes && other.start < start + bytes);
            faults.extend(beside.map(|other| format!("{name} and {} overlap", other.name)));
        }
        faults
    }
}

/// Frame of an element with `room` bytes for data.
pub fn frame_of(words: &[u32], room: usize) -> Option<Frame> {
    let (id, control) = (*words.first()?, *words.get(1)?);
    let of = if id & bit(30) != 0 { extended(id) } else { standard((id >> 18) as u16) };
    let (is_flexible, is_fast) = (control & bit(21) != 0, control & bit(20) != 0);
    let code = (control >> 16 & 0xf) as usize;
    let length = if is_flexible { LENGTHS[code] } else { LENGTHS[code].min(8) };
    let stored = words[2..].iter().flat_map(|word| word.to_le_bytes()).take(room);
    let data: Vec<u8> = stored.chain(std::iter::repeat(FILLER)).take(length).collect();
    if id & bit(29) != 0 {
        return Frame::remote(of, length as u8);
    }
    Frame::with_kind(of, if is_flexible { Kind::Flexible(is_fast) } else { Kind::Classic }, &data)
}

/// Element of a received frame, whose data may be longer than the `room` in bytes.
pub fn element_of(frame: &Frame, room: usize) -> Vec<u32> {
    let (id, control) = header(frame);
    let stored = frame.data().chunks(4).take(room / 4).map(|bytes| {
        let mut word = [0; 4];
        word[..bytes.len()].copy_from_slice(bytes);
        u32::from_le_bytes(word)
    });
    [id, control].into_iter().chain(stored).collect()
}

/// Header words of an element.
fn header(frame: &Frame) -> (u32, u32) {
    let remote = u32::from(frame.kind == Kind::Remote) << 29;
    let id = match frame.id {
        Id::Standard(id) => u32::from(id.as_raw()) << 18,
        Id::Extended(id) => id.as_raw() | bit(30),
    };
    let kind = match frame.kind {
        Kind::Flexible(fast) => bit(21) | u32::from(fast) << 20,
        _ => 0,
    };
    let code = LENGTHS.iter().position(|length| *length >= frame.length()).unwrap_or_default();
    // ANMF: no filter has passed the frame.
    (id | remote, bit(31) | kind | (code as u32) << 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(name: &'static str, start: u32, count: u32) -> Part {
        Part { name, start, bytes: 72 * count, count, most: 64 }
    }

    fn faults(parts: [Part; 2]) -> Vec<String> {
        let mut all = [Part::default(); 7];
        all[..2].copy_from_slice(&parts);
        let fifo = Fifo { start: 0, depth: 3, element: 72 };
        Parts { receive: fifo, send: fifo, all }.faults(0x2800)
    }

    #[test]
    fn adjacent_parts_have_no_fault() {
        assert!(faults([part("a", 0, 3), part("b", 216, 3)]).is_empty());
        assert!(faults([part("a", 0, 3), part("b", 100, 0)]).is_empty());
    }

    #[test]
    fn overlap_end_and_size_are_faults() {
        assert_eq!(faults([part("a", 0, 3), part("b", 212, 3)]), ["b and a overlap"]);
        assert_eq!(
            faults([part("a", 0x2800 - 212, 3), part("b", 0, 3)]),
            ["a: the end is byte 0x2804, and the RAM ends at 0x2800"]
        );
        assert_eq!(faults([part("a", 0, 65), part("b", 0x2000, 1)]), ["a: 65 elements, and 64 are allowed"]);
    }

    #[test]
    fn element_keeps_frame() {
        let frame = Frame::flexible(extended(0x8001), &[0x55; 48], 0).unwrap();
        assert_eq!(frame_of(&element_of(&frame, 64), 64), Some(frame.clone()));
        // Without room the data are lost, and sent as the filler.
        let short = frame_of(&element_of(&frame, 8), 8).unwrap();
        assert_eq!((&short.data()[..8], &short.data()[8..]), (&[0x55; 8][..], &[FILLER; 40][..]));
    }
}
