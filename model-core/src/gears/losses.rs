//! Load-dependent losses of gears, from their efficiency.
//!
//! Equations: (E5) in docs/theory/equivalent-gear.md.

/// Efficiency below which a gear is self-locking [-]. Derived: a worm with the friction angle phi and the lead angle lambda
/// has eta = tan(lambda) / tan(lambda + phi) forwards, and tan(lambda - phi) / tan(lambda), about 2 - 1/eta, backwards.
pub const SELF_LOCKING: f64 = 0.5;

/// Returns the loss over the torque in the teeth at a given efficiency: [while the motor drives, while the load drives
/// back].
///
/// ```
/// let [driving, driven] = model_core::gears::gear_losses(0.97);
/// // To press 10 N m on through the teeth, a motor that drives needs so much more that 97 % of it arrive.
/// let motor = 10.0 + 10.0 * driving;
/// assert!((0.97 * motor - 10.0_f64).abs() < 1e-12);
/// // Of 10 N m that a load drives back, 97 % arrive at the motor.
/// assert!((10.0 - 10.0 * driven - 9.7_f64).abs() < 1e-12);
/// // Of a worm of 40 % nothing arrives: its friction can hold more than the load.
/// let [_, driven] = model_core::gears::gear_losses(0.4);
/// assert!((driven - 1.5_f64).abs() < 1e-12);
/// ```
pub fn gear_losses(efficiency: f64) -> [f64; 2] {
    let driving = 1.0 / efficiency - 1.0;
    [driving, if efficiency < SELF_LOCKING { driving } else { 1.0 - efficiency }]
}
