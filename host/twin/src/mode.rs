//! Modes of a drive that the control socket or the live view commands in place of a client.

use std::f64::consts::TAU;

use drives::drive::{SetPoint, Target};
use drives::{Drive, Turns};
use serde::Deserialize;

/// Mode by command.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "Keys")]
pub enum Mode {
    /// The client commands.
    Client,
    /// No torque.
    Off,
    /// Phases shorted.
    Brake,
    /// The present angle.
    Hold,
    /// An angle of the output [turns].
    Position {
        /// Angle [turns].
        turns: f64,
    },
    /// A speed of the output [turns/s].
    Velocity {
        /// Speed [turns/s].
        turns_per_s: f64,
    },
    /// A torque at the output [N m].
    Torque {
        /// Torque [N m].
        torque: f64,
    },
    /// A sine about the present angle.
    Swing {
        /// Amplitude [turns].
        turns: f64,
        /// Period [s].
        period_s: f64,
    },
}

/// Mode in effect, with time [s] and angle at its start.
#[derive(Debug, Clone, Copy)]
pub struct ActiveMode {
    mode: Mode,
    start: f64,
    origin: Turns,
}

/// Keys of a mode in JSON. They are read one by one: an enum with `serde(tag)` rejects all numbers while another crate
/// of the build turns on `arbitrary_precision` of `serde_json`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    kind: String,
    turns: Option<f64>,
    turns_per_s: Option<f64>,
    #[serde(rename = "torque_N_m")]
    torque: Option<f64>,
    period_s: Option<f64>,
}

impl TryFrom<Keys> for Mode {
    type Error = String;

    fn try_from(mut keys: Keys) -> Result<Self, String> {
        let kind = std::mem::take(&mut keys.kind);
        let needed = |key: &str, value: &mut Option<f64>| {
            value.take().ok_or_else(|| format!("the mode `{kind}` needs a number `{key}`"))
        };
        let mode = match kind.as_str() {
            "client" => Self::Client,
            "off" => Self::Off,
            "brake" => Self::Brake,
            "hold" => Self::Hold,
            "position" => Self::Position { turns: needed("turns", &mut keys.turns)? },
            "velocity" => Self::Velocity { turns_per_s: needed("turns_per_s", &mut keys.turns_per_s)? },
            "torque" => Self::Torque { torque: needed("torque_N_m", &mut keys.torque)? },
            "swing" => Self::Swing {
                turns: needed("turns", &mut keys.turns)?,
                period_s: needed("period_s", &mut keys.period_s)?,
            },
            _ => return Err(format!("there is no mode `{kind}`")),
        };
        let numbers = [
            ("turns", keys.turns),
            ("turns_per_s", keys.turns_per_s),
            ("torque_N_m", keys.torque),
            ("period_s", keys.period_s),
        ];
        match numbers.iter().find(|(_, left)| left.is_some()) {
            Some((key, _)) => Err(format!("the mode `{kind}` takes no number `{key}`")),
            None => Ok(mode),
        }
    }
}

impl Mode {
    /// Numbers of the mode with their names and limits.
    pub fn numbers(self) -> Vec<(&'static str, f64, f64, f64)> {
        match self {
            Self::Client | Self::Off | Self::Brake | Self::Hold => Vec::new(),
            Self::Position { turns } => vec![("turns", turns, -1e4, 1e4)],
            Self::Velocity { turns_per_s } => vec![("turns_per_s", turns_per_s, -1e3, 1e3)],
            Self::Torque { torque } => vec![("torque_N_m", torque, -1e6, 1e6)],
            Self::Swing { turns, period_s } => vec![("turns", turns, -1e2, 1e2), ("period_s", period_s, 0.05, 1e3)],
        }
    }

    /// Word of the mode.
    pub fn word(self) -> &'static str {
        match self {
            Self::Client => "client",
            Self::Off => "off",
            Self::Brake => "brake",
            Self::Hold => "hold",
            Self::Position { .. } => "position",
            Self::Velocity { .. } => "velocity",
            Self::Torque { .. } => "torque",
            Self::Swing { .. } => "swing",
        }
    }

    /// Mode that takes effect at a time [s] after another one; `None` gives the drive back to its client.
    pub fn start(self, drive: &mut Drive, time: f64, before: Option<ActiveMode>) -> Option<ActiveMode> {
        let now = ActiveMode { mode: self, start: time, origin: drive.feedback().position };
        match (self, before.map(|before| (before, before.mode))) {
            (Self::Client, _) => {
                // A client has to enable the drive again; its last set-point could be far away by now.
                drive.disable();
                None
            }
            // A swing goes on about its centre, from its present phase.
            (Self::Swing { period_s, .. }, Some((before, Self::Swing { period_s: old, .. }))) => {
                let start = time - (time - before.start) * period_s / old;
                Some(ActiveMode { mode: self, start, origin: before.origin })
            }
            _ => Some(now),
        }
    }
}

impl ActiveMode {
    /// Word of the mode.
    pub fn word(&self) -> &'static str {
        self.mode.word()
    }

    /// Commands the drive for the period at a time [s], which also feeds its watchdog.
    pub fn command(&self, drive: &mut Drive, time: f64) {
        let angle = |turns: f64| Turns::from_bits((turns * (1_u64 << 32) as f64) as i64);
        let set_point = match self.mode {
            Mode::Client => return,
            Mode::Off => return drive.disable(),
            Mode::Brake => SetPoint::Brake,
            Mode::Hold => SetPoint::Position(Target::hold(self.origin)),
            Mode::Position { turns } => SetPoint::Position(Target::hold(angle(turns))),
            Mode::Velocity { turns_per_s } => SetPoint::Velocity {
                velocity: (TAU * turns_per_s) as f32,
                torque: 0.0,
                max_acceleration: f32::INFINITY,
                max_torque: f32::INFINITY,
            },
            Mode::Torque { torque } => SetPoint::Torque { torque: torque as f32, max_velocity: f32::INFINITY },
            Mode::Swing { turns, period_s } => {
                let (sine, cosine) = (TAU * (time - self.start) / period_s).sin_cos();
                let velocity = (turns * TAU * TAU / period_s * cosine) as f32;
                SetPoint::Position(Target { velocity, ..Target::hold(self.origin.plus(angle(turns * sine))) })
            }
        };
        drive.enable(set_point);
    }
}

#[cfg(test)]
mod tests {
    use drives::Settings;
    use drives::drive::{Sensors, State};

    use super::*;

    fn read(text: &str) -> Result<Mode, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn modes_are_read_by_kind() {
        assert_eq!(read(r#"{"kind":"off"}"#), Ok(Mode::Off));
        assert_eq!(read(r#"{"kind":"torque","torque_N_m":2.0}"#), Ok(Mode::Torque { torque: 2.0 }));
        let swing = Mode::Swing { turns: 0.1, period_s: 2.0 };
        assert_eq!(read(r#"{"kind":"swing","turns":0.1,"period_s":2.0}"#), Ok(swing));
        for bad in [
            r#"{"kind":"fly"}"#,
            r#"{"kind":"position"}"#,
            r#"{"kind":"position","turns":1,"speed":2}"#,
            r#"{"kind":"hold","turns":1}"#,
        ] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn mode_outlives_watchdog() {
        let mut drive = Drive::new(Settings { watchdog: Some(0.01), ..Settings::default() });
        let sensors = Sensors { motor_counts: Some(100), output_counts: Some(50), ..Sensors::default() };
        drive.step(&sensors, None);
        let active = Mode::Hold.start(&mut drive, 0.0, None).expect("a mode");
        for period in 0..2000 {
            active.command(&mut drive, 1e-3 * f64::from(period));
            drive.step(&sensors, None);
        }
        assert_eq!((drive.state(), drive.fault()), (State::Enabled, None));
        assert!(Mode::Client.start(&mut drive, 2.0, Some(active)).is_none());
        assert_eq!(drive.state(), State::Disabled);
    }

    #[test]
    fn swing_follows_sine() {
        let mut drive = Drive::new(Settings::default());
        let active = Mode::Swing { turns: 0.1, period_s: 2.0 }.start(&mut drive, 1.0, None).expect("a mode");
        active.command(&mut drive, 1.5);
        let Some(SetPoint::Position(target)) = drive.set_point() else { panic!("a position") };
        assert!((target.position.to_f32() - 0.1).abs() < 1e-6 && target.velocity.abs() < 1e-6, "{target:?}");
        let slower = Mode::Swing { turns: 0.1, period_s: 8.0 }.start(&mut drive, 1.5, Some(active)).expect("a mode");
        slower.command(&mut drive, 1.5);
        let Some(SetPoint::Position(same)) = drive.set_point() else { panic!("a position") };
        assert!((same.position.to_f32() - 0.1).abs() < 1e-6, "the phase goes on: {same:?}");
    }
}
