//! The long form: twenty seeds of every trial and fifty random plants. It prints each figure; run it with
//! `cargo test --release -p host-tests --test compensation -- --ignored --nocapture`.

use host_tests::tolerance::compensation::{PLANTS_GAIN, PLANTS_WORST};
use reference::closed_loop::random_plant;
use reference::drive_train::DriveTrainParameters;
use reference::scenarios::q1;
use scenario::trial::{Contender, Trial};

use super::{NO_PREVIEW, PREVIEW, figures};

#[test]
#[ignore = "minutes of computing"]
fn every_trial_on_twenty_seeds() {
    let (joint, train) = (q1(), DriveTrainParameters::q1());
    for seed in 1000..1020 {
        for trial in Trial::standard(&joint, &train, seed) {
            let pid = figures(&trial, Contender::MotorPid);
            let rival = figures(&trial, Contender::OutputIntegral);
            for (name, contender) in [("preview", PREVIEW), ("no preview", NO_PREVIEW)] {
                let ours = figures(&trial, contender);
                println!(
                    "seed {seed} {} {name}: over PID rms {:.3} peak {:.3}, over rival rms {:.3} peak {:.3}, lost motion \
                     {:.1} ms, peak mesh force {:.0} N, {} crossings",
                    trial.name,
                    ours.rms / pid.rms,
                    ours.peak / pid.peak,
                    ours.rms / rival.rms,
                    ours.peak / rival.peak,
                    1e3 * ours.lost_motion_time,
                    ours.peak_mesh_force,
                    ours.crossings
                );
            }
        }
    }
}

#[test]
#[ignore = "minutes of computing"]
fn fifty_random_plants() {
    let (joint, train) = (q1(), DriveTrainParameters::q1());
    let mut ratios = Vec::new();
    for seed in 2000_u64..2050 {
        let mut trial = if seed.is_multiple_of(2) {
            Trial::random(&joint, &train, seed)
        } else {
            Trial::steps(&joint, &train, seed)
        };
        let plant = random_plant(&trial.bench.joint, &trial.bench.train, seed);
        trial.width_factor = plant.width_factor * plant.joint.sun_planet.half_backlash[0] / 40e-6;
        trial.bench.joint = plant.joint;
        trial.bench.train = plant.train;
        let (pid, ours) = (figures(&trial, Contender::MotorPid), figures(&trial, NO_PREVIEW));
        println!(
            "plant {seed} {}: rms {:.3} peak {:.3} of PID's",
            trial.name,
            ours.rms / pid.rms,
            ours.peak / pid.peak
        );
        ratios.push(ours.rms / pid.rms);
    }
    ratios.sort_by(f64::total_cmp);
    PLANTS_GAIN.check(ratios[ratios.len() / 2]);
    PLANTS_WORST.check(ratios[ratios.len() - 1]);
}
