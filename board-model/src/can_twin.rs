//! Twin of an image in role `drive`: the frames that the core took, in the ticks in which it took them, through the same
//! joint, drive and server on this host. Every frame of the image has to be the twin's, in order.

use drives::Frame;
use joint_file::JointFile;
use model_core::gears::design::Processor;
use virtual_drive::maker::{self, Maker};
use virtual_drive::{DriveDesign, VirtualDrive, joint_tables};

use crate::can_bus::CanBus;

/// Drive of an image.
#[derive(Debug, Clone, Copy)]
pub struct DriveOf<'j> {
    /// Word of the maker.
    pub maker: &'j str,
    /// Identifier on the bus.
    pub id: u8,
    /// Joint.
    pub joint: &'j JointFile,
    /// Processor that the tables were made for.
    pub processor: Processor,
}

impl DriveOf<'_> {
    /// Frames that the drive sends in the ticks of a bus, if it receives the frames that the core took, and reads the
    /// changes of bus-off that the core read, in the ticks of the core.
    pub fn frames(&self, bus: &CanBus) -> Result<Vec<Frame>, String> {
        match self.maker {
            "moteus" => self.of_maker::<maker::Moteus>(bus),
            "odrive" => self.of_maker::<maker::Odrive>(bus),
            "odrive3" => self.of_maker::<maker::Odrive3>(bus),
            "damiao" => self.of_maker::<maker::Damiao>(bus),
            "cybergear" => self.of_maker::<maker::Cybergear>(bus),
            "robstride" => self.of_maker::<maker::Robstride>(bus),
            "cia402" => self.of_maker::<maker::Cia402>(bus),
            other => Err(format!("no maker is called {other}")),
        }
    }

    fn of_maker<M: Maker>(&self, bus: &CanBus) -> Result<Vec<Frame>, String> {
        match self.joint.parameters.geometry.planets {
            1 => self.run::<M, 1>(bus),
            3 => self.run::<M, 3>(bus),
            4 => self.run::<M, 4>(bus),
            _ => self.run::<M, 5>(bus),
        }
    }

    fn run<M: Maker, const N: usize>(&self, bus: &CanBus) -> Result<Vec<Frame>, String> {
        let JointFile { parameters, surroundings, .. } = self.joint;
        let bandwidth = model_core::compensation::design::good_bandwidth(parameters, surroundings)
            .map_err(|error| error.to_string())?;
        let design = DriveDesign::new(parameters, surroundings, bandwidth, true);
        let tables = joint_tables::<N>(parameters, surroundings, &self.processor).map_err(|error| error.to_string())?;
        let mut drive = VirtualDrive::<M, N>::new(tables.joint(), &design, self.id);
        let mut sent = Vec::new();
        let (mut waiting, mut changes) = (bus.taken.iter().peekable(), bus.seen_off.iter().peekable());
        let mut is_off = false;
        for begun in 0..bus.ticks {
            // The core reads the state of the bus in the tick that has begun, and takes frames before it begins.
            while let Some((_, now)) = changes.next_if(|(tick, _)| *tick <= begun + 1) {
                is_off = *now;
            }
            drive.note_bus_state(is_off, &mut |frame| sent.push(frame));
            while let Some((_, frame)) = waiting.next_if(|(tick, _)| *tick <= begun) {
                drive.receive(frame, &mut |frame| sent.push(frame));
            }
            drive.step(&mut |frame| sent.push(frame));
        }
        Ok(sent)
    }

    /// Compares the frames of an image with the twin's; returns their number. The image's last frames may wait still.
    pub fn compare(&self, bus: &CanBus) -> Result<usize, String> {
        let (handed, expected) = (&bus.handed, self.frames(bus)?);
        let wrong = handed.iter().zip(&expected).position(|((_, own), twin)| own != twin);
        if let Some(place) = wrong {
            let (tick, own) = &handed[place];
            return Err(format!(
                "frame {place}, in tick {tick}, is {} and the twin's is {}",
                shown(own),
                shown(&expected[place])
            ));
        }
        match (handed.len(), expected.len()) {
            (own, twin) if own > twin => Err(format!("{own} frames, and the twin has {twin}")),
            (own, twin) if own + MOST_WAITING < twin => Err(format!("{own} frames, and the twin has {twin}")),
            (own, _) => Ok(own),
        }
    }
}

/// Frames that an image may not have handed over yet at the end.
const MOST_WAITING: usize = 8;

/// Frame in words.
pub fn shown(frame: &Frame) -> String {
    format!("{:#x} {:02x?}", frame.raw_id(), frame.data())
}
