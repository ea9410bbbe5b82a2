//! Core and reference on the same scenario, and the errors between them.

use host_tests::tolerance::Bound;
use model_core::gears::design::{Effort, design_scheme};
use model_core::gears::{Model, Scheme, Tables, Torques};
use model_core::numbers::Real;
use parameters::JointParameters;
use reference::joint::{Observation, Start};
use reference::scenarios;
use reference::scenarios::Scenario;
use simulation::sim::start::core_state;

/// Sample of core or reference: mesh deflections, gap, link relative to the rigid body.
struct Snapshot {
    deflections: [Vec<f64>; 2],
    gap: f64,
    link_offset: f64,
}

/// RMS errors over standard deviations: all mesh deflections together, gap, link relative to the rigid body.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    pub deflection: f64,
    pub gap: f64,
    pub link: f64,
}

impl Errors {
    pub fn worst(&self) -> f64 {
        self.deflection.max(self.gap).max(self.link)
    }
}

/// Runs the core through a scenario and samples it at the reference's times.
fn follow<T: Real, const N: usize>(scenario: &Scenario, scheme: Scheme, effort: Effort) -> Vec<Snapshot> {
    let tables: Tables<T, N> =
        design_scheme(&scenario.joint, scenario.tick_rate, scheme, effort).expect("a scenario's joint is sound");
    let mut model = Model::new(&tables);
    model.set_state(core_state(&scenario.joint, &tables, &scenario.start));
    let mut moments = Vec::new();
    for tick in 0..=scenario.ticks {
        if tick % scenario.sample_every == 0 {
            let outputs = model.outputs();
            moments.push(Snapshot {
                deflections: outputs.deflections.map(|family| family.map(Real::to_f64).to_vec()),
                gap: outputs.gap.to_f64(),
                link_offset: outputs.link_offset.to_f64(),
            });
        }
        let (drive, load) = scenario.torques_at(tick);
        model.step(Torques { drive: T::from_f64(drive), load: T::from_f64(load) });
    }
    moments
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

/// Errors of a run over the samples from `from` on.
pub fn errors<T: Real, const N: usize>(scenario: &Scenario, scheme: Scheme, effort: Effort, from: usize) -> Errors {
    let reference = scenarios::run(scenario).expect("the reference follows every scenario").samples;
    let moments = follow::<T, N>(scenario, scheme, effort);
    assert_eq!(reference.len(), moments.len());
    let pairs: Vec<(&Observation, &Snapshot)> = reference.iter().zip(&moments).skip(from).collect();
    let relative = |of: &dyn Fn(&Observation) -> f64, is: &dyn Fn(&Snapshot) -> f64| {
        let expected: Vec<f64> = pairs.iter().map(|(expected, _)| of(expected)).collect();
        let error: Vec<f64> = pairs.iter().map(|(expected, moment)| is(moment) - of(expected)).collect();
        rms(&error) / deviation(&expected)
    };
    let meshes: Vec<f64> = (0..2 * N)
        .map(|mesh| {
            let (kind, i) = (mesh / N, mesh % N);
            relative(&|expected| expected.deflections[kind][i], &|moment| moment.deflections[kind][i])
        })
        .collect();
    Errors {
        deflection: rms(&meshes),
        gap: relative(&|expected| expected.gap, &|moment| moment.gap),
        link: relative(&|expected| expected.link_offset, &|moment| moment.link_offset),
    }
}

/// RMS error of all mesh deflections at the reference's sample times, over b_c.
pub fn rms_error<const N: usize>(
    joint: &JointParameters,
    tables: &Tables<f64, N>,
    start: &Start,
    torques: (f64, f64),
    expected: &[Observation],
) -> f64 {
    let mut model = Model::new(tables);
    model.set_state(core_state(joint, tables, start));
    let mut now = 0;
    let mut squares = 0.0;
    for seen in expected {
        let ticks = (seen.time * f64::from(tables.tick_rate)).round() as u32;
        for _ in now..ticks {
            model.step(Torques { drive: torques.0, load: torques.1 });
        }
        now = ticks;
        let found = model.outputs().deflections;
        for (found, right) in found.iter().flatten().zip(seen.deflections.iter().flatten()) {
            squares += ((found - right) / joint.characteristic_length).powi(2);
        }
    }
    (squares / (2 * N * expected.len()) as f64).sqrt()
}

/// Checks f32 and f64 against a bound.
#[track_caller]
pub fn check<const N: usize>(scenario: &Scenario, effort: Effort, bound: &Bound) {
    for (scalar, errors) in [
        ("f32", errors::<f32, N>(scenario, Scheme::Realtime, effort, 0)),
        ("f64", errors::<f64, N>(scenario, Scheme::Realtime, effort, 0)),
    ] {
        let Errors { deflection, gap, link } = errors;
        println!("{}, {scalar}: meshes {deflection:.1e}, gap {gap:.1e}, link {link:.1e}", scenario.name);
        bound.check(errors.worst());
    }
}
