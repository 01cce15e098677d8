//! Products of effects' columns piece by piece of the grid, so that those of every window are sums.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    fit::joint::Joint,
    hypothesis::window::{Grid, Window},
};

/// Products over the rows of one piece of time in one part of the ground.
struct Atom {
    piece: usize,
    part: Option<[usize; 2]>,
    /// E'E.
    own: DMatrix<f64>,
    /// B'E.
    with_basis: DMatrix<f64>,
    /// E'r.
    with_residual: DVector<f64>,
}

/// All pieces and parts that were driven.
pub(crate) struct Atoms {
    atoms: Vec<Atom>,
}

impl Atoms {
    /// Sums up whitened columns over the rows of the test drives.
    pub(crate) fn new(joint: &Joint<'_>, grid: &Grid, columns: &DMatrix<f64>) -> Self {
        let mut rows = std::collections::BTreeMap::<(usize, Option<[usize; 2]>), Vec<usize>>::new();
        for i in 0..joint.observed.test_rows {
            let piece = grid.piece(joint.observed.driven_s[i]);
            let part = grid.part(joint.observed.averages()[i].input.position_m);
            rows.entry((piece, part)).or_default().push(i);
        }
        let atom = |((piece, part), rows): ((usize, Option<[usize; 2]>), Vec<usize>)| {
            let own = columns.select_rows(&rows);
            let transposed = own.transpose();
            Atom {
                piece,
                part,
                with_basis: joint.model.transposed().select_columns(&rows) * &own,
                with_residual: &transposed * joint.residual.select_rows(&rows),
                own: transposed * own,
            }
        };
        let rows: Vec<_> = rows.into_iter().collect();
        Atoms { atoms: rows.into_par_iter().map(atom).collect() }
    }

    /// B'E and E'r of one column in a window.
    pub(crate) fn column(&self, column: usize, window: Window) -> (DVector<f64>, f64) {
        let mut with_basis = DVector::zeros(self.atoms.first().map_or(0, |atom| atom.with_basis.nrows()));
        let mut with_residual = 0.0;
        for atom in self.atoms.iter().filter(|atom| window.holds(atom.piece, atom.part)) {
            with_basis += atom.with_basis.column(column);
            with_residual += atom.with_residual[column];
        }
        (with_basis, with_residual)
    }

    /// Product of two columns, each in its window.
    pub(crate) fn product(&self, (a, in_a): (usize, Window), (b, in_b): (usize, Window)) -> f64 {
        let holds = |atom: &&Atom| in_a.holds(atom.piece, atom.part) && in_b.holds(atom.piece, atom.part);
        self.atoms.iter().filter(holds).map(|atom| atom.own[(a, b)]).sum()
    }
}
