//! Shares of a variance: how much of the spread of a result each group of independent inputs makes
//! alone, with its interactions, and in the mean over the orders in which groups are added
//! (Shapley), with 95 % intervals.
//!
//! Pick and freeze: every member is evaluated with its own inputs and with those of some groups
//! taken from a second, independent sample. Half the mean squared difference that a set of groups
//! makes is the variance with that set's interactions. Sources: Jansen, *Analysis of variance
//! designs for model output*, 1999 (total and, in Saltelli et al. 2010, table 2, first order);
//! Song, Nelson & Staum, *Shapley effects for global sensitivity analysis*, 2016 (Shapley);
//! Goda, *A simple algorithm for global sensitivity analysis with Shapley effects*, 2021 (a random
//! order for each member).
//!
//! Not for inputs that depend on each other across groups: such inputs belong in one group.

use rand::Rng;
use serde::Serialize;

use super::Estimate;
use crate::numerics::order;
use crate::rng::{Philox, Stream};

/// Most groups of which every subset is evaluated: 64 ensembles. Beyond, twice as many ensembles as
/// groups are, which for seven is a ninth of the subsets.
const MOST_BY_SUBSETS: usize = 6;
/// Resamples of a bootstrap: the 2.5 % percentile then is the 25th of them, known to ±20 % of its
/// tail (Efron & Tibshirani, *An Introduction to the Bootstrap*, 1993, §12.5: 1000 or more).
const RESAMPLES: u64 = 1000;
/// Columns of a group in a row, after the first one for all groups together.
const PER_GROUP: usize = 3;

/// Groups of inputs, one bit each, least significant first.
pub type Groups = u128;

/// Plan of the ensembles from which the shares are found: for each, the groups that a member takes
/// from the second sample. A pure function of seed and member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Design {
    /// Number of groups, at most 128.
    pub groups: usize,
    /// Seed of the orders in which groups are added, and of the bootstrap.
    pub seed: u64,
}

/// The shares of one group, 1; sampling may carry one below 0 or beyond 1. Intervals are by
/// bootstrap over members.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// Share that it makes alone (first-order Sobol index).
    pub alone: Estimate,
    /// Share with all of its interactions (total Sobol index).
    pub total: Estimate,
    /// Shapley effect: its part of every interaction is one over the number of those in it. These
    /// add up to one.
    pub shapley: Estimate,
}

/// The variance of a result, shared among groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Shares {
    /// Variance that is shared, in the square of the result's unit.
    pub variance: f64,
    /// Members it was found with: those whose every result is finite.
    pub members: u64,
    /// Shares of each group, in their order.
    pub groups: Vec<Share>,
}

impl Design {
    /// Number of ensembles to evaluate.
    pub fn ensembles(&self) -> usize {
        match self.groups {
            0..=MOST_BY_SUBSETS => 1 << self.groups,
            // None, all, each alone, and the first two to all but one of every member's order.
            groups => 2 * groups,
        }
    }

    /// The groups that this member takes from the second sample in an ensemble.
    pub fn taken(&self, ensemble: usize, member: u64) -> Groups {
        let alone = 2..2 + self.groups;
        match ensemble {
            subset if self.groups <= MOST_BY_SUBSETS => subset as Groups,
            0 => 0,
            1 => self.all(),
            group if alone.contains(&group) => 1 << (group - alone.start),
            step => self.order(member).iter().take(step - self.groups).fold(0, |taken, group| taken | 1 << group),
        }
    }

    /// The shares, from the results of every ensemble, members in the same order, the first of them
    /// member 0. Of a vector it is the sum of the variances of its components (Gamboa, Janon, Klein
    /// & Lagnoux, *Sensitivity analysis for multidimensional and functional outputs*, 2014). `None`
    /// without a spread: fewer than two members with finite results, or results that are all one.
    pub fn shares<const N: usize>(&self, results: &[Vec<[f64; N]>]) -> Option<Shares> {
        let members = results.iter().map(Vec::len).min()?;
        let is_finite = |m: &usize| results.iter().all(|ensemble| ensemble[*m].iter().all(|v| v.is_finite()));
        let rows: Vec<Vec<f64>> = (0..members).filter(is_finite).map(|m| self.row(m, results)).collect();
        let sum_of = |some: &mut dyn Iterator<Item = &Vec<f64>>| {
            let mut sum = vec![0.0; 1 + PER_GROUP * self.groups];
            some.for_each(|row| sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += value));
            sum
        };
        let sums = sum_of(&mut rows.iter());
        if rows.len() < 2 || self.groups == 0 || sums[0] <= 0.0 {
            return None;
        }
        let resampled: Vec<Vec<f64>> = (0..RESAMPLES)
            .map(|n| {
                let mut draw = Philox::new(self.seed, n, Stream::Host);
                sum_of(&mut (0..rows.len()).map(|_| &rows[below(rows.len(), &mut draw)]))
            })
            .collect();
        let estimate = |of: &dyn Fn(&[f64]) -> f64| {
            let mut all: Vec<f64> = resampled.iter().map(|sums| of(sums)).filter(|share| share.is_finite()).collect();
            order::sort(&mut all);
            Estimate { value: of(&sums), ci95: [0.025, 0.975].map(|p| order::quantile(&all, p)) }
        };
        let share = |group: usize| {
            let [without, with, shapley] = std::array::from_fn(|c| 1 + PER_GROUP * group + c);
            Share {
                alone: estimate(&|sums| 1.0 - sums[without] / sums[0]),
                total: estimate(&|sums| sums[with] / sums[0]),
                shapley: estimate(&|sums| sums[shapley] / sums[0]),
            }
        };
        let count = rows.len();
        let groups = (0..self.groups).map(share).collect();
        Some(Shares { variance: sums[0] / count as f64, members: count as u64, groups })
    }

    fn all(&self) -> Groups {
        (0..self.groups).fold(0, |all, group| all | 1 << group)
    }

    /// The order in which this member's groups are added.
    fn order(&self, member: u64) -> Vec<usize> {
        // A stretch of streams that the resamples do not reach.
        let mut draw = Philox::new(self.seed, member + RESAMPLES, Stream::Host);
        let mut order: Vec<usize> = (0..self.groups).collect();
        for last in (1..order.len()).rev() {
            order.swap(last, below(last + 1, &mut draw));
        }
        order
    }

    /// Half squared differences of a member: that of all groups; then, per group, those of all
    /// others and of itself, and its Shapley part of the first.
    fn row<const N: usize>(&self, member: usize, results: &[Vec<[f64; N]>]) -> Vec<f64> {
        match self.groups {
            0..=MOST_BY_SUBSETS => self.row_by_subsets(member, results),
            _ => self.row_by_order(member, results),
        }
    }

    /// The row in the mean over all pairs of ensembles that differ by the same groups.
    fn row_by_subsets<const N: usize>(&self, member: usize, results: &[Vec<[f64; N]>]) -> Vec<f64> {
        let (subsets, all) = (1 << self.groups, (1 << self.groups) - 1);
        let half = |set: usize| {
            let pairs = (0..subsets).map(|other| half_square(results[other][member], results[other ^ set][member]));
            pairs.sum::<f64>() / subsets as f64
        };
        let halves: Vec<f64> = (0..subsets).map(half).collect();
        let weights = shapley_weights(self.groups);
        let mut row = vec![halves[all]];
        for bit in (0..self.groups).map(|group| 1_usize << group) {
            let others = (0..subsets).filter(|set| set & bit == 0);
            let shapley =
                others.map(|set| weights[set.count_ones() as usize] * (halves[set | bit] - halves[set])).sum();
            row.extend([halves[all ^ bit], halves[bit], shapley]);
        }
        row
    }

    /// The row with the Shapley parts along the member's own order, from both of its ends.
    fn row_by_order<const N: usize>(&self, member: usize, results: &[Vec<[f64; N]>]) -> Vec<f64> {
        let order = self.order(member as u64);
        let at = |ensemble: usize| results[ensemble][member];
        let (none, all) = (at(0), at(1));
        let mut row = vec![half_square(none, all)];
        (0..self.groups).for_each(|group| {
            row.extend([half_square(at(2 + group), all), half_square(none, at(2 + group)), 0.0]);
        });
        let mut before = none;
        for (place, group) in order.iter().enumerate() {
            let after = match place + 1 {
                1 => at(2 + group),
                added if added == self.groups => all,
                added => at(self.groups + added),
            };
            let grows = half_square(after, none) - half_square(before, none);
            let shrinks = half_square(before, all) - half_square(after, all);
            row[PER_GROUP * (group + 1)] = 0.5 * (grows + shrinks);
            before = after;
        }
        row
    }
}

fn half_square<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
}

/// A number from 0 to below `end`, all as likely to one part in 2³² over `end`.
fn below(end: usize, draw: &mut Philox) -> usize {
    ((u64::from(draw.next_u32()) * end as u64) >> 32) as usize
}

/// Weights of the sets that may stand before a group, by their size: the part of all orders of the
/// groups that begin with this set and go on with the group, size! (groups − 1 − size)! / groups!.
fn shapley_weights(groups: usize) -> Vec<f64> {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    (0..groups).map(|size| factorial(size) * factorial(groups - 1 - size) / factorial(groups)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Results of every ensemble for a function of inputs that are uniform from 0 to 1.
    fn results(design: &Design, members: u64, of: &dyn Fn(&[f64]) -> f64) -> Vec<Vec<[f64; 1]>> {
        let uniform = |sample: u64, member: u64| {
            let mut draw = Philox::new(design.seed, member, if sample == 0 { Stream::Start } else { Stream::Fix });
            (0..design.groups).map(|_| f64::from(draw.next_u32()) / f64::from(u32::MAX)).collect::<Vec<f64>>()
        };
        let samples: Vec<[Vec<f64>; 2]> = (0..members).map(|m| [uniform(0, m), uniform(1, m)]).collect();
        let result = |ensemble: usize, member: u64| {
            let (taken, [own, other]) = (design.taken(ensemble, member), &samples[member as usize]);
            let inputs = (0..design.groups).map(|g| if taken >> g & 1 == 1 { other[g] } else { own[g] });
            [of(&inputs.collect::<Vec<f64>>())]
        };
        (0..design.ensembles()).map(|e| (0..members).map(|m| result(e, m)).collect()).collect()
    }

    /// Shares without their intervals: alone, total, Shapley of each group.
    fn values(design: &Design, members: u64, of: &dyn Fn(&[f64]) -> f64) -> Vec<[f64; 3]> {
        let results = results(design, members, of);
        let mut sums = vec![0.0; 1 + PER_GROUP * design.groups];
        (0..members as usize)
            .for_each(|m| sums.iter_mut().zip(design.row(m, &results)).for_each(|(sum, value)| *sum += value));
        let shares = sums[1..].chunks(PER_GROUP).map(|s| [1.0 - s[0] / sums[0], s[1] / sums[0], s[2] / sums[0]]);
        shares.collect()
    }

    /// Ishigami & Homma 1990 with a = 7, b = 0.1.
    fn ishigami(x: &[f64]) -> f64 {
        let [x1, x2, x3] = [0, 1, 2].map(|i| PI * (2.0 * x[i] - 1.0));
        x1.sin() + 7.0 * x2.sin().powi(2) + 0.1 * x3.powi(4) * x1.sin()
    }

    /// Its shares in closed form.
    const ISHIGAMI: [[f64; 3]; 3] = [[0.3139, 0.5576, 0.4357], [0.4424, 0.4424, 0.4424], [0.0, 0.2437, 0.1218]];

    fn near(got: &[[f64; 3]], want: &[[f64; 3]], within: f64) {
        let pairs = got.iter().flatten().zip(want.iter().flatten());
        let largest = pairs.map(|(got, want)| (got - want).abs()).fold(0.0, f64::max);
        assert!(got.len() == want.len() && largest < within, "{largest}: {got:?} is not {want:?}");
    }

    fn sum_of(shares: &[[f64; 3]], which: usize) -> f64 {
        shares.iter().map(|share| share[which]).sum()
    }

    #[test]
    fn ishigami_has_its_shares() {
        let design = Design { groups: 3, seed: 1 };
        let got = values(&design, 1 << 18, &ishigami);
        near(&got, &ISHIGAMI, 0.005);
        assert!((sum_of(&got, 2) - 1.0).abs() < 1e-12);
        // Control: it interacts, so that none of the other two add up to one.
        assert!((sum_of(&got, 0) - 0.756).abs() < 0.01 && (sum_of(&got, 1) - 1.244).abs() < 0.01);
    }

    // Sobol', Saltelli 1995: the product of (|4x − 2| + a)/(1 + a); eight groups, so by orders.
    #[test]
    fn sobol_g_has_its_shares() {
        let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];
        let of = |x: &[f64]| x.iter().zip(a).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product();
        let own = a.map(|a| 1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
        let variance = own.iter().map(|v| 1.0 + v).product::<f64>() - 1.0;
        let interaction = |set: usize| (0..8).filter(|i| set >> i & 1 == 1).map(|i| own[i]).product::<f64>();
        let closed = |i: usize| {
            let with = || (0..1_usize << 8).filter(move |set| set >> i & 1 == 1);
            let shapley = with().map(|set| interaction(set) / f64::from(set.count_ones())).sum::<f64>();
            [own[i], with().map(interaction).sum(), shapley].map(|part| part / variance)
        };
        let want: Vec<[f64; 3]> = (0..8).map(closed).collect();
        assert!((sum_of(&want, 2) - 1.0).abs() < 1e-12);
        let got = values(&Design { groups: 8, seed: 1 }, 1 << 18, &of);
        near(&got, &want, 0.005);
        assert!((sum_of(&got, 2) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn only_an_additive_function_has_totals_that_are_its_first_orders() {
        let design = Design { groups: 3, seed: 2 };
        let apart = |of: &dyn Fn(&[f64]) -> f64| {
            let shares = values(&design, 1 << 14, of);
            shares.iter().map(|[alone, total, _]| (total - alone).abs()).fold(0.0, f64::max)
        };
        let additive = apart(&|x| x[0] + 2.0 * x[1] + 3.0 * x[2] * x[2]);
        assert!(additive < 0.02, "{additive}");
        // Control.
        assert!(apart(&ishigami) > 0.2);
    }

    #[test]
    fn a_vector_shares_the_sum_of_its_variances() {
        let design = Design { groups: 3, seed: 5 };
        let components: [Vec<Vec<[f64; 1]>>; 2] =
            [results(&design, 1000, &|x| x[0] + x[1] * x[2]), results(&design, 1000, &|x| 2.0 * x[2])];
        let together: Vec<Vec<[f64; 2]>> = (0..design.ensembles())
            .map(|e| (0..1000).map(|m| [components[0][e][m][0], components[1][e][m][0]]).collect())
            .collect();
        let [first, second] = components.each_ref().map(|one| design.shares(one).expect("a spread"));
        let both = design.shares(&together).expect("a spread");
        assert!((both.variance / (first.variance + second.variance) - 1.0).abs() < 1e-12);
        let parts = first.variance * first.groups[2].total.value + second.variance * second.groups[2].total.value;
        assert!((both.groups[2].total.value * both.variance / parts - 1.0).abs() < 1e-12);
    }

    // The nine shares of a seed are of the same members, so that they count as three at most: four
    // standard errors of 120 draws of 0.95 are 0.08.
    #[test]
    fn intervals_hold_the_truth_nineteen_times_in_twenty() {
        let (mut inside, mut all) = (0, 0);
        for seed in 0..40 {
            let design = Design { groups: 3, seed };
            let shares = design.shares(&results(&design, 1024, &ishigami)).expect("a spread");
            for (share, truth) in shares.groups.iter().zip(ISHIGAMI) {
                for (estimate, truth) in [share.alone, share.total, share.shapley].iter().zip(truth) {
                    inside += u32::from((estimate.ci95[0]..=estimate.ci95[1]).contains(&truth));
                    all += 1;
                }
            }
        }
        let part = f64::from(inside) / f64::from(all);
        assert!((0.87..1.0).contains(&part), "{part}");
    }

    #[test]
    fn members_that_failed_are_left_out_and_without_a_spread_there_are_no_shares() {
        let design = Design { groups: 2, seed: 3 };
        let mut some = results(&design, 300, &|x| x[0] + x[1]);
        some[3][17] = [f64::NAN];
        assert_eq!(design.shares(&some).map(|shares| shares.members), Some(299));
        assert_eq!(design.shares(&results(&design, 300, &|_| 1.0)), None);
        assert_eq!(Design { groups: 0, seed: 3 }.shares(&[vec![[1.0], [2.0]]]), None);
    }

    #[test]
    fn orders_hold_every_group_once_and_begin_with_each_as_often() {
        let design = Design { groups: 9, seed: 4 };
        let mut first = [0_u32; 9];
        for member in 0..9000 {
            let mut order = design.order(member);
            first[order[0]] += 1;
            assert_eq!(design.taken(design.ensembles() - 1, member).count_ones(), 8);
            order.sort_unstable();
            assert_eq!(order, (0..9).collect::<Vec<usize>>());
        }
        // Five standard errors of 9000/9.
        assert!(first.iter().all(|n| n.abs_diff(1000) < 150), "{first:?}");
    }
}
