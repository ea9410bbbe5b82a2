//! Registers of a servo: the present bytes, those kept over a power cycle, and the backup.

use super::table::{self, Area, FIELDS, Field, SIZE};

type Bytes = [u8; SIZE];

/// Registers.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    present: Bytes,
    saved: Bytes,
    backup: Bytes,
}

impl Memory {
    /// Registers with the values of the factory.
    pub fn new() -> Self {
        let mut memory = Self { present: [0; SIZE], saved: [0; SIZE], backup: [0; SIZE] };
        FIELDS.iter().for_each(|field| memory.set(field, field.default));
        memory.saved = memory.present;
        memory.backup = memory.present;
        memory
    }

    /// Value of a register.
    pub fn get(&self, field: &Field) -> i32 {
        self.present.get(field.addresses()).and_then(|bytes| field.decode(bytes)).unwrap_or(0)
    }

    /// Quantity of a register.
    pub fn quantity(&self, field: &Field) -> f32 {
        field.quantity_of(self.get(field))
    }

    /// Sets a register until the next power cycle.
    pub fn set(&mut self, field: &Field, value: i32) {
        put(&mut self.present, field, value);
    }

    /// Sets a register for good.
    pub fn save(&mut self, field: &Field, value: i32) {
        self.set(field, value);
        put(&mut self.saved, field, value);
    }

    /// Bytes from an address on; those beyond the last register are zero.
    pub fn read(&self, address: u8, length: u8) -> impl Iterator<Item = u8> {
        let bytes = self.present.iter().copied().skip(address.into());
        bytes.chain(core::iter::repeat(0)).take(length.into())
    }

    /// Writes bytes from an address on: those of registers that can be written, limited to their range.
    pub fn write(&mut self, address: u8, data: &[u8]) {
        let written = usize::from(address)..usize::from(address) + data.len();
        for field in FIELDS.iter().filter(|field| field.area != Area::ReadOnly && overlaps(field, &written)) {
            for at in field.addresses() {
                let byte = at.checked_sub(written.start).and_then(|index| data.get(index));
                if let (Some(byte), Some(place)) = (byte, self.present.get_mut(at)) {
                    *place = *byte;
                }
            }
            let (low, high) = field.range;
            let value = self.get(field).clamp(low, high);
            self.set(field, value);
            if field.area == Area::Saved && self.get(&table::LOCK) == 0 {
                self.save(field, value);
            }
        }
    }

    /// Loads the registers as at power-up.
    pub fn restart(&mut self) {
        self.present = self.saved;
        let torque = self.get(&table::MAX_TORQUE);
        self.set(&table::TORQUE_LIMIT, torque);
    }

    /// Makes the present registers the backup.
    pub fn back_up(&mut self) {
        self.backup = self.present;
    }

    /// Restores the backup of the kept registers, except for the identifier.
    pub fn recover(&mut self) {
        for field in FIELDS.iter().filter(|field| field.area == Area::Saved && **field != table::ID) {
            let value = self.backup.get(field.addresses()).and_then(|bytes| field.decode(bytes)).unwrap_or(0);
            self.save(field, value);
        }
    }
}

fn put(bytes: &mut Bytes, field: &Field, value: i32) {
    if let Some(place) = bytes.get_mut(field.addresses()) {
        place.iter_mut().zip(field.encode(value)).for_each(|(byte, new)| *byte = new);
    }
}

/// True if a register has bytes in a range of addresses.
pub(super) fn overlaps(field: &Field, range: &core::ops::Range<usize>) -> bool {
    let addresses = field.addresses();
    addresses.start < range.end && range.start < addresses.end
}
