//! Twin of an image in role `drive`: the frames that the core took, in the ticks in which it took them, through the same
//! joint, drive and server on this host. Every frame of the image has to be the twin's, in order.

use drives::bus::CanServer;
use drives::drive::VirtualPower;
use drives::{Drive, Frame};
use joint_file::JointFile;
use model_core::gears::design::Processor;
use virtual_drive::maker::{self, Maker};
use virtual_drive::{DriveDesign, joint_tables};

use crate::can_bus::Logged;

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
    /// Frames that the drive sends within a number of ticks, if it receives some frames, each before the tick after
    /// those that had begun.
    pub fn frames(&self, received: &[Logged], ticks: u32) -> Result<Vec<Frame>, String> {
        match self.maker {
            "moteus" => self.of_maker::<maker::Moteus>(received, ticks),
            "odrive" => self.of_maker::<maker::Odrive>(received, ticks),
            "odrive3" => self.of_maker::<maker::Odrive3>(received, ticks),
            "damiao" => self.of_maker::<maker::Damiao>(received, ticks),
            "cybergear" => self.of_maker::<maker::Cybergear>(received, ticks),
            "robstride" => self.of_maker::<maker::Robstride>(received, ticks),
            "cia402" => self.of_maker::<maker::Cia402>(received, ticks),
            other => Err(format!("no maker is called {other}")),
        }
    }

    fn of_maker<M: Maker>(&self, received: &[Logged], ticks: u32) -> Result<Vec<Frame>, String> {
        match self.joint.parameters.geometry.planets {
            1 => self.run::<M, 1>(received, ticks),
            3 => self.run::<M, 3>(received, ticks),
            4 => self.run::<M, 4>(received, ticks),
            _ => self.run::<M, 5>(received, ticks),
        }
    }

    fn run<M: Maker, const N: usize>(&self, received: &[Logged], ticks: u32) -> Result<Vec<Frame>, String> {
        let JointFile { parameters, surroundings, .. } = self.joint;
        let bandwidth = model_core::compensation::design::good_bandwidth(parameters, surroundings)
            .map_err(|error| error.to_string())?;
        let numbers = DriveDesign::new(parameters, surroundings, bandwidth, true);
        let settings = M::settings(numbers.settings(M::PEAK_CURRENT, M::SUPPLY, true));
        let tables = joint_tables::<N>(parameters, surroundings, &self.processor).map_err(|error| error.to_string())?;
        let (mut joint, mut drive) = (tables.joint(), Drive::new(settings));
        let (mut server, mut power) = (M::server(self.id, &settings), VirtualPower::new(M::SUPPLY));
        let mut sent = Vec::new();
        let mut waiting = received.iter().peekable();
        for begun in 0..ticks {
            while let Some((_, frame)) = waiting.next_if(|(tick, _)| *tick <= begun) {
                server.receive(frame, &mut drive, &mut |frame| sent.push(frame));
            }
            virtual_drive::step(&mut joint, &mut drive, &mut power);
            server.tick(&mut drive, &mut |frame| sent.push(frame));
        }
        Ok(sent)
    }

    /// Compares the frames of an image with the twin's; returns their number. The image's last frames may wait still.
    pub fn compare(&self, handed: &[Logged], received: &[Logged], ticks: u32) -> Result<usize, String> {
        let expected = self.frames(received, ticks)?;
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
