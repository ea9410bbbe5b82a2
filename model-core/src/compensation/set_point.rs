//! What the compensation is asked for and what it answers.

use crate::gears::Flank;
use crate::numbers::Real;

/// An angle over any number of turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Position<T: Real> {
    /// Whole turns.
    pub turns: i32,
    /// What is left [turns].
    pub fraction: T,
}

impl<T: Real> Position<T> {
    /// This less another angle [turns].
    pub fn less(&self, turns: i32, fraction: T) -> T {
        T::from_i64(i64::from(self.turns) - i64::from(turns)) + (self.fraction - fraction)
    }
}

/// Where the link shall be at one moment.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motion<T: Real> {
    /// On the scale of the observer's link shaft.
    pub position: Position<T>,
    /// [rad/s].
    pub speed: T,
    /// [rad/s^2].
    pub acceleration: T,
}

/// A spring and damper about a moving point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ImpedancePoint<T: Real> {
    /// On the scale of the observer's link shaft.
    pub position: Position<T>,
    /// [rad/s].
    pub speed: T,
    /// On top of spring and damper [N m].
    pub torque: T,
    /// [N m/rad].
    pub stiffness: T,
    /// [N m s/rad].
    pub damping: T,
}

/// What the compensation is asked for in one control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command<T: Real> {
    /// Follow a motion.
    Position {
        /// The motion now.
        now: Motion<T>,
        /// The motion at the tables' lead from now, if it is known.
        ahead: Option<Motion<T>>,
    },
    /// Be a spring and damper.
    Impedance(ImpedancePoint<T>),
}

/// What the compensation is about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Stage {
    /// A flank carries.
    #[default]
    Touching,
    /// On the way through the gap.
    Crossing,
    /// Closing on a flank at a small speed: past the end of the way, or because the flank was lost.
    Landing,
    /// Control without compensation: the gap cannot be seen.
    Plain,
}

/// What the compensation answers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Shaped<T: Real> {
    /// Torque for the motor [N m].
    pub torque: T,
    /// What it is about.
    pub stage: Stage,
    /// The flank that carries or is being gone to; `None` without a compensation.
    pub flank: Option<Flank>,
    /// Torque that the teeth will have to pass on after a crossing that began now [N m].
    pub demand: T,
    /// What brakes the link besides dry friction, and the dry friction, as learnt [N m].
    pub load: [T; 2],
    /// Share of the compensation in the torque, the rest being plain control: 0 to 1.
    pub trust: T,
}
