//! Up to which bandwidth a joint can be controlled, in the same words and figures for `joint check`, `joint budget`, `joint
//! new` and `joint hil`.

use model_core::compensation::design::{BandwidthRange, bandwidth_range};
use parameters::{JointParameters, Surroundings};
use report::document::Sheet;
use serde::Serialize;

/// Bandwidth of the compensation: its three poles.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct Bandwidth {
    /// Control periods a second, from the joint file.
    pub control_rate_Hz: u32,
    /// Of a compensation whose user asks for none.
    pub usual_rad_per_s: f64,
    /// The widest; more is refused.
    pub widest_rad_per_s: f64,
    /// What sets the widest.
    pub limited_by: String,
}

impl Bandwidth {
    /// The bandwidth of a joint in its drive train; none of a joint that no compensation can be designed for.
    pub fn of(joint: &JointParameters, around: &Surroundings) -> Option<Self> {
        let BandwidthRange { usual, widest, limit } = bandwidth_range(joint, around).ok()?;
        let by_rate = || "control rate, and delays of torque and current loop".to_owned();
        Some(Self {
            control_rate_Hz: around.control_rate,
            usual_rad_per_s: usual,
            widest_rad_per_s: widest,
            limited_by: limit.map_or_else(by_rate, |limit| limit.to_string()),
        })
    }

    /// The widest, with what limits it.
    pub fn widest_in_words(&self) -> String {
        format!("{} rad/s: {}", self.widest_rad_per_s, self.limited_by)
    }

    /// The rows of a sheet.
    pub fn rows(&self, page: &mut Sheet) {
        page.heading(&format!("Compensation at {} Hz", self.control_rate_Hz));
        page.row("bandwidth, if none is asked for", format!("{} rad/s", self.usual_rad_per_s));
        page.row("at most", self.widest_in_words());
    }
}
