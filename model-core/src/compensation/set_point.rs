//! What the compensation is asked for and what it answers.

use crate::gears::Flank;
use crate::numbers::Real;

/// An angle over any number of turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
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

/// Where the link shall be at one moment. It lies in memory as a C program has it, which is read from where it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Motion<T: Real> {
    /// On the scale of the observer's link shaft.
    pub position: Position<T>,
    /// [rad/s].
    pub speed: T,
    /// [rad/s^2].
    pub acceleration: T,
}

/// A spring and damper about a moving point.
///
/// A spring of 100 N m/rad, and somebody who leans on the link with 2 N m: it gives way by 20 mrad, less what friction
/// holds.
///
/// ```
/// use model_core::compensation::design::{compensation_settings, design_compensation};
/// use model_core::compensation::{Command, ImpedancePoint};
/// use model_core::controller::Controller;
/// use model_core::gears::{Tables, design::design};
/// use model_core::observer::design::{design_observer, observer_settings};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
///
/// let mut q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// q1.surroundings.gravity_torque = 0.0;
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let observer = design_observer(&q1.parameters, &observer_settings(&q1.surroundings))?;
/// let compensation = design_compensation(&q1.parameters, &compensation_settings(&q1.surroundings, 60.0))?;
/// let (mut joint, mut controller) = (VirtualJoint::new(&gears, &around), Controller::new(&observer, &compensation));
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

/// The same where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CommandRef<'given, T: Real> {
    /// Follow a motion.
    Position {
        /// The motion now.
        now: &'given Motion<T>,
        /// The motion at the tables' lead from now, if it is known.
        ahead: Option<&'given Motion<T>>,
    },
    /// Be a spring and damper.
    Impedance(&'given ImpedancePoint<T>),
}

impl<T: Real> Command<T> {
    /// What it is, without a copy.
    #[inline]
    pub fn by_reference(&self) -> CommandRef<'_, T> {
        match self {
            Self::Position { now, ahead } => CommandRef::Position { now, ahead: ahead.as_ref() },
            Self::Impedance(point) => CommandRef::Impedance(point),
        }
    }
}

/// What the compensation is about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Stage {
    /// A flank carries, or the joint needs none and the motor rests in the middle of the gap.
    #[default]
    Touching,
    /// On the way through the gap.
    Crossing,
    /// Closing on a flank at a small speed: past the end of the way, or because the flank was lost.
    Landing,
    /// Control without compensation: the gap cannot be seen.
    Plain,
    /// No torque: it is not known where the motor is.
    Off,
    /// No torque until observer and compensation are started anew: the motor ran against its torque, so torque or motor encoder has
    /// the wrong sign.
    Reversed,
}

/// What the compensation answers. The numbers lie first, so that they are copied in one go.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Shaped<T: Real> {
    /// Torque for the motor [N m].
    pub torque: T,
    /// Torque that the teeth will have to pass on after a crossing that began now [N m].
    pub demand: T,
    /// What brakes the link besides dry friction, and the dry friction, as learnt [N m].
    pub load: [T; 2],
    /// Share of the compensation in the torque, the rest being plain control: 0 to 1.
    pub trust: T,
    /// What it is about.
    pub stage: Stage,
    /// The flank that carries or is being gone to; `None` without a compensation.
    pub flank: Option<Flank>,
    /// The loop hunted: the motor alone is controlled for a while.
    pub stepped_back: bool,
    /// The law asked for more torque than the motor has, or brakes early because of that: the link does not keep to what it
    /// is asked for.
    pub short_of_torque: bool,
}
