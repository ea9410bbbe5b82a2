//! Random equivalent gears by seed, and their motions through the gap.

use model_core::gears::Scales;
use model_core::numbers::random::splitmix64;
use parameters::{EquivalentGear, JointParameters};

/// Random numbers of a seed.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9) ^ 0x5eed)
    }

    /// Uniform number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (splitmix64(&mut self.0) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Log-uniform number between two bounds.
    pub fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
}

/// Joint and the torques that move it.
pub struct Motion {
    pub joint: JointParameters,
    pub tick_rate: u32,
    pub ticks: u32,
    /// First tick, drive torque and load torque of each segment [N m].
    pub torques: Vec<(u32, f64, f64)>,
    /// Phase of the contact in a tick [rad].
    pub phase: f64,
}

impl Motion {
    /// Drive and load torque of a tick [N m].
    pub fn torques_at(&self, tick: u32) -> (f64, f64) {
        let index = self.torques.partition_point(|(from, ..)| *from <= tick) - 1;
        (self.torques[index].1, self.torques[index].2)
    }
}

/// Random gear between a belt and a cycloid drive, at a tick rate; the contact's phase in a tick is drawn first.
pub fn motion(seed: u64, tick_rate: u32) -> Motion {
    let random = &mut Random::new(seed);
    let phase = random.log_uniform(0.02, 0.65);
    let denominator = [1, 1, 2, 7, 38][(5.0 * random.unit()) as usize];
    let ratio = [denominator + 1 + random.log_uniform(1.0, 150.0 * f64::from(denominator)) as u32, denominator];
    let rated = random.log_uniform(1.0, 300.0);
    let exact_ratio = f64::from(ratio[0]) / f64::from(ratio[1]);
    let frequency = phase * f64::from(tick_rate);
    let link_inertia = random.log_uniform(1e-3, 1.0) * rated / 10.0;
    let motor_share = random.log_uniform(0.2, 5.0);
    let rotor_and_gear = link_inertia * motor_share / (exact_ratio * exact_ratio);
    let reduced = link_inertia * motor_share / (1.0 + motor_share);
    let in_gear = random.uniform(0.05, 0.9);
    let stiffness = frequency * frequency * reduced;
    let wind_up = rated / stiffness;
    let gear = EquivalentGear {
        ratio,
        lost_motion: if seed.is_multiple_of(7) { 0.0 } else { wind_up * random.log_uniform(0.05, 20.0) },
        stiffness,
        damping_ratio: random.uniform(0.0, 0.3),
        inertia_at_input: in_gear * rotor_and_gear,
    };
    let joint =
        gear.joint("random".try_into().expect("a short name"), (1.0 - in_gear) * rotor_and_gear, link_inertia, rated);
    assert!((Scales::new(&joint).frequency / frequency - 1.0).abs() < 1e-9);
    // Load and drive balance except for a part that turns the joint, and for reversals.
    let ticks = 1200;
    let mut torques = Vec::new();
    for from in (0..ticks).step_by(150) {
        let load = rated * random.uniform(-1.0, 1.0);
        torques.push((from, (load + 0.3 * rated * random.uniform(-1.0, 1.0)) / exact_ratio, load));
    }
    Motion { joint, tick_rate, ticks, torques, phase }
}
