//! The width probe in the loop with a plant: a held load gives the width, everything else a refusal.

use host_tests::tolerance::observer::PROBED_WIDTH;
use model_core::observer::design::{ObserverSettings, design_observer, design_probe};
use model_core::observer::{MAPPED, Observer, ObserverTables, ProbeTable};
use model_core::width_probe::{Probe, ProbeProgress, ProbeRefusal};
use reference::closed_loop::{Controller, SetPoint};
use reference::drive_train::{Disturbance, Measurement};
use scenario::rig::{ActiveController, Period, PeriodSample, Rig, RunError};
use scenario::set_point_source::SetPointSource;

use crate::experiment::{Encoders, Experiment};
use crate::replay::samples;

/// Periods in which the observer settles before the probe begins.
const SETTLES: usize = 1000;

/// Observer and probe as a controller; the first reading is that of the second period.
struct Probing<'t> {
    settings: &'t ObserverSettings,
    observer: Observer<'t, f32, MAPPED>,
    probe: Probe<'t, f32>,
    home: Measurement,
    progress: ProbeProgress<f32>,
    command: f64,
}

impl Controller for Probing<'_> {
    fn period(&mut self, measurement: &Measurement, _: &SetPoint) -> f64 {
        let Some(period) = (measurement.period as usize).checked_sub(1) else { return self.command };
        let moment = PeriodSample {
            command: self.command,
            motor_counts: self.home.motor_counts + measurement.motor_counts,
            output_counts: self.home.output_counts + measurement.output_counts,
            ..PeriodSample::default()
        };
        let estimates = *self.observer.step(&samples(self.settings, &moment, period));
        if period >= SETTLES && self.progress == ProbeProgress::Running {
            let (torque, progress) = self.probe.step(&estimates);
            (self.command, self.progress) = (f64::from(torque), progress);
            assert!(progress == ProbeProgress::Running || torque == 0.0, "a probe ends without a torque");
        }
        self.command
    }
}

/// Runs a probe on Q1 without an output encoder; the load is held by so much dry friction [N m]. What it came to, and the
/// largest force on the teeth [N].
fn probed(half_backlash: f64, seed: u64, holding: f64, pushed_by: f64, torque: f64) -> (ProbeProgress<f32>, f64) {
    let mut experiment = Experiment::new("q1", "hold", Encoders::Preset, Some(half_backlash), seed).lasting(0.7);
    experiment.setup.train.surroundings.load_friction.coulomb = holding;
    experiment.setup.train.surroundings.gravity_torque = 0.0;
    experiment.setup.disturbances = vec![Disturbance::Step { start: 0.0, torque: pushed_by }];
    experiment.settings.output_encoder = None;
    let tables: ObserverTables<f32> = design_observer(&experiment.nominal, &experiment.settings).expect("tables");
    let table: ProbeTable<f32> = design_probe(&experiment.nominal, &experiment.settings, torque).expect("a table");
    let rig = Rig::new(&experiment.setup).expect("a sound drive train");
    let mut probing = Probing {
        settings: &experiment.settings,
        observer: Observer::new(&tables),
        probe: Probe::new(&table),
        home: rig.home(),
        progress: ProbeProgress::Running,
        command: 0.0,
    };
    let mut hardest = 0.0_f64;
    let mut watch = |period: &Period<'_>| -> Result<(), RunError> {
        hardest = hardest.max(period.plant.joint().sun_force().abs());
        Ok(())
    };
    let mut set_points = SetPointSource::of_positions(experiment.setup.motion.clone());
    rig.run(&mut ActiveController::of(Box::new(&mut probing)), &mut set_points, &mut watch).expect("it runs");
    assert!(probing.progress != ProbeProgress::Running, "a probe ends within half a second");
    (probing.progress, hardest)
}

#[test]
fn a_held_load_gives_the_width() {
    for (seed, half_backlash) in [(61, 20e-6), (62, 40e-6), (63, 80e-6)] {
        let (progress, hardest) = probed(half_backlash, seed, 50.0, 0.0, 0.5);
        let ProbeProgress::Done(width) = progress else { panic!("no width: {progress:?}") };
        println!("{half_backlash}: {width:?}, at most {hardest} N");
        PROBED_WIDTH.check(f64::from(width.value) / half_backlash - 1.0);
        assert!(hardest < 300.0, "{hardest} N is no gentle landing");
    }
}

#[test]
fn a_load_that_is_free_or_pushes_is_refused() {
    assert_eq!(probed(40e-6, 64, 0.05, 0.0, 0.5).0, ProbeProgress::Refused(ProbeRefusal::NotHeld));
    let pushed = probed(40e-6, 65, 0.0, 4.0, 0.5).0;
    assert!(matches!(pushed, ProbeProgress::Refused(_)), "{pushed:?}");
}

#[test]
fn a_probe_that_friction_would_swallow_is_not_designed() {
    let experiment = Experiment::new("q1", "hold", Encoders::Preset, Some(40e-6), 66);
    let refusal = design_probe::<f32>(&experiment.nominal, &experiment.settings, 0.05).expect_err("too little torque");
    assert!(refusal.to_string().contains("four times the torque uncertainty"), "{refusal}");
}
