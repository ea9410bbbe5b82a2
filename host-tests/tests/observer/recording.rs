//! Measurements of a run with the truth, for an observer that runs over them later.

use scenario::rig::{ActiveController, Period, Rig};
use scenario::set_point_source::SetPointSource;

/// One control period: measurements and truth at its end.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PeriodSample {
    /// Command during the period [N m].
    pub command: f64,
    /// Motor encoder at the end, from its own zero, with whole turns.
    pub motor_counts: i64,
    /// Output encoder at the end, from its own zero, with whole turns.
    pub output_counts: i64,
    /// True gap coordinate [m].
    pub gap: f64,
    /// True net sun mesh force [N].
    pub sun_force: f64,
    /// True torque that brakes the link [N m].
    pub load_torque: f64,
    /// True angle and speed of the link [rad, rad/s].
    pub link: [f64; 2],
    /// True angle and speed of the motor [rad, rad/s].
    pub motor: [f64; 2],
}

impl PeriodSample {
    /// Sample at the end of a period.
    pub fn at_end_of(period: &Period<'_>) -> Self {
        let (measurement, joint) = (period.plant.measure(), period.plant.joint());
        Self {
            command: period.command,
            motor_counts: measurement.motor_counts,
            output_counts: measurement.output_counts,
            gap: joint.gap,
            sun_force: joint.sun_force(),
            load_torque: period.load_torque(),
            link: [joint.link_angle, joint.link_speed],
            motor: [joint.motor_angle, joint.motor_speed],
        }
    }
}

/// Runs the loop of a rig and records measurements and truth.
pub fn record(rig: Rig, controller: &mut ActiveController<'_>, set_points: &mut SetPointSource) -> Vec<PeriodSample> {
    let mut moments = Vec::new();
    rig.run(controller, set_points, &mut |period| {
        moments.push(PeriodSample::at_end_of(period));
        Ok(())
    })
    .expect("it runs");
    moments
}
