//! Verdicts of the wiring check for each item, with the item's name and the remedy.

use core::fmt;

use crate::numbers::Real;

/// Item of a joint's wiring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum WiringItem {
    /// Each control period gives its samples once. Found: calls per sample.
    Calls = 0,
    /// The control rate equals the tables' rate. Found: control period over the tables' period.
    Period = 1,
    /// The clock of the samples ticks at the tables' rate. Found: tick rate over the tables' rate.
    Clock = 2,
    /// The motor's readings carry times of the samples' clock. Found: 0.
    MotorTime = 3,
    /// The motor moved. Found: torque expected to move the motor [N m].
    Motion = 4,
    /// Counts per turn of the motor encoder. Found: their number; 0 for counts that stand still.
    MotorCounts = 5,
    /// Counts per turn of the output encoder. Found: their number; 0 for counts that stand still.
    OutputCounts = 6,
    /// Motor and output encoder are not exchanged. Found: 0.
    Places = 7,
    /// Gear ratio. Found: motor turns per output turn.
    Ratio = 8,
    /// The motor encoder counts up in the direction of a positive torque. Found: -1.
    MotorDirection = 9,
    /// The output encoder counts up while the motor encoder counts up. Found: -1.
    OutputDirection = 10,
    /// A positive torque drives in the direction in which both encoders count up. Found: -1.
    TorqueDirection = 11,
    /// Acting torque over commanded torque. Found: this factor.
    TorqueScale = 12,
}

/// Number of items.
pub const WIRING_ITEMS: usize = 13;

impl WiringItem {
    /// All items, each at the index of its number.
    pub const ALL: [Self; WIRING_ITEMS] = [
        Self::Calls,
        Self::Period,
        Self::Clock,
        Self::MotorTime,
        Self::Motion,
        Self::MotorCounts,
        Self::OutputCounts,
        Self::Places,
        Self::Ratio,
        Self::MotorDirection,
        Self::OutputDirection,
        Self::TorqueDirection,
        Self::TorqueScale,
    ];

    /// Name of the item, for example `output_direction`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calls => "calls",
            Self::Period => "period",
            Self::Clock => "clock",
            Self::MotorTime => "motor_time",
            Self::Motion => "motion",
            Self::MotorCounts => "motor_counts",
            Self::OutputCounts => "output_counts",
            Self::Places => "places",
            Self::Ratio => "ratio",
            Self::MotorDirection => "motor_direction",
            Self::OutputDirection => "output_direction",
            Self::TorqueDirection => "torque_direction",
            Self::TorqueScale => "torque_scale",
        }
    }

    /// Returns true if only a joint with an output encoder shows the item.
    pub const fn needs_output(self) -> bool {
        matches!(self, Self::OutputCounts | Self::MotorCounts | Self::Places | Self::Ratio | Self::OutputDirection)
    }

    /// Fault and remedy in one sentence.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Calls => "samples come more than once: call the step once a control period",
            Self::Period => {
                "the control rate is not that of the tables: call at control_rate_Hz, or make tables for this rate"
            }
            Self::Clock => {
                "the clock of the samples has another tick rate than the tables: give ticks of clock_rate_Hz"
            }
            Self::MotorTime => {
                "the times of the motor's readings stand still or are of another clock: give the time of the latch"
            }
            Self::Motion => {
                "nothing moved: enable the drive, release the brake, or allow the torque that is expected to move the joint"
            }
            Self::MotorCounts => {
                "the motor encoder has another number of counts in a turn than the tables, or stands still"
            }
            Self::OutputCounts => {
                "the output encoder has another number of counts in a turn than the tables, or stands still"
            }
            Self::Places => "motor and output encoder are exchanged",
            Self::Ratio => "the gear ratio is not that of the tables: these are tables of another joint",
            Self::MotorDirection => {
                "the motor encoder counts down under a positive torque: give the range less the counts"
            }
            Self::OutputDirection => {
                "the output encoder counts against the motor encoder: give the range less the counts"
            }
            Self::TorqueDirection => {
                "a positive torque drives backwards: change the sign of the current, or exchange two phases"
            }
            Self::TorqueScale => {
                "the torque that acts is not the commanded one: check torque constant, unit, and the link's inertia"
            }
        }
    }
}

/// Verdict on one item.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum WiringVerdict<T: Real> {
    /// The samples do not show the item.
    #[default]
    NotSeen,
    /// The item agrees with the tables.
    Right,
    /// The item differs from the tables; the value found.
    Wrong(T),
    /// Either this item or another suspect is wrong, and the samples do not show which; the value found if it is this
    /// item.
    Suspect(T),
}

impl<T: Real> WiringVerdict<T> {
    /// Returns true if the item is wrong or suspect.
    pub fn is_bad(self) -> bool {
        matches!(self, Self::Wrong(_) | Self::Suspect(_))
    }
}

/// Verdicts on all items.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Wiring<T: Real> {
    pub(super) verdicts: [WiringVerdict<T>; WIRING_ITEMS],
    pub(super) has_output: bool,
}

impl<T: Real> Wiring<T> {
    /// Verdict on an item.
    pub fn verdict(&self, item: WiringItem) -> WiringVerdict<T> {
        self.verdicts.get(item as usize).copied().unwrap_or_default()
    }

    /// Items with their verdicts.
    pub fn iter(&self) -> impl Iterator<Item = (WiringItem, WiringVerdict<T>)> + '_ {
        WiringItem::ALL.into_iter().zip(self.verdicts)
    }

    /// Returns true if every item was seen and is right. Without an output encoder the items that need one are ignored.
    pub fn is_all_right(&self) -> bool {
        self.iter().all(|(item, verdict)| verdict == WiringVerdict::Right || (!self.has_output && item.needs_output()))
    }

    /// Returns true if no item is wrong or suspect.
    pub fn is_right(&self) -> bool {
        !self.verdicts.iter().any(|verdict| verdict.is_bad())
    }

    pub(super) fn set(&mut self, item: WiringItem, verdict: WiringVerdict<T>) {
        if let Some(place) = self.verdicts.get_mut(item as usize) {
            *place = verdict;
        }
    }
}

impl<T: Real> fmt::Display for Wiring<T> {
    /// Prints one line per item: name, verdict, value found, and remedy.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (item, verdict) in self.iter() {
            let name = item.name();
            match verdict {
                WiringVerdict::Right => writeln!(out, "{name}: right")?,
                WiringVerdict::NotSeen => writeln!(out, "{name}: not seen")?,
                WiringVerdict::Wrong(found) => writeln!(out, "{name}: WRONG, found {found:?}: {}", item.help())?,
                WiringVerdict::Suspect(found) => writeln!(out, "{name}: SUSPECT, perhaps {found:?}: {}", item.help())?,
            }
        }
        Ok(())
    }
}
