//! Guarantees of the core for any joint: teeth only push, NaN is reported, equal inputs give equal bits, the digest covers the whole state.

use host_tests::tolerance;
use model_core::gears::design::{DesignError, Effort, design, design_scheme, rust_source};
use model_core::gears::{Mechanics, Model, Scheme, Tables, Torques};
use parameters::{ContactState, DeadZone, JointParameters};
use reference::scenarios;

fn q1_tables() -> Tables<f32, 3> {
    design(&scenarios::q1(), 20_000).expect("q1 is sound")
}

/// Torques that drive the joint through its gap again and again.
fn swinging(tick: u32) -> Torques<f32> {
    let sign = if (tick / 150).is_multiple_of(2) { 1.0 } else { -1.0 };
    Torques { drive: 0.8 * sign, load: 4.0 * sign }
}

/// Two runs on the same torques end in the same bits.
#[test]
fn equal_torques_give_equal_bits() {
    let tables = q1_tables();
    let run = || {
        let mut model = Model::new(&tables);
        (0..5000)
            .map(|tick| {
                model.step(swinging(tick));
                model.state_digest()
            })
            .collect::<Vec<u64>>()
    };
    assert_eq!(run(), run());
}

/// A reset restores the initial state.
#[test]
fn reset_restores_the_initial_state() {
    let tables = q1_tables();
    let mut model = Model::new(&tables);
    let fresh = model.state_digest();
    model.step(swinging(0));
    assert_ne!(model.state_digest(), fresh);
    model.reset();
    assert_eq!(model.state_digest(), fresh);
}

/// A swing through the gap visits both flanks and separation.
#[test]
fn swing_visits_every_contact_state() {
    let tables = q1_tables();
    let mut model = Model::new(&tables);
    let mut seen = [false; 3];
    for tick in 0..5000 {
        model.step(swinging(tick));
        for contact in model.outputs().contacts.iter().flatten() {
            seen[*contact as usize] = true;
        }
    }
    let all = [ContactState::DriveSide, ContactState::Separated, ContactState::BackSide];
    assert!(all.iter().all(|state| seen[*state as usize]), "seen: {seen:?}");
}

/// A NaN torque is reported after one step.
#[test]
fn nan_torque_is_reported() {
    let tables = q1_tables();
    let mut model = Model::new(&tables);
    model.step(Torques { drive: f32::NAN, load: 0.0 });
    assert!(!model.is_finite());
}

/// Absurd torques cause neither a panic nor a plausible motion.
#[test]
fn absurd_torques_are_reported() {
    let tables = q1_tables();
    for torque in [1e9, 1e30, f32::MAX, f32::INFINITY, f32::MIN, -f32::INFINITY] {
        let mut model = Model::new(&tables);
        for _ in 0..100 {
            model.step(Torques { drive: torque, load: -torque });
            let _ = model.outputs();
        }
        let gap = model.outputs().gap;
        assert!(!model.is_finite() || gap.abs() > 1.0, "{torque:e} N m left a gap of {gap} m");
    }
}

/// The digest changes with every kind of number in the tables.
#[test]
fn table_digest_covers_every_number() {
    let tables = q1_tables();
    assert!(tables.digest_is_good());
    let changes: [fn(&mut Tables<f32, 3>); 8] = [
        |tables| tables.tick_rate += 1,
        |tables| tables.substeps += 1,
        |tables| tables.units.drive = tables.units.drive.next_up(),
        |tables| tables.rigid.load = -tables.rigid.load,
        |tables| tables.mobility.carrier = tables.mobility.carrier.next_up(),
        |tables| tables.meshes[1][2].half_backlash = tables.meshes[1][2].half_backlash.next_up(),
        |tables| tables.meshes[0][1].ripple[7][1] = 1e-20,
        |tables| tables.flow.late.torques.0[(5, 2)] = tables.flow.late.torques.0[(5, 2)].next_up(),
    ];
    for (index, change) in changes.iter().enumerate() {
        let mut changed = tables.clone();
        change(&mut changed);
        assert!(!changed.digest_is_good(), "change {index} is not seen");
    }
}

/// A tanh dead zone converges to the sharp one as its sharpness grows.
#[test]
fn tanh_dead_zone_converges_to_sharp() {
    let mut joint = scenarios::paper_joint(0.1, 5e-6, 20e-6, 0.4);
    let gaps = |joint: &JointParameters| {
        let tables: Tables<f64, 3> =
            design_scheme(joint, 20_000, Scheme::Realtime, Effort::Accurate).expect("the paper's joint is sound");
        let mut model = Model::new(&tables);
        let load = joint.balanced_load_torque(40.0);
        let gap = |_| {
            model.step(Torques { drive: 40.0, load });
            model.outputs().gap
        };
        (0..200).map(gap).collect::<Vec<f64>>()
    };
    let sharp = gaps(&joint);
    let errors = [3.0, 10.0, 100.0].map(|sharpness| {
        joint.dead_zone = DeadZone::Tanh { sharpness };
        gaps(&joint).iter().zip(&sharp).map(|(tanh, sharp)| (tanh - sharp).abs()).fold(0.0, f64::max) / 20e-6
    });
    assert!(errors[2] < errors[1] && errors[1] < errors[0], "errors over b: {errors:?}");
    tolerance::SHARP_TANH.check(errors[2]);
}

/// Tables for the wrong number of planets are rejected with both numbers.
#[test]
fn wrong_planet_count_is_rejected() {
    let error = design::<f32, 4>(&scenarios::q1(), 20_000).expect_err("q1 has three planets");
    assert_eq!(error, DesignError::WrongPlanetCount { wanted: 4, given: 3 });
    assert!(error.to_string().contains("the joint has 3"));
}

/// The error for a low tick rate names the lowest rate that works.
#[test]
fn low_tick_rate_names_the_lowest() {
    let Err(DesignError::RateTooLow { lowest, .. }) = design::<f32, 3>(&scenarios::q1(), 500) else {
        panic!("500 Hz is far below the planets' 13 kHz")
    };
    assert!(design::<f32, 3>(&scenarios::q1(), lowest).is_ok());
    assert!(design::<f32, 3>(&scenarios::q1(), lowest - 1).is_err());
    assert!(design::<f32, 3>(&scenarios::q1(), 0).is_err());
}

/// The generated source holds joint name, planets and digest.
#[test]
fn board_source_holds_the_table_digest() {
    let source = rust_source(&scenarios::q1(), 20_000).expect("q1 is sound");
    assert!(source.contains("pub const PLANETS: usize = 3;"));
    assert!(source.contains("pub const JOINT_NAME: &str = \"q1\";"));
    assert!(source.contains(&format!("digest: {}", q1_tables().digest)));
}
