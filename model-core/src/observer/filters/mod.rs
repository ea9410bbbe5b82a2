//! The filters: two disturbance observers that share nothing but the torque between them. The motor side says what torque
//! meshes and friction take from the motor, the load side where the link is, how fast it turns and what brakes it.

mod delayed;
pub mod drive_side;
pub mod load_side;

use drive_side::DriveSide;
use load_side::LoadSide;

use super::sensors::counts::Advance;
use super::sensors::latency::Freshness;
use super::sensors::{Sensed, seconds};
use crate::numbers::Real;
use crate::observer::tables::{LoadTable, ObserverTables};

/// Both sides, and what joins them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Filters<T: Real> {
    pub drive: DriveSide<T>,
    pub load: LoadSide<T>,
    /// Torque that the meshes put on the load side, as the motor side says [N m].
    pub mesh_torque: T,
}

/// What is known of the link's place without its encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadCorrection<T: Real> {
    /// Nothing.
    None,
    /// It is further by so much [rad], and turns with the motor.
    TurnsWithMotor(T),
    /// It is further by so much, in loaded contact [rad].
    InContact(T),
}

impl<T: Real> Filters<T> {
    /// Both sides over one period, and the motor side's correction by its reading.
    #[inline(always)]
    pub fn step(&mut self, tables: &ObserverTables<T>, sensed: &Sensed<T>, motor_used: bool) {
        self.drive.predict(&tables.drive, &tables.current, sensed.command, sensed.motor_turned);
        match sensed.motor {
            Advance::By(_) if motor_used => {
                let age = seconds(&tables.clock, sensed.motor_age);
                match sensed.freshness {
                    Freshness::Fresh => self.drive.correct(&tables.drive, age),
                    Freshness::Late => self.drive.correct_late(&tables.drive, age),
                    Freshness::Lost | Freshness::LostForLong | Freshness::Unusable => {}
                }
            }
            Advance::Began => self.drive.ahead = T::ZERO,
            Advance::By(_) | Advance::Implausible | Advance::Jumped(_) => {}
        }
        self.load.predict(&tables.load, self.mesh_torque, sensed.output_turned);
    }

    /// The motor side after its encoder was not used: it goes on by so many counts in a period. A link that nobody sees goes with
    /// it.
    #[cold]
    pub fn find_motor(&mut self, tables: &ObserverTables<T>, counts: T, both_encoders: bool) {
        self.drive.speed = (counts * tables.counts.motor.angle).over(tables.period);
        if !both_encoders {
            self.load.ahead = T::ZERO;
            self.load.speed = self.drive.speed * tables.levers.per_ratio;
        }
    }

    /// The load side's correction by the output's reading of this period.
    #[inline]
    pub fn correct_load(&mut self, tables: &ObserverTables<T>, sensed: &Sensed<T>) {
        self.load.correct(&tables.load, seconds(&tables.clock, sensed.output_age), self.mesh_torque);
    }

    /// The load side's correction without the output encoder.
    pub fn correct_unseen_load(&mut self, table: &LoadTable<T>, correction: LoadCorrection<T>, per_ratio: T) {
        match correction {
            LoadCorrection::None => {}
            LoadCorrection::TurnsWithMotor(further) => {
                self.load.ahead += further;
                self.load.speed = self.drive.speed * per_ratio;
            }
            LoadCorrection::InContact(innovation) => self.load.apply(&table.motor_only_gain, innovation),
        }
    }
}
