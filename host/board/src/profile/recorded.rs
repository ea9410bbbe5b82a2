//! Recorded torque profile: a CSV file with time, motor torque and load torque at any sampling rate, even or uneven.
//! Torques are linear between rows; a command is the mean over its interval, which preserves impulses at any rate.
//! After the last row its torques hold.

use std::path::Path;

use super::torques::{MAX_TORQUE, Torques};
use report::failure::{Failure, Outcome};
use report::input;
use report::number::TYPED;

/// Limit of times: above any epoch's seconds, and small enough for a f64 to resolve a control period [s].
const MAX_TIME: f64 = 1e10;
/// Smallest distance of two rows in time [s].
const MIN_TIME_STEP: f64 = 1e-9;

/// Columns of the file, in any order; others are ignored.
pub const COLUMNS: [&str; 3] = ["time_s", "motor_torque_Nm", "load_torque_Nm"];

/// Rows of the file in ascending time, from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedTorques {
    rows: Vec<Row>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    time: f64,
    torques: Torques,
    /// Integral of the torques from the first row to here [N m s].
    integral: Torques,
}

impl RecordedTorques {
    /// Reads a file; the time of the first row becomes 0.
    pub fn read(path: &Path) -> Outcome<Self> {
        let text = input::text(path, input::LARGEST_RECORDED).map_err(|why| {
            Failure::new(format!("cannot read the profile {}: {why}", path.display()))
                .with_help(format!("name a CSV file, as text in UTF-8; {}", wanted_header()))
        })?;
        Self::parse(&text).map_err(|failure| failure.while_doing(path.display()))
    }

    fn parse(text: &str) -> Outcome<Self> {
        // Values are never quoted, so every comma ends a value. Spreadsheets write a byte-order mark in front.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = (1u64..).zip(text.lines().map(str::trim));
        let mut lines = lines.by_ref().filter(|(_, text)| !text.is_empty() && !text.starts_with('#'));
        let (line, header) =
            lines.next().ok_or_else(|| Failure::new("the profile is empty").with_help(wanted_header()))?;
        let header = values(header);
        let mut places = [0; COLUMNS.len()];
        for (place, wanted) in places.iter_mut().zip(COLUMNS) {
            let found = header.iter().position(|column| *column == wanted);
            *place = found.ok_or_else(|| missing_column(line, wanted, &header))?;
        }
        let mut rows: Vec<Row> = Vec::new();
        let mut start = None;
        for (line, text) in lines {
            let row = values(text);
            if row.len() != header.len() {
                let message = format!("line {line} has {} values, the header has {}", row.len(), header.len());
                return Err(Failure::new(message).with_help("give every row a value for every column"));
            }
            let mut numbers = [0.0; COLUMNS.len()];
            for ((value, column), place) in numbers.iter_mut().zip(COLUMNS).zip(places) {
                *value = number(line, column, row[place])?;
            }
            push_row(&mut rows, *start.get_or_insert(numbers[0]), line, numbers)?;
        }
        let too_few = |what: &str| Failure::new(what).with_help("give at least two rows of numbers");
        match rows.len() {
            0 => Err(too_few("the profile holds no rows")),
            1 => Err(too_few("the profile holds a single row")),
            _ => Ok(Self { rows }),
        }
    }

    /// Time from the first row to the last [s].
    pub fn duration(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.time)
    }

    /// Mean torques over an interval [s].
    pub fn mean(&self, from: f64, to: f64) -> Torques {
        let (start, end) = (self.integral(from), self.integral(to));
        let mean = |start: f64, end: f64| (end - start) / (to - from);
        Torques { drive: mean(start.drive, end.drive), load: mean(start.load, end.load) }
    }

    /// Integral of the piecewise linear torques from 0 [N m s].
    fn integral(&self, time: f64) -> Torques {
        let after = self.rows.partition_point(|row| row.time <= time);
        let left = self.rows[after.saturating_sub(1)];
        let elapsed = time - left.time;
        let slope = |pick: fn(&Torques) -> f64| {
            self.rows
                .get(after)
                .map_or(0.0, |right| (pick(&right.torques) - pick(&left.torques)) / (right.time - left.time))
        };
        let area = |pick: fn(&Torques) -> f64| {
            pick(&left.integral) + elapsed * (pick(&left.torques) + 0.5 * elapsed * slope(pick))
        };
        Torques { drive: area(|torques| torques.drive), load: area(|torques| torques.load) }
    }
}

/// Appends a row; rejects a row whose time is out of range or does not rise.
fn push_row(rows: &mut Vec<Row>, start: f64, line: u64, [time, drive, load]: [f64; 3]) -> Outcome<()> {
    let torques = Torques { drive, load };
    check_time(line, rows.last().map(|last| last.time + start), time)?;
    let time = time - start;
    let integral = match rows.last() {
        None => Torques { drive: 0.0, load: 0.0 },
        Some(last) => {
            let half = 0.5 * (time - last.time);
            Torques {
                drive: last.integral.drive + half * (last.torques.drive + drive),
                load: last.integral.load + half * (last.torques.load + load),
            }
        }
    };
    rows.push(Row { time, torques, integral });
    Ok(())
}

/// Rejects a time that is out of range (wrong unit) or does not rise; `before` is the time of the preceding row.
pub fn check_time(line: u64, before: Option<f64>, now: f64) -> Outcome<()> {
    if now.is_nan() || now.abs() > MAX_TIME {
        return Err(Failure::new(format!("line {line}: time_s is {}", TYPED.write(now)))
            .with_help(format!("it may be from -{MAX_TIME:e} to {MAX_TIME:e} s: check the unit")));
    }
    match before {
        Some(before) if now <= before => {
            Err(Failure::new(format!("line {line}: time_s does not rise: {now} s follows {before} s"))
                .with_help("sort the rows by time and remove repeated ones"))
        }
        Some(before) if now - before < MIN_TIME_STEP => {
            Err(Failure::new(format!("line {line}: time_s rises by {} s only", TYPED.write(now - before))).with_help(
                format!("rows must be {MIN_TIME_STEP:e} s apart at least: check the unit, or leave rows out"),
            ))
        }
        _ => Ok(()),
    }
}

fn number(line: u64, column: &str, text: &str) -> Outcome<f64> {
    match text.parse::<f64>() {
        Ok(value) if !value.is_finite() => Err(Failure::new(format!("line {line}: {column} is {value}"))
            .with_help("every value must be a finite number: remove the row or fill it in")),
        Ok(value) if column != COLUMNS[0] && value.abs() > MAX_TORQUE => {
            Err(Failure::new(format!("line {line}: {column} is {}", TYPED.write(value)))
                .with_help(format!("it may be from -{MAX_TORQUE} to {MAX_TORQUE} N m: check the unit")))
        }
        Ok(value) => Ok(value),
        Err(_) => Err(Failure::new(format!("line {line}: {column} is `{text}`, not a number"))
            .with_help("write numbers with a decimal point, and commas between columns")),
    }
}

fn values(line: &str) -> Vec<&str> {
    line.split(',').map(|value| value.trim().trim_matches('"')).collect()
}

fn missing_column(line: u64, wanted: &str, header: &[&str]) -> Failure {
    let there = header.join(", ");
    Failure::new(format!("line {line}: there is no column `{wanted}`; columns are: {there}")).with_help(wanted_header())
}

fn wanted_header() -> String {
    format!("the first line must name the columns {}", COLUMNS.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        RecordedTorques::parse(text).expect_err("a bad file").message().to_owned()
    }

    /// Every kind of bad row is rejected with its line number.
    #[test]
    fn bad_rows_rejected_by_line() {
        let header = "time_s,motor_torque_Nm,load_torque_Nm\n0,1,6\n";
        assert!(refused(&format!("{header}0.1,NaN,6\n")).starts_with("line 3: motor_torque_Nm is NaN"));
        assert!(refused(&format!("{header}0.1,1,inf\n")).starts_with("line 3: load_torque_Nm is inf"));
        assert!(refused(&format!("{header}0.1,1e60,6\n")).starts_with("line 3: motor_torque_Nm is 1"));
        assert!(refused(&format!("{header}0.1,1,6\n0.1,1,6\n")).starts_with("line 4: time_s does not rise"));
        assert!(refused(&format!("{header}-0.1,1,6\n")).starts_with("line 3: time_s does not rise"));
        assert!(refused(&format!("{header}1e300,1,6\n")).starts_with("line 3: time_s is 1"));
        assert!(refused(&format!("{header}1e-300,1,6\n")).starts_with("line 3: time_s rises by"));
        assert!(refused(&format!("{header}0.1,1\n")).starts_with("line 3 has 2 values"));
        assert!(refused(&format!("{header}\n\n0.1,,6\n")).starts_with("line 5: motor_torque_Nm is ``"));
        assert!(refused(&format!("{header}0.1,1.5x,6\n")).starts_with("line 3: motor_torque_Nm is `1.5x`"));
    }

    /// Files without a column or with fewer than two rows are rejected.
    #[test]
    fn incomplete_files_rejected() {
        assert!(refused("").contains("is empty"));
        assert!(refused("time_s,motor_torque_Nm\n0,1\n").contains("no column `load_torque_Nm`"));
        assert!(refused("time_s,motor_torque_Nm,load_torque_Nm\n").contains("no rows"));
        assert!(refused("time_s,motor_torque_Nm,load_torque_Nm\n0,1,6\n").contains("a single row"));
    }

    /// Columns may be reordered, quoted, and mixed with comments and other columns.
    #[test]
    fn columns_in_any_order_read() {
        let text =
            "\u{feff}# a drive's log\r\nload_torque_Nm, \"time_s\", phase, motor_torque_Nm\r\n6,10,x,1\n12,11,y,2\n";
        let recording = RecordedTorques::parse(text).expect("a good file");
        assert_eq!(recording.duration(), 1.0);
        assert_eq!(recording.mean(0.0, 1.0), Torques { drive: 1.5, load: 9.0 });
    }

    /// The sum of commands times their width equals the integral over the rows.
    #[test]
    fn resampling_preserves_impulse() {
        let mut text = String::from("time_s,motor_torque_Nm,load_torque_Nm\n");
        let times: Vec<f64> = (0..=700).map(|k| 0.001_43 * f64::from(k) + 0.0003 * f64::from(k % 3)).collect();
        for time in &times {
            text += &format!("{time},{},{}\n", (40.0 * time).sin(), time * time);
        }
        let recording = RecordedTorques::parse(&text).expect("a good file");
        let rows: f64 =
            times.windows(2).map(|t| 0.5 * (t[1] - t[0]) * ((40.0 * t[0]).sin() + (40.0 * t[1]).sin())).sum();
        let duration = recording.duration();
        for commands in [13, 1000, 7777] {
            let width = duration / f64::from(commands);
            let impulse: f64 = (0..commands)
                .map(|k| width * recording.mean(width * f64::from(k), width * f64::from(k + 1)).drive)
                .sum();
            assert!((impulse - rows).abs() < 1e-12, "{commands}: {impulse} for {rows}");
        }
    }

    /// After the last row its torques hold.
    #[test]
    fn last_torque_holds() {
        let text = "time_s,motor_torque_Nm,load_torque_Nm\n0,0,0\n1,2,3\n";
        let recording = RecordedTorques::parse(text).expect("a good file");
        assert_eq!(recording.mean(5.0, 6.0), Torques { drive: 2.0, load: 3.0 });
    }
}
