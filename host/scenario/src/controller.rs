//! Names of the controllers of a test: the compensation and the rivals it is compared with. `rig::ActiveController` is
//! a running controller.

/// A controller by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ControllerName {
    /// Observer and compensation with set-points ahead of time.
    Preview,
    /// Observer and compensation with present set-points only.
    NoPreview,
    /// Observer and compensation with impedance set-points.
    Impedance,
    /// Width probe of the observer, with the load held.
    Probe,
    /// PID on the motor: position control without compensation.
    MotorPid,
    /// Motor PID that holds the motor while the link is pushed.
    Locked,
    /// Motor PID with a torque offset by the sign of the speed.
    VelocitySign,
    /// Output position loop over motor speed loop.
    LoadCascade,
    /// Motor PID with jump, feed-forward and an integral over the output: the best rival in position.
    OutputIntegral,
    /// Spring and damper at the motor: impedance without compensation.
    MotorSide,
    /// Spring at the link, damper at the motor: the best rival in impedance.
    LinkSpring,
    /// Spring and damper at the link.
    LinkSide,
    /// No torque.
    Off,
    /// Compensation fed with the true state; no file names it.
    TrueStateCompensation,
}

/// An impedance, and the rate of its set-points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// Stiffness [N m/rad].
    pub stiffness: f64,
    /// Damping [N m s/rad].
    pub damping: f64,
    /// Rate of the set-points [Hz].
    pub rate: f64,
    /// Feed-forward torque for each unit of the motion's acceleration [kg m^2]; by default the joint's inertia.
    pub inertia: Option<f64>,
}

impl Default for Gains {
    fn default() -> Self {
        Self { stiffness: 100.0, damping: 3.0, rate: 1000.0, inertia: None }
    }
}

impl ControllerName {
    /// Controllers that a file may name.
    pub const ALL: [Self; 12] = [
        Self::Preview,
        Self::NoPreview,
        Self::Impedance,
        Self::Probe,
        Self::MotorPid,
        Self::VelocitySign,
        Self::LoadCascade,
        Self::OutputIntegral,
        Self::MotorSide,
        Self::LinkSpring,
        Self::LinkSide,
        Self::Off,
    ];

    /// Controller by its word in a file. `none` is the baseline, and so is `locked` in an impedance test.
    pub fn from_word(word: &str, impedance: bool) -> Self {
        if word == Self::Locked.word() && !impedance {
            return Self::Locked;
        }
        let found = Self::ALL.into_iter().find(|name| name.word() == word);
        found.unwrap_or(Self::baseline(impedance))
    }

    /// Word in files, and name in reports.
    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Preview => ("preview", "compensation, preview"),
            Self::NoPreview => ("no_preview", "compensation, no preview"),
            Self::Impedance => ("impedance", "compensation, impedance"),
            Self::Probe => ("probe", "width probe"),
            Self::MotorPid => ("motor_pid", "motor PID"),
            Self::Locked => ("locked", "motor held by its PID"),
            Self::VelocitySign => ("velocity_sign", "velocity-sign offset"),
            Self::LoadCascade => ("load_cascade", "load cascade"),
            Self::OutputIntegral => ("output_integral", "output integral and jump"),
            Self::MotorSide => ("motor_side", "motor-side impedance"),
            Self::LinkSpring => ("link_spring", "link spring, motor damper"),
            Self::LinkSide => ("link_side", "link-side impedance"),
            Self::Off => ("off", "no torque"),
            Self::TrueStateCompensation => ("perfect_sight", "compensation on the truth"),
        }
    }

    /// Word in files.
    pub fn word(self) -> &'static str {
        self.names().0
    }

    /// Name in reports.
    pub fn label(self) -> &'static str {
        self.names().1
    }

    /// Returns true for observer and compensation.
    pub fn is_compensation(self) -> bool {
        matches!(self, Self::Preview | Self::NoPreview | Self::Impedance | Self::Probe)
    }

    /// Returns true if the controller takes impedance set-points.
    pub fn wants_gains(self) -> bool {
        matches!(self, Self::Impedance | Self::MotorSide | Self::LinkSpring | Self::LinkSide)
    }

    /// Baseline without compensation for this kind of test.
    pub fn baseline(impedance: bool) -> Self {
        if impedance { Self::MotorSide } else { Self::MotorPid }
    }

    /// Strongest controller without compensation.
    pub fn best_rival(impedance: bool) -> Self {
        if impedance { Self::LinkSpring } else { Self::OutputIntegral }
    }

    /// Returns true if both names stand for one control law.
    pub fn has_same_law(self, other: Self) -> bool {
        let law = |name| if name == Self::Locked { Self::MotorPid } else { name };
        law(self) == law(other)
    }

    /// Controller that gives the undisturbed impedance on a joint without backlash; the deviation is measured from its
    /// run.
    pub fn without_gap(self) -> Self {
        if self.is_compensation() { Self::LinkSpring } else { self }
    }
}
