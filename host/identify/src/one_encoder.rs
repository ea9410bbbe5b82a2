//! Logs of one encoder and the motor's torque, row by row: of a joint whose output is held, or whose motor has no encoder.

use std::f64::consts::TAU;

use board::profile::MAX_TORQUE;
use log_reader::bad_readings;
use log_reader::columns::Columns;
use log_reader::register::Register;
use log_reader::resolution::count_angle;
use report::failure::{Failure, Outcome};
use report::number::TYPED;

/// Angles of an encoder, continuous over turns and without bad readings, and its step; nothing if it was not logged [rad].
pub fn angle(columns: &mut Columns, names: [&'static str; 2], turn: u64) -> Outcome<Option<(Vec<f64>, f64)>> {
    let Some(name) = columns.name_of(&names).map(str::to_owned) else { return Ok(None) };
    let count = count_angle(turn);
    let is_counts = columns.first_of(&names[..1])?.is_some();
    let (step, turn) = if is_counts { (1.0, turn as f64) } else { (count, TAU) };
    bad_readings::leave_out(columns, &name, step, Some(turn))?;
    let Some(mut values) = columns.maybe(&name)? else { return Ok(None) };
    if let Some(register) = Register::of(&values, Some(turn)) {
        register.join(&mut values, |_| 1.0);
        register.told(&name, Some(turn)).into_iter().for_each(|told| columns.tell(told));
    }
    if is_counts {
        values.iter_mut().for_each(|value| *value *= count);
    }
    Ok(Some((values, count)))
}

/// Time from the first row on, rising from row to row [s].
pub fn rising_time(columns: &Columns) -> Outcome<Vec<f64>> {
    let time = columns.time_from_start()?;
    match time.windows(2).position(|pair| pair[1] <= pair[0]) {
        None => Ok(time),
        Some(row) => Err(Failure::new(format!("the time does not rise in {}", columns.place(row + 1)))
            .with_help("samples must be in the order in which they were taken, each with its own time")),
    }
}

/// The motor's torque times the ratio [N m].
pub fn torque_at_output(columns: &Columns, ratio: f64) -> Outcome<Vec<f64>> {
    let (_, torque) = columns.named(&["motor_torque_N_m"])?;
    if let Some(row) = torque.iter().position(|torque| torque.abs() > MAX_TORQUE) {
        let message = format!("{}: `motor_torque_N_m` is {}", columns.place(row), TYPED.write(torque[row]));
        return Err(Failure::new(message)
            .with_help(format!("it may be from -{MAX_TORQUE} to {MAX_TORQUE} N m: check the unit")));
    }
    Ok(torque.into_iter().map(|torque| ratio * torque).collect())
}
