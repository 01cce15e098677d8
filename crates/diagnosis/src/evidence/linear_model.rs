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

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use crate::evidence::reduced::{Reduced, log_sum};

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

impl Group {
    /// The same columns, each times a factor.
    pub(crate) fn scaled(mut self, factors: &[f64]) -> Self {
        let scale = |all: &mut DMatrix<f64>| {
            all.column_iter_mut().zip(factors).for_each(|(mut column, by)| column *= *by);
        };
        scale(&mut self.columns);
        self.halves.iter_mut().for_each(scale);
        self
    }
}

/// A linear model about one residual.
pub(crate) struct LinearModel {
    /// B', of which products are faster.
    transposed: DMatrix<f64>,
    /// Those of the first amplitude first.
    scales: Vec<NoiseScale>,
    /// Factors of the basis at each amplitude.
    factors: Vec<DVector<f64>>,
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

/// What belongs to one scale of the noise and one amplitude of the basis.
struct NoiseScale {
    /// 1/s².
    precision: f64,
    /// Which of the amplitudes.
    amplitude: usize,
    /// Cholesky factor L of A_s = L L'.
    root: Cholesky<f64, Dyn>,
    /// L⁻¹ / s², times the amplitude column by column.
    inverse_root: DMatrix<f64>,
    /// ln p(s) − n ln s − ½ ln|A_s|, and of all amplitudes together ln of this one's prior.
    log_weight: f64,
}

/// Amplitudes of parts of a basis; the first combination is that of screening.
pub(crate) struct Amplitudes {
    each: Vec<Combination>,
}

/// One amplitude of every part.
#[derive(Clone)]
struct Combination {
    /// Columns, and by which factor they are larger.
    parts: Vec<(Range<usize>, f64)>,
    log_prior: f64,
}

impl Amplitudes {
    /// No other amplitude than that of the columns as they are.
    pub(crate) fn as_they_are() -> Self {
        Amplitudes { each: vec![Combination { parts: Vec::new(), log_prior: 0.0 }] }
    }

    /// These together with each amplitude of another part, given as factors with log priors.
    pub(crate) fn with(&self, columns: &Range<usize>, factors: &[(f64, f64)]) -> Self {
        let together = |(by, log_prior): (f64, f64)| {
            self.each.iter().cloned().map(move |mut one| {
                one.parts.push((columns.clone(), by));
                one.log_prior += log_prior;
                one
            })
        };
        Amplitudes { each: factors.iter().copied().flat_map(together).collect() }
    }

    /// Factors of so many columns at each combination.
    fn factors(&self, count: usize) -> Vec<DVector<f64>> {
        let of = |one: &Combination| {
            let mut factors = DVector::from_element(count, 1.0);
            for (columns, by) in &one.parts {
                factors.rows_mut(columns.start, columns.len()).fill(*by);
            }
            factors
        };
        self.each.iter().map(of).collect()
    }
}

impl LinearModel {
    /// Prepares a transposed basis of whitened, tempered rows; `effective_rows` is n/τ.
    pub(crate) fn new(transposed: DMatrix<f64>, effective_rows: f64, amplitudes: &Amplitudes) -> Self {
        let gram = products(&transposed);
        let count = gram.nrows();
        let factors = amplitudes.factors(count);
        let scale = |(amplitude, s): (usize, f64)| {
            let (precision, factors) = (1.0 / (s * s), &factors[amplitude]);
            let gram = DMatrix::from_fn(count, count, |i, j| factors[i] * factors[j] * gram[(i, j)]);
            let (root, log_weight) = at_scale(&gram, s, effective_rows)?;
            let mut inverse_root = DMatrix::from_diagonal(&(factors * precision));
            root.l_dirty().solve_lower_triangular_mut(&mut inverse_root);
            let log_weight = log_weight + amplitudes.each[amplitude].log_prior;
            Some(NoiseScale { precision, amplitude, root, inverse_root, log_weight })
        };
        let all: Vec<(usize, f64)> = (0..factors.len()).flat_map(|a| NOISE_SCALES.map(|s| (a, s))).collect();
        let scales = all.into_par_iter().filter_map(scale).collect();
        LinearModel { transposed, scales, factors }
    }

    /// How many scales belong to the first amplitude.
    fn first_scales(&self) -> usize {
        self.of_first().count()
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

    /// A group of columns over the first rows, beside the basis of the first amplitude.
    pub(crate) fn group(&self, columns: DMatrix<f64>) -> Group {
        let with_basis = self.with_basis(&columns);
        let halves = self.halves(&with_basis);
        Group { columns, halves }
    }

    /// A group of columns over the first rows, beside the basis of every amplitude.
    pub(crate) fn group_at_all(&self, columns: DMatrix<f64>) -> Group {
        let with_basis = self.with_basis(&columns);
        let halves = self.scales.iter().map(|scale| &scale.inverse_root * &with_basis).collect();
        Group { columns, halves }
    }

    /// A group beside the basis of the first amplitude alone.
    pub(crate) fn at_first(&self, group: &Group) -> Group {
        let halves = group.halves[..self.first_scales().min(group.halves.len())].to_vec();
        Group { columns: group.columns.clone(), halves }
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

    /// Columns of groups with the basis taken out, at the scales and amplitudes that all of them have; the last of the last group is the
    /// residual.
    pub(crate) fn reduce(&self, groups: &[&Group]) -> Reduced {
        let scales = groups.iter().map(|group| group.halves.len()).min().unwrap_or(0);
        let first: Vec<usize> = groups
            .iter()
            .scan(0, |next, group| {
                let first = *next;
                *next += group.columns.ncols();
                Some(first)
            })
            .collect();
        let count = groups.iter().map(|group| group.columns.ncols()).sum();
        let mut grams = vec![DMatrix::zeros(count, count); scales];
        for (i, a) in groups.iter().enumerate() {
            for (j, b) in groups.iter().enumerate().skip(i) {
                let rows = a.columns.nrows().min(b.columns.nrows());
                let own = a.columns.rows(0, rows).transpose() * b.columns.rows(0, rows);
                for (k, scale) in self.scales[..scales].iter().enumerate() {
                    let block = &own * scale.precision - a.halves[k].transpose() * &b.halves[k];
                    grams[k].view_mut((first[i], first[j]), block.shape()).copy_from(&block);
                    if i != j {
                        let (rows, columns) = block.shape();
                        grams[k].view_mut((first[j], first[i]), (columns, rows)).tr_copy_from(&block);
                    }
                }
            }
        }
        Reduced::of(grams, self.scales[..scales].iter().map(|scale| scale.log_weight).collect())
    }

    /// The scales of the first amplitude.
    fn of_first(&self) -> impl Iterator<Item = &NoiseScale> {
        self.scales.iter().take_while(|scale| scale.amplitude == 0)
    }

    /// L⁻¹ B'E / s² at every scale of the first amplitude.
    pub(crate) fn halves(&self, with_basis: &DMatrix<f64>) -> Vec<DMatrix<f64>> {
        self.of_first().map(|scale| &scale.inverse_root * with_basis).collect()
    }

    /// 1/s² of every scale of the first amplitude.
    pub(crate) fn precisions(&self) -> Vec<f64> {
        self.of_first().map(|scale| scale.precision).collect()
    }

    /// ln p(s) − n ln s − ½ ln|A_s| of every scale of the first amplitude.
    pub(crate) fn log_weights(&self) -> Vec<f64> {
        self.of_first().map(|scale| scale.log_weight).collect()
    }

    /// Posterior mean of the basis' weights at the likeliest scale and amplitude, about a residual that columns of their sizes were taken out of.
    pub(crate) fn basis_weights(&self, reduced: &Reduced, left: &DVector<f64>) -> DVector<f64> {
        let scale = &self.scales[reduced.likeliest_scale()];
        let factors = &self.factors[scale.amplitude];
        let right = (&self.transposed * left * scale.precision).component_mul(factors);
        scale.root.solve(&right).component_mul(factors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::reduced::Half;

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
        let model = LinearModel::new(basis.transpose(), 40.0, &Amplitudes::as_they_are());
        let [columns_of, residual_of] = [columns.clone(), one_column(&residual)].map(|all| model.group(all));
        let reduced = model.reduce(&[&columns_of, &residual_of]);
        for some in [vec![], vec![1], vec![0, 2], vec![0, 1, 2]] {
            let expected = brute(&basis, &columns.select_columns(&some), &residual);
            let found = reduced.select(&some).evidence(&[]).log;
            assert!((found - expected).abs() < 1e-8, "{some:?}: {found} instead of {expected}");
        }
    }

    #[test]
    fn amplitudes_are_summed_over_by_their_priors_and_the_first_scales_are_those_of_the_first() {
        let (basis, columns) = (waves(40, 5, 0.3), waves(40, 2, 2.1));
        let residual = waves(40, 1, 4.0).column(0) + basis.column(3) * 2.5;
        let each = [(1.0, 0.7_f64.ln()), (3.0, 0.3_f64.ln())];
        let model =
            LinearModel::new(basis.transpose(), 40.0, &Amplitudes::as_they_are().with(&(2..5), &each));
        let all = [columns.clone(), one_column(&residual)].map(|all| model.group_at_all(all));
        let reduced = model.reduce(&[&all[0], &all[1]]);
        let density = |(by, log_prior): (f64, f64)| {
            let wider = DMatrix::from_fn(40, 5, |i, j| if j < 2 { 1.0 } else { by } * basis[(i, j)]);
            log_prior + brute(&wider, &columns, &residual)
        };
        let expected = log_sum(each.map(density));
        let found = reduced.evidence(&[]).log;
        assert!((found - expected).abs() < 1e-8, "{found} instead of {expected}");
        let first = all.each_ref().map(|group| model.at_first(group));
        let found = model.reduce(&[&first[0], &first[1]]).evidence(&[]).log;
        assert!((found - density(each[0])).abs() < 1e-8, "{found}");
        let scales = first[1].halves.len();
        assert!((reduced.first(scales).evidence(&[]).log - found).abs() < 1e-12);
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
            let model = LinearModel::new(waves(60, 2, 5.0).transpose(), 60.0, &Amplitudes::as_they_are());
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
        let tempered = LinearModel::new(none.transpose(), 30.0 / tau, &Amplitudes::as_they_are());
        let alone = tempered.group(one_column(&(&residual / tau.sqrt())));
        let found = tempered.reduce(&[&alone]).evidence(&[]).log;
        let one = |s: f64| {
            let log_density = -30.0 * s.ln() - 0.5 * residual.norm_squared() / (s * s);
            log_density / tau - 0.5 * (s.ln() / NOISE_SCALE_LOG_SIGMA).powi(2)
        };
        assert!((found - log_sum(NOISE_SCALES.map(one))).abs() < 1e-9);
    }
}
