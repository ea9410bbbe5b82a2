//! Widest bandwidth of a joint's control, in equal words and figures for `joint check`, `joint budget`, `joint new` and
//! `joint hil`.

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
    /// Default bandwidth of the compensation.
    pub usual_rad_per_s: f64,
    /// Widest bandwidth; a wider one is rejected.
    pub widest_rad_per_s: f64,
    /// Reason for the widest bandwidth.
    pub limited_by: String,
}

impl Bandwidth {
    /// Bandwidth of a joint in its drive train; `None` if no compensation can be designed.
    pub fn for_joint(joint: &JointParameters, surroundings: &Surroundings) -> Option<Self> {
        let BandwidthRange { usual, widest, limit } = bandwidth_range(joint, surroundings).ok()?;
        let by_rate = || "control rate, and delays of torque and current loop".to_owned();
        Some(Self {
            control_rate_Hz: surroundings.control_rate,
            usual_rad_per_s: usual,
            widest_rad_per_s: widest,
            limited_by: limit.map_or_else(by_rate, |limit| limit.to_string()),
        })
    }

    /// Widest bandwidth with its reason.
    pub fn widest_in_words(&self) -> String {
        format!("{} rad/s: {}", self.widest_rad_per_s, self.limited_by)
    }

    /// Adds the rows to a sheet.
    pub fn rows(&self, page: &mut Sheet) {
        page.heading(&format!("Compensation at {} Hz", self.control_rate_Hz));
        page.row("bandwidth, if none is asked for", format!("{} rad/s", self.usual_rad_per_s));
        page.row("at most", self.widest_in_words());
    }
}
