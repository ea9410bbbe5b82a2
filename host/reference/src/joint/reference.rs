//! Reference joint with its state: start, advance under torques, and reduction to small coordinates.

use std::f64::consts::TAU;

use parameters::JointParameters;

use super::equations::JointEquations;
use super::start::{Start, resolve};
use super::validity::ReferenceError;
use crate::integrator::{Counters, Integrator, MAX_ENTRIES, SwitchedSystem};

/// Reference joint with its state.
///
/// Example: joint Q1 under 1 N m for 10 ms, in which its teeth reach their flank; the energy balance closes:
///
/// ```
/// use reference::joint::Reference;
///
/// let mut joint = Reference::new(&reference::scenarios::q1())?;
/// let begin = joint.observe();
/// joint.advance(10e-3, 1.0, 0.0)?;
/// let end = joint.observe();
/// assert!(end.motor_speed > 0.0 && joint.counters().events > 0, "teeth have touched");
/// let energy = |at: &reference::joint::Observation| at.kinetic_energy + at.elastic_energy;
/// let (grown, net) = (energy(&end) - energy(&begin), end.work.net() - begin.work.net());
/// assert!((grown - net).abs() < 1e-6 * end.work.supplied, "{grown} J grown, {net} J brought in");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Reference {
    pub(super) equations: JointEquations,
    pub(super) integrator: Integrator,
    /// Ring teeth passed by the carrier and taken off all coordinates.
    pub(super) teeth_passed: i64,
    /// Half-backlash of every mesh relative to its initial or last set value.
    pub(super) backlash_scale: f64,
}

impl Reference {
    /// Joint at time zero, all bodies at rest at angle zero.
    pub fn new(joint: &JointParameters) -> Result<Self, ReferenceError> {
        Self::start(joint, &Start::Still)
    }

    /// Joint at time zero.
    ///
    /// # Panics
    /// If a list in `start` has not one value for each planet.
    pub fn start(joint: &JointParameters, start: &Start) -> Result<Self, ReferenceError> {
        let mut equations = JointEquations::new(joint)?;
        let state = resolve(start, &equations);
        equations.select_mode(0.0, &state);
        Ok(Self { equations, integrator: Integrator::new(0.0, state), teeth_passed: 0, backlash_scale: 1.0 })
    }

    /// Present time [s].
    pub fn time(&self) -> f64 {
        self.integrator.time()
    }

    /// Advances to `time` [s] under constant torques: `drive_torque` on the sun, `load_torque` braking the link [N m].
    pub fn advance(&mut self, time: f64, drive_torque: f64, load_torque: f64) -> Result<(), ReferenceError> {
        self.equations.drive_force = drive_torque / self.equations.sun_lever;
        self.equations.load_force = load_torque / self.equations.carrier_lever;
        self.count_teeth();
        self.integrator.advance(&mut self.equations, time)?;
        Ok(())
    }

    /// Returns step and event counts of the run so far.
    pub fn counters(&self) -> Counters {
        self.integrator.counters()
    }

    /// Takes whole ring teeth off the coordinates; every deflection and every mesh phase stays. Coordinates stay within
    /// millimetres, so that deflections keep their digits at any number of turns.
    pub(super) fn count_teeth(&mut self) {
        let pitch = TAU / self.equations.ring_teeth * self.equations.carrier_lever;
        let bodies = self.equations.bodies();
        let state = self.integrator.state_mut();
        let teeth = (self.equations.rigid(&state[..bodies]) / pitch).round();
        if teeth != 0.0 && teeth.is_finite() {
            debug_assert!(bodies <= MAX_ENTRIES);
            for (body, position) in state[..bodies].iter_mut().enumerate() {
                *position -= JointEquations::rigid_share(body) * pitch * teeth;
            }
            self.teeth_passed += teeth as i64;
        }
    }
}
