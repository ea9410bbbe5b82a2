//! The core and the independent reference, tick by tick.

use host_tests::tolerance::equivalent;
use model_core::gears::design::design;
use model_core::gears::{Model, Tables, Torques};
use model_core::numbers::Real;
use reference::joint::{Reference, RelativeState, Start};

use crate::random::{Motion, motion};

/// Seeds of random joints at each tick rate.
const SEEDS: u64 = 40;

/// Largest growth of a change of the start; motions above it are left out, as they would test the motion instead of the step.
const PREDICTABLE: f64 = 30.0;

/// Gap of the reference after each tick, from an offset from its middle [m].
fn reference_gaps(motion: &Motion, offset: f64) -> Vec<f64> {
    let sun_planet = [0.5 * offset].into_iter().collect();
    let start = RelativeState { gap: offset, sun_planet, ..RelativeState::centred(1) };
    let mut reference = Reference::start(&motion.joint, &Start::Relative(start)).expect("a sound joint");
    let mut seen = vec![reference.observe().gap];
    for tick in 0..motion.ticks {
        let (drive, load) = motion.torques_at(tick);
        let end = f64::from(tick + 1) / f64::from(motion.tick_rate);
        reference.advance(end, drive, load).expect("a motion that can be integrated");
        seen.push(reference.observe().gap);
    }
    seen
}

/// Gap of the core after each tick [m].
fn core_gaps<T: Real>(motion: &Motion) -> Vec<f64> {
    let tables: Tables<T, 1> = design(&motion.joint, motion.tick_rate).expect("a joint that can be stepped");
    let mut model = Model::new(&tables);
    let mut seen = vec![model.outputs().gap.to_f64()];
    for tick in 0..motion.ticks {
        let (drive, load) = motion.torques_at(tick);
        model.step(Torques { drive: T::from_f64(drive), load: T::from_f64(load) });
        seen.push(model.outputs().gap.to_f64());
    }
    seen
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}

fn difference(one: &[f64], other: &[f64]) -> f64 {
    rms(one.iter().zip(other).map(|(one, other)| one - other))
}

/// RMS errors of f32 and f64 over the RMS gap; `None` for an unpredictable motion.
fn errors(motion: &Motion) -> Option<[f64; 2]> {
    let right = reference_gaps(motion, 0.0);
    let offset = 1e-9 * motion.joint.characteristic_length;
    let growth = difference(&right, &reference_gaps(motion, offset)) / offset;
    let scale = rms(right.iter().copied());
    let found = [core_gaps::<f32>(motion), core_gaps::<f64>(motion)];
    (growth < PREDICTABLE).then(|| found.map(|found| difference(&found, &right) / scale))
}

/// The core follows the reference on random gears at 10, 20 and 40 kHz.
#[test]
fn random_gears_follow_reference() {
    for tick_rate in [10_000, 20_000, 40_000] {
        let motions = (0..SEEDS).map(|seed| motion(seed + u64::from(tick_rate), tick_rate));
        let all: Vec<[f64; 2]> = motions.filter_map(|motion| errors(&motion)).collect();
        assert!(all.len() >= 30, "{} motions at {tick_rate} Hz can be predicted", all.len());
        let worst = |which: usize| all.iter().map(|error| error[which]).fold(0.0, f64::max);
        println!("{tick_rate} Hz, {} motions:", all.len());
        equivalent::RANDOM.check(worst(0));
        equivalent::RANDOM_DOUBLE.check(worst(1));
    }
}

/// The median error of random gears is at the level of f32 rounding.
#[test]
fn median_error_is_rounding() {
    let mut all: Vec<f64> = (1000..1120).filter_map(|seed| Some(errors(&motion(seed, 20_000))?[0])).collect();
    all.sort_by(f64::total_cmp);
    equivalent::RANDOM_MEDIAN.check(all[all.len() / 2]);
    equivalent::RANDOM_90_PERCENT.check(all[9 * all.len() / 10]);
}
