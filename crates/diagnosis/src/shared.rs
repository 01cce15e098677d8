//! What models miss, channel by channel: many columns that are taken out of all others.

use nalgebra::{Cholesky, DMatrix, Dyn};
use rayon::prelude::*;

/// Columns of one channel whose weights have a width of 1, about 0.
pub(crate) struct Shared {
    /// Rows of the channel.
    pub(crate) places: Vec<usize>,
    pub(crate) columns: DMatrix<f64>,
    /// The same, row by row: products of many columns at once are far faster with it.
    transposed: DMatrix<f64>,
    /// Of their products, with what is known before.
    root: Cholesky<f64, Dyn>,
}

impl Shared {
    /// Columns over the averages of a channel, which lie at such places; `None` where there are none.
    pub(crate) fn new(places: Vec<usize>, columns: &[Vec<f64>]) -> Option<Shared> {
        if columns.is_empty() {
            return None;
        }
        let columns = DMatrix::from_fn(places.len(), columns.len(), |i, j| columns[j][i]);
        let transposed = columns.transpose();
        let square = &transposed * &columns + DMatrix::identity(columns.ncols(), columns.ncols());
        let root = Cholesky::new(square)?;
        Some(Shared { places, columns, transposed, root })
    }

    /// What is left of columns in the rows of the channel when the shared ones took their part, and the weights of those in them.
    fn left(&self, columns: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let own = self.own(columns)?;
        let (_, weights) = self.taken_of(&own);
        Some((own - &self.columns * &weights, weights))
    }

    /// Products of the shared columns with others, and the weights of the shared ones in them; `None` where both are nothing.
    pub(crate) fn taken(&self, columns: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        Some(self.taken_of(&self.own(columns)?))
    }

    /// The same of columns over the rows of the channel.
    pub(crate) fn taken_of(&self, columns: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
        let products = &self.transposed * columns;
        let weights = self.root.solve(&products);
        (products, weights)
    }

    /// Rows of the channel of columns; `None` where they have none, as most do not change what the ground or a gyroscope says.
    fn own(&self, columns: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let is_nothing = columns.column_iter().all(|column| self.places.iter().all(|i| column[*i] == 0.0));
        let own =
            || DMatrix::from_fn(self.places.len(), columns.ncols(), |i, j| columns[(self.places[i], j)]);
        (!is_nothing).then(own)
    }
}

/// Number of columns of some channels.
pub(crate) fn count(shared: &[Shared]) -> usize {
    shared.iter().map(|one| one.columns.ncols()).sum()
}

/// Takes the shared parts of all channels out of columns; rows of what is known before of them, where their weights stand, begin at `first`.
pub(crate) fn take(shared: &[Shared], mut first: usize, columns: &mut DMatrix<f64>) {
    let left: Vec<_> = shared.par_iter().map(|one| one.left(columns)).collect();
    for (one, left) in shared.iter().zip(left) {
        if let Some((left, weights)) = left {
            for (mut column, left) in columns.column_iter_mut().zip(left.column_iter()) {
                one.places.iter().zip(left.iter()).for_each(|(place, x)| column[*place] = *x);
            }
            columns.rows_mut(first, weights.nrows()).copy_from(&-weights);
        }
        first += one.columns.ncols();
    }
}
