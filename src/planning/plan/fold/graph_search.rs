//! Paths over the force manifold.

use super::equilibrium::Fold;
use super::manifold::ForceManifold;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A cell of the grid: column and row.
pub type Cell = [usize; 2];

/// A queued cell with its predecessor. The cheapest cell comes first; equal costs are ordered by
/// cell.
pub struct Waiting<From = ()> {
    /// Cost of the cell.
    pub cost: f64,
    /// The cell.
    pub cell: Cell,
    /// Predecessor of the cell.
    pub from: From,
}

impl<From> PartialEq for Waiting<From> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<From> Eq for Waiting<From> {}

impl<From> PartialOrd for Waiting<From> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<From> Ord for Waiting<From> {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_cost = other.cost.total_cmp(&self.cost);
        by_cost.then_with(|| other.cell.cmp(&self.cell))
    }
}

/// Objective of a path over the manifold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Objective {
    /// The sum over the cells of the path (thesis Eq. 4.11).
    Sum,
    /// The largest value over the cells of the path; of equal paths, the one with the smallest
    /// sum.
    Largest,
}

/// Uniform-cost search (thesis Algorithm 4). Returns the path over neighbouring cells (each has
/// eight) from one of `starts` to `goal` that minimises the sum or the maximum of the costs of all
/// cells after the first. `cost` is `None` for forbidden cells.
pub fn uniform_cost_search(
    manifold: &ForceManifold,
    starts: &[Cell],
    goal: Cell,
    objective: Objective,
    cost: impl Fn(&Fold) -> Option<f64>,
) -> Option<(Vec<Cell>, f64)> {
    match objective {
        Objective::Sum => search(manifold, starts, goal, |sum, cost| sum + cost, cost),
        Objective::Largest => {
            let (_, largest) = search(manifold, starts, goal, f64::max, &cost)?;
            let below = |fold: &Fold| cost(fold).filter(|cost| *cost <= largest);
            let (path, _) = search(manifold, starts, goal, |sum, cost| sum + cost, below)?;
            Some((path, largest))
        }
    }
}

fn search(
    manifold: &ForceManifold,
    starts: &[Cell],
    goal: Cell,
    joined: impl Fn(f64, f64) -> f64,
    cost: impl Fn(&Fold) -> Option<f64>,
) -> Option<(Vec<Cell>, f64)> {
    let [columns, rows] = manifold.size();
    let index = |[column, row]: Cell| row * columns + column;
    let mut costs = vec![f64::INFINITY; columns * rows];
    let mut before: Vec<Option<Cell>> = vec![None; columns * rows];
    let mut is_closed = vec![false; columns * rows];
    let mut waiting = BinaryHeap::new();
    for cell in starts.iter().filter(|[c, r]| *c < columns && *r < rows) {
        costs[index(*cell)] = 0.0;
        waiting.push(Waiting {
            cost: 0.0,
            cell: *cell,
            from: (),
        });
    }
    while let Some(Waiting {
        cost: so_far, cell, ..
    }) = waiting.pop()
    {
        if cell == goal {
            let mut path = vec![cell];
            while let Some(previous) = before[index(path[path.len() - 1])] {
                path.push(previous);
            }
            path.reverse();
            return Some((path, so_far));
        }
        if std::mem::replace(&mut is_closed[index(cell)], true) {
            continue;
        }
        for next in neighbours(cell) {
            let Some(cost) = manifold.fold(next).and_then(&cost) else {
                continue;
            };
            let sum = joined(so_far, cost);
            if sum < costs[index(next)] {
                costs[index(next)] = sum;
                before[index(next)] = Some(cell);
                waiting.push(Waiting {
                    cost: sum,
                    cell: next,
                    from: (),
                });
            }
        }
    }
    None
}

/// The eight cells around a cell. Those left of or below the grid wrap around to cells outside any
/// manifold.
pub fn neighbours([column, row]: Cell) -> impl Iterator<Item = Cell> {
    const STEPS: [[isize; 2]; 8] = [
        [1, 0],
        [-1, 0],
        [0, 1],
        [0, -1],
        [1, 1],
        [1, -1],
        [-1, 1],
        [-1, -1],
    ];
    STEPS.into_iter().map(move |[right, up]| {
        [
            column.wrapping_add_signed(right),
            row.wrapping_add_signed(up),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::super::FoldAtlas;
    use super::*;

    /// Compares with Bellman's equation over all cells.
    #[test]
    fn paths_are_the_cheapest() {
        let manifold = ForceManifold::new(&FoldAtlas::new(), 0.2, 4.0);
        let cost = |fold: &Fold| (fold.suspended_length > 0.958).then(|| fold.force_ratio());
        let [columns, rows] = manifold.size();
        let all: Vec<Cell> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| [column, row]))
            .collect();
        let (start, goal) = (manifold.cell([0.9, 1.4]), manifold.cell([4.1, 0.5]));
        for (objective, joined) in [
            (Objective::Sum, (|a, b| a + b) as fn(f64, f64) -> f64),
            (Objective::Largest, f64::max),
        ] {
            let (path, found) =
                uniform_cost_search(&manifold, &[start], goal, objective, cost).unwrap();
            assert_eq!((path[0], path[path.len() - 1]), (start, goal));
            let along = path[1..]
                .iter()
                .map(|cell| cost(manifold.fold(*cell).unwrap()).unwrap());
            assert!((along.fold(0.0, joined) - found).abs() < 1e-12);
            let mut costs = std::collections::HashMap::from([(start, 0.0)]);
            for _ in 0..columns + rows {
                for cell in &all {
                    let Some(own) = manifold.fold(*cell).and_then(cost) else {
                        continue;
                    };
                    let best = neighbours(*cell).filter_map(|next| costs.get(&next).copied());
                    let best = best
                        .map(|before| joined(before, own))
                        .fold(f64::INFINITY, f64::min);
                    let known = costs.entry(*cell).or_insert(f64::INFINITY);
                    *known = known.min(best);
                }
            }
            assert!(
                (costs[&goal] - found).abs() < 1e-12,
                "{} {found}",
                costs[&goal]
            );
        }
    }
}
