//! Number of instructions of a code block: an instruction has one or two half words, as its first half word tells
//! (ARMv7-M A5.1). Every block is counted once.

use std::collections::HashMap;

/// First address of flash.
const FLASH: u32 = 0x0800_0000;

/// Numbers of instructions by the address and size of a block.
#[derive(Debug, Default)]
pub struct Blocks {
    flash: Vec<(u16, u16)>,
    elsewhere: HashMap<u32, (u32, u32)>,
}

impl Blocks {
    /// Instructions of a block that was counted before.
    pub fn get(&self, address: u32, size: u32) -> Option<u32> {
        match self.flash.get((address.wrapping_sub(FLASH) / 2) as usize) {
            Some((known, count)) => (u32::from(*known) == size && *count > 0).then_some((*count).into()),
            None => self.elsewhere.get(&address).filter(|(known, _)| *known == size).map(|(_, count)| *count),
        }
    }

    /// Counts the instructions of a block.
    pub fn look(&mut self, address: u32, code: &[u8]) -> u32 {
        let count = instructions(code);
        let place = (address.wrapping_sub(FLASH) / 2) as usize;
        if place < FLASH_PLACES && code.len() <= u16::MAX as usize {
            if self.flash.is_empty() {
                self.flash = vec![(0, 0); FLASH_PLACES];
            }
            self.flash[place] = (code.len() as u16, count as u16);
        } else {
            self.elsewhere.insert(address, (code.len() as u32, count));
        }
        count
    }
}

/// Half words of the largest flash.
const FLASH_PLACES: usize = 0x10_0000;

fn instructions(code: &[u8]) -> u32 {
    let mut count = 0;
    let mut place = 0;
    while place + 1 < code.len() {
        // 0b11101, 0b11110 and 0b11111 begin an instruction of two half words.
        place += if code[place + 1] >> 3 >= 0b11101 { 4 } else { 2 };
        count += 1;
    }
    count.max(1)
}

#[cfg(test)]
mod tests {
    use super::instructions;

    #[test]
    fn long_instructions_count_once() {
        // nop; dsb; bx lr
        assert_eq!(instructions(&[0x00, 0xbf, 0xbf, 0xf3, 0x4f, 0x8f, 0x70, 0x47]), 3);
    }
}
