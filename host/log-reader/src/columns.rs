//! Named columns of numbers, row by row. A missing or non-numeric value is reported with its place.

use report::failure::{Failure, Outcome};

/// Help on the first line of a log.
pub const HEADER_HELP: &str = "the first line names the columns: time_s,motor_counts,output_counts,motor_torque_N_m and, if it was \
     measured, output_torque_N_m; --column motor_counts=NAME reads another name";

/// Names of each column: the canonical one, and its aliases in logs.
pub const KNOWN: [(&str, &[&str]); 10] = [
    ("time_s", &[]),
    ("time_ms", &[]),
    ("time_us", &[]),
    (PERIOD, &[]),
    ("motor_counts", &[]),
    ("motor_angle_rad", &["motor_rad"]),
    ("output_counts", &["link_counts"]),
    ("output_angle_rad", &["link_angle_rad", "link_rad"]),
    ("motor_torque_N_m", &["motor_torque_Nm", "motor_torque_nm", "drive_torque_Nm", "drive_torque_nm"]),
    ("output_torque_N_m", &[]),
];

/// Columns of time; the first one present is used.
pub const TIMES: [&str; 3] = ["time_s", "time_ms", "time_us"];

/// Columns of the motor's encoder, counts before angles.
pub const MOTOR: [&str; 2] = ["motor_counts", "motor_angle_rad"];

/// Columns of the output's encoder, counts before angles.
pub const OUTPUT: [&str; 2] = ["output_counts", "output_angle_rad"];

/// Column of the number of the control period; gives the times of rows with repeated stamps.
pub const PERIOD: &str = "period";

/// Column of the output less the motor, a replacement for the motor's column in slow logs.
pub const DIFFERENCE: &str = "output_less_motor_counts";

/// Columns by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    names: Vec<String>,
    /// Values of each column.
    values: Vec<Vec<f64>>,
    /// Line or message number of each row.
    places: Vec<usize>,
    /// Word for a row.
    row: &'static str,
    /// Changes to the rows, a sentence each.
    notes: Vec<String>,
    /// Columns with a stated unit.
    stated: Vec<String>,
}

impl Columns {
    /// Empty columns; `row` is the word for a row in messages.
    pub fn new(row: &'static str) -> Self {
        Self { names: Vec::new(), values: Vec::new(), places: Vec::new(), row, notes: Vec::new(), stated: Vec::new() }
    }

    /// Names of the columns, without rows.
    pub fn without_rows(&self) -> Self {
        Self { names: self.names.clone(), ..Self::new(self.row) }
    }

    /// Memory of names and values [bytes].
    pub fn size(&self) -> u64 {
        let names: usize = self.names.iter().map(|name| name.len() + size_of::<String>() + size_of::<Vec<f64>>()).sum();
        (names + size_of::<f64>() * (1 + self.names.len()) * self.places.len()) as u64
    }

    /// Adds a row; the first row gives the names. Returns false for a row with other names.
    pub fn push(&mut self, place: usize, numbers: &[(String, f64)]) -> bool {
        if self.places.is_empty() {
            self.names = numbers.iter().map(|(name, _)| name.clone()).collect();
            self.values = vec![Vec::new(); numbers.len()];
        }
        if self.names.len() != numbers.len() || self.names.iter().zip(numbers).any(|(known, (name, _))| known != name) {
            return false;
        }
        self.values.iter_mut().zip(numbers).for_each(|(values, (_, value))| values.push(*value));
        self.places.push(place);
        true
    }

    /// Renames columns of the log to canonical names.
    pub fn renamed(mut self, renamed: &[(String, String)]) -> Outcome<Self> {
        for (own, theirs) in renamed {
            let Some(place) = self.names.iter().position(|name| name == theirs) else {
                return Err(self.missing(theirs));
            };
            // A column of that name in the log is hidden: another column was chosen for it.
            self.names.iter_mut().filter(|name| *name == own).for_each(|name| name.insert(0, '~'));
            self.names[place].clone_from(own);
        }
        Ok(self)
    }

    /// Multiplies a column and renames it, in place of a column with the new name.
    pub fn scale(&mut self, name: &str, new_name: &str, by: f64) {
        self.names.iter_mut().filter(|known| *known == new_name).for_each(|known| known.insert(0, '~'));
        if let Some(place) = self.names.iter().position(|known| known == name) {
            self.values[place].iter_mut().for_each(|value| *value *= by);
            new_name.clone_into(&mut self.names[place]);
            self.stated.push(new_name.to_owned());
        }
    }

    /// Returns true if the unit of a column was stated.
    pub fn is_unit_stated(&self, name: &str) -> bool {
        self.stated.iter().any(|stated| stated == name)
    }

    /// Adds a note on a change to the rows, for the report.
    pub fn add_note(&mut self, what: String) {
        self.notes.push(what);
    }

    /// Notes on changes to the rows.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Adds the notes on the rows to a failure, as possible causes.
    pub fn with_notes(&self, failure: Failure) -> Failure {
        if self.notes.is_empty() {
            return failure;
        }
        let help = failure.full_help().map_or_else(String::new, |help| format!("{help}\n"));
        failure.with_help(format!("{help}changes to the rows: {}", self.notes.join(" ")))
    }

    /// Keeps the rows marked true.
    pub fn retain_rows(&mut self, keep: &[bool]) {
        let kept = |row: usize| keep.get(row).copied().unwrap_or_default();
        for values in &mut self.values {
            let mut row = 0;
            values.retain(|_| {
                row += 1;
                kept(row - 1)
            });
        }
        let mut row = 0;
        self.places.retain(|_| {
            row += 1;
            kept(row - 1)
        });
    }

    /// Sets the values of a column, replacing those of a column with this name.
    pub fn set(&mut self, name: &str, values: Vec<f64>) {
        match self.names.iter().position(|known| known == name) {
            Some(place) => self.values[place] = values,
            None => {
                self.names.push(name.to_owned());
                self.values.push(values);
            }
        }
    }

    /// Hides a column by renaming it.
    pub fn hide(&mut self, name: &str) {
        self.names.iter_mut().filter(|known| *known == name).for_each(|known| known.insert(0, '~'));
    }

    /// Returns true if a row equals the row before in all columns.
    pub fn is_repeated(&self, row: usize) -> bool {
        let same =
            |values: &Vec<f64>| values[row] == values[row - 1] || (values[row].is_nan() && values[row - 1].is_nan());
        self.values.iter().all(same)
    }

    /// Removes rows with an empty value in a needed column. Of each list of columns the first one present, if any, is
    /// needed.
    pub fn remove_incomplete(&mut self, needed: &[&[&str]]) -> Outcome<()> {
        let places: Vec<usize> =
            needed.iter().filter_map(|columns| self.first_index(columns).map(|(_, place)| place)).collect();
        // Text that is no number is an error, not a missing value.
        for place in &places {
            if let Some(row) = self.values[*place].iter().position(|value| value.is_infinite()) {
                return Err(self.not_finite(row, &self.names[*place]));
            }
        }
        let is_empty = |place: usize, row: usize| self.values[place][row].is_nan();
        let keep: Vec<bool> =
            (0..self.places.len()).map(|row| places.iter().all(|place| !is_empty(*place, row))).collect();
        let (rows, left) = (keep.len(), keep.iter().filter(|keep| **keep).count());
        if left == rows {
            return Ok(());
        }
        let empty = |place: &usize| {
            let count = (0..rows).filter(|row| is_empty(*place, *row)).count();
            (count > 0).then(|| format!("`{}` is empty in {count}", self.names[*place]))
        };
        let empty: Vec<String> = places.iter().filter_map(empty).collect();
        if left == 0 {
            return Err(Failure::new(format!("no row has all values: of {rows} rows {}", empty.join(", "))).with_help(
                "each quantity is logged at its own times: log motor, output and torque in one message, or export \
                     them at common times; values from other times are not used, as they would mimic lost motion",
            ));
        }
        self.add_note(format!(
            "{} of {rows} rows were removed because a value is missing: {}.",
            rows - left,
            empty.join(", ")
        ));
        self.retain_rows(&keep);
        Ok(())
    }

    /// Returns true if motor, output and torque are present.
    pub fn has_required(&self) -> bool {
        self.has_required_of([true; 2])
    }

    /// Returns true if the torque and the needed ones of motor and output are present.
    pub fn has_required_of(&self, [motor, output]: [bool; 2]) -> bool {
        let has = |wanted: &[&str]| {
            let all = KNOWN.iter().filter(|(name, _)| wanted.contains(name));
            all.flat_map(|(name, others)| others.iter().chain([name])).any(|name| self.names().any(|own| own == *name))
        };
        let bare = |name: &str| self.names().any(|own| own == name);
        (!motor || has(&MOTOR) || bare("motor_angle"))
            && (!output || has(&OUTPUT) || bare("output_angle"))
            && (has(&["motor_torque_N_m"]) || bare("motor_torque"))
    }

    /// Returns true if both encoders are present as counts.
    pub fn have_counts(&self) -> bool {
        ["motor_counts", "output_counts"].iter().all(|wanted| self.names().any(|own| own == *wanted))
    }

    /// Names in order of the columns.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// Place of a row in its file.
    pub fn place(&self, row: usize) -> String {
        format!("{} {}", self.row, self.places.get(row).copied().unwrap_or_default())
    }

    /// Time, converted from its unit [s].
    pub fn time(&self) -> Outcome<Vec<f64>> {
        let (name, mut values) = self.named(&TIMES)?;
        let second = match name {
            "time_ms" => 1e-3,
            "time_us" => 1e-6,
            _ => 1.0,
        };
        values.iter_mut().for_each(|time| *time *= second);
        Ok(values)
    }

    /// Time since the first row [s].
    pub fn time_from_start(&self) -> Outcome<Vec<f64>> {
        let mut time = self.time()?;
        let start = time.first().copied().unwrap_or_default();
        time.iter_mut().for_each(|time| *time -= start);
        Ok(time)
    }

    /// Canonical name and values of the first of these columns present, under any alias.
    pub fn named<'n>(&self, columns: &[&'n str]) -> Outcome<(&'n str, Vec<f64>)> {
        self.first_of(columns)?.ok_or_else(|| self.missing(columns.first().copied().unwrap_or_default()))
    }

    /// Canonical name and values of the first of these columns present; `None` without one.
    pub fn first_of<'n>(&self, columns: &[&'n str]) -> Outcome<Option<(&'n str, Vec<f64>)>> {
        match self.first_index(columns) {
            Some((column, place)) => Ok(self.finite(&self.names[place])?.map(|values| (column, values))),
            None => Ok(None),
        }
    }

    /// Canonical name and index of the first of these columns present, under any alias.
    fn first_index<'n>(&self, columns: &[&'n str]) -> Option<(&'n str, usize)> {
        columns.iter().find_map(|&column| {
            let others = KNOWN.iter().find(|(name, _)| *name == column).map_or(&[][..], |(_, others)| *others);
            let mut names = std::iter::once(column).chain(others.iter().copied());
            names.find_map(|name| self.names.iter().position(|known| known == name)).map(|place| (column, place))
        })
    }

    /// Name in the log of the first of these columns present.
    pub fn name_of(&self, columns: &[&str]) -> Option<&str> {
        self.first_index(columns).map(|(_, place)| self.names[place].as_str())
    }

    /// Failure for a log with a single encoder, with the limits of such a log.
    pub fn missing_encoder(&self, what: &str) -> Failure {
        let counts = format!("{what}_counts");
        // A column of the other encoder is not a misspelling of this one.
        let strangers =
            self.names().filter(|name| KNOWN.iter().all(|(known, others)| known != name && !others.contains(name)));
        if joint_file::nearest(&counts, strangers).is_some() {
            return self.missing(&counts);
        }
        let there: Vec<&str> = self.names().take(12).collect();
        let there = there.join(", ");
        let tells = match what {
            "motor" => {
                "an output alone shows neither lost motion (an upper bound at most), nor stiffness, nor an error map"
            }
            _ => {
                "a motor alone shows no lost motion, stiffness or error map, as it does not show the output while the \
                     motor crosses the gap"
            }
        };
        let difference = if what == "motor" { format!(" (in a slow log {DIFFERENCE})") } else { String::new() };
        Failure::new(format!("there is no column for the {what} ({there} are there): {tells}")).with_help(format!(
            "name it {counts} or {what}_angle_rad{difference}, or read a column of another name or number: \
                 --column {counts}=NAME"
        ))
    }

    fn missing(&self, wanted: &str) -> Failure {
        let near = joint_file::nearest(wanted, self.names());
        let there = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        Failure::new(format!("there is no column `{wanted}`{there}")).with_help(HEADER_HELP)
    }

    /// Values under a name, unchecked.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let place = self.names.iter().position(|known| known == name)?;
        self.values.get(place).map(Vec::as_slice)
    }

    /// Values under a name; fails unless all are finite.
    pub fn finite(&self, name: &str) -> Outcome<Option<Vec<f64>>> {
        let Some(place) = self.names.iter().position(|known| known == name) else { return Ok(None) };
        let values = &self.values[place];
        match values.iter().position(|value| !value.is_finite()) {
            Some(row) => Err(self.not_finite(row, name)),
            None => Ok(Some(values.clone())),
        }
    }

    fn not_finite(&self, row: usize, name: &str) -> Failure {
        Failure::new(format!("{} has no finite number for `{name}`", self.place(row)))
            .with_help("write a number with a decimal point in every row, or cut the log there")
    }
}
