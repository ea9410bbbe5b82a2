//! Where everything is, referred to the link, as the estimates have it: what the rest of the compensation works on. It
//! is made anew every control period and carries no state.

use super::set_point::{CommandRef, Position};
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::observer::{Estimates, Source};

/// Where everything is; angles are less the set-point's position, so that they stay small at any number of turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Situation<T: Real> {
    /// Set-point less link [rad].
    pub error: T,
    /// Set-point's speed less the link's [rad/s].
    pub error_rate: T,
    /// Motor, referred to the link with every tooth centred, less set-point [rad].
    pub motor: T,
    /// Motor beyond the link since the first readings, wherever the encoders' zeros lie [rad].
    pub lead: T,
    /// Of that with every tooth centred, as last known [rad].
    pub offset: T,
    /// `motor` as far as the link's place bears it out: what is more than the guess of the gap allows is wind-up [rad].
    pub confirmed_motor: T,
    /// [rad/s].
    pub motor_speed: T,
    /// [rad/s].
    pub link_speed: T,
    /// Motor within its turn [turns].
    pub motor_place: T,
    /// Sine and cosine of the motor's cogging, referred to the link, driving [N m].
    pub cogging: [T; 2],
    /// Position of the set-point.
    pub origin: Position<T>,
    /// Speed that the motor has by the gears' transmission error alone, referred to the link [rad/s].
    pub transmission_error_speed: T,
    /// Torque that the motor loses whatever its direction, and its dry friction [N m]: as the observer has it, sure or
    /// not, for it leaves out of the load torque what it puts down to them.
    pub losses: [T; 2],
    /// Half of the lost motion [rad].
    pub half: T,
    /// Whether that was learnt or came with the joint, rather than being guessed.
    pub half_is_known: bool,
    /// Torque in the teeth [N m].
    pub mesh_torque: T,
    /// Between motor and link [N m/rad].
    pub stiffness: T,
    /// Inertia of link and motor, the link's as learnt [kg m^2].
    pub inertia: T,
    /// By how much the transmission error shifts both flanks, referred to the link [rad].
    pub shift: T,
    /// By how much that grows for each radian of the link.
    pub shift_slope: T,
    /// Gap coordinate, referred to the link: from -half to half about the shift while every mesh is free [rad].
    pub gap: T,
    /// The flank that touches.
    pub contact: Option<Flank>,
    /// Whether the teeth are known to pass on nothing.
    pub open: bool,
    /// Whether both shafts are seen.
    pub feels: bool,
    /// Whether the motor's place in the gap is known as well; for an impedance, the flanks' places too.
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
        let stiffness = T::ONE.over(clamp(estimates.compliance.value, stiffest, softest));
        let learnt = &estimates.link_inertia_ratio;
        let ratio = if learnt.valid { clamp(learnt.value, T::QUARTER, T::FOUR) } else { T::ONE };
        let at_link = T::HALF * tables.gear.inverse_lever;
        let error = tables.gear.turn * origin.less(estimates.link.turns, estimates.link.fraction);
        // The shafts' own angles are counted from their encoders' zeros, which may lie anywhere against each other.
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
        // A position law corrects the link's error after a crossing to a flank that lies elsewhere; an impedance law does not.
        let flanks_known = matches!(command, CommandRef::Position { .. }) || estimates.half_backlash.valid;
        let gap_known = estimates.gap.valid && estimates.half_backlash.value.is_finite();
        let knows = estimates.contact_valid && gap_known && flanks_known;
        situation.sees = situation.feels && knows;
        situation
    }

    /// The shift of the flanks when the link will have turned by an angle [rad].
    pub fn shift_after(&self, tables: &CompensationTables<T>, angle: T) -> T {
        let (sine, cosine) = sine_cosine((tables.gear.mesh_phase_per_radian * angle).to_phase());
        self.shift * cosine + self.shift_slope * tables.gear.radians_per_mesh * sine
    }

    /// Motor beyond the link, with every tooth centred, as far as the link's place bears it out [rad].
    pub fn beyond_link(&self) -> T {
        self.confirmed_motor + self.error
    }

    /// By how much the motor's cogging drives more than that of a motor would which stood where it stands without a gap [N m].
    pub fn cogging_by_gap(&self, tables: &CompensationTables<T>) -> T {
        let phase = self.motor_place.over(T::PHASE_UNIT).to_phase().wrapping_mul(tables.gear.cogging_periods);
        let without_gap = phase.wrapping_sub((tables.gear.cogging_phase_per_radian * self.beyond_link()).to_phase());
        let [here, there] = [phase, without_gap].map(|phase| {
            let (sine, cosine) = sine_cosine::<T>(phase);
            self.cogging[0] * sine + self.cogging[1] * cosine
        });
        here - there
    }

    /// Torque that is lost between motor and load at a speed, while the teeth pass on a torque [N m].
    pub fn lost(&self, tables: &CompensationTables<T>, speed: T, passed: T) -> T {
        let direction = planned_direction(tables, speed);
        let [driving, driven] = tables.gear.losses;
        let ratio = if passed * direction > T::ZERO { driving } else { driven };
        self.losses[0] + (self.losses[1] + ratio * passed.abs()) * direction
    }

    /// Torque of the damper on the motor against the link; it leaves alone what the transmission error makes the motor do
    /// [N m].
    pub fn damping_torque(&self, tables: &CompensationTables<T>) -> T {
        tables.law.motor_damping * (self.link_speed + self.transmission_error_speed - self.motor_speed)
    }
}

/// -1 to 1: what share of the dry friction brakes the link at a speed that is planned: no noise hides its sign.
pub(super) fn planned_direction<T: Real>(tables: &CompensationTables<T>, speed: T) -> T {
    clamp(tables.load.planned_friction_slope * speed, -T::ONE, T::ONE)
}
