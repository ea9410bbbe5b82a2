//! Pictures of the motion: torques, angles, the gap, deflections with contact, and the error against the reference.
//! The close-up of a crossing has a module of its own; how a panel is drawn is `plot`'s business.

use crate::record::{ErrorSeries, RunRecord, Samples};
use report::contacts;
use report::plot::ink::{Ink, LINES};
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{PERCENT, SECONDS, TORQUE, Unit, figure, greatest};
use report::plot::{Figure, HorizontalAxis, Shape};

/// Width of an ordinary line [px].
const LINE: f64 = 1.4;

/// Lines closer than this part of the greatest value cannot be told apart.
const ALIKE: f64 = 0.01;

/// A stretch of motion and the time over which it is shown.
pub struct View<'a> {
    /// Whose run.
    pub record: &'a RunRecord,
    /// Its motion.
    pub samples: &'a Samples,
    /// From and to [s].
    pub range: (f64, f64),
    /// Unit of time.
    pub unit: Unit,
}

/// The whole run.
pub fn whole(record: &RunRecord) -> View<'_> {
    let last = record.samples.time_s.last().copied().unwrap_or(0.0);
    let end = if last > 0.0 { last } else { 1.0 };
    View { record, samples: &record.samples, range: (0.0, end), unit: SECONDS }
}

impl View<'_> {
    /// A figure over the time of this view.
    pub fn figure(&self, title: &str, panels: Vec<Panel>) -> Figure {
        let title = format!("{title} of joint {}", self.record.identity.joint);
        Figure {
            title,
            axis: "time".into(),
            unit: self.unit,
            range: self.range,
            runs: HorizontalAxis::Linear,
            shape: Shape::default(),
            panels,
            note: String::new(),
        }
    }

    /// Drive and load torque.
    pub fn torques(&self) -> Vec<Panel> {
        let rate = f64::from(self.record.settings.tick_rate_hz.max(1));
        let steps = |torque: fn(&crate::record::TorqueCommand) -> f32, ink| {
            let mut points: Vec<(f64, f64)> = Vec::new();
            for command in &self.record.schedule {
                let (time, value) = (f64::from(command.tick) / rate, f64::from(torque(command)));
                // Torques hold until the next command.
                let before = points.last().map(|point| (time, point.1));
                points.extend(before);
                points.push((time, value));
            }
            let hold = points.last().map(|point| (self.range.1, point.1));
            points.extend(hold);
            let clamped = |(time, value): (f64, f64)| (time.clamp(self.range.0, self.range.1), value);
            let visible = points.windows(2).filter(|pair| pair[1].0 >= self.range.0 && pair[0].0 <= self.range.1);
            let points = visible.flat_map(|pair| [clamped(pair[0]), clamped(pair[1])]).collect();
            Mark::Line { points, ink, label: String::new(), width: LINE }
        };
        let drive = steps(|command| command.drive_torque, Ink::First);
        let load = steps(|command| command.load_torque, Ink::Second);
        vec![
            Panel { height: 160, ..Panel::lines("Drive torque on the sun shaft", TORQUE, vec![drive]) },
            Panel { height: 160, ..Panel::lines("Load torque that brakes the link", TORQUE, vec![load]) },
        ]
    }

    /// Motor and link angle, and what is between them.
    pub fn angles(&self) -> Vec<Panel> {
        let samples = self.samples;
        let unit = Unit::of_angle(greatest(samples.motor_angle_rad.iter().copied()));
        let angles = vec![
            self.line(&samples.motor_angle_rad, Ink::First, "motor"),
            self.line(&samples.link_angle_rad, Ink::Second, "link"),
        ];
        vec![Panel::lines("Motor and link angle", unit, angles), self.twist()]
    }

    fn twist(&self) -> Panel {
        let half = 0.5 * self.record.joint.lost_motion_rad;
        let unit = Unit::of_angle(greatest(self.samples.twist_rad.iter().copied()).max(half));
        let mut marks = vec![Mark::Band { range: (-half, half), label: "lost motion of the teeth".into() }];
        if let Some(reference) = &self.record.reference {
            marks.extend(self.reference_line(&reference.samples, &reference.samples.twist_rad));
        }
        marks.push(self.line(&self.samples.twist_rad, Ink::First, "board"));
        Panel::lines("Twist: motor angle over ratio, less link angle", unit, marks)
    }

    /// The gap coordinate over its band.
    pub fn gap(&self) -> Panel {
        let [low, high] = self.record.joint.gap_band_m;
        let gap = wide(&self.samples.gap_m);
        let unit = Unit::of_length(greatest(gap.iter().copied().chain([low, high])));
        let mut marks = vec![Mark::Band { range: (low, high), label: "free: no tooth need touch (4b)".into() }];
        if let Some(reference) = &self.record.reference {
            marks.extend(self.reference_line(&reference.samples, &wide(&reference.samples.gap_m)));
        }
        marks.push(self.line(&gap, Ink::First, "board"));
        Panel::lines("Gap coordinate", unit, marks)
    }

    /// Wind-up between carrier and link; none for a rigid joint.
    pub fn wind_up(&self) -> Option<Panel> {
        let wind_up = wide(&self.samples.wind_up_m);
        let most = greatest(wind_up.iter().copied());
        let line = self.line(&wind_up, Ink::Fourth, "");
        let title = "Wind-up of carrier against link, along the line of action";
        (most > 0.0).then(|| Panel { height: 160, ..Panel::lines(title, Unit::of_length(most), vec![line]) })
    }

    /// All deflections and the contact of every mesh.
    pub fn deflections(&self) -> Vec<Panel> {
        let columns: Vec<Vec<f64>> = self.samples.deflection_m.iter().map(|column| wide(column)).collect();
        let planets = columns.len() / 2;
        let half_backlash = &self.record.joint.half_backlash_m;
        let most = greatest(columns.iter().flatten().chain(half_backlash).copied());
        let family = |title: &str, first: usize| {
            let least = half_backlash.iter().skip(first).take(planets).copied().fold(f64::INFINITY, f64::min);
            let mut marks = Vec::new();
            if least.is_finite() {
                marks.push(Mark::Band { range: (-least, least), label: "parted (2b)".into() });
            }
            let own: Vec<Vec<(f64, f64)>> =
                columns.iter().skip(first).take(planets).map(|c| self.points(self.samples, c)).collect();
            let together = alike(&own, ALIKE * most);
            for (planet, points) in own.into_iter().enumerate().take(if together { 1 } else { planets }) {
                let label =
                    if together { format!("all {planets} planets, alike") } else { format!("planet {}", planet + 1) };
                // Lines may lie on each other: wider ones below show that they are there.
                let width = LINE + if together { 0.0 } else { 2.0 * (planets - 1 - planet) as f64 };
                marks.push(Mark::Line { points, ink: LINES[planet % LINES.len()], label, width });
            }
            Panel::lines(title, Unit::of_length(most), marks)
        };
        vec![
            family("Deflection, sun–planet meshes", 0),
            family("Deflection, ring–planet meshes", planets),
            contacts::panel(&self.samples.time_s, &self.samples.contact, self.range),
        ]
    }

    fn line(&self, values: &[f64], ink: Ink, label: &str) -> Mark {
        Mark::Line { points: self.points(self.samples, values), ink, label: label.into(), width: LINE }
    }

    fn reference_line(&self, samples: &Samples, values: &[f64]) -> Option<Mark> {
        // Beside samples at every tick the straight lines between sparse ones would look like errors.
        if !std::ptr::eq(self.samples, &self.record.samples) {
            return None;
        }
        let points = self.points(samples, values);
        let label = "f64 reference".into();
        (!points.is_empty()).then_some(Mark::Line { points, ink: Ink::Reference, label, width: 4.0 })
    }

    fn points(&self, samples: &Samples, values: &[f64]) -> Vec<(f64, f64)> {
        let points = samples.time_s.iter().copied().zip(values.iter().copied());
        points.filter(|(time, _)| (self.range.0..=self.range.1).contains(time)).collect()
    }
}

/// Distance of every compared quantity from the reference, a panel for each: they differ by orders of magnitude.
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
    marks.push(Mark::Line { points, ink: Ink::First, label: String::new(), width: LINE });
    let (rms, bound) = (figure(root_mean_square(series)), figure(bound));
    let title = format!("Error of {}: RMS {rms} %, bound {bound} %", series.quantity);
    Panel { height: 150, ..Panel::lines(title, PERCENT, marks) }
}

/// Root mean square of the finite values [%].
pub fn root_mean_square(series: &ErrorSeries) -> f64 {
    let finite: Vec<f64> = series.error_percent.iter().copied().filter(|value| value.is_finite()).collect();
    (finite.iter().map(|value| value * value).sum::<f64>() / finite.len().max(1) as f64).sqrt()
}

/// Whether all lines are the same but for a distance.
fn alike(lines: &[Vec<(f64, f64)>], distance: f64) -> bool {
    let near = |a: &(f64, f64), b: &(f64, f64)| (a.1 - b.1).abs() <= distance;
    lines.len() > 1 && lines.iter().all(|line| line.iter().zip(&lines[0]).all(|(a, b)| near(a, b)))
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().copied().map(f64::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_differ_anywhere_are_not_alike() {
        let line: Vec<(f64, f64)> = (0..10).map(|i| (f64::from(i), f64::from(i))).collect();
        let mut other = line.clone();
        other[7].1 += 0.5;
        assert!(alike(&[line.clone(), other.clone()], 0.6));
        assert!(!alike(&[line.clone(), other.clone()], 0.4));
        other[7].1 = f64::NAN;
        assert!(!alike(&[line, other], 0.6));
    }
}
