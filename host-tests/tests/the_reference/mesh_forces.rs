//! The two damping laws at single states: mesh forces of a joint set to a state.

use host_tests::tolerance::MESH_FORCE;
use parameters::{ContactState, DampingLaw};
use reference::joint::{Reference, RelativeState, Start};
use reference::scenarios::{l1, same};

const HALF_BACKLASH: f64 = 60e-6;

/// Damping of L1's meshes from the gears' own masses, without rotor and link.
fn damping() -> [f64; 2] {
    [0.39 * 0.61 / (0.39 + 0.61), 0.61].map(|mass: f64| 2.0 * 0.05 * (1e8 * mass).sqrt())
}

/// Forces and contact of planet 0 at a deflection and rate of both meshes.
fn meshes(law: DampingLaw, deflection: f64, rate: f64) -> [(f64, ContactState); 2] {
    let mut joint = l1();
    joint.damping_law = law;
    let state = RelativeState {
        sun_planet: same(3, deflection),
        sun_planet_rate: same(3, rate),
        // Without transmission error X = d_sp + d_rp.
        gap: 2.0 * deflection,
        gap_rate: 2.0 * rate,
        ..RelativeState::centred(3)
    };
    let seen = Reference::start(&joint, &Start::Relative(state)).expect("L1 is sound").observe();
    [0, 1].map(|kind| (seen.mesh_forces[kind][0], seen.contacts[kind][0]))
}

/// Mesh force of the damping laws, computed by hand.
fn by_hand(law: DampingLaw, deflection: f64, rate: f64, damping: f64) -> f64 {
    let overlap = (deflection - HALF_BACKLASH).max(0.0) + (deflection + HALF_BACKLASH).min(0.0);
    let line = 1e8 * overlap + damping * rate;
    match law {
        DampingLaw::Paper => line,
        DampingLaw::Contact if deflection > HALF_BACKLASH => line.max(0.0),
        DampingLaw::Contact if deflection < -HALF_BACKLASH => line.min(0.0),
        DampingLaw::Contact => 0.0,
    }
}

/// Mesh forces equal both laws, computed by hand.
#[test]
fn mesh_forces_follow_both_laws() {
    for law in [DampingLaw::Paper, DampingLaw::Contact] {
        for deflection in [-75e-6, -61e-6, -20e-6, 0.0, 59e-6, 61e-6, 90e-6] {
            for rate in [-0.5, -0.01, 0.01, 0.5] {
                for ((force, _), damping) in meshes(law, deflection, rate).into_iter().zip(damping()) {
                    let expected = by_hand(law, deflection, rate, damping);
                    MESH_FORCE.check((force - expected) / expected.abs().max(1.0));
                }
            }
        }
    }
}

/// Separated teeth carry no force with the law `contact`, and drag with the law `paper`.
#[test]
fn separated_teeth_drag_in_law_paper_only() {
    for (force, contact) in meshes(DampingLaw::Contact, 59e-6, 0.5) {
        assert_eq!((force, contact), (0.0, ContactState::Separated));
    }
    for ((force, contact), damping) in meshes(DampingLaw::Paper, 59e-6, 0.5).into_iter().zip(damping()) {
        MESH_FORCE.check(force / (0.5 * damping) - 1.0);
        assert_eq!(contact, ContactState::Separated);
    }
}

/// Flanks that recede faster than they spring back touch without force.
#[test]
fn receding_flanks_touch_without_force() {
    for (force, contact) in meshes(DampingLaw::Contact, 61e-6, -0.5) {
        assert_eq!((force, contact), (0.0, ContactState::DriveSide));
    }
    for (force, contact) in meshes(DampingLaw::Contact, -61e-6, 0.5) {
        assert_eq!((force, contact), (0.0, ContactState::BackSide));
    }
}
