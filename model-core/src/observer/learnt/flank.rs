//! Flank of resting teeth, as estimation needs it. The first row that holds decides:
//!
//! | # | evidence | needs | purpose | needed by |
//! |---|---|---|---|---|
//! | 1 | [`settled`] contact, by deflection and force | the half-gap | most reliable: deflection and force come from independent sensors | `observer learning::brief_contact_reveals_the_width` |
//! | 2 | [`settled`] contact, by the steady force | force above bias and ripple | the only evidence before the half-gap is known | `compensation holding::free_hold_learns_unknown_gap` |
//! | 3 | [`loaded`] contact that has not settled | force above noise in two intervals | a link thrown to and fro never settles; two successive flanks show the half-gap | `compensation width::steps_reveal_the_width` |
//! | 4 | change of the deflection since the last rest ([`LastRest::flank`]) | a crossing above noise, a force on that side | bias hides the sign of a light force | `observer learning::brief_contact_reveals_the_width` |
//! | 5 | common motion of motor and link ([`CoMotion::flank`]) | a crossing, and a link that has left its course since | contact without any force | `observer learning::link_travel_reveals_the_width` |
//!
//! If no row holds, a rest updates only parameters that do not depend on the flank.
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

/// Shortest touch that updates the parameters once the half-gap is known [intervals]: the first interval is mostly
/// landing.
const SHORTEST_TOUCH: u8 = 2;

/// Largest deflection by the lag of the force estimate, in standard deviations of one deflection's noise.
const LAGGING: i32 = 4;

/// Standard deviations of the steady force above which contact is loaded without confirmation by the deflection.
const UNCONFIRMED: i32 = 4;

/// Evidence of an interval on the flank.
#[derive(Debug, Clone, Copy)]
pub struct Signs<'now, T: Real> {
    /// Variances of the parameters and of the force.
    pub uncertainty: &'now Uncertainty<T>,
    /// Position of the mean deflection in the gap.
    pub position: ByPosition<T>,
    /// Mean mesh force [N].
    pub force: T,
    /// Compliance from sun to link [m/N].
    pub compliance: T,
}

/// Flank of settled contact in an interval of rest: by deflection and force once the half-gap is known and both
/// encoders are `seen`, otherwise by the steady force.
pub fn settled<T: Real>(signs: &Signs<'_, T>, interval: &Interval<T>, seen: bool) -> Option<Flank> {
    let uncertainty = signs.uncertainty;
    if uncertainty.half_gap_is_known && seen {
        let (contact, _) = signs.position.contact(None, signs.force, uncertainty.both_deviation);
        return contact;
    }
    // The flank of the last settled contact needs less force while the teeth have not left it.
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

/// Flank on which the mesh force exceeds any bias, at rest or not, while the force changes too slowly for the lag of
/// its estimate to matter; the force rises by `rise` in an interval [N]. Once the half-gap is known, the deflection has
/// to agree.
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

/// Flank by force alone. Coarsely controlled motors shake more between intervals than soft landings press, so that the
/// steady force must exceed its threshold; the steady force lags, so that the present force has to agree.
fn loaded_by_force<T: Real>(signs: &Signs<'_, T>, interval: &Interval<T>) -> Option<Flank> {
    let uncertainty = signs.uncertainty;
    let told = |force: T, least: T| with_hysteresis(None, force, least, least);
    let steadily = told(interval.steady, T::from_i32(UNCONFIRMED) * uncertainty.steady_force_deviation);
    let now = told(signs.force, T::TWO * uncertainty.mean_force_deviation);
    if steadily == now { now } else { None }
}

/// Shortest touch that updates the parameters [intervals]. Until the half-gap is known, half a block of rest suffices:
/// a link that is thrown to and fro rests no longer on a flank.
pub fn shortest_touch<T: Real>(uncertainty: &Uncertainty<T>, table: &LearnerTable<T>) -> u8 {
    if uncertainty.half_gap_is_known { SHORTEST_TOUCH } else { (table.block as u8).div_ceil(2) }
}
