//! Invariants of the core, for every scheme: energy balance over a hundred thousand mesh periods, shift of the backlash, scaling, mirroring
//! (oracles 5 and 6). The reference's invariants are in `the_reference`.

use std::f64::consts::TAU;

use host_tests::tolerance::core::{CORE_ENERGY, CORE_SHIFT};
use model_core::gears::design::{Effort, design_scheme};
use model_core::gears::{Model, Outputs, Relative, Scheme, State, Tables, Torques};
use parameters::{ContactState, DampingLaw, JointParameters};
use reference::scenarios::{CASE_A_OMEGA, Scenario, case, regime, same};

use super::oracles::closed_forms::ClosedForm;

fn tables(joint: &JointParameters, tick_rate: u32, scheme: Scheme) -> Tables<f64, 3> {
    design_scheme(joint, tick_rate, scheme, Effort::Accurate).expect("the paper's joint is sound")
}

/// Energy of set P and the work done on it, dimensionless (unit K_m b_c^2), by the sums of oracle 5. Masses and damping are written out
/// independently of the core.
struct EnergyBalance {
    form: ClosedForm,
    half_backlash: f64,
    omega: f64,
    drive_force: f64,
    load_force: f64,
}

/// Energy, power and dissipation at one moment.
struct EnergySample {
    energy: f64,
    power: f64,
    dissipated: f64,
}

impl EnergyBalance {
    fn for_set_p(half_backlash: f64, drive_torque: f64) -> Self {
        let drive_force = drive_torque / 36.8241e-3 / (1e8 * 10e-6);
        Self {
            form: ClosedForm::with_ring(3, 0.05, 1.0),
            half_backlash: half_backlash / 10e-6,
            omega: 2.1,
            drive_force,
            load_force: 2.0 * drive_force,
        }
    }

    fn sample(&self, state: &State<f64, 3>) -> EnergySample {
        let (sine, cosine) = (state.phase as f64 * (TAU / 2.0_f64.powi(64))).sin_cos();
        let (error, error_rate) = (3.0 * sine, 3.0 * self.omega * cosine);
        let (stiffness, stiffness_rate) = (1.0 + 0.1 * sine, 0.1 * self.omega * cosine);
        let Relative { planets, gap, .. } = &state.position;
        let Relative { planets: rates, gap: gap_rate, .. } = &state.rate;

        // Speeds relative to the rigid-body motion, in which the sun moves by 2 and a planet by 1 per unit of the
        // carrier. Relative to it the bodies carry no momentum: 2 M_s u_s + M_p sum u_p + M_c u_c = 0.
        let ClosedForm { sun, planet, carrier, damping, .. } = self.form;
        let shares = 2.0 * sun * gap_rate + planet * rates.iter().map(|rate| gap_rate - rate).sum::<f64>();
        let carrier_speed = -shares / (4.0 * sun + 3.0 * planet + carrier);
        let sun_speed = gap_rate + 2.0 * carrier_speed;
        let mut energy = 0.5 * (sun * sun_speed * sun_speed + carrier * carrier_speed * carrier_speed);
        let mut power = self.drive_force * sun_speed - self.load_force * carrier_speed;
        let mut dissipated = 0.0;
        for (position, rate) in planets.iter().zip(rates) {
            energy += 0.5 * planet * (sun_speed - rate - carrier_speed).powi(2);
            let sides = [(*position, *rate), (gap - position, gap_rate - rate)];
            for ((across, across_rate), damping) in sides.into_iter().zip(damping) {
                let (deflection, speed) = (across - error, across_rate - error_rate);
                let overlap = (deflection - self.half_backlash).max(0.0) + (deflection + self.half_backlash).min(0.0);
                energy += 0.5 * stiffness * overlap * overlap;
                dissipated += damping * speed * speed;
                power -= (stiffness * overlap + damping * speed) * error_rate;
                power += 0.5 * stiffness_rate * overlap * overlap;
            }
        }
        EnergySample { energy, power: power - dissipated, dissipated }
    }
}

/// Oracle 5 on period-3 motion with loss of contact and on chaos. The sum over ticks integrates the power exactly on average, since tick
/// and mesh period are incommensurate.
#[test]
fn energy_balances_over_100000_mesh_periods() {
    const TICK_RATE: u32 = 100_000;
    for (half_backlash, periods) in [(60e-6, 100_000.0), (120e-6, 10_000.0)] {
        let scenario = regime("set P", half_backlash, 1.0);
        let tables = tables(&scenario.joint, TICK_RATE, Scheme::Realtime);
        let step = tables.flow.step;
        let balance = EnergyBalance::for_set_p(half_backlash, 80.0);
        let (drive, load) = scenario.torques_at(0);
        let mut model = Model::new(&tables);
        model.set_state(State::from_deflections(&tables, &Relative::ZERO, &Relative::ZERO, 0.0));
        let first = balance.sample(model.state());
        let (mut before, mut work, mut dissipated, mut worst) = (first.power, 0.0, 0.0, 0.0_f64);
        let mut crossings = 0_u64;
        let mut sides = [[ContactState::Separated; 3]; 2];
        let ticks = (periods * TAU / balance.omega / step).ceil() as u64;
        for tick in 0..ticks {
            model.step(Torques { drive, load });
            let sample = balance.sample(model.state());
            work += 0.5 * step * (before + sample.power);
            before = sample.power;
            dissipated += step * sample.dissipated;
            worst = worst.max((sample.energy - first.energy - work).abs());
            if tick < 100_000 {
                let now = model.outputs().contacts;
                crossings += u64::from(now != sides);
                sides = now;
            }
        }
        assert!(crossings > 10_000, "contact is lost and found again: {crossings}");
        print!("b = {half_backlash:e} m: {dissipated:.2e} dissipated: ");
        CORE_ENERGY.check(worst / dissipated);
    }
}

/// Outputs at 20 kHz from a state in units of b_c and b_c omega_n.
fn run(
    joint: &JointParameters,
    scheme: Scheme,
    start: (&Relative<f64, 3>, &Relative<f64, 3>),
    torques: (f64, f64),
    ticks: u64,
) -> Vec<Outputs<f64, 3>> {
    let tables = tables(joint, 20_000, scheme);
    let mut model = Model::new(&tables);
    model.set_state(State::from_deflections(&tables, start.0, start.1, 0.0));
    let step = |_| {
        model.step(Torques { drive: torques.0, load: torques.1 });
        model.outputs()
    };
    (0..ticks).map(step).collect()
}

/// Mesh deflections and gap [m].
fn lengths(outputs: &Outputs<f64, 3>) -> impl Iterator<Item = f64> + '_ {
    outputs.deflections.iter().flatten().copied().chain([outputs.gap])
}

fn start() -> (Relative<f64, 3>, Relative<f64, 3>) {
    let position = Relative { planets: [7.0, 7.5, 8.0], gap: 15.0, wind_up: 0.0 };
    (position, Relative { planets: [0.3, -0.2, 0.1], gap: 0.4, wind_up: 0.0 })
}

fn case_a(law: DampingLaw) -> Scenario {
    let mut scenario = case("case A", CASE_A_OMEGA);
    scenario.joint.damping_law = law;
    scenario
}

/// Oracle 6, first half: a wider backlash only shifts the motion while no back side is touched.
#[test]
fn backlash_only_shifts_one_sided_motion() {
    for (law, scheme) in [
        (DampingLaw::Paper, Scheme::Realtime),
        (DampingLaw::Contact, Scheme::Realtime),
        (DampingLaw::Paper, Scheme::PaperEtd1),
    ] {
        let narrow = case_a(law);
        let (shift, units) = (55e-6, 5.5);
        let mut wide = narrow.joint.clone();
        for mesh in [&mut wide.sun_planet, &mut wide.ring_planet] {
            mesh.half_backlash = same(3, 60e-6 + shift);
        }
        let (position, rate) = start();
        let moved =
            Relative { planets: position.planets.map(|x| x + units), gap: position.gap + 2.0 * units, ..position };
        // 150 ticks end before the law `contact` has amplified rounding beyond the bound.
        let ticks = 150;
        let narrow_run = run(&narrow.joint, scheme, (&position, &rate), narrow.torques_at(0), ticks);
        let wide_run = run(&wide, scheme, (&moved, &rate), narrow.torques_at(0), ticks);
        let sides: Vec<ContactState> =
            narrow_run.iter().flat_map(|outputs| outputs.contacts.into_iter().flatten()).collect();
        assert!(sides.contains(&ContactState::Separated) && !sides.contains(&ContactState::BackSide));
        for (narrow, wide) in narrow_run.iter().zip(&wide_run) {
            for (index, (narrow, wide)) in lengths(narrow).zip(lengths(wide)).enumerate() {
                let expected = if index == 6 { 2.0 * shift } else { shift };
                CORE_SHIFT.check((wide - narrow - expected) / 10e-6);
            }
        }
    }
}

/// Oracle 6, second half: exact in every bit, since a power of two and a change of sign cause no rounding.
#[test]
fn scaling_and_mirroring_keep_every_bit() {
    for factor in [2.0_f64, 0.25, -1.0] {
        for (law, scheme) in [
            (DampingLaw::Paper, Scheme::Realtime),
            (DampingLaw::Contact, Scheme::Realtime),
            (DampingLaw::Paper, Scheme::PaperEtd1),
        ] {
            let plain = case_a(law);
            let mut scaled = plain.joint.clone();
            for mesh in [&mut scaled.sun_planet, &mut scaled.ring_planet] {
                mesh.half_backlash.iter_mut().for_each(|value| *value *= factor.abs());
                mesh.transmission_error.iter_mut().for_each(|value| *value *= factor);
            }
            let (drive, load) = plain.torques_at(0);
            let (position, rate) = start();
            let [scaled_position, scaled_rate] = [position, rate].map(|given| Relative::ZERO.plus(factor, &given));
            let plain_run = run(&plain.joint, scheme, (&position, &rate), (drive, load), 1000);
            let torques = (factor * drive, factor * load);
            let scaled_run = run(&scaled, scheme, (&scaled_position, &scaled_rate), torques, 1000);
            for (plain, scaled) in plain_run.iter().zip(&scaled_run) {
                assert!(lengths(plain).zip(lengths(scaled)).all(|(plain, scaled)| scaled == factor * plain));
            }
        }
    }
}
