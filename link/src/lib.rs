#![cfg_attr(not(test), no_std)]
//! The protocol between a board and its host. `messages` defines the messages, with those of the roles that control in
//! `controller` and `virtual_joint`; `framing` puts them on a byte stream: postcard, then CRC-32, then COBS, each frame
//! ended by a zero byte. `scanner` tells good frames as they go by, before anybody has time for them.

pub mod controller;
pub mod framing;
pub mod messages;
pub mod scanner;
pub mod virtual_joint;

/// Both ends must speak the same version; raised with every change of a message.
pub const PROTOCOL_VERSION: u16 = 12;
