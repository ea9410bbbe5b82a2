//! Exponential ticks of light planets: used while every tooth keeps contact, and rejected where a tooth opens within the tick. A rejected
//! tick equals Verlet sub-steps in every bit.

use host_tests::tolerance::light_planets::{EXPONENTIAL_TICK, EXPONENTIAL_TICK_SWINGING, OVERLOOKED_OPENING};
use model_core::gears::{Model, Tables, Torques};
use parameters::{ContactState, DampingLaw, JointParameters};
use reference::joint::RelativeState;

use super::subject::{at_rest_under, joint, reference, state, tables, verlet_only};

const RATE: u32 = 10_000;
const SUBSTEPS: u32 = 8;
/// Samples of the reference within the tick.
const MOMENTS: u32 = 100;

/// Ticks by contact and method.
#[derive(Debug, Default)]
struct TickCounts {
    /// Ticks with every tooth in contact: advanced by the exponential, left to Verlet sub-steps.
    closed: [u32; 2],
    /// Ticks in which a tooth opens: advanced by the exponential, left to Verlet sub-steps.
    opened: [u32; 2],
    /// Largest error of the exponential with every tooth in contact, over b_c.
    error: f64,
    /// Widest opening that the exponential overlooked, over b_c.
    overlooked: f64,
}

impl TickCounts {
    fn add<const N: usize>(
        &mut self,
        joint: &JointParameters,
        both: &[Tables<f64, N>; 2],
        start: &RelativeState,
        torques: (f64, f64),
    ) {
        let seen = reference(joint, start, torques, MOMENTS * RATE, MOMENTS);
        let length = joint.characteristic_length;
        let separated = |contact: &ContactState| *contact == ContactState::Separated;
        let opens = seen.iter().any(|seen| seen.contacts.iter().flatten().any(separated));
        let [ours, verlet] = both.each_ref().map(|tables| {
            let mut model = Model::new(tables);
            model.set_state(state(joint, tables, start));
            model.step(Torques { drive: torques.0, load: torques.1 });
            (model.state_digest(), model.outputs().deflections)
        });
        let refused = ours.0 == verlet.0;
        let count = if opens { &mut self.opened } else { &mut self.closed };
        count[usize::from(refused)] += 1;
        if !refused && !opens {
            let right = seen[MOMENTS as usize].deflections.iter().flatten();
            let off = ours.1.iter().flatten().zip(right).map(|(found, right)| (found - right).abs() / length);
            self.error = off.fold(self.error, f64::max);
        }
        if !refused && opens {
            let half = joint.sun_planet.half_backlash[0];
            let open =
                seen.iter().flat_map(|seen| seen.deflections.iter().flatten()).map(|d| (half - d.abs()) / length);
            self.overlooked = open.fold(self.overlooked, f64::max);
        }
    }
}

/// Ticks of a joint that turns under balanced torques of either sign while one planet moves away from the sun at increasing speeds.
fn count_receding<const N: usize>(law: DampingLaw) -> TickCounts {
    found::<N>(law, |_, start, drive| {
        let at = |step: u32| {
            let mut start = start.clone();
            start.sun_planet_rate[0] = -drive.signum() * 0.003 * f64::from(step);
            start
        };
        (0..12).map(at).collect()
    })
}

/// Ticks of the same joint while one planet is off its balance between sun and ring and swings. Positions are fractions of the static
/// deflection, speeds those of a swing with that amplitude.
fn count_swinging<const N: usize>(law: DampingLaw) -> TickCounts {
    found::<N>(law, |joint, start, drive| {
        let deflection = start.sun_planet[0] - drive.signum() * joint.sun_planet.half_backlash[0];
        let stiffness = joint.sun_planet.mean_stiffness + joint.ring_planet.mean_stiffness;
        let frequency = (stiffness / joint.bodies.planet_equivalent_mass).sqrt();
        let at = |place: f64, speed: f64| {
            let mut start = start.clone();
            start.sun_planet[1] += place * deflection;
            start.sun_planet_rate[1] = speed * deflection * frequency;
            start
        };
        let (places, speeds) = ([-0.8, -0.4, 0.4, 0.8], [-0.8, -0.1, 0.0, 0.1, 0.8]);
        places.into_iter().flat_map(|place| speeds.map(|speed| at(place, speed))).collect()
    })
}

/// Ticks from all starts, each derived from the state at rest under a torque.
fn found<const N: usize>(
    law: DampingLaw,
    starts: impl Fn(&JointParameters, &RelativeState, f64) -> Vec<RelativeState>,
) -> TickCounts {
    let joint = joint(N, law);
    let both = [tables::<N>(&joint, RATE, SUBSTEPS), verlet_only::<N>(&joint, RATE, SUBSTEPS)];
    let mut found = TickCounts::default();
    for drive in [-3.0_f64, -1.0, 0.1, 0.5, 2.0, 3.0] {
        let (rest, load) = at_rest_under(&joint, drive);
        let turning = RelativeState { rigid_speed: 3.0, ..rest };
        for start in starts(&joint, &turning, drive) {
            found.add(&joint, &both, &start, (drive, load));
        }
    }
    println!("{N} planets, {law:?}: {found:?}");
    found
}

fn check<const N: usize>() {
    for law in [DampingLaw::Contact, DampingLaw::Paper] {
        for (found, bound) in
            [(count_receding::<N>(law), &EXPONENTIAL_TICK), (count_swinging::<N>(law), &EXPONENTIAL_TICK_SWINGING)]
        {
            assert!(found.closed[0] >= 5 && found.opened[1] >= 5, "ticks of both kinds: {found:?}");
            bound.check(found.error);
            OVERLOOKED_OPENING.check(found.overlooked);
        }
    }
}

/// A tick in which a tooth opens is left to Verlet sub-steps.
#[test]
fn opening_tooth_takes_verlet_substeps() {
    check::<3>();
    check::<4>();
    check::<5>();
}
