#![no_std]
//! A joint behind a finished drive, one control period at a time, in f32: the role `drive` of the firmware and
//! `joint twin --image` run the same functions, so that equal frames in equal periods have equal answers.
//!
//! In each period the frames that arrived go to the drive's server first, then [`step`] runs joint, drive and supply,
//! then the server's own `tick` sends cyclic frames. Makers of drives are types of [`maker`]; [`DriveDesign`] holds the
//! numbers of a drive that fits a joint.
//!
//! ```
//! use drives::bus::CanServer;
//! use drives::drive::VirtualPower;
//! use drives::{Drive, Frame, frame::standard};
//! use model_core::VirtualJointDesign;
//! use virtual_drive::maker::{Damiao, Maker};
//! use virtual_drive::{DriveDesign, step};
//!
//! let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
//! let tables = VirtualJointDesign::<3>::new(&q1, 10_000)?;
//! let numbers = DriveDesign::new(&q1.parameters, &q1.surroundings, 40.0, true);
//! let settings = Damiao::settings(numbers.settings(Damiao::PEAK_CURRENT, Damiao::SUPPLY, true));
//! let (mut joint, mut power) = (tables.joint(), VirtualPower::new(Damiao::SUPPLY));
//! let (mut drive, mut server) = (Drive::new(settings), Damiao::server(1, &settings));
//! let mut answers = 0;
//! let enable = Frame::classic(standard(1), &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc]).unwrap();
//! server.receive(&enable, &mut drive, &mut |_| answers += 1);
//! step(&mut joint, &mut drive, &mut power);
//! server.tick(&mut drive, &mut |_| answers += 1);
//! assert_eq!(answers, 1);
//! # Ok::<(), model_core::gears::design::DesignError>(())
//! ```

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

#[cfg(feature = "design")]
mod design;
pub mod maker;
mod numbers;
mod period;

#[cfg(feature = "design")]
pub use design::joint_tables;
pub use numbers::DriveDesign;
pub use period::step;
