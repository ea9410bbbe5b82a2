//! How uncertain everything is that was learnt: variances and what follows from them, brought up to date a part an
//! interval, so that no period has to do it all.

use super::bias::Bias;
use super::learner::Learner;
use super::regressors::{self, COMPLIANCE, ERROR, HALF_GAP, OFFSET, Regressors, SKEW, Touch};
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::ObserverTables;

/// Parts in which variances are brought up to date.
const PARTS: u8 = 4;

/// What holds from the end of an interval until the next.
#[derive(Debug, Clone, Copy)]
pub struct Uncertainty<T: Real> {
    /// Standard deviation of the mesh force from the motor side [N].
    pub force_deviation: T,
    /// The same over an interval.
    pub mean_force_deviation: T,
    /// The same over the few intervals that contact takes to settle.
    pub steady_force_deviation: T,
    /// The same with the deflection's help.
    pub both_deviation: T,
    /// Variance of the deflection with everything taken out that was learnt [m^2].
    pub deflection_variance: T,
    /// Standard deviation of the deflection less the nearer edge [m].
    pub edge_deviation: T,
    /// Variance of everything that was learnt from forces, by what stays wrong of them, bias and ripple as wind-up: of the
    /// deflection, and of a flank, whose distance from the other is free of bias [m^2].
    pub wind_up_variance: [T; 2],
    /// Variances of half-gap [m^2], offset [m^2], compliance [m^2/N^2] and skew [m^2 s^2].
    pub variances: [T; 4],
    /// Distance from an edge that noise and ignorance can make [m].
    pub blur: T,
    /// Distance from an edge within which teeth that come across the gap count as touching [m].
    pub near: T,
    /// Weight of the deflection beside the motor side in the mesh force [-].
    pub position_weight: T,
    /// Whether positions decide about contact that is learnt from.
    pub half_gap_is_known: bool,
    /// Whether they decide about contact that is reported.
    pub half_gap_serves: bool,
    /// 1 over the compliance [N/m].
    pub stiffness: T,
    /// Part of the compliance that the meshes have.
    pub mesh_share: T,
    /// By how much the compliance may be wrong: two standard deviations [m/N].
    pub softness: T,
    /// As wide as the guess lets the half-gap be, until it has been seen on both flanks for long: what was learnt of a gap by one
    /// flank, or by counts wider than the gap, may be sure and wrong. Zero from then on [m].
    pub guessed_half_gap: T,
    /// Furthest from the middle of the gap that the deflection can be without wind-up [m].
    pub reach: T,
    /// Variance of the gap coordinate while teeth touch, and while they do not [m^2].
    pub gap_variance: [T; 2],
    /// The largest with which it is valid; zero without a half-gap, and in a gap narrower than a count [m^2].
    pub widest_variance: T,
    /// Whether the transmission error shifts a flank over the middle of the gap.
    pub flanks_swap: bool,
    /// The last interval was in settled contact.
    pub settled: bool,
    /// Standard deviation of a rest's noise over that of the encoders' noise, at least 1 [-]. Effects that the model lacks count as noise.
    pub rest_deviation: T,
    /// Mean of the normalised innovations of rests, positive where the rests show a wider gap [-].
    half_gap_error: T,
    /// What comes next.
    turn: u8,
}

impl<T: Real> Uncertainty<T> {
    /// Part of an interval's noise that the steady force has, as a variance [-]: an average that follows by a quarter has
    /// 1/7, less what intervals next to each other share.
    const STEADY_NOISE: T = T::EIGHTH;

    /// Largest distance from a flank within which teeth count as touching, as a part of the half-gap [-]: what the gap
    /// coordinate may be off by and still be worth compensating.
    const NEAREST: T = T::TWENTIETH;

    /// Share of a rest in the mean over rests [-].
    const OF_A_REST: T = T::TWENTIETH;

    /// Mean normalised innovation beyond which the half-gap has changed [-]. Derived: the mean over rests of independent noise has a standard
    /// deviation of sqrt(share / (2 - share)) = 0.16, so that 1 is six of them.
    const HALF_GAP_CHANGED: T = T::ONE;

    /// An uncertainty that has not taken its tables yet.
    #[inline(always)]
    pub fn unbegun() -> Self {
        Self {
            force_deviation: T::ZERO,
            mean_force_deviation: T::ZERO,
            steady_force_deviation: T::ZERO,
            both_deviation: T::ZERO,
            deflection_variance: T::ZERO,
            edge_deviation: T::ZERO,
            wind_up_variance: [T::ZERO; 2],
            variances: [T::ZERO; 4],
            blur: T::ZERO,
            near: T::ZERO,
            position_weight: T::ZERO,
            half_gap_is_known: false,
            half_gap_serves: false,
            stiffness: T::ZERO,
            mesh_share: T::ZERO,
            softness: T::ZERO,
            guessed_half_gap: T::ZERO,
            reach: T::ZERO,
            gap_variance: [T::ZERO; 2],
            widest_variance: T::ZERO,
            flanks_swap: false,
            settled: false,
            rest_deviation: T::ONE,
            half_gap_error: T::ZERO,
            turn: 0,
        }
    }

    /// Back to what holds before anything is learnt.
    pub fn restart<const P: usize>(&mut self, tables: &ObserverTables<T>, learner: &Learner<T, P>) {
        *self = Self::unbegun();
        let free = regressors::free(T::ZERO, 0, Some(0));
        let touch = Touch { flank: Some(Flank::Drive), ..Touch::NONE };
        self.of_force(tables, &Bias::new(&tables.contact), learner.value(COMPLIANCE), T::ZERO);
        for _ in 0..PARTS {
            self.next(tables, learner, &free, &touch);
        }
        self.of_learnt(tables, learner, false);
    }

    /// How well the motor side knows the mesh force.
    pub fn of_force(&mut self, tables: &ObserverTables<T>, bias: &Bias<T>, compliance: T, direction: T) {
        let contact = &tables.contact;
        let known = bias.variance_at(direction) + contact.ripple_variance;
        let ripple = T::HALF * contact.ripple_variance;
        let [_, friction, _] = bias.variance;
        // What of the force's variance no mean takes away, with bias and without.
        let lasting = [bias.variance_at(direction) + ripple, direction * direction * friction * T::HALF + ripple];
        self.wind_up_variance = lasting.map(|force| force * compliance * compliance);
        self.force_deviation = (known + contact.force_variance).square_root();
        let noise = contact.force_variance * tables.learner.per_periods * Self::STEADY_NOISE;
        self.steady_force_deviation = (known + noise).square_root();
        self.mean_force_deviation = (known + contact.force_variance * tables.learner.per_periods).square_root();
    }

    /// Updates the noise of rests and the half-gap's error by a rest on a flank that was learnt from: its innovation v and the variance of v.
    ///
    /// With n = v^2 / variance, the standard deviation r of a rest's noise follows r' = max(1, r (1 + share (n - 1) / 2)), so that n is 1 in the
    /// mean (covariance matching: R. K. Mehra, *On the identification of variances and adaptive Kalman filtering*, IEEE Transactions on
    /// Automatic Control 15(2), 1970). Outliers are not learnt from and leave r as it is: the joint has changed, or its encoder fails.
    pub fn take_innovation(&mut self, innovation: T, variance: T, flank: Flank) {
        let square = (innovation * innovation).over(variance);
        let grown = self.rest_deviation * (T::ONE + T::HALF * Self::OF_A_REST * (square - T::ONE));
        self.rest_deviation = if grown > T::ONE { grown } else { T::ONE };
        let size = square.square_root();
        let wider = if innovation * flank.sign() < T::ZERO { -size } else { size };
        self.half_gap_error += Self::OF_A_REST * (wider - self.half_gap_error);
    }

    /// Returns true once rests on both flanks have shown that the half-gap has changed; the mean of their innovations then begins anew.
    pub fn detect_half_gap_change(&mut self) -> bool {
        let changed = self.half_gap_error.abs() > Self::HALF_GAP_CHANGED;
        if changed {
            self.half_gap_error = T::ZERO;
        }
        changed
    }

    /// The next part of what the learner knows.
    pub fn next<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        learner: &Learner<T, P>,
        free: &Regressors<T, P>,
        touch: &Touch<T>,
    ) {
        let table = &tables.learner;
        let noise = tables.contact.deflection_variance;
        let [of_deflection, of_flank] = self.wind_up_variance;
        let [touching, open] = &mut self.gap_variance;
        match self.turn {
            0 => {
                self.deflection_variance = learner.variance(table, free);
                *open = self.deflection_variance + of_deflection + noise;
            }
            1 => *touching = learner.variance(table, &touch.on(&[T::ZERO; P])) + of_flank + noise,
            2 => {
                self.variances =
                    [HALF_GAP, OFFSET, COMPLIANCE, SKEW].map(|parameter| learner.variance_of(table, parameter));
            }
            _ => self.of_edge(tables, learner, learner.variance(table, &touch.on(free))),
        }
        self.turn = if self.turn + 1 < PARTS { self.turn + 1 } else { 0 };
    }

    /// What follows from how well the nearer edge is known.
    fn of_edge<const P: usize>(&mut self, tables: &ObserverTables<T>, learner: &Learner<T, P>, variance: T) {
        self.edge_deviation = variance.square_root();
        let edge = variance + tables.contact.deflection_variance;
        self.blur = T::TWO * edge.square_root();
        let compliance = learner.value(COMPLIANCE);
        let force = self.force_deviation * self.force_deviation;
        // Weights in inverse proportion to the variances, both as deflection.
        let from_force = force * compliance * compliance;
        self.position_weight = from_force.over(from_force + edge);
        self.both_deviation = (force * (T::ONE - self.position_weight)).square_root();
        let half_gap = learner.value(HALF_GAP);
        let part = half_gap * tables.contact.known_part;
        self.half_gap_is_known = half_gap > T::ZERO && variance < part * part;
        // Once known it serves as long as it can: a place in the turn that the maps have not seen yet is no new joint.
        let thrice = T::THREE * part;
        self.half_gap_serves =
            self.half_gap_is_known || self.half_gap_serves && half_gap > T::ZERO && variance < thrice * thrice;
    }

    /// What follows for every period until the next interval; `trusted` is whether a half-gap was ever seen on both flanks for long.
    pub fn of_learnt<const P: usize>(&mut self, tables: &ObserverTables<T>, learner: &Learner<T, P>, trusted: bool) {
        let (half_gap, compliance) = (learner.value(HALF_GAP), learner.value(COMPLIANCE));
        let [_, _, compliance_variance, _] = self.variances;
        self.stiffness = if compliance > T::ZERO { T::ONE.over(compliance) } else { T::ZERO };
        self.mesh_share = tables.learner.mesh_compliance * self.stiffness;
        self.softness = T::TWO * compliance_variance.square_root();
        let [guess, deviation] = [tables.learner.mean[HALF_GAP], tables.learner.deviation[HALF_GAP]];
        self.guessed_half_gap = if trusted { T::ZERO } else { guess + T::THREE * deviation };
        // What is rounded is off by anything up to that alike.
        let rounding = tables.rounding();
        let edge = self.edge_deviation * self.edge_deviation + T::THIRD * rounding * rounding;
        let [by_learnt, by_guess] =
            [half_gap + T::THREE * edge.square_root(), self.guessed_half_gap + T::TWO * rounding];
        self.reach = tables.supervisor.margin + if by_guess > by_learnt { by_guess } else { by_learnt };
        let widest = T::TWO * half_gap * tables.supervisor.widest_part;
        // In a gap narrower than a count of the output encoder nobody can tell where the teeth are.
        self.widest_variance = if half_gap > rounding { widest * widest } else { T::ZERO };
        let [sine, cosine] = [learner.value(ERROR), learner.value(ERROR + 1)];
        let error = (sine * sine + cosine * cosine).square_root();
        self.flanks_swap = error > half_gap;
        // The planets' errors differ: some teeth meet before the others, by half of it on the mean, and noise hides when.
        let (first, most) = (self.blur + T::HALF * error, Self::NEAREST * half_gap);
        self.near = if first < most { first } else { most };
    }
}
