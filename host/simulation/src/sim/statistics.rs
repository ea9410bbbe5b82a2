//! Figures of a motion, accumulated tick by tick: contact shares, impacts, ranges of the deflections, mesh forces and
//! Poincare points. Events between two ticks are not seen.

use parameters::ContactState;

use super::snapshot::{MeshSnapshot, Snapshot};

/// Largest number of stored points; a longer run keeps the last ones.
const MAX_POINCARE_POINTS: usize = 2000;
/// Longest period that is searched for [mesh periods].
const LONGEST_PERIOD: usize = 32;
/// Distance below which Poincare points count as equal, over the range of the motion [-].
const POINT_TOLERANCE: f64 = 1e-3;

/// Sums of one mesh over ticks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeshSums {
    drive_side: u64,
    back_side: u64,
    landings: u64,
    sum: f64,
    square: f64,
    least: f64,
    greatest: f64,
    peak_force: f64,
    touched: Option<ContactState>,
}

/// Figures of one mesh.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "N is written N")]
pub struct MeshStatistics {
    /// Share of time on the drive side [-].
    pub drive_side_share: f64,
    /// Share of time with teeth separated [-].
    pub separated_share: f64,
    /// Share of time on the back side [-].
    pub back_side_share: f64,
    /// Landings on either flank in a second.
    pub impacts_per_s: f64,
    /// Mean deflection [m].
    pub deflection_mean_m: f64,
    /// Root mean square of the deflection about its mean [m].
    pub deflection_rms_m: f64,
    /// Greatest minus least deflection [m].
    pub deflection_peak_to_peak_m: f64,
    /// Greatest magnitude of the mesh force [N].
    pub peak_force_N: f64,
}

/// A Poincare point: the motion when the mesh phase passes a whole period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoincarePoint {
    /// Sun-planet deflection of planet 1 [m].
    pub deflection: f64,
    /// Deflection rate [m/s].
    pub rate: f64,
    /// Gap coordinate [m].
    pub gap: f64,
    /// Rate of the gap coordinate [m/s].
    pub gap_rate: f64,
}

/// Statistics, accumulated during a run.
#[derive(Debug, Clone, Default)]
pub struct Statistics {
    ticks: u64,
    first: f64,
    last: Option<Snapshot>,
    meshes: Vec<MeshSums>,
    points: Vec<PoincarePoint>,
}

impl Statistics {
    /// Adds a tick.
    pub fn add_tick(&mut self, snapshot: &Snapshot) {
        if self.meshes.is_empty() {
            self.meshes = vec![MeshSums::default(); snapshot.teeth.len()];
            self.first = snapshot.time;
        }
        for (sums, teeth) in self.meshes.iter_mut().zip(&snapshot.teeth) {
            sums.add(self.ticks, teeth);
        }
        if let Some(last) = &self.last {
            self.points.extend(crossing(last, snapshot));
            if self.points.len() >= 2 * MAX_POINCARE_POINTS {
                self.points.drain(..MAX_POINCARE_POINTS);
            }
        }
        self.last = Some(snapshot.clone());
        self.ticks += 1;
    }

    /// Covered time [s].
    pub fn span(&self) -> f64 {
        self.last.as_ref().map_or(0.0, |last| last.time - self.first)
    }

    /// Figures of every mesh.
    pub fn meshes(&self) -> Vec<MeshStatistics> {
        self.meshes.iter().map(|sums| sums.figures(self.ticks, self.span())).collect()
    }

    /// Last Poincare points.
    pub fn points(&self) -> &[PoincarePoint] {
        &self.points[self.points.len().saturating_sub(MAX_POINCARE_POINTS)..]
    }

    /// Mesh periods after which the motion repeats; `None` if it does not within 32, or with too few points.
    pub fn period(&self) -> Option<usize> {
        let points = self.points();
        let swing = |value: fn(&PoincarePoint) -> f64, whole: f64| {
            let (low, high) = points.iter().map(value).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            (high - low).max(whole)
        };
        let whole = self.meshes.first().map_or(0.0, |mesh| mesh.greatest - mesh.least);
        let size = [swing(|p| p.deflection, whole), swing(|p| p.gap, whole)];
        let same = |a: &PoincarePoint, b: &PoincarePoint| {
            (a.deflection - b.deflection).abs() <= POINT_TOLERANCE * size[0]
                && (a.gap - b.gap).abs() <= POINT_TOLERANCE * size[1]
        };
        (1..=LONGEST_PERIOD).find(|&period| {
            // Three rounds and 8 more points must agree, so that chaos does not match by chance.
            let wanted = 3 * period + 8;
            points.len() > wanted + period
                && points.iter().rev().take(wanted).zip(points.iter().rev().skip(period)).all(|(a, b)| same(a, b))
        })
    }
}

impl MeshSums {
    fn add(&mut self, ticks: u64, &MeshSnapshot { deflection, force, contact, .. }: &MeshSnapshot) {
        if ticks == 0 {
            (self.least, self.greatest) = (deflection, deflection);
        }
        self.least = self.least.min(deflection);
        self.greatest = self.greatest.max(deflection);
        self.sum += deflection;
        self.square += deflection * deflection;
        self.peak_force = self.peak_force.max(force.abs());
        self.drive_side += u64::from(contact == ContactState::DriveSide);
        self.back_side += u64::from(contact == ContactState::BackSide);
        let landed = contact != ContactState::Separated && self.touched.is_some_and(|before| before != contact);
        self.landings += u64::from(landed);
        self.touched = Some(contact);
    }

    fn figures(&self, ticks: u64, span: f64) -> MeshStatistics {
        let count = ticks.max(1) as f64;
        let mean = self.sum / count;
        let share = |ticks: u64| ticks as f64 / count;
        MeshStatistics {
            drive_side_share: share(self.drive_side),
            separated_share: share(ticks - self.drive_side - self.back_side),
            back_side_share: share(self.back_side),
            impacts_per_s: if span > 0.0 { self.landings as f64 / span } else { 0.0 },
            deflection_mean_m: mean,
            deflection_rms_m: (self.square / count - mean * mean).max(0.0).sqrt(),
            deflection_peak_to_peak_m: self.greatest - self.least,
            peak_force_N: self.peak_force,
        }
    }
}

/// Motion when the mesh phase passes a whole period between two ticks, by cubic interpolation.
fn crossing(before: &Snapshot, after: &Snapshot) -> Option<PoincarePoint> {
    let (from, to) = (before.mesh_periods, after.mesh_periods);
    let whole = if to > from { (from.floor() + 1.0).min(to.floor()) } else { from.ceil() - 1.0 };
    let inside = if to > from { from < whole && whole <= to } else { to <= whole && whole < from };
    if !inside {
        return None;
    }
    let part = (whole - from) / (to - from);
    let width = after.time - before.time;
    let (one, other) = (before.teeth.first()?, after.teeth.first()?);
    let (deflection, rate) = hermite([one.deflection, other.deflection], [one.rate, other.rate], width, part);
    let (gap, gap_rate) = hermite([before.gap, after.gap], [before.gap_rate, after.gap_rate], width, part);
    Some(PoincarePoint { deflection, rate, gap, gap_rate })
}

/// Value and slope of the cubic through two values with their slopes.
fn hermite(values: [f64; 2], slopes: [f64; 2], width: f64, part: f64) -> (f64, f64) {
    let rise = values[1] - values[0];
    let (first, last) = (slopes[0] * width, slopes[1] * width);
    let square = 3.0 * rise - 2.0 * first - last;
    let cube = first + last - 2.0 * rise;
    let value = values[0] + part * (first + part * (square + part * cube));
    (value, (first + part * (2.0 * square + part * 3.0 * cube)) / width)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Statistics of a wave with 50 ticks a mesh period, with the teeth separated below zero.
    fn gathered(wave: impl Fn(f64) -> (f64, f64)) -> Statistics {
        let mut statistics = Statistics::default();
        for tick in 0..20_000 {
            let periods = f64::from(tick) / 50.0;
            let (deflection, rate) = wave(periods);
            let contact = if deflection > 0.0 { ContactState::DriveSide } else { ContactState::Separated };
            let teeth = MeshSnapshot { deflection, rate, force: 2.0 * deflection.max(0.0), contact };
            let snapshot = Snapshot {
                tick,
                time: periods,
                drive: 0.0,
                load: 0.0,
                carrier_angle: 0.0,
                carrier_speed: 0.0,
                motor_offset: 0.0,
                link_offset: 0.0,
                gap: 0.0,
                gap_rate: 0.0,
                wind_up: 0.0,
                wind_up_rate: 0.0,
                mesh_periods: periods,
                teeth: [teeth].into_iter().collect(),
                energy: None,
            };
            statistics.add_tick(&snapshot);
        }
        statistics
    }

    fn sine(over: f64) -> impl Fn(f64) -> (f64, f64) {
        let omega = std::f64::consts::TAU / over;
        move |t| ((omega * t + 0.3).sin(), omega * (omega * t + 0.3).cos())
    }

    #[test]
    fn sine_has_exact_statistics() {
        let figures = gathered(sine(1.0)).meshes()[0];
        assert!((figures.drive_side_share - 0.5).abs() < 0.01, "{figures:?}");
        assert!((figures.separated_share - 0.5).abs() < 0.01, "{figures:?}");
        assert!((figures.impacts_per_s - 1.0).abs() < 0.01, "{figures:?}");
        assert!((figures.deflection_rms_m - 0.5f64.sqrt()).abs() < 1e-3, "{figures:?}");
        assert!((figures.deflection_peak_to_peak_m - 2.0).abs() < 1e-2, "{figures:?}");
        assert!((figures.peak_force_N - 2.0).abs() < 1e-2, "{figures:?}");
    }

    #[test]
    fn period_is_counted_in_mesh_periods() {
        for period in [1, 2, 3, 6] {
            assert_eq!(gathered(sine(f64::from(period))).period(), Some(period as usize));
        }
    }

    #[test]
    fn aperiodic_motion_has_no_period() {
        assert_eq!(gathered(sine(std::f64::consts::SQRT_2)).period(), None);
    }

    /// A Poincare point lies between two ticks, where the mesh phase completes a period.
    #[test]
    fn poincare_points_are_interpolated() {
        let statistics = gathered(sine(3.0));
        let expected: Vec<f64> = (1..=3).map(|k| sine(3.0)(f64::from(k)).0).collect();
        for (index, point) in statistics.points().iter().enumerate() {
            assert!((point.deflection - expected[index % 3]).abs() < 1e-6, "{index}: {point:?}");
        }
    }
}
