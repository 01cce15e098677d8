//! What a candidate gains in blocks that were held out of the fit.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::{System, root};
use crate::{
    linear::NormalEquations,
    shared::{self, Shared},
};

/// Rows of one channel that are held out together, and which columns are anything there.
struct Piece<'a> {
    rows: Vec<usize>,
    reached: Vec<usize>,
    shared: Option<&'a Shared>,
}

/// Rows of one channel, what is shared there, and the places of its columns among all.
type Channel<'a> = (Vec<usize>, Option<&'a Shared>, Range<usize>);

impl System {
    /// Drop of squared errors block by block when each tenth of the blocks is judged by a fit of the others.
    pub(crate) fn held_out(&self, columns: &[Vec<f64>], folds: usize) -> Vec<f64> {
        let count = self.columns.ncols() + shared::count(&self.shared);
        let all_columns = count + columns.len();
        let pieces: Vec<Vec<Piece<'_>>> = self.pieces(columns.len(), folds);
        let products = |pieces: &Vec<Piece<'_>>| {
            let mut products = NormalEquations::none(all_columns);
            for piece in pieces {
                products.add(&piece.reached, &self.dense(columns, piece), &self.errors_in(&piece.rows));
            }
            products
        };
        let parts: Vec<NormalEquations> = pieces.par_iter().map(products).collect();
        let all = parts.iter().fold(self.known_before(columns.len()), |(square, right), part| {
            (square + &part.square, right + &part.right)
        });
        let gains_of = |(pieces, part): (&Vec<Piece<'_>>, &NormalEquations)| -> Option<Vec<f64>> {
            let (square, right) = (&all.0 - &part.square, &all.1 - &part.right);
            let solve = |n: usize| {
                let square = square.view((0, 0), (n, n)).into_owned();
                let found = root(square)?.solve(&right.rows(0, n));
                // Without the candidate its columns weigh nothing.
                Some(found.resize_vertically(all_columns, 0.0))
            };
            let (before, after) = (solve(count)?, solve(all_columns)?);
            let mut gains = vec![0.0; self.blocks];
            for piece in pieces {
                let (part, errors) = (self.dense(columns, piece), self.errors_in(&piece.rows));
                let left = [&before, &after].map(|found| &errors - &part * found.select_rows(&piece.reached));
                for (k, i) in piece.rows.iter().enumerate() {
                    gains[self.block[*i]] += left[0][k].powi(2) - left[1][k].powi(2);
                }
            }
            Some(gains)
        };
        let by_part: Vec<Option<Vec<f64>>> = pieces.par_iter().zip(&parts).map(gains_of).collect();
        let mut gains = vec![0.0; self.blocks];
        for of_part in by_part.into_iter().flatten() {
            gains.iter_mut().zip(of_part).for_each(|(sum, gain)| *sum += gain);
        }
        gains
    }

    /// Rows of each fold, channel by channel as far as something is shared there; whole stretches of neighbouring blocks are left out
    /// together. Columns of a candidate come last.
    fn pieces<'a>(&'a self, candidate: usize, folds: usize) -> Vec<Vec<Piece<'a>>> {
        let fold = |i: usize| self.block[i] * folds / self.blocks.max(1);
        let always = self.columns.ncols();
        let last = always + shared::count(&self.shared);
        let mut is_rest = vec![true; self.rows];
        let mut channels: Vec<Channel<'a>> = Vec::new();
        let mut at = always;
        for one in self.shared.iter() {
            one.places.iter().for_each(|place| is_rest[*place] = false);
            channels.push((one.places.clone(), Some(one), at..at + one.columns.ncols()));
            at += one.columns.ncols();
        }
        channels.push(((0..self.rows).filter(|i| is_rest[*i]).collect(), None, last..last));
        let piece = |out: usize, (places, shared, own): &Channel<'a>| Piece {
            rows: places.iter().copied().filter(|i| fold(*i) == out).collect(),
            reached: (0..always).chain(own.clone()).chain(last..last + candidate).collect(),
            shared: *shared,
        };
        (0..folds).map(|out| channels.iter().map(|channel| piece(out, channel)).collect()).collect()
    }

    /// The columns that reach a piece, over its rows, those of a candidate last.
    fn dense(&self, columns: &[Vec<f64>], piece: &Piece<'_>) -> DMatrix<f64> {
        let always = self.columns.ncols();
        let shared = piece.shared.map_or(0, |one| one.columns.ncols());
        let mut part = DMatrix::zeros(piece.rows.len(), piece.reached.len());
        for j in 0..always {
            piece.rows.iter().enumerate().for_each(|(k, i)| part[(k, j)] = self.columns[(*i, j)]);
        }
        if let Some(one) = piece.shared {
            let own: Vec<usize> = piece.rows.iter().map(|i| one.places.partition_point(|p| p < i)).collect();
            for j in 0..shared {
                own.iter().enumerate().for_each(|(k, i)| part[(k, always + j)] = one.columns[(*i, j)]);
            }
        }
        for (j, column) in columns.iter().enumerate() {
            let to = always + shared + j;
            piece.rows.iter().enumerate().for_each(|(k, i)| part[(k, to)] = column[*i]);
        }
        part
    }

    fn errors_in(&self, rows: &[usize]) -> DVector<f64> {
        DVector::from_fn(rows.len(), |k, _| self.errors[rows[k]])
    }

    /// What is known before of all columns, those of a candidate last, of which nothing is: products with each other and with the errors.
    fn known_before(&self, candidate: usize) -> (DMatrix<f64>, DVector<f64>) {
        let (always, shared) = (self.columns.ncols(), shared::count(&self.shared));
        let known = |j: usize| self.columns[(self.rows + j, j)];
        let all = always + shared + candidate;
        let squares = DVector::from_fn(all, |j, _| match j {
            j if j < always => known(j).powi(2),
            j if j < always + shared => 1.0,
            _ => 0.0,
        });
        let right =
            DVector::from_fn(
                all,
                |j, _| {
                    if j < always { known(j) * self.errors[self.rows + j] } else { 0.0 }
                },
            );
        (DMatrix::from_diagonal(&squares), right)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::evidence::Fitted;

    const ROWS: usize = 60;
    const BLOCKS: usize = 12;
    const FOLDS: usize = 4;

    /// Columns unlike each other, and errors of which the last one holds a part.
    struct Given {
        columns: Vec<Vec<f64>>,
        /// Of the even rows only.
        shared: Vec<Vec<f64>>,
        candidate: Vec<f64>,
        errors: Vec<f64>,
    }

    fn given() -> Given {
        let column = |which: usize, rows: usize| -> Vec<f64> {
            (0..rows).map(|i| (1.7 * i as f64 + (i * i * (which + 1)) as f64).sin()).collect()
        };
        let columns = vec![column(0, ROWS), column(1, ROWS)];
        let shared = vec![column(2, ROWS / 2), column(3, ROWS / 2)];
        let (candidate, noise) = (column(4, ROWS), column(5, ROWS));
        let errors = noise.iter().zip(&candidate).map(|(noise, x)| noise + 2.0 * x).collect();
        Given { columns, shared, candidate, errors }
    }

    fn block(row: usize) -> usize {
        row * BLOCKS / ROWS
    }

    fn system(given: &Given, unit: f64) -> System {
        let even: Vec<usize> = (0..ROWS).step_by(2).collect();
        let shared: Arc<[Shared]> = Shared::new(even, &given.shared).into_iter().collect();
        let scaled: Vec<f64> = given.columns[1].iter().map(|x| unit * x).collect();
        let columns = [given.columns[0].clone(), scaled];
        // Something is known before of the first, and nothing of the second.
        let fitted = Fitted { columns: &columns, known: &[1.5, 0.0], offset: &[0.7, 0.0], shared: &shared };
        System::new(given.errors.clone(), &fitted, ((0..ROWS).map(block).collect(), vec![0; ROWS]))
    }

    /// The same by least squares over rows, each written down.
    fn by_hand(given: &Given) -> Vec<f64> {
        let row = |i: usize, with: bool| {
            let shared = given.shared.iter().map(|c| if i.is_multiple_of(2) { c[i / 2] } else { 0.0 });
            let own = given.columns.iter().map(|c| c[i]);
            own.chain(shared).chain(with.then_some(given.candidate[i])).collect::<Vec<f64>>()
        };
        let fold = |i: usize| block(i) * FOLDS / BLOCKS;
        let left = |i: usize, with: bool| {
            let others: Vec<usize> = (0..ROWS).filter(|other| fold(*other) != fold(i)).collect();
            let count = 4 + usize::from(with);
            let known = [[1.5, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
            let matrix = DMatrix::from_fn(others.len() + 3, count, |k, j| match others.get(k) {
                Some(other) => row(*other, with)[j],
                None => known[k - others.len()].get(j).copied().unwrap_or(0.0),
            });
            let right = DVector::from_fn(others.len() + 3, |k, _| match others.get(k) {
                Some(other) => given.errors[*other],
                None => [0.7, 0.0, 0.0][k - others.len()],
            });
            let found = matrix.svd(true, true).solve(&right, 1e-12).unwrap();
            given.errors[i] - row(i, with).iter().zip(found.iter()).map(|(x, value)| x * value).sum::<f64>()
        };
        let mut gains = vec![0.0; BLOCKS];
        (0..ROWS).for_each(|i| gains[block(i)] += left(i, false).powi(2) - left(i, true).powi(2));
        gains
    }

    #[test]
    fn blocks_gain_what_least_squares_without_their_neighbours_says() {
        let given = given();
        let gains = system(&given, 1.0).held_out(std::slice::from_ref(&given.candidate), FOLDS);
        let by_hand = by_hand(&given);
        for (gain, by_hand) in gains.iter().zip(&by_hand) {
            assert!((gain - by_hand).abs() < 1e-6, "{gains:?} {by_hand:?}");
        }
        assert!(by_hand.iter().sum::<f64>() > 10.0, "the errors hold it");
    }

    #[test]
    fn neither_the_unit_of_a_candidate_nor_that_of_what_stands_beside_it_matters() {
        let given = given();
        let tiny: Vec<f64> = given.candidate.iter().map(|x| 1e-9 * x).collect();
        let [one, other] = [(1.0, &given.candidate), (1e-9, &tiny)].map(|(unit, candidate)| {
            let system = system(&given, unit);
            (
                system.held_out(std::slice::from_ref(candidate), FOLDS),
                system.weigh(std::slice::from_ref(candidate)).unwrap(),
            )
        });
        for (a, b) in one.0.iter().zip(&other.0) {
            assert!((a - b).abs() < 1e-6 * (1.0 + a.abs()), "{:?} {:?}", one.0, other.0);
        }
        assert!((other.1.wald / one.1.wald - 1.0).abs() < 1e-6);
        assert!((1e-9 * other.1.values[0] / one.1.values[0] - 1.0).abs() < 1e-6);
    }
}
