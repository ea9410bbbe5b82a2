//! Tick of an equivalent gear: two masses and one contact. The motion is linear while the contact state holds: one
//! exponential flow in contact, free flight in the gap. If the contact state changes, the time of the change is found and
//! the rest of the tick starts there. A tick that starts in the gap follows one change (a flank is met); a tick that starts
//! in contact follows two (the flank is left, the next is met). A further change waits for the next tick.
//!
//! In dimensionless time the contact has stiffness one: y'' = a - y - c y' for the overlap y and the acceleration a by
//! the torques (`pull`). The contact presses while y > 0 and y + c y' > 0, so that it never pulls.
//!
//! Equations: (E7), (E8), (E9) in docs/theory/equivalent-gear.md.

use crate::gears::tables::Tables;
use crate::numbers::Real;

/// Row and column of the gap, and of the gap's rate, in the in-phase flow.
const GAP: usize = 1;
const RATE: usize = 4;

/// Distance between motor and link, or overlap on a flank, and the rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapMotion<T> {
    /// Motor minus link on the line of action, or overlap.
    pub position: T,
    /// Rate of `position`.
    pub rate: T,
}

impl<T: Real> GapMotion<T> {
    fn plus(self, change: Self) -> Self {
        Self { position: self.position + change.position, rate: self.rate + change.rate }
    }

    /// Converts an overlap on one flank to the overlap on the opposite flank at the distance `way`.
    fn mirrored(self, way: T) -> Self {
        Self { position: -(self.position + way), rate: -self.rate }
    }
}

/// One flank under constant torques; overlap, rate and acceleration are positive into the flank.
#[derive(Clone, Copy)]
struct Flank<T> {
    damping: T,
    /// Acceleration by the torques, which equals the overlap at rest.
    pull: T,
}

/// Returns gap and rate after one tick; `acceleration` is the acceleration of the gap by the torques.
#[inline]
pub fn tick<T: Real, const N: usize>(tables: &Tables<T, N>, acceleration: T, start: GapMotion<T>) -> GapMotion<T> {
    let half = tables.meshes[0].first().map_or(T::ZERO, |mesh| T::TWO * mesh.half_backlash);
    let side = if start.position < T::ZERO { -T::ONE } else { T::ONE };
    let pull = side * acceleration;
    let flank = Flank { damping: tables.springs[0].damping, pull };
    let overlap = GapMotion { position: side * start.position - half, rate: side * start.rate };
    let moved = if flank.is_pressed(overlap) {
        flank.pressed(tables, overlap, T::TWO * half)
    } else {
        let gap = T::TWO * half;
        let whole = tables.flow.step;
        let moved = flank.free(overlap, whole);
        flank.meeting(overlap, moved, whole, gap)
    };
    GapMotion { position: start.position + side * moved.position, rate: start.rate + side * moved.rate }
}

impl<T: Real> Flank<T> {
    /// Returns the contact force without the condition that the contact never pulls.
    #[inline(always)]
    fn line(&self, at: GapMotion<T>) -> T {
        at.position + self.damping * at.rate
    }

    #[inline(always)]
    fn is_pressed(&self, at: GapMotion<T>) -> bool {
        at.position > T::ZERO && self.line(at) > T::ZERO
    }

    /// Returns the changes of position and rate in free flight.
    #[inline(always)]
    fn free(&self, at: GapMotion<T>, time: T) -> GapMotion<T> {
        let gained = self.pull * time;
        GapMotion { position: time * (at.rate + T::HALF * gained), rate: gained }
    }

    /// Returns the changes over a tick that begins in contact; `gap` is the distance to the opposite flank.
    #[inline(always)]
    fn pressed<const N: usize>(&self, tables: &Tables<T, N>, at: GapMotion<T>, gap: T) -> GapMotion<T> {
        let flow = &tables.flow.whole.in_phase.0;
        let beyond = at.position - self.pull;
        let over = |row| flow[(row, GAP)] * beyond + flow[(row, RATE)] * at.rate;
        let moved = GapMotion { position: over(GAP), rate: over(RATE) };
        let (line, change) = (self.line(at), self.line(moved));
        if line + change >= T::ZERO {
            return moved;
        }
        // The contact ends where the force, approximated by a parabola, falls through zero. Near this time the force is
        // small, so an error of the time acts only with its square.
        let whole = tables.flow.step;
        let slope = whole * (at.rate + self.damping * (self.pull - line));
        let part = whole * first_rise(-line, -change, slope - change);
        let held = self.held(at, part);
        let (parted, left) = (at.plus(held), whole - part);
        held.plus(self.meeting(parted, self.free(parted, left), left, gap))
    }

    /// Returns the changes over the time `left` in free flight, and in contact once a flank is met. `moved` is the change
    /// without contact.
    #[inline(always)]
    fn meeting(&self, at: GapMotion<T>, moved: GapMotion<T>, left: T, gap: T) -> GapMotion<T> {
        let end = at.plus(moved);
        if self.is_pressed(end) {
            return self.landing(at, end, moved, left);
        }
        let (other, beyond) = (Self { pull: -self.pull, ..*self }, end.mirrored(gap));
        if other.is_pressed(beyond) {
            let moved = GapMotion { position: -moved.position, rate: -moved.rate };
            let landed = other.landing(at.mirrored(gap), beyond, moved, left);
            return GapMotion { position: -landed.position, rate: -landed.rate };
        }
        moved
    }

    /// Returns the changes in free flight up to this flank and in contact afterwards. Without contact the motion would change
    /// by `moved` to `end`. Contact begins where the overlap becomes positive; if it already is, where the force does.
    #[inline(always)]
    fn landing(&self, at: GapMotion<T>, end: GapMotion<T>, moved: GapMotion<T>, left: T) -> GapMotion<T> {
        let curve = T::HALF * moved.rate * left;
        let share = if at.position < T::ZERO {
            first_rise(at.position, moved.position, curve)
        } else {
            let start = self.line(at);
            first_rise(start, self.line(end) - start, curve)
        };
        let time = share * left;
        let way = self.free(at, time);
        way.plus(self.held(at.plus(way), left - time))
    }

    /// Returns the changes of position and rate over a part of a tick in contact. With the matrix A of the motion, exp(A t) - I
    /// is t A over 1 - A t / 2 + (A t)^2 / 12, with an error of fifth order (Pade approximation [2/2]). A^2 = -1 - c A reduces
    /// the quotient to two products. The divisor exceeds 1/2 for every part of a tick that the design allows.
    #[inline(always)]
    fn held(&self, at: GapMotion<T>, time: T) -> GapMotion<T> {
        let beyond = at.position - self.pull;
        let twelfth = T::HALF * T::SIXTH * time;
        let along = T::ONE - twelfth * time;
        let across = T::HALF * time + self.damping * twelfth * time;
        let scale = time / (along * (along + self.damping * across) + across * across);
        let braking = beyond + self.damping * at.rate;
        GapMotion {
            position: scale * (along * at.rate - across * beyond),
            rate: -(scale * (along * braking + across * at.rate)),
        }
    }
}

/// Returns the s at which start + rise s + curve s (s - 1), negative at s = 0 and positive at s = 1, passes through zero:
/// the zero of the chord, refined by two Newton steps. A lower bound on the slope limits the steps.
#[inline(always)]
fn first_rise<T: Real>(start: T, rise: T, curve: T) -> T {
    if rise <= T::ZERO {
        return T::ONE;
    }
    let inverse = T::ONE / rise;
    let (chord, bend) = (-(start * inverse), curve * inverse);
    let step = |share: T| {
        let gradient = T::ONE + bend * (share + share - T::ONE);
        let left = share - chord + bend * share * (share - T::ONE);
        share - left / if gradient > T::QUARTER { gradient } else { T::QUARTER }
    };
    let share = step(step(chord));
    if share < T::ONE { share } else { T::ONE }
}

#[cfg(test)]
mod tests {
    use super::first_rise;

    #[test]
    fn zero_of_parabola_is_found() {
        for (start, rise, curve, error) in [(-1.0, 2.0, 0.0, 1e-15), (-0.3, 1.0, 0.2, 1e-7), (-0.7, 1.0, -0.4, 1e-5)] {
            let share: f64 = first_rise(start, rise, curve);
            let left = start + rise * share + curve * share * (share - 1.0);
            assert!((0.0..=1.0).contains(&share) && left.abs() < error, "{start} {rise} {curve}: {share}, {left}");
        }
    }

    #[test]
    fn nothing_is_divided_by_zero() {
        for (start, rise, curve) in [(0.0, 0.0, 0.0), (-1.0, 0.0, 1.0), (-1e-9, 1.0, -1e9), (-1.0, 2.0, 1e9)] {
            let share: f64 = first_rise(start, rise, curve);
            assert!(share.is_finite() && share <= 1.0, "{start} {rise} {curve}: {share}");
        }
    }
}
