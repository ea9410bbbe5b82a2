//! The controllers of a test by name: the compensation or a rival. While they run they are `rig::ActiveController`s.

/// A controller by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ControllerName {
    /// Observer and compensation, told set-points ahead of time.
    Preview,
    /// Observer and compensation, told the present only.
    NoPreview,
    /// Observer and compensation with impedance set-points.
    Impedance,
    /// The width probe of the observer: the load is held.
    Probe,
    /// PID on the motor: position control without compensation.
    MotorPid,
    /// The same PID where it is the motor that is held, and the link that is pushed.
    Locked,
    /// The PID with an offset by the sign of the speed.
    VelocitySign,
    /// Output position over motor speed.
    LoadCascade,
    /// Motor PID with jump, feed-forward and an integral over the output: the best rival in position.
    OutputIntegral,
    /// Spring and damper at the motor: impedance without compensation.
    MotorSide,
    /// Spring at the link, damper at the motor: the best rival in impedance.
    LinkSpring,
    /// Both at the link.
    LinkSide,
    /// No torque at all.
    Off,
    /// The compensation on the truth: no file names it.
    TrueStateCompensation,
}

/// An impedance, and the rate of its set-points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// [N m/rad].
    pub stiffness: f64,
    /// [N m s/rad].
    pub damping: f64,
    /// [Hz].
    pub rate: f64,
    /// Torque sent along for each unit of the motion's acceleration [kg m^2]; by default the joint's inertia.
    pub inertia: Option<f64>,
}

impl Default for Gains {
    fn default() -> Self {
        Self { stiffness: 100.0, damping: 3.0, rate: 1000.0, inertia: None }
    }
}

impl ControllerName {
    /// All that a file may name.
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

    /// From its word in a file; `none` stands for the baseline, and `locked` too where that is an impedance.
    pub fn of_word(word: &str, impedance: bool) -> Self {
        if word == Self::Locked.word() && !impedance {
            return Self::Locked;
        }
        let found = Self::ALL.into_iter().find(|name| name.word() == word);
        found.unwrap_or(Self::baseline(impedance))
    }

    /// Its word, and its name in reports.
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

    /// Its word.
    pub fn word(self) -> &'static str {
        self.names().0
    }

    /// Its name in reports.
    pub fn label(self) -> &'static str {
        self.names().1
    }

    /// Observer and compensation.
    pub fn is_compensation(self) -> bool {
        matches!(self, Self::Preview | Self::NoPreview | Self::Impedance | Self::Probe)
    }

    /// Follows impedance set-points.
    pub fn wants_gains(self) -> bool {
        matches!(self, Self::Impedance | Self::MotorSide | Self::LinkSpring | Self::LinkSide)
    }

    /// The same kind of test without compensation.
    pub fn baseline(impedance: bool) -> Self {
        if impedance { Self::MotorSide } else { Self::MotorPid }
    }

    /// The strongest controller without compensation.
    pub fn best_rival(impedance: bool) -> Self {
        if impedance { Self::LinkSpring } else { Self::OutputIntegral }
    }

    /// Whether two are one law under two names.
    pub fn is_the_same_as(self, other: Self) -> bool {
        let law = |name| if name == Self::Locked { Self::MotorPid } else { name };
        law(self) == law(other)
    }

    /// The controller that gives the same impedance on a joint without a gap, from which the deviation is measured.
    pub fn without_gap(self) -> Self {
        if self.is_compensation() { Self::LinkSpring } else { self }
    }
}
