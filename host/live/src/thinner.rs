//! Reduction of full-rate samples: a thousand a second, and every sample around a change of contact.
//!
//! A sample leaves `MARGIN` after it came, so that a change of contact can still keep the samples before it.

use std::collections::VecDeque;

use crate::sample::Sample;

/// Samples a second without a change of contact [Hz].
const RATE: f64 = 1000.0;
/// Time before and after a change of contact in which every sample is kept [s].
const MARGIN: f64 = 5e-3;
/// Share of the time that bursts may take in the long run [-]. Teeth that rattle would keep every sample.
const BURST_SHARE: f64 = 0.25;
/// Longest burst after a time without bursts [s].
const MAX_BURST: f64 = 1.0;

/// Least allowance for a new burst [s].
const MIN_BURST: f64 = 0.05;

/// Reduction of the samples of one source.
#[derive(Debug)]
pub struct Thinner {
    waiting: VecDeque<(Sample, bool)>,
    /// Samples of the even rate so far.
    even: u64,
    /// Time of the first and of the last sample [s].
    first: Option<f64>,
    last: f64,
    burst_end: f64,
    /// Time that bursts may still take [s].
    allowance: f64,
}

impl Default for Thinner {
    fn default() -> Self {
        Self {
            waiting: VecDeque::new(),
            even: 0,
            first: None,
            last: 0.0,
            burst_end: f64::NEG_INFINITY,
            allowance: MAX_BURST,
        }
    }
}

impl Thinner {
    /// Takes a sample; appends the samples that are due to `kept`.
    pub fn push(&mut self, sample: Sample, kept: &mut Vec<Sample>) {
        let first = *self.first.get_or_insert(sample.time);
        let step = (sample.time - self.last).clamp(0.0, MARGIN);
        self.last = sample.time;
        self.allowance = (self.allowance + BURST_SHARE * step).min(MAX_BURST);
        let changes =
            self.waiting.back().is_some_and(|(before, _)| before.meshes.contacts() != sample.meshes.contacts());
        let is_new = sample.time > self.burst_end;
        if changes && self.allowance > if is_new { MIN_BURST } else { 0.0 } {
            self.burst_end = sample.time + MARGIN;
            self.waiting.iter_mut().for_each(|(_, is_kept)| *is_kept = true);
            // The samples before the change are part of the burst.
            self.allowance -= if is_new { MARGIN } else { 0.0 };
        }
        let is_in_burst = sample.time <= self.burst_end;
        if is_in_burst {
            self.allowance -= step;
        }
        // A millionth of a period covers the rounding of the time.
        let is_due = (sample.time - first) * RATE >= self.even as f64 - 1e-6;
        if is_due {
            self.even = ((sample.time - first) * RATE + 1e-6).max(0.0) as u64 + 1;
        }
        self.waiting.push_back((sample, is_in_burst || is_due));
        while self.waiting.front().is_some_and(|(oldest, _)| oldest.time + MARGIN < sample.time) {
            kept.extend(self.waiting.pop_front().filter(|(_, is_kept)| *is_kept).map(|(oldest, _)| oldest));
        }
    }

    /// Appends all samples that still wait to `kept`, at the end of a run.
    pub fn finish(&mut self, kept: &mut Vec<Sample>) {
        kept.extend(self.waiting.drain(..).filter(|(_, is_kept)| *is_kept).map(|(sample, _)| sample));
    }
}

#[cfg(test)]
mod tests {
    use parameters::ContactState;

    use super::*;

    /// Samples at 20 kHz whose only mesh is on the drive flank while `touches` holds.
    fn thin(duration: f64, touches: impl Fn(f64) -> bool) -> Vec<f64> {
        let (mut thinner, mut kept) = (Thinner::default(), Vec::new());
        for tick in 0..(duration * 20e3) as u32 {
            let mut sample = Sample::at(f64::from(tick) / 20e3);
            let contact = if touches(sample.time) { ContactState::DriveSide } else { ContactState::Separated };
            sample.meshes.add(contact, 0.0);
            thinner.push(sample, &mut kept);
        }
        thinner.finish(&mut kept);
        let times: Vec<f64> = kept.iter().map(|sample| sample.time).collect();
        assert!(times.is_sorted(), "{times:?}");
        times
    }

    fn count(times: &[f64], from: f64, to: f64) -> usize {
        times.iter().filter(|time| (from..to).contains(*time)).count()
    }

    #[test]
    fn steady_contact_leaves_one_kilohertz() {
        let times = thin(2.0, |_| true);
        assert_eq!(times.len(), 2000);
        assert!((times[1500] - 1.5).abs() < 1e-9, "{}", times[1500]);
    }

    #[test]
    fn change_of_contact_keeps_full_rate() {
        let times = thin(1.0, |time| time < 0.5);
        assert_eq!(count(&times, 0.496, 0.504), 160);
        assert_eq!(count(&times, 0.1, 0.2), 100);
        assert_eq!(count(&times, 0.6, 0.7), 100);
    }

    #[test]
    fn rattling_teeth_have_a_share() {
        let times = thin(20.0, |time| ((time * 2000.0) as u64).is_multiple_of(2));
        let share = count(&times, 5.0, 20.0) as f64 / (15.0 * 20e3);
        assert!((0.2..0.35).contains(&share), "{share}");
        assert!(count(&times, 0.0, 0.5) > 9_900, "the first second is whole");
    }
}
