//! Payload: part of the link's inertia on a spring and a damper.
//!
//! With the link's inertia J_l and the payload's share s, frequency f and damping ratio zeta on a held link, the
//! payload has the inertia J_p = s J_l. Its angle r relative to the link follows, with w_0 = 2 pi f (J. P. Den Hartog,
//! "Mechanical Vibrations", chapter 3),
//!
//! ```text
//! J_p (theta_l'' + r'') = -J_p w_0^2 r - 2 zeta w_0 J_p r'   (P1)
//! ```
//!
//! The rest of the link, (1 - s) J_l, is braked by the torque J_p theta_p'' with theta_p = theta_l + r. On a free link
//! the pair swings at w_0 / sqrt(1 - s) with the damping ratio zeta / sqrt(1 - s).
//!
//! Within a part of a period the link's speed is constant: (P1) is solved exactly, and the link is braked by the mean
//! torque, the change of the payload's angular momentum. Angular momentum is conserved up to rounding.
//!
//! Equations: (R1) in docs/theory/real-joints.md.

use std::f64::consts::TAU;

use parameters::Payload;

/// Payload with its state.
#[derive(Debug, Clone)]
pub(super) struct SwingingPayload {
    /// w_0 [rad/s].
    frequency: f64,
    damping_ratio: f64,
    /// J_p [kg m^2].
    inertia: f64,
    /// theta_p [rad] and its rate [rad/s].
    angle: f64,
    speed: f64,
}

impl SwingingPayload {
    /// Returns a payload at rest on the link, if there is a payload.
    pub fn on_link(payload: &Payload, link_inertia: f64, angle: f64, speed: f64) -> Option<Self> {
        (payload.inertia_share > 0.0).then_some(Self {
            frequency: TAU * payload.frequency,
            damping_ratio: payload.damping_ratio,
            inertia: payload.inertia_share * link_inertia,
            angle,
            speed,
        })
    }

    /// Multiplies the payload's inertia; frequency and damping ratio on a held link stay.
    pub fn scale(&mut self, ratio: f64) {
        self.inertia *= ratio;
    }

    /// Advances by a part of a period with constant link speed; returns the mean torque that brakes the link [N m].
    pub fn advance(&mut self, link_angle: f64, link_speed: f64, part: f64) -> f64 {
        let (r, rate) = (self.angle - link_angle, self.speed - link_speed);
        let decay = self.damping_ratio * self.frequency;
        // Always below 1: joint files allow no more.
        let swing = self.frequency * (1.0 - self.damping_ratio * self.damping_ratio).sqrt();
        let (sine, cosine) = (swing * part).sin_cos();
        let left = (-decay * part).exp();
        let quadrature = (rate + decay * r) / swing;
        let after = left * (r * cosine + quadrature * sine);
        let rate_after = left * (rate * cosine - (decay * quadrature + swing * r) * sine);
        let before = self.speed;
        self.angle = link_angle + link_speed * part + after;
        self.speed = link_speed + rate_after;
        self.inertia * (self.speed - before) / part
    }
}
