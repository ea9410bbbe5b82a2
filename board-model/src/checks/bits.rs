//! Steps of the board against the host's twin, through a host session over the modelled line.

use std::time::Duration;

use board::device::image::DEFAULT_TICK_RATE;
use board::profile::TorqueProfile;
use board::session::{BoardHelp, Session};
use board::twin;
use link::messages::{RunMode, RunSettings};

use super::clean;
use crate::boards::Subject;
use crate::images::JOINT;
use crate::talk::{Talk, Unattended};

/// Duration of the motion: 20,000 steps [s].
const LENGTH: f64 = 1.0;
/// Steps between two samples; the digest in a sample covers every step.
const DECIMATION: u16 = 20;

/// Drives the joint through its reversals in lockstep, and compares every sample.
pub fn steps(subject: &Subject) -> Result<String, String> {
    let talk = Talk::new(subject.start()?);
    let joint = joint_file::preset(JOINT).and_then(|text| joint_file::read(text).ok()).ok_or("no preset")?.parameters;
    let words = |failure: report::failure::Failure| failure.to_string();
    let profile = TorqueProfile::load("reversals", &joint, DEFAULT_TICK_RATE, Some(LENGTH)).map_err(words)?;
    let mut session = Session::new(Box::new(talk.line()), Box::new(Unattended));
    let settings =
        RunSettings { mode: RunMode::Lockstep, decimation: DECIMATION, command_timeout: u32::MAX, from_memory: false };
    let run = session
        .wait_for_hello(&BoardHelp::Rebuild, Duration::from_secs(20))
        .and_then(|_| session.reset(settings))
        .and_then(|()| session.stream(&profile, &mut |_| {}))
        .and_then(|()| session.finish(profile.ticks));
    clean(&talk.board.borrow())?;
    run.map_err(words)?;
    let recording = &session.recording;
    let agreement =
        twin::compare(&joint, subject.board.chip(), DEFAULT_TICK_RATE, &recording.accepted, &recording.samples)
            .map_err(words)?;
    if agreement.steps < profile.ticks || agreement.different > 0 {
        return Err(format!("{} of {} steps agree: {:?}", agreement.steps, profile.ticks, agreement.first));
    }
    let lost = talk.board.borrow().machine().wires.line.overruns;
    if lost > 0 {
        return Err(format!("{lost} bytes were lost in the USART"));
    }
    Ok(format!("{} steps, {} samples", agreement.steps, agreement.samples))
}
