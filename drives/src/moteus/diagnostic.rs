//! Diagnostic channel: lines of text that read and set the configuration.
//!
//! | line | answer |
//! |---|---|
//! | `conf get NAME` | value |
//! | `conf set NAME VALUE` | `OK` |
//! | `conf write`, `tel stop`, `d stop` | `OK`; the last one stops the drive |
//! | others | `ERR` and the reason |

use core::f32::consts::TAU;

use heapless::String;

use super::decimal;
use super::server::Server;
use crate::drive::{Drive, Expiry};
use crate::turns::Turns;

/// Mode after a timeout that takes the torque off.
const TIMEOUT_STOPPED: f32 = 0.0;
/// Mode after a timeout that damps.
const TIMEOUT_DAMPED: f32 = 12.0;

impl Server {
    /// Reads bytes of lines and follows each line that is complete and not empty.
    pub(super) fn read_text(&mut self, text: &[u8], drive: &mut Drive) {
        for byte in text {
            if matches!(byte, b'\r' | b'\n') {
                let line = core::mem::take(&mut self.channel.line);
                self.follow_line(core::str::from_utf8(&line).unwrap_or("?"), drive);
            } else if self.channel.line.push(*byte).is_err() {
                // A line that is too long is no command.
                self.channel.line.clear();
            }
        }
    }

    fn follow_line(&mut self, line: &str, drive: &mut Drive) {
        let mut words = line.split_ascii_whitespace();
        let words = [words.next(), words.next(), words.next(), words.next()].map(Option::unwrap_or_default);
        if words[0].is_empty() {
            return;
        }
        let mut answer = String::<40>::new();
        let _ = match words {
            ["conf", "get", name, ""] => match self.configure(name, None, drive) {
                Some(value) => answer.push_str(&decimal::print(value)).and_then(|()| answer.push_str("\r\n")),
                None => answer.push_str("ERR error reading\r\n"),
            },
            ["conf", "set", name, value] => {
                let value = decimal::parse(value);
                let is_set = value.is_some() && self.configure(name, value, drive).is_some();
                answer.push_str(if is_set { "OK\r\n" } else { "ERR error setting\r\n" })
            }
            ["d", "stop", ..] => {
                drive.disable();
                drive.clear_fault();
                answer.push_str("OK\r\n")
            }
            ["conf", "write", ..] | ["tel", "stop", ..] => answer.push_str("OK\r\n"),
            _ => answer.push_str("ERR unknown command\r\n"),
        };
        self.channel.answer(answer.as_bytes());
    }

    /// Value of a configuration by its name, after it was set to `new`; `None` for an unknown name or a wrong value.
    fn configure(&mut self, name: &str, new: Option<f32>, drive: &mut Drive) -> Option<f32> {
        let settings = drive.settings_mut();
        let torque_constant = settings.torque_constant.max(f32::MIN_POSITIVE);
        let defaults = &mut self.defaults;
        let per_turn = 1.0 / TAU;
        let (value, unit) = match name {
            "servo.pid_position.kp" => (&mut settings.gains.stiffness, per_turn),
            "servo.pid_position.ki" => (&mut settings.gains.integral, per_turn),
            "servo.pid_position.kd" => (&mut settings.gains.damping, per_turn),
            "servo.pid_position.ilimit" => (&mut settings.integral_limit, 1.0),
            "servo.max_current_A" => (&mut settings.torque_limit, torque_constant),
            "servo.max_voltage" => (&mut settings.max_voltage, 1.0),
            "servo.fault_temperature" => (&mut settings.max_temperature, 1.0),
            "servo.timeout_max_torque_Nm" => (&mut settings.expiry_torque, 1.0),
            "servo.default_timeout_s" => (&mut defaults.timeout, 1.0),
            "servo.default_velocity_limit" => (&mut defaults.velocity_limit, 1.0),
            "servo.default_accel_limit" => (&mut defaults.accel_limit, 1.0),
            "servo.max_velocity" => (&mut defaults.max_velocity, 1.0),
            _ => return self.configure_other(name, new, drive),
        };
        if let Some(new) = new {
            *value = new * unit;
        }
        Some(*value / unit)
    }

    /// Configuration that is no number of the settings.
    fn configure_other(&mut self, name: &str, new: Option<f32>, drive: &mut Drive) -> Option<f32> {
        let bound = match name {
            "servopos.position_min" => &mut self.bounds.0,
            "servopos.position_max" => &mut self.bounds.1,
            "servo.timeout_mode" => {
                let expiry = &mut drive.settings_mut().expiry;
                match new {
                    Some(TIMEOUT_STOPPED) => *expiry = Expiry::Disable,
                    Some(TIMEOUT_DAMPED) => *expiry = Expiry::Damp,
                    Some(_) => return None,
                    None => (),
                }
                return Some(if *expiry == Expiry::Damp { TIMEOUT_DAMPED } else { TIMEOUT_STOPPED });
            }
            "id.id" => {
                if let Some(id) = new {
                    self.set_id((1.0..127.0).contains(&id).then_some(id as u8)?);
                }
                return Some(self.id().into());
            }
            "motor_position.rotor_to_output_ratio" if new.is_none() => {
                return Some(1.0 / drive.settings().ratio.to_f32().max(f32::MIN_POSITIVE));
            }
            _ => return None,
        };
        if let Some(new) = new {
            *bound = new.is_finite().then(|| Turns::new(new));
        }
        Some(bound.map_or(f32::NAN, Turns::to_f32))
    }
}
