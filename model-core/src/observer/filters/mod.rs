//! Filters of motor side and load side: two disturbance observers, coupled by the mesh torque alone. The motor side
//! (O2, O3) estimates the torque taken by meshes and friction; the load side (O4) estimates angle, speed and load
//! torque of the link.

mod delayed;
pub mod drive_side;
pub mod load_side;

pub(super) mod thresholds;

use drive_side::DriveSide;
use load_side::LoadSide;

use super::sensors::counts::CountChange;
use super::sensors::latency::SampleAge;
use super::sensors::{SensorReadings, seconds};
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::{LoadTable, ObserverTables};

/// Filters of both sides and the torque that couples them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Filters<T: Real> {
    pub drive: DriveSide<T>,
    pub load: LoadSide<T>,
    /// Mesh torque acting on the load side, estimated by the motor side [N m].
    pub mesh_torque: T,
}
state_words! { struct Filters<T> { drive, load, mesh_torque } }

/// Correction of the link's state without its encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadCorrection<T: Real> {
    /// No correction.
    None,
    /// Adds an angle to the link [rad] and sets the link to the motor's speed.
    TurnsWithMotor(T),
    /// Corrects by an innovation in loaded contact [rad].
    InContact(T),
}

impl<T: Real> Filters<T> {
    /// Predicts both sides over one period and corrects the motor side by its reading.
    #[inline(always)]
    pub fn step(&mut self, tables: &ObserverTables<T>, readings: &SensorReadings<T>, motor_used: bool) {
        self.drive.predict(&tables.drive, &tables.current, readings.command, readings.motor_travel);
        match readings.motor {
            CountChange::By(_) if motor_used => {
                let age = seconds(&tables.clock, readings.motor_age);
                match readings.motor_sample_age {
                    SampleAge::Fresh => self.drive.correct(&tables.drive, age),
                    SampleAge::Late => self.drive.correct_late(&tables.drive, age),
                    SampleAge::Repeated | SampleAge::RepeatedForLong | SampleAge::Unusable => {}
                }
            }
            CountChange::First => self.drive.angle_residual = T::ZERO,
            CountChange::By(_) | CountChange::Implausible | CountChange::Jumped(_) => {}
        }
        self.load.predict(&tables.load, self.mesh_torque, readings.output_travel);
    }

    /// Restarts the motor side when its encoder is readmitted; `counts` is the motor's travel in a period. Without an
    /// output encoder the link gets the motor's speed.
    #[cold]
    pub fn restart_motor_side(&mut self, tables: &ObserverTables<T>, counts: T, both_encoders: bool) {
        self.drive.speed = (counts * tables.counts.motor.angle) / tables.period;
        if !both_encoders {
            self.load.angle_residual = T::ZERO;
            self.load.speed = self.drive.speed * tables.levers.per_ratio;
        }
    }

    /// Corrects the load side by the output reading of this period.
    #[inline]
    pub fn correct_load(&mut self, tables: &ObserverTables<T>, readings: &SensorReadings<T>) {
        self.load.correct(&tables.load, seconds(&tables.clock, readings.output_age), self.mesh_torque);
    }

    /// Corrects the load side without an output encoder.
    pub fn correct_unseen_load(&mut self, table: &LoadTable<T>, correction: LoadCorrection<T>, per_ratio: T) {
        match correction {
            LoadCorrection::None => {}
            LoadCorrection::TurnsWithMotor(angle) => {
                self.load.angle_residual += angle;
                self.load.speed = self.drive.speed * per_ratio;
            }
            LoadCorrection::InContact(innovation) => self.load.apply(&table.motor_only_gain, innovation),
        }
    }
}
