//! Hysteretic part of the stiffness between carrier and link: a slipping spring after Dahl.
//!
//! With the wind-up w = u_c - u_l the slipping part carries the force F = k q. Its deflection q follows (P. R. Dahl, "A solid friction
//! model", Aerospace Corporation TOR-0158(3107-18)-1, 1968, with the exponent 1)
//!
//! ```text
//! q' = w' - |w'| q / q_s   (D1)
//! ```
//!
//! At small wind-up q = w: a spring of stiffness k. At large wind-up |q| tends to q_s and the force to the slip force k
//! q_s. Over a steady cycle of amplitude X the slipping part dissipates the energy
//!
//! ```text
//! E = 4 k q_s (X - q_s tanh(X / q_s))   (D2)
//! ```
//!
//! Equations: (R2) in docs/theory/real-joints.md.

/// Slipping spring.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slip {
    /// k [N/m].
    pub stiffness: f64,
    /// q_s [m].
    pub limit: f64,
}

impl Slip {
    /// q' by (D1) at a deflection and a rate of the wind-up.
    pub fn rate(self, deflection: f64, wind_up_rate: f64) -> f64 {
        wind_up_rate - wind_up_rate.abs() * deflection / self.limit
    }

    /// Dissipated power: F w' less the growth of the energy k q^2 / 2 [W].
    pub fn loss(self, deflection: f64, wind_up_rate: f64) -> f64 {
        self.stiffness * deflection * deflection * wind_up_rate.abs() / self.limit
    }

    /// q after a change of the wind-up in one direction: the exact solution of (D1).
    pub fn after(self, deflection: f64, wind_up_change: f64) -> f64 {
        let end = self.limit.copysign(wind_up_change);
        deflection + (end - deflection) * -(-wind_up_change.abs() / self.limit).exp_m1()
    }
}
