//! Wire form of the outputs of a control period: the compensation's outputs, and all estimates if requested. Every
//! field is SI.

use model_core::compensation::{ControlOutput, Stage};
use model_core::controller::Answer;
use model_core::gears::{Flank, sign};
use model_core::observer::{Estimate, Estimates, MotorFault, Notices, OutputFault, Shaft, Source, TorqueResponse};
use model_core::width_probe::{ProbeProgress, ProbeRefusal};
use parameters::ContactState;
use serde::{Deserialize, Serialize};

/// Outputs of a control period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answered {
    /// Completed control periods.
    pub tick: u32,
    /// Running digest over every answer so far.
    pub digest: u64,
    /// Compensation outputs: motor torque, stage and diagnostics.
    pub shaped: WireShaped,
    /// All estimates, if requested.
    pub estimates: Option<WireEstimates>,
    /// Progress of the width probe, in a period of a probe.
    pub probed: Option<WireProbed>,
    /// Computation time of this period [timer counts].
    pub computation: u16,
}

/// Progress of a width probe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum WireProbed {
    /// The probe is running.
    Running,
    /// Measured half-backlash [m].
    Done(WireEstimate),
    /// Reason for a refusal: 0 motor not at rest, 1 loaded, 2 link not held, 3 stuck, 4 unsteady, 5 bad samples.
    Refused(u8),
}

impl From<ProbeProgress<f32>> for WireProbed {
    fn from(progress: ProbeProgress<f32>) -> Self {
        match progress {
            ProbeProgress::Running => Self::Running,
            ProbeProgress::Done(width) => Self::Done(estimate(width)),
            ProbeProgress::Refused(refusal) => Self::Refused(refusal as u8),
        }
    }
}

impl From<WireProbed> for ProbeProgress<f32> {
    fn from(wire: WireProbed) -> Self {
        match wire {
            WireProbed::Running => Self::Running,
            WireProbed::Done(width) => Self::Done(estimated(width)),
            WireProbed::Refused(refusal) => Self::Refused(match refusal {
                0 => ProbeRefusal::NotAtRest,
                1 => ProbeRefusal::Loaded,
                2 => ProbeRefusal::NotHeld,
                3 => ProbeRefusal::Stuck,
                4 => ProbeRefusal::Unsteady,
                _ => ProbeRefusal::BadSamples,
            }),
        }
    }
}

/// Outputs of the compensation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WireShaped {
    /// Motor torque [N m].
    pub torque: f32,
    /// Stage: 0 touching, 1 crossing, 2 landing, 3 plain, 4 off, 5 reversed.
    pub stage: u8,
    /// Flank in use: 1 drive flank, -1 back flank, 0 none.
    pub side: f32,
    /// Demanded torque through the teeth [N m].
    pub demand: f32,
    /// Load torque without dry friction, and dry friction [N m].
    pub load: [f32; 2],
    /// Share of the compensation in the torque, 0 to 1.
    pub trust: f32,
    /// The law demands more torque than the limit, or brakes early because of the limit.
    pub short_of_torque: bool,
    /// The loop hunted and is left to plain control for a while.
    pub stepped_back: bool,
}

/// Value, variance, validity.
pub type WireEstimate = (f32, f32, bool);

/// Estimates of the observer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WireEstimates {
    /// Source of the estimates: 0 both encoders; motor only, because the output encoder is 1 absent, 2 silent, 3
    /// frozen, 4 out of range, 9 without a first reading; none, because the motor encoder is 5 silent, 6 late, 7
    /// frozen, 8 jumped.
    pub source: u8,
    /// Flags from bit 0 on: torque unknown, out of time, motor implausible, motor jumped, contact valid, settled,
    /// torque or motor encoder reversed.
    pub flags: u8,
    /// Contact by force and reported contact: 0 separated, 1 drive side, 2 back side.
    pub contacts: (u8, u8),
    /// Gap coordinate [m].
    pub gap: WireEstimate,
    /// Rate of the gap coordinate [m/s], shift of both flanks [m], slope of the shift [m/rad].
    pub gap_course: [f32; 3],
    /// Mesh torque, load torque [N m], half-backlash [m], encoder offset [rad], compliance [rad/(N m)], skew [s],
    /// torque bias, motor friction [N m], ratio of the link inertia to the designed one.
    pub others: [WireEstimate; 9],
    /// Motor and link: whole turns, fraction, speed [rad/s].
    pub shafts: [(i32, f32, f32); 2],
}

impl From<&ControlOutput<f32>> for WireShaped {
    fn from(shaped: &ControlOutput<f32>) -> Self {
        let ControlOutput { torque, stage, flank, demand, load, trust, short_of_torque, stepped_back } = *shaped;
        Self { torque, stage: stage as u8, side: sign(flank), demand, load, trust, short_of_torque, stepped_back }
    }
}

impl From<WireShaped> for ControlOutput<f32> {
    fn from(wire: WireShaped) -> Self {
        let WireShaped { torque, stage, side, demand, load, trust, short_of_torque, stepped_back } = wire;
        let stage = match stage {
            0 => Stage::Touching,
            1 => Stage::Crossing,
            2 => Stage::Landing,
            3 => Stage::Plain,
            5 => Stage::Reversed,
            _ => Stage::Off,
        };
        Self { torque, stage, flank: Flank::towards(side), demand, load, trust, short_of_torque, stepped_back }
    }
}

fn estimate(of: Estimate<f32>) -> WireEstimate {
    (of.value, of.variance, of.valid)
}

fn estimated((value, variance, valid): WireEstimate) -> Estimate<f32> {
    Estimate { value, variance, valid }
}

fn contact(of: ContactState) -> u8 {
    match of {
        ContactState::Separated => 0,
        ContactState::DriveSide => 1,
        ContactState::BackSide => 2,
    }
}

fn contacted(of: u8) -> ContactState {
    match of {
        1 => ContactState::DriveSide,
        2 => ContactState::BackSide,
        _ => ContactState::Separated,
    }
}

impl From<&Estimates<f32>> for WireEstimates {
    fn from(of: &Estimates<f32>) -> Self {
        let notices = &of.notices;
        let flags = [
            notices.torque_unknown,
            notices.out_of_time,
            notices.motor_implausible,
            notices.motor_jumped,
            of.contact_valid,
            of.settled,
            of.torque_response == TorqueResponse::Reversed,
        ];
        let shaft = |shaft: Shaft<f32>| (shaft.turns, shaft.fraction, shaft.speed);
        Self {
            source: match of.source {
                Source::Both => 0,
                Source::MotorOnly(OutputFault::Absent) => 1,
                Source::MotorOnly(OutputFault::Silent) => 2,
                Source::MotorOnly(OutputFault::Frozen) => 3,
                Source::MotorOnly(OutputFault::OutOfRange) => 4,
                Source::Nothing(MotorFault::Silent) => 5,
                Source::Nothing(MotorFault::Late) => 6,
                Source::Nothing(MotorFault::Frozen) => 7,
                Source::Nothing(MotorFault::Jumped) => 8,
                Source::MotorOnly(OutputFault::Unheard) => 9,
            },
            flags: flags.iter().rev().fold(0, |bits, flag| bits << 1 | u8::from(*flag)),
            contacts: (contact(of.contact), contact(of.reported_contact)),
            gap: estimate(of.gap),
            gap_course: [of.gap_rate, of.flank_shift, of.flank_shift_slope],
            others: [
                of.mesh_torque,
                of.load_torque,
                of.half_backlash,
                of.encoder_offset,
                of.compliance,
                of.skew,
                of.torque_bias,
                of.motor_friction,
                of.link_inertia_ratio,
            ]
            .map(estimate),
            shafts: [of.motor, of.link].map(shaft),
        }
    }
}

impl From<WireEstimates> for Estimates<f32> {
    fn from(wire: WireEstimates) -> Self {
        let flag = |bit: u8| wire.flags >> bit & 1 == 1;
        let shaft = |(turns, fraction, speed)| Shaft { turns, fraction, speed };
        let [mesh_torque, load_torque, half_backlash, encoder_offset, compliance, skew, rest @ ..] =
            wire.others.map(estimated);
        let [torque_bias, motor_friction, link_inertia_ratio] = rest;
        let [motor, link] = wire.shafts.map(shaft);
        let [gap_rate, flank_shift, flank_shift_slope] = wire.gap_course;
        Self {
            source: match wire.source {
                0 => Source::Both,
                1 => Source::MotorOnly(OutputFault::Absent),
                2 => Source::MotorOnly(OutputFault::Silent),
                3 => Source::MotorOnly(OutputFault::Frozen),
                4 => Source::MotorOnly(OutputFault::OutOfRange),
                6 => Source::Nothing(MotorFault::Late),
                7 => Source::Nothing(MotorFault::Frozen),
                8 => Source::Nothing(MotorFault::Jumped),
                9 => Source::MotorOnly(OutputFault::Unheard),
                _ => Source::Nothing(MotorFault::Silent),
            },
            notices: Notices {
                torque_unknown: flag(0),
                out_of_time: flag(1),
                motor_implausible: flag(2),
                motor_jumped: flag(3),
            },
            gap: estimated(wire.gap),
            gap_rate,
            flank_shift,
            flank_shift_slope,
            contact: contacted(wire.contacts.0),
            reported_contact: contacted(wire.contacts.1),
            contact_valid: flag(4),
            settled: flag(5),
            torque_response: if flag(6) { TorqueResponse::Reversed } else { TorqueResponse::Unknown },
            mesh_torque,
            load_torque,
            half_backlash,
            encoder_offset,
            compliance,
            skew,
            torque_bias,
            motor_friction,
            // Used by the compensation on the board only; not sent.
            cogging: [0.0; 2],
            half_backlash_usable: false,
            motor_lead: 0.0,
            link_inertia_ratio,
            motor,
            link,
        }
    }
}

impl Answered {
    /// Returns the answer, if it contains the estimates.
    pub fn answer(&self) -> Option<Answer<f32>> {
        let probed = self.probed.map(ProbeProgress::from);
        Some(Answer { estimates: self.estimates?.into(), shaped: self.shaped.into(), probed })
    }
}
