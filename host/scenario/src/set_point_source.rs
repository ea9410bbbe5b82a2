//! Set-points of a run: every control period, or held at the rate of an impedance.

use joint_file::sheet;
use reference::closed_loop::{Motion, SetPoint, SharedProfile};

use super::case::{Case, Designed};
use super::controller::{ControllerName, Gains};
use super::file::TestFile;

/// Source of a run's set-points.
pub struct SetPointSource {
    motion: SharedProfile,
    /// Preview time of the motion [s].
    lead: Option<f64>,
    /// Impedance, and feed-forward torque for each unit of acceleration [kg m^2].
    impedance: Option<(Gains, f64)>,
    held: Option<(u64, Motion)>,
}

impl SetPointSource {
    /// Set-points for one controller of a case.
    pub fn new(file: &TestFile, case: &Case, controller: ControllerName, designed: Option<&Designed>) -> Self {
        let preview = controller == ControllerName::Preview;
        let lead = designed.filter(|_| preview).map(|designed| f64::from(designed.compensation.crossing.lead));
        let gains = file.gains.filter(|_| controller.wants_gains() || controller == ControllerName::Off);
        let inertia = |gains: &Gains| gains.inertia.unwrap_or_else(|| sheet::inertia_at_link(&case.nominal));
        let impedance = gains.map(|gains| (gains, inertia(&gains)));
        Self { motion: case.motion.clone(), lead, impedance, held: None }
    }

    /// Positions of a motion without preview.
    pub fn of_positions(motion: SharedProfile) -> Self {
        Self { motion, lead: None, impedance: None, held: None }
    }

    /// Set-point of a period, and the number of its frame.
    pub fn at(&mut self, time: f64, index: u64) -> (u64, SetPoint) {
        let motion = &self.motion;
        let Some((gains, inertia)) = self.impedance else {
            let ahead = self.lead.map(|lead| motion.at(time + lead));
            return (index, SetPoint::Position { now: motion.at(time), ahead });
        };
        let number = (time * gains.rate + 1e-9) as u64;
        let about = match self.held {
            Some((sent, about)) if sent == number => about,
            _ => motion.at(time),
        };
        self.held = Some((number, about));
        let set_point = SetPoint::Impedance {
            about: Motion { acceleration: 0.0, ..about },
            torque: inertia * about.acceleration,
            stiffness: gains.stiffness,
            damping: gains.damping,
        };
        (number, set_point)
    }
}
