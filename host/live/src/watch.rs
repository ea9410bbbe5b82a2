//! Limit of a run on the clock beside a live view.

use std::time::{Duration, Instant};

use crate::feed::Feed;
use crate::source::Description;
use crate::view::Live;

/// Limit of a run on the clock, and the live view that it may show itself in.
#[derive(Clone, Copy)]
pub struct Watch<'l> {
    deadline: Instant,
    live: Option<&'l Live>,
    name: Option<&'l str>,
}

impl<'l> Watch<'l> {
    /// Watch without a live view.
    pub fn until(deadline: Instant) -> Self {
        Self { deadline, live: None, name: None }
    }

    /// Watch beside a live view, without showing the run.
    #[must_use]
    pub fn beside(self, live: Option<&'l Live>) -> Self {
        Self { live, ..self }
    }

    /// Watch that shows the run under a name, unless another run shows itself.
    #[must_use]
    pub fn named(self, name: Option<&'l str>) -> Self {
        Self { name, ..self }
    }

    /// Watch with another deadline.
    #[must_use]
    pub fn extended_to(self, deadline: Instant) -> Self {
        Self { deadline, ..self }
    }

    /// True after the deadline; time that runs have waited for the live view does not count.
    pub fn is_over(&self) -> bool {
        let waited = self.live.map_or(Duration::ZERO, Live::waited);
        Instant::now().checked_sub(waited).is_some_and(|now| now > self.deadline)
    }

    /// Feed of the run, if it shows itself. `describe` makes its description from its name.
    pub fn claim(&self, describe: impl FnOnce(&str) -> Description) -> Option<Feed> {
        self.live?.claim(describe(self.name?))
    }
}
