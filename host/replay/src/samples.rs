//! An observer's samples from the columns of a log: of a run as its controller received them, of any other log by the
//! time of each row.

use std::f64::consts::TAU;

use model_core::observer::design::{EncoderSettings, ObserverSettings};
use model_core::observer::{Reading, Samples};
use scenario::controller_log::{OBSERVER_TORQUE, OUTPUT_READ, SAMPLE_FIELDS};

use board::profile::MAX_TORQUE;
use joint_file::named::Loaded;
use log_reader::column_map::ColumnMap;
use log_reader::columns::{Columns, MOTOR, OUTPUT, TIMES};
use log_reader::log_file::LogFile;
use log_reader::time_stamps;
use model_core::gears::Kinematics;
use report::failure::{Failure, Outcome};
use report::number::TYPED;

/// Largest relative difference between the rates of rows and of control periods.
const RATE_TOLERANCE: f64 = 0.02;
/// Rows of estimates written per second.
const WRITTEN_RATE: f64 = 1000.0;

/// Remark that only runs of `joint hil TEST` have.
pub const RUN_REMARK: &str = "controller";

/// Samples of a log.
pub struct ReplaySamples {
    /// Time of each row [s].
    pub time: Vec<f64>,
    /// Control period [s].
    pub period: f64,
    /// True if counts were computed from angles.
    pub from_angles: bool,
    /// Changes to the rows of the file, a sentence each.
    pub log_notes: Vec<String>,
    /// Commanded motor torque from each row on [N m].
    pub torque: Vec<f64>,
    samples: Vec<Samples<f32>>,
}

impl ReplaySamples {
    /// Reads a log; `refuses` returns the reason why the joint has no observer at another control rate.
    pub fn read(
        file: &LogFile,
        topic: Option<&str>,
        map: &ColumnMap,
        loaded: &Loaded,
        settings: &ObserverSettings,
        refuses: &dyn Fn(f64) -> Option<Failure>,
    ) -> Outcome<Self> {
        let period = 1.0 / f64::from(settings.control_rate);
        let motor_only = settings.output_encoder.is_none();
        let accepts = |columns: &Columns| columns.has_required_of([true, !motor_only]);
        let mut columns = file.columns(topic, map, loaded.file.parameters.geometry.ratio_by_teeth(), accepts)?;
        let read = if columns.names().any(|name| name == SAMPLE_FIELDS[0]) {
            Self::from_run(&columns, period)
        } else if let Some(controller) = file.remarks().get(RUN_REMARK) {
            Err(missing_samples(controller))
        } else {
            Self::from_columns(&mut columns, settings, period)
        };
        let read = read.and_then(|read| read.check_control_rate(settings, refuses));
        read.map_err(|failure| columns.with_notes(failure).while_doing(file.path().display()))
    }

    /// Samples as the run's controller received them.
    fn from_run(columns: &Columns, period: f64) -> Outcome<Self> {
        let whole = |name: &str| -> Outcome<Vec<u32>> {
            let (_, values) = columns.named(&[name])?;
            let bad = |value: &f64| value.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(value);
            if let Some(row) = values.iter().position(bad) {
                return Err(Failure::new(format!(
                    "{} of `{name}` is not a whole number of 32 bits",
                    columns.place(row)
                ))
                .with_help("use the log as written by `joint hil`"));
            }
            Ok(values.into_iter().map(|value| value as u32).collect())
        };
        let [now, motor, motor_at, output, output_at] = SAMPLE_FIELDS.map(whole);
        let (now, motor, motor_at, output, output_at) = (now?, motor?, motor_at?, output?, output_at?);
        let (_, fresh) = columns.named(&[OUTPUT_READ])?;
        let (_, shown) = columns.named(&[&OBSERVER_TORQUE.to_ascii_lowercase()])?;
        let (_, torque) = columns.named(&["motor_torque_N_m"])?;
        let sample = |row: usize| Samples {
            time: now[row],
            motor: Reading { counts: motor[row], time: motor_at[row] },
            output: (fresh[row] != 0.0).then(|| Reading { counts: output[row], time: output_at[row] }),
            torque: shown[row] as f32,
        };
        let samples = (0..now.len()).map(sample);
        Ok(Self {
            time: columns.time()?,
            period,
            from_angles: false,
            torque,
            samples: samples.collect(),
            log_notes: Vec::new(),
        })
    }

    /// Samples from the rows of any log, one per control period.
    fn from_columns(columns: &mut Columns, settings: &ObserverSettings, period: f64) -> Outcome<Self> {
        let output: &[&str] = if settings.output_encoder.is_some() { &OUTPUT } else { &[] };
        columns.remove_incomplete(&[&TIMES, &MOTOR, output, &["motor_torque_N_m"]])?;
        time_stamps::resolve(columns)?;
        let columns = &*columns;
        let time = columns.time_from_start()?;
        let (motor, motor_angle) = counts(columns, "motor", settings.motor_encoder)?;
        let output = settings.output_encoder.map(|encoder| counts(columns, "output", encoder)).transpose()?;
        let from_angles = motor_angle || output.as_ref().is_some_and(|(_, angle)| *angle);
        let output = output.map(|(counts, _)| counts);
        let (_, torque) = columns.named(&["motor_torque_N_m"])?;
        if let Some(row) = torque.iter().position(|torque| torque.abs() > MAX_TORQUE) {
            let message = format!("{}: `motor_torque_N_m` is {}", columns.place(row), TYPED.write(torque[row]));
            return Err(Failure::new(message)
                .with_help(format!("it may be from -{MAX_TORQUE} to {MAX_TORQUE} N m: check the unit")));
        }
        let clock = f64::from(settings.clock_rate);
        let sample = |row: usize| {
            // The clock wraps like a controller's.
            let now = (time[row] * clock).round() as u64 as u32;
            Samples {
                time: now,
                motor: Reading { counts: motor[row], time: now },
                output: output.as_ref().map(|counts| Reading { counts: counts[row], time: now }),
                // A row's torque acts from its time on; until then the torque of the row before acted.
                torque: row.checked_sub(1).map_or(0.0, |before| torque[before] as f32),
            }
        };
        let samples = (0..time.len()).map(sample).collect();
        let read = Self { period, from_angles, samples, torque, time, log_notes: columns.notes().to_vec() };
        if let Some(row) = read.time.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(Failure::new(format!("the time does not rise in {}", columns.place(row + 1)))
                .with_help("samples must be in the order in which they were taken, each with its own time"));
        }
        Ok(read)
    }

    /// Rejects rows whose rate differs from the control rate.
    fn check_control_rate(
        self,
        settings: &ObserverSettings,
        refuses: &dyn Fn(f64) -> Option<Failure>,
    ) -> Outcome<Self> {
        let mut steps: Vec<f64> = self.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let Some(usual) = steps.get(steps.len() / 2) else {
            return Err(Failure::new(format!("there are only {} samples", self.time.len()))
                .with_help("an observer needs a motion over many control periods"));
        };
        if (usual / self.period - 1.0).abs() > RATE_TOLERANCE {
            let rate = 1.0 / usual;
            let message = format!(
                "its rows have a rate of {rate:.0} Hz, but the control rate of this joint is {} Hz",
                settings.control_rate
            );
            return Err(Failure::new(message).with_help(match refuses(rate.round()) {
                None => {
                    format!("log every control period; if the controller runs at that rate, add --set control_rate_Hz={rate:.0}")
                }
                Some(why) => format!(
                    "log every control period: an observer at the rate of these rows cannot be designed ({}); for a slow \
                         log `joint identify --quasi-static` finds lost motion and friction",
                    why.message()
                ),
            }));
        }
        Ok(self)
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Samples of a control period.
    pub fn at(&self, index: usize) -> Samples<f32> {
        self.samples[index]
    }

    /// Default thinning of the written rows.
    pub fn default_thinning(&self) -> usize {
        (1.0 / (WRITTEN_RATE * self.period)).round().max(1.0) as usize
    }
}

/// Failure for a run's log without an observer's samples.
pub fn missing_samples(controller: &str) -> Failure {
    Failure::new(format!("the log of this run of `{controller}` has no observer's samples")).with_help(
        "only the tested controller logs them, not its rivals nor older versions: run the test again, and use \
             the log of its own controller, if it has an observer",
    )
}

/// Raw counts of an encoder, computed from angles if necessary, and true for angles.
fn counts(columns: &Columns, what: &str, encoder: EncoderSettings) -> Outcome<(Vec<u32>, bool)> {
    let names = [format!("{what}_counts"), format!("{what}_angle_rad")];
    let there = columns.first_of(&[names[0].as_str(), names[1].as_str()])?;
    let (name, values) = there.ok_or_else(|| {
        let of_identify = columns.missing_encoder(what);
        let help = of_identify.help().unwrap_or_default().to_owned();
        Failure::new(format!("an observer needs counts, and there is no column for the {what}")).with_help(help)
    })?;
    let range = if encoder.wraps_at == 0 { 1_i64 << 32 } else { i64::from(encoder.wraps_at) };
    let is_angle = name == names[1];
    let turn = f64::from(encoder.counts_per_turn);
    let mut raw = Vec::with_capacity(values.len());
    for (row, value) in values.iter().enumerate() {
        let counts = if is_angle { (value * turn / TAU).floor() } else { *value };
        if counts.fract() != 0.0 || counts.abs() > 9e15 {
            return Err(Failure::new(format!("{} of `{name}` is not a whole number of counts", columns.place(row)))
                .with_help(format!("angles belong in a column such as {what}_angle_rad")));
        }
        raw.push((counts as i64).rem_euclid(range) as u32);
    }
    Ok((raw, is_angle))
}
