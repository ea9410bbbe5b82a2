//! A tick of the sharp dead zone: by exponential while its contact set holds, otherwise in sub-steps. A tick in
//! sub-steps ends with laws and accelerations from which the next one goes on, so that only the first of several pays
//! for looking at its start. Light planets are stepped elsewhere (`light`).

use crate::gears::contact::Drive;
use crate::gears::excitation::{Beat, MeshPhase};
use crate::gears::flow::{self, Held};
use crate::gears::frozen::{Frozen, Start};
use crate::gears::runge_kutta::Motion;
use crate::gears::stages::Course;
use crate::gears::substep;
use crate::gears::tables::Tables;
use crate::numbers::Real;
use parameters::DampingLaw;

/// What is known at the end of a tick beside position and rate. It can be forgotten at any time: the next tick then finds
/// it anew.
#[derive(Debug, Clone)]
pub struct Sharp<T, const N: usize> {
    start: Start<T, N>,
    course: Course<T, N>,
    /// Torques of the last tick, as accelerations of a stage.
    drive: Drive<T>,
    /// Whether laws, accelerations and torques are those of the end of the last tick.
    goes_on: bool,
}

impl<T: Real, const N: usize> Sharp<T, N> {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { start: Start::EMPTY, course: Course::EMPTY, drive: Drive::NONE, goes_on: false };

    /// The motion was changed from outside.
    pub fn forget(&mut self) {
        self.goes_on = false;
    }

    /// One tick. Ripple of one harmonic has a copy of its own, which need not ask at every mesh whether there are more.
    pub fn tick<const OVERTONES: usize>(
        &mut self,
        tables: &Tables<T, N>,
        drive: &Drive<T>,
        phase: &MeshPhase<T>,
        motion: &Motion<T, N>,
    ) -> Motion<T, N> {
        let stage = &tables.stage;
        let pushes_only = if tables.damping_law == DampingLaw::Contact { T::ONE } else { T::ZERO };
        let frozen = Frozen::<T, N, OVERTONES> {
            tables,
            drive: drive.times(stage.square_sixth),
            pushes_only,
            adheres: T::ONE - pushes_only,
        };
        let Self { start, course, .. } = self;
        course.place(motion, tables.substep);
        if self.goes_on && start.is_open() {
            course.pushed(&frozen.drive.less(&self.drive), &stage.mobility);
        } else {
            self.goes_on = false;
            let rate = tables.substep * phase.rate;
            frozen.start(&Beat::new(phase.start, rate, tables.excitation.harmonics), course, start);
            let held = if tables.mobility.wind_up > T::ZERO {
                flow::hold::<T, N, 3, OVERTONES>(&frozen, drive, phase, start, course, motion)
            } else {
                flow::hold::<T, N, 2, OVERTONES>(&frozen, drive, phase, start, course, motion)
            };
            match held {
                Held::Whole(end) => return end,
                Held::Late(end) => return flow::corrected(&frozen, &mut start.laws, phase, &end),
                Held::Not => {}
            }
            substep::begin(&frozen, start, phase, course);
        }
        substep::advance(&frozen, phase, &mut start.laws, course);
        (self.drive, self.goes_on) = (frozen.drive, true);
        course.motion(tables.substep, stage.rate, motion)
    }
}
