//! Eq. 19 term by term as printed, with the sum missing in its second row restored, in the paper's own X: deflections of the sun-planet
//! meshes (errors subtracted) and the gap coordinate.

use parameters::MAX_PLANETS;
use reference::integrator::{Entries, MAX_ENTRIES};

use super::joint::{Formulation, Joint, MeshMotion};

/// State: X_sp of every planet, X_sc, then their rates.
pub struct Equation19 {
    /// Sums the K_rp term of the second row over planets, which is correct; the printed row has one planet.
    pub sum_of_the_second_row: bool,
}

impl Formulation for Equation19 {
    /// Start at X = X' = 0, where the reference starts.
    fn start(&self, _: &Joint) -> Entries {
        [0.0; MAX_ENTRIES]
    }

    /// X_spi, and the argument of f for the ring: X_sc - X_spi - e_spi - e_rpi; with their rates.
    fn meshes(&self, joint: &Joint, time: f64, state: &Entries) -> [[MeshMotion; MAX_PLANETS]; 2] {
        let n = joint.planets;
        let (positions, rates) = (&state[..=n], &state[n + 1..]);
        let mut meshes = [[MeshMotion::default(); MAX_PLANETS]; 2];
        for i in 0..n {
            let (sun, ring) = (joint.error(0, i, time), joint.error(1, i, time));
            meshes[0][i] = MeshMotion { deflection: positions[i], rate: rates[i] };
            meshes[1][i] = MeshMotion {
                deflection: positions[n] - positions[i] - sun[0] - ring[0],
                rate: rates[n] - rates[i] - sun[1] - ring[1],
            };
        }
        meshes
    }

    fn derivative(&self, joint: &Joint, time: f64, state: &Entries, rates: &mut Entries) {
        let (n, sun, planet, carrier) = (joint.planets, joint.sun, joint.planet, joint.carrier);
        let meshes = self.meshes(joint, time, state);
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
}
