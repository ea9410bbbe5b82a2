//! Twin on the host of a board that runs the whole loop: equal joint, observer and compensation over the same knots, in
//! the same order of operations. The metrics of the board's run are computed from the twin, whose every period is
//! observable.

use std::f64::consts::TAU;

use joint_file::JointFile;
use link::virtual_joint::Knot;
use model_core::compensation::{Command, Position};
use model_core::controller::Controller;
use model_core::controller::trajectory::Trajectory;
use model_core::gears::design::{Effort, design_scheme};
use model_core::gears::{Scheme, Tables};
use model_core::numbers::digest;
use model_core::virtual_joint::design::design_surroundings;
use model_core::virtual_joint::fault::{Fault, FixedPoint};
use model_core::virtual_joint::fault_injector::FaultInjector;
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};
use reference::closed_loop::{Motion, Sample};

use super::faults::{counts_per_turn, mounting_angles};
use super::trajectory;
use crate::case::{Case, Designed};
use crate::file::TestFile;
use crate::port::restart_from_memory;
use crate::run_history::{LoggedSetPoint, RunHistory, TrueValues};
use board::device::board::Board;
use report::failure::{Failure, Outcome};
use simulation::sim::snapshot::Reader;

/// A twin run: the test, its drawn case, and the true joint at the board's rate.
pub struct Twin<'t> {
    /// Test file.
    pub file: &'t TestFile,
    /// Case of the test.
    pub case: &'t Case,
    /// Tables of the controller.
    pub designed: &'t Designed,
    /// True joint.
    pub truth: &'t JointFile,
    /// Board of the image.
    pub board: &'t Board,
    /// Faults between joint and controller.
    pub faults: &'t [Fault<FixedPoint<f32>>],
}

/// Result of a twin run.
pub struct TwinResult {
    /// Motion in knots.
    pub knots: Vec<Knot>,
    /// History of the run.
    pub history: RunHistory,
    /// Running digest after every period.
    pub digests: Vec<u64>,
}

impl Twin<'_> {
    /// Runs the twin.
    pub fn run(&self) -> Outcome<TwinResult> {
        match self.truth.parameters.geometry.planets {
            1 => self.run_with::<1>(),
            3 => self.run_with::<3>(),
            4 => self.run_with::<4>(),
            _ => self.run_with::<5>(),
        }
    }

    fn run_with<const N: usize>(&self) -> Outcome<TwinResult> {
        let joint = &self.truth.parameters;
        let surroundings = self.truth.surroundings;
        let refused = |error: &dyn std::fmt::Display| {
            Failure::new(format!("joint `{}` cannot be simulated on {}: {error}", joint.name, self.board.name()))
        };
        let effort = Effort::Within(self.board.processor());
        let tables: Tables<f32, N> = design_scheme(joint, surroundings.control_rate, Scheme::Realtime, effort)
            .map_err(|error| refused(&error))?;
        let table: SurroundingsTable<f32> =
            design_surroundings(joint, &surroundings, &tables).map_err(|error| refused(&error))?;
        let mut controller = Controller::with_tables(&self.designed.observer, &self.designed.compensation);
        if self.file.from_memory {
            self.run_once(&tables, &table, &mut controller);
            let memory_at_start = Some(restart_from_memory(&mut controller)?);
            let mut result = self.run_once(&tables, &table, &mut controller);
            result.history.memory_at_start = memory_at_start;
            return Ok(result);
        }
        Ok(self.run_once(&tables, &table, &mut controller))
    }

    /// Runs from the first period to the last.
    fn run_once<const N: usize>(
        &self,
        tables: &Tables<f32, N>,
        table: &SurroundingsTable<f32>,
        controller: &mut Controller<'_, f32>,
    ) -> TwinResult {
        let mut virtual_joint = VirtualJoint::new(tables, table);
        let mut faults = FaultInjector::default();
        let all_taken = self.faults.iter().all(|fault| faults.add(*fault));
        debug_assert!(all_taken, "more than fit were refused before");
        let [_, mounted] = mounting_angles(&self.case.zeros, counts_per_turn(&self.truth.surroundings));
        let of_output = f64::from(mounted) / 2.0_f64.powi(32) - f64::from(virtual_joint.output_turn(mounted));
        // Without the output encoder, the observer's angle of the link counts from the start.
        let zero = if self.file.output_encoder { of_output } else { 0.0 };
        let knots = trajectory::knots(self.file, self.case, self.designed, zero);
        let joint = &self.truth.parameters;
        let reader = Reader::new(joint, tables);

        let rate = f64::from(tables.tick_rate);
        let periods = (self.file.duration * rate).round() as u32;
        let half = self.case.half_backlash();
        let mut history = RunHistory::begin(1.0 / rate, periods.into());
        let (mut digests, mut running) = (Vec::with_capacity(periods as usize), digest::START);
        let (mut coming, mut demand, mut load, mut since) = (knots.iter().peekable(), Trajectory::HOLD, 0.0, 0);
        for period in 0..periods {
            if let Some(knot) = coming.next_if(|knot| knot.tick == period) {
                (demand, load, since) = (Trajectory::from(knot.trajectory), knot.load_torque, period);
            }
            let elapsed = f32::from((period - since).min(u16::MAX.into()) as u16);
            let command = demand.at(table.period * elapsed, table.turn);
            let samples = faults.apply_to_samples(virtual_joint.samples(), table);
            let answer = controller.step(&samples, &command);
            virtual_joint.advance(faults.apply_to_torque(answer.shaped.torque), load);
            running = digest::chain(answer.digest(running), virtual_joint.model().state_digest());
            digests.push(running);

            let moment = reader.read(period + 1, virtual_joint.model());
            let state = virtual_joint.model().state();
            let planets: f32 = state.rate.planets.iter().sum();
            let [of_planets, of_gap, of_wind_up] = table.link_rate;
            let beyond = of_planets * planets + of_gap * state.rate.gap + of_wind_up * state.rate.wind_up;
            let [_, stiffness, damping] = table.to_link;
            let sample = Sample {
                time: moment.time,
                wanted: self.case.motion.at(moment.time).position,
                link: moment.link_angle(),
                link_speed: moment.carrier_speed + f64::from(beyond),
                gap: if half > 0.0 { moment.gap / (2.0 * half) } else { moment.gap.signum() },
                mesh_force: moment.teeth.iter().take(N).map(|teeth| teeth.force).sum(),
                transmitted: f64::from(stiffness) * moment.wind_up + f64::from(damping) * f64::from(state.rate.wind_up),
                command: f64::from(answer.shaped.torque),
            };
            let truth = TrueValues {
                gap: moment.gap,
                half_backlash: half,
                load_torque: f64::from(virtual_joint.acting().load),
                motor: moment.motor_angle(joint),
            };
            history.add(sample, truth, samples, logged_set_point(&command, zero), Some(&answer));
        }
        TwinResult { knots, history, digests }
    }
}

/// Set-point with its angle relative to the joint's own zero, where the observer's scale reads `zero` [turns].
fn logged_set_point(command: &Command<f32>, zero: f64) -> LoggedSetPoint {
    let angle = |position: Position<f32>| TAU * (f64::from(position.turns) + f64::from(position.fraction) - zero);
    match command {
        Command::Position { now, .. } => LoggedSetPoint {
            motion: Motion {
                position: angle(now.position),
                speed: now.speed.into(),
                acceleration: now.acceleration.into(),
            },
            ..LoggedSetPoint::default()
        },
        Command::Impedance(point) => LoggedSetPoint {
            motion: Motion { position: angle(point.position), speed: point.speed.into(), acceleration: 0.0 },
            torque: point.torque.into(),
            stiffness: point.stiffness.into(),
            damping: point.damping.into(),
        },
    }
}
