//! The core on random joints: finite and repeatable in f32, passive without excitation, and with a digest that sees
//! every parameter.

use host_tests::scenarios::{Scenario, same};
use host_tests::tolerance::{MOMENTUM, PASSIVITY};
use model_core::dead_zone::DeadZone;
use model_core::design::{DesignError, Effort, design_scheme};
use model_core::joint::{Excitation, JointParameters};
use model_core::mesh::{MeshPhases, StiffnessWave};
use model_core::real::Real;
use model_core::realtime::{Model, Relative, State, Torques};
use model_core::scales::Scales;
use model_core::tables::{Scheme, Tables};
use proptest::prelude::*;

use crate::books::rigid_gains;
use crate::random::{TICK_RATE, config, joint, scenario};

/// Tables at a tick rate, or at the one that a refusal names.
fn tables<T: Real, const N: usize>(joint: &JointParameters, tick_rate: u32, effort: Effort) -> Tables<T, N> {
    let design = |tick_rate| design_scheme(joint, tick_rate, Scheme::Realtime, effort);
    match design(tick_rate) {
        Err(DesignError::RateTooLow { lowest, .. }) => design(lowest).expect("the rate that was named"),
        other => other.expect("a sound joint"),
    }
}

/// Whether the core stays finite and says the same twice.
fn stays_finite<const N: usize>(scenario: &Scenario) -> bool {
    let tables: Tables<f32, N> = tables(&scenario.joint, TICK_RATE, Effort::Board);
    let run = || {
        let mut model = Model::new(&tables);
        for tick in 0..scenario.ticks {
            let (drive, load) = scenario.torques_at(tick);
            model.step(Torques { drive: drive as f32, load: load as f32 });
        }
        (model.is_finite(), model.state_digest())
    };
    let (finite, digest) = run();
    finite && run() == (true, digest)
}

/// Speed of the core's rigid carrier less what its torques must have made of it, over the largest [-].
fn astray<const N: usize>(scenario: &Scenario) -> f64 {
    let tables: Tables<f64, N> = tables(&scenario.joint, TICK_RATE, Effort::Board);
    let gains = rigid_gains(&scenario.joint);
    let mut model = Model::new(&tables);
    let (mut expected, mut largest, mut worst) = (0.0, 1.0_f64, 0.0_f64);
    for tick in 0..scenario.ticks {
        let (drive, load) = scenario.torques_at(tick);
        model.step(Torques { drive, load });
        expected += (gains[0] * drive + gains[1] * load) / f64::from(tables.tick_rate);
        largest = largest.max(expected.abs());
        worst = worst.max((model.outputs().carrier_speed - expected).abs());
    }
    worst / largest
}

/// Kinetic and elastic energy of the relative motion, in units of K_m b_c^2, from the joint's own numbers.
fn energy<const N: usize>(joint: &JointParameters, state: &State<f64, N>) -> f64 {
    let scales = Scales::new(joint);
    let lever = joint.geometry.carrier_base_radius();
    let unit = scales.frequency.powi(2) / scales.stiffness;
    let sun = joint.bodies.sun_equivalent_mass + joint.rotor_inertia / joint.geometry.sun_base_radius.powi(2);
    let (planet, link) = (joint.bodies.planet_equivalent_mass, joint.link_inertia / lever.powi(2));
    let carrier = joint.carrier_equivalent_mass();
    let Relative { planets, gap, wind_up } = &state.rate;
    // Speeds while the rigid body stands still: 2 M_s u_s + M_p sum u_p + M_c u_c + M_l u_l = 0.
    let shares = 2.0 * sun * gap + planet * planets.iter().map(|rate| gap - rate).sum::<f64>() - link * wind_up;
    let mass = 4.0 * sun + N as f64 * planet + carrier + link;
    let carrier_speed = -shares / mass;
    let sun_speed = gap + 2.0 * carrier_speed;
    let planet_squares: f64 = planets.iter().map(|rate| (sun_speed - rate - carrier_speed).powi(2)).sum();
    let kinetic = sun * sun_speed.powi(2)
        + planet * planet_squares
        + carrier * carrier_speed.powi(2)
        + link * (carrier_speed - wind_up).powi(2);
    let mut elastic = 0.0;
    for i in 0..N {
        let across = [state.position.planets[i], state.position.gap - state.position.planets[i]];
        for (deflection, mesh) in across.into_iter().zip([&joint.sun_planet, &joint.ring_planet]) {
            let half_backlash = mesh.half_backlash[i] / scales.length;
            let overlap = (deflection.abs() - half_backlash).max(0.0);
            elastic += mesh.mean_stiffness / scales.stiffness * overlap.powi(2);
        }
    }
    if let Some(compliance) = joint.compliance {
        elastic += compliance.stiffness / lever.powi(2) / scales.stiffness * state.position.wind_up.powi(2);
    }
    0.5 * (unit * kinetic + elastic)
}

/// Energy over what it was at first, at most and at least, in a swing without torques, ripple and errors; at 1 MHz,
/// where the integration's own loss is small even for a light planet.
fn swing<const N: usize>(joint: &JointParameters, start: [f64; 3]) -> (f64, f64) {
    let tables: Tables<f64, N> = tables(joint, 50 * TICK_RATE, Effort::Accurate);
    let mut model = Model::new(&tables);
    let [spread, gap, rate] = start;
    let position =
        Relative { planets: std::array::from_fn(|i| gap / 2.0 + spread * (i as f64 - 1.0)), gap, wind_up: 0.0 };
    let rates = Relative { planets: [rate; N], gap: -rate, wind_up: 0.0 };
    model.set_state(State::from_deflections(&tables, &position, &rates, 0.0));
    let first = energy(joint, model.state());
    (0..2000).fold((1.0, 1.0), |(most, least): (f64, f64), _| {
        model.step(Torques { drive: 0.0, load: 0.0 });
        let now = energy(joint, model.state()) / first;
        (most.max(now), least.min(now))
    })
}

/// A change of one parameter by a thousandth, or of a choice.
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
        use model_core::mesh::DampingLaw::{Contact, Paper};
        joint.damping_law = if joint.damping_law == Paper { Contact } else { Paper };
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
    #![proptest_config(config(300))]

    #[test]
    fn the_core_stays_finite_and_repeats_itself(mut scenario in scenario(), sharpness in prop::option::of(1.0..50.0)) {
        if let Some(sharpness) = sharpness {
            scenario.joint.dead_zone = DeadZone::Tanh { sharpness };
        }
        let finite = match scenario.joint.geometry.planets {
            3 => stays_finite::<3>(&scenario),
            4 => stays_finite::<4>(&scenario),
            _ => stays_finite::<5>(&scenario),
        };
        prop_assert!(finite);
    }

    #[test]
    fn the_core_keeps_the_book_of_momentum(scenario in scenario()) {
        MOMENTUM.check(match scenario.joint.geometry.planets {
            3 => astray::<3>(&scenario),
            4 => astray::<4>(&scenario),
            _ => astray::<5>(&scenario),
        });
    }
}

proptest! {
    #![proptest_config(config(30))]

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

proptest! {
    #![proptest_config(config(100))]

    #[test]
    fn without_torques_and_excitation_the_core_gains_no_energy_and_loses_none_undamped(
        mut joint in joint(),
        start in (-3.0..3.0, -20.0..20.0, 0.1..2.0),
        damped in any::<bool>(),
    ) {
        let planets = joint.geometry.planets;
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
            mesh.transmission_error = same(planets, 0.0);
            mesh.damping_ratio *= f64::from(damped);
        }
        if let Some(compliance) = &mut joint.compliance {
            compliance.damping_ratio *= f64::from(damped);
        }
        let start = start.into();
        let (most, least) = match planets {
            3 => swing::<3>(&joint, start),
            4 => swing::<4>(&joint, start),
            _ => swing::<5>(&joint, start),
        };
        PASSIVITY.check(most - 1.0);
        if !damped {
            PASSIVITY.check(1.0 - least);
        }
    }
}
