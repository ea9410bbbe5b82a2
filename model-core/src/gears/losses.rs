//! What gears lose in proportion to what their teeth pass on.

/// What gears of an efficiency lose over what their teeth pass on, while the motor drives and while the load does.
///
/// ```
/// let [driving, driven] = model_core::gears::gear_losses(0.97);
/// // To press 10 N m on through the teeth, a motor that drives needs so much more that 97 % of it arrive.
/// let motor = 10.0 + 10.0 * driving;
/// assert!((0.97 * motor - 10.0_f64).abs() < 1e-12);
/// // Of 10 N m that a load drives back, 97 % arrive at the motor.
/// assert!((10.0 - 10.0 * driven - 9.7_f64).abs() < 1e-12);
/// ```
pub fn gear_losses(efficiency: f64) -> [f64; 2] {
    [1.0 / efficiency - 1.0, 1.0 - efficiency]
}
