//! STM32F405, STM32G474 and STM32H743 at register level, written from their reference manuals and not from the
//! firmware: runs the images that ship, and records every violation of a rule.

pub mod as5047p;
pub mod blocks;
pub mod boards;
pub mod can_bus;
pub mod can_twin;
pub mod checks;
pub mod chips;
pub mod cpu;
pub mod image;
pub mod images;
pub mod known;
pub mod machine;
pub mod peripherals;
pub mod planted;
pub mod port;
pub mod register;
pub mod scs;
pub mod talk;
pub mod tamper;
pub mod violation;
pub mod wires;
