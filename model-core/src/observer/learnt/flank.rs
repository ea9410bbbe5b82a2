//! On which flank teeth rest, as far as it is told for learning. In their order; the first that tells it decides:
//!
//! | # | told by | needs | why it is there | needed by |
//! |---|---|---|---|---|
//! | 1 | [`settled`] contact, by deflection and force | the half-gap | the surest: what says the flank is not what says the force | `observer learning::teeth_that_touch_a_flank_for_some_milliseconds_on_their_way_show_the_width` |
//! | 2 | [`settled`] contact, by the steady force | force above bias and ripple | all there is before the half-gap is known | `compensation holding::without_any_friction_a_gap_that_is_not_known_yet_is_learnt_from_the_first_soft_touches` |
//! | 3 | [`loaded`] contact that has not settled | force above noise, twice | a link thrown to and fro never settles; one flank next to the other tells the half-gap | `compensation width::steps_between_two_places_show_the_width` |
//! | 4 | the change of the deflection since the last rest ([`LastRest::flank`]) | a crossing beyond noise, a force on that side | where bias hides the sign of a light force | `observer learning::teeth_that_touch_a_flank_for_some_milliseconds_on_their_way_show_the_width` |
//! | 5 | motor and link moving together ([`CoMotion::flank`]) | a crossing, and a link that has left its course since | where there is no force at all | `observer learning::a_joint_that_hardly_feels_its_load_shows_the_width_by_where_its_link_goes` |
//!
//! Where none tells it, a rest teaches only what does not depend on the flank.
//!
//! [`LastRest::flank`]: super::last_rest::LastRest::flank
//! [`CoMotion::flank`]: super::co_motion::CoMotion::flank

use super::interval::Interval;
use super::uncertainty::Uncertainty;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::contact::by_force::with_hysteresis;
use crate::observer::contact::by_position::ByPosition;
use crate::observer::tables::LearnerTable;

/// Intervals of a touch that ended early from which it is learnt, once the half-gap is known: one is mostly landing.
const SHORTEST_TOUCH: u8 = 2;

/// Standard deviations of one deflection's noise by which a force that changes may move the deflection while its estimate
/// lags behind.
const LAGGING: i32 = 4;

/// Standard deviations of the steady force above which contact is loaded that no deflection confirms yet.
const UNCONFIRMED: i32 = 4;

/// What an interval has to tell the flank by.
#[derive(Debug, Clone, Copy)]
pub struct Signs<'now, T: Real> {
    /// How uncertain it is.
    pub uncertainty: &'now Uncertainty<T>,
    /// Where the mean deflection is in the gap.
    pub position: ByPosition<T>,
    /// Mean mesh force [N].
    pub force: T,
    /// From sun to link [m/N].
    pub compliance: T,
}

/// The flank on which contact has settled in an interval of rest, by deflection and force where the half-gap is known and
/// both encoders are `seen`, else by the steady force.
pub fn settled<T: Real>(signs: &Signs<'_, T>, interval: &Interval<T>, seen: bool) -> Option<Flank> {
    let uncertainty = signs.uncertainty;
    if uncertainty.half_gap_is_known && seen {
        let (contact, _) = signs.position.contact(None, signs.force, uncertainty.both_deviation);
        return contact;
    }
    // A flank that nothing has left since takes less to be believed.
    let twice = T::TWO * uncertainty.steady_force_deviation;
    let thrice = twice + uncertainty.steady_force_deviation;
    let needed = |flank| if interval.flank == Some(flank) { twice } else { thrice };
    if interval.steady > needed(Flank::Drive) {
        Some(Flank::Drive)
    } else if -interval.steady > needed(Flank::Back) {
        Some(Flank::Back)
    } else {
        None
    }
}

/// The flank on which teeth are pressed together by more than any bias, at rest or not, while the force does not change so
/// fast that the lag of its estimate would matter; the force rises by `rise` in an interval [N]. Once the half-gap is known,
/// the deflection has to agree.
pub fn loaded<T: Real>(
    signs: &Signs<'_, T>,
    interval: &Interval<T>,
    table: &LearnerTable<T>,
    rise: T,
) -> Option<Flank> {
    let uncertainty = signs.uncertainty;
    let lags = rise.abs() * signs.compliance * table.force_lag;
    if lags > T::from_i32(LAGGING) * table.noise {
        return None;
    }
    if !uncertainty.half_gap_is_known {
        return loaded_by_force(signs, interval);
    }
    if signs.force.abs() <= T::THREE * uncertainty.mean_force_deviation {
        return None;
    }
    let (contact, _) = signs.position.contact(None, signs.force, uncertainty.both_deviation);
    contact.filter(|flank| flank.sign::<T>() * signs.force > T::ZERO)
}

/// The flank that an interval's force tells alone. Motors that are held coarsely shake more from interval to interval than
/// teeth press that meet softly, so it takes the steady force to be sure; that lags, so the present one has to agree.
fn loaded_by_force<T: Real>(signs: &Signs<'_, T>, interval: &Interval<T>) -> Option<Flank> {
    let uncertainty = signs.uncertainty;
    let told = |force: T, least: T| with_hysteresis(None, force, least, least);
    let steadily = told(interval.steady, T::from_i32(UNCONFIRMED) * uncertainty.steady_force_deviation);
    let now = told(signs.force, T::TWO * uncertainty.mean_force_deviation);
    if steadily == now { now } else { None }
}

/// Intervals of a touch that ended early from which it is learnt. Until the half-gap is known, half a block of rest counts
/// too: a link that is thrown to and fro rests no longer than that on a flank.
pub fn shortest_touch<T: Real>(uncertainty: &Uncertainty<T>, table: &LearnerTable<T>) -> u8 {
    if uncertainty.half_gap_is_known { SHORTEST_TOUCH } else { (table.block as u8).div_ceil(2) }
}
