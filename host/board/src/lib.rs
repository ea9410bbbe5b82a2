//! A board as the host sees it: its image is built for it (`target`), it is found in the emulator or behind a port
//! (`bench`), talked to over a line (`transport`, `session`) and made to follow a torque profile (`profile`); what was
//! heard is kept (`recording`, `logs`), and the same run is computed here, bit for bit (`twin`). What a run is worth is
//! judged elsewhere.

pub mod bench;
pub mod line_options;
pub mod logs;
pub mod profile;
pub mod recording;
pub mod session;
pub mod target;
pub mod transport;
pub mod trip;
pub mod twin;
