//! A board as seen from the host: its firmware image is built (`device`), the emulator started or the port opened
//! (`connection`), messages exchanged over the line (`transport`, `session`), and a torque profile run (`profile`).
//! Received messages are kept raw (`recording`, `logs`); `twin` computes the same run on the host and compares it bit
//! for bit. Verdicts on a run are made in `joint-run`.

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
