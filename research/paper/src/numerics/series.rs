//! Taylor series of motion and of tangent vectors about one moment, on fixed branches of the force law. The equations are eqs 1-6 along the
//! line of action; the coordinates are X_sp + e (planets), X_sc (gap) and the wind-up.

use super::system::{MAX_COORDINATES, MAX_MESHES, System};
use super::zone::{Guard, Zone};

/// Highest power kept.
pub(super) const ORDER: usize = 14;

/// Number of terms of a series.
pub(super) const TERMS: usize = ORDER + 1;

/// Coordinates or their rates; entries beyond the system's coordinates are unused.
pub type Coordinates = [f64; MAX_COORDINATES];

/// Positions and rates, dimensionless: sun-planet displacement of every planet (X_sp + e/b_c), gap X_sc, wind-up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Positions over b_c.
    pub position: Coordinates,
    /// Rates over b_c omega_n.
    pub rate: Coordinates,
}

type MeshTerms = [[f64; MAX_MESHES]; TERMS];

/// Motion-independent data of a step: stiffness and error as series, branches as masks.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    meshes: usize,
    stiffness: MeshTerms,
    error: MeshTerms,
    damper: [f64; MAX_MESHES],
    acts: [f64; MAX_MESHES],
    offset: [f64; MAX_MESHES],
}

/// Motion, or tangent vector, as power series in time.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub position: [Coordinates; TERMS],
    /// Deflections less errors, before the backlash is subtracted.
    pub deflection: MeshTerms,
    /// Forces of meshes by their contact law, acting or not.
    pub force: MeshTerms,
}

impl Moment {
    /// Data at a time since the beginning of a mesh period.
    pub fn new(system: &System, zones: &[Zone; MAX_MESHES], time: f64) -> Self {
        let meshes = system.meshes.len();
        let mut moment = Self {
            meshes,
            stiffness: [[0.0; MAX_MESHES]; TERMS],
            error: [[0.0; MAX_MESHES]; TERMS],
            damper: [0.0; MAX_MESHES],
            acts: [0.0; MAX_MESHES],
            offset: [0.0; MAX_MESHES],
        };
        let most = system.meshes.iter().map(|mesh| mesh.harmonics.len()).max().unwrap_or(0);
        for order in 1..=most {
            let rate = order as f64 * system.omega;
            let (sine, cosine) = (rate * time).sin_cos();
            // Derivatives of sine and cosine of m phase, over factorials: they repeat after four with changed sign.
            let mut factor = 1.0;
            for power in 0..TERMS {
                let (of_sine, of_cosine) = match power % 4 {
                    0 => (sine, cosine),
                    1 => (cosine, -sine),
                    2 => (-sine, -cosine),
                    _ => (-cosine, sine),
                };
                let (of_sine, of_cosine) = (factor * of_sine, factor * of_cosine);
                for (index, mesh) in system.meshes.iter().enumerate() {
                    if let Some(wave) = mesh.harmonics.get(order - 1) {
                        let ripple = wave.sine * of_sine + wave.cosine * of_cosine;
                        moment.stiffness[power][index] += mesh.mean_stiffness * ripple;
                    }
                    if order == 1 {
                        moment.error[power][index] = mesh.error.sine * of_sine + mesh.error.cosine * of_cosine;
                    }
                }
                factor *= rate / (power + 1) as f64;
            }
        }
        for (index, mesh) in system.meshes.iter().enumerate() {
            let branch = zones[index].branch(mesh, system.law);
            moment.stiffness[0][index] += mesh.mean_stiffness;
            for terms in &mut moment.stiffness {
                terms[index] *= branch.spring;
            }
            moment.damper[index] = branch.damper * mesh.damping;
            moment.acts[index] = branch.acts;
            moment.offset[index] = branch.offset;
        }
        moment
    }

    /// Stiffness of a mesh at the moment itself; zero where the branch has no spring.
    pub fn stiffness_now(&self, mesh: usize) -> f64 {
        self.stiffness[0][mesh]
    }
}

impl Series {
    /// Motion that starts at `state`.
    pub fn motion(system: &System, moment: &Moment, state: &State) -> Self {
        Self::expand(system, moment, state, 1.0)
    }

    /// Tangent vector on the same branches, without errors, backlash and torques.
    pub fn tangent(system: &System, moment: &Moment, state: &State) -> Self {
        Self::expand(system, moment, state, 0.0)
    }

    fn expand(system: &System, moment: &Moment, state: &State, imposed: f64) -> Self {
        let planets = system.planets;
        let coordinates = system.coordinates();
        let (gap, wind_up) = (planets, planets + 1);
        let [sun, planet, carrier, link] = system.mobilities;
        let mut series = Self {
            position: [[0.0; MAX_COORDINATES]; TERMS],
            deflection: [[0.0; MAX_MESHES]; TERMS],
            force: [[0.0; MAX_MESHES]; TERMS],
        };
        series.position[0] = state.position;
        series.position[1] = state.rate;
        series.deflect(moment, planets, 0, imposed);
        for power in 0..TERMS - 2 {
            series.deflect(moment, planets, power + 1, imposed);
            let mut force = [0.0; MAX_MESHES];
            for lower in 0..=power {
                let stiffness = &moment.stiffness[lower];
                let deflection = &series.deflection[power - lower];
                let offset = if lower == power { imposed } else { 0.0 };
                for (mesh, force) in force[..moment.meshes].iter_mut().enumerate() {
                    *force += stiffness[mesh] * (deflection[mesh] - offset * moment.offset[mesh]);
                }
            }
            let next = (power + 1) as f64;
            for (mesh, force) in force[..moment.meshes].iter_mut().enumerate() {
                *force += moment.damper[mesh] * next * series.deflection[power + 1][mesh];
            }
            series.force[power] = force;
            let acting = |mesh: usize| moment.acts[mesh] * force[mesh];
            let on_sun: f64 = (0..planets).map(acting).sum();
            let on_ring: f64 = (planets..2 * planets).map(acting).sum();
            let constant = if power == 0 { imposed } else { 0.0 };
            let behind = match system.compliance {
                Some((spring, damper)) => {
                    spring * series.position[power][wind_up] + damper * next * series.position[power + 1][wind_up]
                }
                None => constant * system.load_force,
            };
            let of_sun = sun * (constant * system.drive_force - on_sun);
            let of_carrier = carrier * (on_sun + on_ring - behind);
            let divisor = next * (next + 1.0);
            let mut acceleration = [0.0; MAX_COORDINATES];
            for (index, value) in acceleration[..planets].iter_mut().enumerate() {
                *value = of_sun - of_carrier - planet * (acting(index) - acting(planets + index));
            }
            acceleration[gap] = of_sun - 2.0 * of_carrier;
            if system.compliance.is_some() {
                acceleration[wind_up] = of_carrier - link * (behind - constant * system.load_force);
            }
            for (coefficient, value) in series.position[power + 2][..coordinates].iter_mut().zip(acceleration) {
                *coefficient = value / divisor;
            }
        }
        series.deflect(moment, planets, TERMS - 1, imposed);
        series
    }

    /// Eq. 4 for one power: the sun-planet mesh is a coordinate, the ring-planet mesh the rest of the gap.
    fn deflect(&mut self, moment: &Moment, planets: usize, power: usize, imposed: f64) {
        let position = &self.position[power];
        let (error, deflection) = (&moment.error[power], &mut self.deflection[power]);
        for planet in 0..planets {
            deflection[planet] = position[planet] - imposed * error[planet];
            deflection[planets + planet] = position[planets] - position[planet] - imposed * error[planets + planet];
        }
    }

    /// Longest step whose last terms stay below `tolerance`.
    pub fn step(&self, coordinates: usize, tolerance: f64) -> f64 {
        let longest = |power: usize| {
            let greatest = self.position[power][..coordinates].iter().fold(0.0_f64, |most, c| most.max(c.abs()));
            (tolerance / greatest.max(f64::MIN_POSITIVE)).powf(1.0 / power as f64)
        };
        longest(ORDER).min(longest(ORDER - 1))
    }

    /// State at a time after the start.
    pub fn at(&self, coordinates: usize, time: f64) -> State {
        let mut state = State::default();
        for power in (0..TERMS).rev() {
            let terms = &self.position[power];
            for (index, term) in terms[..coordinates].iter().enumerate() {
                state.rate[index] = state.rate[index] * time + state.position[index];
                state.position[index] = state.position[index] * time + term;
            }
        }
        state
    }

    /// Guard as a polynomial, positive as long as its zone holds.
    pub fn guard(&self, mesh: usize, half_backlash: f64, guard: Guard, sign: f64) -> [f64; TERMS] {
        let column = |terms: &MeshTerms| core::array::from_fn(|power| sign * terms[power][mesh]);
        let edge = match guard {
            Guard::NoForce => return column(&self.force),
            Guard::DriveEdge => half_backlash,
            Guard::BackEdge => -half_backlash,
        };
        let mut terms: [f64; TERMS] = column(&self.deflection);
        terms[0] -= sign * edge;
        terms
    }

    /// Deceleration of the coordinates by a unit force of one mesh.
    pub fn gain(system: &System, mesh: usize) -> Coordinates {
        let planets = system.planets;
        let [sun, planet, carrier, _] = system.mobilities;
        let (of_sun, side) = if mesh < planets { (sun, 1.0) } else { (0.0, -1.0) };
        let mut gain = [0.0; MAX_COORDINATES];
        gain[..planets].fill(of_sun + carrier);
        gain[mesh % planets] += side * planet;
        gain[planets] = of_sun + 2.0 * carrier;
        if system.compliance.is_some() {
            gain[planets + 1] = -carrier;
        }
        gain
    }
}
