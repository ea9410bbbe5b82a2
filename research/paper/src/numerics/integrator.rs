//! Integrates a joint mesh period by mesh period: Taylor steps that end at every contact event, together with any number of tangent
//! vectors. No history is kept.

use parameters::{ContactState, DampingLaw};

use super::first_root::first_fall;
pub use super::series::{Coordinates, State};
use super::series::{Moment, Series};
use super::system::{MAX_COORDINATES, MAX_MESHES, StudyError, System};
use super::zone::{Guard, Side, Zone};

/// Size of the last terms kept, over b_c; the neglected terms are smaller.
const TOLERANCE: f64 = 1e-12;

/// Longest step in dimensionless time, as required by `first_root`.
const LONGEST_STEP: f64 = 0.6;

/// Shortest step that counts as progress, in periods.
const SHORTEST_PROGRESS: f64 = 1e-12;

/// Number of events without progress that count as one graze, which a short step without guards leaves behind.
const GRAZE_EVENTS: u32 = 32;

/// Length of the step out of a graze over the longest step.
const GRAZE_STEP: f64 = 1e-5;

/// Largest number of steps in one period, above that of any motion of gears.
const STEPS_MAX: u32 = 1_000_000;

/// Largest position of any motion of gears, over b_c.
const POSITION_MAX: f64 = 1e9;

/// Joint with its present state, integrated forwards.
#[derive(Debug, Clone)]
pub struct EventIntegrator<'a> {
    system: &'a System,
    state: State,
    /// Time since the beginning of the present period.
    time: f64,
    zones: [Zone; MAX_MESHES],
    tangents: Vec<State>,
    events: u64,
    steps: u64,
}

/// Motion within one step, evaluated at any time in it.
pub struct Segment<'a> {
    system: &'a System,
    series: &'a Series,
    /// Beginning of the segment, since the beginning of the period.
    pub from: f64,
    /// End of the segment.
    pub to: f64,
}

impl Segment<'_> {
    /// State at a time within the segment.
    pub fn at(&self, time: f64) -> State {
        self.series.at(self.system.coordinates(), time - self.from)
    }
}

impl<'a> EventIntegrator<'a> {
    /// Joint at the beginning of a period.
    pub fn new(system: &'a System, state: State) -> Self {
        let mut motion = Self {
            system,
            state,
            time: 0.0,
            zones: [Zone::Free; MAX_MESHES],
            tangents: Vec::new(),
            events: 0,
            steps: 0,
        };
        motion.find_zones();
        motion
    }

    /// Joint at X = X' = 0: every tooth in the middle of its gap, up to the transmission errors.
    pub fn from_rest(system: &'a System) -> Self {
        let mut state = State::default();
        for planet in 0..system.planets {
            (state.position[planet], state.rate[planet]) = system.transmission_error(planet, 0.0);
        }
        Self::new(system, state)
    }

    /// The joint.
    pub fn system(&self) -> &'a System {
        self.system
    }

    /// Present state.
    pub fn state(&self) -> State {
        self.state
    }

    /// Number of contact events so far.
    pub fn events(&self) -> u64 {
        self.events
    }

    /// Number of steps so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Tangent vectors of the motion.
    pub fn tangents(&mut self) -> &mut Vec<State> {
        &mut self.tangents
    }

    /// X_sp of planet 0, X_sc, X_sp' and X_sc' at the beginning of a period.
    pub fn poincare_point(&self) -> [f64; 4] {
        let (error, error_rate) = self.system.transmission_error(0, self.time);
        let gap = self.system.planets;
        let State { position, rate } = &self.state;
        [position[0] - error, position[gap], rate[0] - error_rate, rate[gap]]
    }

    /// Advances to the beginning of the next period.
    pub fn period(&mut self) -> Result<(), StudyError> {
        self.period_with(|_| ())
    }

    /// Advances to the beginning of the next period, with a callback for every segment.
    pub fn period_with(&mut self, mut look: impl FnMut(&Segment<'_>)) -> Result<(), StudyError> {
        let end = self.system.period();
        let coordinates = self.system.coordinates();
        let (mut steps, mut idle) = (0, 0);
        while self.time < end {
            steps += 1;
            if steps > STEPS_MAX {
                return Err(StudyError::TooStiff);
            }
            let moment = Moment::new(self.system, &self.zones, self.time);
            let series = Series::motion(self.system, &moment, &self.state);
            let remaining = end - self.time;
            let wanted = series.step(coordinates, TOLERANCE).min(LONGEST_STEP);
            let blind = idle >= GRAZE_EVENTS;
            let wanted = if blind { wanted.min(GRAZE_STEP * LONGEST_STEP) } else { wanted };
            // Two equal parts replace a full step and a tiny rest.
            let whole = if wanted >= remaining { remaining } else { wanted.min(0.5 * remaining) };
            let event = if blind { None } else { self.first_event(&series, whole) };
            let step = event.as_ref().map_or(whole, |event| event.step);
            if step > 0.0 {
                let to = if step == remaining { end } else { self.time + step };
                look(&Segment { system: self.system, series: &series, from: self.time, to });
                for tangent in &mut self.tangents {
                    *tangent = Series::tangent(self.system, &moment, tangent).at(coordinates, step);
                }
                self.state = series.at(coordinates, step);
                self.time = to;
            }
            let size = self.state.position[..coordinates].iter().fold(0.0, greater_magnitude);
            if size.is_nan() || size > POSITION_MAX {
                return Err(StudyError::NotFinite);
            }
            idle = if step > SHORTEST_PROGRESS * end { 0 } else { idle + 1 };
            if let Some(event) = event {
                self.events += 1;
                self.change(&event);
            } else if blind {
                self.find_zones();
                idle = 0;
            }
        }
        self.steps += u64::from(steps);
        self.time = 0.0;
        Ok(())
    }

    fn first_event(&self, series: &Series, step: f64) -> Option<Event> {
        let law = self.system.law;
        let mut first: Option<Event> = None;
        for (mesh, constants) in self.system.meshes.iter().enumerate() {
            for (guard, sign) in self.zones[mesh].guards(law) {
                let polynomial = series.guard(mesh, constants.half_backlash, *guard, *sign);
                match first_fall(&polynomial, step) {
                    Some(at) if first.as_ref().is_none_or(|event| at < event.step) => {
                        first = Some(Event { step: at, falls: vec![(mesh, *guard)] });
                    }
                    // Planets in phase change contact at the same time; separate events would drive them apart by rounding alone.
                    Some(at) => first.iter_mut().filter(|e| e.step == at).for_each(|e| e.falls.push((mesh, *guard))),
                    None => {}
                }
            }
        }
        first
    }

    fn change(&mut self, event: &Event) {
        for &(mesh, guard) in &event.falls {
            let before = self.zones[mesh];
            self.zones[mesh] = before.after(guard);
            let meets = before == Zone::Free && self.system.law == DampingLaw::Contact;
            if meets {
                self.jump(mesh);
            }
        }
    }

    /// Carries tangent vectors across a moment at which a mesh force jumps by C d' (law `contact`): neighbouring trajectories meet earlier
    /// or later by -dd / d', and feel the jump longer or shorter by this time.
    fn jump(&mut self, mesh: usize) {
        let planets = self.system.planets;
        let damping = self.system.meshes[mesh].damping;
        let gain = Series::gain(self.system, mesh);
        for tangent in &mut self.tangents {
            let planet = mesh % planets;
            let of_planet = tangent.position[planet];
            let deflection = if mesh < planets { of_planet } else { tangent.position[planets] - of_planet };
            for (rate, gain) in tangent.rate.iter_mut().zip(gain) {
                *rate -= gain * damping * deflection;
            }
        }
    }

    fn find_zones(&mut self) {
        let moment = Moment::new(self.system, &[Zone::Push(Side::Drive); MAX_MESHES], self.time);
        for (mesh, constants) in self.system.meshes.iter().enumerate() {
            let (deflection, rate) = self.deflection(mesh);
            self.zones[mesh] = Zone::of(constants, self.system.law, deflection, rate, moment.stiffness_now(mesh));
        }
    }

    /// Deflection of a mesh over b_c, and its rate.
    pub fn deflection(&self, mesh: usize) -> (f64, f64) {
        deflection(self.system, &self.state, mesh, self.time)
    }
}

/// Deflection of a mesh over b_c and its rate, in a state at a time since the beginning of a period.
pub fn deflection(system: &System, state: &State, mesh: usize, time: f64) -> (f64, f64) {
    let planets = system.planets;
    let (error, error_rate) = system.transmission_error(mesh, time);
    let across = |values: &[f64; MAX_COORDINATES]| {
        if mesh < planets { values[mesh] } else { values[planets] - values[mesh - planets] }
    };
    (across(&state.position) - error, across(&state.rate) - error_rate)
}

/// Flank in contact at a deflection over b_c, by geometry alone.
pub fn contact(system: &System, mesh: usize, deflection: f64) -> ContactState {
    let half = system.meshes[mesh].half_backlash;
    if deflection > half {
        ContactState::DriveSide
    } else if deflection < -half {
        ContactState::BackSide
    } else {
        ContactState::Separated
    }
}

/// Greater magnitude; unlike with `max`, NaN is kept.
fn greater_magnitude(most: f64, value: &f64) -> f64 {
    if most.is_nan() || value.abs() <= most { most } else { value.abs() }
}

/// Falling guards and their time.
#[derive(Debug, Clone)]
struct Event {
    step: f64,
    falls: Vec<(usize, Guard)>,
}
