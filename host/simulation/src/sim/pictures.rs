//! Pictures of a run over time: torques, gap, deflections with contact, forces. Phase portraits and spectra are in
//! `portraits`, what judges a scheme is in `judgement`.

use model_core::gears::Kinematics;
use parameters::{ContactState, JointParameters};

use super::moment::{Moment, Teeth};
use super::plan::Plan;
use report::contacts;
use report::contacts::Contact;
use report::plot::ink::{Ink, LINES};
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{MILLISECONDS, SECONDS, TORQUE, Unit, greatest};
use report::plot::{Figure, HorizontalAxis, Shape};

/// Width of an ordinary line [px].
pub(super) const LINE: f64 = 1.4;
/// Lines closer than this part of the greatest value cannot be told apart.
const ALIKE: f64 = 0.01;
/// Mesh periods shown where every one of them is to be seen.
const CLOSE_PERIODS: f64 = 12.0;
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
        Figure {
            runs: HorizontalAxis::Linear,
            shape: Shape::default(),
            title,
            axis: "time".into(),
            unit,
            range: self.range,
            panels,
            note: String::new(),
        }
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
        let times: Vec<f64> = self.samples.iter().map(|moment| moment.time).collect();
        panels.push(contacts::panel(&times, &contact_columns(self.samples), self.range));
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
fn contact_columns(samples: &[Moment]) -> Vec<Vec<Contact>> {
    let meshes = samples.first().map_or(0, |moment| moment.teeth.len());
    let column = |mesh: usize| {
        let state = |moment: &Moment| match moment.teeth[mesh].contact {
            ContactState::Separated => Contact::Separated,
            ContactState::DriveSide => Contact::DriveSide,
            ContactState::BackSide => Contact::BackSide,
        };
        samples.iter().map(state).collect()
    };
    (0..meshes).map(column).collect()
}
