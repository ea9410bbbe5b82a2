//! The three roles on boards without hardware, with schedules for each.

use std::ops::Range;

use firmware::observer::Observing;
use firmware::plant::Plant;
use firmware::port::Direct;
use firmware::protocol::Protocol;
use firmware::tables::{PLANETS, TABLES};
use firmware::whole_loop::WholeLoop;
use firmware::work::Work;
use link::controller::{EXCHANGES_PER_SCHEDULE, Exchange};
use link::messages::{COMMANDS_PER_SCHEDULE, Command, Schedule, ToBoard};
use link::virtual_joint::{KNOTS_PER_SCHEDULE, Knot, WireTrajectory};
use model_core::controller::Controller;
use model_core::controller::trajectory::Trajectory;
use model_core::virtual_joint::VirtualJoint;

pub mod control {
    #![allow(missing_docs, dead_code, clippy::all, clippy::excessive_precision, reason = "generated numbers")]
    include!(concat!(env!("OUT_DIR"), "/control.rs"));
}

pub type PlantWork = Plant<'static, PLANETS>;
pub type ObserverWork = Observing<Direct<'static>>;
pub type LoopWork = WholeLoop<'static, Direct<'static>, PLANETS>;

pub fn controller() -> Controller<'static, f32> {
    Controller::with_tables(&control::OBSERVER, &control::COMPENSATION)
}

/// Slow turn of the link from a tick on.
pub fn knot(tick: u32) -> Knot {
    let trajectory = WireTrajectory::Position((0, [1e-4 * tick as f32, 0.5, 0.0, 0.0, 0.0, 0.0]), None);
    Knot { tick, load_torque: 0.5, trajectory }
}

/// Role that can be scheduled by generic tests.
pub trait TestRole: Work<Protocol: Protocol<Command: 'static, Sample: 'static> + 'static> + 'static {
    /// Most commands in one schedule.
    const MOST: u32;
    /// Role at rest.
    fn work() -> Self;
    /// Schedule with a command for each of these ticks, at most [`TestRole::MOST`].
    fn schedule(sequence: u16, horizon: u32, ticks: Range<u32>) -> ToBoard;
}

impl TestRole for PlantWork {
    const MOST: u32 = COMMANDS_PER_SCHEDULE as u32;

    fn work() -> Self {
        Plant::new(&TABLES)
    }

    fn schedule(sequence: u16, horizon: u32, ticks: Range<u32>) -> ToBoard {
        let commands = ticks.map(|tick| Command { tick, drive_torque: 0.1, load_torque: 0.0 }).collect();
        ToBoard::Schedule(Schedule { sequence, horizon, commands })
    }
}

impl TestRole for ObserverWork {
    const MOST: u32 = EXCHANGES_PER_SCHEDULE as u32;

    fn work() -> Self {
        Observing::new(Direct(controller()), true)
    }

    fn schedule(sequence: u16, horizon: u32, ticks: Range<u32>) -> ToBoard {
        let samples = VirtualJoint::<f32, PLANETS>::new(&TABLES, &control::SURROUNDINGS).samples();
        let hold = Trajectory::HOLD.at(0.0, 1.0);
        let commands = ticks.map(|tick| Exchange::new(tick, &samples, &hold)).collect();
        ToBoard::Exchanges(Schedule { sequence, horizon, commands })
    }
}

impl TestRole for LoopWork {
    const MOST: u32 = KNOTS_PER_SCHEDULE as u32;

    fn work() -> Self {
        WholeLoop::new(&TABLES, &control::SURROUNDINGS, Direct(controller()))
    }

    fn schedule(sequence: u16, horizon: u32, ticks: Range<u32>) -> ToBoard {
        ToBoard::Trajectory(Schedule { sequence, horizon, commands: ticks.map(knot).collect() })
    }
}
