//! Pictures of a run: the motion over time, phase portraits with Poincare points, the spectrum, the books of energy and
//! the schemes beside each other. Which of them a page shows is `page`'s business.

use model_core::joint::JointParameters;
use model_core::mesh::ContactState;

use super::comparison::Comparison;
use super::energy::Entry;
use super::moment::{Moment, Teeth};
use super::plan::Plan;
use super::scheme::SchemeName;
use super::spectrum::Spectrum;
use super::statistics::Point;
use crate::record::{Contact, Samples};
use crate::report::contacts;
use crate::report::plot::Figure;
use crate::report::plot::ink::{Ink, LINES};
use crate::report::plot::mark::Mark;
use crate::report::plot::panel::Panel;
use crate::report::plot::unit::{MILLISECONDS, SECONDS, TORQUE, Unit, axis_range, greatest};

/// Width of an ordinary line [px].
const LINE: f64 = 1.4;
/// Width of a line that another one lies on [px].
const BROAD: f64 = 4.0;
/// Lines closer than this part of the greatest value cannot be told apart.
const ALIKE: f64 = 0.01;
/// Mesh periods shown where every one of them is to be seen.
const CLOSE_PERIODS: f64 = 12.0;
/// Samples drawn of a phase portrait under constant torques: more only blacken it.
const PORTRAIT: usize = 6000;
/// Samples drawn of a phase portrait under a profile, which shows the whole run.
const PROFILE_PORTRAIT: usize = 20_000;
/// Size of a Poincare point over the size of the picture, and of one among many.
const DOT: [f64; 2] = [0.0085, 0.024];
const SMALL_DOT: [f64; 2] = [0.0042, 0.012];
/// Periods that are shown by large points.
const FEW: usize = 8;

/// Errors below this are rounding, and not drawn any lower.
const SMALLEST_ERROR: f64 = 1e-8;

/// Decibels.
const DECIBELS: Unit = Unit { factor: 1.0, name: "dB" };

/// A stretch of a run.
pub struct View<'a> {
    /// Whose.
    pub plan: &'a Plan,
    /// Its samples.
    pub samples: &'a [Moment],
    /// From and to [s].
    pub range: (f64, f64),
}

impl<'a> View<'a> {
    /// The whole run.
    pub fn whole(plan: &'a Plan, samples: &'a [Moment]) -> Self {
        let end = samples.last().map_or(0.0, |last| last.time);
        Self { plan, samples, range: (0.0, if end > 0.0 { end } else { 1.0 }) }
    }

    /// The last few mesh periods, if they are a small part of the run.
    pub fn close(&self) -> Option<Self> {
        let length = CLOSE_PERIODS / self.plan.mesh_frequency();
        let from = self.range.1 - length;
        let first = self.samples.partition_point(|moment| moment.time < from);
        let samples = &self.samples[first..];
        (from > 0.5 * self.range.1 && samples.len() > 24).then_some(Self {
            plan: self.plan,
            samples,
            range: (from, self.range.1),
        })
    }

    fn joint(&self) -> &JointParameters {
        self.plan.parameters()
    }

    /// A figure over the time of this view.
    pub fn figure(&self, title: &str, panels: Vec<Panel>) -> Figure {
        let title = format!("{title} of joint {}", self.joint().name);
        let unit = if self.range.1 < 0.5 { MILLISECONDS } else { SECONDS };
        Figure { title, axis: "time".into(), unit, range: self.range, panels }
    }

    fn line(&self, value: impl Fn(&Moment) -> f64, ink: Ink, label: &str) -> Mark {
        let points = self.samples.iter().map(|moment| (moment.time, value(moment))).collect();
        Mark::Line { points, ink, label: label.into(), width: LINE }
    }

    /// Drive and load torque; steps where they change.
    pub fn torques(&self) -> Vec<Panel> {
        let drive = self.line(|moment| moment.drive, Ink::First, "");
        let load = self.line(|moment| moment.load, Ink::Second, "");
        vec![
            Panel { height: 150, ..Panel::lines("Drive torque on the sun shaft", TORQUE, vec![drive]) },
            Panel { height: 150, ..Panel::lines("Load torque that brakes the link", TORQUE, vec![load]) },
        ]
    }

    /// The gap coordinate over its band, the twist that it leaves at the link, and the wind-up if there is any.
    pub fn gap(&self) -> Vec<Panel> {
        let joint = self.joint();
        let half_backlash =
            |planet: usize| joint.sun_planet.half_backlash[planet] + joint.ring_planet.half_backlash[planet];
        let reach = (0..joint.geometry.planets).map(half_backlash).fold(f64::INFINITY, f64::min);
        let most = greatest(self.samples.iter().map(|moment| moment.gap)).max(reach);
        let band = Mark::Band { range: (-reach, reach), label: "free: no tooth need touch (4b)".into() };
        let gap = self.line(|moment| moment.gap, Ink::First, "");
        let half = reach / joint.geometry.carrier_base_radius() / 2.0;
        let twist = |moment: &Moment| moment.twist(joint);
        let unit = Unit::of_angle(greatest(self.samples.iter().map(twist)).max(half));
        let lost = Mark::Band { range: (-half, half), label: "lost motion of the teeth".into() };
        let mut panels = vec![
            Panel::lines("Gap coordinate", Unit::of_length(most), vec![band, gap]),
            Panel::lines(
                "Twist: motor angle over ratio, less link angle",
                unit,
                vec![lost, self.line(twist, Ink::Third, "")],
            ),
        ];
        let most = greatest(self.samples.iter().map(|moment| moment.wind_up));
        if joint.compliance.is_some() && most > 0.0 {
            let line = self.line(|moment| moment.wind_up, Ink::Fourth, "");
            let title = "Wind-up of carrier against link, along the line of action";
            panels.push(Panel { height: 150, ..Panel::lines(title, Unit::of_length(most), vec![line]) });
        }
        panels
    }

    /// Deflections of both families with the contact of every mesh.
    pub fn deflections(&self) -> Vec<Panel> {
        let joint = self.joint();
        let families = [&joint.sun_planet.half_backlash, &joint.ring_planet.half_backlash];
        let all = self.samples.iter().flat_map(|moment| moment.teeth.iter().map(|teeth| teeth.deflection));
        let most = greatest(all.chain(families.iter().flat_map(|list| list.iter().copied())));
        let titles = ["Deflection, sun–planet meshes", "Deflection, ring–planet meshes"];
        let mut panels: Vec<Panel> = titles
            .into_iter()
            .zip(families)
            .enumerate()
            .map(|(kind, (title, half_backlash))| {
                let least = half_backlash.iter().copied().fold(f64::INFINITY, f64::min);
                let mut marks = vec![Mark::Band { range: (-least, least), label: "parted (2b)".into() }];
                marks.extend(self.family(kind, |teeth| teeth.deflection, ALIKE * most));
                Panel::lines(title, Unit::of_length(most), marks)
            })
            .collect();
        panels.push(contacts::panel(&contact_samples(self.samples), self.range));
        panels
    }

    /// Forces of the sun-planet and ring-planet meshes.
    pub fn forces(&self) -> Vec<Panel> {
        let most = greatest(self.samples.iter().flat_map(|moment| moment.teeth.iter().map(|teeth| teeth.force)));
        let unit = if most < 2e3 { Unit { factor: 1.0, name: "N" } } else { Unit { factor: 1e-3, name: "kN" } };
        ["Mesh force, sun–planet", "Mesh force, ring–planet"]
            .into_iter()
            .enumerate()
            .map(|(kind, title)| Panel::lines(title, unit, self.family(kind, |teeth| teeth.force, ALIKE * most)))
            .collect()
    }

    /// One line for each planet, or one for all that are alike.
    fn family(&self, kind: usize, value: fn(&Teeth) -> f64, distance: f64) -> Vec<Mark> {
        let planets = self.joint().geometry.planets;
        let first = kind * planets;
        let near = |moment: &Moment| {
            let one = value(&moment.teeth[first]);
            moment.teeth[first..first + planets].iter().all(|teeth| (value(teeth) - one).abs() <= distance)
        };
        let alike = self.samples.iter().all(near);
        (0..if alike { 1 } else { planets })
            .map(|planet| {
                let label =
                    if alike { format!("all {planets} planets, alike") } else { format!("planet {}", planet + 1) };
                let points = self.samples.iter().map(|m| (m.time, value(&m.teeth[first + planet]))).collect();
                // Lines may lie on each other: wider ones below show that they are there.
                let width = LINE + if alike { 0.0 } else { (planets - 1 - planet) as f64 };
                Mark::Line { points, ink: LINES[planet % LINES.len()], label, width }
            })
            .collect()
    }
}

/// Contact columns as the strips take them.
fn contact_samples(samples: &[Moment]) -> Samples {
    let meshes = samples.first().map_or(0, |moment| moment.teeth.len());
    let column = |mesh: usize| {
        let state = |moment: &Moment| match moment.teeth[mesh].contact {
            ContactState::Separated => Contact::Separated,
            ContactState::DriveSide => Contact::DriveSide,
            ContactState::BackSide => Contact::BackSide,
        };
        samples.iter().map(state).collect()
    };
    Samples {
        time_s: samples.iter().map(|moment| moment.time).collect(),
        contact: (0..meshes).map(column).collect(),
        ..Samples::default()
    }
}

/// Which motion a phase portrait shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Portrait {
    /// Sun-planet deflection of planet 1.
    Deflection,
    /// Gap coordinate.
    Gap,
}

/// Rate over position of the last samples, with the Poincare points on it.
pub fn portrait(
    plan: &Plan,
    samples: &[Moment],
    (points, period): (&[Point], Option<usize>),
    which: Portrait,
) -> Figure {
    let samples = if plan.constant { &samples[samples.len().saturating_sub(PORTRAIT)..] } else { samples };
    let stride = if plan.constant { 1 } else { samples.len().div_ceil(PROFILE_PORTRAIT) };
    let of = |moment: &Moment| match which {
        Portrait::Deflection => (moment.teeth[0].deflection, moment.teeth[0].rate),
        Portrait::Gap => (moment.gap, moment.gap_rate),
    };
    let of_point = |point: &Point| match which {
        Portrait::Deflection => (point.deflection, point.rate),
        Portrait::Gap => (point.gap, point.gap_rate),
    };
    let curve: Vec<(f64, f64)> = samples.iter().step_by(stride.max(1)).map(of).collect();
    let range = axis_range(curve.iter().map(|point| point.0));
    let up = axis_range(curve.iter().map(|point| point.1));
    let size = if period.is_some_and(|period| period <= FEW) { DOT } else { SMALL_DOT };
    let (half_width, half_height) = (0.5 * size[0] * (range.1 - range.0), 0.5 * size[1] * (up.1 - up.0));
    let dot = |point: &Point| {
        let (x, y) = of_point(point);
        [x - half_width, x + half_width, y - half_height, y + half_height]
    };
    let inside = |point: &&Point| {
        let (x, y) = of_point(point);
        (range.0..=range.1).contains(&x) && (up.0..=up.1).contains(&y)
    };
    // A motion that repeats has a few points, each hit time and again: one dot for each is enough.
    let mut boxes: Vec<[f64; 4]> = Vec::new();
    for dot in points.iter().filter(inside).map(dot) {
        let near = |other: &[f64; 4]| {
            (other[0] - dot[0]).abs() < 0.1 * half_width && (other[2] - dot[2]).abs() < 0.1 * half_height
        };
        if !boxes.iter().any(near) {
            boxes.push(dot);
        }
    }
    let label = if points.is_empty() { "" } else { "once a mesh period" };
    let (title, axis) = match which {
        Portrait::Deflection => ("Phase portrait, sun–planet deflection of planet 1", "deflection"),
        Portrait::Gap => ("Phase portrait, gap coordinate", "gap"),
    };
    let most = greatest(curve.iter().map(|point| point.1));
    let unit = if most < 1.0 { Unit { factor: 1e3, name: "mm/s" } } else { Unit { factor: 1.0, name: "m/s" } };
    let marks = vec![
        Mark::Line { points: curve, ink: Ink::Bar, label: String::new(), width: 1.0 },
        Mark::Boxes { boxes, ink: Ink::Limit, label: label.into() },
    ];
    Figure {
        title: format!("{title} of joint {}", plan.parameters().name),
        axis: axis.into(),
        unit: Unit::of_length(greatest([range.0, range.1].into_iter())),
        range,
        panels: vec![Panel { height: 380, ..Panel::lines(format!("{title}: rate"), unit, marks) }],
    }
}

/// Amplitudes in decibels over a micrometre, up to what the mesh frequency and its harmonics need.
pub fn spectrum(plan: &Plan, spectrum: &Spectrum) -> Figure {
    let mesh = plan.mesh_frequency();
    let top = spectrum.step * spectrum.amplitudes.len() as f64;
    let end = if mesh > 0.0 { top.min(8.5 * mesh) } else { top };
    // Below a picometre there is nothing but rounding.
    let decibels = |amplitude: f64| 20.0 * (1e6 * amplitude).max(1e-6).log10();
    let shown = (end / spectrum.step) as usize;
    let points = spectrum.amplitudes.iter().take(shown).enumerate();
    let points = points.map(|(place, amplitude)| (place as f64 * spectrum.step, decibels(*amplitude))).collect();
    let mut marks = Vec::new();
    if mesh > 0.0 && mesh < end {
        marks.push(Mark::Deadline { at: mesh, label: "mesh frequency".into() });
    }
    marks.push(Mark::Line { points, ink: Ink::First, label: String::new(), width: LINE });
    let unit = if end < 2e3 { Unit { factor: 1.0, name: "Hz" } } else { Unit { factor: 1e-3, name: "kHz" } };
    let title = "Spectrum of the sun–planet deflection of planet 1";
    Figure {
        title: format!("{title} of joint {}", plan.parameters().name),
        axis: "frequency".into(),
        unit,
        range: (0.0, end),
        panels: vec![Panel { height: 260, ..Panel::lines(format!("{title}, over 1 µm"), DECIBELS, marks) }],
    }
}

/// Stored energy and work, and the residual on a scale of its own.
pub fn energy(plan: &Plan, entries: &[Entry]) -> Figure {
    let joules = |most: f64| match most {
        most if most < 1e-6 => Unit { factor: 1e9, name: "nJ" },
        most if most < 1e-3 => Unit { factor: 1e6, name: "µJ" },
        most if most < 1.0 => Unit { factor: 1e3, name: "mJ" },
        _ => Unit { factor: 1.0, name: "J" },
    };
    let start = entries.first().map_or(0.0, |entry| entry.stored);
    let line = |value: &dyn Fn(&Entry) -> f64, ink: Ink, label: &str| Mark::Line {
        points: entries.iter().map(|entry| (entry.time, value(entry))).collect(),
        ink,
        label: label.into(),
        width: LINE,
    };
    let marks = vec![
        line(&|entry| entry.work.supplied, Ink::First, "supplied by torques"),
        line(&|entry| entry.work.dissipated, Ink::Second, "dissipated"),
        line(&|entry| entry.work.against_errors, Ink::Third, "against errors"),
        line(&|entry| entry.work.by_stiffness, Ink::Fourth, "by stiffness"),
        line(&|entry| entry.stored - start, Ink::Fifth, "stored"),
    ];
    let works = entries.iter().flat_map(|entry| [entry.work.supplied, entry.work.dissipated, entry.stored - start]);
    let books = Panel::lines("Energy since the start", joules(greatest(works)), marks);
    let residual = line(&|entry| entry.residual, Ink::Limit, "");
    let most = greatest(entries.iter().map(|entry| entry.residual));
    let residual = Panel { height: 150, ..Panel::lines("Residual of the balance", joules(most), vec![residual]) };
    let end = entries.last().map_or(1.0, |entry| entry.time);
    View { plan, samples: &[], range: (0.0, if end > 0.0 { end } else { 1.0 }) }.figure("Energy", vec![books, residual])
}

/// Colours of the schemes.
fn ink(scheme: SchemeName) -> Ink {
    match scheme {
        SchemeName::Reference => Ink::Reference,
        SchemeName::Realtime => Ink::First,
        SchemeName::Paper => Ink::Second,
        SchemeName::RungeKutta4 => Ink::Third,
        SchemeName::Euler => Ink::Fourth,
    }
}

/// One deflection by every scheme at the end of the predictable part, and the error of each over all of it.
pub fn schemes(plan: &Plan, comparison: &Comparison) -> Vec<Figure> {
    let until = comparison.predictable_until();
    let length = (6.0 / plan.mesh_frequency()).min(until);
    let from = (until - length).max(0.0);
    let inside = |time: f64| (from..=until).contains(&time);
    let tracks = comparison.tracks.iter().map(|track| {
        let points = comparison.times.iter().copied().zip(track.columns[0].iter().copied());
        Mark::Line {
            points: points.filter(|(time, _)| inside(*time)).collect(),
            ink: ink(track.scheme),
            label: track.scheme.name().into(),
            width: if track.scheme == SchemeName::Reference { BROAD } else { LINE },
        }
    });
    // A scheme far off must not flatten the others: the axis is the reference's, with air.
    let exact = comparison.times.iter().zip(&comparison.tracks[0].columns[0]);
    let (low, high) = axis_range(exact.filter(|(time, _)| inside(**time)).map(|(_, value)| *value));
    let air = 0.5 * (high - low);
    let clip = |mark: Mark| match mark {
        Mark::Line { points, ink, label, width } => {
            let points = points.into_iter().map(|(time, value)| (time, value.clamp(low - air, high + air))).collect();
            Mark::Line { points, ink, label, width }
        }
        other => other,
    };
    let unit = Unit::of_length(greatest([low, high].into_iter()));
    let panel =
        Panel { height: 300, ..Panel::lines("Sun–planet deflection of planet 1", unit, tracks.map(clip).collect()) };
    let view = |range| View { plan, samples: &[], range };
    let errors = comparison.tracks.iter().skip(1).map(|track| {
        let error = |(time, error): (f64, f64)| (time, 20.0 * error.max(SMALLEST_ERROR).log10());
        let points = comparison.error_of(track).into_iter().map(error).collect();
        Mark::Line { points, ink: ink(track.scheme), label: track.scheme.name().into(), width: LINE }
    });
    let title = "Error of that deflection over its standard deviation, RMS of short stretches";
    let errors = Panel { height: 300, ..Panel::lines(title, DECIBELS, errors.collect()) };
    let whole = (0.0, if until > 0.0 { until } else { 1.0 });
    let close = (from < until).then(|| view((from, until)).figure("Deflection by every scheme", vec![panel]));
    close.into_iter().chain([view(whole).figure("Error of every scheme", vec![errors])]).collect()
}
