//! Grid of a sweep: every combination of its axes, numbered with the last axis fastest.

use super::axis::Axis;
use joint_file::named::{self, Loaded};
use report::failure::{Failure, Outcome};

/// Largest number of points; at a tenth of a second each they take more than a day.
pub const MAX_POINTS: u64 = 1_000_000;
/// Largest number of values of an axis that are all checked before the sweep; of a longer axis only both ends are.
const MAX_CHECKED_VALUES: usize = 1000;

/// All points.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Axes in the order of the command line.
    pub axes: Vec<Axis>,
    /// Number of points.
    pub points: u64,
}

impl Grid {
    /// Parses the values of every `--vary`; short keys need the joint file's text.
    pub fn parse(vary: &[String], joint: Option<&str>) -> Outcome<Self> {
        let axes = vary.iter().map(|vary| Axis::parse(vary, joint)).collect::<Outcome<Vec<_>>>()?;
        for (place, axis) in axes.iter().enumerate() {
            if axes[..place].iter().any(|other| other.key == axis.key) {
                return Err(Failure::new(format!("`{}` is varied twice", axis.key))
                    .with_help("give every key one --vary with all its values"));
            }
        }
        let count: f64 = axes.iter().map(|axis| axis.values.len() as f64).product();
        if axes.is_empty() {
            return Err(Failure::new("the grid has no axis")
                .with_help("give at least one --vary, such as --vary mesh.half_backlash_um=0:150:0.5"));
        }
        if count > MAX_POINTS as f64 {
            return Err(too_many(&axes, count));
        }
        Ok(Self { axes, points: count as u64 })
    }

    /// Value of every axis at a point.
    pub fn values(&self, point: u64) -> Vec<&str> {
        let mut rest = point;
        let mut values: Vec<&str> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let count = axis.values.len() as u64;
                let value = &axis.values[(rest % count) as usize];
                rest /= count;
                value.as_str()
            })
            .collect();
        values.reverse();
        values
    }

    /// Changes of a point's joint, with keys of both mesh families before those of one.
    pub fn changes(&self, point: u64) -> Vec<String> {
        let mut keyed: Vec<(&str, &str)> =
            self.axes.iter().map(|axis| axis.key.as_str()).zip(self.values(point)).collect();
        keyed.sort_by_key(|(key, _)| key.matches('.').count());
        keyed.into_iter().map(|(key, value)| format!("{key}={value}")).collect()
    }

    /// Checks every axis, with the others at their first values: rejects values that the joint file cannot have, and
    /// axes without an effect, before any computation.
    pub fn check_axes(&self, base: &Loaded) -> Outcome<()> {
        let at = |point: u64| named::read_changed(base.name.clone(), base.text.clone(), &self.changes(point));
        let mut stride = self.points;
        for axis in &self.axes {
            let count = axis.values.len();
            stride /= count as u64;
            let first = at(0)?;
            let mut moved = count == 1;
            for place in (1..count).filter(|place| count <= MAX_CHECKED_VALUES || *place == count - 1) {
                let joint = at(place as u64 * stride)?.file;
                moved |= joint.parameters != first.file.parameters || joint.profile != first.file.profile;
            }
            if !moved {
                let message = format!("varying `{}` has no effect in a simulation of the joint", axis.key);
                return Err(Failure::new(message)
                    .with_help("leave it out; the drive train around the joint has no part in a sweep"));
            }
        }
        Ok(())
    }
}

fn too_many(axes: &[Axis], count: f64) -> Failure {
    let each: Vec<String> = axes.iter().map(|axis| axis.values.len().to_string()).collect();
    let message =
        format!("a grid of {} = {count:.0} points: at most {MAX_POINTS} can be swept at once", each.join(" x "));
    // Coarser steps on the longest axis save most.
    let longest = axes.iter().max_by_key(|axis| axis.values.len());
    let help = longest.and_then(|axis| {
        let wanted = (MAX_POINTS as f64 * axis.values.len() as f64 / count).floor();
        let step = axis.coarser_step(wanted.clamp(2.0, 1e6))?;
        let enough = if wanted >= 2.0 { "" } else { ", and coarser steps on the others" };
        Some(format!("use coarser steps: {} in steps of {step}{enough}", axis.key))
    });
    Failure::new(message).with_help(help.unwrap_or_else(|| "give fewer values".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(vary: &[&str]) -> Outcome<Grid> {
        Grid::parse(&vary.iter().map(ToString::to_string).collect::<Vec<_>>(), None)
    }

    #[test]
    fn last_axis_varies_fastest() {
        let grid = grid(&["mesh.half_backlash_um=10:30:10", "mesh.damping_ratio=0.05,0.1"]).expect("a good grid");
        assert_eq!(grid.points, 6);
        assert_eq!(grid.values(0), ["10", "0.05"]);
        assert_eq!(grid.values(1), ["10", "0.1"]);
        assert_eq!(grid.values(5), ["30", "0.1"]);
    }

    /// The error of a grid with too many points names their number and a coarser step.
    #[test]
    fn oversized_grid_error_gives_a_valid_step() {
        let failure = grid(&["mesh.half_backlash_um=0:100:0.0002", "mesh.damping_ratio=0:0.999999:0.000002"]);
        let failure = failure.expect_err("too many");
        assert!(failure.message().contains("500001 x 500000 = 250000500000 points"), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("coarser steps")), "{failure}");
    }

    #[test]
    fn duplicate_or_idle_axis_is_rejected() {
        assert!(grid(&["half_backlash_um=1:2:1", "mesh.half_backlash_um=3:4:1"]).is_err());
        assert!(grid(&[]).is_err());
        let base = named::load(std::path::Path::new("q1")).expect("a preset");
        let check_axes = |vary: &[&str]| grid(vary).and_then(|grid| grid.check_axes(&base));
        assert!(check_axes(&["mesh.half_backlash_um=10:30:10", "sun_planet.half_backlash_um=5,6"]).is_ok());
        let same = check_axes(&["mesh.half_backlash_um=10:30:10", "mesh.backlash_um=5,6"]).expect_err("the same thing");
        assert!(same.message().contains("has no effect"), "{same}");
        let outside = check_axes(&["drive_train.efficiency=0.9,0.95"]).expect_err("no effect");
        assert!(outside.message().contains("has no effect"), "{outside}");
        let bad = check_axes(&["mesh.damping_ratio=0:2:0.5"]).expect_err("out of range").to_string();
        assert!(bad.contains("damping_ratio"), "{bad}");
    }
}
