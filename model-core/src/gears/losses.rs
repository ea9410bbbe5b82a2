//! What gears lose in proportion to what their teeth pass on.

/// What gears of an efficiency lose over what their teeth pass on, while the motor drives and while the load does.
pub fn gear_losses(efficiency: f64) -> [f64; 2] {
    [1.0 / efficiency - 1.0, 1.0 - efficiency]
}
