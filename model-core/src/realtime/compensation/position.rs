//! The control law of position mode: spring on the link, damper on the motor, acceleration and load fed forward. The
//! load estimate takes the place of an integral.

use super::arithmetic::{beyond, clamp};
use super::intent::{Intent, Situation, crossing_time};
use super::load::LoadModel;
use super::set_point::Motion;
use crate::real::Real;
use crate::tables::compensation::CompensationTables;

/// What position mode remembers.
#[derive(Debug, Clone)]
pub(super) struct PositionLaw<T: Real> {
    /// Acceleration asked for one period ago.
    before: Option<T>,
    /// Error that is let be while the motion rests, grown by crossings that feedback alone has caused [rad].
    indulgence: T,
    /// Sign of the demand ahead, one period ago.
    asked: T,
}

impl<T: Real> PositionLaw<T> {
    pub fn new() -> Self {
        Self { before: None, indulgence: T::ZERO, asked: T::ZERO }
    }

    pub fn forget(&mut self) {
        self.before = None;
    }

    pub fn intend(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
        ahead: Option<&Motion<T>>,
    ) -> Intent<T> {
        let crossing = crossing_time(tables, situation.half);
        let lead = crossing + tables.reaction;
        let (ahead_speed, ahead_acceleration) = self.ahead(tables, now, ahead, lead);
        let rests = now.speed == T::ZERO
            && now.acceleration == T::ZERO
            && ahead_speed == T::ZERO
            && ahead_acceleration == T::ZERO;
        let let_be = if rests { self.indulgence } else { T::ZERO };

        let error = beyond(situation.error, let_be);
        let law = (tables.load_inertia + tables.motor_inertia) * now.acceleration
            + load.even()
            + load.drag(tables, now.speed)
            + tables.position_gain * error
            + tables.damping_gain * (now.speed - situation.motor_speed);
        let feedback = |time: T| {
            let error = beyond(situation.error + time * situation.error_rate, let_be);
            let torque = tables.position_gain * error + tables.damping_gain * situation.error_rate;
            beyond(torque, tables.doubt)
        };
        let free = load.even() + load.drag(tables, situation.link_speed);
        let planned_ahead = tables.load_inertia * ahead_acceleration
            + load.even()
            + load.drag(tables, ahead_speed - situation.error_rate);
        let demand_ahead = planned_ahead + feedback(lead);
        self.indulge(tables, rests, planned_ahead, demand_ahead, situation.half);
        Intent {
            law,
            demand_now: tables.load_inertia * now.acceleration + free + feedback(T::ZERO),
            demand_ahead,
            planned_ahead,
            free_acceleration: -free * tables.inverse_load_inertia,
            crossing,
        }
    }

    /// Speed and acceleration asked for at a time from now; without a preview, by the jerk.
    fn ahead(&mut self, tables: &CompensationTables<T>, now: &Motion<T>, ahead: Option<&Motion<T>>, lead: T) -> (T, T) {
        let before = self.before.replace(now.acceleration);
        match ahead {
            Some(ahead) => {
                let part = lead * tables.inverse_lead;
                (
                    now.speed + part * (ahead.speed - now.speed),
                    now.acceleration + part * (ahead.acceleration - now.acceleration),
                )
            }
            None => {
                let growth = before.map_or(T::ZERO, |before| lead * tables.rate * (now.acceleration - before));
                (now.speed + lead * (now.acceleration + T::HALF * growth), now.acceleration + growth)
            }
        }
    }

    /// Doubles the error that is let be whenever feedback alone asks for the other flank of a joint at rest; forgives it
    /// slowly, and at once when the joint is to move.
    fn indulge(&mut self, tables: &CompensationTables<T>, rests: bool, planned: T, demand: T, half: T) {
        if !rests {
            self.indulgence = T::ZERO;
            self.asked = T::ZERO;
            return;
        }
        self.indulgence = self.indulgence * tables.forgiving;
        if self.asked * demand < T::ZERO && planned * demand <= T::ZERO {
            let grown = self.indulgence + self.indulgence + tables.first_indulgence * half;
            self.indulgence = clamp(grown, T::ZERO, tables.last_indulgence * half);
        }
        if demand != T::ZERO {
            self.asked = if demand > T::ZERO { T::ONE } else { -T::ONE };
        }
    }
}
