//! Forces of the meshes (eqs 4-6, with the dead zones of eqs 12 and 13) and the accelerations by mesh forces and torques (eqs 1-3). Time
//! stepping is in the schemes.

use model_core::numbers::Real;

use crate::instant::Instant;
use crate::motion::Coordinates;
use crate::plant::Plant;

/// Accelerations by the torques.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push<T> {
    /// Acceleration of the sun.
    pub sun: T,
    /// Acceleration of the carrier.
    pub carrier: T,
    /// Acceleration of the link.
    pub link: T,
}

/// Force law, selected at compile time.
pub trait ForceLaw<T: Real> {
    /// True if teeth only push: damping ends with contact.
    const PUSHES_ONLY: bool;

    /// Force of a mesh from its deflection and rate.
    fn force(spring: &Spring<T>, deflection: T, rate: T) -> T;

    /// Force less the damping of the displacement's speed, from deflection, speed and rate of the error.
    #[inline(always)]
    fn force_less_damping(spring: &Spring<T>, deflection: T, speed: T, error_rate: T) -> T {
        Self::force(spring, deflection, speed - error_rate) - spring.damping * speed
    }
}

/// Parameters of a mesh at an instant.
pub struct Spring<T> {
    /// Stiffness.
    pub stiffness: T,
    /// Damping.
    pub damping: T,
    /// Half-backlash.
    pub half_backlash: T,
    /// Sharpness of the tanh dead zone.
    pub sharpness: T,
}

/// Law of [`crate::plant::Law::Always`].
pub struct Always;
/// Law of [`crate::plant::Law::Push`].
pub struct PushOnly;
/// Law of [`crate::plant::Law::Smooth`].
pub struct Smooth;
/// Law of [`crate::plant::Law::SmoothPush`].
pub struct SmoothPush;

impl<T: Real> ForceLaw<T> for Always {
    const PUSHES_ONLY: bool = false;

    #[inline(always)]
    fn force_less_damping(spring: &Spring<T>, deflection: T, _: T, error_rate: T) -> T {
        Self::force(spring, deflection, -error_rate)
    }

    #[inline(always)]
    fn force(spring: &Spring<T>, deflection: T, rate: T) -> T {
        let damping = spring.damping * rate;
        if deflection > spring.half_backlash {
            spring.stiffness * (deflection - spring.half_backlash) + damping
        } else if deflection < -spring.half_backlash {
            spring.stiffness * (deflection + spring.half_backlash) + damping
        } else {
            damping
        }
    }
}

impl<T: Real> ForceLaw<T> for PushOnly {
    const PUSHES_ONLY: bool = true;

    #[inline(always)]
    fn force(spring: &Spring<T>, deflection: T, rate: T) -> T {
        if deflection > spring.half_backlash {
            let force = spring.stiffness * (deflection - spring.half_backlash) + spring.damping * rate;
            if force > T::ZERO { force } else { T::ZERO }
        } else if deflection < -spring.half_backlash {
            let force = spring.stiffness * (deflection + spring.half_backlash) + spring.damping * rate;
            if force < T::ZERO { force } else { T::ZERO }
        } else {
            T::ZERO
        }
    }
}

impl<T: Real> ForceLaw<T> for Smooth {
    const PUSHES_ONLY: bool = false;

    #[inline(always)]
    fn force(spring: &Spring<T>, deflection: T, rate: T) -> T {
        spring.stiffness * smooth(spring, deflection).0 + spring.damping * rate
    }
}

impl<T: Real> ForceLaw<T> for SmoothPush {
    const PUSHES_ONLY: bool = true;

    #[inline(always)]
    fn force(spring: &Spring<T>, deflection: T, rate: T) -> T {
        let (overlap, closed) = smooth(spring, deflection);
        let force = spring.stiffness * overlap + closed * spring.damping * rate;
        let pulls = if deflection < T::ZERO { force > T::ZERO } else { force < T::ZERO };
        if pulls { T::ZERO } else { force }
    }
}

/// Overlap by eq. 13, and degree of contact between 0 and 1. Eq. 13 is odd: with y = |x| the tanh of the farther flank is almost always
/// one, so that one tanh remains.
#[inline(always)]
fn smooth<T: Real>(spring: &Spring<T>, deflection: T) -> (T, T) {
    let negative = deflection < T::ZERO;
    let distance = if negative { -deflection } else { deflection };
    let near = rational_tanh(spring.sharpness * (distance - spring.half_backlash));
    let far = rational_tanh(spring.sharpness * (distance + spring.half_backlash));
    let parted = T::HALF * (far - near);
    let overlap = distance - distance * parted - T::HALF * spring.half_backlash * (near + far);
    (if negative { -overlap } else { overlap }, T::ONE - parted)
}

/// tanh by Lambert's continued fraction to seven terms, clamped where it reaches one: error at most 1e-4, a small part of the corner error
/// of eq. 13.
#[inline(always)]
fn rational_tanh<T: Real>(x: T) -> T {
    let limit = T::from_f64(4.97);
    if x >= limit {
        return T::ONE;
    }
    if x <= -limit {
        return -T::ONE;
    }
    let square = x * x;
    let number = T::from_f64;
    let above = number(135_135.0) + square * (number(17_325.0) + square * (number(378.0) + square));
    let below = number(135_135.0) + square * (number(62_370.0) + square * (number(3_150.0) + square * number(28.0)));
    (x * above) / below
}

/// Accelerations of the coordinates.
#[inline(always)]
pub fn acceleration<T: Real, const N: usize, L: ForceLaw<T>, const COMPLIANT: bool>(
    plant: &Plant<T, N>,
    push: &Push<T>,
    now: &Instant<T, N>,
    position: &Coordinates<T, N>,
    rate: &Coordinates<T, N>,
) -> Coordinates<T, N> {
    let mesh = |kind: usize, i: usize, position: T, rate: T| {
        let spring = Spring {
            stiffness: now.stiffness[kind][i],
            damping: plant.damping[kind],
            half_backlash: plant.meshes[kind][i].half_backlash,
            sharpness: plant.sharpness,
        };
        L::force(&spring, position - now.error[kind][i], rate - now.error_rate[kind][i])
    };
    let (mut sun_sum, mut ring_sum) = (T::ZERO, T::ZERO);
    let mut planets = [T::ZERO; N];
    for i in 0..N {
        let sun = mesh(0, i, position.planets[i], rate.planets[i]);
        let ring = mesh(1, i, position.gap - position.planets[i], rate.gap - rate.planets[i]);
        sun_sum += sun;
        ring_sum += ring;
        planets[i] = plant.planet * (sun - ring);
    }
    let sun = push.sun - plant.sun * sun_sum;
    let (mut carrier_force, mut wind_up) = (sun_sum + ring_sum, T::ZERO);
    if COMPLIANT {
        wind_up = plant.wind_up[0] * position.wind_up + plant.wind_up[1] * rate.wind_up;
        carrier_force -= wind_up;
    }
    let carrier = push.carrier + plant.carrier * carrier_force;
    let apart = sun - carrier;
    for planet in &mut planets {
        *planet = apart - *planet;
    }
    let wind_up = if COMPLIANT { carrier - (push.link + plant.link * wind_up) } else { T::ZERO };
    Coordinates { planets, gap: apart - carrier, wind_up }
}
