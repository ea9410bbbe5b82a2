//! Fixed step of the core at 20 kHz against the independent reference, scenario by scenario, in f32 as on a board and in f64 from the same
//! source. Errors are RMS over the standard deviation of the motion; bounds are in `tolerance`.

use host_tests::tolerance;
use model_core::gears::Scheme;
use model_core::gears::design::Effort;
use reference::joint::{RelativeState, Start};
use reference::scenarios;
use reference::scenarios::Scenario;

use super::comparison::{check, errors};

fn named(name: &str) -> Scenario {
    let all = scenarios::motions();
    let names: Vec<String> = all.iter().map(|scenario| scenario.name.clone()).collect();
    all.into_iter().find(|scenario| scenario.name == name).unwrap_or_else(|| panic!("{name} is not in {names:?}"))
}

#[test]
fn free_motion_follows_reference() {
    check::<3>(&named("L1 contact, free motion"), Effort::Accurate, &tolerance::core::FREE_MOTION);
    check::<3>(&named("L1 paper, free motion"), Effort::Accurate, &tolerance::core::FREE_MOTION);
    check::<3>(&named("Q1 paper, free motion"), Effort::Accurate, &tolerance::core::FREE_MOTION);
}

#[test]
fn step_load_follows_reference() {
    for joint in ["L1 contact", "L1 paper", "Q1 contact", "Q1 paper"] {
        check::<3>(&named(&format!("{joint}, step load")), Effort::Board, &tolerance::core::STEP_LOAD);
    }
}

#[test]
fn reversal_follows_reference() {
    for joint in ["L1 contact", "L1 paper"] {
        check::<3>(&named(&format!("{joint}, reversal through the gap")), Effort::Board, &tolerance::core::REVERSAL);
    }
    check::<3>(&named("Q1 paper, reversal through the gap"), Effort::Accurate, &tolerance::core::REVERSAL);
}

#[test]
fn separated_start_follows_reference() {
    for joint in ["L1 contact", "L1 paper"] {
        check::<3>(&named(&format!("{joint}, all teeth separated")), Effort::Board, &tolerance::core::ALL_SEPARATED);
    }
    check::<3>(&named("Q1 paper, all teeth separated"), Effort::Accurate, &tolerance::core::ALL_SEPARATED);
}

#[test]
fn back_side_contact_follows_reference() {
    for joint in ["L1 contact", "L1 paper", "Q1 contact", "Q1 paper"] {
        check::<3>(&named(&format!("{joint}, back-side contact")), Effort::Board, &tolerance::core::BACK_SIDE);
    }
}

#[test]
fn paper_joint_at_0_um_follows_reference() {
    check::<3>(&scenarios::regime("set P, b = 0", 0.0, 300.0), Effort::Accurate, &tolerance::core::REGIMES);
}

#[test]
fn paper_joint_at_10_um_follows_reference() {
    check::<3>(&scenarios::regime("set P, b = 10 um", 10e-6, 300.0), Effort::Accurate, &tolerance::core::REGIMES);
}

/// From rest, 60 um passes through a chaotic transient; on its period-3 attractor the motion is predictable.
#[test]
fn paper_joint_at_60_um_follows_reference() {
    let mut scenario = scenarios::regime("set P, b = 60 um", 60e-6, 300.0);
    let speed = scenarios::PAPER_LENGTH * scenarios::paper_natural_frequency();
    scenario.start = Start::Relative(RelativeState {
        sun_planet: scenarios::same(3, 0.7489 * scenarios::PAPER_LENGTH),
        sun_planet_rate: scenarios::same(3, -13.9408 * speed),
        gap: 6.1283 * scenarios::PAPER_LENGTH,
        gap_rate: -6.2729 * speed,
        ..RelativeState::centred(3)
    });
    check::<3>(&scenario, Effort::Accurate, &tolerance::core::REGIMES);
}

/// In chaos any two integrators diverge; until then they agree.
#[test]
fn paper_joint_at_120_um_follows_reference() {
    check::<3>(&scenarios::regime("set P, b = 120 um", 120e-6, 15.0), Effort::Accurate, &tolerance::core::REGIMES);
}

#[test]
fn cases_a_and_q_follow_reference() {
    for (name, omega, bound) in [
        ("A", scenarios::CASE_A_OMEGA, &tolerance::core::CASE_A),
        ("Q", scenarios::CASE_Q_OMEGA, &tolerance::core::CASE_Q),
    ] {
        let scenario = scenarios::case(name, omega);
        let from = (100.0 / scenarios::paper_natural_frequency() * f64::from(scenario.tick_rate)).ceil() as usize;
        let error = errors::<f32, 3>(&scenario, Scheme::Realtime, Effort::Accurate, from).deflection;
        println!("case {name}: {error:.2e}");
        bound.check(error);
    }
}

/// The paper's own scheme is exact while contact holds and nothing varies, and far off when meshes part.
#[test]
fn paper_scheme_is_exact_in_contact_only() {
    let mut still = scenarios::case("Q without ripple", scenarios::CASE_Q_OMEGA);
    for mesh in [&mut still.joint.sun_planet, &mut still.joint.ring_planet] {
        mesh.stiffness_wave = parameters::StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
        mesh.transmission_error = scenarios::same(3, 0.0);
    }
    let Start::Relative(start) = &mut still.start else { unreachable!("a case states its start") };
    start.sun_planet = scenarios::same(3, 7.0 * scenarios::PAPER_LENGTH);
    start.sun_planet_rate = scenarios::same(3, 0.0);
    start.gap = 14.0 * scenarios::PAPER_LENGTH;
    tolerance::core::PAPER_SCHEME_IN_CONTACT
        .check(errors::<f64, 3>(&still, Scheme::PaperEtd1, Effort::Board, 0).deflection);
    let parting = scenarios::case("A", scenarios::CASE_A_OMEGA);
    let paper = errors::<f64, 3>(&parting, Scheme::PaperEtd1, Effort::Board, 0).deflection;
    let realtime = errors::<f64, 3>(&parting, Scheme::Realtime, Effort::Board, 0).deflection;
    assert!(paper > 20.0 * realtime, "the paper's scheme leaves {paper:.1e}, the board's {realtime:.1e}");
}

/// The usual methods converge to the same motion, only more slowly.
#[test]
fn usual_methods_follow_less_closely() {
    let scenario = scenarios::case("A", scenarios::CASE_A_OMEGA);
    let error = |scheme| errors::<f64, 3>(&scenario, scheme, Effort::Accurate, 0).deflection;
    let (realtime, runge_kutta, euler) =
        (error(Scheme::Realtime), error(Scheme::RungeKutta4), error(Scheme::SemiImplicitEuler));
    println!("realtime {realtime:.1e}, Runge-Kutta {runge_kutta:.1e}, semi-implicit Euler {euler:.1e}");
    assert!(realtime < runge_kutta && runge_kutta < euler && euler < 0.2);
}
