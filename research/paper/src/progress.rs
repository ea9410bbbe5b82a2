//! The line that says how far a study is. On anything but a terminal there is none.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The line; any thread may move it on.
pub struct Progress {
    bar: ProgressBar,
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// Nothing is shown yet.
    pub fn new() -> Self {
        Self { bar: ProgressBar::hidden() }
    }

    /// A stage begins that goes through so many units of work.
    pub fn run(&self, what: &'static str, units: u64) {
        // The template is a constant of this file; were it unreadable, the plain style would do.
        let style = ProgressStyle::with_template("{prefix}  {bar:40} {percent:>3} %  {elapsed}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        self.bar.set_style(style);
        self.bar.set_prefix(what);
        self.bar.set_length(units);
        self.bar.set_position(0);
        self.bar.set_draw_target(ProgressDrawTarget::stderr());
    }

    /// So many more units are done.
    pub fn done(&self, units: u64) {
        self.bar.inc(units);
    }

    /// Nothing is under way any more.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
