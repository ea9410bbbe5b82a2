//! Both sides put together in one control period, before anything is decided: the deflection between motor and link with
//! everything taken out that was learnt, and the mesh force.

use super::Learnt;
use super::bias::Bias;
use super::regressors::{MAPPED, OFFSET, SKEW};
use crate::numbers::Real;
use crate::observer::filters::Filters;
use crate::observer::sensors::Sensors;
use crate::observer::tables::ObserverTables;

/// What one period comes to before anything is decided.
#[derive(Debug, Clone, Copy)]
pub struct Fused<T: Real> {
    /// By how much the transmission error shifts both flanks now [m].
    pub flank_shift: T,
    /// Motor less ratio times link along the line of action, as measured [m].
    pub measured: T,
    /// The same with everything taken out that was learnt, wind-up left in [m].
    pub deflection: T,
    /// Rate of either [m/s].
    pub rate: T,
    /// How far the deflection goes on while what is measured lags behind, where that is more than noise [m].
    pub travel: T,
    /// Force that the motor loses, friction and bias included [N].
    pub lost: T,
    /// Direction of the motor's dry friction, from -1 to 1.
    pub direction: T,
    /// Mesh force from the motor side [N].
    pub force: T,
}

impl<T: Real> Fused<T> {
    /// Puts the two sides together.
    #[inline]
    pub fn new<const P: usize>(
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        learnt: &Learnt<T, P>,
        both_encoders: bool,
    ) -> Self {
        let levers = &tables.levers;
        let (drive, load) = (&filters.drive, &filters.load);
        let (_, difference) = sensors.counts.used();
        let flank_shift = learnt.transmission_error(&learnt.errors.mesh);
        let measured = tables.counts.length * small(difference) + levers.sun * drive.ahead - levers.output * load.ahead;
        let lost = drive.taken * levers.per_sun;
        let direction = Bias::direction(&tables.contact, drive.speed);
        let net = lost - learnt.bias.at(direction);
        // Losses in proportion to the load are friction too: they take from what drives and add to what holds back.
        let loss = if net * direction > T::ZERO { tables.contact.loss_driving } else { tables.contact.loss_driven };
        let force = net + net * direction.abs() * loss;
        let rate = levers.sun * drive.speed - levers.output * load.speed;
        let travel = if rate.abs() > tables.contact.rate_deviation { rate * tables.contact.lag } else { T::ZERO };
        let link_speed = if both_encoders { load.speed } else { T::ZERO };
        let deflection = measured - beside_teeth(learnt, link_speed);
        Self { flank_shift, measured, rate, travel, deflection, lost, direction, force }
    }

    /// Deflection of the teeth, wind-up left in: zero in the middle of the gap [m].
    pub fn of_teeth(&self) -> T {
        self.deflection - self.flank_shift
    }
}

/// Deflection that everything but the teeth makes now [m].
fn beside_teeth<T: Real, const P: usize>(learnt: &Learnt<T, P>, link_speed: T) -> T {
    let plain = learnt.learner.value(OFFSET) + learnt.learner.value(SKEW) * link_speed;
    if P == MAPPED { plain + learnt.errors.errors[0] + learnt.errors.errors[1] } else { plain }
}

/// A difference of counts, which teeth keep small, as a number: wide whole numbers take a chip without them long to turn.
pub fn small<T: Real>(difference: i64) -> T {
    let narrow = difference as i32;
    T::from_i32(if i64::from(narrow) == difference {
        narrow
    } else if difference < 0 {
        i32::MIN
    } else {
        i32::MAX
    })
}
