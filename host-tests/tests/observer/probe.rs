//! The width probe in the loop with a plant: a held load gives the width, everything else a refusal.

use host_tests::tolerance::observer::PROBED_WIDTH;
use model_core::observer::design::{design_observer, design_probe};
use model_core::observer::{MAPPED, Observer, ObserverTables, Probe, ProbeTable, Progress, Refusal};
use reference::drive_train::{Disturbance, DriveTrain};
use reference::joint::Start;

use crate::motion::Moment;
use crate::replay::samples;
use crate::trial::{Encoders, Trial};

/// Runs a probe on Q1 without an output encoder; the load is held by so much dry friction [N m].
fn probed(half_backlash: f64, seed: u64, holding: f64, pushed_by: f64, torque: f64) -> (Progress<f32>, f64) {
    let mut trial = Trial::new("q1", "hold", Encoders::Preset, Some(half_backlash), seed);
    trial.run.train.surroundings.load_friction.coulomb = holding;
    trial.run.train.surroundings.gravity_torque = 0.0;
    trial.settings.output_encoder = None;
    let push = Disturbance::Step { start: 0.0, torque: pushed_by };
    let mut train = DriveTrain::new(&trial.run.joint, &Start::Still, trial.run.train.clone(), vec![push], seed)
        .expect("a sound drive train");
    let tables: ObserverTables<f32> = design_observer(&trial.told, &trial.settings).expect("tables");
    let table: ProbeTable<f32> = design_probe(&trial.told, &trial.settings, torque).expect("a table");
    let mut observer = Observer::<f32, MAPPED>::new(&tables);
    let mut probe = Probe::new(&table);
    let mut command = 0.0;
    let mut hardest = 0.0_f64;
    for period in 0..7000 {
        train.advance(command).expect("it runs");
        hardest = hardest.max(train.joint().sun_force().abs());
        let measured = train.measure();
        let moment = Moment {
            command,
            motor_counts: measured.motor_counts,
            output_counts: measured.output_counts,
            gap: 0.0,
            sun_force: 0.0,
            load_torque: 0.0,
            link: [0.0; 2],
            motor: [0.0; 2],
        };
        let estimates = *observer.step(&samples(&trial.settings, &moment, period));
        // The observer settles first.
        if period < 1000 {
            continue;
        }
        let (torque, progress) = probe.step(&estimates);
        if progress != Progress::Running {
            assert_eq!(torque, 0.0);
            return (progress, hardest);
        }
        command = f64::from(torque);
    }
    panic!("a probe ends within half a second");
}

#[test]
fn a_held_load_gives_the_width() {
    for (seed, half_backlash) in [(61, 20e-6), (62, 40e-6), (63, 80e-6)] {
        let (progress, hardest) = probed(half_backlash, seed, 50.0, 0.0, 0.5);
        let Progress::Done(width) = progress else { panic!("no width: {progress:?}") };
        println!("{half_backlash}: {width:?}, at most {hardest} N");
        PROBED_WIDTH.check(f64::from(width.value) / half_backlash - 1.0);
        assert!(hardest < 300.0, "{hardest} N is no gentle landing");
    }
}

#[test]
fn a_load_that_is_free_or_pushes_is_refused() {
    assert_eq!(probed(40e-6, 64, 0.05, 0.0, 0.5).0, Progress::Refused(Refusal::NotHeld));
    let pushed = probed(40e-6, 65, 0.0, 4.0, 0.5).0;
    assert!(matches!(pushed, Progress::Refused(_)), "{pushed:?}");
}

#[test]
fn a_probe_that_friction_would_swallow_is_not_designed() {
    let trial = Trial::new("q1", "hold", Encoders::Preset, Some(40e-6), 66);
    let refusal = design_probe::<f32>(&trial.told, &trial.settings, 0.05).expect_err("too little torque");
    assert!(refusal.to_string().contains("four times the torque uncertainty"), "{refusal}");
}
