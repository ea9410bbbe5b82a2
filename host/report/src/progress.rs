//! Progress line with the current stage and its advance. If standard error is not a terminal, only the program's own
//! messages are printed.

use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::escape::escaped;
use crate::failure::Outcome;
use crate::interruption;

/// Progress line on the screen; questions are asked above it.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Asks the user for a line of text on the terminal, with the progress line suspended. `None` at the end of input.
pub fn ask(question: &str) -> Option<String> {
    let ask = || {
        let mut stderr = io::stderr().lock();
        let _ = write!(stderr, "{}", escaped(question)).and_then(|()| stderr.flush());
        let mut line = String::new();
        let read = io::stdin().read_line(&mut line).unwrap_or_default();
        (read > 0).then_some(line)
    };
    match shown().clone() {
        Some(bar) => bar.suspend(ask),
        None => ask(),
    }
}

/// A panic in another thread leaves the value consistent.
fn shown() -> MutexGuard<'static, Option<ProgressBar>> {
    SHOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Progress line that any thread may update.
pub struct Progress {
    bar: Mutex<Option<ProgressBar>>,
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// Progress line that shows nothing yet.
    pub fn new() -> Self {
        Self { bar: Mutex::new(None) }
    }

    /// Runs work with a progress line; the user may interrupt it.
    pub fn during<T>(work: impl FnOnce(&Self) -> Outcome<T>) -> Outcome<T> {
        interruption::watch()?;
        let progress = Self::new();
        let outcome = work(&progress);
        progress.clear();
        interruption::explain(outcome)
    }

    /// Shows a stage of unknown length.
    pub fn stage(&self, what: &str) {
        let bar = ProgressBar::new_spinner().with_style(style("{spinner} {prefix}  {wide_msg:.dim}"));
        bar.enable_steady_tick(Duration::from_millis(100));
        self.show(bar, what);
    }

    /// Shows a stage with a number of units: ticks, runs, points.
    pub fn run(&self, what: &str, units: impl Into<u64>) {
        let bar = ProgressBar::new(units.into());
        self.show(bar.with_style(style("{prefix}  {bar:40} {percent:>3} %  {elapsed}, {eta} left")), what);
    }

    /// Sets the number of finished units.
    pub fn set_position(&self, units: u32) {
        if let Some(bar) = &*self.bar() {
            bar.set_position(units.into());
        }
    }

    /// Adds finished units.
    pub fn advance(&self, units: u64) {
        if let Some(bar) = &*self.bar() {
            bar.inc(units);
        }
    }

    /// Prints a line above the progress line, on a terminal only.
    pub fn print_above(&self, line: &str) {
        if let Some(bar) = self.bar().as_ref().filter(|bar| !bar.is_hidden()) {
            bar.println(crate::output::on(&std::io::stderr(), line));
        }
    }

    /// Prints a message of a stage. The program's own messages stay; output of other programs only passes through the
    /// progress line.
    pub fn print_message(&self, line: &str) {
        let line = &*escaped(line);
        let own = line.starts_with(|first: char| first.is_ascii_lowercase()) && !line.starts_with("warning");
        match &*self.bar() {
            Some(bar) if !bar.is_hidden() && own => bar.println(line),
            Some(bar) if !bar.is_hidden() => bar.set_message(line.to_owned()),
            _ if own => crate::output::remark(line),
            _ => {}
        }
    }

    /// Removes the progress line.
    pub fn clear(&self) {
        if let Some(bar) = self.bar().take() {
            bar.finish_and_clear();
            shown().take();
        }
    }

    /// A panic in another thread leaves the line consistent.
    fn bar(&self) -> MutexGuard<'_, Option<ProgressBar>> {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn show(&self, bar: ProgressBar, what: &str) {
        self.clear();
        bar.set_prefix(escaped(what).into_owned());
        *shown() = Some(bar.clone());
        *self.bar() = Some(bar);
    }
}

fn style(template: &str) -> ProgressStyle {
    // The templates are constants of this file; a wrong one would fall back to the default style.
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Position and length of the progress line; `None` without a line.
    fn stands(progress: &Progress) -> Option<(u64, Option<u64>)> {
        progress.bar().as_ref().map(|bar| (bar.position(), bar.length()))
    }

    #[test]
    fn run_counts_units_until_cleared() {
        let progress = Progress::new();
        progress.set_position(3);
        assert_eq!(stands(&progress), None, "nothing is under way yet");
        progress.run("running", 10_u32);
        progress.set_position(5);
        progress.advance(2);
        assert_eq!(stands(&progress), Some((7, Some(10))));
        progress.clear();
        progress.set_position(6);
        assert_eq!(stands(&progress), None);
    }

    #[test]
    fn stage_replaces_previous_stage() {
        let progress = Progress::new();
        progress.run("running", 10_u32);
        progress.set_position(5);
        progress.stage("building");
        assert_eq!(stands(&progress), Some((0, None)), "a stage of unknown length");
        let bar = progress.bar().clone();
        assert_eq!(bar.map(|bar| bar.prefix()), Some("building".to_owned()));
    }

    #[test]
    fn finished_work_leaves_no_line() {
        let left = Progress::during(|progress| {
            progress.run("running", 10_u32);
            Ok(progress.bar().clone())
        });
        assert!(left.ok().flatten().is_some_and(|bar| bar.is_finished()));
    }
}
