//! Least cost from every cell to the goal when headings need not join up.

use std::{cmp::Reverse, collections::BinaryHeap};

use crate::{
    heading::{HEADINGS, Heading},
    lattice::Lattice,
    ordered::Ordered,
    table::CostTable,
};

/// A lower bound of the cost to the goal, cell by cell.
///
/// Every lattice motion, seen without its headings, is a step between cells; the field is the exact least cost over
/// these steps, each as cheap as its cheapest heading and shape. It never exceeds the true cost and falls along every
/// motion by no more than the motion costs, so A* expands each state at most once.
pub struct GoalField {
    cost: Vec<f64>,
}

impl GoalField {
    /// Backward Dijkstra from goal cells with the cost that still follows there.
    pub fn new(lattice: &Lattice<'_>, table: &CostTable, goals: &[(usize, f64)]) -> Self {
        let grid = &lattice.terrain.grid;
        let steps = steps_by_displacement(lattice);
        let mut cost = vec![f64::INFINITY; grid.cells()];
        let mut queue = BinaryHeap::new();
        for &(cell, after) in goals {
            if after < cost[cell] {
                cost[cell] = after;
                queue.push(Reverse((Ordered(after), cell)));
            }
        }
        while let Some(Reverse((Ordered(reached), index))) = queue.pop() {
            if reached > cost[index] {
                continue;
            }
            let cell = grid.cell(index);
            for (displacement, motions) in &steps {
                let back = (-displacement.0, -displacement.1);
                let Some(before) = crate::footprint::shifted(lattice.terrain, cell, back) else { continue };
                let before = grid.index(before);
                let least = motions
                    .iter()
                    .map(|&(heading, motion)| table.cost(before * HEADINGS + heading, motion))
                    .fold(f32::INFINITY, f32::min);
                let total = reached + f64::from(least);
                if total < cost[before] {
                    cost[before] = total;
                    queue.push(Reverse((Ordered(total), before)));
                }
            }
        }
        GoalField { cost }
    }

    /// Least cost from a cell to the goal; infinite where no chain of motions leads there.
    #[inline]
    pub fn at(&self, cell: usize) -> f64 {
        self.cost[cell]
    }
}

/// Motions that change the cell, collected by the displacement they make.
type Displacements = Vec<((i32, i32), Vec<(usize, usize)>)>;

fn steps_by_displacement(lattice: &Lattice<'_>) -> Displacements {
    let mut steps = std::collections::BTreeMap::<(i32, i32), Vec<(usize, usize)>>::new();
    for heading in Heading::all() {
        for (index, motion) in lattice.motions[heading.index()].iter().enumerate() {
            if (motion.columns, motion.rows) != (0, 0) {
                steps.entry((motion.columns, motion.rows)).or_default().push((heading.index(), index));
            }
        }
    }
    steps.into_iter().collect()
}
