//! One set of figures for present and candidate, from the same code.

use crate::runs::{Recording, Said, Stands, Step, Truth, What};

/// A width counts as right within this part.
const WIDTH_RIGHT: f64 = 0.05;
/// No side is judged within this part of the gap from an edge, or with less than this part of the rated force.
const BAND: f64 = 0.05;
/// Slower links do not count as moving [rad/s].
const MOVING: f64 = 1e-3;
/// 95 of 100 values lie within so many standard deviations.
const REACH: f64 = 1.96;
/// What a width's variance is taken every so often for: its errors are the same from period to period [s].
const WIDTH_EVERY: f64 = 0.1;
/// An encoder that was given up for a fault may stay so for this time after it; longer is an alarm of its own [s].
const AFTER: f64 = 2.0;

/// Figures of one run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures {
    /// Length of the run [s].
    pub seconds: f64,
    /// Periods after settling, and of those in which the gap was valid.
    pub periods: f64,
    /// See above.
    pub valid: f64,
    /// Sum of squared gap errors over the gap.
    pub gap: f64,
    /// The same while valid.
    pub gap_valid: f64,
    /// The largest, over the gap.
    pub worst: f64,
    /// The same while valid.
    pub worst_valid: f64,
    /// Sum of normalised squared errors while valid.
    pub nees: f64,
    /// Periods while valid whose truth lies within the 95 % interval.
    pub within: f64,
    /// Periods in which a side was judged, and those in which it was right.
    pub judged: f64,
    /// See above.
    pub right: f64,
    /// Periods in which the side was right of all, however light the force.
    pub right_of_all: f64,
    /// Landings on the other flank.
    pub landings: usize,
    /// Those that were not reported before the teeth had gone on to the next flank.
    pub missed: usize,
    /// When the others were reported after they happened [s].
    pub delays: Vec<f64>,
    /// Contact in motion until the width was right for good [s].
    pub width_after: f64,
    /// Error of the width at the end, over the width.
    pub width_error: f64,
    /// Squared errors of the width over their variance while valid, one every so often.
    pub width_nees: Vec<f64>,
    /// Share of time for which the width was said to be known.
    pub width_valid: f64,
    /// Encoders given up with nothing wrong.
    pub false_alarms: usize,
    /// The encoder given up that was not at fault, while one was.
    pub wrong_blame: usize,
    /// Faults that had to be found, and after how long they were [s].
    pub faults: usize,
    /// See above.
    pub found: Vec<f64>,
}

/// Scores what an estimator said in each step of a recording.
pub fn score(recording: &Recording, said: impl Iterator<Item = Said>) -> Figures {
    let mut figures = Figures::default();
    let mut landings = Landings::default();
    let mut alarms = Alarms::new(recording);
    let mut contact = 0.0;
    let mut next_width = 0.0;
    let mut before = 0.0;
    for (Step { truth, .. }, said) in recording.steps.iter().zip(said) {
        let period = truth.time - before;
        before = truth.time;
        figures.seconds = truth.time;
        let half_gap = 2.0 * truth.half_backlash;
        if truth.gap.abs() > (1.0 - BAND) * half_gap && truth.link_speed.abs() > MOVING {
            contact += period;
        }
        let width = said.width / truth.half_backlash - 1.0;
        if width.is_nan() || width.abs() > WIDTH_RIGHT {
            figures.width_after = contact;
        }
        figures.width_error = width.abs();
        alarms.note(truth.time, said.stands, &mut figures);
        if truth.time < recording.settle {
            continue;
        }
        note_gap(&mut figures, truth, &said);
        if said.width_valid && truth.time >= next_width {
            next_width = truth.time + WIDTH_EVERY;
            let error = said.width - truth.half_backlash;
            figures.width_nees.push(error * error / said.width_variance.max(1e-30));
        }
        figures.width_valid += f64::from(u8::from(said.width_valid));
        let force = truth.force * recording.per_rated;
        let side = if force > 0.0 { 1 } else if force < 0.0 { -1 } else { 0 };
        figures.right_of_all += f64::from(u8::from(side == said.side));
        let place = truth.gap.abs() / half_gap;
        if if side == 0 { place < 1.0 - 2.0 * BAND } else { force.abs() > BAND } {
            figures.judged += 1.0;
            figures.right += f64::from(u8::from(side == said.side));
        }
        landings.note(truth.time, if place > 1.0 { side } else { 0 }, said.side);
    }
    figures.faults = recording.wrongs.iter().filter(|wrong| wrong.must).count();
    figures.landings = landings.all;
    figures.missed = landings.missed;
    figures.delays = landings.delays;
    figures
}

fn note_gap(figures: &mut Figures, truth: &Truth, said: &Said) {
    let gap = 4.0 * truth.half_backlash;
    let error = said.gap - truth.gap;
    let part = error / gap;
    figures.periods += 1.0;
    figures.gap += part * part;
    figures.worst = figures.worst.max(part.abs());
    if said.gap_valid {
        let normalised = error * error / said.gap_variance.max(1e-30);
        figures.valid += 1.0;
        figures.gap_valid += part * part;
        figures.worst_valid = figures.worst_valid.max(part.abs());
        figures.nees += normalised;
        figures.within += f64::from(u8::from(normalised < REACH * REACH));
    }
}

/// Landings on the flank opposite to the last one, and when they were reported.
#[derive(Default)]
struct Landings {
    before: i8,
    open: Option<(f64, i8)>,
    delays: Vec<f64>,
    all: usize,
    missed: usize,
}

impl Landings {
    fn note(&mut self, time: f64, side: i8, reported: i8) {
        if side != 0 && side != self.before {
            if self.before != 0 {
                self.all += 1;
                self.missed += usize::from(self.open.is_some());
                self.open = Some((time, side));
            }
            self.before = side;
        }
        if let Some((since, side)) = self.open
            && reported == side
        {
            self.delays.push(time - since);
            self.open = None;
        }
    }
}

/// Encoders given up, rightly or not.
struct Alarms<'r> {
    recording: &'r Recording,
    before: Stands,
    found: Vec<bool>,
}

impl<'r> Alarms<'r> {
    fn new(recording: &'r Recording) -> Self {
        Self { recording, before: Stands::Both, found: vec![false; recording.wrongs.len()] }
    }

    fn note(&mut self, time: f64, stands: Stands, figures: &mut Figures) {
        let blamed = match stands {
            Stands::Both => None,
            Stands::MotorOnly => Some(What::Output),
            Stands::Nothing => Some(What::Motor),
        };
        // The motor is silent before the first reading.
        let begins = stands != self.before && time > 0.01;
        self.before = stands;
        let wrongs = &self.recording.wrongs;
        for (index, wrong) in wrongs.iter().enumerate() {
            if wrong.must && time >= wrong.start && !self.found[index] {
                if blamed == Some(wrong.what) && time < wrong.end {
                    self.found[index] = true;
                    figures.found.push(time - wrong.start);
                }
            }
        }
        let Some(blamed) = blamed.filter(|_| begins) else { return };
        let mut on = wrongs.iter().filter(|wrong| time >= wrong.start && time < wrong.end + AFTER).peekable();
        if on.peek().is_none() {
            figures.false_alarms += 1;
        } else if !on.any(|wrong| wrong.what == blamed) {
            figures.wrong_blame += 1;
        }
    }
}

/// Figures of several runs as one line's cells.
pub fn cells(all: &[Figures]) -> Vec<String> {
    let sum = |of: &dyn Fn(&Figures) -> f64| all.iter().map(of).sum::<f64>();
    let most = |of: &dyn Fn(&Figures) -> f64| all.iter().map(of).fold(0.0, f64::max);
    let rms = |squares: f64, count: f64| 100.0 * (squares / count).sqrt();
    let mut delays: Vec<f64> = all.iter().flat_map(|one| one.delays.iter().copied()).collect();
    delays.sort_by(f64::total_cmp);
    let part = |part: f64| {
        delays.get((part * delays.len() as f64) as usize).map_or("-".to_owned(), |late| format!("{:.1}", 1e3 * late))
    };
    let mut widths: Vec<f64> = all.iter().map(|one| 100.0 * one.width_error).collect();
    widths.sort_by(f64::total_cmp);
    let mut after: Vec<f64> = all.iter().map(|one| one.width_after).collect();
    after.sort_by(f64::total_cmp);
    let median = |of: &[f64]| of.get(of.len() / 2).copied().unwrap_or(f64::NAN);
    let width_nees: Vec<f64> = all.iter().flat_map(|one| one.width_nees.iter().copied()).collect();
    let mut found: Vec<f64> = all.iter().flat_map(|one| one.found.iter().copied()).collect();
    found.sort_by(f64::total_cmp);
    let faults = sum(&|one| one.faults as f64);
    let valid = sum(&|one| one.valid);
    vec![
        format!("{:.2}", 100.0 * sum(&|one| one.right) / sum(&|one| one.judged)),
        format!("{:.2}", 100.0 * sum(&|one| one.right_of_all) / sum(&|one| one.periods)),
        format!("{:.2}", rms(sum(&|one| one.gap), sum(&|one| one.periods))),
        format!("{:.0}", 100.0 * most(&|one| one.worst)),
        format!("{:.2}", rms(sum(&|one| one.gap_valid), valid)),
        format!("{:.0}", 100.0 * most(&|one| one.worst_valid)),
        format!("{:.1}", 100.0 * valid / sum(&|one| one.periods)),
        format!("{}/{}", sum(&|one| one.missed as f64), sum(&|one| one.landings as f64)),
        format!("{} {}", part(0.5), part(0.95)),
        format!("{:.2} {:.2}", median(&after), after.last().copied().unwrap_or(f64::NAN)),
        format!("{:.1} {:.1}", median(&widths), widths.last().copied().unwrap_or(f64::NAN)),
        format!("{:.1}", 100.0 * sum(&|one| one.within) / valid),
        format!("{:.1}", sum(&|one| one.nees) / valid),
        format!("{:.1}", width_nees.iter().sum::<f64>() / width_nees.len() as f64),
        format!(
            "{}+{} in {:.0} s",
            sum(&|one| one.false_alarms as f64),
            sum(&|one| one.wrong_blame as f64),
            sum(&|one| one.seconds)
        ),
        if faults > 0.0 {
            let late = |index: usize| found.get(index).map_or("-".to_owned(), |late| format!("{:.1}", 1e3 * late));
            format!("{}/{faults} {} {}", found.len(), late(found.len() / 2), late(found.len().wrapping_sub(1)))
        } else {
            String::new()
        },
    ]
}

/// What the cells are.
pub const HEADS: [&str; 16] = [
    "side %", "of all", "gap rms", "worst", "rms v", "worst v", "valid %", "missed", "late ms 50 95", "width s 50 max",
    "width % 50 max", "in 95 %", "NEES", "w NEES", "alarms", "found",
];
