//! `--live`: shows a run while it goes on, in a browser, in Foxglove and in PlotJuggler.
//!
//! A run publishes a [`Sample`] of every control period through its [`Feed`], a bounded channel that never blocks.
//! [`Pace`] makes a run follow the clock. The `hub` thread reduces the samples (`thinner`) and passes them on: `udp` to
//! PlotJuggler, and a bounded queue to each viewer. `server` accepts viewers after the checks of `request`; `viewer`
//! serves one of them, as the page or as Foxglove. A viewer that does not read loses samples, and is disconnected in the
//! end.

mod feed;
mod hub;
mod options;
mod pace;
mod request;
mod sample;
mod server;
mod shared;
mod source;
mod thinner;
mod udp;
mod view;
mod viewer;
mod watch;

pub use feed::Feed;
pub use options::{LiveOptions, PacedLiveOptions};
pub use pace::{Pace, parse_speed};
pub use sample::Sample;
pub use shared::Commands;
pub use source::Description;
pub use view::Live;
pub use watch::Watch;
