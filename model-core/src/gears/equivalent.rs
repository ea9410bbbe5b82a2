//! A tick of an equivalent gear: two masses and one contact, whose motion is linear while the contact stays as it is. A
//! tick in which it does is taken whole, by the exponential flow or as free flight. Where it changes, the moment is found
//! and the rest of the tick goes on from there: once for a flank that is met, and for one that is left also for the next
//! that is met. A change beyond these waits for the next tick.
//!
//! In dimensionless time the contact's stiffness is one: y'' = a - y - c y' for the overlap y and the acceleration a by
//! the torques. The contact presses while y > 0 and y + c y' > 0, so that it never pulls.

use crate::gears::tables::Tables;
use crate::numbers::Real;

/// Rows and columns of the gap and of its rate in the in-phase flow.
const GAP: usize = 1;
const RATE: usize = 4;

/// How far motor and link are apart, or an overlap on a flank; and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point<T> {
    /// Motor less link on the line of action.
    pub position: T,
    /// Its rate.
    pub rate: T,
}

impl<T: Real> Point<T> {
    fn plus(self, change: Self) -> Self {
        Self { position: self.position + change.position, rate: self.rate + change.rate }
    }

    /// The same seen from the other side, `way` from there.
    fn mirrored(self, way: T) -> Self {
        Self { position: -(self.position + way), rate: -self.rate }
    }
}

/// One flank under torques that hold over the tick: overlap, rate and acceleration are positive into it.
#[derive(Clone, Copy)]
struct Flank<T> {
    damping: T,
    /// Acceleration by the torques: the overlap in which the contact would rest.
    pull: T,
}

/// One tick, with the acceleration of the gap by the torques.
#[inline]
pub fn tick<T: Real, const N: usize>(tables: &Tables<T, N>, acceleration: T, start: Point<T>) -> Point<T> {
    let half = tables.meshes[0].first().map_or(T::ZERO, |mesh| T::TWO * mesh.half_backlash);
    let side = if start.position < T::ZERO { -T::ONE } else { T::ONE };
    let pull = side * acceleration;
    let flank = Flank { damping: tables.springs[0].damping, pull };
    let overlap = Point { position: side * start.position - half, rate: side * start.rate };
    let moved = if flank.is_pressed(overlap) {
        flank.pressed(tables, overlap, T::TWO * half)
    } else {
        let gap = T::TWO * half;
        let whole = tables.flow.step;
        let moved = flank.free(overlap, whole);
        flank.meeting(overlap, moved, whole, gap)
    };
    Point { position: start.position + side * moved.position, rate: start.rate + side * moved.rate }
}

impl<T: Real> Flank<T> {
    /// Force of a contact that may also pull.
    #[inline(always)]
    fn line(&self, at: Point<T>) -> T {
        at.position + self.damping * at.rate
    }

    #[inline(always)]
    fn is_pressed(&self, at: Point<T>) -> bool {
        at.position > T::ZERO && self.line(at) > T::ZERO
    }

    /// Way and gain of speed in free flight.
    #[inline(always)]
    fn free(&self, at: Point<T>, time: T) -> Point<T> {
        let gained = self.pull * time;
        Point { position: time * (at.rate + T::HALF * gained), rate: gained }
    }

    /// A tick that begins in contact, with `gap` between this flank and the other.
    #[inline(always)]
    fn pressed<const N: usize>(&self, tables: &Tables<T, N>, at: Point<T>, gap: T) -> Point<T> {
        let flow = &tables.flow.whole.in_phase.0;
        let beyond = at.position - self.pull;
        let over = |row| flow[(row, GAP)] * beyond + flow[(row, RATE)] * at.rate;
        let moved = Point { position: over(GAP), rate: over(RATE) };
        let (line, change) = (self.line(at), self.line(moved));
        if line + change >= T::ZERO {
            return moved;
        }
        // It parts where the force line, as a parabola, falls through zero. There the force is zero, so that a moment that is a
        // little wrong matters in its square only.
        let whole = tables.flow.step;
        let slope = whole * (at.rate + self.damping * (self.pull - line));
        let part = whole * first_rise(-line, -change, slope - change);
        let held = self.held(at, part);
        let (parted, left) = (at.plus(held), whole - part);
        held.plus(self.meeting(parted, self.free(parted, left), left, gap))
    }

    /// Free flight that would move by `moved` in the time left, with whatever flank it meets.
    #[inline(always)]
    fn meeting(&self, at: Point<T>, moved: Point<T>, left: T, gap: T) -> Point<T> {
        let end = at.plus(moved);
        if self.is_pressed(end) {
            return self.landing(at, end, moved, left);
        }
        let (other, beyond) = (Self { pull: -self.pull, ..*self }, end.mirrored(gap));
        if other.is_pressed(beyond) {
            let moved = Point { position: -moved.position, rate: -moved.rate };
            let landed = other.landing(at.mirrored(gap), beyond, moved, left);
            return Point { position: -landed.position, rate: -landed.rate };
        }
        moved
    }

    /// Free flight up to the flank and contact from there on; without contact it would move by `moved` to `end`. It is met by
    /// the overlap, or where there is some already, by the force line.
    #[inline(always)]
    fn landing(&self, at: Point<T>, end: Point<T>, moved: Point<T>, left: T) -> Point<T> {
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

    /// Way and gain of speed of a part of a tick in contact. With A the matrix of the motion, exp(A t) - I is t A over
    /// 1 - A t / 2 + (A t)^2 / 12 up to the fifth order (Pade's approximation of orders two and two); A^2 = -1 - c A makes that
    /// two products. Its divisor is above 1/2 for every part of a tick that design allows.
    #[inline(always)]
    fn held(&self, at: Point<T>, time: T) -> Point<T> {
        let beyond = at.position - self.pull;
        let twelfth = T::HALF * T::SIXTH * time;
        let along = T::ONE - twelfth * time;
        let across = T::HALF * time + self.damping * twelfth * time;
        let scale = time.over(along * (along + self.damping * across) + across * across);
        let braking = beyond + self.damping * at.rate;
        Point {
            position: scale * (along * at.rate - across * beyond),
            rate: -(scale * (along * braking + across * at.rate)),
        }
    }
}

/// Share of the way at which start + rise s + curve s (s - 1), below zero at s = 0 and above it at s = 1, passes through
/// zero: where the chord does, and two of Newton's steps from there. Where the curve hardly rises they are held short.
#[inline(always)]
fn first_rise<T: Real>(start: T, rise: T, curve: T) -> T {
    if rise <= T::ZERO {
        return T::ONE;
    }
    let inverse = T::ONE.over(rise);
    let (chord, bend) = (-(start * inverse), curve * inverse);
    let step = |share: T| {
        let gradient = T::ONE + bend * (share + share - T::ONE);
        let left = share - chord + bend * share * (share - T::ONE);
        share - left.over(if gradient > T::QUARTER { gradient } else { T::QUARTER })
    };
    let share = step(step(chord));
    if share < T::ONE { share } else { T::ONE }
}

#[cfg(test)]
mod tests {
    use super::first_rise;

    #[test]
    fn a_parabola_s_way_through_zero_is_found_wherever_it_bends() {
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
