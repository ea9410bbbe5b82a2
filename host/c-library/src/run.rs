//! Closed loop of `bindings/c/programs/run.h` on the core itself, with equal motion, push, output gap and digest.

use model_core::compensation::{Command, Compensation, ImpedancePoint, Motion, Position};
use model_core::controller::Controller;
use model_core::gears::Tables;
use model_core::numbers::digest::{START, chain};
use model_core::observer::{MAPPED, Observer, Source};
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};
use model_core::width_probe::ProbeProgress;
use model_core::wiring::{WiringCheck, WiringProgress};
use report::failure::{Failure, Outcome};
use table_blob::{Blob, Gears};

/// Digest after a number of periods, from the tables of the C program.
pub fn digest(words: &[u64], periods: u32) -> Outcome<u64> {
    let invalid_tables = |error| Failure::new(format!("invalid tables: {error:?}"));
    let blob = Blob::open(words).map_err(invalid_tables)?;
    let (gears, around) = blob.plant().map_err(invalid_tables)?;
    match gears {
        Gears::One(gears) => closed_loop(&blob, gears, around, periods),
        Gears::Three(gears) => closed_loop(&blob, gears, around, periods),
        Gears::Four(gears) => closed_loop(&blob, gears, around, periods),
        Gears::Five(gears) => closed_loop(&blob, gears, around, periods),
    }
    .map_err(invalid_tables)
}

fn closed_loop<const N: usize>(
    blob: &Blob<'_>,
    gears: &Tables<f32, N>,
    around: &SurroundingsTable<f32>,
    periods: u32,
) -> Result<u64, table_blob::BlobError> {
    let (observer_tables, compensation_tables) = (blob.observer()?, blob.compensation()?);
    let rate = blob.header().control_rate;
    let scale = rate / 10_000;
    let lead = (compensation_tables.crossing.lead * rate as f32) as u32;
    let mut joint = VirtualJoint::new(gears, around);
    let mut observer = Observer::<f32, MAPPED>::new(observer_tables);
    let mut compensation = Compensation::new(compensation_tables);
    let mut running = START;
    for period in 0..periods {
        let (now, ahead) = (motion(scale, period), motion(scale, period + lead));
        let push = if (period / (1700 * scale)).is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut samples = joint.samples();
        if (15_000 * scale..16_000 * scale).contains(&period) {
            samples.output = None;
        }
        let estimates = *observer.step(&samples);
        let command = if (period / (10_000 * scale)).is_multiple_of(2) {
            Command::Position { now, ahead: Some(ahead) }
        } else {
            let Motion { position, speed, .. } = now;
            Command::Impedance(ImpedancePoint { position, speed, torque: 0.0, stiffness: 100.0, damping: 3.0 })
        };
        let shaped = compensation.step(&estimates, &command);
        joint.advance(shaped.torque, push);
        let said = [
            shaped.torque,
            shaped.trust,
            shaped.demand,
            estimates.gap.value,
            estimates.gap.variance,
            estimates.half_backlash.value,
            estimates.load_torque.value,
            estimates.compliance.value,
            estimates.skew.value,
            estimates.motor.fraction,
            estimates.link.speed,
        ];
        let digest = said.iter().fold(running, |digest, value| chain(digest, value.to_bits().into()));
        let source = match estimates.source {
            Source::Nothing(_) => 0,
            Source::MotorOnly(_) => 1,
            Source::Both => 2,
        };
        let digest = chain(digest, u64::from(estimates.reported_contact.code()) << 8 | source);
        running = chain(digest, joint.model().state_digest());
    }
    Ok(running)
}

/// Bang-bang motion to and fro by a twentieth of a turn, from integers and single multiplications.
fn motion(scale: u32, period: u32) -> Motion<f32> {
    let half = 1250 * scale;
    let segment = 2 * half;
    let (since, backwards) = (period % segment, !(period / segment).is_multiple_of(2));
    let (left, begun) = (segment - since, since < half);
    let way = if begun { since * since } else { 2 * half * half - left * left };
    let place = if backwards { 2 * half * half - way } else { way };
    let speed = if begun { since } else { left } as i32 * if backwards { -1 } else { 1 };
    let share = if scale == 1 { 1.0_f32 } else { 0.5 };
    Motion {
        position: Position { turns: 0, fraction: place as f32 * (1.6e-8 * share * share) },
        speed: speed as f32 * (0.002_010_619_3 * share),
        acceleration: if begun == backwards { -20.106_193 } else { 20.106_193 },
    }
}

/// Wiring checks of `bindings/c/programs/wiring.c` on the core itself: digest of the torques.
pub fn wiring_digest(words: &[u64]) -> Outcome<u64> {
    let invalid_tables = |error| Failure::new(format!("invalid tables: {error:?}"));
    let blob = Blob::open(words).map_err(invalid_tables)?;
    let (Gears::Three(gears), around) = blob.plant().map_err(invalid_tables)? else {
        return Err(Failure::new("the wiring check needs a joint with three planets"));
    };
    let table = blob.wiring().map_err(invalid_tables)?;
    let mut running = START;
    for miswiring in 0..4 {
        let (mut joint, mut check) = (VirtualJoint::new(gears, around), WiringCheck::new(table));
        let mut torque = 0.0;
        for _ in 0..200_000 {
            let mut samples = joint.samples();
            if let (1, Some(output)) = (miswiring, &mut samples.output) {
                output.counts = table.counts.output.last - output.counts;
            } else if miswiring == 2 {
                samples.motor.counts = table.counts.motor.last - samples.motor.counts;
            }
            samples.torque = torque;
            let progress;
            (torque, progress) = check.step(&samples, 0.5);
            joint.advance(if miswiring == 3 { -torque } else { torque }, 0.0);
            running = chain(running, torque.to_bits().into());
            if progress != WiringProgress::Running {
                break;
            }
        }
    }
    Ok(running)
}

/// Width probe of `bindings/c/programs/probe.c` on the core itself: digest of torques and widths over a number of
/// periods.
pub fn probe_digest(words: &[u64], periods: u32) -> Outcome<u64> {
    let invalid_tables = |error| Failure::new(format!("invalid tables: {error:?}"));
    let blob = Blob::open(words).map_err(invalid_tables)?;
    let (Gears::Three(gears), around) = blob.plant().map_err(invalid_tables)? else {
        return Err(Failure::new("the width probe needs a joint with three planets"));
    };
    let mut joint = VirtualJoint::new(gears, around);
    let (observer, compensation) =
        (blob.observer().map_err(invalid_tables)?, blob.compensation().map_err(invalid_tables)?);
    let mut controller =
        Controller::with_tables(observer, compensation).with_probe(Some(blob.probe().map_err(invalid_tables)?));
    let mut running = START;
    for _ in 0..periods {
        let answer = controller.probe(&joint.samples());
        let width = match answer.probed {
            Some(ProbeProgress::Done(width)) => width.value,
            _ => 0.0,
        };
        running = [answer.shaped.torque, width].iter().fold(running, |all, value| chain(all, value.to_bits().into()));
        joint.advance(answer.shaped.torque, 0.0);
    }
    Ok(running)
}
