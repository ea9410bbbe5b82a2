//! Registers as data: what a manual's register map says of each, so that access rules are checked in one place.

/// What is known of a register.
#[derive(Debug, Clone, Copy)]
pub struct Register {
    /// Its name in the manual.
    pub name: &'static str,
    /// From the peripheral's base.
    pub offset: u32,
    /// Its value after a reset.
    pub reset: u32,
    /// Bits that mean something; the others must be kept as after the reset.
    pub fields: u32,
    /// Bits among them that writes do not change by themselves: read-only, or changed in a way of their own.
    pub special: u32,
    /// Widths of access in bytes that are allowed, added up: 1, 2 and 4.
    pub widths: u32,
    /// Reserved bits may be written with anything, as in registers of keys.
    pub any_value: bool,
}

impl Register {
    /// A register that is accessed by words and has no bits of its own ways.
    pub const fn new(name: &'static str, offset: u32, reset: u32, fields: u32) -> Self {
        Self { name, offset, reset, fields, special: 0, widths: 4, any_value: false }
    }

    /// With bits that writes do not change by themselves.
    pub const fn special(mut self, bits: u32) -> Self {
        self.special = bits;
        self
    }

    /// Bytes and half-words as well.
    pub const fn any_width(mut self) -> Self {
        self.widths = 7;
        self
    }

    /// Half-words as well.
    pub const fn half_words(mut self) -> Self {
        self.widths = 6;
        self
    }

    /// No bit is reserved in a write.
    pub const fn any_value(mut self) -> Self {
        self.any_value = true;
        self
    }
}

/// The registers of a peripheral with their values.
#[derive(Debug, Clone)]
pub struct Registers {
    table: &'static [Register],
    values: Vec<u32>,
}

impl Registers {
    /// As after a reset.
    pub fn new(table: &'static [Register]) -> Self {
        Self { table, values: table.iter().map(|register| register.reset).collect() }
    }

    /// All to their values after a reset.
    pub fn reset(&mut self) {
        *self = Self::new(self.table);
    }

    /// What is known of the one at an offset.
    pub fn describe(&self, offset: u32) -> Option<&'static Register> {
        self.place(offset).map(|place| &self.table[place])
    }

    /// Its value; 0 where there is none.
    pub fn get(&self, offset: u32) -> u32 {
        self.place(offset).map_or(0, |place| self.values[place])
    }

    /// Sets its value.
    pub fn set(&mut self, offset: u32, value: u32) {
        if let Some(place) = self.place(offset) {
            self.values[place] = value;
        }
    }

    /// Sets and clears bits.
    pub fn change(&mut self, offset: u32, set: u32, clear: u32) {
        self.set(offset, self.get(offset) & !clear | set);
    }

    /// Whether a bit is set.
    pub fn is_set(&self, offset: u32, bit: u32) -> bool {
        self.get(offset) >> bit & 1 == 1
    }

    /// A field's value.
    pub fn field(&self, offset: u32, low: u32, bits: u32) -> u32 {
        self.get(offset) >> low & ((1 << bits) - 1)
    }

    fn place(&self, offset: u32) -> Option<usize> {
        self.table.iter().position(|register| register.offset == offset)
    }
}

/// Bits from `low` up to and with `high`.
pub const fn bits(high: u32, low: u32) -> u32 {
    (u32::MAX >> (31 - high)) & (u32::MAX << low)
}

/// One bit.
pub const fn bit(number: u32) -> u32 {
    1 << number
}
