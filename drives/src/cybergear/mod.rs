//! Xiaomi CyberGear and RobStride drives: CAN at 1 Mbit/s, classical frames with 29-bit identifiers.
//!
//! Identifier: type in bits 28 to 24, data in bits 23 to 8, target address in bits 7 to 0. A host writes its own
//! address into bits 15 to 8, a drive answers with its address there and the host's address as the target.
//!
//! | type | direction | identifier data | bytes |
//! |---|---|---|---|
//! | 0 identify | to drive; answered to 0xFE | host; drive | unique identifier (8) |
//! | 1 operation | to drive | torque | angle, speed, kp, kd: 16 bits each, high byte first |
//! | 2 feedback | from drive | state (2), faults (6), drive (8) | angle, speed, torque, temperature x 10 [deg C] |
//! | 3 enable, 4 stop | to drive; answered by 2 | host | stop: 1 in byte 0 clears a fault |
//! | 5 calibrate | to drive, result from drive | host; drive | result: electrical offset, f32 [rad] |
//! | 6 set zero | to drive; answered by 2 | host | 1 |
//! | 7 set address | to drive; answered by 0 | new address (8), host (8) | - |
//! | 17 read | to drive and back | host; failure (8), drive (8) | index (2), 0 (2), value (4), low byte first |
//! | 18 write | to drive; answered by 2 | host | index (2), 0 (2), value (4), low byte first |
//! | 21 fault | from drive | host (CyberGear), drive (RobStride) | faults (4), warnings (4), low byte first |
//! | 22 bit rate (CyberGear) | to drive; answered by 0 | host | code |
//! | 22 save (RobStride) | to drive; answered by 2 | host | 1 to 8 |
//! | 23 bit rate, 25 protocol (RobStride) | to drive; answered by 0 | host | 1 to 6, code |
//! | 24 report (RobStride) | to drive; answered and repeated | host; as type 2 | 1 to 6, 1 or 0; as type 2 |
//!
//! Units: rad, rad/s and N m at the output, A of the winding. The current times torque constant and ratio is the torque
//! at the output. Sign convention of this crate: a positive torque accelerates a positive turn.
//!
//! Laws of the run modes:
//!
//! - operation (0): torque = kp (angle set - angle) + kd (speed set - speed) + torque set;
//! - position, CyberGear (1), and cyclic position, RobStride (5): speed reference = `loc_kp` (`loc_ref` - angle) within
//!   `limit_spd`, current = PI of the speed error within `limit_cur`;
//! - profile position, RobStride (1): as above behind a trapezoid of `vel_max` and `acc_set`;
//! - speed (2): PI of `spd_ref` - speed within `limit_cur`, on RobStride behind a ramp of `acc_rad`;
//! - current (3): `iq_ref`.
//!
//! Encoders: `encoderRaw` and `modPos` are the rotor's encoder. `mechPos` is the output's angle by the rotor's encoder:
//! `mechPos` = (2 pi `rotation` + `modPos` - `MechOffset`) / ratio; the sample values of both makers' tables agree with
//! this equation. `encoder2raw` and `chasu_angle_out` are the second encoder, here the encoder of the output.
//! CyberGear has no second encoder; RS01 has no documented index for it.
//!
//! Documents: CyberGear micromotor instruction manual (English translation at github.com/belovictor/cybergear-docs),
//! sections 3.3.3 and 4; RobStride RS00 to RS06 User Manual, editions 260428, sections 3.3.5 (tables), 4.1 to 4.3
//! (github.com/RobStride/Product_Information). Type 5 is in no manual; it follows python-cybergear 0.1.2.
//!
//! Interpretations, where the manuals are silent:
//!
//! - `spd_ki` is added each 50 us, the tick of the timeout. The integral gain per second is 20 000 times `spd_ki`.
//! - A run mode cannot be changed while the drive is enabled (manuals: stop first); such a write is ignored.
//! - Values out of their range are limited to it; NaN is ignored.
//! - Until a client writes `loc_ref`, an enabled drive holds its present angle. A stop forgets all references.
//! - The reset after a timeout is no fault: the drive can be enabled again at once.
//! - Faults that the makers do not have (speed, travel, stop, command) are reported as a fault of the driver chip.
//! - CyberGear's fault frame carries the host's address in bits 15 to 8, as its manual says.
//! - The factory gains belong to the makers' motors; those of [`crate::Settings`] stay until a client writes others.
//!
//! Known limits of this implementation:
//!
//! - Bit rate, protocol switch and saving are answered without an effect; nothing outlives [`Server`].
//! - `zero_sta`, `damper`, `add_offset`, the current loop's gains and `spd_filt_gain` are stored and read back only.
//! - Writable are the parameters that [`Parameter`] marks so. `rotation` and `GearRatio`, writable by the manual, are
//!   read-only; other rows of the tables are missing.
//! - Not implemented: version frames, upload of the whole table (types 19, 20), CANopen and MIT frames of RobStride,
//!   CyberGear's undocumented run modes 4 and 7.

mod answer;
pub mod client;
mod defaults;
mod faults;
mod model;
mod parameter;
mod registers;
mod request;
mod server;
mod wire;

pub use answer::{Answer, Feedback, Mode};
pub use defaults::settings;
pub use faults::Flags;
pub use model::{Model, Sheet};
pub use parameter::{Kind, Parameter, Value};
pub use registers::RunMode;
pub use request::{Command, Operation, Request};
pub use server::Server;
pub use wire::Field;

#[cfg(test)]
mod tests;
