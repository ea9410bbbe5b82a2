//! Independent check of an attractor: the event-restarted Runge-Kutta method of order 8 in absolute coordinates, which shares neither
//! equations nor method with the study. It is too slow for whole diagrams.

use model_core::gears::Scales;
use reference::joint::{Reference, RelativeState, Start};

use super::plan::StudyJoint;
use crate::numerics::attractor::Class;
use crate::numerics::integrator::{EventIntegrator, State};

/// Periods compared on an attractor without a period: neighbouring trajectories have diverged little by then.
const PERIODS: usize = 6;

/// Largest distance over b_c (rates over b_c omega_n) at the next Poincare points, from the present state of a motion; `None` if the second
/// integrator rejects the joint.
pub fn distance(subject: &StudyJoint, half_backlash: f64, motion: &EventIntegrator<'_>, class: Class) -> Option<f64> {
    let parameters = subject.with_half_backlash(half_backlash);
    let scales = Scales::new(&parameters);
    let system = motion.system();
    let planets = system.planets();
    let (length, speed) = (scales.length, scales.length * scales.frequency);
    let State { position, rate } = motion.state();
    let deflections = (0..planets).map(|planet| motion.deflection(planet));
    let start = RelativeState {
        sun_planet: deflections.clone().map(|(deflection, _)| deflection * length).collect(),
        sun_planet_rate: deflections.map(|(_, rate)| rate * speed).collect(),
        gap: position[planets] * length,
        gap_rate: rate[planets] * speed,
        wind_up: position[planets + 1] * length,
        wind_up_rate: rate[planets + 1] * speed,
        rigid_speed: 0.0,
    };
    let mut reference = Reference::start(&parameters, &Start::Relative(start)).ok()?;
    let mut own = EventIntegrator::new(system, motion.state());
    let periods = match class {
        Class::Periodic(period) => period,
        _ => PERIODS,
    };
    let mut greatest: f64 = 0.0;
    for period in 1..=periods {
        own.period().ok()?;
        let time = period as f64 * system.period() / scales.frequency;
        reference.advance(time, subject.drive_torque, subject.load_torque).ok()?;
        let seen = reference.observe();
        for planet in 0..planets {
            let (deflection, rate) = own.deflection(planet);
            greatest = greatest.max((seen.deflections[0][planet] / length - deflection).abs());
            greatest = greatest.max((seen.deflection_rates[0][planet] / speed - rate).abs());
        }
        greatest = greatest.max((seen.gap / length - own.state().position[planets]).abs());
        greatest = greatest.max((seen.gap_rate / speed - own.state().rate[planets]).abs());
    }
    Some(greatest)
}
