//! Standard motion profiles of the link, each with a smooth start.

use std::f64::consts::TAU;
use std::sync::Arc;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::Motion;

/// Motion over time.
pub trait MotionProfile {
    /// Returns the motion at a time [s].
    fn at(&self, time: f64) -> Motion;
}

/// Motion shared by several runs.
pub type SharedProfile = Arc<dyn MotionProfile + Send + Sync>;

/// Standard motions.
#[derive(Debug, Clone, PartialEq)]
pub enum Profile {
    /// Sine: amplitude sin(2 pi frequency t), fading in over the first second.
    Sine {
        /// [rad].
        amplitude: f64,
        /// [Hz].
        frequency: f64,
    },
    /// Sum of five sines of random frequency and phase, fading in over the first second.
    Random {
        /// Standard deviation [rad].
        amplitude: f64,
        /// Highest frequency [Hz].
        highest: f64,
        /// Seed of frequencies and phases.
        seed: u64,
    },
    /// To and fro between two points on minimum-jerk paths, with a rest after each way. The rests vary, so that a
    /// controller cannot predict the next move without preview.
    Steps {
        /// [rad].
        height: f64,
        /// Duration of one way [s].
        duration: f64,
        /// Shortest rest [s].
        rest: f64,
        /// Seed of the rests' lengths.
        seed: u64,
    },
    /// Periodic path of a leg's joint, fading in over the first second: amplitude (sin p + sin(2 p + 1) / 2) / 1.5 with
    /// p = 2 pi frequency t. The second harmonic gives the two unequal bends of a knee in a step (assumed shape).
    Walking {
        /// [rad].
        amplitude: f64,
        /// Step frequency [Hz].
        frequency: f64,
    },
    /// Stay at an angle [rad].
    Hold(f64),
}

/// Minimum-jerk path from 0 to 1 over 0 to 1 with its first two derivatives.
pub fn minimum_jerk(part: f64) -> [f64; 3] {
    let s = part.clamp(0.0, 1.0);
    [
        s * s * s * (10.0 + s * (6.0 * s - 15.0)),
        30.0 * s * s * (1.0 - s) * (1.0 - s),
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    ]
}

/// Fades a motion in over a time, by the product rule.
pub fn swelling(time: f64, over: f64, motion: Motion) -> Motion {
    let [f, df, ddf] = minimum_jerk(time / over);
    let (df, ddf) = (df / over, ddf / (over * over));
    Motion {
        position: f * motion.position,
        speed: df * motion.position + f * motion.speed,
        acceleration: ddf * motion.position + 2.0 * df * motion.speed + f * motion.acceleration,
    }
}

fn sine(amplitude: f64, frequency: f64, phase: f64, time: f64) -> Motion {
    let rate = TAU * frequency;
    let (sine, cosine) = (rate * time + phase).sin_cos();
    Motion {
        position: amplitude * sine,
        speed: amplitude * rate * cosine,
        acceleration: -amplitude * rate * rate * sine,
    }
}

fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

impl MotionProfile for Profile {
    fn at(&self, time: f64) -> Motion {
        match *self {
            Self::Sine { amplitude, frequency } => swelling(time, 1.0, sine(amplitude, frequency, 0.0, time)),
            Self::Walking { amplitude, frequency } => {
                let first = sine(amplitude / 1.5, frequency, 0.0, time);
                let second = sine(0.5 * amplitude / 1.5, 2.0 * frequency, 1.0, time);
                let sum = Motion {
                    position: first.position + second.position,
                    speed: first.speed + second.speed,
                    acceleration: first.acceleration + second.acceleration,
                };
                swelling(time, 1.0, sum)
            }
            Self::Random { amplitude, highest, seed } => {
                let mut random = ChaCha8Rng::seed_from_u64(seed);
                let mut sum = Motion::default();
                for index in 0..5 {
                    // One sine per fifth of the band, so that no draw is slow throughout.
                    let frequency = highest * (index as f64 + 0.1 + 0.9 * uniform(&mut random)) / 5.0;
                    let part = sine(amplitude * (0.4_f64).sqrt(), frequency, TAU * uniform(&mut random), time);
                    sum.position += part.position;
                    sum.speed += part.speed;
                    sum.acceleration += part.acceleration;
                }
                swelling(time, 1.0, sum)
            }
            Self::Steps { height, duration, rest, seed } => {
                let mut random = ChaCha8Rng::seed_from_u64(seed);
                let (mut from, mut start, mut moved) = (0.0, rest, 0.0);
                while time > start {
                    let to = height - from;
                    if time < start + duration {
                        let [f, df, ddf] = minimum_jerk((time - start) / duration);
                        return Motion {
                            position: from + (to - from) * f,
                            speed: (to - from) * df / duration,
                            acceleration: (to - from) * ddf / (duration * duration),
                        };
                    }
                    moved = to;
                    from = to;
                    start += duration + rest * (1.0 + uniform(&mut random));
                }
                Motion { position: moved, ..Motion::default() }
            }
            Self::Hold(angle) => Motion { position: angle, ..Motion::default() },
        }
    }
}
