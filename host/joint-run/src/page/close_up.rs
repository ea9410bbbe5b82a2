//! Close-up of the first reversal through the gap, where the teeth leave one flank and land on the other. Drawn at
//! every tick if the record has them, otherwise from the samples.

use super::motion::View;
use crate::record::{RunRecord, Samples};
use report::plot::Figure;
use report::plot::unit::Unit;

/// Least samples of a picture.
const SAMPLES_MIN: usize = 12;
/// Shortest time shown before and after the crossing [s].
const MARGIN_MIN: f64 = 4e-3;
/// Longest time shown before and after the crossing [s].
const MARGIN_MAX: f64 = 40e-3;

/// Start and end [s] around the first full crossing of the band, if there is one.
pub fn crossing(samples: &Samples, band: [f64; 2]) -> Option<(f64, f64)> {
    let side = |gap: f32| {
        let gap = f64::from(gap);
        i8::from(gap > band[1]) - i8::from(gap < band[0])
    };
    let mut left: Option<(i8, usize)> = None;
    for (index, &gap) in samples.gap_m.iter().enumerate() {
        match (side(gap), left) {
            (0, _) => {}
            (now, Some((before, last))) if now != before => {
                let (from, to) = (samples.time_s[last], samples.time_s[index]);
                let margin = (to - from).clamp(MARGIN_MIN, MARGIN_MAX);
                return Some(((from - margin).max(0.0), to + 2.0 * margin));
            }
            (now, _) => left = Some((now, index)),
        }
    }
    None
}

/// View of the close-up at every tick, or of the samples around the first crossing.
pub fn view(record: &RunRecord) -> Option<View<'_>> {
    let (samples, range) = match &record.close_up {
        Some(close_up) if close_up.samples.len() >= SAMPLES_MIN => {
            let times = &close_up.samples.time_s;
            (&close_up.samples, (times[0], times[times.len() - 1]))
        }
        _ => (&record.samples, crossing(&record.samples, record.joint.gap_band_m)?),
    };
    let inside = samples.time_s.iter().filter(|time| (range.0..=range.1).contains(*time)).count();
    let unit = Unit::of_time(range.1 - range.0);
    (inside >= SAMPLES_MIN && range.1 > range.0).then_some(View { record, samples, range, unit })
}

/// Torque, gap, deflections and contact in one picture.
pub fn figure(view: &View<'_>) -> Figure {
    let mut panels = view.torques();
    panels.truncate(1);
    panels.push(view.gap());
    panels.extend(view.deflections());
    view.figure("A reversal through the gap", panels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(gap: impl Iterator<Item = f32>) -> Samples {
        let gap_m: Vec<f32> = gap.collect();
        let time_s = (0..gap_m.len()).map(|index| index as f64 * 1e-3).collect();
        Samples { gap_m, time_s, ..Samples::default() }
    }

    #[test]
    fn crossing_spans_flank_to_flank() {
        let ramp = samples((0..200).map(|i| 2e-4 - 2e-6 * i as f32));
        let (from, to) = crossing(&ramp, [-8e-5, 8e-5]).expect("the ramp crosses");
        assert!(from < 0.060 && to > 0.140, "{from} to {to}");
    }

    #[test]
    fn return_to_flank_is_no_crossing() {
        let dip = samples((0..200).map(|i| 1e-6 * (i as f32 - 100.0).abs()));
        assert_eq!(crossing(&dip, [-8e-5, 8e-5]), None);
    }
}
