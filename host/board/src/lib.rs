//! A board as the host sees it: build its firmware image (`device`), start the emulator or open the port
//! (`connection`), talk to it over the line (`transport`, `session`), and drive it through a torque profile
//! (`profile`). Received messages are kept raw (`recording`, `logs`); `twin` computes the same run on the host and
//! compares it bit for bit. Verdicts on a run are made in `joint-run`.

pub mod connection;
pub mod device;
pub mod line_options;
pub mod logs;
pub mod profile;
pub mod recording;
pub mod session;
pub mod transport;
pub mod trip;
pub mod twin;
