//! Digest of the tables on random joints: every parameter changes it.

use model_core::gears::design::Effort;
use parameters::{DampingLaw, DeadZone, Excitation, JointParameters, MeshPhases, StiffnessWave};
use proptest::prelude::*;
use reference::scenarios::same;

use crate::core::tables;
use crate::random::{TICK_RATE, config, joint};

/// Change of one parameter by a thousandth, or of a choice.
type Change = fn(&mut JointParameters);

const CHANGES: [(&str, Change); 19] = [
    ("sun mass", |joint| joint.bodies.sun_equivalent_mass *= 1.001),
    ("planet equivalent mass", |joint| joint.bodies.planet_equivalent_mass *= 1.001),
    ("planet mass", |joint| joint.bodies.planet_mass *= 1.001),
    ("carrier", |joint| joint.bodies.carrier_inertia_over_radius_squared *= 1.001),
    ("rotor", |joint| joint.rotor_inertia *= 1.001),
    ("link", |joint| joint.link_inertia *= 1.001),
    ("sun radius", |joint| joint.geometry.sun_base_radius *= 1.001),
    ("carrier radius", |joint| joint.geometry.carrier_radius *= 1.001),
    ("pressure angle", |joint| joint.geometry.working_pressure_angle *= 1.001),
    ("sun-planet stiffness", |joint| joint.sun_planet.mean_stiffness *= 1.001),
    ("ring-planet stiffness", |joint| joint.ring_planet.mean_stiffness *= 1.001),
    ("damping ratio", |joint| joint.ring_planet.damping_ratio += 1e-3),
    ("backlash of one mesh", |joint| joint.ring_planet.half_backlash[2] += 1e-8),
    ("error of one mesh", |joint| joint.sun_planet.transmission_error[1] += 1e-8),
    ("stiffness wave", |joint| joint.sun_planet.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.77 }),
    ("phases", |joint| {
        joint.sun_planet.transmission_error = same(joint.geometry.planets, 1e-5);
        joint.sun_planet.phases = MeshPhases::FromTeeth { stiffness: 0.5, error: 7.0 };
    }),
    ("damping law", |joint| {
        joint.damping_law =
            if joint.damping_law == DampingLaw::Paper { DampingLaw::Contact } else { DampingLaw::Paper };
    }),
    ("dead zone", |joint| joint.dead_zone = DeadZone::Tanh { sharpness: 10.0 }),
    ("excitation", |joint| {
        joint.excitation = match joint.excitation {
            Excitation::Angle => Excitation::Time { mesh_frequency: 100.0 },
            Excitation::Time { mesh_frequency } => Excitation::Time { mesh_frequency: mesh_frequency + 1.0 },
        }
    }),
];

fn digest<const N: usize>(joint: &JointParameters) -> u64 {
    tables::<f32, N>(joint, 10 * TICK_RATE, Effort::Board).digest
}

proptest! {
    #![proptest_config(config(30))]

    /// Every parameter changes the digest.
    #[test]
    fn every_parameter_changes_the_digest(joint in joint()) {
        let digest = match joint.geometry.planets {
            3 => digest::<3>,
            4 => digest::<4>,
            _ => digest::<5>,
        };
        let plain = digest(&joint);
        prop_assert_eq!(plain, digest(&joint.clone()));
        for (what, change) in CHANGES {
            let mut changed = joint.clone();
            change(&mut changed);
            prop_assert_ne!(plain, digest(&changed), "{} leaves no trace", what);
        }
    }
}
