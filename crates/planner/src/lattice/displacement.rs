//! Steps between cells that a lattice's motions make.

use std::collections::BTreeMap;

use crate::lattice::graph::Lattice;

/// A step between cells and the motions that make it, as slots among the codes of a cell.
pub(crate) struct Displacement {
    pub(crate) columns: i32,
    pub(crate) rows: i32,
    pub(crate) slots: Vec<usize>,
}

impl Displacement {
    /// All steps of a lattice's motions from south to north; turning on the spot is none.
    pub(crate) fn of(lattice: &Lattice) -> Vec<Self> {
        let stride = lattice.motions_per_state();
        let mut steps = BTreeMap::<(i32, i32), Vec<usize>>::new();
        for (heading, motions) in lattice.motions.iter().enumerate() {
            for (index, motion) in motions.iter().enumerate() {
                if (motion.columns, motion.rows) != (0, 0) {
                    steps.entry((motion.rows, motion.columns)).or_default().push(heading * stride + index);
                }
            }
        }
        steps.into_iter().map(|((rows, columns), slots)| Displacement { columns, rows, slots }).collect()
    }
}
