//! Parts of an elimination that do not depend on each other.

use std::ops::Range;

/// Consecutive supernodes that form whole subtrees of the elimination tree.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Branch {
    pub(super) supernodes: Range<usize>,
}

/// Parts into which the work of the branches is divided, for any number of threads.
const PARTS: usize = 16;
/// Least number of block products in a branch, if there are other branches: waking a thread takes
/// as long as thousands of products.
const SMALLEST_BRANCH: usize = 30_000;

/// Cuts the tree into branches of about the same work, and the trunk that holds them together.
pub(super) fn branches(parents: &[Option<usize>], products: &[usize]) -> (Vec<Branch>, Vec<usize>) {
    let mut of_subtree = products.to_vec();
    for (supernode, parent) in parents.iter().enumerate() {
        if let Some(parent) = *parent {
            of_subtree[parent] += of_subtree[supernode];
        }
    }
    let total: usize = products.iter().sum();
    let limit = (total / PARTS).max(SMALLEST_BRANCH);
    let (mut branches, mut trunk): (Vec<Branch>, Vec<usize>) = (Vec::new(), Vec::new());
    let (mut start, mut work) = (0, 0);
    for supernode in 0..parents.len() {
        let is_of_trunk = of_subtree[supernode] > limit;
        if is_of_trunk {
            trunk.push(supernode);
            if start < supernode {
                branches.push(Branch {
                    supernodes: start..supernode,
                });
            }
            (start, work) = (supernode + 1, 0);
            continue;
        }
        work += products[supernode];
        // A subtree ends at a node without parent, or whose parent belongs to the trunk.
        let is_root = parents[supernode].is_none_or(|parent| of_subtree[parent] > limit);
        if is_root && work >= limit {
            branches.push(Branch {
                supernodes: start..supernode + 1,
            });
            (start, work) = (supernode + 1, 0);
        }
    }
    if start < parents.len() {
        branches.push(Branch {
            supernodes: start..parents.len(),
        });
    }
    (branches, trunk)
}
