//! Process data of the server: received PDOs into objects, objects into transmit PDOs.

use super::dictionary::{self as object, Address, Direction, PDO_COUNT, PDO_IS_INVALID};
use super::state::State;
use super::{Server, fault, pdo};
use crate::drive::Drive;
use crate::frame::{Frame, standard};
use heapless::Vec;

impl Server {
    /// Identifier of a valid PDO.
    pub(super) fn pdo_id(&self, direction: Direction, number: usize) -> Option<u16> {
        let id = self.stored(Address::new(direction.parameters(number), 1));
        (id & PDO_IS_INVALID == 0).then_some(id as u16 & 0x7FF)
    }

    pub(super) fn receive_pdo(&mut self, id: u16, data: &[u8], drive: &mut Drive) {
        for number in 0..PDO_COUNT {
            if self.pdo_id(Direction::Receive, number) != Some(id) {
                continue;
            }
            let length: usize =
                self.mappings(Direction::Receive.mapping(number)).iter().copied().map(pdo::size_of_mapping).sum();
            let Some(data) = data.get(..length).and_then(|data| Vec::from_slice(data).ok()) else {
                self.report(fault::PDO_LENGTH);
                continue;
            };
            let now = self.now;
            let Some(pdo) = self.receive.get_mut(number) else { continue };
            (pdo.pending, pdo.seen) = (Some(data), Some(now));
            if self.error == fault::PDO_TIMEOUT && self.state != State::Fault {
                self.clear_error();
            }
            if self.transmission(Direction::Receive, number) > 240 {
                self.apply_pdos(Some(number), drive);
            }
        }
    }

    pub(super) fn transmission(&self, direction: Direction, number: usize) -> u8 {
        self.stored(Address::new(direction.parameters(number), 2)) as u8
    }

    /// Writes the objects of received PDOs, of one or of all. The control word is the last, because it takes targets
    /// over.
    pub(super) fn apply_pdos(&mut self, only: Option<usize>, drive: &mut Drive) {
        let mut control = None;
        for number in (0..PDO_COUNT).filter(|number| only.is_none_or(|only| only == *number)) {
            let Some(data) = self.receive.get_mut(number).and_then(|pdo| pdo.pending.take()) else { continue };
            let mappings = self.mappings(Direction::Receive.mapping(number));
            for (address, raw) in pdo::unpack(&mappings, &data) {
                if address == object::CONTROLWORD {
                    control = Some(raw);
                } else {
                    // A PDO has no answer: a value out of range changes nothing.
                    let _ = self.write(address, raw, drive);
                }
            }
        }
        if let Some(word) = control {
            let _ = self.write(object::CONTROLWORD, word, drive);
        }
    }

    /// Frames of the TPDOs that are due, of one or of all.
    pub(super) fn due_pdos(
        &mut self,
        trigger: pdo::Trigger,
        only: Option<usize>,
        drive: &Drive,
    ) -> impl Iterator<Item = Frame> {
        let numbers = (0..PDO_COUNT).filter(move |number| only.is_none_or(|only| only == *number));
        numbers.filter_map(move |number| self.due_pdo(trigger, number, drive))
    }

    /// Frame of a TPDO that is due.
    fn due_pdo(&mut self, trigger: pdo::Trigger, number: usize, drive: &Drive) -> Option<Frame> {
        let id = self.pdo_id(Direction::Transmit, number)?;
        let timing = pdo::Timing {
            transmission: self.transmission(Direction::Transmit, number),
            inhibit: self.stored(Address::new(Direction::Transmit.parameters(number), 3)),
            event: self.stored(Address::new(Direction::Transmit.parameters(number), 5)),
        };
        let mut data = pdo::Data::new();
        for mapping in self.mappings(Direction::Transmit.mapping(number)) {
            let raw = self.read(object::mapped_address(mapping), drive).unwrap_or(0);
            pdo::pack(&mut data, raw, pdo::size_of_mapping(mapping));
        }
        let now = self.now;
        let pdo = self.transmit.get_mut(number)?;
        if !pdo.is_due(trigger, timing, &data, now) {
            return None;
        }
        let frame = Frame::classic(standard(id), &data)?;
        pdo.note(data, now);
        Some(frame)
    }
}
