#![no_std]
//! A joint behind a finished drive, one control period at a time, in f32: the role `drive` of the firmware and
//! `joint twin --image` run the same functions, so that equal frames in equal periods have equal answers.
//!
//! [`VirtualDrive`] holds joint, drive, supply and the server of a maker's protocol. In each period the frames that
//! arrived go to the server first, then [`step`] runs joint, drive and supply, then the server sends its cyclic frames.
//! Makers of drives are types of [`maker`]; [`DriveDesign`] holds the numbers of a drive that fits a joint.
//!
//! ```
//! use drives::{Frame, frame::standard};
//! use model_core::VirtualJointDesign;
//! use virtual_drive::maker::Damiao;
//! use virtual_drive::{DriveDesign, VirtualDrive};
//!
//! let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
//! let tables = VirtualJointDesign::<3>::new(&q1, 10_000)?;
//! let design = DriveDesign::new(&q1.parameters, &q1.surroundings, 40.0, true);
//! let mut drive = VirtualDrive::<Damiao, 3>::new(tables.joint(), &design, 1);
//! let mut answers = 0;
//! let enable = Frame::classic(standard(1), &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfc]).unwrap();
//! drive.receive(&enable, &mut |_| answers += 1);
//! drive.step(&mut |_| answers += 1);
//! assert_eq!(answers, 1);
//! # Ok::<(), model_core::gears::design::DesignError>(())
//! ```

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

#[cfg(feature = "design")]
mod design;
pub mod maker;
mod numbers;
mod period;
mod virtual_drive;

#[cfg(feature = "design")]
pub use design::joint_tables;
pub use numbers::DriveDesign;
pub use period::step;
pub use virtual_drive::VirtualDrive;
