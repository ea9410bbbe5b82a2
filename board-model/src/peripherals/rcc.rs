//! What reset and clock controllers of the three chips share: oscillators that need their time, dividers, reset flags.

use crate::wires::{MICROSECOND, Time, Wires};

/// Times to the ready flags. A crystal takes the longest: 2 ms in all three data sheets.
pub const CRYSTAL_START: Time = 2000 * MICROSECOND;
/// A clock that is fed in is there at once, but for the input stage.
pub const BYPASS_START: Time = 2 * MICROSECOND;
/// The internal oscillator, 4 us at most.
pub const INTERNAL_START: Time = 4 * MICROSECOND;
/// A PLL's lock time: 200 us (F405), less on the others.
pub const PLL_LOCK: Time = 200 * MICROSECOND;

/// Something that is switched on and ready a while later.
#[derive(Debug, Clone, Copy, Default)]
pub struct Source {
    ready_at: Option<Time>,
}

impl Source {
    /// Running since long ago.
    pub const RUNNING: Self = Self { ready_at: Some(0) };

    /// On or off; `None` for a start that never comes to its end.
    pub fn switch(&mut self, on: bool, start: Option<Time>, now: Time) {
        self.ready_at = match (on, self.ready_at) {
            (false, _) => None,
            (true, Some(ready)) => Some(ready),
            (true, None) => start.map(|start| now + start),
        };
    }

    /// Whether it can be used.
    pub fn is_ready(self, now: Time) -> bool {
        self.ready_at.is_some_and(|ready| ready <= now)
    }
}

/// Frequency of the external oscillator and the time to its ready flag, if it comes.
pub fn external(wires: &Wires, bypass: bool) -> Option<(u64, Time)> {
    match bypass {
        true => wires.surroundings.external_clock.map(|rate| (rate, BYPASS_START)),
        false => wires.surroundings.crystal.map(|rate| (rate, CRYSTAL_START)),
    }
}

/// Divider of the bus of the core: RM0090 7.3.3, RM0440 7.4.3, RM0433 8.7.6.
pub fn bus_divider(code: u32) -> u64 {
    match code {
        0..8 => 1,
        8..12 => 2 << (code - 8),
        _ => 64 << (code - 12),
    }
}

/// Divider of a peripheral bus, in the same registers.
pub fn peripheral_divider(code: u32) -> u64 {
    if code < 4 { 1 } else { 2 << (code - 4) }
}

/// Frequencies in megahertz, for messages.
pub fn megahertz(rate: u64) -> String {
    format!("{:.3} MHz", rate as f64 / 1e6)
}

/// Notes a frequency outside of its range.
pub fn within(wires: &mut Wires, register: &str, what: &str, rate: u64, [low, high]: [u64; 2], section: &'static str) {
    if !(low..=high).contains(&rate) {
        let [low, high] = [low, high].map(megahertz);
        let what = format!("{what} is {}: {low} to {high} are allowed", megahertz(rate));
        wires.violation(register, what, section);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dividers_are_those_of_the_manual() {
        assert_eq!([0, 8, 11, 12, 15].map(bus_divider), [1, 2, 16, 64, 512]);
        assert_eq!([0, 4, 5, 7].map(peripheral_divider), [1, 2, 4, 16]);
    }

    #[test]
    fn a_source_that_was_switched_on_is_ready_after_its_time() {
        let mut source = Source::default();
        source.switch(true, Some(5), 10);
        source.switch(true, Some(5), 14);
        assert_eq!([14, 15].map(|now| source.is_ready(now)), [false, true]);
        source.switch(false, Some(5), 20);
        assert!(!source.is_ready(100));
    }
}
