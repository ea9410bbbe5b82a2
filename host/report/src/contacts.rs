//! Contact states over time as rows of coloured strips, one row for each mesh. A strip that covers many samples shows
//! the share of each state by height.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plot::ink::Ink;
use crate::plot::mark::Mark;
use crate::plot::panel::{Panel, VerticalAxis};
use crate::plot::unit::Unit;

/// Contact state of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(into = "u8", try_from = "u8")]
pub enum Contact {
    /// No flank in contact: 0.
    Separated = 0,
    /// Drive-side flank in contact: 1.
    DriveSide = 1,
    /// Back-side flank in contact: 2.
    BackSide = 2,
}

/// Largest number of strips across the picture; more could not be distinguished.
const MAX_STRIPS: usize = 400;
/// Resolution of the shown shares, so that equal neighbours can be merged.
const SHARE_STEPS: f64 = 10.0;
/// Coloured share of a row's height [-].
const ROW_FILL: f64 = 0.78;

/// States from the bottom of a strip upwards.
const STATES: [(Contact, Ink, &str); 3] = [
    (Contact::DriveSide, Ink::DriveSide, "drive side"),
    (Contact::Separated, Ink::Separated, "separated"),
    (Contact::BackSide, Ink::BackSide, "back side"),
];

impl Contact {
    /// Word in logs and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Separated => "separated",
            Self::DriveSide => "drive_side",
            Self::BackSide => "back_side",
        }
    }

    /// State of a mesh in the two-bit form of the line protocol.
    pub fn from_bits(bits: u32, mesh: usize) -> Self {
        Self::try_from((bits >> (2 * mesh) & 3) as u8).unwrap_or(Self::Separated)
    }
}

impl From<Contact> for u8 {
    fn from(contact: Contact) -> Self {
        contact as Self
    }
}

impl TryFrom<u8> for Contact {
    type Error = String;

    fn try_from(code: u8) -> Result<Self, String> {
        match code {
            0 => Ok(Self::Separated),
            1 => Ok(Self::DriveSide),
            2 => Ok(Self::BackSide),
            _ => Err(format!("contact state {code}: expected 0, 1 or 2")),
        }
    }
}

/// Panel of contact strips for the samples within a range of time [s]; `contact` has a column for each mesh.
pub fn panel(times: &[f64], contact: &[Vec<Contact>], range: (f64, f64)) -> Panel {
    let rows = contact.len();
    let mut boxes = STATES.map(|_| Vec::new());
    for (mesh, states) in contact.iter().enumerate() {
        let bottom = (rows - 1 - mesh) as f64 + 0.5 * (1.0 - ROW_FILL);
        for (from, to, shares) in strips(times, states, range) {
            let mut level = bottom;
            for (share, boxes) in shares.iter().zip(&mut boxes) {
                let height = share * ROW_FILL;
                if height > 0.0 {
                    boxes.push([from, to, level, level + height]);
                }
                level += height;
            }
        }
    }
    let marks =
        STATES.iter().zip(boxes).map(|(&(_, ink, label), boxes)| Mark::Boxes { boxes, ink, label: label.into() });
    Panel {
        title: "Contact of every mesh".into(),
        unit: Unit { factor: 1.0, name: "" },
        height: 44 + 18 * rows.max(1) as i32,
        marks: marks.collect(),
        axis: VerticalAxis::Rows((0..rows).map(|mesh| mesh_name(mesh, rows)).collect()),
    }
}

/// Prefixes of fields and columns for both mesh families: sun and ring, or the two halves of an equivalent gear, which
/// has no teeth.
pub const fn families(planets: usize) -> [&'static str; 2] {
    if planets == 1 { ["motor_half", "link_half"] } else { ["sun_planet", "ring_planet"] }
}

/// Name of a mesh by its index.
pub fn mesh_name(mesh: usize, meshes: usize) -> String {
    let planets = meshes / 2;
    if planets == 1 {
        // An equivalent gear has one contact, whose deflection and force are shared by two halves.
        return ["half at the motor", "half at the link"][mesh.min(1)].to_owned();
    }
    if mesh < planets { format!("sun–planet {}", mesh + 1) } else { format!("ring–planet {}", mesh - planets + 1) }
}

/// Start, end and the share of each of [`STATES`]; equal neighbours are merged.
fn strips(times: &[f64], states: &[Contact], range: (f64, f64)) -> Vec<(f64, f64, [f64; 3])> {
    let width = (range.1 - range.0) / MAX_STRIPS as f64;
    let inside: Vec<(f64, Contact)> = times
        .iter()
        .copied()
        .zip(states.iter().copied())
        .filter(|(time, _)| (range.0..=range.1).contains(time))
        .collect();
    let column = |time: f64| ((time - range.0) / width).floor();
    let mut strips: Vec<(f64, f64, [f64; 3])> = Vec::new();
    let mut from = inside.first().map_or(range.0, |(time, _)| *time);
    for group in inside.chunk_by(|a, b| column(a.0) == column(b.0)) {
        let to = group[group.len() - 1].0;
        let share =
            |state: Contact| group.iter().filter(|sample| sample.1 == state).count() as f64 / group.len() as f64;
        let drive = (SHARE_STEPS * share(Contact::DriveSide)).round() / SHARE_STEPS;
        let back = (SHARE_STEPS * share(Contact::BackSide)).round() / SHARE_STEPS;
        let shares = [drive, (1.0 - drive - back).max(0.0), back.min(1.0 - drive)];
        match strips.last_mut() {
            Some(last) if last.2 == shares => last.1 = to,
            _ => strips.push((from, to, shares)),
        }
        from = to;
    }
    strips
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_neighbours_merge_into_one_strip() {
        let times: Vec<f64> = (0..1000).map(f64::from).collect();
        let states: Vec<Contact> =
            (0..1000).map(|i| if i < 500 { Contact::DriveSide } else { Contact::BackSide }).collect();
        let strips = strips(&times, &states, (0.0, 1000.0));
        assert!(strips.len() <= 3, "{strips:?}");
        assert_eq!(strips[0].2, [1.0, 0.0, 0.0]);
        assert_eq!(strips[strips.len() - 1].2, [0.0, 0.0, 1.0]);
    }

    #[test]
    fn strip_of_many_samples_shows_shares() {
        let times: Vec<f64> = (0..4000).map(f64::from).collect();
        let states: Vec<Contact> =
            (0..4000).map(|i| if i % 2 == 0 { Contact::Separated } else { Contact::DriveSide }).collect();
        let strips = strips(&times, &states, (0.0, 4000.0));
        assert_eq!(strips[0].2, [0.5, 0.5, 0.0]);
    }

    #[test]
    fn mesh_numbers_start_at_one() {
        assert_eq!(mesh_name(0, 6), "sun–planet 1");
        assert_eq!(mesh_name(5, 6), "ring–planet 3");
    }
}
