//! The observer over a recorded log in the format of `joint identify`: position of the motor in the gap, flank in contact, width of the
//! gap. Without a log it records one first, from a virtual joint whose half-backlash has worn to 55 um.
//!
//! `cargo run -p examples --example observe_a_log -- LOG.csv joints/q1.toml`

use std::{env, error::Error, f64::consts::TAU, fs, path::Path};

use joint_file::named::load_with;
use model_core::gears::{self, Tables};
use model_core::observer::{MAPPED, Observer, Reading, Samples, design};
use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
use parameters::Surroundings;

const COLUMNS: &str = "time_s,motor_counts,output_counts,motor_torque_N_m";

fn main() -> Result<(), Box<dyn Error>> {
    let log = env::args().nth(1).map_or_else(record, |file| Ok(fs::read_to_string(file)?))?;
    let name = env::args().nth(2).unwrap_or("q1".into());
    let joint = load_with(Path::new(&name), &[]).map_err(|failure| failure.message().to_owned())?.file;
    let mut rows = csv::Reader::from_reader(log.as_bytes());
    let named = rows.headers()?.iter().eq(COLUMNS.split(','));
    named.then_some(()).ok_or(format!("the columns of a log are {COLUMNS}"))?;
    let rows: Vec<[f64; 4]> = rows.deserialize().collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    let [first, second, ..] = &rows[..] else { return Err("the log has less than two rows".into()) };
    let around = Surroundings { control_rate: (1.0 / (second[0] - first[0])).round() as u32, ..joint.surroundings };
    let tables = design::design_observer(&joint.parameters, &design::observer_settings(&around))?;
    // The torque of a row acts after its readings: the observer receives it with the next readings.
    let (mut observer, mut torque) = (Observer::<f32, MAPPED>::new(&tables), 0.0);
    println!("time_s  gap_um  flank       half_backlash_um  deviation_um");
    for (period, row) in (0_u32..).zip(&rows) {
        let time = period.wrapping_mul(design::CLOCK_TICKS);
        let read = |counts, turn: u64| Reading { counts: (counts as i64).rem_euclid(turn as i64) as u32, time };
        let output = Some(read(row[2], around.output_encoder.counts_per_turn));
        let said =
            observer.step(&Samples { time, motor: read(row[1], around.motor_encoder.counts_per_turn), output, torque });
        torque = row[3] as f32;
        if (period + 1).is_multiple_of((around.control_rate / 10).max(1)) {
            let flank = if said.contact_valid { format!("{:?}", said.reported_contact) } else { "unknown".into() };
            let [gap, half, deviation] = [said.gap.value, said.half_backlash.value, said.half_backlash.variance.sqrt()];
            let [gap_um, half_um, deviation_um] = [gap, half, deviation].map(|length_m| 1e6 * length_m);
            println!("{:6.3}  {gap_um:6.1}  {flank:10}  {half_um:16.1}  {deviation_um:12.1}", row[0]);
        }
    }
    Ok(())
}

/// Log of a test on the virtual joint: the motor swings the link to and fro by a torque that reverses twice a second.
fn record() -> Result<String, Box<dyn Error>> {
    let worn = load_with(Path::new("q1"), &["mesh.half_backlash_um=55".into()]).map_err(|it| it.to_string())?.file;
    let gears: Tables<f32, 3> = gears::design::design(&worn.parameters, worn.surroundings.control_rate)?;
    let table = design_surroundings(&worn.parameters, &worn.surroundings, &gears)?;
    let (mut joint, mut log) = (VirtualJoint::new(&gears, &table), COLUMNS.to_owned());
    for period in 0..6 * worn.surroundings.control_rate {
        let (seen, time_s) = (joint.samples(), f64::from(period) / f64::from(worn.surroundings.control_rate));
        let torque = (2.0 * TAU * time_s).cos() as f32;
        log += &format!("\n{time_s:.6},{},{},{torque:.3}", seen.motor.counts, seen.output.map_or(0, |it| it.counts));
        joint.advance(torque, 0.0);
    }
    Ok(log)
}
