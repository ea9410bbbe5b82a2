//! Pictures of a run over time: torques, gap, deflections with contact, forces. Phase portraits and spectra are in
//! `portraits`, pictures of schemes in `scheme_pictures`.

use model_core::gears::Kinematics;
use parameters::{ContactState, JointParameters};

use super::plan::SimulationPlan;
use super::snapshot::{MeshSnapshot, Snapshot};
use report::contacts;
use report::contacts::Contact;
use report::panels::{self, Points, line};
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::panel::Panel;
use report::plot::unit::{FORCE, Unit, greatest};

/// Mesh periods in a close-up, where each of them is visible.
const CLOSE_PERIODS: f64 = 12.0;

/// A time range of a run.
pub struct View<'a> {
    /// Plan of the run.
    pub plan: &'a SimulationPlan,
    /// Samples in the range.
    pub samples: &'a [Snapshot],
    /// Start and end [s].
    pub range: (f64, f64),
}

impl<'a> View<'a> {
    /// View of the whole run.
    pub fn whole(plan: &'a SimulationPlan, samples: &'a [Snapshot]) -> Self {
        let end = samples.last().map_or(0.0, |last| last.time);
        Self { plan, samples, range: (0.0, if end > 0.0 { end } else { 1.0 }) }
    }

    /// View of the last mesh periods, if they are a small part of the run.
    pub fn close(&self) -> Option<Self> {
        let length = CLOSE_PERIODS / self.plan.mesh_frequency();
        let from = self.range.1 - length;
        let first = self.samples.partition_point(|snapshot| snapshot.time < from);
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

    /// Figure over the time of this view.
    pub fn figure(&self, title: &str, panels: Vec<Panel>) -> Figure {
        let title = format!("{title} of joint {}", self.joint().name);
        Figure::over_time(title, Unit::of_time(self.range.1), self.range, panels)
    }

    fn points(&self, value: impl Fn(&Snapshot) -> f64) -> Points {
        self.samples.iter().map(|snapshot| (snapshot.time, value(snapshot))).collect()
    }

    /// Drive and load torque, as steps.
    pub fn torques(&self) -> Vec<Panel> {
        panels::torques(self.points(|snapshot| snapshot.drive), self.points(|snapshot| snapshot.load))
    }

    /// Gap coordinate over its band, remaining twist at the link, and wind-up if the joint has a compliance.
    pub fn gap(&self) -> Vec<Panel> {
        let joint = self.joint();
        let half_backlash =
            |planet: usize| joint.sun_planet.half_backlash[planet] + joint.ring_planet.half_backlash[planet];
        let reach = (0..joint.geometry.planets).map(half_backlash).fold(f64::INFINITY, f64::min);
        let half = reach / joint.geometry.carrier_base_radius() / 2.0;
        let gap = line(self.points(|snapshot| snapshot.gap), Ink::First, "");
        let twist = line(self.points(|snapshot| snapshot.twist(joint)), Ink::Third, "");
        let mut all = vec![panels::gap((-reach, reach), vec![gap]), panels::twist(half, vec![twist])];
        if joint.compliance.is_some() {
            all.extend(panels::wind_up(self.points(|snapshot| snapshot.wind_up)));
        }
        all
    }

    /// Deflections of both families with the contact of every mesh.
    pub fn deflections(&self) -> Vec<Panel> {
        let joint = self.joint();
        let half_backlash: [&[f64]; 2] = [&joint.sun_planet.half_backlash, &joint.ring_planet.half_backlash];
        let [sun, ring] = self.of_planets(|teeth| teeth.deflection);
        let mut panels = panels::deflections([(sun, half_backlash[0]), (ring, half_backlash[1])]);
        let times: Vec<f64> = self.samples.iter().map(|snapshot| snapshot.time).collect();
        panels.push(contacts::panel(&times, &contact_columns(self.samples), self.range));
        panels
    }

    /// Forces of the sun-planet and ring-planet meshes.
    pub fn forces(&self) -> Vec<Panel> {
        let kinds = self.of_planets(|teeth| teeth.force);
        let most = greatest(kinds.iter().flatten().flatten().map(|point| point.1));
        let unit = if most < 2e3 { FORCE } else { Unit { factor: 1e-3, name: "kN" } };
        let titles = ["Mesh force, sun–planet", "Mesh force, ring–planet"];
        let panel = |(title, lines)| Panel::lines(title, unit, panels::planets(lines, most));
        titles.into_iter().zip(kinds).map(panel).collect()
    }

    /// One line for each planet, sun-planet and ring-planet.
    fn of_planets(&self, value: fn(&MeshSnapshot) -> f64) -> [Vec<Points>; 2] {
        let planets = self.joint().geometry.planets;
        let line = |mesh: usize| self.points(|snapshot| value(&snapshot.teeth[mesh]));
        [(0..planets).map(line).collect(), (planets..2 * planets).map(line).collect()]
    }
}

/// Contact columns for the contact strips.
fn contact_columns(samples: &[Snapshot]) -> Vec<Vec<Contact>> {
    let meshes = samples.first().map_or(0, |snapshot| snapshot.teeth.len());
    let column = |mesh: usize| {
        let state = |snapshot: &Snapshot| match snapshot.teeth[mesh].contact {
            ContactState::Separated => Contact::Separated,
            ContactState::DriveSide => Contact::DriveSide,
            ContactState::BackSide => Contact::BackSide,
        };
        samples.iter().map(state).collect()
    };
    (0..meshes).map(column).collect()
}
