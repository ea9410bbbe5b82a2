//! Input and output of the compensation: set-points, commands, stages and the resulting torque.

use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Angle over any number of turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Position<T: Real = f32> {
    /// Whole turns.
    pub turns: i32,
    /// Remaining part of a turn [turns].
    pub fraction: T,
}
state_words! { struct Position<T> { turns, fraction } }

impl<T: Real> Position<T> {
    /// Difference to another angle, `self` minus the other [turns].
    pub fn difference(&self, turns: i32, fraction: T) -> T {
        T::from_i64(i64::from(self.turns) - i64::from(turns)) + (self.fraction - fraction)
    }
}

/// Set-point of the link at one moment. `repr(C)`: a C caller's struct is read in place.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Motion<T: Real = f32> {
    /// Position on the scale of the observer's link shaft.
    pub position: Position<T>,
    /// Speed [rad/s].
    pub speed: T,
    /// Acceleration [rad/s^2].
    pub acceleration: T,
}

/// Set-point of impedance mode: a spring and a damper about a moving point.
///
/// In this example 2 N m push against a spring of 100 N m/rad: the link gives way by 20 mrad, less the part that
/// friction holds.
///
/// ```
/// use model_core::{Command, Controller, ControllerDesign, ImpedancePoint, VirtualJointDesign};
///
/// let mut q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// q1.surroundings.gravity_torque = 0.0;
/// let design = ControllerDesign::new(&q1, 10_000)?;
/// let plant = VirtualJointDesign::<3>::new(&q1, 10_000)?;
/// let (mut joint, mut controller) = (plant.joint(), Controller::new(&design));
/// let spring = ImpedancePoint { stiffness: 100.0, damping: 4.0, ..ImpedancePoint::default() };
/// for _ in 0..10_000 {
///     let answer = controller.step(&joint.samples(), &Command::Impedance(spring));
///     joint.advance(answer.shaped.torque, 2.0);
/// }
/// let answer = controller.step(&joint.samples(), &Command::Impedance(spring));
/// let link = answer.estimates.link;
/// let given_way_rad = -6.28 * (link.turns as f32 + link.fraction);
/// assert!((0.013..0.024).contains(&given_way_rad), "{given_way_rad}");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct ImpedancePoint<T: Real = f32> {
    /// Position on the scale of the observer's link shaft.
    pub position: Position<T>,
    /// Speed [rad/s].
    pub speed: T,
    /// Torque added to spring and damper [N m].
    pub torque: T,
    /// Stiffness of the spring [N m/rad].
    pub stiffness: T,
    /// Damping [N m s/rad].
    pub damping: T,
}
state_words! { struct ImpedancePoint<T> { position, speed, torque, stiffness, damping } }

/// Command of one control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command<T: Real = f32> {
    /// Position mode: the link follows a motion.
    Position {
        /// Present motion.
        now: Motion<T>,
        /// Motion after [`CrossingTable::lead`](super::tables::CrossingTable::lead), if known.
        ahead: Option<Motion<T>>,
    },
    /// Impedance mode: the link behaves as a spring and damper.
    Impedance(ImpedancePoint<T>),
}

/// Borrowed [`Command`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CommandRef<'given, T: Real> {
    /// Position mode: the link follows a motion.
    Position {
        /// Present motion.
        now: &'given Motion<T>,
        /// Motion after [`CrossingTable::lead`](super::tables::CrossingTable::lead), if known.
        ahead: Option<&'given Motion<T>>,
    },
    /// Impedance mode: the link behaves as a spring and damper.
    Impedance(&'given ImpedancePoint<T>),
}

impl<T: Real> Command<T> {
    /// Holds angle zero of the observer's link shaft.
    pub const HOLD: Self = {
        let position = Position { turns: 0, fraction: T::ZERO };
        Self::Position { now: Motion { position, speed: T::ZERO, acceleration: T::ZERO }, ahead: None }
    };

    /// Borrows the command instead of copying the set-points.
    #[inline]
    pub fn by_reference(&self) -> CommandRef<'_, T> {
        match self {
            Self::Position { now, ahead } => CommandRef::Position { now, ahead: ahead.as_ref() },
            Self::Impedance(point) => CommandRef::Impedance(point),
        }
    }
}

/// State of the compensation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Stage {
    /// A flank carries the demand; or friction holds the link at its set-point, and the motor waits in the middle of
    /// the gap.
    #[default]
    Touching,
    /// The motor follows its path through the gap.
    Crossing,
    /// The motor approaches a flank at the landing speed, because the path has ended or the flank was lost.
    Landing,
    /// Control without compensation: the estimates of the gap are not valid, or the compensation has stepped back.
    Plain,
    /// No torque: the motor position is unknown.
    Off,
    /// No torque until observer and compensation are restarted: the motor accelerated against its torque, so that
    /// torque or motor encoder has the wrong sign.
    Reversed,
}
state_words! { enum Stage { Touching, Crossing, Landing, Plain, Off, Reversed } }

/// Output of the compensation in one control period. The numbers come first, so that they are copied in one block.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct ControlOutput<T: Real = f32> {
    /// Torque command of the motor [N m].
    pub torque: T,
    /// Torque through the teeth at the end of a crossing that begins now; zero under plain control [N m].
    pub demand: T,
    /// Estimated load torque: gravity torque, dry friction [N m].
    pub load: [T; 2],
    /// Share of the compensation in the torque, 0 to 1; plain control has the rest.
    pub trust: T,
    /// State of the compensation.
    pub stage: Stage,
    /// Flank that carries or is approached; `None` in the stages `Off` and `Reversed`.
    pub flank: Option<Flank>,
    /// True while plain control acts because the loop hunted.
    pub stepped_back: bool,
    /// True if the torque was cut off at the motor's limit, or if the link is braked early because of that limit: the
    /// link does not follow its set-point.
    pub short_of_torque: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difference_counts_whole_turns() {
        let position = Position { turns: -2, fraction: 0.25 };
        assert_eq!(position.difference(3, 0.5), -5.25);
    }

    #[test]
    fn difference_at_the_ends_of_the_turns_does_not_overflow() {
        assert_eq!(Position { turns: i32::MAX, fraction: 0.0 }.difference(i32::MIN, 0.0), 4_294_967_295.0);
    }
}
