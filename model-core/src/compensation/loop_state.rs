//! State of the joint in a control period, referred to the link: input of the rest of the compensation. The state is
//! computed anew every period from the estimates.

use super::set_point::{CommandRef, Position};
use super::thresholds::EstimateBounds;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::observer::{Estimates, Source};

/// State of the joint; angles are relative to the set-point, so that they stay small at any number of turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopState<T: Real> {
    /// Set-point less link [rad].
    pub error: T,
    /// Set-point's speed less the link's [rad/s].
    pub error_rate: T,
    /// Motor, referred to the link with all teeth centred, less set-point [rad].
    pub motor_position: T,
    /// Motor less link, counted from the first readings, whatever the zeros of the encoders [rad].
    pub motor_lead: T,
    /// Value of `motor_lead` with all teeth centred, as last known [rad].
    pub encoder_offset: T,
    /// `motor_position`, bounded to twice the half-gap around the link: a larger distance is wind-up [rad].
    pub bounded_motor_position: T,
    /// Speed of the motor, referred to the link [rad/s].
    pub motor_speed: T,
    /// Speed of the link [rad/s].
    pub link_speed: T,
    /// Angle of the motor within its turn [turns].
    pub motor_angle: T,
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
    pub half_gap: T,
    /// True if `half_gap` is estimated or given, not guessed.
    pub half_gap_known: bool,
    /// Torque through the teeth [N m].
    pub mesh_torque: T,
    /// Stiffness between motor and link [N m/rad].
    pub stiffness: T,
    /// Inertia of motor and link, with the estimated link inertia [kg m^2].
    pub inertia: T,
    /// Shift of both flanks by the transmission error, referred to the link [rad].
    pub flank_shift: T,
    /// Growth of `flank_shift` per radian of the link [-].
    pub flank_shift_slope: T,
    /// Gap coordinate, referred to the link: -`half_gap` to `half_gap` about `flank_shift` while every mesh is free
    /// [rad].
    pub gap: T,
    /// Flank in contact.
    pub contact: Option<Flank>,
    /// True if the teeth are known to pass no torque.
    pub teeth_open: bool,
    /// True if both encoders are used and all estimates are finite.
    pub link_seen: bool,
    /// True if gap and contact are valid as well; in impedance mode also the half-gap.
    pub gap_known: bool,
}

impl<T: Real> LoopState<T> {
    /// Refers the estimates of a period to the link and to the set-point. `encoder_offset` is the offset of the motor
    /// encoder against the output encoder at the link [rad].
    pub fn new(
        tables: &CompensationTables<T>,
        estimates: &Estimates<T>,
        encoder_offset: T,
        command: CommandRef<T>,
    ) -> Self {
        let (origin, speed) = match command {
            CommandRef::Position { now, .. } => (now.position, now.speed),
            CommandRef::Impedance(point) => (point.position, point.speed),
        };
        let error = tables.gear.turn * origin.difference(estimates.link.turns, estimates.link.fraction);
        // Motor and link angle count from the zeros of their encoders, which differ by an offset.
        let motor_position = estimates.motor_lead - encoder_offset - error;
        let half_gap = half_gap(tables, estimates);
        let both_encoders = estimates.source == Source::Both;
        let contact = Flank::touched(estimates.reported_contact);
        // Shifts and gap coordinate are deflections of both meshes in series: twice the travel of the carrier.
        let at_link = T::HALF * tables.gear.inverse_lever;
        let mut state = Self {
            error,
            error_rate: speed - estimates.link.speed,
            motor_position,
            motor_lead: estimates.motor_lead,
            encoder_offset,
            bounded_motor_position: if both_encoders && error.is_finite() {
                clamp(motor_position, -error - half_gap - half_gap, half_gap + half_gap - error)
            } else {
                motor_position
            },
            motor_speed: tables.gear.link_per_motor * estimates.motor.speed,
            motor_angle: estimates.motor.fraction,
            cogging: estimates.cogging,
            link_speed: estimates.link.speed,
            origin,
            half_gap,
            half_gap_known: estimates.half_backlash_usable,
            mesh_torque: estimates.mesh_torque.value,
            stiffness: stiffness(tables, estimates),
            inertia: inertia(tables, estimates),
            losses: [estimates.torque_bias, estimates.motor_friction]
                .map(|loss| tables.gear.motor_per_link * loss.value),
            transmission_error_speed: at_link * estimates.flank_shift_slope * estimates.link.speed,
            flank_shift: at_link * estimates.flank_shift,
            flank_shift_slope: at_link * estimates.flank_shift_slope,
            gap: at_link * estimates.gap.value,
            contact,
            teeth_open: estimates.contact_valid && contact.is_none(),
            link_seen: false,
            gap_known: false,
        };
        state.link_seen = both_encoders && state.is_finite();
        state.gap_known = state.link_seen && gap_is_valid(estimates, command);
        state
    }

    /// True if all quantities are finite. A sum of quantities of one unit is finite only if each of them is.
    fn is_finite(&self) -> bool {
        let angles = self.error + self.motor_position + self.gap + self.flank_shift;
        let speeds = self.error_rate + self.motor_speed + self.transmission_error_speed;
        let torques = self.losses[0] + self.losses[1] + self.mesh_torque;
        [angles, speeds, torques, self.stiffness, self.inertia].iter().all(|quantity| quantity.is_finite())
    }

    /// Shift of the flanks after a further angle of the link [rad].
    pub fn flank_shift_after(&self, tables: &CompensationTables<T>, angle: T) -> T {
        let (sine, cosine) = sine_cosine((tables.gear.mesh_phase_per_radian * angle).to_phase());
        self.flank_shift * cosine + self.flank_shift_slope * tables.gear.radians_per_mesh * sine
    }

    /// Motor less link with all teeth centred, bounded to twice the half-gap [rad].
    pub fn bounded_motor_lead(&self) -> T {
        self.bounded_motor_position + self.error
    }

    /// Cogging torque of the motor less the cogging torque in a joint without a gap [N m].
    pub fn cogging_difference(&self, tables: &CompensationTables<T>) -> T {
        let phase = (self.motor_angle / T::PHASE_UNIT).to_phase().wrapping_mul(tables.gear.cogging_periods);
        let rigid_phase =
            phase.wrapping_sub((tables.gear.cogging_phase_per_radian * self.bounded_motor_lead()).to_phase());
        let [with_gap, rigid] = [phase, rigid_phase].map(|phase| {
            let (sine, cosine) = sine_cosine::<T>(phase);
            self.cogging[0] * sine + self.cogging[1] * cosine
        });
        with_gap - rigid
    }

    /// Torque lost between motor and load at a speed, while the teeth pass a torque [N m].
    pub fn loss_torque(&self, tables: &CompensationTables<T>, speed: T, mesh_torque: T) -> T {
        let direction = friction_direction(tables, speed);
        let [driving, driven] = tables.gear.losses;
        let ratio = if mesh_torque * direction > T::ZERO { driving } else { driven };
        self.losses[0] + (self.losses[1] + ratio * mesh_torque.abs()) * direction
    }

    /// Torque of the damper on the motor against the link, without the motion caused by the transmission error [N m].
    pub fn damping_torque(&self, tables: &CompensationTables<T>) -> T {
        tables.law.motor_damping * (self.link_speed + self.transmission_error_speed - self.motor_speed)
    }
}

/// Half of the lost motion, from 0 to the widest that the tables allow [rad].
fn half_gap<T: Real>(tables: &CompensationTables<T>, estimates: &Estimates<T>) -> T {
    clamp(tables.gear.inverse_lever * estimates.half_backlash.value, T::ZERO, tables.body.widest_half)
}

/// Stiffness between motor and link, by the estimated compliance within its bounds [N m/rad].
fn stiffness<T: Real>(tables: &CompensationTables<T>, estimates: &Estimates<T>) -> T {
    let [softest, stiffest] = tables.body.compliances;
    T::ONE / clamp(estimates.compliance.value, stiffest, softest)
}

/// Inertia of motor and link; the link's is the designed one until it is estimated [kg m^2].
fn inertia<T: Real>(tables: &CompensationTables<T>, estimates: &Estimates<T>) -> T {
    let [lightest, heaviest] = EstimateBounds::<T>::TUNED.link_inertia_ratio;
    let estimated = &estimates.link_inertia_ratio;
    let ratio = if estimated.valid { clamp(estimated.value, lightest, heaviest) } else { T::ONE };
    tables.body.motor_inertia + ratio * tables.body.load_inertia
}

/// True if gap and contact are valid. Position mode corrects the error of the link after a crossing to a misplaced
/// flank; impedance mode does not, and needs a valid half-gap as well.
fn gap_is_valid<T: Real>(estimates: &Estimates<T>, command: CommandRef<T>) -> bool {
    let flanks_known = matches!(command, CommandRef::Position { .. }) || estimates.half_backlash.valid;
    let gap_known = estimates.gap.valid && estimates.half_backlash.value.is_finite();
    estimates.contact_valid && gap_known && flanks_known
}

/// Share and sign of the dry friction at a planned speed, -1 to 1: a planned speed has no noise.
pub(super) fn friction_direction<T: Real>(tables: &CompensationTables<T>, speed: T) -> T {
    clamp(tables.load.planned_friction_slope * speed, -T::ONE, T::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::set_point::{ImpedancePoint, Motion};
    use crate::compensation::test_bench::{q1, state, tables};
    use crate::observer::OutputFault;

    /// Estimates of a joint that sees both shafts, with everything valid.
    fn estimates() -> Estimates<f64> {
        let mut estimates = Estimates { source: Source::Both, contact_valid: true, ..Estimates::default() };
        (estimates.gap.valid, estimates.half_backlash.valid) = (true, true);
        estimates.half_backlash.value = 2e-3;
        estimates.compliance.value = 1e-3;
        estimates
    }

    fn position(estimates: &Estimates<f64>) -> LoopState<f64> {
        let now = &Motion::default();
        LoopState::new(&tables(), estimates, 0.0, CommandRef::Position { now, ahead: None })
    }

    #[test]
    fn valid_estimates_know_the_gap() {
        let state = position(&estimates());
        assert!(state.link_seen && state.gap_known);
    }

    #[test]
    fn quantity_that_is_not_finite_hides_the_link() {
        let spoils: [fn(&mut Estimates<f64>, f64); 9] = [
            |estimates, value| estimates.link.fraction = value,
            |estimates, value| estimates.link.speed = value,
            |estimates, value| estimates.motor_lead = value,
            |estimates, value| estimates.motor.speed = value,
            |estimates, value| estimates.gap.value = value,
            |estimates, value| estimates.flank_shift = value,
            |estimates, value| estimates.torque_bias.value = value,
            |estimates, value| estimates.motor_friction.value = value,
            |estimates, value| estimates.mesh_torque.value = value,
        ];
        for (index, spoil) in spoils.iter().enumerate() {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut estimates = estimates();
                spoil(&mut estimates, value);
                let state = position(&estimates);
                assert!(!state.link_seen && !state.gap_known, "quantity {index}: {value}");
            }
        }
    }

    #[test]
    fn infinities_of_opposite_sign_do_not_cancel() {
        let state = LoopState { error: f64::INFINITY, gap: f64::NEG_INFINITY, ..state() };
        assert!(!state.is_finite());
    }

    #[test]
    fn motor_encoder_alone_does_not_see_the_link() {
        assert!(!position(&Estimates { source: Source::MotorOnly(OutputFault::Absent), ..estimates() }).link_seen);
    }

    #[test]
    fn invalid_gap_or_contact_is_not_known() {
        let mut without_gap = estimates();
        without_gap.gap.valid = false;
        let without_contact = Estimates { contact_valid: false, ..estimates() };
        for estimates in [without_gap, without_contact] {
            let state = position(&estimates);
            assert!(state.link_seen && !state.gap_known);
        }
    }

    #[test]
    fn impedance_mode_needs_a_valid_half_gap() {
        let mut guessed = estimates();
        guessed.half_backlash.valid = false;
        let point = &ImpedancePoint::default();
        assert!(position(&guessed).gap_known);
        assert!(!LoopState::new(&tables(), &guessed, 0.0, CommandRef::Impedance(point)).gap_known);
    }

    #[test]
    fn link_inertia_counts_within_its_bounds() {
        let inertia = |ratio: f64, valid: bool| {
            let mut estimates = estimates();
            (estimates.link_inertia_ratio.value, estimates.link_inertia_ratio.valid) = (ratio, valid);
            inertia(&tables(), &estimates)
        };
        assert_eq!([0.1, 2.0, 9.0].map(|ratio| inertia(ratio, true)), [1.75, 7.0, 13.0]);
        assert_eq!(inertia(9.0, false), 4.0);
    }

    #[test]
    fn compliance_counts_within_its_bounds() {
        let stiffness = |compliance: f64| {
            let mut estimates = estimates();
            estimates.compliance.value = compliance;
            stiffness(&tables(), &estimates)
        };
        assert_eq!([0.0, 1e-3, 1.0].map(stiffness), [4000.0, 1000.0, 250.0]);
    }

    #[test]
    fn half_gap_counts_up_to_the_widest() {
        let half_gap = |value: f64| {
            let mut estimates = estimates();
            estimates.half_backlash.value = value;
            half_gap(&tables(), &estimates)
        };
        assert_eq!([-1.0, 2e-3, 1.0].map(half_gap), [0.0, 2e-3, 10e-3]);
    }

    #[test]
    fn motor_far_from_the_link_is_bounded_to_twice_the_half_gap() {
        let lead = |motor_lead| position(&Estimates { motor_lead, ..estimates() }).bounded_motor_lead();
        assert_eq!([-1.0, 3e-3, 1.0].map(lead), [-4e-3, 3e-3, 4e-3]);
    }

    #[test]
    fn losses_act_against_the_motion() {
        let state = LoopState { losses: [0.5, 1.0], ..state() };
        let loss = |speed: f64, mesh_torque: f64| state.loss_torque(&tables(), speed, mesh_torque);
        // Driving losses of a tenth, driven losses of a fifth of the torque through the teeth.
        assert_eq!([loss(1.0, 5.0), loss(-1.0, 5.0), loss(0.0, 5.0)], [2.0, -1.5, 0.5]);
    }

    #[test]
    fn friction_direction_saturates() {
        let direction = |speed: f64| friction_direction(&tables(), speed);
        assert_eq!([-1.0, -5e-4, 0.0, 5e-4, 1.0].map(direction), [-1.0, -0.5, 0.0, 0.5, 1.0]);
    }

    #[test]
    fn motor_centred_in_its_gap_has_no_cogging_difference() {
        let centred = LoopState { cogging: [0.3, 0.2], motor_angle: 0.37, bounded_motor_position: 0.0, ..state() };
        assert_eq!(centred.cogging_difference(&tables()), 0.0);
        let displaced = LoopState { bounded_motor_position: 5e-3, ..centred };
        assert!(displaced.cogging_difference(&tables()) != 0.0);
    }

    #[test]
    fn damper_opposes_a_motor_ahead_of_the_link() {
        let state = LoopState { motor_speed: 0.3, link_speed: 0.1, transmission_error_speed: 0.1, ..state() };
        assert!((state.damping_torque(&tables()) + 2.0).abs() < 1e-12);
    }

    #[test]
    fn compliance_is_within_factor_of_four() {
        let tables = q1();
        let stiffness = |compliance: f64| {
            let mut estimates = estimates();
            estimates.compliance.value = compliance;
            stiffness(&tables, &estimates)
        };
        // From a quarter to four times the joint file's stiffness.
        assert!((stiffness(0.0) / stiffness(1.0) - 16.0).abs() < 1e-9);
    }

    #[test]
    fn half_gap_is_at_most_five_guesses() {
        let tables = q1();
        let half_gap = |value: f64| {
            let mut estimates = estimates();
            estimates.half_backlash.value = value;
            half_gap(&tables, &estimates) / tables.gear.inverse_lever
        };
        // A half-backlash of 40 um is the guess.
        let [within, beyond] = [199e-6, 201e-6].map(half_gap);
        assert!((within - 199e-6).abs() < 1e-12 && (beyond - 200e-6).abs() < 1e-12, "{within} {beyond}");
    }

    #[test]
    fn planned_friction_is_full_from_1_mrad_per_s() {
        let direction = |speed: f64| friction_direction(&q1(), speed);
        let [below, above] = [0.9e-3, 1.1e-3].map(direction);
        assert!((below - 0.9).abs() < 1e-9 && above == 1.0, "{below} {above}");
    }
}
