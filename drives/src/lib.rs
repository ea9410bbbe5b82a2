#![no_std]
//! Motor drives as their clients see them. A [`drive::Drive`] reads encoders, supervises and controls one motor; a
//! protocol module translates between its maker's frames and this drive. Runs in f32 without allocation or panic.
//!
//! | module | drive and bus | document |
//! |---|---|---|
//! | [`cia402`] | CiA 402 servo drives on CANopen | CiA 301, CiA 402-2 (IEC 61800-7-201) |
//! | [`cybergear`] | Xiaomi CyberGear, RobStride; CAN, 29-bit identifiers | CyberGear instruction manual; RobStride 04 manual |
//! | [`damiao`] | MIT frame of Damiao drives; CAN | DM-J4310-2EC V1.1 user manual |
//! | [`feetech`] | Feetech STS and SMS; serial | Feetech STS/SMS communication protocol manual |
//! | [`moteus`] | moteus; CAN FD | moteus reference, register protocol |
//! | [`odrive`] | ODrive, CANSimple; CAN | ODrive CAN protocol, CANSimple DBC |
//!
//! Each protocol works both ways: its `Server` is a drive on the bus, its `client` functions encode the frames that
//! command such a drive and decode the answers.
//!
//! Sign convention: motor and output turn in the same direction for a positive ratio; a positive torque accelerates a
//! positive turn.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

#[cfg(test)]
extern crate std;

pub mod bus;
pub mod cia402;
pub mod cybergear;
pub mod damiao;
pub mod drive;
pub mod feetech;
pub mod frame;
pub mod moteus;
pub mod odrive;
pub mod scale;
pub mod turns;
pub mod value;

pub use drive::{Drive, Settings};
pub use frame::Frame;
pub use turns::Turns;
