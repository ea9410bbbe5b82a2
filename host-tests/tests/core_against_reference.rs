//! The core's fixed step at 20 kHz against the independent reference, scenario by scenario, in f32 as on a board and
//! in f64 from the same source. Errors are RMS over the motion's own standard deviation; bounds stand in `tolerance`.

use std::array;

use host_tests::reference::{Observation, RelativeState, Start};
use host_tests::scenarios::{self, Scenario};
use host_tests::tolerance::{self, Bound};
use model_core::design::{Effort, design_scheme};
use model_core::real::Real;
use model_core::realtime::{Model, Relative, State, Torques};
use model_core::scales::Scales;
use model_core::tables::{Scheme, Tables};

/// What the core and the reference both say at one moment: mesh deflections, gap, link less rigid body.
struct Moment {
    deflections: [[f64; 3]; 2],
    gap: f64,
    link_offset: f64,
}

/// RMS errors over standard deviations.
#[derive(Debug, Clone, Copy)]
struct Errors {
    deflection: f64,
    gap: f64,
    link: f64,
}

impl Errors {
    fn worst(&self) -> f64 {
        self.deflection.max(self.gap).max(self.link)
    }
}

fn state<T: Real>(tables: &Tables<T, 3>, scenario: &Scenario) -> State<T, 3> {
    let Start::Relative(start) = &scenario.start else { return State::REST };
    let length = scenario.joint.characteristic_length;
    let speed = length * Scales::new(&scenario.joint).frequency;
    let relative = |planets: &[f64], gap: f64, wind_up: f64, unit: f64| Relative {
        planets: array::from_fn(|i| T::from_f64(planets[i] / unit)),
        gap: T::from_f64(gap / unit),
        wind_up: T::from_f64(wind_up / unit),
    };
    State::from_deflections(
        tables,
        &relative(&start.sun_planet, start.gap, start.wind_up, length),
        &relative(&start.sun_planet_rate, start.gap_rate, start.wind_up_rate, speed),
        T::from_f64(start.rigid_speed),
    )
}

/// The core through a scenario, sampled as the reference is.
fn follow<T: Real>(scenario: &Scenario, scheme: Scheme, effort: Effort) -> Vec<Moment> {
    let tables: Tables<T, 3> =
        design_scheme(&scenario.joint, scenario.tick_rate, scheme, effort).expect("a scenario's joint is sound");
    let mut model = Model::new(&tables);
    model.set_state(state(&tables, scenario));
    let mut moments = Vec::new();
    for tick in 0..=scenario.ticks {
        if tick % scenario.sample_every == 0 {
            let outputs = model.outputs();
            moments.push(Moment {
                deflections: outputs.deflections.map(|family| family.map(Real::to_f64)),
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
fn errors<T: Real>(scenario: &Scenario, scheme: Scheme, effort: Effort, from: usize) -> Errors {
    let reference = scenarios::run(scenario).expect("the reference follows every scenario").samples;
    let moments = follow::<T>(scenario, scheme, effort);
    assert_eq!(reference.len(), moments.len());
    let pairs: Vec<(&Observation, &Moment)> = reference.iter().zip(&moments).skip(from).collect();
    let relative = |of: &dyn Fn(&Observation) -> f64, is: &dyn Fn(&Moment) -> f64| {
        let expected: Vec<f64> = pairs.iter().map(|(expected, _)| of(expected)).collect();
        let error: Vec<f64> = pairs.iter().map(|(expected, moment)| is(moment) - of(expected)).collect();
        rms(&error) / deviation(&expected)
    };
    let meshes: Vec<f64> = (0..6)
        .map(|mesh| {
            let (kind, i) = (mesh / 3, mesh % 3);
            relative(&|expected| expected.deflections[kind][i], &|moment| moment.deflections[kind][i])
        })
        .collect();
    Errors {
        deflection: rms(&meshes),
        gap: relative(&|expected| expected.gap, &|moment| moment.gap),
        link: relative(&|expected| expected.link_offset, &|moment| moment.link_offset),
    }
}

fn named(name: &str) -> Scenario {
    let all = scenarios::motions();
    let names: Vec<String> = all.iter().map(|scenario| scenario.name.clone()).collect();
    all.into_iter().find(|scenario| scenario.name == name).unwrap_or_else(|| panic!("{name} is not in {names:?}"))
}

fn check(scenario: &Scenario, effort: Effort, bound: &Bound) {
    for (scalar, errors) in [
        ("f32", errors::<f32>(scenario, Scheme::Realtime, effort, 0)),
        ("f64", errors::<f64>(scenario, Scheme::Realtime, effort, 0)),
    ] {
        let Errors { deflection, gap, link } = errors;
        println!("{}, {scalar}: meshes {deflection:.1e}, gap {gap:.1e}, link {link:.1e}", scenario.name);
        bound.check(errors.worst());
    }
}

#[test]
fn free_motion_follows_the_reference() {
    check(&named("L1 contact, free motion"), Effort::Accurate, &tolerance::FREE_MOTION);
    check(&named("L1 paper, free motion"), Effort::Accurate, &tolerance::FREE_MOTION);
    check(&named("Q1 paper, free motion"), Effort::Accurate, &tolerance::FREE_MOTION);
}

#[test]
fn a_step_load_follows_the_reference() {
    for joint in ["L1 contact", "L1 paper", "Q1 contact", "Q1 paper"] {
        check(&named(&format!("{joint}, step load")), Effort::Board, &tolerance::STEP_LOAD);
    }
}

#[test]
fn a_reversal_follows_the_reference() {
    for joint in ["L1 contact", "L1 paper"] {
        check(&named(&format!("{joint}, reversal through the gap")), Effort::Board, &tolerance::REVERSAL);
    }
    check(&named("Q1 paper, reversal through the gap"), Effort::Accurate, &tolerance::REVERSAL);
}

#[test]
fn a_start_with_all_teeth_separated_follows_the_reference() {
    for joint in ["L1 contact", "L1 paper"] {
        check(&named(&format!("{joint}, all teeth separated")), Effort::Board, &tolerance::ALL_SEPARATED);
    }
    check(&named("Q1 paper, all teeth separated"), Effort::Accurate, &tolerance::ALL_SEPARATED);
}

#[test]
fn back_side_contact_follows_the_reference() {
    for joint in ["L1 contact", "L1 paper", "Q1 contact", "Q1 paper"] {
        check(&named(&format!("{joint}, back-side contact")), Effort::Board, &tolerance::BACK_SIDE);
    }
}

#[test]
fn the_paper_s_joint_without_backlash_follows_the_reference() {
    check(&scenarios::regime("set P, b = 0", 0.0, 300.0), Effort::Accurate, &tolerance::REGIMES);
}

#[test]
fn the_paper_s_joint_at_10_um_follows_the_reference() {
    check(&scenarios::regime("set P, b = 10 um", 10e-6, 300.0), Effort::Accurate, &tolerance::REGIMES);
}

/// From rest, 60 um passes through a chaotic transient; on its period-3 attractor the motion can be predicted.
#[test]
fn the_paper_s_joint_at_60_um_follows_the_reference_on_its_attractor() {
    let mut scenario = scenarios::regime("set P, b = 60 um", 60e-6, 300.0);
    let speed = scenarios::PAPER_LENGTH * scenarios::paper_natural_frequency();
    scenario.start = Start::Relative(RelativeState {
        sun_planet: scenarios::same(3, 0.7489 * scenarios::PAPER_LENGTH),
        sun_planet_rate: scenarios::same(3, -13.9408 * speed),
        gap: 6.1283 * scenarios::PAPER_LENGTH,
        gap_rate: -6.2729 * speed,
        ..RelativeState::centred(3)
    });
    check(&scenario, Effort::Accurate, &tolerance::REGIMES);
}

/// Chaos parts any two integrators; until then they agree.
#[test]
fn the_paper_s_joint_at_120_um_follows_the_reference_until_chaos_parts_them() {
    check(&scenarios::regime("set P, b = 120 um", 120e-6, 15.0), Effort::Accurate, &tolerance::REGIMES);
}

#[test]
fn cases_a_and_q_follow_the_reference() {
    for (name, omega, bound) in
        [("A", scenarios::CASE_A_OMEGA, &tolerance::CASE_A), ("Q", scenarios::CASE_Q_OMEGA, &tolerance::CASE_Q)]
    {
        let scenario = scenarios::case(name, omega);
        let from = (100.0 / scenarios::paper_natural_frequency() * f64::from(scenario.tick_rate)).ceil() as usize;
        let error = errors::<f32>(&scenario, Scheme::Realtime, Effort::Accurate, from).deflection;
        println!("case {name}: {error:.2e}");
        bound.check(error);
    }
}

/// The paper's own scheme stays available as what it is: right while contact holds and nothing varies.
#[test]
fn the_paper_s_scheme_is_exact_while_contact_holds_and_far_off_when_meshes_part() {
    let mut still = scenarios::case("Q without ripple", scenarios::CASE_Q_OMEGA);
    for mesh in [&mut still.joint.sun_planet, &mut still.joint.ring_planet] {
        mesh.stiffness_wave = model_core::mesh::StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
        mesh.transmission_error = scenarios::same(3, 0.0);
    }
    let Start::Relative(start) = &mut still.start else { unreachable!("a case states its start") };
    start.sun_planet = scenarios::same(3, 7.0 * scenarios::PAPER_LENGTH);
    start.sun_planet_rate = scenarios::same(3, 0.0);
    start.gap = 14.0 * scenarios::PAPER_LENGTH;
    tolerance::PAPER_SCHEME_HELD.check(errors::<f64>(&still, Scheme::PaperEtd1, Effort::Board, 0).deflection);
    let parting = scenarios::case("A", scenarios::CASE_A_OMEGA);
    let paper = errors::<f64>(&parting, Scheme::PaperEtd1, Effort::Board, 0).deflection;
    let realtime = errors::<f64>(&parting, Scheme::Realtime, Effort::Board, 0).deflection;
    assert!(paper > 20.0 * realtime, "the paper's scheme leaves {paper:.1e}, the board's {realtime:.1e}");
}
