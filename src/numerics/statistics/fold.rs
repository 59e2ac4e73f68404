//! Moments of the blocks of an ensemble, merged two and two as in a tournament.
//!
//! Merging floating-point sums depends on the order. Here the order is a binary tree that block
//! numbers alone decide: blocks 2k and 2k + 1 merge, then pairs of pairs, and what has no partner
//! at the end is merged from left to right. Any stretch of blocks is kept as the few whole subtrees
//! that it holds, so that stretches summed on different machines, in any number and order, end in
//! the bits of one run. Pairwise merging also rounds less than a running sum.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Moments;

/// Moments of some blocks; four quantities each.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Fold {
    /// Whole subtrees by their first block.
    nodes: BTreeMap<u64, Node>,
}

/// The moments of 2^level blocks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Depth of the subtree: it holds 2^level blocks.
    pub level: u32,
    /// Moments of each quantity, in the order of `QUANTITIES`.
    pub moments: [Moments; 4],
}

impl Fold {
    /// Adds a block that is not in yet.
    pub fn add_block(&mut self, block: u64, moments: &[Moments; 4]) {
        self.add(block, Node { level: 0, moments: *moments });
    }

    /// Adds a subtree, none of whose blocks is in yet.
    fn add(&mut self, mut first: u64, mut node: Node) {
        while node.level < 63 {
            let size = 1 << node.level;
            let (left, right) = if first & size == 0 { (first, first + size) } else { (first - size, first) };
            let other = if left == first { right } else { left };
            let Some(partner) = self.nodes.get(&other).filter(|n| n.level == node.level).copied() else { break };
            self.nodes.remove(&other);
            let (mut moments, second) =
                if left == first { (node.moments, partner.moments) } else { (partner.moments, node.moments) };
            moments.iter_mut().zip(&second).for_each(|(mine, theirs)| mine.merge(theirs));
            (first, node) = (left, Node { level: node.level + 1, moments });
        }
        self.nodes.insert(first, node);
    }

    /// Adds all blocks of another one, none of which is in yet.
    pub fn absorb(&mut self, other: &Self) {
        other.nodes.iter().for_each(|(first, node)| self.add(*first, *node));
    }

    /// The subtrees with their first blocks, in order.
    pub fn nodes(&self) -> impl Iterator<Item = (u64, &Node)> {
        self.nodes.iter().map(|(first, node)| (*first, node))
    }

    /// From subtrees with their first blocks.
    pub fn from_nodes(nodes: impl Iterator<Item = (u64, Node)>) -> Self {
        let mut fold = Self::default();
        nodes.for_each(|(first, node)| fold.add(first, node));
        fold
    }

    /// All of it: what is left of the tree, from left to right.
    pub fn total(&self) -> [Moments; 4] {
        let mut total = [Moments::default(); 4];
        for node in self.nodes.values() {
            total.iter_mut().zip(&node.moments).for_each(|(mine, theirs)| mine.merge(theirs));
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of a block whose sums round at every merge.
    fn block(number: u64) -> [Moments; 4] {
        std::array::from_fn(|q| {
            let value = |i: u64| 1e3 * ((number * 7919 + i * 31 + q as u64) as f64).sin();
            Moments::of((0..5 + number % 3).map(value))
        })
    }

    fn of(blocks: impl Iterator<Item = u64>) -> Fold {
        let mut fold = Fold::default();
        blocks.for_each(|number| fold.add_block(number, &block(number)));
        fold
    }

    #[test]
    fn any_partition_in_any_order_has_the_bits_of_the_whole() {
        for count in [1, 2, 37, 64, 100] {
            let whole = of(0..count);
            assert_eq!(whole.nodes().count() as u32, count.count_ones(), "{count}");
            for parts in [1, 2, 3, 7, 16] {
                let pieces: Vec<Fold> = (0..parts).map(|k| of(count * k / parts..count * (k + 1) / parts)).collect();
                let mut backwards = Fold::default();
                pieces.iter().rev().for_each(|piece| backwards.absorb(piece));
                assert_eq!(backwards, whole, "{count} in {parts}");
                assert_eq!(backwards.total(), whole.total());
                assert!(pieces.iter().all(|p| Fold::from_nodes(p.nodes().map(|(f, n)| (f, *n))) == *p));
            }
        }
        // Control: merged one by one, the parts of a partition round otherwise.
        let running = |blocks: &mut dyn Iterator<Item = u64>| {
            let mut sum = Moments::default();
            blocks.for_each(|number| sum.merge(&block(number)[0]));
            sum
        };
        let mut halves = running(&mut (0..50));
        halves.merge(&running(&mut (50..100)));
        assert_ne!(halves, running(&mut (0..100)));
    }

    #[test]
    fn the_total_is_that_of_all_values() {
        let total = of(0..23).total();
        assert_eq!(total[2].count, (0..23u64).map(|n| 5 + n % 3).sum::<u64>());
        let mut running = Moments::default();
        (0..23).for_each(|n| running.merge(&block(n)[2]));
        assert!((total[2].mean - running.mean).abs() < 1e-9 && (total[2].sd() / running.sd() - 1.0).abs() < 1e-12);
        assert_eq!((total[2].min, total[2].max), (running.min, running.max));
    }
}
