//! A motion from a CSV file: positions at any times, optionally with a load torque. Between rows the link follows the
//! cubic spline through the positions, with continuous acceleration; it is at rest where three or more rows are equal,
//! and at the first and the last row.

use std::path::Path;

use reference::closed_loop::{Motion, MotionProfile};

use board::profile::{MAX_SPEED, MAX_TORQUE, check_time};
use report::failure::{Failure, Outcome};
use report::input;

/// Required columns.
const COLUMNS: [&str; 2] = ["time_s", "position_rad"];
/// Optional column.
const LOAD_COLUMN: &str = "load_torque_N_m";
/// Largest position of a plausible joint [rad]; loads and speeds have their own limits.
const MAX_POSITION: f64 = 1e4;

/// A recorded motion: rows of the file, in rising time from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedMotion {
    rows: Vec<Row>,
}

/// One row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time [s].
    pub time: f64,
    /// Position [rad].
    pub position: f64,
    /// Speed [rad/s].
    speed: f64,
    /// Torque that brakes the link until the next row [N m].
    pub load: f64,
}

impl RecordedMotion {
    /// Reads the text of a file.
    pub fn text(path: &Path) -> Outcome<String> {
        input::text(path, input::LARGEST_RECORDED).map_err(|why| {
            Failure::new(format!("cannot read the motion {}: {why}", path.display()))
                .with_help("`file` in [profile] is looked for beside the test file")
        })
    }

    /// Parses the text of a file; the time of the first row becomes 0.
    pub fn parse(text: &str) -> Outcome<Self> {
        let header_help = "the first line names the columns: time_s,position_rad and, if wanted, load_torque_N_m";
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines = (1u64..).zip(text.lines().map(str::trim));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (_, header) = lines.next().ok_or_else(|| Failure::new("the motion is empty").with_help(header_help))?;
        let header: Vec<&str> = header.split(',').map(|name| name.trim().trim_matches('"')).collect();
        let place = |name: &str| header.iter().position(|column| *column == name);
        let twice = |name: &&&str| header.iter().filter(|column| *column == *name).count() > 1;
        if let Some(name) = COLUMNS.iter().chain([&LOAD_COLUMN]).find(twice) {
            return Err(Failure::new(format!("there are two columns `{name}`")).with_help(header_help));
        }
        let [time, position] = COLUMNS.map(|name| {
            place(name).ok_or_else(|| Failure::new(format!("there is no column `{name}`")).with_help(header_help))
        });
        let (time, position, load) = (time?, position?, place(LOAD_COLUMN));
        let mut rows: Vec<Row> = Vec::new();
        for (line, text) in lines {
            let values: Vec<&str> = text.split(',').map(str::trim).collect();
            let number = |place: usize| {
                let value = values.get(place).and_then(|value| value.parse::<f64>().ok());
                value.filter(|value| value.is_finite()).ok_or_else(|| {
                    let name = header.get(place).copied().unwrap_or_default();
                    Failure::new(format!("line {line} has no number for `{name}`"))
                        .with_help("write a finite number with a point, in every row")
                })
            };
            let within = |place: usize, most: f64| {
                number(place).and_then(|value| match value.abs() <= most {
                    true => Ok(value),
                    false => {
                        let name = header.get(place).copied().unwrap_or_default();
                        Err(Failure::new(format!("line {line}: `{name}` is {value:e}"))
                            .with_help(format!("it may be from -{most} to {most}: check the unit")))
                    }
                })
            };
            let row = Row { time: number(time)?, position: within(position, MAX_POSITION)?, speed: 0.0, load: 0.0 };
            let row = Row { load: load.map_or(Ok(0.0), |load| within(load, MAX_TORQUE))?, ..row };
            check_time(line, rows.last().map(|last| last.time), row.time)?;
            if let Some(last) = rows.last().filter(|last| !row.is_reachable_from(last)) {
                let (way, time) = (row.position - last.position, row.time - last.time);
                return Err(Failure::new(format!("line {line}: a jump of {way} rad in {time:e} s")).with_help(
                    format!("no link is faster than {MAX_SPEED} rad/s; profile \"steps\" with move_s = 0 jumps"),
                ));
            }
            rows.push(row);
        }
        if rows.len() < 2 {
            return Err(Failure::new("a motion needs two rows at least").with_help(header_help));
        }
        let start = rows[0].time;
        rows.iter_mut().for_each(|row| row.time -= start);
        set_speeds(&mut rows);
        Ok(Self { rows })
    }

    /// Length [s].
    pub fn duration(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.time)
    }

    /// Rows of the file.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }
}

impl Row {
    fn is_reachable_from(&self, before: &Self) -> bool {
        (self.position - before.position).abs() <= MAX_SPEED * (self.time - before.time)
    }
}

/// Speeds that make the acceleration continuous: h2 v0 + 2 (h1 + h2) v1 + h1 v2 = 3 (h2 d1 + h1 d2) at every row that
/// is not at rest, with the intervals h and the slopes d before and after the row.
fn set_speeds(rows: &mut [Row]) {
    // Forward elimination: the speed of a row is a constant less a share of the next row's speed.
    let mut constant_and_share = vec![(0.0, 0.0); rows.len()];
    for index in 1..rows.len() - 1 {
        let [before, current, after] = [rows[index - 1], rows[index], rows[index + 1]];
        if before.position == current.position && current.position == after.position {
            continue;
        }
        let (h1, h2) = (current.time - before.time, after.time - current.time);
        let (d1, d2) = ((current.position - before.position) / h1, (after.position - current.position) / h2);
        let (constant, share) = constant_and_share[index - 1];
        let pivot = 2.0 * (h1 + h2) - h2 * share;
        constant_and_share[index] = ((3.0 * (h2 * d1 + h1 * d2) - h2 * constant) / pivot, h1 / pivot);
    }
    for index in (1..rows.len() - 1).rev() {
        let (constant, share) = constant_and_share[index];
        rows[index].speed = constant - share * rows[index + 1].speed;
    }
}

impl MotionProfile for RecordedMotion {
    fn at(&self, time: f64) -> Motion {
        let after = self.rows.partition_point(|row| row.time <= time);
        let (Some(from), Some(to)) =
            (after.checked_sub(1).and_then(|index| self.rows.get(index)), self.rows.get(after))
        else {
            let position = self.rows.last().map_or(0.0, |row| row.position);
            return Motion { position, ..Motion::default() };
        };
        let width = to.time - from.time;
        let s = (time - from.time) / width;
        let way = to.position - from.position;
        let (v0, v1) = (from.speed * width, to.speed * width);
        let (c2, c3) = (3.0 * way - 2.0 * v0 - v1, v0 + v1 - 2.0 * way);
        Motion {
            position: from.position + s * (v0 + s * (c2 + s * c3)),
            speed: (v0 + s * (2.0 * c2 + 3.0 * s * c3)) / width,
            acceleration: (2.0 * c2 + 6.0 * s * c3) / (width * width),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recorded_sine_interpolated() {
        let mut text = String::from("time_s,position_rad\n");
        for k in 0..=200 {
            let time = 0.01 * f64::from(k);
            text += &format!("{},{}\n", 7.0 + time, (3.0 * time).sin());
        }
        let motion = RecordedMotion::parse(&text).expect("a good file");
        assert_eq!(motion.duration(), 2.0);
        for time in [0.333, 1.007, 1.5] {
            let at = motion.at(time);
            assert!((at.position - (3.0 * time).sin()).abs() < 1e-6, "{at:?}");
            assert!((at.speed - 3.0 * (3.0 * time).cos()).abs() < 3e-3, "{at:?}");
        }
        assert_eq!(motion.at(9.0).speed, 0.0);
    }

    #[test]
    fn acceleration_is_continuous() {
        let mut text = String::from("time_s,position_rad\n");
        let mut time = 0.0_f64;
        for k in 0..=400 {
            time += if k % 2 == 0 { 0.004 } else { 0.006 };
            text += &format!("{time},{}\n", (9.0 * time).sin());
        }
        let motion = RecordedMotion::parse(&text).expect("a good file");
        for k in 0..1000 {
            let time = 0.5 + 0.001 * f64::from(k);
            let [before, after] = [time, time + 1e-3].map(|time| motion.at(time).acceleration);
            let rate = -729.0 * (9.0 * (time + 0.5e-3 + 0.004)).cos();
            assert!(((after - before) / 1e-3 - rate).abs() < 0.05 * 729.0, "{time}: {before} {after} {rate}");
        }
    }

    #[test]
    fn equal_rows_are_at_rest() {
        let text = "time_s,position_rad\n0,0\n1,0\n2,0\n3,0.1\n4,0.3\n5,0.3\n6,0.3\n7,0.3\n8,0\n";
        let motion = RecordedMotion::parse(text).expect("a good file");
        for time in [0.2, 0.9, 5.5, 5.7] {
            let at = motion.at(time);
            assert_eq!((at.speed, at.acceleration), (0.0, 0.0), "{time}");
        }
        assert!(motion.at(4.5).position > 0.3, "it comes to rest beyond its place and goes back to it");
    }

    #[test]
    fn bad_motion_names_line() {
        let refused = |text: &str| RecordedMotion::parse(text).expect_err(text).message().to_owned();
        assert!(refused("").contains("empty"));
        assert!(refused("time_s,angle\n0,0\n").contains("position_rad"));
        assert!(refused("time_s,position_rad,position_rad\n0,0,0\n1,1,2\n").contains("two columns `position_rad`"));
        assert!(refused("time_s,position_rad\n0,0\n0,1\n").contains("line 3"));
        assert!(refused("time_s,position_rad\n0,0\n1,NaN\n").contains("line 3"));
        assert!(refused("time_s,position_rad\n0,0\n").contains("two rows"));
        assert!(refused("time_s,position_rad\n0,0\n1,1e300\n").contains("`position_rad` is 1e300"));
        assert!(refused("time_s,position_rad\n0,0\n1e-6,1\n").contains("a jump of 1 rad in 1e-6 s"));
        assert!(
            refused("time_s,position_rad\n0,0\n1e-300,0\n1,1\n").contains("line 3: time_s rises by"),
            "0 / 0 there"
        );
        assert!(refused("time_s,position_rad\n0,0\n1e300,1\n").contains("line 3: time_s is 1"));
        assert!(refused("time_s,position_rad\n-1e308,0\n1e308,1\n").contains("line 2: time_s is -1"));
        assert!(refused("time_s,position_rad\n0,0\n1,inf\n").contains("line 3"));
        assert!(refused("time_s,position_rad\n0,0\n2,1\n1,1\n").contains("line 4: time_s does not rise"));
        assert!(refused("time_s,position_rad,load_torque_N_m\n0,0,0\n1,0,nan\n").contains("`load_torque_N_m`"));
    }
}
