//! The candidate: probabilities of three modes (back flank, free, drive flank) in place of the observer's deciders.
//!
//! Counts and the steady-state filters of motor and link are the observer's, with its own tables. What is new is `modes`:
//! every likelihood is of the deflection and of the motor side's force, with the covariance that the learner itself has of
//! half-gap, offset, compliance and maps. Whatever is said, learnt or refused follows from those probabilities.

mod faults;
mod filters;
mod learner;
mod modes;

use faults::Faults;
use filters::{Filters, Sensed};
use learner::{COMPLIANCE, HALF_GAP, Learner, P};
use model_core::observer::{ObserverTables, Samples};
use modes::{Evidence, Modes};

use crate::runs::{Said, Stands};

/// What is varied from one candidate to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variant {
    /// How learning is weighted by the probability p of a flank.
    pub weight: Weight,
    /// The deflection's rate tells rest from crossing.
    pub by_rate: bool,
    /// Evidence counts as the same for so many periods.
    pub correlated: f64,
    /// The same in learning intervals.
    pub correlated_intervals: f64,
    /// Innovations may widen the covariance.
    pub inflate: bool,
    /// The lag of the force is taken from its mean rise over as long.
    pub smooth_rise: bool,
    /// What was likely before is so in full, and not only as far as readings are new.
    pub kept: bool,
    /// What the force's noise says of the compliance is taken back.
    pub compensated: bool,
    /// A surprise is first taken for wear.
    pub wear_first: bool,
    /// Dry friction hides forces of a motor that stands still, for what is said too.
    pub hidden: bool,
    /// How often a flank counts beside free teeth for the side that is reported.
    pub lean: f64,
    /// For so many more periods evidence counts as the same while the motor stands still.
    pub alike_at_rest: f64,
    /// Bias and friction are learnt where the place tells that teeth are free, whatever the force.
    pub by_place_alone: bool,
    /// Free teeth are never said to be beyond an edge.
    pub clamped: bool,
    /// And never for teeth that grow.
    pub no_growth: bool,
    /// How often what lags behind takes from the weight of an interval, beside its own variance.
    pub lagging: f64,
    /// Faults are looked for.
    pub faults: bool,
    /// What the means of so many intervals teach is learnt at once; fewer have more noise in their force.
    pub block: f64,
    /// Forces are drawn towards the mean of their flank by what noise explains.
    pub calibrated: bool,
    /// The ripple of the torque counts so many times in it, for a block takes some of its mean.
    pub force_noise: f64,
    /// And noise that intervals do not share so many times.
    pub white_noise: f64,
    /// Evidence of friction that is not known is part of that noise.
    pub force_bias: bool,
    /// A flank counts only with those intervals that had it before, too.
    pub settled: bool,
    /// Part of open teeth that rest: one, and rest says nothing.
    pub free_rest: f64,
    /// What a force may be up to for what is said, in place of `forces`.
    pub forces_now: Forces,
    /// What a force may be.
    pub forces: Forces,
    /// Friction and bias are learnt where the teeth have been free for so many intervals, unless they do not belong to
    /// what is known.
    pub open_for: usize,
    /// Inside the gap the gap coordinate is the deflection, whatever touches.
    pub by_place: bool,
}

/// What forces are expected to be up to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Forces {
    /// The motor's largest.
    Largest,
    /// Half way, by their ratio, between noise and that.
    Light,
    /// The largest of the last second or so.
    Lately,
}

/// How learning is weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// By p.
    Probability,
    /// By what p exceeds all others: 2 p - 1, and nothing below a half.
    Surplus,
}

impl Variant {
    /// The variant of a name: `base`, with changes after it, as in `base+p`.
    pub fn of(name: &str) -> Self {
        let mut variant = Self {
            weight: Weight::Surplus,
            by_rate: false,
            correlated: 3.0,
            correlated_intervals: 2.0,
            inflate: true,
            smooth_rise: true,
            kept: false,
            compensated: true,
            wear_first: true,
            hidden: false,
            lean: 1.0,
            alike_at_rest: 6.0,
            by_place_alone: false,
            clamped: false,
            no_growth: true,
            lagging: 1.0,
            faults: true,
            block: 8.0,
            calibrated: false,
            force_noise: 0.25,
            white_noise: 1.0,
            force_bias: false,
            settled: true,
            free_rest: 1.0,
            forces_now: Forces::Largest,
            forces: Forces::Largest,
            open_for: 3,
            by_place: true,
        };
        for change in name.split('+').skip(1) {
            match change {
                "p" => variant.weight = Weight::Probability,
                "rate" => variant.by_rate = true,
                "white" => (variant.correlated, variant.correlated_intervals) = (1.0, 1.0),
                "n6" => variant.correlated = 6.0,
                "n12" => variant.correlated = 12.0,
                "i1" => variant.correlated_intervals = 1.0,
                "i4" => variant.correlated_intervals = 4.0,
                "keep" => variant.inflate = false,
                "each" => variant.block = 1.0,
                "white.5" => variant.white_noise = 0.5,
                "white2" => variant.white_noise = 2.0,
                "white4" => variant.white_noise = 4.0,
                "ripple.5" => variant.force_noise = 0.5,
                "ripple0" => variant.force_noise = 0.0,
                "noise1" => variant.force_noise = 1.0,
                "noise2" => variant.force_noise = 2.0,
                "noise4" => variant.force_noise = 4.0,
                "biased" => variant.force_bias = true,
                "unsettled" => variant.settled = false,
                "raw" => variant.calibrated = false,
                "moves" => (variant.by_rate, variant.free_rest) = (true, 0.0),
                "rest3" => (variant.by_rate, variant.free_rest) = (true, 0.3),
                "rest1" => (variant.by_rate, variant.free_rest) = (true, 0.1),
                "nowlight" => variant.forces_now = Forces::Light,
                "nowlately" => variant.forces_now = Forces::Lately,
                "light" => variant.forces = Forces::Light,
                "lately" => variant.forces = Forces::Lately,
                "open1" => variant.open_for = 0,
                "bymode" => variant.by_place = false,
                "kept" => variant.kept = true,
                "n9" => variant.correlated = 9.0,
                "calibrated" => (variant.compensated, variant.calibrated) = (false, true),
                "anyhow" => variant.wear_first = false,
                "both" => (variant.compensated, variant.calibrated) = (true, true),
                "hidden" => variant.hidden = true,
                "lean2" => variant.lean = 2.0,
                "lean4" => variant.lean = 4.0,
                "restless" => variant.alike_at_rest = 0.0,
                "rest20" => variant.alike_at_rest = 20.0,
                "rest60" => variant.alike_at_rest = 60.0,
                "byplace" => variant.by_place_alone = true,
                "clamped" => variant.clamped = true,
                "growth" => variant.no_growth = false,
                "nolag" => variant.lagging = 0.0,
                "lag4" => variant.lagging = 4.0,
                "lag16" => variant.lagging = 16.0,
                "rough" => variant.smooth_rise = false,
                "nofaults" => variant.faults = false,
                _ => panic!("no such variant: {change}"),
            }
        }
        variant
    }
}

/// What is learnt, for a compensation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Learnt {
    /// At the output [rad].
    pub offset: f64,
    /// At the output [rad/(N m)].
    pub compliance: f64,
    /// At the carrier [N m].
    pub mesh_torque: f64,
    /// At the motor [N m].
    pub bias: f64,
    /// At the motor [N m].
    pub friction: f64,
    /// Shift of both flanks [m], and its growth for each radian of the link.
    pub flank_shift: f64,
    /// See above.
    pub flank_shift_slope: f64,
    /// It shifts a flank over the middle of the gap.
    pub flanks_swap: bool,
}

/// One estimator of one joint.
pub struct Candidate<'t> {
    tables: &'t ObserverTables<f64>,
    variant: Variant,
    filters: Filters,
    learner: Learner,
    /// Every period: what is said.
    now: Modes,
    /// Every learning interval: what is learnt from.
    lasting: Modes,
    interval: Interval,
    /// What back and drive flank have shown and is not learnt yet.
    blocks: [Block; 2],
    known: Known,
    faults: Faults,
    before: f64,
    /// By how much it rises in a period, and its mean over a few learning intervals [N].
    rise: f64,
    smooth: f64,
    /// The strongest force lately [N].
    strongest: f64,
    /// How free the teeth were in the last intervals, newest first.
    free: [f64; 4],
    /// Modes of the last interval.
    before_modes: [f64; 3],
    /// The motor's strongest torque lately [N m].
    torque: f64,
    /// Sine and cosine of the mesh phase, and the force that is passed on [N].
    mesh: [f64; 2],
    passed: f64,
}

/// Sums over the periods of a learning interval.
#[derive(Debug, Clone, Copy, Default)]
struct Interval {
    periods: u16,
    deflection: f64,
    force: f64,
    lost: f64,
    rate: f64,
    direction: f64,
    free: [f64; P],
    mesh: [f64; 2],
    /// The last interval's force [N].
    last_force: f64,
}

/// Weighted sums over intervals on one flank, and what its forces were.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    weight: f64,
    intervals: f64,
    deflection: f64,
    force: f64,
    noise: f64,
    direction: f64,
    free: [f64; P],
    mesh: [f64; 2],
    /// Blocks that the forces are averaged over, their mean [N] and variance [N^2].
    averaged: f64,
    mean: f64,
    variance: f64,
}

/// Blocks that forces are averaged over at most.
const FORCES: f64 = 64.0;

impl Block {
    /// Begins anew; what its forces were is kept.
    fn clear(&mut self) {
        let Self { averaged, mean, variance, .. } = *self;
        *self = Self { averaged, mean, variance, ..Self::default() };
    }

    /// What the force most likely was: what varies no more than noise does is taken for constant.
    fn calibrate(&mut self, force: f64, noise: f64) -> f64 {
        self.averaged = (self.averaged + 1.0).min(FORCES);
        let by = force - self.mean;
        self.mean += by / self.averaged;
        let beyond = force - self.mean;
        self.variance += (by * beyond - self.variance) / self.averaged;
        if self.variance > noise { self.mean + beyond * (1.0 - noise / self.variance) } else { self.mean }
    }
}

/// Variances that hold until the next learning interval [m^2].
#[derive(Debug, Clone, Copy, Default)]
struct Known {
    /// Of open teeth.
    open: f64,
    /// Of either edge, back then drive, where the deflection is: offset and maps included.
    edges: [f64; 2],
    /// Of the gap coordinate of teeth on a flank, back then drive.
    flanks: [f64; 2],
    /// Of the half-gap.
    half_gap: f64,
    /// By how much more the edges are uncertain for each squared newton.
    per_force: f64,
}

impl<'t> Candidate<'t> {
    /// One that has seen nothing.
    pub fn new(tables: &'t ObserverTables<f64>, variant: Variant) -> Self {
        let mut candidate = Self {
            tables,
            variant,
            filters: Filters::default(),
            learner: Learner::new(tables),
            now: Modes::default(),
            lasting: Modes::default(),
            interval: Interval::default(),
            blocks: [Block::default(); 2],
            known: Known::default(),
            faults: Faults::default(),
            before: 0.0,
            rise: 0.0,
            smooth: 0.0,
            strongest: largest_torque(tables) * tables.levers.per_sun,
            free: [0.0; 4],
            before_modes: [0.0; 3],
            torque: 0.0,
            mesh: [0.0, 1.0],
            passed: 0.0,
        };
        candidate.find_known(&[0.0; P], &[0.0, 1.0]);
        candidate
    }

    /// Takes the samples of a period.
    pub fn step(&mut self, samples: &Samples<f32>) -> Said {
        let tables = self.tables;
        let sensed = self.filters.step(tables, samples);
        let (free, mesh) = learner::regressors(&sensed);
        let [half_gap, compliance] = [HALF_GAP, COMPLIANCE].map(|index| self.learner.value(index));
        let error = self.learner.transmission_error(&mesh);
        let stands = if self.variant.faults { self.watch(tables, &sensed, &free, error) } else { Stands::Both };
        if stands == Stands::Nothing {
            self.filters.hold();
            return self.nothing();
        }
        let unseen = stands == Stands::MotorOnly;
        let contact = &tables.contact;
        let teeth = if unseen { 0.0 } else { sensed.deflection - self.learner.deflection(&free) - error };
        let force = self.learner.bias.force(tables, sensed.lost, sensed.direction);
        // By how much the force that is said lags behind.
        let lag = (tables.learner.force_lag * f64::from(tables.learner.periods)).max(1.0);
        let share = if self.variant.smooth_rise { 1.0 / lag } else { 1.0 };
        self.rise += share * (force - self.before - self.rise);
        let rise = lag * self.rise;
        self.before = force;
        self.smooth += contact.smoothing * (force - self.smooth);

        let evidence = Evidence {
            teeth,
            force,
            half_gap,
            compliance,
            ahead: sensed.rate * contact.lag,
            step: sensed.rate * tables.period,
            rate: None,
            // Nobody sees where the teeth are.
            edges: if unseen {
                [4.0 * half_gap * half_gap; 2]
            } else {
                self.known.edges.map(|edge| edge + self.known.per_force * force * force)
            },
            deflection_variance: tables.drive.variance[0] * tables.levers.sun.powi(2)
                + tables.load.variance[0] * tables.levers.output.powi(2),
            force_variance: contact.force_variance
                + contact.ripple_variance
                + self.learner.bias.variance_at(sensed.direction)
                + if self.variant.hidden {
                    (1.0 - sensed.direction.powi(2)) * self.learner.bias.friction.powi(2)
                } else {
                    0.0
                }
                + rise * rise,
            usual_force: 0.0,
            speed: tables.contact.rate_deviation * tables.period,
        };
        let evidence = if unseen {
            // What the motor feels is all there is, and it must stand out by itself.
            let noise = contact.force_variance * contact.smoothing + (force - self.smooth).powi(2) * contact.smoothing;
            let known = contact.ripple_variance + self.learner.bias.variance_at(sensed.direction);
            Evidence { force: self.smooth, force_variance: known + noise, ..evidence }
        } else {
            evidence
        };
        let evidence = Evidence { usual_force: self.usual_force(self.variant.forces_now, evidence.force_variance), ..evidence };
        // What stands still says the same for longer.
        let alike = self.variant.correlated + self.variant.alike_at_rest * (1.0 - sensed.direction.powi(2));
        self.now.step(&evidence, alike, self.variant.kept);

        // The link feels what the meshes most likely pass on.
        let passed = self.now.force(&evidence);
        (self.mesh, self.passed) = (mesh, passed);
        self.filters.pass(tables.levers.output * passed);
        if unseen {
            self.filters.follow(tables);
            return self.say_unseen(error);
        }
        self.add(tables, &sensed, &free, &mesh, force);
        self.say(&evidence, error, &sensed)
    }

    /// Looks for faults of the encoders, and does what follows from them.
    fn watch(&mut self, tables: &ObserverTables<f64>, sensed: &Sensed, free: &[f64; P], error: f64) -> Stands {
        let [half_gap, compliance] = [HALF_GAP, COMPLIANCE].map(|index| self.learner.value(index));
        let before = self.faults.stands();
        let deflection = if before == Stands::Both { sensed.deflection } else { sensed.counted };
        let teeth = deflection - self.learner.deflection(free) - error;
        let side = teeth.signum();
        let force = self.learner.bias.force(tables, sensed.lost, sensed.direction);
        let wind_up = compliance * (side * force).max(0.0);
        let variance = self.known.edges[usize::from(side > 0.0)]
            + self.known.per_force * force * force
            + tables.contact.deflection_variance
            + tables.learner.noise.powi(2);
        let place = faults::Place {
            beyond: side * teeth - half_gap - wind_up,
            variance,
            // Teeth wear, by as much as their gap at most.
            margin: tables.supervisor.margin + 3.0 * variance.sqrt() + half_gap,
        };
        self.torque = sensed.air_gap.abs().max(0.95 * self.torque);
        let found = self.faults.step(tables, sensed, &place, self.torque);
        if found != faults::Found::Nothing {
            if before == Stands::Nothing {
                self.filters.restart(tables);
            } else {
                self.filters.follow(tables);
            }
        }
        if found == faults::Found::Elsewhere {
            // Teeth in the middle of the gap are the best guess.
            self.learner.move_to(teeth);
        }
        let stands = self.faults.stands();
        if stands != before {
            self.filters.rely([stands != Stands::Nothing, stands == Stands::Both]);
            self.interval = Interval::default();
            self.blocks.iter_mut().for_each(Block::clear);
        }
        stands
    }

    /// What can be said without the output encoder: teeth that press are on their flank.
    fn say_unseen(&self, error: f64) -> Said {
        let half_gap = self.learner.value(HALF_GAP);
        let [back, drive] = self.now.touching();
        let pressed = half_gap + self.tables.learner.mesh_compliance * self.smooth.abs();
        let mean = pressed * (drive - back);
        let compliance = self.learner.value(COMPLIANCE);
        let [_, lasting] = self.learner.bias.lasting(self.tables, compliance, 1.0);
        let error_variance = self.known.flanks[1] + lasting + self.tables.contact.deflection_variance;
        let variance = error_variance + half_gap * half_gap * (back + drive - (drive - back).powi(2))
            + (1.0 - back - drive) * half_gap * half_gap;
        let widest = 2.0 * half_gap * self.tables.supervisor.widest_part;
        Said {
            gap: mean + error,
            gap_variance: variance,
            gap_valid: variance < widest * widest,
            side: self.now.side(self.variant.lean),
            stands: Stands::MotorOnly,
            ..self.nothing()
        }
    }

    fn say(&self, evidence: &Evidence, error: f64, sensed: &Sensed) -> Said {
        let tables = self.tables;
        let Evidence { half_gap, compliance, teeth, .. } = *evidence;
        let share = tables.learner.mesh_compliance / compliance.max(tables.learner.mesh_compliance);
        let noise = tables.contact.deflection_variance;
        let step = sensed.rate * tables.period;
        let lasting = self.learner.bias.lasting(tables, compliance, sensed.direction);
        let places = self.now.sides().map(|(probability, side)| {
            if side == 0.0 {
                let place = if self.variant.clamped { teeth.clamp(-half_gap, half_gap) } else { teeth };
                (probability, place, self.known.open + lasting[0] + noise + step * step)
            } else {
                let beyond = (side * teeth - half_gap).max(0.0);
                let flank = self.known.flanks[usize::from(side > 0.0)];
                let inside = self.variant.by_place && side * teeth < half_gap;
                let place = if inside { teeth.clamp(-half_gap, half_gap) } else { side * (half_gap + share * beyond) };
                (probability, place, flank + lasting[1] + noise)
            }
        });
        let mean: f64 = places.iter().map(|(probability, place, _)| probability * place).sum();
        let variance: f64 =
            places.iter().map(|(probability, place, variance)| probability * (variance + (place - mean).powi(2))).sum();
        let widest = 2.0 * half_gap * tables.supervisor.widest_part;
        let width_variance = self.known.half_gap + lasting[1];
        Said {
            gap: mean + error,
            gap_variance: variance,
            gap_valid: variance < widest * widest,
            side: self.now.side(self.variant.lean),
            width: half_gap / 2.0,
            width_variance: width_variance / 4.0,
            width_valid: half_gap > 0.0 && width_variance < (half_gap / 8.0).powi(2),
            stands: Stands::Both,
        }
    }

    /// Nothing can be said.
    fn nothing(&self) -> Said {
        let half_gap = self.learner.value(HALF_GAP);
        Said {
            gap: 0.0,
            gap_variance: half_gap * half_gap,
            gap_valid: false,
            side: 0,
            width: half_gap / 2.0,
            width_variance: self.known.half_gap / 4.0,
            width_valid: false,
            stands: Stands::Nothing,
        }
    }

    fn add(&mut self, tables: &ObserverTables<f64>, sensed: &Sensed, free: &[f64; P], mesh: &[f64; 2], force: f64) {
        let of = &mut self.interval;
        let part = tables.learner.per_periods;
        of.periods += 1;
        of.deflection += part * sensed.deflection;
        of.force += part * force;
        of.lost += part * sensed.lost;
        of.rate += part * sensed.rate;
        of.direction += part * sensed.direction;
        of.free.iter_mut().zip(free).for_each(|(sum, value)| *sum += part * value);
        of.mesh.iter_mut().zip(mesh).for_each(|(sum, value)| *sum += part * value);
        if of.periods >= tables.learner.periods {
            self.close(tables);
        }
    }

    /// Ends a learning interval: modes by its means, then what each of them teaches, weighted by how likely it is.
    fn close(&mut self, tables: &ObserverTables<f64>) {
        let Interval { deflection, force, lost, rate, direction, free, mesh, last_force, .. } = self.interval;
        self.interval = Interval { last_force: force, ..Interval::default() };
        let (table, contact) = (&tables.learner, &tables.contact);
        let [half_gap, compliance] = [HALF_GAP, COMPLIANCE].map(|index| self.learner.value(index));
        let rise = (force - last_force) * table.force_lag;
        let force = force + rise;
        let lag = rate * contact.lag;
        // A motor that stands still hides a force by its dry friction.
        let hidden = (1.0 - direction * direction) * self.learner.bias.friction.powi(2);
        let noise = table.noise * table.noise;
        let levers = &tables.levers;
        let per_inertia = -tables.drive.speed[0] / tables.period;
        let still = 1.0 - direction * direction;
        let evidence = Evidence {
            teeth: deflection - self.learner.deflection(&free) - self.learner.transmission_error(&mesh),
            force,
            half_gap,
            compliance,
            ahead: lag,
            step: rate * table.span,
            rate: self.variant.by_rate.then(|| modes::Rate {
                value: rate - compliance * rise / (table.force_lag * table.span),
                deviation: contact.rate_deviation,
                free: (4.0 * half_gap * largest_torque(tables) * levers.sun * per_inertia).sqrt(),
                may_rest: self.variant.free_rest,
            }),
            edges: self.known.edges.map(|edge| edge + self.known.per_force * force * force),
            deflection_variance: noise,
            force_variance: contact.force_variance * table.per_periods
                + contact.ripple_variance
                + self.learner.bias.variance_at(direction)
                + rise * rise
                + hidden,
            usual_force: 0.0,
            speed: contact.rate_deviation * table.span,
        };
        self.strongest += (force.abs() - self.strongest).max(-self.strongest * table.span / LATELY);
        let evidence = Evidence { usual_force: self.usual_force(self.variant.forces, evidence.force_variance), ..evidence };
        self.lasting.step(&evidence, self.variant.correlated_intervals, false);
        let [back, drive] = self.lasting.touching();
        self.free.rotate_right(1);
        self.free[0] = 1.0 - back - drive;
        let lags = lag * lag + (compliance * rise).powi(2);
        let before = std::mem::replace(&mut self.before_modes, self.lasting.sides().map(|(probability, _)| probability));
        for ((probability, side), before) in self.lasting.sides().into_iter().zip(before) {
            let probability = if self.variant.settled { probability.min(before) } else { probability };
            let weight = match self.variant.weight {
                Weight::Probability => probability,
                Weight::Surplus => (2.0 * probability - 1.0).max(0.0),
            };
            if weight < 1e-3 {
                continue;
            }
            if side == 0.0 {
                let open = self.free.iter().take(self.variant.open_for + 1).fold(1.0, |least: f64, free| least.min(*free));
                // Not by the force that is learnt from.
                let open = if self.variant.by_place_alone { open.min(evidence.inside_both()) } else { open };
                let weight = (2.0 * open - 1.0).max(1e-3);
                self.learner.bias.learn(contact, lost, direction, weight, self.variant.open_for > 0);
            } else {
                // A motor that stands still says the same again and again.
                let weight = weight * (1.0 - still).max(0.02) / (1.0 + self.variant.lagging * lags / noise);
                let block = &mut self.blocks[usize::from(side > 0.0)];
                block.weight += weight;
                block.intervals += 1.0;
                block.deflection += weight * deflection;
                block.force += weight * force;
                block.noise += weight * lags;
                block.direction += weight * direction;
                block.free.iter_mut().zip(&free).for_each(|(sum, value)| *sum += weight * value);
                block.mesh.iter_mut().zip(&mesh).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        for side in [-1.0, 1.0] {
            let index = usize::from(side > 0.0);
            let touches = self.lasting.touching();
            let full = self.blocks[index].intervals >= self.variant.block;
            if self.blocks[index].intervals > 0.0 && (full || touches[index] < 0.1) {
                self.conclude(tables, side, noise);
            }
        }
        self.learner.age(tables);
        self.find_known(&free, &mesh);
    }

    /// What a force may be up to [N], whose noise has this variance.
    fn usual_force(&self, forces: Forces, variance: f64) -> f64 {
        let largest = largest_torque(self.tables) * self.tables.levers.per_sun;
        let noise = variance.sqrt();
        match forces {
            Forces::Largest => largest,
            Forces::Light => (noise * largest).sqrt(),
            Forces::Lately => self.strongest.max(3.0 * noise).min(largest),
        }
    }

    /// Learns what a flank has shown.
    fn conclude(&mut self, tables: &ObserverTables<f64>, side: f64, noise: f64) {
        let table = &tables.learner;
        let block = &mut self.blocks[usize::from(side > 0.0)];
        let per = 1.0 / block.weight;
        let (deflection, force, lags) = (per * block.deflection, per * block.force, per * block.noise);
        let (free, mesh) = (block.free.map(|sum| per * sum), block.mesh.map(|sum| per * sum));
        let share = block.weight / f64::from(table.block);
        let contact = &tables.contact;
        let white = contact.force_variance * table.per_periods / block.intervals.max(1.0);
        let mut force_noise = self.variant.white_noise * white + self.variant.force_noise * 0.5 * contact.ripple_variance;
        if self.variant.force_bias {
            force_noise += self.learner.bias.variance_at(block.direction * per);
        }
        let force = if self.variant.calibrated { block.calibrate(force, force_noise) } else { force };
        block.clear();
        let touch = learner::touching(&free, side, force, &mesh);
        let how = learner::How {
            inflate: self.variant.inflate,
            wear_first: self.variant.wear_first,
            no_growth: self.variant.no_growth,
            force_noise: if self.variant.compensated { force_noise } else { 0.0 },
        };
        self.learner.learn(&touch, deflection, (noise + lags) / share, share, how);
    }

    /// Variances for the periods to come.
    fn find_known(&mut self, free: &[f64; P], mesh: &[f64; 2]) {
        let variance = |regressors: &[f64; P]| self.learner.variance(regressors);
        let edge = |side: f64| learner::touching(free, side, 0.0, mesh);
        let flank = |side: f64| learner::touching(&[0.0; P], side, 0.0, mesh);
        let mut force = [0.0; P];
        force[COMPLIANCE] = 1.0;
        let mut width = [0.0; P];
        width[HALF_GAP] = 1.0;
        self.known = Known {
            open: variance(free),
            edges: [-1.0, 1.0].map(|side| variance(&edge(side))),
            flanks: [-1.0, 1.0].map(|side| variance(&flank(side))),
            half_gap: variance(&width),
            per_force: variance(&force),
        };
    }

    /// What it has learnt, for a compensation.
    pub fn learnt(&self) -> Learnt {
        let levers = &self.tables.levers;
        let [sine, cosine] = self.mesh;
        let amplitude = self.learner.value(learner::ERROR).hypot(self.learner.value(learner::ERROR + 1));
        Learnt {
            offset: self.learner.value(learner::OFFSET) * levers.per_output,
            compliance: self.learner.value(COMPLIANCE) * levers.per_output.powi(2),
            mesh_torque: self.passed * levers.output,
            bias: self.learner.bias.bias * levers.sun,
            friction: self.learner.bias.friction * levers.sun,
            flank_shift: self.learner.transmission_error(&self.mesh),
            flank_shift_slope: self.learner.transmission_error(&[cosine, -sine]) * self.tables.counts.mesh_periods,
            flanks_swap: amplitude > self.learner.value(HALF_GAP),
        }
    }

    /// What it thinks, for traces.
    pub fn inside(&self) -> String {
        let [back, free, drive] = self.lasting.sides().map(|(probability, _)| probability);
        let now = self.now.sides().map(|(probability, _)| format!("{probability:.2}")).join(" ");
        format!("{now} | {back:.2} {free:.2} {drive:.2} | sd c {:.1} um | {}", 1e6 * self.known.half_gap.sqrt(), self.learner)
    }
}

/// Time in which a strong force is forgotten [s].
const LATELY: f64 = 1.0;

/// The motor's largest torque [N m]: samples of up to twice that are believed.
fn largest_torque(tables: &ObserverTables<f64>) -> f64 {
    0.5 * tables.current.believed
}
