//! A linear model with Gaussian priors and one unknown scale of the noise, and the log evidence of sets of columns.
//!
//! ```text
//! r = B β + E x + s ε,   β, x, ε ~ N(0, I)
//! A_s = I + B'B/s²,   R_s = E'E/s² − E'B A_s⁻¹ B'E/s⁴   (r as the last column of E)
//! ln p(r) = ln Σ_s p(s) exp( −n ln s − ½ ln|A_s| − ½ R_rr + ½ b'(I + R)⁻¹ b − ½ ln|I + R| ),   b = R_r
//! ```
//!
//! The constant −n/2 ln 2π is left out. Rasmussen & Williams, Gaussian Processes for Machine Learning (2006), 2.2 and A.3. The likelihood is
//! tempered as a power posterior (Miller & Dunson, J. Am. Stat. Assoc. 114, 2019): with rows divided by √τ and n by τ.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use statrs::function::erf::erfc;

/// Scales of the noise that are summed over, each a quarter to a half more than the one before, and their prior: the noise model is right to a
/// factor of 1.5, one sigma.
const NOISE_SCALES: [f64; 7] = [0.7, 0.87, 1.1, 1.35, 1.7, 2.3, 3.5];
const NOISE_SCALE_LOG_SIGMA: f64 = 0.4;

/// Whitened columns over the first rows, beyond which they are zero, with their products with the basis.
#[derive(Clone)]
pub(crate) struct Group {
    /// The columns.
    pub(crate) columns: DMatrix<f64>,
    /// L⁻¹ B'E / s² at every scale, A_s = L L'.
    pub(crate) halves: Vec<DMatrix<f64>>,
}

/// A linear model about one residual.
pub(crate) struct LinearModel {
    /// B', of which products are faster.
    transposed: DMatrix<f64>,
    scales: Vec<NoiseScale>,
}

/// So many columns of so many rows, transposed.
pub(crate) fn transposed(
    rows: usize,
    count: usize,
    columns: impl IntoIterator<Item = impl AsRef<[f64]>>,
) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(count, rows);
    for (j, column) in columns.into_iter().enumerate() {
        all.row_mut(j).iter_mut().zip(column.as_ref()).for_each(|(to, x)| *to = *x);
    }
    all
}

/// Products of all columns with each other, of a transposed matrix.
pub(crate) fn products(transposed: &DMatrix<f64>) -> DMatrix<f64> {
    /// Rows that are multiplied at once: they stay in the cache.
    const ROWS: usize = 1024;
    let (count, rows) = transposed.shape();
    let pieces = rows.div_ceil(ROWS).max(1);
    /// One sum for each core of a small machine, and the same sums on every machine.
    const SUMS: usize = 4;
    let sum = |which: usize| {
        let mut gram = DMatrix::zeros(count, count);
        for piece in (which..pieces).step_by(SUMS) {
            let own = transposed.columns(piece * ROWS, ROWS.min(rows - piece * ROWS));
            gram.gemm(1.0, &own, &own.transpose(), 1.0);
        }
        gram
    };
    (0..SUMS).into_par_iter().map(sum).reduce(|| DMatrix::zeros(count, count), |a, b| a + b)
}

/// A matrix of columns of so many rows; there may be none.
pub(crate) fn matrix(rows: usize, columns: &[DVector<f64>]) -> DMatrix<f64> {
    if columns.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(columns) }
}

/// Cholesky factor of A_s, and ln p(s) − n ln s − ½ ln|A_s|, of columns whose products are known.
fn at_scale(gram: &DMatrix<f64>, s: f64, effective_rows: f64) -> Option<(Cholesky<f64, Dyn>, f64)> {
    let mut a = gram / (s * s);
    (0..a.nrows()).for_each(|i| a[(i, i)] += 1.0);
    let root = a.cholesky()?;
    let half_log_det: f64 = root.l_dirty().diagonal().iter().map(|l| l.ln()).sum();
    let log_prior = -0.5 * (s.ln() / NOISE_SCALE_LOG_SIGMA).powi(2);
    Some((root, log_prior - effective_rows * s.ln() - half_log_det))
}

/// Products of columns with each other and with a residual: of columns of any amplitude the evidence is found from them.
pub(crate) struct Moments {
    gram: DMatrix<f64>,
    with_residual: DVector<f64>,
    residual_norm2: f64,
    effective_rows: f64,
}

impl Moments {
    /// Those of transposed columns of whitened, tempered rows; `effective_rows` is n/τ.
    pub(crate) fn new(transposed: &DMatrix<f64>, residual: &DVector<f64>, effective_rows: f64) -> Self {
        Moments {
            gram: products(transposed),
            with_residual: transposed * residual,
            residual_norm2: residual.norm_squared(),
            effective_rows,
        }
    }

    /// Log evidence of the residual under the columns, each times a factor.
    pub(crate) fn log_evidence(&self, factors: &DVector<f64>) -> f64 {
        let count = self.gram.nrows();
        let gram = DMatrix::from_fn(count, count, |i, j| factors[i] * factors[j] * self.gram[(i, j)]);
        let right = self.with_residual.component_mul(factors);
        let log = |s: f64| {
            let (root, log_weight) = at_scale(&gram, s, self.effective_rows)?;
            let explained = right.dot(&root.solve(&right)) / s.powi(4);
            Some(log_weight - 0.5 * (self.residual_norm2 / (s * s) - explained))
        };
        log_sum(NOISE_SCALES.into_iter().filter_map(log))
    }
}

/// What belongs to one scale of the noise.
struct NoiseScale {
    /// 1/s².
    precision: f64,
    /// Cholesky factor L of A_s = L L'.
    root: Cholesky<f64, Dyn>,
    /// L⁻¹ / s².
    inverse_root: DMatrix<f64>,
    /// ln p(s) − n ln s − ½ ln|A_s|.
    log_weight: f64,
}

/// Columns with the basis taken out, scale by scale.
pub(crate) struct Reduced {
    /// R_s.
    grams: Vec<DMatrix<f64>>,
    log_weights: Vec<f64>,
}

/// Signs that the size of a column can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    /// Both: a normal prior.
    Both,
    /// Positive only: a half-normal prior.
    Positive,
}

/// Log evidence of a set of columns, with the posterior of their sizes.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    /// Natural logarithm.
    pub(crate) log: f64,
    /// Posterior mean of the sizes, in prior standard deviations.
    pub(crate) mean: DVector<f64>,
    /// Their posterior covariance.
    pub(crate) covariance: DMatrix<f64>,
}

impl LinearModel {
    /// Prepares a transposed basis of whitened, tempered rows; `effective_rows` is n/τ.
    pub(crate) fn new(transposed: DMatrix<f64>, effective_rows: f64) -> Self {
        let gram = products(&transposed);
        let scale = |s: f64| {
            let precision = 1.0 / (s * s);
            let (root, log_weight) = at_scale(&gram, s, effective_rows)?;
            let mut inverse_root = DMatrix::identity(gram.nrows(), gram.nrows()) * precision;
            root.l_dirty().solve_lower_triangular_mut(&mut inverse_root);
            Some(NoiseScale { precision, root, inverse_root, log_weight })
        };
        let scales = NOISE_SCALES.into_par_iter().filter_map(scale).collect();
        LinearModel { transposed, scales }
    }

    /// The basis, transposed: a column for each row of the drives.
    pub(crate) fn transposed(&self) -> &DMatrix<f64> {
        &self.transposed
    }

    /// B'E of columns over the first rows.
    pub(crate) fn with_basis(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        /// nalgebra multiplies fewer columns one by one, which reads all of B for each of them: eight at once take half the time of four.
        const AT_ONCE: usize = 8;
        let basis = self.transposed.columns(0, columns.nrows());
        match columns.ncols() {
            count @ 2..AT_ONCE => {
                let wide = columns.clone().resize_horizontally(AT_ONCE, 0.0);
                (basis * wide).resize_horizontally(count, 0.0)
            }
            _ => basis * columns,
        }
    }

    /// A group of columns over the first rows.
    pub(crate) fn group(&self, columns: DMatrix<f64>) -> Group {
        let with_basis = self.with_basis(&columns);
        let halves = self.halves(&with_basis);
        Group { columns, halves }
    }

    /// Posterior covariance of the first columns of the basis where the noise is as it was identified.
    pub(crate) fn covariance_of_first(&self, count: usize) -> DMatrix<f64> {
        let all = self.transposed.nrows();
        let with_prior = products(&self.transposed) + DMatrix::identity(all, all);
        let first = DMatrix::identity(all, count);
        let solved = with_prior.cholesky().map(|root| root.solve(&first));
        solved.map_or_else(|| DMatrix::identity(count, count), |all| all.rows(0, count).into_owned())
    }

    /// The last column of a group apart from those before it.
    pub(crate) fn split_last(group: &Group) -> (Group, Group) {
        let first = group.columns.ncols() - 1;
        let apart = |all: &DMatrix<f64>, from: usize, count: usize| all.columns(from, count).into_owned();
        let part = |from: usize, count: usize| Group {
            columns: apart(&group.columns, from, count),
            halves: group.halves.iter().map(|half| apart(half, from, count)).collect(),
        };
        (part(0, first), part(first, 1))
    }

    /// Columns of groups with the basis taken out; the last of the last group is the residual.
    pub(crate) fn reduce(&self, groups: &[&Group]) -> Reduced {
        let first: Vec<usize> = groups
            .iter()
            .scan(0, |next, group| {
                let first = *next;
                *next += group.columns.ncols();
                Some(first)
            })
            .collect();
        let count = groups.iter().map(|group| group.columns.ncols()).sum();
        let mut grams = vec![DMatrix::zeros(count, count); self.scales.len()];
        for (i, a) in groups.iter().enumerate() {
            for (j, b) in groups.iter().enumerate().skip(i) {
                let rows = a.columns.nrows().min(b.columns.nrows());
                let own = a.columns.rows(0, rows).transpose() * b.columns.rows(0, rows);
                for (k, scale) in self.scales.iter().enumerate() {
                    let block = &own * scale.precision - a.halves[k].transpose() * &b.halves[k];
                    grams[k].view_mut((first[i], first[j]), block.shape()).copy_from(&block);
                    if i != j {
                        let (rows, columns) = block.shape();
                        grams[k].view_mut((first[j], first[i]), (columns, rows)).tr_copy_from(&block);
                    }
                }
            }
        }
        Reduced { grams, log_weights: self.log_weights() }
    }

    /// L⁻¹ B'E / s² at every scale.
    pub(crate) fn halves(&self, with_basis: &DMatrix<f64>) -> Vec<DMatrix<f64>> {
        self.scales.iter().map(|scale| &scale.inverse_root * with_basis).collect()
    }

    /// 1/s² of every scale.
    pub(crate) fn precisions(&self) -> Vec<f64> {
        self.scales.iter().map(|scale| scale.precision).collect()
    }

    /// ln p(s) − n ln s − ½ ln|A_s| of every scale.
    pub(crate) fn log_weights(&self) -> Vec<f64> {
        self.scales.iter().map(|scale| scale.log_weight).collect()
    }

    /// Posterior mean of the basis' weights at the likeliest scale, about a residual that columns of their sizes were taken out of.
    pub(crate) fn basis_weights(&self, reduced: &Reduced, left: &DVector<f64>) -> DVector<f64> {
        let scale = &self.scales[reduced.likeliest_scale()];
        scale.root.solve(&(&self.transposed * left * scale.precision))
    }
}

impl Reduced {
    /// Reduced products that were worked out elsewhere, scale by scale.
    pub(crate) fn of(grams: Vec<DMatrix<f64>>, log_weights: Vec<f64>) -> Self {
        Reduced { grams, log_weights }
    }

    /// The same of some columns only, each times a factor; the residual stays.
    pub(crate) fn scaled(&self, factors: &[f64]) -> Reduced {
        let scaled = |gram: &DMatrix<f64>| {
            let last = gram.nrows() - 1;
            let factor = |i: usize| if i == last { 1.0 } else { factors[i] };
            DMatrix::from_fn(last + 1, last + 1, |i, j| factor(i) * factor(j) * gram[(i, j)])
        };
        Reduced { grams: self.grams.iter().map(scaled).collect(), log_weights: self.log_weights.clone() }
    }

    /// The same of a choice of columns; the residual stays.
    #[cfg(test)]
    pub(crate) fn select(&self, columns: &[usize]) -> Reduced {
        let chosen = |gram: &DMatrix<f64>| {
            let last = gram.nrows() - 1;
            let at = |i: usize| columns.get(i).copied().unwrap_or(last);
            let count = columns.len() + 1;
            DMatrix::from_fn(count, count, |i, j| gram[(at(i), at(j))])
        };
        Reduced { grams: self.grams.iter().map(chosen).collect(), log_weights: self.log_weights.clone() }
    }

    /// Log evidence and sizes with all columns free, `halves` saying which of the first cannot be negative.
    pub(crate) fn evidence(&self, halves: &[Half]) -> Evidence {
        let parts: Vec<Part> = (0..self.grams.len()).map(|i| self.at_scale(i, halves)).collect();
        let most = parts.iter().map(|part| part.log).fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = parts.iter().map(|part| (part.log - most).exp()).collect();
        let total: f64 = weights.iter().sum();
        let count = self.grams.first().map_or(0, |gram| gram.nrows() - 1);
        let mut mean = DVector::zeros(count);
        let mut covariance = DMatrix::zeros(count, count);
        for (part, weight) in parts.iter().zip(&weights) {
            mean += &part.mean * (weight / total);
            covariance += &part.covariance * (weight / total);
        }
        Evidence { log: most + total.ln(), mean, covariance }
    }

    /// Reduced square of the first column at the likeliest scale of the noise with all columns free.
    pub(crate) fn information(&self) -> f64 {
        self.grams.get(self.likeliest_scale()).map_or(0.0, |gram| gram[(0, 0)])
    }

    /// Index of the likeliest scale of the noise with all columns free.
    fn likeliest_scale(&self) -> usize {
        let log = |i: &usize| self.at_scale(*i, &[]).log;
        (0..self.grams.len()).max_by(|a, b| log(a).total_cmp(&log(b))).unwrap_or(0)
    }

    fn at_scale(&self, i: usize, halves: &[Half]) -> Part {
        let gram = &self.grams[i];
        let count = gram.nrows() - 1;
        let none = || Part {
            log: f64::NEG_INFINITY,
            mean: DVector::zeros(count),
            covariance: DMatrix::zeros(count, count),
        };
        let plain = self.log_weights[i] - 0.5 * gram[(count, count)];
        if count == 0 {
            return Part { log: plain, ..none() };
        }
        let mut with_prior = gram.view((0, 0), (count, count)).into_owned();
        (0..count).for_each(|j| with_prior[(j, j)] += 1.0);
        let Some(root) = with_prior.cholesky() else { return none() };
        let right = gram.view((0, count), (count, 1)).column(0).into_owned();
        let mean = root.solve(&right);
        let half_log_det: f64 = root.l_dirty().diagonal().iter().map(|l| l.ln()).sum();
        let covariance = root.inverse();
        let cut: f64 = (0..count)
            .filter(|j| halves.get(*j) == Some(&Half::Positive))
            .map(|j| log_share_above_zero(mean[j] / covariance[(j, j)].sqrt()) + std::f64::consts::LN_2)
            .sum();
        Part { log: plain + 0.5 * right.dot(&mean) - half_log_det + cut, mean, covariance }
    }
}

struct Part {
    log: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

/// ln Φ(z), by its asymptotic series where Φ underflows (Abramowitz & Stegun 26.2.12).
fn log_share_above_zero(z: f64) -> f64 {
    /// Where erfc is still exact.
    const EXACT_FROM: f64 = -30.0;
    if z > EXACT_FROM {
        return (0.5 * erfc(-z * std::f64::consts::FRAC_1_SQRT_2)).ln();
    }
    -0.5 * z * z - (-z).ln() - 0.5 * std::f64::consts::TAU.ln()
}

/// ln Σ exp.
pub(crate) fn log_sum(logs: impl IntoIterator<Item = f64>) -> f64 {
    let logs: Vec<f64> = logs.into_iter().collect();
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return most;
    }
    most + logs.iter().map(|log| (log - most).exp()).sum::<f64>().ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of deviation about one, the same in every run.
    fn waves(rows: usize, columns: usize, phase: f64) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |i, j| {
            1.4 * ((0.7 + 0.31 * j as f64) * i as f64 + phase + j as f64).sin()
        })
    }

    fn one_column(values: &DVector<f64>) -> DMatrix<f64> {
        DMatrix::from_columns(std::slice::from_ref(values))
    }

    /// ln N(r; 0, s² τ I + B B' + E E') in full, summed over scales, with the constant left out and the power 1/τ of the rows' density.
    fn brute(basis: &DMatrix<f64>, columns: &DMatrix<f64>, residual: &DVector<f64>) -> f64 {
        let n = residual.len();
        let one = |s: f64| {
            let noise = DMatrix::identity(n, n) * (s * s);
            let covariance = noise + basis * basis.transpose() + columns * columns.transpose();
            let root = covariance.cholesky().unwrap();
            let half_log_det: f64 = root.l().diagonal().iter().map(|l| l.ln()).sum();
            let prior = -0.5 * (s.ln() / NOISE_SCALE_LOG_SIGMA).powi(2);
            prior - half_log_det - 0.5 * residual.dot(&root.solve(residual))
        };
        log_sum(NOISE_SCALES.map(one))
    }

    #[test]
    fn evidence_is_the_density_of_the_rows_under_all_columns_together() {
        let (basis, columns) = (waves(40, 5, 0.3), waves(40, 3, 2.1));
        let residual = waves(40, 1, 4.0).column(0) + columns.column(1) * 0.8;
        let model = LinearModel::new(basis.transpose(), 40.0);
        let [columns_of, residual_of] = [columns.clone(), one_column(&residual)].map(|all| model.group(all));
        let reduced = model.reduce(&[&columns_of, &residual_of]);
        for some in [vec![], vec![1], vec![0, 2], vec![0, 1, 2]] {
            let expected = brute(&basis, &columns.select_columns(&some), &residual);
            let found = reduced.select(&some).evidence(&[]).log;
            assert!((found - expected).abs() < 1e-8, "{some:?}: {found} instead of {expected}");
        }
    }

    #[test]
    fn evidence_from_products_is_that_of_the_columns_at_their_amplitudes() {
        let (columns, residual) = (waves(40, 5, 0.3), waves(40, 1, 4.0).column(0).into_owned());
        let factors = DVector::from_vec(vec![1.0, 1.0, 0.3, 0.3, 0.3]);
        let scaled = &columns * DMatrix::from_diagonal(&factors);
        let expected = brute(&scaled, &DMatrix::zeros(40, 0), &residual);
        let found = Moments::new(&columns.transpose(), &residual, 40.0).log_evidence(&factors);
        assert!((found - expected).abs() < 1e-8, "{found} instead of {expected}");
    }

    #[test]
    fn a_size_of_the_wrong_sign_costs_evidence_and_one_of_the_right_sign_gains_a_factor_of_two() {
        let columns = waves(60, 1, 1.0);
        let evidence = |size: f64, half: Half| {
            let residual = waves(60, 1, 8.0).column(0) * 0.3 + columns.column(0) * size;
            let model = LinearModel::new(waves(60, 2, 5.0).transpose(), 60.0);
            let groups = [columns.clone(), one_column(&residual)].map(|all| model.group(all));
            model.reduce(&[&groups[0], &groups[1]]).evidence(&[half]).log
        };
        let gain = |size: f64| evidence(size, Half::Positive) - evidence(size, Half::Both);
        assert!((gain(2.0) - std::f64::consts::LN_2).abs() < 1e-6, "{}", gain(2.0));
        assert!(gain(-2.0) < -20.0, "{}", gain(-2.0));
    }

    #[test]
    fn tempered_rows_have_the_power_of_their_density() {
        // Without columns that are known, the power of a normal density is that of variance τ s², but for constants of s and τ.
        let residual = waves(30, 1, 0.0).column(0).into_owned();
        let tau = 4.0_f64;
        let none = DMatrix::zeros(30, 0);
        let tempered = LinearModel::new(none.transpose(), 30.0 / tau);
        let alone = tempered.group(one_column(&(&residual / tau.sqrt())));
        let found = tempered.reduce(&[&alone]).evidence(&[]).log;
        let one = |s: f64| {
            let log_density = -30.0 * s.ln() - 0.5 * residual.norm_squared() / (s * s);
            log_density / tau - 0.5 * (s.ln() / NOISE_SCALE_LOG_SIGMA).powi(2)
        };
        assert!((found - log_sum(NOISE_SCALES.map(one))).abs() < 1e-9);
    }

    #[test]
    fn shares_far_below_zero_are_told_without_underflow() {
        let beside = [-29.9, -30.1].map(log_share_above_zero);
        assert!((beside[0] - beside[1] - 6.0).abs() < 0.1, "{beside:?}");
        assert!((log_share_above_zero(0.0) + std::f64::consts::LN_2).abs() < 1e-12);
    }
}
