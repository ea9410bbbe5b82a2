//! Set-points of a drive as commands of the compensation.

use drives::Turns;
use drives::drive::SetPoint;
use model_core::{Command, ImpedancePoint, Motion, Position};

/// Fraction of a turn in one bit of an angle.
const BIT: f32 = 1.0 / 4_294_967_296.0;

/// Command for a set-point of a drive whose angle zero lies at `origin` on the observer's link shaft; `None` for a
/// set-point without an angle, which the drive's own law follows.
pub fn command(set_point: &SetPoint, origin: Turns) -> Option<Command> {
    match set_point {
        SetPoint::Position(target) => {
            let now = Motion { position: position(target.position, origin), speed: target.velocity, acceleration: 0.0 };
            Some(Command::Position { now, ahead: None })
        }
        SetPoint::Impedance { position: angle, velocity, stiffness, damping, torque } => {
            Some(Command::Impedance(ImpedancePoint {
                position: position(*angle, origin),
                speed: *velocity,
                torque: *torque,
                stiffness: *stiffness,
                damping: *damping,
            }))
        }
        _ => None,
    }
}

fn position(angle: Turns, origin: Turns) -> Position {
    let bits = angle.plus(origin).to_bits();
    Position { turns: (bits >> 32) as i32, fraction: (bits.cast_unsigned() as u32) as f32 * BIT }
}

#[cfg(test)]
mod tests {
    use super::*;
    use drives::drive::Target;

    #[test]
    fn angle_is_split_into_turns_and_fraction() {
        let set_point = SetPoint::Position(Target { velocity: 2.0, ..Target::hold(Turns::new(-1.25)) });
        let Some(Command::Position { now, ahead: None }) = command(&set_point, Turns::new(0.5)) else {
            panic!("a position");
        };
        assert_eq!((now.position, now.speed), (Position { turns: -1, fraction: 0.25 }, 2.0));
    }

    #[test]
    fn torque_needs_no_compensation() {
        assert_eq!(command(&SetPoint::Torque { torque: 1.0, max_velocity: 1.0 }, Turns::ZERO), None);
    }
}
