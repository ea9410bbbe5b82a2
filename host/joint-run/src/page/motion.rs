//! Pictures of the motion: torques, angles, the gap, deflections with contact, and the error against the reference.
//! `close_up` draws the close-up of a crossing.

use crate::record::{ErrorSeries, RunRecord, Samples, TorqueCommand};
use report::contacts;
use report::number::PAGE;
use report::panels::{self, BROAD, Points, line};
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{PERCENT, SECONDS, Unit, greatest};

/// Range of samples and the time over which it is shown.
pub struct View<'a> {
    /// Record of the run.
    pub record: &'a RunRecord,
    /// Motion shown.
    pub samples: &'a Samples,
    /// Start and end [s].
    pub range: (f64, f64),
    /// Unit of time.
    pub unit: Unit,
}

/// View of the whole run.
pub fn whole(record: &RunRecord) -> View<'_> {
    let last = record.samples.time_s.last().copied().unwrap_or(0.0);
    let end = if last > 0.0 { last } else { 1.0 };
    View { record, samples: &record.samples, range: (0.0, end), unit: SECONDS }
}

impl View<'_> {
    /// Figure over the time of this view.
    pub fn figure(&self, title: &str, panels: Vec<Panel>) -> Figure {
        Figure::over_time(format!("{title} of joint {}", self.record.identity.joint), self.unit, self.range, panels)
    }

    /// Drive and load torque, held from one command to the next.
    pub fn torques(&self) -> Vec<Panel> {
        let rate = f64::from(self.record.settings.tick_rate_hz.max(1));
        let steps = |torque: fn(&TorqueCommand) -> f32| -> Points {
            let mut points = Points::new();
            for command in &self.record.schedule {
                let (time, value) = (f64::from(command.tick) / rate, f64::from(torque(command)));
                let before = points.last().map(|point| (time, point.1));
                points.extend(before);
                points.push((time, value));
            }
            let hold = points.last().map(|point| (self.range.1, point.1));
            points.extend(hold);
            let clamped = |(time, value): (f64, f64)| (time.clamp(self.range.0, self.range.1), value);
            let visible = points.windows(2).filter(|pair| pair[1].0 >= self.range.0 && pair[0].0 <= self.range.1);
            visible.flat_map(|pair| [clamped(pair[0]), clamped(pair[1])]).collect()
        };
        panels::torques(steps(|command| command.drive_torque), steps(|command| command.load_torque))
    }

    /// Motor and link angle, and the twist between them.
    pub fn angles(&self) -> Vec<Panel> {
        let samples = self.samples;
        let unit = Unit::of_angle(greatest(samples.motor_angle_rad.iter().copied()));
        let angles = vec![
            line(self.points(samples, &samples.motor_angle_rad), Ink::First, "motor"),
            line(self.points(samples, &samples.link_angle_rad), Ink::Second, "link"),
        ];
        let twist = self.beside_reference(|samples| samples.twist_rad.clone());
        vec![
            Panel::lines("Motor and link angle", unit, angles),
            panels::twist(0.5 * self.record.joint.lost_motion_rad, twist),
        ]
    }

    /// Gap coordinate over its band.
    pub fn gap(&self) -> Panel {
        let [low, high] = self.record.joint.gap_band_m;
        panels::gap((low, high), self.beside_reference(|samples| wide(&samples.gap_m)))
    }

    /// Wind-up between carrier and link; `None` for a rigid joint.
    pub fn wind_up(&self) -> Option<Panel> {
        panels::wind_up(self.points(self.samples, &wide(&self.samples.wind_up_m)))
    }

    /// All deflections and the contact of every mesh.
    pub fn deflections(&self) -> Vec<Panel> {
        let columns = &self.samples.deflection_m;
        let lines: Vec<Points> = columns.iter().map(|column| self.points(self.samples, &wide(column))).collect();
        let planets = lines.len() / 2;
        let half_backlash = &self.record.joint.half_backlash_m;
        let (sun, ring) = half_backlash.split_at(planets.min(half_backlash.len()));
        let mut panels = panels::deflections([(lines[..planets].to_vec(), sun), (lines[planets..].to_vec(), ring)]);
        panels.push(contacts::panel(&self.samples.time_s, &self.samples.contact, self.range));
        panels
    }

    /// Line of the board, above the reference's if there is one. Beside samples at every tick, the straight lines
    /// between the reference's sparse samples would look like errors.
    fn beside_reference(&self, values: impl Fn(&Samples) -> Vec<f64>) -> Vec<Mark> {
        let sparse = std::ptr::eq(self.samples, &self.record.samples);
        let reference = self.record.reference.as_ref().filter(|_| sparse).map(|reference| &reference.samples);
        let points =
            reference.map(|samples| self.points(samples, &values(samples))).filter(|points| !points.is_empty());
        let below = points.map(|points| Mark::line(points, Ink::Reference, "f64 reference", BROAD));
        below.into_iter().chain([line(self.points(self.samples, &values(self.samples)), Ink::First, "board")]).collect()
    }

    fn points(&self, samples: &Samples, values: &[f64]) -> Points {
        let points = samples.time_s.iter().copied().zip(values.iter().copied());
        points.filter(|(time, _)| (self.range.0..=self.range.1).contains(time)).collect()
    }
}

/// Errors of all compared quantities against the reference, a panel each: they differ by orders of magnitude.
pub fn errors(record: &RunRecord) -> Option<Figure> {
    let series = &record.reference.as_ref()?.errors;
    let panels: Vec<Panel> = series.iter().map(error_panel).collect();
    (!panels.is_empty()).then(|| whole(record).figure("Error against the reference", panels))
}

fn error_panel(series: &ErrorSeries) -> Panel {
    let bound = series.bound_percent;
    let mut marks = Vec::new();
    if bound < 3.0 * greatest(series.error_percent.iter().copied()) {
        marks.push(Mark::Band { range: (-bound, bound), label: "bound on the root mean square".into() });
    }
    let points = series.time_s.iter().copied().zip(series.error_percent.iter().copied()).collect();
    marks.push(line(points, Ink::First, ""));
    let (rms, bound) = (PAGE.write(root_mean_square(series)), PAGE.write(bound));
    let title = format!("Error of {}: RMS {rms} %, bound {bound} %", series.quantity);
    Panel { height: 150, ..Panel::lines(title, PERCENT, marks) }
}

/// Root mean square of the finite values [%].
pub fn root_mean_square(series: &ErrorSeries) -> f64 {
    let finite: Vec<f64> = series.error_percent.iter().copied().filter(|value| value.is_finite()).collect();
    (finite.iter().map(|value| value * value).sum::<f64>() / finite.len().max(1) as f64).sqrt()
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().copied().map(f64::from).collect()
}
