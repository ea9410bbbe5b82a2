//! Eq. 19 term by term as the paper prints it, with the sum that its second row lost, in the paper's own X: deflections
//! of the sun-planet meshes (errors taken off) and the gap coordinate.

use parameters::MAX_PLANETS;
use reference::integrator::{Entries, Guards, MAX_ENTRIES, SwitchedSystem};

use crate::joint::{Deflections, Joint, Moving};

/// State: X_sp of every planet, X_sc, then their rates.
pub struct Equation19 {
    joint: Joint,
    /// Whether the K_rp term of the second row is summed over planets, as it must be.
    pub sum_of_the_second_row: bool,
}

impl Equation19 {
    pub fn new(joint: Joint) -> Self {
        Self { joint, sum_of_the_second_row: true }
    }

    /// X = X' = 0, as the reference starts.
    pub fn start(&self) -> Entries {
        [0.0; MAX_ENTRIES]
    }

    pub fn deflections(&self, time: f64, state: &Entries) -> Deflections {
        self.joint.list(&self.meshes(time, state))
    }

    /// X_spi, and the argument of f for the ring: X_sc - X_spi - e_spi - e_rpi; with their rates.
    fn meshes(&self, time: f64, state: &Entries) -> [[Moving; MAX_PLANETS]; 2] {
        let n = self.joint.planets;
        let (positions, rates) = (&state[..=n], &state[n + 1..]);
        let mut meshes = [[Moving::default(); MAX_PLANETS]; 2];
        for i in 0..n {
            let (sun, ring) = (self.joint.error(0, i, time), self.joint.error(1, i, time));
            meshes[0][i] = Moving { deflection: positions[i], rate: rates[i] };
            meshes[1][i] = Moving {
                deflection: positions[n] - positions[i] - sun[0] - ring[0],
                rate: rates[n] - rates[i] - sun[1] - ring[1],
            };
        }
        meshes
    }
}

impl SwitchedSystem for Equation19 {
    fn dimension(&self) -> usize {
        2 * (self.joint.planets + 1)
    }

    fn derivative(&self, time: f64, state: &Entries, rates: &mut Entries) {
        let joint = &self.joint;
        let (n, sun, planet, carrier) = (joint.planets, joint.sun, joint.planet, joint.carrier);
        let meshes = self.meshes(time, state);
        let elastic = |kind: usize, i: usize| joint.elastic(kind, i, time, meshes[kind][i].deflection);
        let damping = |kind: usize, i: usize| joint.meshes[kind][i].damping * meshes[kind][i].rate;
        let sum = |of: &dyn Fn(usize) -> f64| (0..n).map(of).sum::<f64>();
        let (sun_elastic, ring_elastic) = (sum(&|i| elastic(0, i)), sum(&|i| elastic(1, i)));
        let (sun_damping, ring_damping) = (sum(&|i| damping(0, i)), sum(&|i| damping(1, i)));
        for i in 0..n {
            rates[i] = state[n + 1 + i];
            rates[n + 1 + i] = joint.drive + joint.load
                - joint.error(0, i, time)[2]
                - (1.0 / sun + 1.0 / carrier) * sun_elastic
                - elastic(0, i) / planet
                - (1.0 / sun + 1.0 / carrier) * sun_damping
                + elastic(1, i) / planet
                - ring_elastic / carrier
                + damping(1, i) / planet
                - damping(0, i) / planet
                - ring_damping / carrier;
        }
        let second_row = if self.sum_of_the_second_row { ring_elastic } else { elastic(1, 0) };
        rates[n] = state[2 * n + 1];
        rates[2 * n + 1] = joint.drive + 2.0 * joint.load
            - (1.0 / sun + 2.0 / carrier) * sun_elastic
            - 2.0 / carrier * second_row
            - (1.0 / sun + 2.0 / carrier) * sun_damping
            - 2.0 / carrier * ring_damping;
    }

    fn freeze(&mut self, time: f64, state: &Entries) {
        let meshes = self.meshes(time, state);
        self.joint.hold(&meshes);
    }

    fn guards(&self, time: f64, state: &Entries, _: &Entries, guards: &mut Guards) {
        self.joint.watch(&self.meshes(time, state), guards);
    }

    fn guard_resolution(&self) -> f64 {
        1e-12
    }

    fn tolerance(&self, _: usize) -> f64 {
        1e-12
    }

    fn longest_step(&self) -> f64 {
        0.5
    }
}
