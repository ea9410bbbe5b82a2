//! Tables of a virtual joint's surroundings: magnitudes of errors from data sheets, without signs and phases.
//! `gears::design` makes the tables of the gears.

use core::f64::consts::TAU;

use crate::gears::design::{DesignError, design};
use crate::gears::{Kinematics, Mechanics, Scales, Tables, gear_losses};
use crate::numbers::Real;
use crate::numbers::count_weights::divisor;
use crate::observer::design::{CLOCK_TICKS, NO_LIMIT};
use crate::virtual_joint::tables::{
    COMMAND_QUEUE_LENGTH, CurrentLoopTable, EncoderErrorTable, FrictionTable, SurroundingsTable, VirtualJointDesign,
    encoder_phase,
};
use parameters::{Friction, JointParameters, PlantParameters, Surroundings};

impl<const N: usize> VirtualJointDesign<N> {
    /// Designs the tables of `joint`, such as a joint file, for `rate` control periods a second [Hz].
    ///
    /// # Errors
    ///
    /// Names a parameter or a rate that no virtual joint can be designed for, or the joint's number of planets if it
    /// is not `N`.
    pub fn new<'t>(joint: impl Into<PlantParameters<'t>>, rate: u32) -> Result<Self, DesignError> {
        let PlantParameters { joint, surroundings } = joint.into();
        let gears = design(joint, rate)?;
        let surroundings = Surroundings { control_rate: rate, ..*surroundings };
        Ok(Self { surroundings: design_surroundings(joint, &surroundings, &gears)?, gears })
    }
}

/// Designs the tables of a virtual joint's surroundings; `tables` are the gears' tables for a tick of one control
/// period.
pub fn design_surroundings<T: Real, const N: usize>(
    joint: &JointParameters,
    of: &Surroundings,
    tables: &Tables<T, N>,
) -> Result<SurroundingsTable<T>, DesignError> {
    check(joint, of, tables.tick_rate)?;
    let real = T::from_f64;
    let geometry = &joint.geometry;
    let scales = Scales::new(joint);
    let period = 1.0 / f64::from(tables.tick_rate);
    let (teeth, sun) = (geometry.sun_teeth + geometry.ring_teeth, geometry.sun_teeth);
    let common = divisor(teeth.into(), sun.into()) as u32;
    let units = f64::powi(2.0, 32) / TAU;
    let lever = geometry.carrier_base_radius();
    let motor_inertia = joint.rotor_inertia + joint.bodies.sun_equivalent_mass * geometry.sun_base_radius.powi(2);
    let carrier_inertia = (joint.carrier_equivalent_mass()
        + geometry.planets as f64 * joint.bodies.planet_equivalent_mass)
        * lever
        * lever;
    let to_link = match joint.compliance {
        Some(compliance) => {
            let geared = 4.0 * (joint.bodies.sun_equivalent_mass + joint.rotor_equivalent_mass())
                + geometry.planets as f64 * joint.bodies.planet_equivalent_mass
                + joint.carrier_equivalent_mass();
            let reduced = geared * joint.link_equivalent_mass() / (geared + joint.link_equivalent_mass());
            let damping = 2.0 * compliance.damping_ratio * lever * (compliance.stiffness * reduced).sqrt();
            [0.0, compliance.stiffness / lever, damping / lever * scales.length * scales.frequency]
        }
        None => [geometry.ratio_by_teeth(), 0.0, 0.0],
    };
    let link_inertia = joint.link_inertia + if joint.compliance.is_some() { 0.0 } else { carrier_inertia };
    let ratio = period / of.current_lag;
    let (rise, lacking) =
        if of.current_lag > 0.0 { (-(-ratio).exp_m1(), -(-ratio).exp_m1() / ratio) } else { (1.0, 0.0) };
    let rates = |gains: &[T; 3]| gains.map(|gain| real(gain.to_f64() * scales.frequency));
    let mut half_backlash = [T::ZERO; 5];
    half_backlash.iter_mut().zip(&joint.sun_planet.half_backlash).for_each(|(place, value)| *place = real(*value));
    Ok(SurroundingsTable {
        period: real(period),
        clock_ticks: CLOCK_TICKS,
        turn: real(TAU),
        ratio: [teeth / common, sun / common],
        gear: real(geometry.ratio_by_teeth()),
        units_per_radian: real(units),
        motor_rate: rates(&tables.units.motor_offset),
        link_rate: rates(&tables.units.link_offset),
        current: CurrentLoopTable {
            delay: of.delay.round() as u32,
            rise: real(rise),
            lacking: real(lacking),
            gain: real(1.0 + of.torque_constant_error_ratio),
            limit: real(of.torque_limit.min(NO_LIMIT)),
        },
        cogging_torque: real(of.cogging_torque),
        cogging_periods: of.cogging_periods_per_turn,
        motor_friction: friction(&of.motor_friction, motor_inertia / period),
        load_friction: friction(&of.load_friction, link_inertia / period),
        losses: gear_losses(of.efficiency).map(real),
        half_backlash,
        sun_torque: real(joint.sun_planet.mean_stiffness * geometry.sun_base_radius),
        to_link: to_link.map(real),
        weight: real(of.gravity_torque),
        encoders: [&of.motor_encoder, &of.output_encoder].map(|encoder| EncoderErrorTable {
            // `check` has limited the counts.
            turn: encoder.counts_per_turn as u32,
            errors: [encoder.once_per_turn_error, encoder.twice_per_turn_error].map(|error| real(error * units)),
            lag: real(encoder.skew * units),
            phase: encoder_phase(encoder.counts_per_turn),
        }),
    })
}

fn friction<T: Real>(of: &Friction, stop: f64) -> FrictionTable<T> {
    let real = T::from_f64;
    // A rational law replaces the exponential fall of the rise: both have half of the rise left at the same speed.
    let half = of.stribeck_speed * core::f64::consts::LN_2;
    FrictionTable {
        coulomb: real(of.coulomb),
        viscous: real(of.viscous),
        rise: real(of.coulomb * of.stribeck_rise_ratio),
        per_speed: real(if half > 0.0 { 1.0 / half } else { 0.0 }),
        stop: real(stop),
    }
}

fn check(joint: &JointParameters, of: &Surroundings, tick_rate: u32) -> Result<(), DesignError> {
    if let Some(effect) = of.effects().next() {
        return Err(DesignError::NoSuchEffect { key: effect.key() });
    }
    let within = |what, given: f64, least: f64, most: f64, must_be| {
        if given >= least && given <= most { Ok(()) } else { Err(DesignError::OutOfRange { what, given, must_be }) }
    };
    let must_be = "the tick rate: a virtual joint's tick is a control period";
    within("the control rate", of.control_rate.into(), tick_rate.into(), tick_rate.into(), must_be)?;
    let most = COMMAND_QUEUE_LENGTH as f64 - 1.0;
    within("the control delay", of.delay, 0.0, most, "from 0 to 4 control periods")?;
    within("the efficiency", of.efficiency, 0.1, 1.0, "from 0.1 to 1")?;
    for encoder in [&of.motor_encoder, &of.output_encoder] {
        let turn = encoder.counts_per_turn as f64;
        within("the number of counts in a turn of an encoder", turn, 12.0, 16_777_216.0, "from 12 to 2^24")?;
    }
    let ratio = joint.geometry.ratio_by_radii() / joint.geometry.ratio_by_teeth();
    within(
        "the ratio by radii over the ratio by teeth",
        ratio,
        1.0 - 1e-9,
        1.0 + 1e-9,
        "1: a virtual joint counts teeth",
    )
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use parameters::{Effect, PayloadStep};

    use super::*;
    use crate::gears::design::design;
    use crate::virtual_joint::VirtualJoint;

    #[test]
    fn unsupported_effect_is_refused_by_its_key() {
        let file = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
        let tables: Tables<f32, 3> = design(&file.parameters, 10_000).expect("tables");
        let mut around = file.surroundings;
        assert!(design_surroundings::<f32, 3>(&file.parameters, &around, &tables).is_ok());
        around.payload_step = PayloadStep { time: 1.0, ratio: 3.0 };
        let refused = design_surroundings::<f32, 3>(&file.parameters, &around, &tables).expect_err("refused");
        assert_eq!(refused, DesignError::NoSuchEffect { key: Effect::PayloadStep.key() });
        assert!(refused.to_string().contains("`payload_step_ratio`"), "{refused}");
        around = file.surroundings;
        around.output_encoder.noise_counts = 1.0;
        let refused = design_surroundings::<f32, 3>(&file.parameters, &around, &tables).expect_err("refused");
        assert!(refused.to_string().contains("`noise_counts`"), "{refused}");
    }

    /// Angles of motor and link [turns] after 0.5 s of a pull at the link of C1 with the motor off.
    fn pulled(efficiency: f64, torque: f32) -> [f64; 2] {
        let mut file = joint_file::read(joint_file::preset("c1").expect("a preset")).expect("a joint");
        file.surroundings.efficiency = efficiency;
        file.surroundings.gravity_torque = 0.0;
        let gears: Tables<f32, 1> = design(&file.parameters, file.surroundings.control_rate).expect("tables");
        let around = design_surroundings(&file.parameters, &file.surroundings, &gears).expect("tables");
        let mut joint = VirtualJoint::new(&gears, &around);
        (0..5000).for_each(|_| joint.advance(0.0, torque));
        let samples = joint.samples();
        let turns = |counts: u32, encoder: &EncoderErrorTable<f32>| {
            f64::from(encoder.angle(counts).cast_signed()) / f64::powi(2.0, 32)
        };
        [
            turns(samples.motor.counts, &around.encoders[0]),
            turns(samples.output.expect("an output encoder").counts, &around.encoders[1]),
        ]
    }

    #[test]
    fn self_locking_gear_holds_the_link() {
        // Gap of 3 arcmin, twice the wind-up of 20 N m at 20 N m/arcmin as the link swings into the teeth, and an
        // encoder error.
        let most = (3.0 + 2.0 + 1.0) / (360.0 * 60.0);
        for torque in [20.0, -20.0] {
            let [motor, link] = pulled(0.4, torque);
            assert!(motor.abs() < 0.01 && link.abs() < most, "{torque} N m: {motor}, {link} turns");
            let [_, link] = pulled(0.9, torque);
            assert!(link.abs() > 10.0 * most, "{torque} N m: {link} turns");
        }
    }
}
