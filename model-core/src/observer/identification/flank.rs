//! Flank of resting teeth, as estimation needs it. The first row that holds decides:
//!
//! | # | evidence | needs | purpose | needed by |
//! |---|---|---|---|---|
//! | 1 | [`settled_flank`] contact, by deflection and force | the half-gap | most reliable: deflection and force come from independent sensors | `observer learning::brief_contact_reveals_the_width` |
//! | 2 | [`settled_flank`] contact, by the steady force | force above bias and ripple | the only evidence before the half-gap is known | `compensation holding::free_hold_learns_unknown_gap` |
//! | 3 | [`loaded_flank`] contact that has not settled | force above noise in two intervals | a link thrown to and fro never settles; two successive flanks show the half-gap | `compensation width::steps_reveal_the_width` |
//! | 4 | change of the deflection since the last rest ([`LastDwell::flank`]) | a crossing above noise, a force on that side | bias hides the sign of a light force | `observer learning::brief_contact_reveals_the_width` |
//! | 5 | common motion of motor and link ([`CoMotion::flank`]) | a crossing, and a link that has left its course since | contact without any force | `observer learning::link_travel_reveals_the_width` |
//!
//! If no row holds, a dwell updates only parameters that do not depend on the flank.
//!
//! [`LastDwell::flank`]: super::last_dwell::LastDwell::flank
//! [`CoMotion::flank`]: super::co_motion::CoMotion::flank

use super::interval::Interval;
use super::thresholds::FLANK;
use super::uncertainty::Uncertainty;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::contact::force_contact::with_hysteresis;
use crate::observer::contact::gap_position::GapPosition;
use crate::observer::tables::LearnerTable;

/// Evidence of an interval on the flank.
#[derive(Debug, Clone, Copy)]
pub struct FlankEvidence<'by_force, T: Real> {
    /// Variances of the parameters and of the force.
    pub uncertainty: &'by_force Uncertainty<T>,
    /// Position of the mean deflection in the gap.
    pub position: GapPosition<T>,
    /// Mean mesh force [N].
    pub force: T,
    /// Compliance from sun to link [m/N].
    pub compliance: T,
}

/// Flank of settled contact in an interval of rest: by deflection and force once the half-gap is known and both
/// encoders are `both_encoders`, otherwise by the steady force.
pub fn settled_flank<T: Real>(
    evidence: &FlankEvidence<'_, T>,
    interval: &Interval<T>,
    both_encoders: bool,
) -> Option<Flank> {
    let uncertainty = evidence.uncertainty;
    if uncertainty.half_gap_is_known && both_encoders {
        let (contact, _) = evidence.position.contact(None, evidence.force, uncertainty.combined_deviation);
        return contact;
    }
    // The flank of the last settled contact needs less force while the teeth have not left it.
    let twice = T::TWO * uncertainty.steady_force_deviation;
    let thrice = twice + uncertainty.steady_force_deviation;
    let threshold = |flank| if interval.settled_flank == Some(flank) { twice } else { thrice };
    if interval.steady_force > threshold(Flank::Drive) {
        Some(Flank::Drive)
    } else if -interval.steady_force > threshold(Flank::Back) {
        Some(Flank::Back)
    } else {
        None
    }
}

/// Flank on which the mesh force exceeds any bias, at rest or not, while the force changes too slowly for the lag of
/// its estimate to matter; the force rises by `rise` in an interval [N]. Once the half-gap is known, the deflection has
/// to agree.
pub fn loaded_flank<T: Real>(
    evidence: &FlankEvidence<'_, T>,
    interval: &Interval<T>,
    table: &LearnerTable<T>,
    rise: T,
) -> Option<Flank> {
    let uncertainty = evidence.uncertainty;
    let deflection_by_lag = rise.abs() * evidence.compliance * table.force_lag;
    if deflection_by_lag > T::from_i32(FLANK.lag_sigma) * table.noise {
        return None;
    }
    if !uncertainty.half_gap_is_known {
        return loaded_flank_by_force(evidence, interval);
    }
    if evidence.force.abs() <= T::THREE * uncertainty.mean_force_deviation {
        return None;
    }
    let (contact, _) = evidence.position.contact(None, evidence.force, uncertainty.combined_deviation);
    contact.filter(|flank| flank.sign::<T>() * evidence.force > T::ZERO)
}

/// Flank by force alone. Coarsely controlled motors shake more between intervals than soft landings press, so that the
/// steady force must exceed its threshold; the steady force lags, so that the present force has to agree.
fn loaded_flank_by_force<T: Real>(evidence: &FlankEvidence<'_, T>, interval: &Interval<T>) -> Option<Flank> {
    let uncertainty = evidence.uncertainty;
    let flank_by = |force: T, least: T| with_hysteresis(None, force, least, least);
    let by_steady_force =
        flank_by(interval.steady_force, T::from_i32(FLANK.unconfirmed_sigma) * uncertainty.steady_force_deviation);
    let by_force = flank_by(evidence.force, T::TWO * uncertainty.mean_force_deviation);
    if by_steady_force == by_force { by_force } else { None }
}

/// Shortest touch that updates the parameters [intervals]. Until the half-gap is known, half a block of rest suffices:
/// a link that is thrown to and fro rests no longer on a flank.
pub fn shortest_contact<T: Real>(uncertainty: &Uncertainty<T>, table: &LearnerTable<T>) -> u8 {
    if uncertainty.half_gap_is_known { FLANK.shortest_contact } else { (table.block as u8).div_ceil(2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::learner;

    const DRIVE: Option<Flank> = Some(Flank::Drive);

    /// Deviations of 1 N; the half-gap is known if `is_known`.
    fn uncertainty(is_known: bool) -> Uncertainty<f32> {
        let mut uncertainty = Uncertainty::uninitialized();
        uncertainty.steady_force_deviation = 1.0;
        uncertainty.mean_force_deviation = 1.0;
        uncertainty.combined_deviation = 1.0;
        uncertainty.half_gap_is_known = is_known;
        uncertainty
    }

    /// Evidence of a force on teeth at a deflection, in a half-gap of 80 um.
    fn evidence(uncertainty: &Uncertainty<f32>, deflection: f32, force: f32) -> FlankEvidence<'_, f32> {
        let position = GapPosition {
            deflection,
            travel: 0.0,
            half_gap: 80e-6,
            blur: 10e-6,
            near: 0.0,
            stiffness: 5e6,
            weight: 0.0,
        };
        FlankEvidence { uncertainty, position, force, compliance: 1e-6 }
    }

    fn interval(steady_force: f32) -> Interval<f32> {
        let mut interval = Interval::new();
        interval.steady_force = steady_force;
        interval
    }

    #[test]
    fn unknown_half_gap_needs_three_deviations() {
        let uncertainty = uncertainty(false);
        let evidence = evidence(&uncertainty, 0.0, 0.0);
        assert_eq!(settled_flank(&evidence, &interval(3.0), true), None);
        assert_eq!(settled_flank(&evidence, &interval(3.1), true), DRIVE);
        assert_eq!(settled_flank(&evidence, &interval(-3.1), true), Some(Flank::Back));
    }

    #[test]
    fn settled_flank_is_kept_above_two_deviations() {
        let uncertainty = uncertainty(false);
        let evidence = evidence(&uncertainty, 0.0, 0.0);
        let settled = |steady_force| {
            let mut interval = interval(steady_force);
            interval.settled_flank = DRIVE;
            settled_flank(&evidence, &interval, true)
        };
        assert_eq!((settled(2.1), settled(2.0), settled(-2.1)), (DRIVE, None, None));
    }

    #[test]
    fn known_half_gap_decides_by_deflection() {
        let uncertainty = uncertainty(true);
        let far = interval(100.0);
        assert_eq!(settled_flank(&evidence(&uncertainty, 60e-6, 100.0), &far, true), None);
        assert_eq!(settled_flank(&evidence(&uncertainty, 85e-6, 3.0), &far, true), DRIVE);
        assert_eq!(settled_flank(&evidence(&uncertainty, 60e-6, 100.0), &far, false), DRIVE, "no output encoder");
    }

    #[test]
    fn rising_force_is_not_loaded() {
        let uncertainty = uncertainty(true);
        let evidence = evidence(&uncertainty, 85e-6, 10.0);
        // A rise of 8 N lags by 8 N x 1 um/N x 0.5 = 4 um, four deviations.
        assert_eq!(loaded_flank(&evidence, &interval(0.0), &learner(), 7.9), DRIVE);
        assert_eq!(loaded_flank(&evidence, &interval(0.0), &learner(), -8.1), None);
    }

    #[test]
    fn loaded_flank_needs_force_and_deflection() {
        let uncertainty = uncertainty(true);
        let loaded = |deflection, force| {
            loaded_flank(&evidence(&uncertainty, deflection, force), &interval(0.0), &learner(), 0.0)
        };
        assert_eq!(loaded(85e-6, 3.0), None);
        assert_eq!(loaded(85e-6, 3.1), DRIVE);
        assert_eq!(loaded(85e-6, -3.1), None);
        assert_eq!(loaded(-85e-6, -3.1), Some(Flank::Back));
    }

    #[test]
    fn loaded_flank_by_force_needs_steady_force() {
        let uncertainty = uncertainty(false);
        let loaded =
            |steady, force| loaded_flank(&evidence(&uncertainty, 0.0, force), &interval(steady), &learner(), 0.0);
        assert_eq!(loaded(4.1, 2.1), DRIVE);
        assert_eq!(loaded(3.9, 2.1), None);
        assert_eq!(loaded(4.1, 1.9), None);
        assert_eq!(loaded(4.1, -2.1), None);
    }

    #[test]
    fn shortest_contact_depends_on_half_gap() {
        assert_eq!(shortest_contact(&uncertainty(true), &learner()), FLANK.shortest_contact);
        assert_eq!(shortest_contact(&uncertainty(false), &learner()), 4, "half of 8 intervals");
    }
}
