//! Ranges of the maker's motor types.

use super::mit::Ranges;

/// Motor types with the default values of their registers PMAX, VMAX and TMAX, by the table of the client damiao-motor
/// 1.0.6. LeRobot has 8 rad/s for the 4340 and 12.5 rad, 30 rad/s, 10 N m for the 3507.
pub const MOTOR_TYPES: [(&str, Ranges); 15] = [
    ("3507", Ranges::new(12.566, 50.0, 5.0)),
    ("4310", Ranges::new(12.5, 30.0, 10.0)),
    ("4310P", Ranges::new(12.5, 50.0, 10.0)),
    ("4340", Ranges::new(12.5, 10.0, 28.0)),
    ("4340P", Ranges::new(12.5, 10.0, 28.0)),
    ("6006", Ranges::new(12.5, 45.0, 20.0)),
    ("8006", Ranges::new(12.5, 45.0, 40.0)),
    ("8009", Ranges::new(12.5, 45.0, 54.0)),
    ("10010L", Ranges::new(12.5, 25.0, 200.0)),
    ("10010", Ranges::new(12.5, 20.0, 200.0)),
    ("H3510", Ranges::new(12.5, 280.0, 1.0)),
    ("G6215", Ranges::new(12.5, 45.0, 10.0)),
    ("H6220", Ranges::new(12.5, 45.0, 10.0)),
    ("JH11", Ranges::new(12.5, 10.0, 12.0)),
    ("6248P", Ranges::new(12.566, 20.0, 120.0)),
];

/// Ranges of a motor type; `None` for an unknown one.
///
/// ```
/// assert_eq!(drives::damiao::ranges("4340").unwrap().torque, 28.0);
/// ```
pub fn ranges(motor_type: &str) -> Option<Ranges> {
    MOTOR_TYPES.into_iter().find(|(name, _)| *name == motor_type).map(|(_, ranges)| ranges)
}
