//! Wiring check of a log against the joint file: signs, counts, ratio, torque, rate and clock, by the core's own check
//! in f64.

use model_core::observer::Samples;
use model_core::observer::design::ObserverSettings;
use model_core::wiring::design::design_wiring;
use model_core::wiring::{WiringItem, WiringJudge, WiringVerdict};
use parameters::JointParameters;
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;
use serde::Serialize;

use crate::samples::ReplaySamples;

/// Verdict on an item of the wiring.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WiringFinding {
    /// Item, such as `output_direction`.
    pub item: String,
    /// `right`, `wrong`, `suspect` (it or another suspect is wrong) or `not_seen`.
    pub verdict: String,
    /// Value found instead: counts per turn, ratio, -1 for a direction, a factor for torque, rate and clock.
    pub found: Option<f64>,
    /// Remedy.
    pub help: Option<String>,
}

impl WiringFinding {
    /// Returns true if the log is rejected for this item. A torque scale depends on unknown loads, and a log without
    /// motion is not wrong.
    fn contradicts(&self) -> bool {
        let doubtful = [WiringItem::TorqueScale, WiringItem::Motion].map(WiringItem::name);
        self.verdict == "wrong" && !doubtful.contains(&self.item.as_str())
    }
}

/// Checks the wiring by the motion of a log.
pub fn check(
    joint: &JointParameters,
    settings: &ObserverSettings,
    samples: &ReplaySamples,
) -> Outcome<Vec<WiringFinding>> {
    let table = design_wiring::<f64>(joint, settings).map_err(|error| {
        Failure::new(format!("no wiring check can be designed for joint `{}`: {error}", joint.name))
    })?;
    let mut judge = WiringJudge::new(&table);
    for index in 0..samples.len() {
        let Samples { time, motor, output, torque } = samples.at(index);
        judge.step(&Samples { time, motor, output, torque: torque.into() });
    }
    let finding = |(item, verdict): (WiringItem, WiringVerdict<f64>)| {
        let (word, found) = match verdict {
            WiringVerdict::NotSeen => ("not_seen", None),
            WiringVerdict::Right => ("right", None),
            WiringVerdict::Wrong(found) => ("wrong", Some(found)),
            WiringVerdict::Suspect(found) => ("suspect", Some(found)),
        };
        let help = verdict.is_bad().then(|| item.help().to_owned());
        WiringFinding { item: item.name().to_owned(), verdict: word.to_owned(), found, help }
    };
    Ok(judge.wiring().iter().map(finding).collect())
}

/// Rejects a log whose wiring contradicts the joint file.
pub fn reject_contradictions(findings: &[WiringFinding]) -> Outcome<()> {
    let wrong: Vec<&WiringFinding> = findings.iter().filter(|finding| finding.contradicts()).collect();
    let Some(first) = wrong.first() else { return Ok(()) };
    let named: Vec<String> = wrong
        .iter()
        .map(|finding| format!("{} ({})", finding.item, ESTIMATE.write(finding.found.unwrap_or_default())))
        .collect();
    let message = format!("the wiring of this log is not that of the joint file: {}", named.join(", "));
    Err(Failure::new(message).with_help(first.help.clone().unwrap_or_default()))
}
