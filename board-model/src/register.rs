//! Registers as data: entries of a manual's register map, so that access rules are checked in one place.

/// Description of a register.
#[derive(Debug, Clone, Copy)]
pub struct Register {
    /// Name in the manual.
    pub name: &'static str,
    /// Offset from the peripheral's base.
    pub offset: u32,
    /// Value after a reset.
    pub reset: u32,
    /// Defined bits; the others must keep their reset value.
    pub fields: u32,
    /// Defined bits that a write does not change directly: read-only, or with special behaviour.
    pub special: u32,
    /// Sum of the allowed access widths: 1, 2 and 4 [byte].
    pub widths: u32,
    /// True if reserved bits may have any value, as in key registers.
    pub any_value: bool,
}

impl Register {
    /// Register that is accessed by words and has no special bits.
    pub const fn new(name: &'static str, offset: u32, reset: u32, fields: u32) -> Self {
        Self { name, offset, reset, fields, special: 0, widths: 4, any_value: false }
    }

    /// Adds special bits.
    pub const fn special(mut self, bits: u32) -> Self {
        self.special = bits;
        self
    }

    /// Allows bytes and half words too.
    pub const fn any_width(mut self) -> Self {
        self.widths = 7;
        self
    }

    /// Allows half words too.
    pub const fn half_words(mut self) -> Self {
        self.widths = 6;
        self
    }

    /// Allows any value of reserved bits.
    pub const fn any_value(mut self) -> Self {
        self.any_value = true;
        self
    }
}

/// Registers of a peripheral with their values.
#[derive(Debug, Clone)]
pub struct Registers {
    table: &'static [Register],
    values: Vec<u32>,
}

impl Registers {
    /// Registers after a reset.
    pub fn new(table: &'static [Register]) -> Self {
        Self { table, values: table.iter().map(|register| register.reset).collect() }
    }

    /// Resets all registers.
    pub fn reset(&mut self) {
        *self = Self::new(self.table);
    }

    /// Description of the register at an offset.
    pub fn describe(&self, offset: u32) -> Option<&'static Register> {
        self.place(offset).map(|place| &self.table[place])
    }

    /// Value of a register; 0 if there is none.
    pub fn get(&self, offset: u32) -> u32 {
        self.place(offset).map_or(0, |place| self.values[place])
    }

    /// Sets the value of a register.
    pub fn set(&mut self, offset: u32, value: u32) {
        if let Some(place) = self.place(offset) {
            self.values[place] = value;
        }
    }

    /// Sets and clears bits.
    pub fn change(&mut self, offset: u32, set: u32, clear: u32) {
        self.set(offset, self.get(offset) & !clear | set);
    }

    /// Returns whether a bit is set.
    pub fn is_set(&self, offset: u32, bit: u32) -> bool {
        self.get(offset) >> bit & 1 == 1
    }

    /// Value of a field.
    pub fn field(&self, offset: u32, low: u32, bits: u32) -> u32 {
        self.get(offset) >> low & ((1 << bits) - 1)
    }

    fn place(&self, offset: u32) -> Option<usize> {
        self.table.iter().position(|register| register.offset == offset)
    }
}

/// Mask of the bits from `low` to `high`, inclusive.
pub const fn bits(high: u32, low: u32) -> u32 {
    (u32::MAX >> (31 - high)) & (u32::MAX << low)
}

/// Mask of one bit.
pub const fn bit(number: u32) -> u32 {
    1 << number
}
