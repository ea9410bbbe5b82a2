//! Width probe in the loop with a plant: with a held load it measures the width, otherwise it is rejected.

use crate::recording::PeriodSample;
use host_tests::tolerance::observer::PROBED_WIDTH;
use model_core::observer::design::{ObserverSettings, design_observer, design_probe};
use model_core::observer::{MAPPED, Observer, ObserverTables, ProbeTable};
use model_core::width_probe::{Probe, ProbeProgress, ProbeRefusal};
use reference::closed_loop::{Controller, SetPoint};
use reference::drive_train::{Disturbance, Measurement};
use scenario::rig::{ActiveController, Period, Rig, RunError};
use scenario::set_point_source::SetPointSource;

use crate::experiment::{Encoders, Experiment};
use crate::replay::samples;

/// Periods for the observer to settle before the probe begins.
const SETTLING_PERIODS: usize = 1000;

/// Observer and probe as a controller; the first reading is taken in the second period.
struct ProbeController<'t> {
    settings: &'t ObserverSettings,
    observer: Observer<'t, f32, MAPPED>,
    probe: Probe<'t, f32>,
    home: Measurement,
    progress: ProbeProgress<f32>,
    command: f64,
}

impl Controller for ProbeController<'_> {
    fn period(&mut self, measurement: &Measurement, _: &SetPoint) -> f64 {
        let Some(period) = (measurement.period as usize).checked_sub(1) else { return self.command };
        let moment = PeriodSample {
            command: self.command,
            motor_counts: self.home.motor_counts + measurement.motor_counts,
            output_counts: self.home.output_counts + measurement.output_counts,
            ..PeriodSample::default()
        };
        let estimates = *self.observer.step(&samples(self.settings, &moment, period));
        if period >= SETTLING_PERIODS && self.progress == ProbeProgress::Running {
            let (torque, progress) = self.probe.step(&estimates);
            (self.command, self.progress) = (f64::from(torque), progress);
            assert!(progress == ProbeProgress::Running || torque == 0.0, "a probe ends without a torque");
        }
        self.command
    }
}

/// Result of a probe on Q1 without an output encoder, with the load held by dry friction `holding` [N m], and the largest force on the
/// teeth [N].
fn run_probe(half_backlash: f64, seed: u64, holding: f64, pushed_by: f64, torque: f64) -> (ProbeProgress<f32>, f64) {
    let mut experiment = Experiment::new("q1", "hold", Encoders::Preset, Some(half_backlash), seed).lasting(0.7);
    experiment.setup.train.surroundings.load_friction.coulomb = holding;
    experiment.setup.train.surroundings.gravity_torque = 0.0;
    experiment.setup.disturbances = vec![Disturbance::Step { start: 0.0, torque: pushed_by }];
    experiment.settings.output_encoder = None;
    let tables: ObserverTables<f32> = design_observer(&experiment.nominal, &experiment.settings).expect("tables");
    let table: ProbeTable<f32> = design_probe(&experiment.nominal, &experiment.settings, torque).expect("a table");
    let rig = Rig::new(&experiment.setup).expect("a sound drive train");
    let mut controller = ProbeController {
        settings: &experiment.settings,
        observer: Observer::new(&tables),
        probe: Probe::new(&table),
        home: rig.home(),
        progress: ProbeProgress::Running,
        command: 0.0,
    };
    let mut peak_force = 0.0_f64;
    let mut watch = |period: &Period<'_>| -> Result<(), RunError> {
        peak_force = peak_force.max(period.plant.joint().sun_force().abs());
        Ok(())
    };
    let mut set_points = SetPointSource::of_positions(experiment.setup.motion.clone());
    rig.run(&mut ActiveController::from_rival(Box::new(&mut controller)), &mut set_points, &mut watch)
        .expect("it runs");
    assert!(controller.progress != ProbeProgress::Running, "a probe ends within half a second");
    (controller.progress, peak_force)
}

/// With a held load the probe measures the half-backlash.
#[test]
fn held_load_gives_the_width() {
    for (seed, half_backlash) in [(61, 20e-6), (62, 40e-6), (63, 80e-6)] {
        let (progress, peak_force) = run_probe(half_backlash, seed, 50.0, 0.0, 0.5);
        let ProbeProgress::Done(width) = progress else { panic!("no width: {progress:?}") };
        println!("{half_backlash}: {width:?}, at most {peak_force} N");
        PROBED_WIDTH.check(f64::from(width.value) / half_backlash - 1.0);
        assert!(peak_force < 300.0, "{peak_force} N is no gentle landing");
    }
}

/// A free or driven load ends the probe with a refusal.
#[test]
fn free_or_driven_load_is_refused() {
    assert_eq!(run_probe(40e-6, 64, 0.05, 0.0, 0.5).0, ProbeProgress::Refused(ProbeRefusal::NotHeld));
    let pushed = run_probe(40e-6, 65, 0.0, 4.0, 0.5).0;
    assert!(matches!(pushed, ProbeProgress::Refused(_)), "{pushed:?}");
}

/// The design rejects a probe torque too small against friction.
#[test]
fn weak_probe_is_rejected() {
    let experiment = Experiment::new("q1", "hold", Encoders::Preset, Some(40e-6), 66);
    let refusal = design_probe::<f32>(&experiment.nominal, &experiment.settings, 0.05).expect_err("too little torque");
    assert!(refusal.to_string().contains("four times the torque uncertainty"), "{refusal}");
}
