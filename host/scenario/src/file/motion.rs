//! Reads `[profile]` and `[[disturbance]]`: motion of the link and torques on it. Standard motions scale with the
//! joint's rated torque, so that any joint can run them.

use toml::Spanned;

use super::keys::REAL_MOTIONS;
use super::section::Section;

/// A reference motion with its load.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionProfile {
    /// Kind, as in the file.
    pub kind: &'static str,
    /// Desired position of the link over time.
    pub trajectory: Trajectory,
    /// Load on the link.
    pub load: ProfileLoad,
    /// Dry friction of the link over the rated output torque [-]; replaces the friction in the joint file.
    pub friction: Option<f64>,
    /// Gravity torque of the link over the rated output torque [-]; replaces the gravity torque in the joint file.
    pub gravity: Option<f64>,
    /// Default length of a run [s].
    pub duration: f64,
    /// Default time for the estimation of parameters [s].
    pub settle: f64,
}

/// Desired position of the link over time.
#[derive(Debug, Clone, PartialEq)]
pub enum Trajectory {
    /// Amplitude [rad] and frequency [Hz] of a sine.
    Sine(f64, f64),
    /// Standard deviation [rad] and highest frequency [Hz].
    Random(f64, f64),
    /// Height [rad], duration [s] and shortest rest [s].
    Steps(f64, f64, f64),
    /// Amplitude [rad] and steps a second [Hz] of a leg's joint.
    Walking(f64, f64),
    /// Constant angle [rad].
    Hold(f64),
    /// Path of a CSV file.
    File(String),
    /// Random motion and load for each seed, within the motor's torque.
    Any,
    /// A motion of real joints: the stated one, or one for each seed.
    Real(Option<RealMotion>),
}

/// Motion of a robot's joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RealMotion {
    /// Sine of 1 Hz.
    Sine,
    /// Five sines up to 2 Hz.
    Random,
    /// Moves back and forth on least-jerk paths.
    Moves,
    /// Sine of 0.15 Hz.
    SlowSine,
    /// Hold under a foot's load.
    DisturbedHold,
    /// Path of a leg's joint with the load of its foot.
    Walking,
    /// Rest without a load.
    Rest,
}

impl RealMotion {
    /// All motions, in the order of their words; successive seeds take successive motions.
    pub const ALL: [Self; 7] =
        [Self::Sine, Self::Random, Self::Moves, Self::SlowSine, Self::DisturbedHold, Self::Walking, Self::Rest];

    /// Motion of a seed; seven successive seeds cover all seven.
    pub fn for_seed(seed: u64) -> Self {
        Self::ALL[(seed % 7) as usize]
    }

    fn from_word(word: &str) -> Option<Self> {
        REAL_MOTIONS.iter().position(|known| *known == word).map(|index| Self::ALL[index])
    }
}

/// Load on the link as part of the profile; without a stated value the torque scales with the rated torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProfileLoad {
    /// No load.
    None,
    /// Periodic load: torque [N m], frequency [Hz].
    Wave(Wave, Option<f64>, f64),
    /// One push at the start of the figures: torque [N m], length [s].
    Kick(Option<f64>, f64),
    /// A push each second with alternating sign: torque [N m], length [s].
    Impacts(Option<f64>, f64),
    /// Load of a foot in each step, for a [`Trajectory::Walking`] of equal frequency: torque [N m], frequency [Hz].
    Stance(Option<f64>, f64),
    /// Slow alternating load: torque [N m], frequency [Hz].
    Slow(Option<f64>, f64),
}

/// Waveform of a periodic load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wave {
    /// Sine.
    Sine,
    /// Steps without a ramp.
    Square,
    /// Ramps of 20 ms, as under a foot that is set down.
    Walk,
}

/// A disturbance torque on the link, as stated in the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisturbanceSpec {
    /// `step`, `pulse` or `sine`.
    pub kind: &'static str,
    /// Start [s].
    pub start: f64,
    /// Length of a pulse [s].
    pub length: f64,
    /// Torque, positive if it brakes [N m].
    pub torque: f64,
    /// Frequency of a sine [Hz].
    pub frequency: f64,
}

/// Load friction of T1 over the rated torque [-]: 1 N m for Q1.
const T1_FRICTION_RATIO: f64 = 1.0 / 12.0;
/// Weight of T2b over the rated torque [-]: 6 N m for Q1.
const T2B_WEIGHT_RATIO: f64 = 0.5;
/// Step rate of a walking robot [Hz].
pub const STEP_RATE: f64 = 1.2;
/// Torque of a brake that holds the link, over the rated torque [-]; no probe reaches it.
const BRAKE_TORQUE_RATIO: f64 = 4.0;

impl MotionProfile {
    /// Default motion of a kind.
    pub fn default_of_kind(kind: &'static str) -> Self {
        let default = Self {
            kind,
            trajectory: Trajectory::Hold(0.0),
            load: ProfileLoad::None,
            friction: None,
            gravity: Some(0.0),
            duration: 8.0,
            settle: 2.0,
        };
        match kind {
            "T1" => Self {
                trajectory: Trajectory::Sine(0.5, 0.2),
                friction: Some(T1_FRICTION_RATIO),
                duration: 12.0,
                ..default
            },
            "T2" | "impedance" => Self { trajectory: Trajectory::Sine(0.5, 1.0), ..default }.with_four_periods(1.0),
            "T2b" => Self { trajectory: Trajectory::Sine(0.3, 1.5), gravity: Some(T2B_WEIGHT_RATIO), ..default }
                .with_four_periods(1.5),
            "sine" => Self { trajectory: Trajectory::Sine(0.5, 1.0), gravity: None, ..default }.with_four_periods(1.0),
            "random" => Self { trajectory: Trajectory::Random(0.2, 2.0), ..default },
            "steps" => Self { trajectory: Trajectory::Steps(0.05, 0.06, 0.3), ..default },
            "disturbed_hold" => Self { load: ProfileLoad::Wave(Wave::Sine, None, 1.0), ..default },
            "free_hold" => Self { load: ProfileLoad::Kick(None, 0.02), duration: 14.0, settle: 2.1, ..default },
            "impact" => Self { load: ProfileLoad::Impacts(None, 0.01), ..default },
            "hysteresis" => Self { load: ProfileLoad::Slow(None, 0.25), duration: 9.0, settle: 1.0, ..default },
            "held" => Self { friction: Some(BRAKE_TORQUE_RATIO), duration: 1.0, settle: 0.0, ..default },
            "walking" => Self {
                trajectory: Trajectory::Walking(0.3, STEP_RATE),
                load: ProfileLoad::Stance(None, STEP_RATE),
                gravity: None,
                ..default
            },
            "real" => Self { trajectory: Trajectory::Real(None), gravity: None, ..default },
            // The link keeps its stated friction and weight.
            "any" => Self { trajectory: Trajectory::Any, gravity: None, ..default },
            // A recorded motion carries no gravity torque by default: its load is recorded with it or absent.
            _ => Self { gravity: None, ..default },
        }
    }

    /// Numbers of a random motion and its load, by key.
    pub fn drawn_values(&self) -> Vec<(&'static str, f64)> {
        let mut numbers = match self.trajectory {
            Trajectory::Sine(amplitude, frequency) => {
                vec![("profile.sine.amplitude_rad", amplitude), ("profile.sine.frequency_Hz", frequency)]
            }
            Trajectory::Random(amplitude, highest) => {
                vec![("profile.random.amplitude_rad", amplitude), ("profile.random.highest_Hz", highest)]
            }
            Trajectory::Steps(height, duration, rest) => vec![
                ("profile.steps.height_rad", height),
                ("profile.steps.move_s", duration),
                ("profile.steps.rest_s", rest),
            ],
            Trajectory::Walking(amplitude, frequency) => {
                vec![("profile.walking.amplitude_rad", amplitude), ("profile.walking.frequency_Hz", frequency)]
            }
            Trajectory::Hold(_) | Trajectory::File(_) | Trajectory::Any | Trajectory::Real(_) => Vec::new(),
        };
        if let ProfileLoad::Stance(Some(torque), _) = self.load {
            numbers.push(("profile.load.stance_N_m", torque));
        }
        if let ProfileLoad::Wave(wave, Some(torque), frequency) = self.load {
            let of_wave = match wave {
                Wave::Sine => "profile.load.sine_N_m",
                Wave::Square => "profile.load.square_N_m",
                Wave::Walk => "profile.load.walk_N_m",
            };
            numbers.extend([(of_wave, torque), ("profile.load.frequency_Hz", frequency)]);
        }
        numbers
    }

    /// Sets four periods for the figures, after the time for the estimation of parameters.
    fn with_four_periods(self, frequency: f64) -> Self {
        Self { duration: 2.0 + 4.0 / frequency, settle: 1.0 + (1.0 / frequency).max(1.0), ..self }
    }
}

/// Reads `[profile]`.
pub(super) fn read(section: &Section<'_>) -> Option<MotionProfile> {
    let kind = section.required("kind", Section::word)?;
    let mut profile = MotionProfile::default_of_kind(kind);
    let mut known_keys = vec!["kind"];
    {
        let mut set = |name: &'static str, value: &mut f64| {
            known_keys.push(name);
            *value = section.number(name).unwrap_or(*value);
        };
        match &mut profile.trajectory {
            Trajectory::Hold(_) if kind == "csv" => {}
            Trajectory::Sine(amplitude, frequency) => {
                set("amplitude_rad", amplitude);
                set("frequency_Hz", frequency);
            }
            Trajectory::Random(amplitude, highest) => {
                set("amplitude_rad", amplitude);
                set("highest_Hz", highest);
            }
            Trajectory::Steps(height, duration, rest) => {
                set("height_rad", height);
                set("move_s", duration);
                set("rest_s", rest);
            }
            Trajectory::Walking(amplitude, frequency) => {
                set("amplitude_rad", amplitude);
                set("frequency_Hz", frequency);
            }
            Trajectory::Hold(angle) => set("angle_rad", angle),
            Trajectory::File(_) | Trajectory::Any | Trajectory::Real(_) => {}
        }
        match &mut profile.load {
            ProfileLoad::None | ProfileLoad::Stance(..) => {}
            ProfileLoad::Wave(_, _, frequency) | ProfileLoad::Slow(_, frequency) => set("frequency_Hz", frequency),
            ProfileLoad::Kick(_, length) | ProfileLoad::Impacts(_, length) => set("pulse_s", length),
        }
    }
    if let (Trajectory::Walking(_, steps), ProfileLoad::Stance(_, frequency)) = (&profile.trajectory, &mut profile.load)
    {
        *frequency = *steps;
    }
    if let Trajectory::Real(motion) = &mut profile.trajectory {
        known_keys.push("motion");
        *motion = section.word("motion").and_then(RealMotion::from_word);
    }
    if let ProfileLoad::Wave(_, torque, _)
    | ProfileLoad::Stance(torque, _)
    | ProfileLoad::Slow(torque, _)
    | ProfileLoad::Kick(torque, _)
    | ProfileLoad::Impacts(torque, _) = &mut profile.load
    {
        known_keys.push("torque_N_m");
        *torque = section.number("torque_N_m");
    }
    if let ProfileLoad::Wave(wave, ..) = &mut profile.load {
        known_keys.push("wave");
        *wave = match section.word("wave") {
            Some("square") => Wave::Square,
            Some("walk") => Wave::Walk,
            _ => *wave,
        };
    }
    if let Trajectory::Sine(_, frequency) = profile.trajectory
        && section.has("frequency_Hz")
    {
        profile = profile.with_four_periods(frequency);
    }
    if kind == "csv" {
        known_keys.push("file");
        profile.trajectory = Trajectory::File(section.required("file", Section::text)?);
    }
    reject_unused_keys(section, &known_keys, kind);
    Some(profile)
}

/// Reads one `[[disturbance]]`.
pub(super) fn read_disturbance(section: &Section<'_>) -> Option<DisturbanceSpec> {
    let kind = section.required("kind", Section::word)?;
    let known_keys: &[&str] = match kind {
        "step" => &["kind", "start_s", "torque_N_m"],
        "pulse" => &["kind", "start_s", "length_s", "torque_N_m"],
        _ => &["kind", "torque_N_m", "frequency_Hz"],
    };
    known_keys.iter().filter(|name| !section.has(name)).for_each(|name| section.missing(name));
    reject_unused_keys(section, known_keys, kind);
    let number = |name: &str| if known_keys.contains(&name) { section.number(name) } else { Some(0.0) };
    Some(DisturbanceSpec {
        kind,
        start: number("start_s")?,
        length: number("length_s")?,
        torque: number("torque_N_m")?,
        frequency: number("frequency_Hz")?,
    })
}

/// Rejects keys that have no meaning for this kind.
pub(super) fn reject_unused_keys(section: &Section<'_>, known_keys: &[&str], kind: &str) {
    for (name, value) in section.table {
        let name = name.get_ref().as_ref();
        if !known_keys.contains(&name) && super::keys::KEYS.iter().any(|key| key.name == name) {
            let known: Vec<String> = known_keys.iter().map(|name| format!("`{name}`")).collect();
            let help = format!("kind \"{kind}\" has {}", known.join(", "));
            section.notes.error(Spanned::span(value), format!("`{name}` has no effect on \"{kind}\""), help);
        }
    }
}
