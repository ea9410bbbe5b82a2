//! State of the joint in a control period, referred to the link: input of the rest of the compensation. The state is
//! computed anew every period from the estimates.

use super::set_point::{CommandRef, Position};
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::observer::{Estimates, Source};

/// State of the joint; angles are relative to the set-point, so that they stay small at any number of turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Situation<T: Real> {
    /// Set-point less link [rad].
    pub error: T,
    /// Set-point's speed less the link's [rad/s].
    pub error_rate: T,
    /// Motor, referred to the link with all teeth centred, less set-point [rad].
    pub motor: T,
    /// Motor less link, counted from the first readings, whatever the zeros of the encoders [rad].
    pub lead: T,
    /// Value of `lead` with all teeth centred, as last known [rad].
    pub offset: T,
    /// `motor`, bounded to twice the half-gap around the link: a larger distance is wind-up [rad].
    pub confirmed_motor: T,
    /// Speed of the motor, referred to the link [rad/s].
    pub motor_speed: T,
    /// Speed of the link [rad/s].
    pub link_speed: T,
    /// Angle of the motor within its turn [turns].
    pub motor_place: T,
    /// Sine and cosine part of the motor's cogging torque, referred to the link; positive drives [N m].
    pub cogging: [T; 2],
    /// Position of the set-point: origin of the angles.
    pub origin: Position<T>,
    /// Speed of the motor caused by the transmission error, v_e, referred to the link [rad/s].
    pub transmission_error_speed: T,
    /// Torque bias and dry friction of the motor, valid or not: the observer has subtracted both from the load torque
    /// [N m].
    pub losses: [T; 2],
    /// Half of the lost motion [rad].
    pub half: T,
    /// True if `half` is estimated or given, not guessed.
    pub half_is_known: bool,
    /// Torque through the teeth [N m].
    pub mesh_torque: T,
    /// Stiffness between motor and link [N m/rad].
    pub stiffness: T,
    /// Inertia of motor and link, with the estimated link inertia [kg m^2].
    pub inertia: T,
    /// Shift of both flanks by the transmission error, referred to the link [rad].
    pub shift: T,
    /// Growth of `shift` per radian of the link [-].
    pub shift_slope: T,
    /// Gap coordinate, referred to the link: -half to half about `shift` while every mesh is free [rad].
    pub gap: T,
    /// Flank in contact.
    pub contact: Option<Flank>,
    /// True if the teeth are known to pass no torque.
    pub open: bool,
    /// True if both encoders are used and all estimates are finite.
    pub feels: bool,
    /// True if gap and contact are valid as well; in impedance mode also the half-gap.
    pub sees: bool,
}

impl<T: Real> Situation<T> {
    pub fn new(tables: &CompensationTables<T>, estimates: &Estimates<T>, offset: T, command: CommandRef<T>) -> Self {
        let (origin, speed) = match command {
            CommandRef::Position { now, .. } => (now.position, now.speed),
            CommandRef::Impedance(point) => (point.position, point.speed),
        };
        let contact = Flank::touched(estimates.reported_contact);
        let half = clamp(tables.gear.inverse_lever * estimates.half_backlash.value, T::ZERO, tables.body.widest_half);
        let [softest, stiffest] = tables.body.compliances;
        let stiffness = T::ONE / clamp(estimates.compliance.value, stiffest, softest);
        let learnt = &estimates.link_inertia_ratio;
        let ratio = if learnt.valid { clamp(learnt.value, T::QUARTER, T::FOUR) } else { T::ONE };
        let at_link = T::HALF * tables.gear.inverse_lever;
        let error = tables.gear.turn * origin.less(estimates.link.turns, estimates.link.fraction);
        // Motor and link angle count from the zeros of their encoders, which differ by an offset.
        let motor = estimates.motor_lead - offset - error;
        let confirmed_motor = if estimates.source == Source::Both && error.is_finite() {
            clamp(motor, -error - half - half, half + half - error)
        } else {
            motor
        };
        let mut situation = Self {
            error,
            error_rate: speed - estimates.link.speed,
            motor,
            lead: estimates.motor_lead,
            offset,
            confirmed_motor,
            motor_speed: tables.gear.link_per_motor * estimates.motor.speed,
            motor_place: estimates.motor.fraction,
            cogging: estimates.cogging,
            link_speed: estimates.link.speed,
            origin,
            half,
            half_is_known: estimates.half_backlash_usable,
            mesh_torque: estimates.mesh_torque.value,
            stiffness,
            inertia: tables.body.motor_inertia + ratio * tables.body.load_inertia,
            losses: [estimates.torque_bias, estimates.motor_friction]
                .map(|loss| tables.gear.motor_per_link * loss.value),
            transmission_error_speed: at_link * estimates.flank_shift_slope * estimates.link.speed,
            shift: at_link * estimates.flank_shift,
            shift_slope: at_link * estimates.flank_shift_slope,
            gap: at_link * estimates.gap.value,
            contact,
            open: estimates.contact_valid && contact.is_none(),
            feels: false,
            sees: false,
        };
        let sum = situation.error + situation.error_rate + situation.motor + situation.motor_speed + situation.gap;
        let sum =
            sum + situation.shift + situation.transmission_error_speed + situation.losses[0] + situation.losses[1];
        let sum = sum + situation.mesh_torque + situation.stiffness + situation.inertia;
        situation.feels = estimates.source == Source::Both && sum.is_finite();
        // Position mode corrects the error of the link after a crossing to a misplaced flank; impedance mode does not.
        let flanks_known = matches!(command, CommandRef::Position { .. }) || estimates.half_backlash.valid;
        let gap_known = estimates.gap.valid && estimates.half_backlash.value.is_finite();
        let knows = estimates.contact_valid && gap_known && flanks_known;
        situation.sees = situation.feels && knows;
        situation
    }

    /// Shift of the flanks after a further angle of the link [rad].
    pub fn shift_after(&self, tables: &CompensationTables<T>, angle: T) -> T {
        let (sine, cosine) = sine_cosine((tables.gear.mesh_phase_per_radian * angle).to_phase());
        self.shift * cosine + self.shift_slope * tables.gear.radians_per_mesh * sine
    }

    /// Motor less link with all teeth centred, bounded to twice the half-gap [rad].
    pub fn beyond_link(&self) -> T {
        self.confirmed_motor + self.error
    }

    /// Cogging torque of the motor less the cogging torque in a joint without a gap [N m].
    pub fn cogging_by_gap(&self, tables: &CompensationTables<T>) -> T {
        let phase = (self.motor_place / T::PHASE_UNIT).to_phase().wrapping_mul(tables.gear.cogging_periods);
        let without_gap = phase.wrapping_sub((tables.gear.cogging_phase_per_radian * self.beyond_link()).to_phase());
        let [here, there] = [phase, without_gap].map(|phase| {
            let (sine, cosine) = sine_cosine::<T>(phase);
            self.cogging[0] * sine + self.cogging[1] * cosine
        });
        here - there
    }

    /// Torque lost between motor and load at a speed, while the teeth pass a torque [N m].
    pub fn lost(&self, tables: &CompensationTables<T>, speed: T, passed: T) -> T {
        let direction = planned_direction(tables, speed);
        let [driving, driven] = tables.gear.losses;
        let ratio = if passed * direction > T::ZERO { driving } else { driven };
        self.losses[0] + (self.losses[1] + ratio * passed.abs()) * direction
    }

    /// Torque of the damper on the motor against the link, without the motion caused by the transmission error [N m].
    pub fn damping_torque(&self, tables: &CompensationTables<T>) -> T {
        tables.law.motor_damping * (self.link_speed + self.transmission_error_speed - self.motor_speed)
    }
}

/// Share and sign of the dry friction at a planned speed, -1 to 1: a planned speed has no noise.
pub(super) fn planned_direction<T: Real>(tables: &CompensationTables<T>, speed: T) -> T {
    clamp(tables.load.planned_friction_slope * speed, -T::ONE, T::ONE)
}
