//! Faults of the teeth: grown backlash, and a tooth with a softer mesh.

use std::f64::consts::TAU;

use model_core::virtual_joint::fault::FaultKind;
use parameters::JointParameters;
use reference::joint::{Observation, mean_half_backlash};

use super::active::ActiveFault;
use crate::file::{Fault, HostOnlyFault, fault_is_active};
use crate::plant::{PlantName, Teeth};
use report::failure::{Failure, Outcome};

/// Rejects a broken tooth of a plant without teeth; `help` is the remedy for the core's plant.
pub fn check_broken_tooth(faults: &[Fault], joint: &JointParameters, plant: PlantName, help: &str) -> Outcome<()> {
    let is_broken = |fault: &Fault| matches!(fault.kind, FaultKind::Other(HostOnlyFault::BrokenTooth(_)));
    let (message, help) = match plant {
        _ if !faults.iter().any(is_broken) => return Ok(()),
        _ if joint.equivalent_gear().is_some() => (
            format!("joint `{}` is an equivalent gear, which has no tooth to break", joint.name),
            "leave the broken tooth out, or name a joint with teeth",
        ),
        PlantName::Core => ("the core's planets share their stiffness, so no tooth of it can break".to_owned(), help),
        PlantName::Reference => return Ok(()),
    };
    Err(Failure::new(message).with_help(help))
}

/// Original and current state of the teeth.
#[derive(Debug, Clone)]
pub(super) struct ToothState {
    half_backlash: f64,
    /// Current half-backlash [m].
    pub half_backlash_now: f64,
    stiffness: f64,
    /// Meshes of the broken tooth, by planet.
    pub soft: Vec<bool>,
    sun_teeth: f64,
}

impl ToothState {
    /// Original state of the teeth.
    pub fn new(joint: &JointParameters) -> Self {
        let half_backlash = mean_half_backlash(joint);
        Self {
            half_backlash,
            half_backlash_now: half_backlash,
            stiffness: joint.sun_planet.mean_stiffness,
            soft: vec![false; joint.geometry.planets],
            sun_teeth: f64::from(joint.geometry.sun_teeth),
        }
    }

    /// Sets the half-backlash without faults [m]; it acts from the next update on.
    pub fn set_half_backlash(&mut self, half_backlash: f64) {
        self.half_backlash = half_backlash;
    }

    /// Changes the teeth as faults begin, end, or come into mesh.
    pub fn update_teeth(&mut self, faults: &[ActiveFault], time: f64, joint: &Observation, inside: &mut dyn Teeth) {
        let (mut half_backlash, mut soft) = (self.half_backlash, 1.0);
        for active in faults.iter().filter(|active| fault_is_active(&active.fault, time)) {
            match active.fault.kind {
                FaultKind::Other(HostOnlyFault::GrownBacklash(grown)) => half_backlash = grown,
                FaultKind::Other(HostOnlyFault::BrokenTooth(ratio)) => soft = ratio,
                _ => {}
            }
        }
        if half_backlash != self.half_backlash_now {
            inside.set_half_backlash(half_backlash);
            self.half_backlash_now = half_backlash;
        }
        if soft == 1.0 && !self.soft.contains(&true) {
            return;
        }
        let planets = self.soft.len();
        let (sun_teeth, stiffness) = (self.sun_teeth, self.stiffness);
        for (planet, is_soft) in self.soft.iter_mut().enumerate() {
            // The broken tooth meets each planet once in a turn of the sun against the carrier, for one pitch.
            let angle = joint.motor_angle - joint.carrier_angle - TAU * planet as f64 / planets as f64;
            let meets = soft < 1.0 && angle.rem_euclid(TAU) < TAU / sun_teeth;
            if meets != *is_soft {
                *is_soft = meets;
                inside.set_sun_planet_stiffness(planet, stiffness * if meets { soft } else { 1.0 });
            }
        }
    }
}
