//! Momentum and energy balances of the core and of the reference, computed by hand.

use host_tests::tolerance::{ENERGY, equivalent};
use model_core::gears::design::design;
use model_core::gears::{Model, Outputs, Tables, Torques};
use parameters::{ContactState, JointParameters};
use reference::joint::Reference;

use crate::random::motion;

/// Inertia of motor and gear, inertia of the link [kg m^2], and ratio.
fn bodies(joint: &JointParameters) -> (f64, f64, f64) {
    let gear = joint.equivalent_gear().expect("an equivalent gear");
    let ratio = f64::from(gear.ratio[0]) / f64::from(gear.ratio[1]);
    (joint.rotor_inertia + gear.inertia_at_input, joint.link_inertia, ratio)
}

/// Momentum changes by the external torques alone, in core and reference.
#[test]
fn momentum_follows_the_torques() {
    for seed in 0..30 {
        let motion = motion(seed, 20_000);
        let (motor, link, ratio) = bodies(&motion.joint);
        let tables: Tables<f64, 1> = design(&motion.joint, motion.tick_rate).expect("a sound joint");
        let mut model = Model::new(&tables);
        let mut reference = Reference::new(&motion.joint).expect("a sound joint");
        let (mut gained, mut largest) = (0.0, 0.0_f64);
        for tick in 0..motion.ticks {
            let (drive, load) = motion.torques_at(tick);
            model.step(Torques { drive, load });
            reference.advance(f64::from(tick + 1) / 20e3, drive, load).expect("it can be integrated");
            // Referred to the link: the gear's support takes the rest of the motor's momentum.
            gained += (ratio * drive - load) / 20e3;
            largest = largest.max(gained.abs());
        }
        let seen = reference.observe();
        let by_reference = ratio * motor * seen.motor_speed + link * seen.link_speed;
        let by_core = (ratio * ratio * motor + link) * model.outputs().carrier_speed;
        equivalent::MOMENTUM.check((by_reference - gained) / largest);
        equivalent::MOMENTUM.check((by_core - gained) / largest);
    }
}

/// Energy of the reference equals the net work done on it.
#[test]
fn reference_energy_balances() {
    for seed in 0..30 {
        let motion = motion(seed, 20_000);
        let gear = motion.joint.equivalent_gear().expect("an equivalent gear");
        let (motor, link, ratio) = bodies(&motion.joint);
        let mut reference = Reference::new(&motion.joint).expect("a sound joint");
        let (mut missing, mut largest) = (0.0_f64, 0.0_f64);
        for tick in 0..motion.ticks {
            let (drive, load) = motion.torques_at(tick);
            reference.advance(f64::from(tick + 1) / 20e3, drive, load).expect("it can be integrated");
            let seen = reference.observe();
            let twist = seen.motor_offset / ratio - seen.link_offset;
            let beyond = (twist.abs() - 0.5 * gear.lost_motion).max(0.0);
            let kinetic = 0.5 * motor * seen.motor_speed.powi(2) + 0.5 * link * seen.link_speed.powi(2);
            let energy = kinetic + 0.5 * gear.stiffness * beyond * beyond;
            missing = missing.max((energy - seen.work.net()).abs());
            largest = largest.max(energy);
        }
        ENERGY.check(missing / largest);
    }
}

/// An undamped gear keeps its energy and a damped gear gains none.
#[test]
fn free_gear_gains_no_energy() {
    for seed in 0..30 {
        let mut motion = motion(seed, 20_000);
        for damping_ratio in [0.0, 0.1] {
            for mesh in [&mut motion.joint.sun_planet, &mut motion.joint.ring_planet] {
                mesh.damping_ratio = damping_ratio;
            }
            let gear = motion.joint.equivalent_gear().expect("an equivalent gear");
            let (motor, link, ratio) = bodies(&motion.joint);
            let reduced = 1.0 / (1.0 / (ratio * ratio * motor) + 1.0 / link);
            let tables: Tables<f32, 1> = design(&motion.joint, motion.tick_rate).expect("a sound joint");
            let mut model = Model::new(&tables);
            let twist =
                |outputs: &Outputs<f32, 1>| f64::from(outputs.motor_offset) / ratio - f64::from(outputs.link_offset);
            // A push winds the gear up before it is left alone.
            for _ in 0..100 {
                let rated = motion.joint.rated_output_torque;
                model.step(Torques { drive: (rated / ratio) as f32, load: rated as f32 });
            }
            let speed = tables.units.length * motion.phase as f32 * 20e3;
            let energy = |model: &Model<'_, f32, 1>| {
                let beyond = (twist(&model.outputs()).abs() - 0.5 * gear.lost_motion).max(0.0);
                // The gap's rate is that of twice the twist.
                let rate = 0.5 * f64::from(model.state().rate.gap * speed);
                0.5 * reduced * rate * rate + 0.5 * gear.stiffness * beyond * beyond
            };
            let first = energy(&model);
            let (mut least, mut greatest) = (first, first);
            for _ in 0..4000 {
                model.step(Torques { drive: 0.0, load: 0.0 });
                let now = energy(&model);
                (least, greatest) = (least.min(now), greatest.max(now));
            }
            equivalent::ENERGY_GAINED.check(greatest / first - 1.0);
            if damping_ratio == 0.0 {
                equivalent::ENERGY_LOST.check(1.0 - least / first);
            }
        }
    }
}

/// The contact force pushes on either flank and is zero between them.
#[test]
fn contact_never_pulls() {
    for seed in 0..20 {
        let motion = motion(seed, 20_000);
        let mut reference = Reference::new(&motion.joint).expect("a sound joint");
        let mut touched = [false; 3];
        for tick in 0..motion.ticks {
            let (drive, load) = motion.torques_at(tick);
            reference.advance(f64::from(tick + 1) / 20e3, drive, load).expect("it can be integrated");
            let seen = reference.observe();
            let (force, contact) = (seen.mesh_forces[0][0], seen.contacts[0][0]);
            touched[usize::from(contact.code())] = true;
            let pushes = match contact {
                ContactState::DriveSide => force >= 0.0,
                ContactState::Separated => force == 0.0,
                ContactState::BackSide => force <= 0.0,
            };
            assert!(pushes, "{force} N while {contact:?}");
            assert_eq!(seen.mesh_forces[0], seen.mesh_forces[1], "a planet without mass");
        }
        assert!(touched[1] && touched[2], "seed {seed} goes to both flanks");
    }
}
