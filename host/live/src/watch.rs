//! Limit of a run on the clock beside a live view.

use std::time::{Duration, Instant};

use crate::feed::Feed;
use crate::source::Description;
use crate::view::Live;

/// Limit of a run on the clock, and the live view that may show the run.
#[derive(Clone, Copy)]
pub struct Watch<'l> {
    deadline: Instant,
    live: Option<&'l Live>,
    /// Time that runs had waited for the live view when the deadline was set.
    waited_before: Duration,
    name: Option<&'l str>,
}

impl<'l> Watch<'l> {
    /// Watch without a live view.
    pub fn until(deadline: Instant) -> Self {
        Self { deadline, live: None, waited_before: Duration::ZERO, name: None }
    }

    /// Watch with a live view. The view does not show the run, whose waits for the view extend the limit.
    #[must_use]
    pub fn beside(self, live: Option<&'l Live>) -> Self {
        Self { live, ..self }.extended_to(self.deadline)
    }

    /// Watch whose live view shows the run under a name, unless the view shows another run; `None` does not show it.
    #[must_use]
    pub fn named(self, name: Option<&'l str>) -> Self {
        Self { name, ..self }
    }

    /// Watch with another deadline, set now.
    #[must_use]
    pub fn extended_to(self, deadline: Instant) -> Self {
        Self { deadline, waited_before: self.waited(), ..self }
    }

    fn waited(&self) -> Duration {
        self.live.map_or(Duration::ZERO, Live::waited)
    }

    /// True after the deadline. The time that runs have waited for the live view since the deadline was set extends it.
    pub fn is_over(&self) -> bool {
        let waited = self.waited().saturating_sub(self.waited_before);
        Instant::now().checked_sub(waited).is_some_and(|now| now > self.deadline)
    }

    /// Feed of the run, if the view shows it. `describe` makes its description from its name.
    pub fn claim(&self, describe: impl FnOnce(&str) -> Description) -> Option<Feed> {
        self.live?.claim(describe(self.name?))
    }
}
