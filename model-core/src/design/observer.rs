//! Tables of the observer: from joint, encoders and how much is known beforehand to flows and gains. What the observer
//! does with them is left to `realtime::observer`.
//!
//! No gain is typed in. Both filters are steady-state Kalman filters from the encoders' quantisation and from how fast
//! torques may change; the learner starts from the stated uncertainties; thresholds are multiples of the noise that
//! these leave.

mod filter;
mod integers;
mod probe;
mod source;

use core::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use crate::design::exponential::flow;
use crate::digest;
use crate::error::DesignError;
use crate::joint::JointParameters;
use crate::mesh::MeshKind;
use crate::real::Real;
use crate::tables::observer::{
    ContactTable, CountTable, CurrentTable, DriveTable, EncoderTable, LearnerTable, LeverTable, LoadTable, MOST_DELAY,
    MOST_PARAMETERS, ObserverTables, SupervisorTable,
};
use filter::{Filter, System};
pub use probe::design_probe;
pub use source::observer_source;

/// An encoder as its data sheet has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderSettings {
    /// Counts in one turn of its shaft; any number.
    pub counts_per_turn: u32,
    /// Raw counts run from 0 to this less 1 and start again; 0 stands for 2^32. The number of counts in a turn for a
    /// single-turn absolute encoder.
    pub wraps_at: u32,
    /// Whether it knows its place in the turn when it begins. If not, offset and error maps are learnt anew every time.
    pub absolute: bool,
    /// Standard deviation to expect of its once- and of its twice-per-turn error; zero if there is none [rad].
    pub harmonic_error: f64,
}

/// What the observer is designed from besides the joint. The joint's own half-backlash and compliance are guesses to
/// start from.
#[derive(Debug, Clone, PartialEq)]
pub struct ObserverSettings {
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Ticks a second of the clock of all moments [Hz].
    pub clock_rate: u32,
    /// Encoder on the motor.
    pub motor_encoder: EncoderSettings,
    /// Encoder on the link, if there is one.
    pub output_encoder: Option<EncoderSettings>,
    /// Fastest that the motor can turn [rad/s].
    pub fastest_motor: f64,
    /// From commanding a torque to its first effect [control periods].
    pub torque_delay: f64,
    /// Time constant of the current loop after that [s].
    pub torque_lag: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// Torque noise over the torque, standard deviation [-].
    pub torque_noise_ratio: f64,
    /// Standard deviation of the motor's bias and dry friction, each, beforehand [N m].
    pub torque_uncertainty: f64,
    /// Standard deviation of what the motor's torque does beside bias and dry friction: cogging, ripple [N m].
    pub torque_ripple: f64,
    /// Efficiency of the gears while the motor drives, losses in proportion to the torque [-].
    pub efficiency: f64,
    /// Standard deviation of the half-backlash guess, relative to it [-].
    pub backlash_uncertainty: f64,
    /// Standard deviation of the compliance guess, relative to it [-].
    pub compliance_uncertainty: f64,
    /// How much older an output reading is expected to be than its time says, less the same of the motor's [s].
    pub skew: f64,
    /// Standard deviation of the skew between the encoders' readings [s].
    pub skew_uncertainty: f64,
}

/// Time in which the load torque may change by as much as the motor can hold [s]. Friction that turns round and
/// collisions are faster, gravity slower; a filter for this follows the first with a lag of a few milliseconds.
const LOAD_CHANGE: f64 = 2.0;

/// Shortest half swing that the motor side follows [control periods].
const FASTEST_SWING: f64 = 20.0;

/// Part of the motor's largest torque by which the mesh force changes in half a swing of motor against load.
const MESH_CHANGE: f64 = 0.2;

/// Part of the motor's largest torque by which the mesh force is wrong for about a millisecond after an impact.
const IMPACT_ERROR: f64 = 0.05;

/// Length of a learning interval [s]: short against the motions in which contact settles, long against noise.
const LEARNING_INTERVAL: f64 = 1e-3;

/// Learning intervals over which the observer takes the speed of the way.
const WINDOW: f64 = 8.0;

/// Length of settled contact that makes up one way to learn from [s]: about as long as cogging and swings of the wind-up
/// take to repeat, so that one block's error says little about the next one's.
const BLOCK: f64 = 8e-3;

/// Time in which wear and warmth may change what was learnt by as much as is known of it [s].
const MEMORY: f64 = 100.0;

/// Tables of the observer.
pub fn design_observer<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
) -> Result<ObserverTables<T>, DesignError> {
    super::validate::validate(joint)?;
    settings.check()?;
    let real = T::from_f64;
    let step = 1.0 / f64::from(settings.control_rate);
    let body = Body::new(joint);
    let counts = counts::<T>(joint, settings, step)?;
    let motor_count = TAU / f64::from(settings.motor_encoder.counts_per_turn);
    let output_count = TAU / f64::from(settings.output_encoder.unwrap_or(settings.motor_encoder).counts_per_turn);
    let drive = drive_filter(&body, settings, motor_count, step);
    let load = load_filter(&body, settings, output_count * output_count / 12.0, step);

    let rated_force = settings.torque_limit / body.sun_lever;
    let force_variance = drive.quiet[2] / (body.sun_lever * body.sun_lever);
    let periods = libm::round(LEARNING_INTERVAL / step).max(1.0);
    let way_variance = drive.quiet[0] * body.sun_lever.powi(2) + load.quiet[0] * body.output_lever.powi(2);
    let ripple = settings.torque_ripple / body.sun_lever;
    let wind_up_variance = body.compliance.powi(2) * (force_variance / periods + ripple * ripple);
    let blind = load_filter(
        &body,
        settings,
        (way_variance + body.compliance.powi(2) * (force_variance + ripple * ripple)) / body.output_lever.powi(2),
        step,
    );
    let unmodelled = 0.1 * settings.motor_encoder.harmonic_error * body.sun_lever;
    let noise = libm::sqrt(way_variance + wind_up_variance + unmodelled * unmodelled);
    let block = libm::round(BLOCK / LEARNING_INTERVAL).max(1.0);

    let half_gap = 2.0 * body.half_backlash;
    let harmonics = |encoder: Option<EncoderSettings>, lever: f64| {
        encoder.map_or(0.0, |encoder| encoder.harmonic_error) * lever / core::f64::consts::SQRT_2
    };
    let motor_harmonic = harmonics(Some(settings.motor_encoder), body.sun_lever);
    let output_harmonic = harmonics(settings.output_encoder, body.output_lever);
    let mut deviation = [0.0; MOST_PARAMETERS];
    deviation[0] = half_gap * settings.backlash_uncertainty;
    deviation[1] = 2.0 * half_gap + body.compliance * rated_force;
    deviation[2] = body.compliance * settings.compliance_uncertainty;
    deviation[3] = body.output_lever * settings.skew_uncertainty;
    deviation[4..6].fill(body.transmission_error / core::f64::consts::SQRT_2);
    deviation[6..10].fill(motor_harmonic);
    deviation[10..14].fill(output_harmonic);
    let mut mean = [0.0; MOST_PARAMETERS];
    mean[0] = half_gap;
    mean[2] = body.compliance;
    mean[3] = body.output_lever * settings.skew;

    let meshes = f64::from(joint.geometry.ring_teeth);
    let tables = ObserverTables {
        identity: mean
            .iter()
            .chain(&deviation)
            .fold(identity(joint, settings), |running, number| digest::chain(running, number.to_bits())),
        control_rate: settings.control_rate,
        period: real(step),
        period_ticks: [0.5, 1.5].map(|part| libm::round(part * step * f64::from(settings.clock_rate)) as u32),
        tick: real(1.0 / f64::from(settings.clock_rate)),
        counts,
        levers: LeverTable {
            sun: real(body.sun_lever),
            per_sun: real(1.0 / body.sun_lever),
            output: real(body.output_lever),
            per_output: real(1.0 / body.output_lever),
            ratio: real(body.ratio),
            per_ratio: real(1.0 / body.ratio),
        },
        current: current(settings, step),
        drive: drive_table(&body, settings, &drive, step),
        load: LoadTable {
            angle: [real(step), real(load.response[(0, 0)])],
            speed: real(load.response[(1, 0)]),
            gain: [0, 1, 2].map(|state| real(load.gain[state])),
            variance: [real(load.variance[0]), real(load.variance[2])],
            blind_gain: [0, 1, 2].map(|state| real(blind.gain[state])),
            blind_variance: [real(blind.variance[1]), real(blind.variance[2])],
            way_per_torque: real(0.5 * body.output_lever / body.load_inertia),
        },
        contact: ContactTable {
            force_variance: real(force_variance),
            ripple_variance: real(ripple * ripple),
            way_variance: real(way_variance),
            bias_noise: real((force_variance + ripple * ripple) * 5.0),
            bias_prior: real((settings.torque_uncertainty / body.sun_lever).powi(2)),
            bias_drift: real((settings.torque_uncertainty / body.sun_lever).powi(2) * LEARNING_INTERVAL / 10.0),
            bias_limit: real(3.0 * settings.torque_uncertainty / body.sun_lever),
            still: real(3.0 * libm::sqrt(2.0 * (way_variance + wind_up_variance)) / WINDOW),
            still_per_speed: real(
                2.0 * (2.2 * motor_harmonic + (output_harmonic + meshes * body.transmission_error) / body.ratio),
            ),
            turning: real(3.0 * libm::sqrt(drive.quiet[1])),
            rate_deviation: real(
                3.0 * libm::sqrt(drive.quiet[1] * body.sun_lever.powi(2) + load.quiet[1] * body.output_lever.powi(2)),
            ),
            lag: real(2.0 * step),
            smoothing: real(-libm::expm1(-step / (1.5 * LEARNING_INTERVAL))),
            known_part: real(0.08),
            efficiency: real(settings.efficiency),
            per_efficiency: real(1.0 / settings.efficiency),
        },
        learner: LearnerTable {
            periods: periods as u32,
            per_periods: real(1.0 / periods),
            block: block as u32,
            per_block: real(1.0 / block),
            span: real(periods * step),
            mean: mean.map(real),
            deviation: deviation.map(real),
            weight: real(1.0 / noise),
            noise: real(noise),
            forgetting: real(LEARNING_INTERVAL / MEMORY),
            mesh_compliance: real(body.mesh_compliance),
        },
        supervisor: SupervisorTable {
            silent_after: (10e-3 / step) as u32,
            failed_after: (4e-3 / step) as u32,
            trusted_after: (0.3 / LEARNING_INTERVAL) as u32,
            margin: real(0.1 * half_gap + 0.1 * body.compliance * rated_force),
            widest_part: real(0.1),
        },
    };
    Ok(tables)
}

/// What the observer needs of the joint, felt along the line of action.
struct Body {
    sun_lever: f64,
    /// Ratio by teeth times the sun's base radius.
    output_lever: f64,
    ratio: f64,
    motor_inertia: f64,
    load_inertia: f64,
    half_backlash: f64,
    /// Way of the sun under a unit force, link held: meshes and wind-up.
    compliance: f64,
    mesh_compliance: f64,
    /// Amplitude of the transmission error of sun to carrier, at most.
    transmission_error: f64,
}

impl Body {
    fn new(joint: &JointParameters) -> Self {
        let geometry = &joint.geometry;
        let planets = geometry.planets as f64;
        let sun_lever = geometry.sun_base_radius;
        let ratio = geometry.ratio_by_teeth();
        let output_lever = ratio * sun_lever;
        let carrier_lever = geometry.carrier_base_radius();
        let [sun_planet, ring_planet] = [MeshKind::SunPlanet, MeshKind::RingPlanet].map(|kind| joint.mesh(kind));
        let mesh_compliance = (1.0 / sun_planet.mean_stiffness + 1.0 / ring_planet.mean_stiffness) / planets;
        let wind_up = joint.compliance.map_or(0.0, |compliance| output_lever * output_lever / compliance.stiffness);
        let smallest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, |most: f64, value| most.max(value.abs()));
        Self {
            sun_lever,
            output_lever,
            ratio,
            motor_inertia: joint.rotor_inertia + joint.bodies.sun_equivalent_mass * sun_lever * sun_lever,
            load_inertia: joint.link_inertia
                + (joint.carrier_equivalent_mass() + planets * joint.bodies.planet_equivalent_mass)
                    * carrier_lever
                    * carrier_lever,
            // The planet with the least backlash takes the force.
            half_backlash: 0.5 * (smallest(&sun_planet.half_backlash) + smallest(&ring_planet.half_backlash)),
            compliance: mesh_compliance + wind_up,
            mesh_compliance,
            transmission_error: largest(&sun_planet.transmission_error) + largest(&ring_planet.transmission_error),
        }
    }

    /// The two inertias against the compliance [rad/s].
    fn contact_frequency(&self) -> f64 {
        let motor = self.motor_inertia / (self.sun_lever * self.sun_lever);
        let load = self.load_inertia / (self.output_lever * self.output_lever);
        libm::sqrt((1.0 / motor + 1.0 / load) / self.compliance)
    }
}

/// State: angle, speed, taken torque. The taken torque wanders so that it may change by the largest torque in half a
/// swing of motor against load; the torque noise acts on the speed.
fn drive_filter(body: &Body, settings: &ObserverSettings, count: f64, step: f64) -> Filter {
    let per_inertia = 1.0 / body.motor_inertia;
    // Faster swings than this are not followed: what they would cost in noise is worth more.
    let half_swing = (core::f64::consts::PI / body.contact_frequency()).max(FASTEST_SWING * step);
    let torque_noise = settings.torque_noise_ratio * settings.torque_limit;
    System {
        dynamics: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0]),
        inputs: DMatrix::zeros(3, 0),
        process_noise: DVector::from_vec(std::vec![
            0.0,
            (torque_noise * per_inertia).powi(2) * step,
            (MESH_CHANGE * settings.torque_limit).powi(2) / half_swing,
        ]),
        measurement_noise: count * count / 12.0,
    }
    .filter(step)
}

/// State: angle, speed, load torque.
fn load_filter(body: &Body, settings: &ObserverSettings, measurement_noise: f64, step: f64) -> Filter {
    let per_inertia = 1.0 / body.load_inertia;
    let impact = IMPACT_ERROR * settings.torque_limit * body.ratio * per_inertia;
    System {
        dynamics: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0]),
        inputs: DMatrix::from_row_slice(3, 1, &[0.0, per_inertia, 0.0]),
        process_noise: DVector::from_vec(std::vec![
            0.0,
            impact * impact * LEARNING_INTERVAL,
            load_change(body, settings),
        ]),
        measurement_noise,
    }
    .filter(step)
}

/// Spectral density of the load torque's changes.
fn load_change(body: &Body, settings: &ObserverSettings) -> f64 {
    (settings.torque_limit * body.ratio).powi(2) / LOAD_CHANGE
}

/// Flow of the motor with its current loop: the torque in the air gap rises towards the wanted one.
fn drive_table<T: Real>(body: &Body, settings: &ObserverSettings, filter: &Filter, step: f64) -> DriveTable<T> {
    let real = T::from_f64;
    let per_inertia = 1.0 / body.motor_inertia;
    let flow = if settings.torque_lag > 0.0 {
        let rate = 1.0 / settings.torque_lag;
        // Angle, speed, taken torque, air-gap torque; the wanted torque is the input.
        let dynamics = DMatrix::from_row_slice(
            4,
            4,
            &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -per_inertia, per_inertia, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -rate],
        );
        flow(&dynamics, &DMatrix::from_row_slice(4, 1, &[0.0, 0.0, 0.0, rate]), step, 1)
    } else {
        let dynamics = DMatrix::from_row_slice(
            4,
            4,
            &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -per_inertia, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        );
        flow(&dynamics, &DMatrix::from_row_slice(4, 1, &[0.0, per_inertia, 0.0, 0.0]), step, 1)
    };
    let (change, response) = (&flow.transition, &flow.input_integrals[0]);
    DriveTable {
        angle: [change[(0, 1)], change[(0, 2)], change[(0, 3)], response[0]].map(real),
        speed: [change[(1, 2)], change[(1, 3)], response[1]].map(real),
        gain: [0, 1, 2].map(|state| real(filter.gain[state])),
        variance: [real(filter.variance[0]), real(filter.variance[2])],
    }
}

fn current<T: Real>(settings: &ObserverSettings, step: f64) -> CurrentTable<T> {
    let whole = libm::floor(settings.torque_delay);
    let rise = if settings.torque_lag > 0.0 { -libm::expm1(-step / settings.torque_lag) } else { 1.0 };
    CurrentTable {
        whole_delay: whole as u32,
        part_delay: T::from_f64(settings.torque_delay - whole),
        rise: T::from_f64(rise),
        limit: T::from_f64(settings.torque_limit),
    }
}

fn counts<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
    step: f64,
) -> Result<CountTable<T>, DesignError> {
    let motor = settings.motor_encoder;
    let output = settings.output_encoder.unwrap_or(motor);
    let geometry = &joint.geometry;
    let weights = integers::Weights::new(
        motor.counts_per_turn,
        output.counts_per_turn,
        geometry.sun_teeth + geometry.ring_teeth,
        geometry.sun_teeth,
    );
    let encoder = |encoder: EncoderSettings, fastest: f64| EncoderTable {
        turn: encoder.counts_per_turn,
        wraps_at: encoder.wraps_at,
        phase: (libm::ldexp(1.0, 64) / f64::from(encoder.counts_per_turn)) as u64,
        // Twice what the speed allows, and never more than what could not be told from the other way round.
        fastest: (libm::ceil(2.0 * fastest * step / TAU * f64::from(encoder.counts_per_turn)) as u32 + 2)
            .min(encoder.counts_per_turn / 2),
        angle: T::from_f64(TAU / f64::from(encoder.counts_per_turn)),
        fraction: T::from_f64(1.0 / f64::from(encoder.counts_per_turn)),
        turns: T::from_f64(1.0 / TAU),
    };
    let unit = TAU / f64::from(motor.counts_per_turn) / weights.motor as f64;
    Ok(CountTable {
        motor: encoder(motor, settings.fastest_motor),
        output: encoder(output, settings.fastest_motor / geometry.ratio_by_teeth()),
        absolute: motor.absolute && output.absolute,
        has_output: settings.output_encoder.is_some(),
        motor_weight: weights.motor,
        output_weight: weights.output,
        modulus: weights.modulus,
        meshes: geometry.ring_teeth,
        length: T::from_f64(unit * geometry.sun_base_radius),
    })
}

/// Digest of what a learnt memory belongs to.
fn identity(joint: &JointParameters, settings: &ObserverSettings) -> u64 {
    let geometry = &joint.geometry;
    let output = settings.output_encoder.map_or(0, |encoder| encoder.counts_per_turn);
    let words = [
        geometry.sun_teeth,
        geometry.planet_teeth,
        geometry.ring_teeth,
        settings.motor_encoder.counts_per_turn,
        output,
    ];
    let named = joint.name.bytes().fold(digest::START, |running, byte| digest::chain(running, byte.into()));
    let counted = words.into_iter().fold(named, |running, word| digest::chain(running, word.into()));
    digest::chain(counted, geometry.sun_base_radius.to_bits())
}

impl ObserverSettings {
    fn check(&self) -> Result<(), DesignError> {
        let within = |what, given: f64, least: f64, most: f64, must_be| {
            if given >= least && given <= most { Ok(()) } else { Err(DesignError::OutOfRange { what, given, must_be }) }
        };
        within("the control rate", self.control_rate.into(), 500.0, 1e5, "from 500 Hz to 100 kHz")?;
        within("the clock rate of the observer's samples", self.clock_rate.into(), 1e4, 4e9, "10 kHz or more")?;
        for encoder in [Some(self.motor_encoder), self.output_encoder].into_iter().flatten() {
            let turn = f64::from(encoder.counts_per_turn);
            within("the number of counts in a turn of an encoder", turn, 64.0, 16_777_216.0, "from 64 to 2^24")?;
            within("the harmonic error of an encoder", encoder.harmonic_error, 0.0, 0.1, "from 0 to 0.1 rad")?;
            let wraps_at = if encoder.wraps_at == 0 { 4_294_967_296.0 } else { f64::from(encoder.wraps_at) };
            let must_be = "a whole number of turns, or 0 for 2^32";
            let whole = encoder.wraps_at == 0 || encoder.wraps_at % encoder.counts_per_turn == 0;
            within("where an encoder's counts wrap", if whole { wraps_at } else { -1.0 }, 64.0, 4.3e9, must_be)?;
        }
        within("the motor's fastest speed", self.fastest_motor, 0.1, 1e5, "positive, in rad/s")?;
        within("the torque delay", self.torque_delay, 0.0, MOST_DELAY as f64 - 1.0, "from 0 to 3 control periods")?;
        within("the current loop's lag", self.torque_lag, 0.0, 0.1, "from 0 to 0.1 s")?;
        within("the motor's torque limit", self.torque_limit, 1e-6, 1e6, "positive and finite")?;
        within("the torque noise", self.torque_noise_ratio, 0.0, 1.0, "from 0 to 1")?;
        within("the torque uncertainty", self.torque_uncertainty, 1e-9, 1e6, "positive and finite")?;
        within("the torque ripple", self.torque_ripple, 0.0, 1e6, "zero or more, and finite")?;
        within("the efficiency", self.efficiency, 0.1, 1.0, "from 0.1 to 1")?;
        within("the uncertainty of the backlash", self.backlash_uncertainty, 1e-6, 10.0, "from 1e-6 to 10")?;
        within("the uncertainty of the compliance", self.compliance_uncertainty, 1e-6, 10.0, "from 1e-6 to 10")?;
        within("the skew", self.skew, -0.1, 0.1, "from -0.1 to 0.1 s")?;
        within("the uncertainty of the skew", self.skew_uncertainty, 0.0, 0.1, "from 0 to 0.1 s")
    }
}
