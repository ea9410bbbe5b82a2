//! The core on random joints: finite and repeatable in f32, passive without excitation, and never pulling with the damping law `contact`.
//! The digest is tested in `digest`.

use host_tests::tolerance::core::{MOMENTUM, PASSIVITY};
use model_core::gears::design::{DesignError, Effort, design_scheme};
use model_core::gears::{Kinematics, Mechanics, Model, Relative, Scales, Scheme, State, Tables, Torques};
use model_core::numbers::Real;
use parameters::{DampingLaw, DeadZone, JointParameters, StiffnessWave};
use proptest::prelude::*;
use reference::scenarios::{Scenario, same};

use crate::balances::rigid_gains;
use crate::random::{TICK_RATE, config, joint, scenario};

/// Tables at a tick rate, or at the lowest rate that the error names.
pub fn tables<T: Real, const N: usize>(joint: &JointParameters, tick_rate: u32, effort: Effort) -> Tables<T, N> {
    let design = |tick_rate| design_scheme(joint, tick_rate, Scheme::Realtime, effort);
    match design(tick_rate) {
        Err(DesignError::RateTooLow { lowest, .. }) => design(lowest).expect("the rate that was named"),
        other => other.expect("a sound joint"),
    }
}

/// Returns true if the core stays finite and two runs agree.
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

/// Error of the core's rigid carrier speed against the torques' momentum, over the largest speed [-].
fn momentum_error<const N: usize>(scenario: &Scenario) -> f64 {
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

/// Kinetic and elastic energy of the relative motion, in units of K_m b_c^2, from the joint's own parameters.
fn energy<const N: usize>(joint: &JointParameters, state: &State<f64, N>) -> f64 {
    let scales = Scales::new(joint);
    let lever = joint.geometry.carrier_base_radius();
    let unit = scales.frequency.powi(2) / scales.stiffness;
    let sun = joint.bodies.sun_equivalent_mass + joint.rotor_inertia / joint.geometry.sun_base_radius.powi(2);
    let (planet, link) = (joint.bodies.planet_equivalent_mass, joint.link_inertia / lever.powi(2));
    let carrier = joint.carrier_equivalent_mass();
    let Relative { planets, gap, wind_up } = &state.rate;
    // Speeds while the rigid body is at rest: 2 M_s u_s + M_p sum u_p + M_c u_c + M_l u_l = 0.
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

/// Largest and least energy over its initial value, in a swing without torques, ripple and errors; at 1 MHz, where the integration's own
/// loss is small even for a light planet.
fn energy_range<const N: usize>(joint: &JointParameters, start: [f64; 3]) -> (f64, f64) {
    let tables: Tables<f64, N> = tables(joint, 50 * TICK_RATE, Effort::Accurate);
    let mut model = Model::new(&tables);
    let [spread, gap, rate] = start;
    let position =
        Relative { planets: std::array::from_fn(|i| gap / 2.0 + spread * (i as f64 - 1.0)), gap, wind_up: 0.0 };
    let rates = Relative { planets: [rate; N], gap: -rate, wind_up: 0.0 };
    model.set_state(State::from_deflections(&tables, &position, &rates, 0.0));
    let first = energy(joint, model.state());
    (0..2000).fold((1.0, 1.0), |(greatest, least): (f64, f64), _| {
        model.step(Torques { drive: 0.0, load: 0.0 });
        let now = energy(joint, model.state()) / first;
        (greatest.max(now), least.min(now))
    })
}

/// Change of the rates in a tick when one sun mesh overlaps but recedes at three times the speed at which damping outweighs its spring, and
/// all others are separated; over this speed.
fn pull_of_receding_mesh<const N: usize>(joint: &JointParameters) -> f64 {
    let tables: Tables<f64, N> = tables(joint, 50 * TICK_RATE, Effort::Accurate);
    let half_backlash = tables.meshes[0][0].half_backlash;
    let overlap = 0.01 * half_backlash;
    let speed = 3.0 * overlap * tables.springs[0].stiffness / tables.springs[0].damping;
    let (mut planets, mut rates) = ([0.0; N], [0.0; N]);
    (planets[0], rates[0]) = (half_backlash + overlap, -speed);
    let position = Relative { planets, gap: 0.6 * half_backlash, wind_up: 0.0 };
    let rate = Relative { planets: rates, ..Relative::ZERO };
    let mut model = Model::new(&tables);
    model.set_state(State::from_deflections(&tables, &position, &rate, 0.0));
    model.step(Torques { drive: 0.0, load: 0.0 });
    let Relative { planets: after, gap, wind_up } = model.state().rate;
    let changes = after.iter().zip(rates).map(|(after, before)| after - before).chain([gap, wind_up]);
    changes.fold(0.0, |largest: f64, change| largest.max(change.abs())) / speed
}

proptest! {
    #![proptest_config(config(300))]

    /// The core stays finite and two runs agree in every bit.
    #[test]
    fn core_is_finite_and_repeatable(mut scenario in scenario(), sharpness in prop::option::of(1.0..50.0)) {
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

    /// With the damping law `contact` no tooth of the core pulls.
    #[test]
    fn core_teeth_only_push(mut joint in joint(), half_backlash in 10e-6..100e-6) {
        joint.damping_law = DampingLaw::Contact;
        let planets = joint.geometry.planets;
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.damping_ratio += 0.05;
            mesh.half_backlash = same(planets, half_backlash);
            mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
            mesh.transmission_error = same(planets, 0.0);
        }
        let pull_of_receding_mesh = match planets {
            3 => pull_of_receding_mesh::<3>(&joint),
            4 => pull_of_receding_mesh::<4>(&joint),
            _ => pull_of_receding_mesh::<5>(&joint),
        };
        prop_assert!(pull_of_receding_mesh == 0.0, "rates change by {pull_of_receding_mesh} of themselves without a force");
    }

    /// Momentum of the core equals the torques.
    #[test]
    fn core_momentum_follows_torques(scenario in scenario()) {
        MOMENTUM.check(match scenario.joint.geometry.planets {
            3 => momentum_error::<3>(&scenario),
            4 => momentum_error::<4>(&scenario),
            _ => momentum_error::<5>(&scenario),
        });
    }
}

proptest! {
    #![proptest_config(config(100))]

    /// Without torques and excitation the core gains no energy, and undamped it loses none.
    #[test]
    fn core_is_passive_without_input(
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
        let (greatest, least) = match planets {
            3 => energy_range::<3>(&joint, start),
            4 => energy_range::<4>(&joint, start),
            _ => energy_range::<5>(&joint, start),
        };
        PASSIVITY.check(greatest - 1.0);
        if !damped {
            PASSIVITY.check(1.0 - least);
        }
    }
}
