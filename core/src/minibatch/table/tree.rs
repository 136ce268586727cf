//! The tree of sums over the blocks: nodes of 16 children, level by level.
//!
//! A node holds running sums of its children's weights, as integers: a draw compares 16 numbers and counts, a change
//! adds a difference to some of them, and as integers lose nothing the sums are those of a tree built afresh, bit for
//! bit.

use crate::matrix::{first, from};
use core::hint::select_unpredictable;

/// How many children a node has.
pub const CHILDREN: usize = 16;

/// Where each child ends, in units of the table's scale: the last element is the node's weight.
pub type Node = [i64; CHILDREN];

/// The blocks of the most items there can be.
pub const MAX_BLOCKS: usize = 1 << 28;
const MAX_LEVELS: usize = 7;

/// Where the levels of a tree lie among its nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels {
    /// The first node of each level, lowest first, and behind the highest its end: the root is the one before that.
    start: [usize; MAX_LEVELS + 1],
    depth: usize,
}

impl Levels {
    /// Those over so many blocks, at most [`MAX_BLOCKS`].
    pub(super) const fn new(blocks: usize) -> Levels {
        let mut start = [0; MAX_LEVELS + 1];
        let mut nodes = blocks.div_ceil(CHILDREN);
        let mut depth = 0;
        while depth < MAX_LEVELS {
            start[depth + 1] = start[depth] + nodes;
            depth += 1;
            if nodes <= 1 {
                break;
            }
            nodes = nodes.div_ceil(CHILDREN);
        }
        Levels { start, depth }
    }

    pub(super) const fn nodes(&self) -> usize {
        self.start[self.depth % (MAX_LEVELS + 1)]
    }

    /// The first node of each level, from the lowest to the highest.
    pub(super) fn starts(&self) -> &[usize] {
        first(&self.start, self.depth)
    }
}

/// Where a child begins and ends.
pub(super) fn span(node: &Node, child: usize) -> (i64, i64) {
    // A branch would be mispredicted once in 16 times.
    let begin = select_unpredictable(child == 0, 0, node[child.wrapping_sub(1) % CHILDREN]);
    (begin, node[child % CHILDREN])
}

pub(super) fn weight(node: &Node, child: usize) -> i64 {
    let (begin, end) = span(node, child);
    end.wrapping_sub(begin)
}

/// Changes each child's weight by its difference.
pub(super) fn add_all(node: &mut Node, differences: &Node) {
    let mut sum = 0i64;
    for (end, difference) in node.iter_mut().zip(differences) {
        sum = sum.wrapping_add(*difference);
        *end = end.wrapping_add(sum);
    }
}

/// Makes the levels above the lowest from its first `used` nodes, the only ones with weights.
pub(super) fn raise(nodes: &mut [Node], levels: &Levels, mut used: usize) {
    for pair in levels.starts().windows(2) {
        let &[below, above] = pair else { return };
        let Some((lower, upper)) = nodes.split_at_mut_checked(above) else { return };
        let lower = first(from(lower, below), used);
        used = used.div_ceil(CHILDREN);
        for (node, children) in upper.iter_mut().zip(lower.chunks(CHILDREN)) {
            let mut sum = 0;
            let mut children = children.iter();
            *node = core::array::from_fn(|_| {
                sum = children.next().map_or(sum, |child| child[CHILDREN - 1].wrapping_add(sum));
                sum
            });
        }
    }
}
