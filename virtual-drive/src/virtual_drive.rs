//! Joint, drive, supply and server of one maker, stepped together.

use drives::bus::CanServer;
use drives::drive::VirtualPower;
use drives::frame::Send;
use drives::{Drive, Frame};
use model_core::virtual_joint::VirtualJoint;

use crate::maker::Maker;
use crate::{DriveDesign, step};

/// A joint behind a maker's drive on a CAN bus.
///
/// In each control period, [`note_bus_state`](Self::note_bus_state) comes first, then [`receive`](Self::receive) for
/// each frame that arrived, then [`step`](Self::step).
pub struct VirtualDrive<'t, M: Maker, const N: usize> {
    joint: VirtualJoint<'t, f32, N>,
    drive: Drive,
    power: VirtualPower,
    server: M::Server,
    is_bus_off: bool,
}

impl<'t, M: Maker, const N: usize> VirtualDrive<'t, M, N> {
    /// Joint at rest behind a disabled, calibrated drive with an identifier, on a bus that works.
    pub fn new(joint: VirtualJoint<'t, f32, N>, design: &DriveDesign, id: u8) -> Self {
        let settings = M::settings(design.settings(M::PEAK_CURRENT, M::SUPPLY, true));
        Self {
            joint,
            drive: Drive::new(settings),
            power: VirtualPower::new(M::SUPPLY),
            server: M::server(id, &settings),
            is_bus_off: false,
        }
    }

    /// Tells the server if the CAN controller went off the bus (`is_off`) or returned since the last call.
    pub fn note_bus_state(&mut self, is_off: bool, send: Send<'_>) {
        if is_off != self.is_bus_off {
            self.is_bus_off = is_off;
            self.server.bus_off(is_off, &mut self.drive, send);
        }
    }

    /// Handles a frame from the bus.
    pub fn receive(&mut self, frame: &Frame, send: Send<'_>) {
        self.server.receive(frame, &mut self.drive, send);
    }

    /// Runs one control period of joint, drive and supply, then sends the server's cyclic frames.
    pub fn step(&mut self, send: Send<'_>) {
        self.advance();
        self.send_cyclic(send);
    }

    /// First part of [`step`](Self::step): joint, drive and supply.
    pub fn advance(&mut self) {
        step(&mut self.joint, &mut self.drive, &mut self.power);
    }

    /// Second part of [`step`](Self::step): the server's cyclic frames.
    pub fn send_cyclic(&mut self, send: Send<'_>) {
        self.server.tick(&mut self.drive, send);
    }

    /// Drive.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use drives::drive::Fault;
    use drives::frame::standard;
    use model_core::VirtualJointDesign;

    use super::*;
    use crate::maker::{Cia402, Odrive3};

    fn with_drive<M: Maker>(run: impl FnOnce(VirtualDrive<'_, M, 3>)) {
        let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
        let tables = VirtualJointDesign::<3>::new(&q1, 10_000).unwrap();
        let design = DriveDesign::new(&q1.parameters, &q1.surroundings, 40.0, true);
        run(VirtualDrive::new(tables.joint(), &design, 1));
    }

    /// CiA 402 sends 8140h when the controller goes off and 0 when it returns, once each.
    #[test]
    fn bus_off_is_reported_at_each_change() {
        with_drive::<Cia402>(|mut unit| {
            let mut sent = Vec::new();
            // The drive boots within 100 ms.
            (0..1000).for_each(|_| unit.step(&mut |_| {}));
            for is_off in [false, true, true, false, false] {
                unit.note_bus_state(is_off, &mut |frame| sent.push(frame));
            }
            assert!(sent.iter().all(|frame| frame.id == standard(0x81)));
            let codes: Vec<&[u8]> = sent.iter().map(|frame| &frame.data()[..2]).collect();
            assert_eq!(codes, [[0x40, 0x81], [0, 0]]);
        });
    }

    #[test]
    fn joint_that_is_not_finite_restarts() {
        with_drive::<Odrive3>(|mut unit| {
            unit.joint.advance(0.0, f32::NAN);
            assert!(!unit.joint.model().is_finite());
            unit.step(&mut |_| {});
            assert!(unit.joint.model().is_finite());
            assert_eq!(unit.drive.fault(), Some(Fault::MotorEncoder));
            unit.drive.clear_fault();
            unit.step(&mut |_| {});
            assert_eq!(unit.drive.fault(), None);
        });
    }
}
