//! How much a candidate explains, beside everything else that is fitted with it.

mod beyond;
mod held_out;
mod lasting;
mod sides;

use std::sync::Arc;

pub(crate) use lasting::spread;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
pub(crate) use sides::{Sided, Sides};

use crate::{
    regime::{self, Regime},
    shared::{self, Shared},
};

/// Columns that are weighed in one go: enough for products of matrices, few enough for a processor's caches.
const TOGETHER: usize = 64;
/// Fewest that are, of long drives, and values that they may have in all: larger pieces of memory are asked for anew each time.
const LEAST_TOGETHER: usize = 8;
const MOST_VALUES: usize = 1 << 20;

/// Whitened errors, everything that is fitted whatever the candidate, and the blocks that count as one piece of evidence each.
///
/// Rows are those that are recorded, then one for what is known before of each column, then one for each shared column.
pub(crate) struct System {
    errors: DVector<f64>,
    /// What is fitted in every channel: the robot's own numbers.
    columns: DMatrix<f64>,
    /// What models miss, channel by channel.
    shared: Arc<[Shared]>,
    /// Rows of the errors that are recorded, the rest being what is known before.
    rows: usize,
    /// Block by row.
    block: Vec<usize>,
    /// Regime by row.
    regime: Vec<usize>,
    blocks: usize,
    /// The columns that shared ones do not explain, and the same row by row.
    own: DMatrix<f64>,
    transposed: DMatrix<f64>,
    /// (AᵀA)⁻¹ of them.
    inverse: DMatrix<f64>,
    /// The errors that are left when nothing but what is fitted always is.
    left: DVector<f64>,
}

/// What is fitted whatever the candidate, whitened.
pub(crate) struct Fitted<'a> {
    /// Columns, what is known before of the weight of each in the same units, and the weight itself.
    pub(crate) columns: &'a [Vec<f64>],
    pub(crate) known: &'a [f64],
    pub(crate) offset: &'a [f64],
    /// Columns of one channel each, with weights of one sigma 1.
    pub(crate) shared: &'a Arc<[Shared]>,
}

/// What a candidate explains.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    /// Values of its linear parameters.
    pub(crate) values: Vec<f64>,
    /// Their covariance, from blocks.
    pub(crate) covariance: DMatrix<f64>,
    /// valuesᵀ covariance⁻¹ values: how many block-wise standard errors the values are from nothing, squared.
    pub(crate) wald: f64,
    /// Drop of squared errors.
    pub(crate) explained: f64,
    /// The whitened sensitivities that nothing else explains.
    pub(crate) own: DMatrix<f64>,
    /// Scatter of its size from regime to regime, over what chance makes of it, squared; 1 where they agree (Birge, Phys. Rev. 40,
    /// 1932).
    pub(crate) discord: f64,
    /// Variance of its values, over that of blocks whose errors do not hang together.
    pub(crate) lasting: f64,
    /// Among how many blocks what it explains is spread.
    pub(crate) spread: f64,
}

impl Evidence {
    /// By how much it is less than squares say, as sizes differ from regime to regime and errors hang together.
    pub(crate) fn scatter(&self) -> f64 {
        self.discord * self.lasting
    }
}

#[cfg(test)]
impl Evidence {
    /// Of one number, spread over many blocks that agree; `own` are the sensitivities that nothing else explains.
    pub(crate) fn of_one(value: f64, variance: f64, own: DMatrix<f64>) -> Self {
        let wald = value * value / variance;
        Evidence {
            values: vec![value],
            covariance: DMatrix::from_element(1, 1, variance),
            wald,
            explained: wald,
            own,
            discord: 1.0,
            lasting: 1.0,
            spread: 100.0,
        }
    }
}

impl System {
    /// Puts a system together of errors, whose rows belong to blocks and regimes.
    pub(crate) fn new(
        errors: Vec<f64>,
        fitted: &Fitted<'_>,
        (block, regime): (Vec<usize>, Vec<usize>),
    ) -> Self {
        let (rows, count) = (errors.len(), fitted.columns.len());
        let shared = Arc::clone(fitted.shared);
        let all = rows + count + shared::count(&shared);
        let mut columns = DMatrix::zeros(all, count);
        for (j, column) in fitted.columns.iter().enumerate() {
            columns.view_mut((0, j), (rows, 1)).copy_from_slice(column);
            columns[(rows + j, j)] = fitted.known[j];
        }
        let mut extended = errors;
        extended.extend_from_slice(fitted.offset);
        extended.resize(all, 0.0);
        let errors = DVector::from_vec(extended);
        let mut own = columns.clone();
        shared::take(&shared, rows + count, &mut own);
        let mut left = DMatrix::from_column_slice(all, 1, errors.as_slice());
        shared::take(&shared, rows + count, &mut left);
        let transposed = own.transpose();
        let inverse = inverse(&transposed * &own);
        let left = left.column(0) - &own * (&inverse * (&transposed * left.column(0)));
        let blocks = block.iter().max().map_or(0, |b| b + 1);
        System { errors, columns, shared, rows, block, regime, blocks, own, transposed, inverse, left }
    }

    /// Number of blocks.
    pub(crate) fn blocks(&self) -> usize {
        self.blocks
    }

    /// How many columns are best weighed in one go.
    pub(crate) fn together(&self) -> usize {
        (MOST_VALUES / self.rows.max(1)).clamp(LEAST_TOGETHER, TOGETHER)
    }

    /// What is left of columns when everything fitted always has taken its part.
    pub(crate) fn own(&self, columns: &[Vec<f64>]) -> DMatrix<f64> {
        let mut own = DMatrix::zeros(self.left.len(), columns.len());
        for (j, column) in columns.iter().enumerate() {
            own.view_mut((0, j), (self.rows, 1)).copy_from_slice(column);
        }
        shared::take(&self.shared, self.rows + self.columns.ncols(), &mut own);
        let share = &self.inverse * (&self.transposed * &own);
        own - &self.own * share
    }

    /// The errors that are left when nothing but what is fitted always is.
    pub(crate) fn left(&self) -> &DVector<f64> {
        &self.left
    }

    /// What a candidate's columns explain; `None` where the rest explains all that they do.
    pub(crate) fn weigh(&self, columns: &[Vec<f64>]) -> Option<Evidence> {
        self.weigh_own(columns, self.own(columns), &self.left)
    }

    /// The same for many candidates at once, which is far faster.
    pub(crate) fn weigh_all(&self, candidates: &[Vec<Vec<f64>>]) -> Vec<Option<Evidence>> {
        let own = self.own(&candidates.concat());
        let mut first = 0;
        let one = |columns: &Vec<Vec<f64>>| {
            let of = own.columns(first, columns.len()).into_owned();
            first += columns.len();
            self.weigh_own(columns, of, &self.left)
        };
        candidates.iter().map(one).collect()
    }

    /// What columns explain, of which `own` is left when everything fitted always has taken its part.
    fn weigh_own(&self, columns: &[Vec<f64>], own: DMatrix<f64>, left: &DVector<f64>) -> Option<Evidence> {
        let square = own.tr_mul(&own);
        for (j, column) in columns.iter().enumerate() {
            let whole: f64 = column.iter().map(|x| x * x).sum();
            if is_nothing(square[(j, j)], whole) {
                return None;
            }
        }
        let inverse = square.try_inverse()?;
        let right = own.tr_mul(left);
        let values = &inverse * &right;
        let explained = values.dot(&right);
        let after = left - &own * &values;
        let mut scores = DMatrix::<f64>::zeros(columns.len(), self.blocks);
        for (i, block) in self.block.iter().enumerate() {
            for j in 0..columns.len() {
                scores[(j, *block)] += own[(i, j)] * after[i];
            }
        }
        // Rows of what is known before hang together with no block.
        for i in self.rows..after.len() {
            for j in 0..columns.len() {
                let block = (i - self.rows) % self.blocks.max(1);
                scores[(j, block)] += own[(i, j)] * after[i];
            }
        }
        let freedom = self.blocks as f64 / (self.blocks as f64 - columns.len() as f64 - 1.0).max(1.0);
        let robust = &inverse * (&scores * scores.transpose()) * &inverse * freedom;
        // The larger of both, as in `calibration::fit`.
        let trusting = &inverse * (after.norm_squared() / self.rows.max(1) as f64).max(1.0);
        let stretch: Vec<f64> = (0..columns.len())
            .map(|j| (trusting[(j, j)] / robust[(j, j)].max(1e-300)).max(1.0).sqrt())
            .collect();
        let covariance =
            DMatrix::from_fn(columns.len(), columns.len(), |i, j| robust[(i, j)] * stretch[i] * stretch[j]);
        let wald = (values.transpose() * covariance.clone().try_inverse()? * &values)[(0, 0)];
        let rows = ((&self.block[..], self.blocks), (&self.regime[..], Regime::COUNT));
        let effect = &own * &values;
        let discord = regime::discord(rows.0, rows.1, &effect, &after);
        let by_block = |other: &DVector<f64>| {
            let mut sums = vec![0.0; self.blocks];
            self.block.iter().enumerate().for_each(|(i, block)| sums[*block] += effect[i] * other[i]);
            sums
        };
        let lasting = lasting::lasting(&by_block(&after));
        let spread = spread(&by_block(&effect));
        let values = values.iter().copied().collect();
        Some(Evidence { values, covariance, wald, explained, own, discord, lasting, spread })
    }

    /// How far the size of what is in the fit already scatters from regime to regime on climbs, descents and level ground.
    pub(crate) fn discord_on_slopes(&self, evidence: &Evidence, values: &[f64], regime: &[usize]) -> f64 {
        let effect = &evidence.own * DVector::from_column_slice(values);
        let regimes = (regime, Regime::COUNT_ON_SLOPES);
        regime::discord((&self.block, self.blocks), regimes, &effect, &self.left)
    }

    /// Drop of squared errors by what each of some candidates explains at its best.
    pub(crate) fn explained(&self, candidates: &[Vec<Vec<f64>>]) -> Vec<f64> {
        let products = self.products(&candidates.concat());
        let mut first = 0;
        let of = |candidate: &Vec<Vec<f64>>| {
            let (at, count) = (first, candidate.len());
            first += count;
            let (square, right) = products.of(at, count);
            if (0..count).any(|j| is_nothing(square[(j, j)], products.whole[at + j])) {
                return 0.0;
            }
            square.cholesky().map_or(0.0, |root| right.dot(&root.solve(&right)))
        };
        candidates.iter().map(of).collect()
    }

    /// Products of columns with each other, less what everything fitted always takes of them, and with the errors.
    fn products(&self, columns: &[Vec<f64>]) -> Products {
        let columns = DMatrix::from_fn(self.rows, columns.len(), |i, j| columns[j][i]);
        let own = self.transposed.columns(0, self.rows) * &columns;
        let mut taken = vec![(own.clone(), &self.inverse * own)];
        taken.extend(self.shared.iter().filter_map(|shared| shared.taken(&columns)));
        let right = columns.tr_mul(&self.left.rows(0, self.rows));
        let whole = columns.column_iter().map(|column| column.norm_squared()).collect();
        Products { columns, taken, right, whole }
    }
}

/// Products of columns with each other and with errors.
struct Products {
    columns: DMatrix<f64>,
    /// Products with what is fitted always, and its weights in the columns.
    taken: Vec<(DMatrix<f64>, DMatrix<f64>)>,
    right: DVector<f64>,
    /// Squares of whole columns.
    whole: Vec<f64>,
}

impl Products {
    /// Of some neighbouring columns.
    fn of(&self, at: usize, count: usize) -> (DMatrix<f64>, DVector<f64>) {
        let part = self.columns.columns(at, count);
        let mut square = part.tr_mul(&part);
        for (products, weights) in &self.taken {
            square -= products.columns(at, count).tr_mul(&weights.columns(at, count));
        }
        (square, self.right.rows(at, count).into_owned())
    }
}

/// Whether nothing is left of a column: less than a ten-thousandth of its square is rounding.
fn is_nothing(left: f64, whole: f64) -> bool {
    left < 1e-4 * whole || whole == 0.0
}

/// Inverse of a matrix of products.
fn inverse(square: DMatrix<f64>) -> DMatrix<f64> {
    let count = square.nrows();
    root(square).map_or_else(|| DMatrix::zeros(count, count), |root| root.inverse())
}

/// Root of a matrix of products, whatever the units of its columns; those that nothing excites take no share.
fn root(mut square: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    for j in 0..square.nrows() {
        let own = square[(j, j)];
        square[(j, j)] = if own > 0.0 { own * (1.0 + ROUNDING) } else { 1.0 };
    }
    square.cholesky()
}

/// Share of a column's square by which columns that hang together in all but rounding are kept apart.
const ROUNDING: f64 = 1e-9;
