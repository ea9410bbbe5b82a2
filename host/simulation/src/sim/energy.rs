//! Energy balance of a run (kinetic and elastic energy against the work of torques, damping, errors and changing
//! stiffness), tick by tick. The work of a tick is that of the reference started at the tick's own state, so the
//! residual is the scheme's own gain or loss of energy. The tanh dead zone has no balance.

use model_core::gears::MeshPhasing;
use std::f64::consts::TAU;

use parameters::{DeadZone, JointParameters, MESH_KINDS, MeshPhases};
use reference::joint::{Reference, RelativeState, Start, Work};

use super::snapshot::Snapshot;

/// Largest number of points in the picture.
const MAX_ENTRIES: usize = 20_000;

/// Energy balance of a run [J].
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(missing_docs, non_snake_case, reason = "names and units say it")]
pub struct Balance {
    /// Kinetic and elastic energy at the start and at the end.
    pub stored_at_start_J: f64,
    pub stored_at_end_J: f64,
    /// Energy supplied by the drive torque, minus that taken by the load.
    pub supplied_J: f64,
    /// Energy dissipated in mesh damping and compliance.
    pub dissipated_J: f64,
    /// Work done against imposed transmission errors.
    pub against_errors_J: f64,
    /// Energy supplied by changing mesh stiffness.
    pub by_stiffness_J: f64,
    /// Growth of the stored energy minus all work: energy gained (or, negative, lost) by the scheme.
    pub residual_J: f64,
    /// Residual over the dissipated energy.
    pub residual_over_dissipated: f64,
}

/// One entry of the balance: time [s], stored energy, work so far and residual so far [J].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BalanceEntry {
    /// Time [s].
    pub time: f64,
    /// Kinetic and elastic energy [J].
    pub stored: f64,
    /// Work so far.
    pub work: Work,
    /// Stored energy minus its initial value and all work [J].
    pub residual: f64,
}

/// Energy balance, accumulated during a run.
#[derive(Debug, Clone)]
pub struct EnergyAccount<'a> {
    joint: &'a JointParameters,
    tick_rate: f64,
    /// Ticks between two entries.
    every: u32,
    started: Option<f64>,
    /// Reference at the start of the current tick.
    open: Option<Reference>,
    torques: (f64, f64),
    work: Work,
    /// Entries for the picture.
    pub entries: Vec<BalanceEntry>,
    last: Option<BalanceEntry>,
}

impl<'a> EnergyAccount<'a> {
    /// Balance for a run with a number of ticks; `None` for the tanh dead zone.
    pub fn open(joint: &'a JointParameters, tick_rate: u32, ticks: u32) -> Option<Self> {
        let every = ticks.div_ceil(MAX_ENTRIES as u32).max(1);
        (joint.dead_zone == DeadZone::Sharp).then(|| Self {
            joint,
            tick_rate: tick_rate.into(),
            every,
            started: None,
            open: None,
            torques: (0.0, 0.0),
            work: Work::default(),
            entries: Vec::new(),
            last: None,
        })
    }

    /// Adds a tick. A state that the reference cannot follow adds no work, so it shows in the residual.
    pub fn add_tick(&mut self, snapshot: &Snapshot) {
        let stored = match &snapshot.energy {
            Some(energy) => {
                self.work = energy.work;
                energy.stored
            }
            None => {
                if let Some(mut tick) = self.open.take()
                    && tick.advance(1.0 / self.tick_rate, self.torques.0, self.torques.1).is_ok()
                {
                    self.work = sum(&self.work, &tick.observe().work);
                }
                let Ok(tick) = Reference::start(&at_mesh_phase(self.joint, snapshot.mesh_periods), &state_of(snapshot))
                else {
                    return;
                };
                let observation = tick.observe();
                self.open = Some(tick);
                observation.kinetic_energy + observation.elastic_energy
            }
        };
        self.torques = (snapshot.drive, snapshot.load);
        let started = *self.started.get_or_insert(stored);
        let residual = stored - started - self.work.net();
        let entry = BalanceEntry { time: snapshot.time, stored, work: self.work, residual };
        if snapshot.tick.is_multiple_of(self.every) {
            self.entries.push(entry);
        }
        self.last = Some(entry);
    }

    /// Balance so far.
    pub fn balance(&self) -> Option<Balance> {
        let last = self.last?;
        let Work { supplied, dissipated, against_errors, by_stiffness } = last.work;
        Some(Balance {
            stored_at_start_J: self.started?,
            stored_at_end_J: last.stored,
            supplied_J: supplied,
            dissipated_J: dissipated,
            against_errors_J: against_errors,
            by_stiffness_J: by_stiffness,
            residual_J: last.residual,
            residual_over_dissipated: last.residual / dissipated.abs().max(f64::MIN_POSITIVE),
        })
    }
}

fn sum(a: &Work, b: &Work) -> Work {
    Work {
        supplied: a.supplied + b.supplied,
        dissipated: a.dissipated + b.dissipated,
        against_errors: a.against_errors + b.against_errors,
        by_stiffness: a.by_stiffness + b.by_stiffness,
    }
}

/// Joint with its current mesh phase as phase zero.
fn at_mesh_phase(joint: &JointParameters, mesh_periods: f64) -> JointParameters {
    let angle = TAU * (mesh_periods - mesh_periods.floor());
    let mut now = joint.clone();
    for kind in MESH_KINDS {
        let planets = 0..joint.geometry.planets;
        let phases = MeshPhases::Given {
            stiffness: planets.clone().map(|planet| joint.stiffness_phase(kind, planet) + angle).collect(),
            error: planets.map(|planet| joint.error_phase(kind, planet) + angle).collect(),
        };
        match kind {
            parameters::MeshKind::SunPlanet => now.sun_planet.phases = phases,
            parameters::MeshKind::RingPlanet => now.ring_planet.phases = phases,
        }
    }
    now
}

fn state_of(snapshot: &Snapshot) -> Start {
    let planets = snapshot.teeth.len() / 2;
    let sun_planet = || snapshot.teeth.iter().take(planets);
    Start::Relative(RelativeState {
        sun_planet: sun_planet().map(|teeth| teeth.deflection).collect(),
        sun_planet_rate: sun_planet().map(|teeth| teeth.rate).collect(),
        gap: snapshot.gap,
        gap_rate: snapshot.gap_rate,
        wind_up: snapshot.wind_up,
        wind_up_rate: snapshot.wind_up_rate,
        rigid_speed: snapshot.carrier_speed,
    })
}

#[cfg(test)]
mod tests {
    use model_core::gears::{Kinematics, Mechanics};

    use host_tests::tolerance;
    use link::messages::Command;
    use model_core::gears::design::Effort;
    use parameters::StiffnessWave;

    use super::*;
    use crate::sim::scheme::SchemeName;
    use crate::sim::stepping::{SimulationSpec, simulate};

    fn joint(name: &str) -> JointParameters {
        joint_file::read(joint_file::preset(name).expect("a preset")).expect("a good preset").parameters
    }

    /// Runs a joint from the middle of its gap, turning, so that every contact state occurs.
    fn run_through(joint: &JointParameters, tick_rate: u32, scheme: SchemeName, each: &mut dyn FnMut(&Snapshot)) {
        let planets = joint.geometry.planets;
        let start =
            Start::Relative(RelativeState { rigid_speed: 3.0, gap_rate: 0.05, ..RelativeState::centred(planets) });
        let drive = 0.3 * joint.rated_output_torque / joint.geometry.ratio_by_radii();
        let load = joint.balanced_load_torque(drive);
        let torques = [
            Command { tick: 0, drive_torque: drive as f32, load_torque: load as f32 },
            Command { tick: 600, drive_torque: -drive as f32, load_torque: -load as f32 },
        ];
        let run = SimulationSpec {
            joint: joint.clone(),
            tick_rate,
            ticks: 1500,
            torques: torques.into(),
            start,
            double: true,
            effort: Effort::Accurate,
        };
        simulate(&run, scheme, 0.0, &mut |snapshot| {
            each(snapshot);
            Ok(())
        })
        .expect("a good joint");
    }

    /// The reference evaluates the state by its own equations.
    #[test]
    fn core_reading_matches_reference() {
        let mut rectangular = joint("q1");
        for mesh in [&mut rectangular.sun_planet, &mut rectangular.ring_planet] {
            mesh.stiffness_wave = StiffnessWave::Rectangular { stiffness_ratio: 0.1, contact_ratio: 1.6, order: 5 };
        }
        for joint in [joint("q1"), joint("paper"), joint("l1"), rectangular] {
            let force_scale = joint.sun_planet.mean_stiffness * joint.characteristic_length;
            let mut worst = [0.0f64; 3];
            run_through(&joint, 200_000, SchemeName::Realtime, &mut |snapshot| {
                let read = Reference::start(&at_mesh_phase(&joint, snapshot.mesh_periods), &state_of(snapshot));
                let read = Snapshot::from_reference(0, &joint, &read.expect("a good state").observe());
                for (one, other) in snapshot.teeth.iter().zip(&read.teeth) {
                    worst[0] = worst[0].max((one.deflection - other.deflection).abs() / joint.characteristic_length);
                    worst[1] = worst[1].max((one.force - other.force).abs() / force_scale);
                }
                worst[2] = worst[2].max((snapshot.motor_offset - read.motor_offset).abs());
                worst[2] = worst[2].max((snapshot.link_offset - read.link_offset).abs());
            });
            println!("{}: {worst:?}", joint.name);
            worst.into_iter().for_each(|error| tolerance::core::HOST_OUTPUTS.check(error));
        }
    }

    #[test]
    fn reference_energy_balances() {
        for joint in [joint("q1"), joint("paper"), joint("l1")] {
            let mut account = EnergyAccount::open(&joint, 200_000, 1500).expect("a sharp dead zone");
            run_through(&joint, 200_000, SchemeName::Reference, &mut |snapshot| account.add_tick(snapshot));
            let balance = account.balance().expect("it has run");
            println!("{}: {balance:?}", joint.name);
            tolerance::REFERENCE_ENERGY_BALANCE.check(balance.residual_over_dissipated);
        }
    }

    /// The work of the ticks comes from the reference, tick by tick; the residual is the scheme's own error.
    #[test]
    fn board_scheme_has_smallest_residual() {
        let joint = joint("paper");
        let residual = |scheme| {
            let mut account = EnergyAccount::open(&joint, 200_000, 1500).expect("a sharp dead zone");
            run_through(&joint, 200_000, scheme, &mut |snapshot| account.add_tick(snapshot));
            account.balance().expect("it has run").residual_over_dissipated.abs()
        };
        let [realtime, runge_kutta, euler] =
            [SchemeName::Realtime, SchemeName::RungeKutta4, SchemeName::Euler].map(residual);
        println!("realtime {realtime:.1e}, Runge-Kutta {runge_kutta:.1e}, Euler {euler:.1e}");
        tolerance::core::BOARD_ENERGY_BALANCE.check(realtime);
        assert!(realtime < runge_kutta && runge_kutta < euler);
    }

    #[test]
    fn tanh_dead_zone_has_no_balance() {
        let mut joint = joint("q1");
        joint.dead_zone = DeadZone::Tanh { sharpness: 10.0 };
        assert!(EnergyAccount::open(&joint, 20_000, 100).is_none());
    }
}
