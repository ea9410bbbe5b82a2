#![cfg_attr(not(test), no_std)]
//! Protocol between a board and its host. `messages` defines the messages, `controller` and `virtual_joint` the
//! messages of the roles that control; `framing` encodes them for a byte stream: postcard, CRC-32, COBS, a closing zero
//! byte. `scanner` detects good frames as their bytes pass, before the message is decoded.

pub mod controller;
pub mod framing;
pub mod messages;
pub mod scanner;
pub mod virtual_joint;

/// Protocol version, equal on both sides; raised with every change of a message.
pub const PROTOCOL_VERSION: u16 = 12;
