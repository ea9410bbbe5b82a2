//! Repeated time stamps, as of a host that receives several samples at once. The number of the control period or
//! another time column gives the times; repeated rows are removed. Nothing else is guessed.

use super::columns::{Columns, PERIOD, TIMES};
use report::failure::{Failure, Outcome};

/// Periods after which counters wrap.
const COUNTER_PERIODS: [f64; 3] = [256.0, 65_536.0, 4_294_967_296.0];
/// Largest deviation of stamps from evenly counted periods, as a share of the log; if it is larger, the column does not
/// count periods.
const STAMP_DEVIATION_MAX: f64 = 0.02;

/// Gives every row its own time if stamps repeat; rejects a log without a source of the times.
pub fn resolve(columns: &mut Columns) -> Outcome<()> {
    let time = columns.time()?;
    let repeats = time.windows(2).filter(|pair| pair[1] == pair[0]).count();
    if repeats == 0 {
        return Ok(());
    }
    let note = format!("{repeats} of {} rows have the time of the row before", time.len());
    if let Some(counted) = by_periods(columns, &time) {
        columns.set(TIMES[0], counted);
        columns.add_note(format!("{note}: times are those of the control periods that `{PERIOD}` counts."));
        return Ok(());
    }
    let used = columns.first_of(&TIMES)?.map_or(TIMES[0], |(name, _)| name);
    for other in TIMES.into_iter().filter(|name| *name != used) {
        let Some((_, values)) = columns.first_of(&[other])? else { continue };
        if values.windows(2).all(|pair| pair[1] > pair[0]) {
            columns.hide(used);
            columns.add_note(format!("{note} in `{used}`: times are those of `{other}`."));
            return Ok(());
        }
    }
    let keep: Vec<bool> = (0..time.len()).map(|row| row == 0 || !columns.is_repeated(row)).collect();
    let identical = keep.iter().filter(|keep| !**keep).count();
    if identical == repeats {
        columns.retain_rows(&keep);
        columns.add_note(format!("{note} and all its values: left out."));
        return Ok(());
    }
    let first = (1..time.len()).find(|row| time[*row] == time[row - 1] && keep[*row]).unwrap_or_default();
    let has_counter = columns.column(PERIOD).is_some();
    Err(Failure::new(format!("the time does not rise in {}: {note}, with other values", columns.place(first))).with_help(
        if has_counter {
            format!("`{PERIOD}` does not count control periods evenly against the time: log the controller's own clock as \
                 time_us")
        } else {
            format!(
                "log the number of the control period and name its column, --column {PERIOD}=NAME, or the \
                     controller's own clock (--column time_us=NAME); the stamps of a host that receives several samples \
                     at once are not the samples' times"
            )
        },
    ))
}

/// Times from the number of the control period, if it counts up evenly.
fn by_periods(columns: &Columns, time: &[f64]) -> Option<Vec<f64>> {
    let counts = |periods: &&[f64]| periods.iter().all(|period| period.fract() == 0.0 && *period >= 0.0);
    let mut periods = columns.column(PERIOD).filter(counts)?.to_vec();
    if periods.windows(2).any(|pair| pair[1] < pair[0]) {
        let most = periods.iter().copied().fold(0.0, f64::max);
        let wraps = COUNTER_PERIODS.into_iter().find(|wraps| most < *wraps)?;
        let mut last = periods[0];
        for row in 1..periods.len() {
            let step = (periods[row] - last).rem_euclid(wraps);
            last = periods[row];
            periods[row] = periods[row - 1] + step;
        }
    }
    if periods.windows(2).any(|pair| pair[1] <= pair[0]) {
        return None;
    }
    let count = periods.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
    let (of_periods, of_time) = (mean(&periods), mean(time));
    let (mut square, mut product) = (0.0, 0.0);
    for (period, time) in periods.iter().zip(time) {
        square += (period - of_periods).powi(2);
        product += (period - of_periods) * (time - of_time);
    }
    let length = product / square;
    let counted: Vec<f64> = periods.iter().map(|period| of_time + length * (period - of_periods)).collect();
    let off = counted.iter().zip(time).map(|(counted, time)| (counted - time).abs()).fold(0.0, f64::max);
    let duration = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
    (length > 0.0 && off < STAMP_DEVIATION_MAX * duration).then_some(counted)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows stamped in groups of four, with additional columns by row.
    fn log(more: &[(&str, &dyn Fn(usize) -> f64)]) -> Columns {
        let mut columns = Columns::new("line");
        for row in 0..4000 {
            let mut numbers =
                vec![("time_s".to_owned(), (row / 4) as f64 * 4e-4), ("motor_counts".to_owned(), 3.0 * row as f64)];
            numbers.extend(more.iter().map(|(name, value)| ((*name).to_owned(), value(row))));
            assert!(columns.push(row + 2, &numbers));
        }
        columns
    }

    /// A period counter gives the times of repeated stamps, even if it wraps.
    #[test]
    fn period_counter_gives_times() {
        for counter in [&(|row: usize| (row + 7) as f64) as &dyn Fn(usize) -> f64, &|row| (row % 256) as f64] {
            let mut columns = log(&[(PERIOD, counter)]);
            resolve(&mut columns).expect("resolved");
            let time = columns.time().expect("numbers");
            assert!(time.windows(2).all(|pair| ((pair[1] - pair[0]) / 1e-4 - 1.0).abs() < 1e-3), "{:?}", &time[..3]);
            assert!(columns.notes()[0].contains("3000 of 4000 rows"), "{:?}", columns.notes());
        }
        let refused = resolve(&mut log(&[(PERIOD, &|row| (row % 1000) as f64)])).expect_err("it restarts");
        assert!(refused.help().is_some_and(|help| help.contains("does not count control periods")), "{refused}");
    }

    /// Another time column gives the times of repeated stamps.
    #[test]
    fn other_time_column_gives_times() {
        let mut columns = log(&[("time_us", &|row| 100.0 * row as f64)]);
        resolve(&mut columns).expect("resolved");
        assert!((columns.time().expect("numbers")[3] - 3e-4).abs() < 1e-12);
    }

    /// Repeated rows are removed; repeated stamps with other values are rejected.
    #[test]
    fn repeated_rows_are_removed() {
        let mut columns = Columns::new("line");
        for row in [0, 1, 1, 2, 3, 3, 3] {
            assert!(
                columns.push(row, &[("time_s".to_owned(), row as f64), ("motor_counts".to_owned(), 5.0 * row as f64)])
            );
        }
        resolve(&mut columns).expect("resolved");
        assert_eq!(columns.time().expect("numbers"), [0.0, 1.0, 2.0, 3.0]);
        let refused = resolve(&mut log(&[])).expect_err("nothing tells the times");
        assert!(refused.message().contains("line 3") && refused.message().contains("3000 of 4000"), "{refused}");
        assert!(refused.help().is_some_and(|help| help.contains("--column period=NAME")), "{refused}");
    }
}
