//! Columns of a log with one encoder and the motor's torque: the output is clamped, or the motor has no encoder.

use board::profile::MAX_TORQUE;
use log_reader::bad_readings::{self, EncoderColumn};
use log_reader::columns::Columns;
use log_reader::register::Register;
use log_reader::resolution::count_angle;
use report::failure::{Failure, Outcome};
use report::number::TYPED;

/// Returns the angles of an encoder and the angle of a count [rad]; `None` if the encoder was not logged. The angles
/// are continuous over turns; rows with bad readings are removed.
pub fn angle(columns: &mut Columns, names: [&'static str; 2], turn: u64) -> Outcome<Option<(Vec<f64>, f64)>> {
    let count = count_angle(turn);
    let Some(column) = bad_readings::remove_from_encoder(columns, names, turn)? else { return Ok(None) };
    let EncoderColumn { name, is_counts, turn } = column;
    let Some(mut values) = columns.finite(&name)? else { return Ok(None) };
    if let Some(register) = Register::find(&values, Some(turn)) {
        register.join(&mut values, |_| 1.0);
        register.note(&name, Some(turn)).into_iter().for_each(|note| columns.add_note(note));
    }
    if is_counts {
        values.iter_mut().for_each(|value| *value *= count);
    }
    Ok(Some((values, count)))
}

/// Returns the time since the first row [s]; fails where the time does not rise.
pub fn rising_time(columns: &Columns) -> Outcome<Vec<f64>> {
    let time = columns.time_from_start()?;
    match time.windows(2).position(|pair| pair[1] <= pair[0]) {
        None => Ok(time),
        Some(row) => Err(Failure::new(format!("the time does not rise in {}", columns.place(row + 1)))
            .with_help("samples must be in the order in which they were taken, each with its own time")),
    }
}

/// Returns the motor's torque times the ratio [N m].
pub fn torque_at_output(columns: &Columns, ratio: f64) -> Outcome<Vec<f64>> {
    let (_, torque) = columns.named(&["motor_torque_N_m"])?;
    if let Some(row) = torque.iter().position(|torque| torque.abs() > MAX_TORQUE) {
        let message = format!("{}: `motor_torque_N_m` is {}", columns.place(row), TYPED.write(torque[row]));
        return Err(Failure::new(message)
            .with_help(format!("it may be from -{MAX_TORQUE} to {MAX_TORQUE} N m: check the unit")));
    }
    Ok(torque.into_iter().map(|torque| ratio * torque).collect())
}
