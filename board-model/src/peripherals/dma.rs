//! What both kinds of DMA controller share: a transfer of one item between a peripheral and memory.

/// One item to be moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transfer {
    /// From there.
    pub from: u32,
    /// To there.
    pub to: u32,
    /// Bytes of the item.
    pub size: u32,
}

/// Addresses of one that runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Way {
    /// The peripheral's register.
    pub peripheral: u32,
    /// The first item in memory.
    pub memory: u32,
    /// Addresses in memory rise.
    pub rises: bool,
    /// From memory to the peripheral.
    pub outwards: bool,
    /// Bytes of an item.
    pub size: u32,
}

impl Way {
    /// The transfer of an item by its number.
    pub fn item(self, number: u32) -> Transfer {
        let memory = self.memory + if self.rises { number * self.size } else { 0 };
        let (from, to) = if self.outwards { (memory, self.peripheral) } else { (self.peripheral, memory) };
        Transfer { from, to, size: self.size }
    }
}
