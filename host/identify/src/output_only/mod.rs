//! `joint identify --output-only`: estimates inertia, friction and weight, and an upper bound of the lost motion, from
//! the output's angle and the motor's torque, for a joint whose motor has no encoder. `swings` finds the motions of the
//! output between two turning points during which the torque reverses. `swing_fit` fits a balance of torques to all
//! swings. While the motor crosses the gap, the output coasts; `crossing` derives the upper bound from the coasting
//! distance.

mod crossing;
mod swing_fit;
mod swings;

use super::arguments::Arguments;
use super::estimate::{Estimate, NORMAL_QUANTILE};
use super::findings::gap::{Shown, static_findings};
use super::findings::{FOUND_INTERVAL_SHARE, Finding, finding};
use super::one_encoder;
use super::pictures::thinning;
use super::prior::PriorModel;
use super::results::Results;
use joint_file::named::Loaded;
use log_reader::columns::{Columns, OUTPUT, TIMES};
use log_reader::resolution::resolution;
use log_reader::time_stamps;
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{MILLISECONDS, Unit};
use swing_fit::{Expected, Integrals, SHARED, Samples, SwingFit};
use swings::{Swing, swings};

/// Fewest swings: the scatter needs four swings beyond the number of shared unknowns.
const SWINGS_MIN: usize = SHARED + 4;
/// Bias of friction and weight that the simplified balance of torques may cause, over the largest torque [-]. Measured
/// on simulated logs; twice the share for logs of both encoders.
const BALANCE_BIAS: f64 = 0.003;

/// Log of the output's angle and the motor's torque.
struct OutputLog {
    /// Time since the first sample [s].
    time: Vec<f64>,
    /// Output angle [rad].
    angle: Vec<f64>,
    /// Motor torque times the ratio [N m].
    torque: Vec<f64>,
    /// Step of the encoder [rad].
    resolution: f64,
    /// Changes to the rows, a sentence each.
    notes: Vec<String>,
}

/// Identifies a joint from a log of its output and the motor's torque.
pub fn identify(arguments: &Arguments, loaded: &Loaded, prior: &PriorModel) -> Outcome<Results> {
    let at_path = |failure: Failure| failure.while_doing(arguments.log.display());
    let log = OutputLog::read(arguments, prior)?;
    let swings = log.swings().map_err(at_path)?;
    let expected = Expected {
        step_by_torque: prior.motor_share() * (1.0 - prior.motor_share()) * prior.compliance,
        inertia: prior.total_inertia(),
    };
    let integrals = Integrals::new(Samples { time: &log.time, angle: &log.angle, torque: &log.torque });
    let fit = SwingFit::fit(&integrals, &swings, expected).ok_or_else(|| {
        at_path(
            Failure::new("the swings of this log do not determine a balance of torques")
                .with_help("let the torque step to and fro with three strengths, and log more samples a swing"),
        )
    })?;
    check(&fit, prior.motor_at_output()).map_err(at_path)?;
    Ok(Results {
        duration: log.time.last().copied().unwrap_or_default(),
        crossings: swings.len(),
        assumptions: assumptions(&log, &swings, &fit, prior),
        figures: vec![picture(&fit)],
        findings: findings(&integrals, &swings, &fit, loaded, prior),
    })
}

impl OutputLog {
    fn read(arguments: &Arguments, prior: &PriorModel) -> Outcome<Self> {
        let accepts = |columns: &Columns| columns.has_required_of([false, true]);
        arguments.read_log(prior.ratio(), accepts, |columns| Self::from_columns(columns, prior))
    }

    fn from_columns(columns: &mut Columns, prior: &PriorModel) -> Outcome<Self> {
        columns.remove_incomplete(&[&TIMES, &OUTPUT, &["motor_torque_N_m"]])?;
        time_stamps::resolve(columns)?;
        let (angle, resolution) =
            one_encoder::angle(columns, OUTPUT, prior.output_turn)?.ok_or_else(|| columns.missing_encoder("output"))?;
        let time = one_encoder::rising_time(columns)?;
        let torque = one_encoder::torque_at_output(columns, prior.ratio())?;
        Ok(Self { time, angle, torque, resolution, notes: columns.notes().to_vec() })
    }

    fn swings(&self) -> Outcome<Vec<Swing>> {
        let found = swings(&self.angle, &self.torque, self.resolution);
        if found.len() >= SWINGS_MIN {
            return Ok(found);
        }
        let turned: Vec<f64> = self.torque.iter().map(|torque| -torque).collect();
        if swings(&self.angle, &turned, self.resolution).len() >= SWINGS_MIN {
            return Err(Failure::new(
                "the torque brakes where it should drive: torque and output have different signs",
            )
            .with_help("reverse the sign of one of them, so that the output counts up under positive torque"));
        }
        Err(Failure::new(format!(
            "too few reversals: the torque steps from driving to braking in {} swings of the output; {SWINGS_MIN} are needed",
            found.len()
        ))
        .with_help(
            "step the motor's torque between both signs with three strengths, eight times each; let the output move by 20 counts or more \
             before and after each step",
        ))
    }
}

/// Rejects a fit that no joint can have: no response to the torque, or less inertia than the motor alone (`motor`, at
/// the output [kg m^2]).
fn check(fit: &SwingFit, motor: f64) -> Outcome<()> {
    let Estimate { value, half } = fit.estimate(swing_fit::TORQUE);
    if value <= half {
        return Err(Failure::new("the output does not follow the torque in this log")
            .with_help("check which columns output and torque are, and that the torque is well above the friction"));
    }
    let inertia = 1.0 / (value - half);
    if inertia < 0.8 * motor {
        return Err(Failure::new(format!(
            "torque over acceleration of the output is {} kg m^2, and the motor alone has {} kg m^2 at the output by the joint file",
            ESTIMATE.write(inertia),
            ESTIMATE.write(motor)
        ))
        .with_help("check the unit of the torque, rotor_inertia_kg_m2 and the ratio of the joint file"));
    }
    Ok(())
}

fn findings(
    integrals: &Integrals<'_>,
    swings: &[Swing],
    fit: &SwingFit,
    loaded: &Loaded,
    prior: &PriorModel,
) -> Vec<Finding> {
    let inverse = fit.estimate(swing_fit::TORQUE);
    let loss = fit.torque_of(swing_fit::LOSS).value;
    let largest = swings.iter().flat_map(|swing| swing.torque).fold(0.0, f64::max);
    // The loss of the gears differs between driving and braking, which biases the torque scale by 2 loss^2. Friction
    // and weight change the torque through the teeth, and the loss with it.
    let scale = (NORMAL_QUANTILE * prior.torque_error).hypot(inverse.half / inverse.value) + 2.0 * loss * loss;
    let scaled = |estimate: Estimate| estimate.with_independent_error(scale * estimate.value);
    let inertia = scaled(Estimate { value: 1.0 / inverse.value, half: 0.0 });
    let beside = prior.total_inertia() - loaded.file.parameters.link_inertia;
    let link = Estimate { value: inertia.value - beside, ..inertia }
        .with_independent_error(NORMAL_QUANTILE * prior.inertia_error * beside);
    let of_balance = BALANCE_BIAS * largest;
    let dry = fit.torque_of(swing_fit::DRY);
    let dry = scaled(dry).widened_by(loss * dry.value).widened_by(of_balance);
    let fastest = fit.fastest;
    let viscous = scaled(fit.torque_of(swing_fit::VISCOUS));
    let viscous = viscous.widened_by(loss * viscous.value).widened_by(of_balance / fastest);
    let found =
        |estimate: Estimate, least: f64| estimate.half < (FOUND_INTERVAL_SHARE * estimate.value.abs()).max(least);
    let why = "the output must swing with torques of three strengths that are well above the friction";
    let mut findings = gap(integrals, swings, fit, prior, inertia);
    findings.push(
        finding("inertia of motor and link at the output", "kg m^2", "", inertia).only_if(found(inertia, 0.0), why),
    );
    findings.push(
        finding("inertia of the link", "kg m^2", "bodies.link_inertia_kg_m2", link)
            .only_if(link.value > 0.0 && found(link, 0.0), "the motor's inertia is most of what turns")
            .with_note("with the rotor's as stated"),
    );
    let small = 4.0 * of_balance;
    findings.push(
        finding("dry friction of motor and link at the output", "N m", "", dry)
            .only_if(found(dry, small), why)
            .not_negative(),
    );
    let around = &prior.surroundings;
    let ratio = prior.ratio();
    let note = "if the motor's is as stated";
    let dry_of_link = Estimate { value: dry.value - ratio * around.motor_friction.coulomb, ..dry };
    let of_link = |estimate: Estimate, least: f64| estimate.value + estimate.half > 0.0 && found(estimate, least);
    let why_link = "the motor's friction as the joint file states it is most of what is found, or more";
    findings.push(
        finding("dry friction of the link", "N m", "drive_train.load_coulomb_friction_N_m", dry_of_link)
            .only_if(of_link(dry_of_link, small), why_link)
            .not_negative()
            .with_note(note),
    );
    let why_viscous = "the output must move for a while, in both directions and at different speeds";
    let small = small / fastest;
    findings.push(
        finding("viscous friction of motor and link at the output", "N m s/rad", "", viscous)
            .only_if(found(viscous, small), why_viscous)
            .not_negative(),
    );
    let viscous_of_link = Estimate { value: viscous.value - ratio * ratio * around.motor_friction.viscous, ..viscous };
    let key = "drive_train.load_viscous_friction_N_m_s_per_rad";
    findings.push(
        finding("viscous friction of the link", "N m s/rad", key, viscous_of_link)
            .only_if(of_link(viscous_of_link, small), why_link)
            .not_negative()
            .with_note(note),
    );
    let [sine, cosine] = [swing_fit::SINE, swing_fit::COSINE].map(|unknown| fit.torque_of(unknown).value);
    let weight = sine.hypot(cosine);
    let slopes = [(swing_fit::SINE, sine / weight), (swing_fit::COSINE, cosine / weight)];
    let half = fit.half(&slopes.map(|(unknown, slope)| (unknown, slope / inverse.value)));
    let weight = scaled(Estimate { value: weight, half }).widened_by(loss * weight).widened_by(of_balance);
    let hangs = (-cosine).atan2(sine).to_degrees();
    findings.push(
        finding("weight of the link", "N m", "drive_train.gravity_torque_N_m", weight)
            .only_if(
                weight.half < FOUND_INTERVAL_SHARE * weight.value,
                "the link must turn far, with its weight well above the friction",
            )
            .with_note(format!("the link hangs down at {hangs:.0} deg of the log's angle")),
    );
    findings
}

/// Half-backlash and lost motion as upper bounds; the compliance, which the output alone does not show, without a
/// value.
fn gap(
    integrals: &Integrals<'_>,
    swings: &[Swing],
    fit: &SwingFit,
    prior: &PriorModel,
    inertia: Estimate,
) -> Vec<Finding> {
    // The inertia before the gap lies between the sun's side alone and everything that turns with the motor.
    let wrong = NORMAL_QUANTILE * prior.inertia_error;
    let sun = prior.sun_inertia * prior.ratio() * prior.ratio();
    let least = (sun * (1.0 - wrong) / (inertia.value + inertia.half)).min(1.0);
    let most = (prior.motor_at_output() * (1.0 + wrong) / (inertia.value - inertia.half)).min(1.0);
    let bound = crossing::bound(integrals, swings, fit, [least, most]);
    let why = match bound {
        Ok(_) => format!(
            "while the motor crosses the gap, the output moves on by the motor's share of the inertia ({:.0} % at least) times the lost \
             motion, less the bouncing of the teeth; an encoder at the motor or a held output (--output-locked) shows the lost motion itself",
            100.0 * least
        ),
        Err(why) => format!("not even an upper bound: {why}"),
    };
    let unknown = Estimate { value: f64::NAN, half: f64::NAN };
    let bend = Shown { is_shown: false, why: "the output alone does not show the twist" };
    let found = static_findings(prior, [unknown; 3], [Shown { is_shown: false, why: &why }, bend]);
    let bounded = |one: Finding| match (bound, one.unit.as_str()) {
        (Ok(most), "um") => one.with_upper_bound(1e6 * prior.lever * 0.5 * most),
        (Ok(most), "mrad") => one.with_upper_bound(1e3 * most),
        _ => one,
    };
    found.into_iter().map(bounded).collect()
}

/// Assumptions behind the numbers.
fn assumptions(log: &OutputLog, swings: &[Swing], fit: &SwingFit, prior: &PriorModel) -> Vec<String> {
    let torques = swings.iter().flat_map(|swing| swing.torque);
    let (least, most) =
        torques.fold((f64::MAX, 0.0_f64), |(least, most), torque| (least.min(torque), most.max(torque)));
    let mut list = vec![
        format!(
            "The motor's angle is not read, as stated: {} swings of the output on which the torque reverses, {} to {} N m at the output.",
            swings.len(),
            ESTIMATE.write(least),
            ESTIMATE.write(most)
        ),
        format!(
            "The torque scale is expected to be right within {:.1} % and the rotor inertia within {:.1} % (one standard deviation); all \
             intervals include both.",
            100.0 * prior.torque_error,
            100.0 * prior.inertia_error
        ),
        format!(
            "The log shows the frictions of motor and link together; the link's part is their sum less the motor's friction in the joint \
             file. The gears lose {} % of the torque in addition.",
            ESTIMATE.write(100.0 * fit.torque_of(swing_fit::LOSS).value)
        ),
        format!(
            "Torque and reading are late by {} ms together; the fit removes this delay.",
            ESTIMATE.write(1e3 * fit.delay)
        ),
        format!("Ratio {} / {}; output encoder of {}.", prior.teeth[1], prior.teeth[0], resolution(prior.output_turn)),
    ];
    list.extend(log.notes.iter().cloned());
    list
}

/// Residuals of the fit over the time since the reversal.
fn picture(fit: &SwingFit) -> Figure {
    let every = thinning(fit.residuals.len());
    let points: Vec<(f64, f64)> = fit.residuals.iter().copied().step_by(every).collect();
    let range = points.iter().fold((0.0_f64, 0.0_f64), |(from, to), (time, _)| (from.min(*time), to.max(*time)));
    let marks = vec![Mark::Points { points, ink: Ink::First, label: "samples".into(), size: 2.0 }];
    let unit = Unit::of_angle(6.0 * fit.residual);
    let panel = Panel { height: 420, ..Panel::lines("Output less the fit", unit, marks) };
    let note = "A good fit leaves scatter within a count of the encoder; a wave after the reversal is the ringing of the joint.".into();
    Figure {
        note,
        ..Figure::new("Residuals around the reversals", "time after the reversal", MILLISECONDS, range, vec![panel])
    }
}
