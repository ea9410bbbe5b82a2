//! Equivalent gears that design and reference reject, with the reason.

use model_core::gears::design::{DesignError, Effort, design, design_scheme};
use model_core::gears::{Model, Scheme, Tables, Torques};
use parameters::{Compliance, DampingLaw, JointParameters, ParameterError, StiffnessWave};
use reference::joint::Reference;

use crate::random::motion;

/// A contact too fast for the rate is rejected with the lowest rate that works.
#[test]
fn fast_contact_names_the_lowest_rate() {
    let motion = motion(3, 20_000);
    let low_rate = (motion.phase * 20e3 / 0.8) as u32;
    let Err(DesignError::RateTooLow { lowest, .. }) = design::<f32, 1>(&motion.joint, low_rate) else {
        panic!("{low_rate} Hz is enough")
    };
    assert!((f64::from(lowest) * 0.7 / (motion.phase * 20e3) - 1.0).abs() < 1e-3, "{lowest} Hz");
    assert!(design::<f32, 1>(&motion.joint, lowest).is_ok());
}

/// Properties that only planets have are rejected, and so are the schemes of toothed joints.
#[test]
fn planet_properties_are_rejected() {
    let joint = motion(1, 20_000).joint;
    let refused = |change: &dyn Fn(&mut JointParameters)| {
        let mut joint = joint.clone();
        change(&mut joint);
        joint.validate().expect_err("no equivalent gear")
    };
    let ripple = StiffnessWave::Harmonic { stiffness_ratio: 0.1 };
    for error in [
        refused(&|joint| joint.sun_planet.stiffness_wave = ripple),
        refused(&|joint| joint.sun_planet.transmission_error[0] = 1e-6),
        refused(&|joint| joint.damping_law = DampingLaw::Paper),
        refused(&|joint| joint.compliance = Some(Compliance { stiffness: 1e4, damping_ratio: 0.0 })),
        refused(&|joint| joint.ring_planet.half_backlash[0] += 1e-6),
    ] {
        assert_eq!(error, ParameterError::NotEquivalent);
    }
    assert!(refused(&|joint| joint.link_inertia = 0.0).to_string().contains("link inertia"));
    assert!(refused(&|joint| joint.geometry.ring_teeth = 0).to_string().contains("ratio"));
    for scheme in [Scheme::PaperEtd1, Scheme::RungeKutta4, Scheme::SemiImplicitEuler] {
        let refused = design_scheme::<f32, 1>(&joint, 20_000, scheme, Effort::Board);
        assert_eq!(refused.expect_err("no scheme of teeth"), DesignError::OneSchemeOnly);
    }
    assert!(matches!(design::<f32, 3>(&joint, 20_000), Err(DesignError::WrongPlanetCount { wanted: 3, given: 1 })));
    let mut without_link = joint.clone();
    without_link.link_inertia = 0.0;
    assert!(Reference::new(&without_link).is_err());
}

/// A tick from any state and torque ends in finite numbers or the canonical NaN.
#[test]
fn any_state_ends_finite_or_canonical_nan() {
    let joint = motion(2, 20_000).joint;
    let tables: Tables<f32, 1> = design(&joint, 20_000).expect("a sound joint");
    assert!(tables.digest_is_good());
    let wild = [0.0, -0.0, 1e-30, 1.0, -1.0, 1e9, 1e30, f32::MAX, f32::MIN, f32::INFINITY, f32::NAN];
    for gap in wild {
        for rate in wild {
            for torque in wild {
                let mut model = Model::new(&tables);
                let mut state = *model.state();
                (state.position.gap, state.rate.gap) = (gap, rate);
                model.set_state(state);
                model.step(Torques { drive: torque, load: -torque });
                let now = model.state();
                let canonical = |value: f32| value.is_finite() || value.to_bits() == f32::NAN.to_bits();
                assert!(canonical(now.position.gap) && canonical(now.rate.gap), "{gap} {rate} {torque}: {now:?}");
            }
        }
    }
}
