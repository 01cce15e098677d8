//! What models miss, channel by channel: many columns that are taken out of all others.

use nalgebra::{Cholesky, DMatrix, Dyn};

/// Columns of one channel whose weights have a width of 1, about 0.
pub(crate) struct Shared {
    /// Rows of the channel.
    pub(crate) places: Vec<usize>,
    pub(crate) columns: DMatrix<f64>,
    /// The same, row by row: products of many columns at once are far faster with it.
    transposed: DMatrix<f64>,
    /// Of their products, with what is known before.
    root: Cholesky<f64, Dyn>,
    /// Row of the first of them.
    first: usize,
}

impl Shared {
    /// Columns by channel; rows of what is known before begin at `first`.
    pub(crate) fn of(columns: &[Vec<f64>], channel: &[usize], mut first: usize) -> Vec<Shared> {
        let of_channel = |column: &Vec<f64>| column.iter().position(|x| *x != 0.0).map(|i| channel[i]);
        let names: Vec<Option<usize>> = columns.iter().map(of_channel).collect();
        let mut all = Vec::new();
        for name in 0..channel.iter().max().map_or(0, |c| c + 1) {
            let own: Vec<&Vec<f64>> =
                columns.iter().zip(&names).filter(|(_, n)| **n == Some(name)).map(|(c, _)| c).collect();
            let places: Vec<usize> = (0..channel.len()).filter(|i| channel[*i] == name).collect();
            let columns = DMatrix::from_fn(places.len(), own.len(), |i, j| own[j][places[i]]);
            let transposed = columns.transpose();
            let square = &transposed * &columns + DMatrix::identity(own.len(), own.len());
            let Some(root) = Cholesky::new(square) else { continue };
            all.push(Shared { places, columns, transposed, root, first });
            first += own.len();
        }
        all
    }

    /// Takes the shared part out of columns, and puts its weights where what is known before of them stands.
    pub(crate) fn take(&self, columns: &mut DMatrix<f64>) {
        let Some(own) = self.own(columns) else { return };
        let weights = self.root.solve(&(&self.transposed * &own));
        let left = own - &self.columns * &weights;
        for (mut column, left) in columns.column_iter_mut().zip(left.column_iter()) {
            self.places.iter().zip(left.iter()).for_each(|(place, x)| column[*place] = *x);
        }
        columns.rows_mut(self.first, weights.nrows()).copy_from(&-weights);
    }

    /// Products of the shared columns with others, and the weights of the shared ones in them; `None` where both are nothing.
    pub(crate) fn taken(&self, columns: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let products = &self.transposed * &self.own(columns)?;
        let weights = self.root.solve(&products);
        Some((products, weights))
    }

    /// Rows of the channel of columns; `None` where they have none, as most do not change what the ground or a gyroscope says.
    fn own(&self, columns: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let is_nothing = columns.column_iter().all(|column| self.places.iter().all(|i| column[*i] == 0.0));
        let own =
            || DMatrix::from_fn(self.places.len(), columns.ncols(), |i, j| columns[(self.places[i], j)]);
        (!is_nothing).then(own)
    }
}
