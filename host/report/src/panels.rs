//! Panels of a joint's motion, equal in all reports: torques, gap, twist, wind-up, and one line for each planet.
//! Contact strips are in `contacts`.

use crate::document::{Text, indexed};
use crate::plot::ink::{Ink, LINES};
use crate::plot::mark::Mark;
use crate::plot::panel::Panel;
use crate::plot::unit::{TORQUE, Unit, greatest};

/// Caption of pictures of long series.
pub const THINNED: &str =
    "A picture with fewer columns than samples shows the least and the greatest sample of each column.";
/// Caption of pictures of deflections and contact.
pub const DEFLECTIONS: &str = "Deflection of every mesh. Above the shaded band the drive side carries, below it the back \
                               side, inside it the teeth are separated. Strips that stand for many samples show the \
                               share of each state by height.";

/// Definition of the gap coordinate.
pub fn gap_coordinate() -> Text {
    indexed("Gap coordinate X = u_s − 2 u_c along the line of action")
}

/// Default width of a line [px].
pub const LINE: f64 = 1.4;
/// Width of a line below another one [px].
pub const BROAD: f64 = 4.0;
/// Distance of lines that cannot be distinguished, over the greatest value [-].
const SAME_LINE_DISTANCE: f64 = 0.01;

/// Points of a line, SI.
pub type Points = Vec<(f64, f64)>;

/// Line of default width.
pub fn line(points: Points, ink: Ink, label: &str) -> Mark {
    Mark::line(points, ink, label, LINE)
}

/// Drive and load torque.
pub fn torques(drive: Points, load: Points) -> Vec<Panel> {
    let panel =
        |title: &str, points, ink| Panel { height: 160, ..Panel::lines(title, TORQUE, vec![line(points, ink, "")]) };
    vec![
        panel("Drive torque at the motor", drive, Ink::First),
        panel("Load torque that brakes the link", load, Ink::Second),
    ]
}

/// Gap coordinate over the band in which every mesh can be free at once [m].
pub fn gap(band: (f64, f64), lines: Vec<Mark>) -> Panel {
    over_band(
        "Gap coordinate",
        Unit::of_length,
        Mark::Band { range: band, label: "free: no flank need touch (4b)".into() },
        lines,
    )
}

/// Twist over the lost motion, half on either side [rad].
pub fn twist(half: f64, lines: Vec<Mark>) -> Panel {
    let band = Mark::Band { range: (-half, half), label: "lost motion of the gears".into() };
    over_band("Twist: motor angle over ratio, less link angle", Unit::of_angle, band, lines)
}

fn over_band(title: &str, unit: fn(f64) -> Unit, band: Mark, lines: Vec<Mark>) -> Panel {
    let marks: Vec<Mark> = std::iter::once(band).chain(lines).collect();
    let most = greatest(marks.iter().flat_map(Mark::values));
    Panel::lines(title, unit(most), marks)
}

/// Wind-up between carrier and link [m]; `None` for a rigid joint.
pub fn wind_up(points: Points) -> Option<Panel> {
    let most = greatest(points.iter().map(|point| point.1));
    let title = "Wind-up of carrier against link, along the line of action";
    let line = line(points, Ink::Fourth, "");
    (most > 0.0).then(|| Panel { height: 160, ..Panel::lines(title, Unit::of_length(most), vec![line]) })
}

/// Deflections of the sun-planet and the ring-planet meshes over the bands with parted teeth: lines and half-backlashes
/// of the planets of each kind [m].
pub fn deflections(kinds: [(Vec<Points>, &[f64]); 2]) -> Vec<Panel> {
    let values = |(lines, half_backlash): &(Vec<Points>, &[f64])| {
        greatest(lines.iter().flatten().map(|point| point.1).chain(half_backlash.iter().copied()))
    };
    let most = kinds.iter().map(values).fold(0.0, f64::max);
    // An equivalent gear has one contact, whose deflection is shared by two halves.
    let titles = match kinds[0].0.len() {
        1 => ["Deflection, half at the motor", "Deflection, half at the link"],
        _ => ["Deflection, sun–planet meshes", "Deflection, ring–planet meshes"],
    };
    let panel = |(title, (lines, half_backlash)): (&str, (Vec<Points>, &[f64]))| {
        let least = half_backlash.iter().copied().fold(f64::INFINITY, f64::min);
        let band = least.is_finite().then(|| Mark::Band { range: (-least, least), label: "parted (2b)".into() });
        let marks = band.into_iter().chain(planets(lines, most)).collect();
        Panel::lines(title, Unit::of_length(most), marks)
    };
    titles.into_iter().zip(kinds).map(panel).collect()
}

/// One line for each planet, or a single line if they cannot be distinguished at the scale of the greatest value.
pub fn planets(lines: Vec<Points>, most: f64) -> Vec<Mark> {
    let planets = lines.len();
    let coincide = lines_coincide(&lines, SAME_LINE_DISTANCE * most);
    let mark = |(planet, points): (usize, Points)| {
        let label = if planets == 1 {
            String::new()
        } else if coincide {
            format!("all {planets} planets, alike")
        } else {
            format!("planet {}", planet + 1)
        };
        // Lines may cover one another: lower ones are wider, so that they stay visible.
        let width = LINE + if coincide { 0.0 } else { (planets - 1 - planet) as f64 };
        Mark::line(points, LINES[planet % LINES.len()], label, width)
    };
    lines.into_iter().enumerate().take(if coincide { 1 } else { planets }).map(mark).collect()
}

/// Returns true if all lines agree within a distance.
fn lines_coincide(lines: &[Points], distance: f64) -> bool {
    let near = |a: &(f64, f64), b: &(f64, f64)| (a.1 - b.1).abs() <= distance;
    lines.len() > 1 && lines.iter().all(|line| line.iter().zip(&lines[0]).all(|(a, b)| near(a, b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differing_lines_do_not_coincide() {
        let line: Points = (0..10).map(|i| (f64::from(i), f64::from(i))).collect();
        let mut other = line.clone();
        other[7].1 += 0.5;
        assert!(lines_coincide(&[line.clone(), other.clone()], 0.6));
        assert!(!lines_coincide(&[line.clone(), other.clone()], 0.4));
        other[7].1 = f64::NAN;
        assert!(!lines_coincide(&[line, other], 0.6));
    }
}
