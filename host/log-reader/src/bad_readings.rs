//! Bad readings of an encoder: up to three samples that jump away from the motion and return, as after a flipped bit or
//! a lost frame. The rows are removed with a note, and nothing near them is used, as for any lost sample. A log with
//! too many is rejected.

use std::f64::consts::TAU;

use super::columns::Columns;
use super::register::Register;
use super::resolution::count_angle;
use report::failure::{Failure, Outcome};

/// Largest share of rows removed for bad readings of one encoder.
pub const BAD_SHARE_MAX: f64 = 0.01;
/// Longest run of bad readings [rows].
const RUN_ROWS_MAX: usize = 3;
/// A reading jumps if it deviates from the motion by JUMP times the usual change of a step ...
const JUMP: f64 = 20.0;
/// ... which is this quantile of the changes: each bad reading spoils three changes, so up to 6 % bad readings are
/// found ...
const USUAL_CHANGE_QUANTILE: f64 = 0.8;
/// ... and by this many counts.
const JUMP_COUNTS_MIN: f64 = 8.0;
/// Rows named in a failure.
const ROWS_NAMED: usize = 5;

/// Column of an encoder.
#[derive(Debug, Clone, PartialEq)]
pub struct EncoderColumn {
    /// Name of the column.
    pub name: String,
    /// True for counts, false for angles in rad.
    pub is_counts: bool,
    /// Size of a turn, in the unit of the column.
    pub turn: f64,
}

/// Removes rows with bad readings of an encoder. `names` are its columns of counts and of angles [rad]. Returns the
/// column in the log; `None` if the encoder was not logged.
pub fn remove_from_encoder(
    columns: &mut Columns,
    names: [&'static str; 2],
    counts_per_turn: u64,
) -> Outcome<Option<EncoderColumn>> {
    let Some(name) = columns.name_of(&names).map(str::to_owned) else { return Ok(None) };
    let is_counts = columns.first_of(&names[..1])?.is_some();
    let (count, turn) = if is_counts { (1.0, counts_per_turn as f64) } else { (count_angle(counts_per_turn), TAU) };
    remove_from_column(columns, &name, count, Some(turn))?;
    Ok(Some(EncoderColumn { name, is_counts, turn }))
}

/// Removes rows with bad readings in a column. `count` is its resolution, `turn` the size of a turn, if known.
pub fn remove_from_column(columns: &mut Columns, name: &str, count: f64, turn: Option<f64>) -> Outcome<()> {
    let Some(values) = columns.finite(name)? else { return Ok(()) };
    let bad = find(&values, Register::find(&values, turn).as_ref(), count);
    if bad.is_empty() {
        return Ok(());
    }
    let share = bad.len() as f64 / values.len() as f64;
    let places: Vec<String> = bad.iter().take(ROWS_NAMED).map(|row| columns.place(*row)).collect();
    let more = if bad.len() > ROWS_NAMED { ", ..." } else { "" };
    let note = format!(
        "{} of {} readings of `{name}` ({:.2} %) jump away from the motion and return: {}{more}",
        bad.len(),
        values.len(),
        100.0 * share,
        places.join(", ")
    );
    if share > BAD_SHARE_MAX {
        return Err(Failure::new(note).with_help(format!(
            "up to {:.0} % are removed; with more, look for flipped bits or lost frames: the encoder's cable and \
                 supply, its parity or checksum, and that the column is `{name}`",
            100.0 * BAD_SHARE_MAX
        )));
    }
    let mut keep = vec![true; values.len()];
    bad.iter().for_each(|row| keep[*row] = false);
    columns.retain_rows(&keep);
    columns.add_note(format!("{note}; left out."));
    Ok(())
}

/// Rows whose readings jump away and return.
fn find(values: &[f64], register: Option<&Register>, count: f64) -> Vec<usize> {
    let step = |from: usize, to: usize| {
        let step = values[to] - values[from];
        register.map_or(step, |register| register.shorter(step))
    };
    let change = |difference: f64| register.map_or(difference, |register| register.shorter(difference));
    let mut changes: Vec<f64> =
        (2..values.len()).map(|row| change(step(row - 1, row) - step(row - 2, row - 1)).abs()).collect();
    changes.sort_by(f64::total_cmp);
    let Some(usual) = changes.get((changes.len() as f64 * USUAL_CHANGE_QUANTILE) as usize) else { return Vec::new() };
    let jump = (JUMP * usual).max(JUMP_COUNTS_MIN * count);
    let out = |row: usize| register.is_some_and(|register| !register.holds(values[row]));
    // Returns true if a row is outside of the register, or jumps from the extrapolation of two earlier rows.
    let jumps = |[first, second]: [usize; 2], row: usize| {
        let rate = step(first, second) / (second - first) as f64;
        let ahead = (row - second) as f64;
        out(row) || change(step(second, row) - rate * ahead).abs() > jump
    };
    // First row from which the motion is even.
    let even = |row: &usize| !out(*row) && !out(row + 1) && !jumps([*row, row + 1], row + 2);
    let start = (0..=RUN_ROWS_MAX.min(values.len() - 3)).find(even).unwrap_or_default();
    let mut bad: Vec<usize> = (0..start).collect();
    let mut good = [start, start + 1];
    let mut row = start + 2;
    while row < values.len() {
        if !jumps(good, row) {
            (good, row) = ([good[1], row], row + 1);
            continue;
        }
        let back = |to: &usize| !jumps(good, *to) && (to + 1 == values.len() || !jumps([good[1], *to], to + 1));
        match (row + 1..(row + RUN_ROWS_MAX + 1).min(values.len())).find(back) {
            Some(to) => {
                bad.extend(row..to);
                (good, row) = ([good[1], to], to + 1);
            }
            None if row + RUN_ROWS_MAX >= values.len() => {
                bad.extend(row..values.len());
                break;
            }
            // The readings do not return: the motion continues from here, or the readings are rejected as a whole
            // later.
            None => (good, row) = ([row, (row + 1).min(values.len() - 1)], row + 2),
        }
    }
    bad
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURN: f64 = 16384.0;

    /// Motion to and fro over turns, in a register of a turn or without one.
    fn motion(wraps: bool) -> Vec<f64> {
        let at = |row: i32| (30_000.0 * (f64::from(row) * 1e-2).sin()).round();
        (0..3000).map(|row| if wraps { at(row).rem_euclid(TURN) } else { at(row) }).collect()
    }

    fn found(values: &[f64]) -> Vec<usize> {
        find(values, Register::find(values, Some(TURN)).as_ref(), 1.0)
    }

    /// Readings that jump away and return are found anywhere in the log.
    #[test]
    fn bad_readings_are_found_anywhere() {
        for wraps in [false, true] {
            assert_eq!(found(&motion(wraps)), Vec::<usize>::new(), "{wraps}: nothing in a good log");
            for (rows, by) in [
                (&[500_usize][..], 8192.0),
                (&[0], 4000.0),
                (&[2999], 4000.0),
                (&[700, 701, 702], -3000.0),
                (&[100, 900, 901, 1800, 2998], 2048.0),
            ] {
                let mut values = motion(wraps);
                rows.iter().for_each(|row| values[*row] += by);
                assert_eq!(found(&values), rows, "{wraps}: {by}");
            }
            let mut zeros = motion(wraps);
            (zeros[411], zeros[1200]) = (1e6, 1e6);
            assert_eq!(found(&zeros), [411, 1200]);
        }
    }

    /// An impact, a slip and repeated readings are not bad readings.
    #[test]
    fn impact_slip_and_repeats_are_kept() {
        for every in [2, 5, 10] {
            let stale: Vec<f64> = (0..3000).map(|row| motion(false)[row / every * every]).collect();
            assert_eq!(found(&stale), Vec::<usize>::new(), "{every}");
        }
        let blow: Vec<f64> =
            (0..2000_i32).map(|row| f64::from(if row < 1000 { 90 * row } else { 180_000 - 90 * row })).collect();
        assert_eq!(found(&blow), Vec::<usize>::new());
        let mut slipped = motion(false);
        slipped.iter_mut().skip(1500).for_each(|value| *value += 5000.0);
        assert_eq!(found(&slipped), Vec::<usize>::new());
    }
}
