//! What simpler methods would say of the same drives: the Bayesian information criterion on errors taken as independent, and a
//! sparse regression. They are there to be compared with, and decide nothing.

use model::{Robot, mechanism};
use nalgebra::{DMatrix, DVector};

use crate::{
    Error, Series,
    fit::baseline::{Baseline, differences},
    hypothesis::{
        effect::effects,
        window::{Grid, Windows},
    },
    observe::observations::Observations,
    search::engine::{alone, scale},
};

/// Mechanisms that are taken up at most, as many as the diagnosis takes.
const MOST: usize = 3;
/// Weight of the ridge on columns of length one: that of `pysindy.STLSQ` unless told otherwise.
const RIDGE: f64 = 0.05;
/// Terms that make less of the mean power than this are struck out: the weakest effect anyone asks for makes 1.2 %.
const THRESHOLD: f64 = 0.01;
/// Rounds of fitting and striking out: the default of `pysindy.STLSQ`.
const ROUNDS: usize = 20;

/// Drives with the errors of the robot fitted to them, and all that could explain these.
pub struct Plain {
    errors_w: DVector<f64>,
    always: Vec<Vec<f64>>,
    candidates: Vec<Candidate>,
    mean_w: f64,
}

/// A mechanism in one window, with the power of each of its free parameters.
struct Candidate {
    mechanism: &'static str,
    columns: Vec<Vec<f64>>,
}

impl Plain {
    /// Fits the robot and works out what every mechanism would change in every window.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub fn new(series: &Series, robot: &Robot) -> Result<Self, Error> {
        let observed = Observations::new(series, robot);
        let baseline = Baseline::fit(&observed, robot)?;
        let grid = Grid::new(&observed, Windows::All);
        let effects =
            effects(&mechanism::ALL, &scale(&observed, &baseline, robot), &alone(&observed, &baseline))?;
        // Errors taken as alike are all of power.
        let rows: Vec<usize> = (0..observed.rows()).filter(|i| observed.is_power(*i)).collect();
        let power = |values: &[f64]| -> Vec<f64> { rows.iter().map(|i| values[*i]).collect() };
        let mut candidates = Vec::new();
        // Wider priors change no column.
        for effect in effects.iter().filter(|effect| effect.widening <= 1.0) {
            for (window, _) in grid.windows(effect.mechanism) {
                let holds = |i: usize| {
                    let average = &observed.averages()[i];
                    window.holds(grid.piece(observed.driven_s[i]), grid.part(average.input.position_m))
                };
                let masked = |column: &Vec<f64>| -> Vec<f64> {
                    rows.iter().map(|i| if holds(*i) { column[*i] } else { 0.0 }).collect()
                };
                let columns = effect.columns.iter().map(masked).collect();
                candidates.push(Candidate { mechanism: effect.mechanism.name(), columns });
            }
        }
        let predicted_w = power(&baseline.predicted);
        Ok(Plain {
            errors_w: DVector::from_vec(differences(&power(&series.recorded), &predicted_w)),
            always: baseline.sensitivities.iter().map(|column| power(column)).collect(),
            candidates,
            mean_w: predicted_w.iter().map(|w| w.abs()).sum::<f64>() / predicted_w.len().max(1) as f64,
        })
    }

    /// Mechanisms by forward selection, each time the one that lowers n ln(RSS/n) + k ln n most, as long as one does
    /// (Schwarz, Ann. Stat. 6, 1978).
    pub fn by_information(&self) -> Vec<String> {
        let mut basis = orthonormal(&self.always);
        let mut left = project(&self.errors_w, &basis);
        let mut found: Vec<String> = Vec::new();
        while found.len() < MOST {
            let (n, before) = (left.len() as f64, left.norm_squared());
            let gain = |candidate: &Candidate| {
                let own = own(&basis, &candidate.columns);
                let after = project(&left, &own).norm_squared();
                let drop = n * (before.max(1e-300) / after.max(1e-300)).ln() - own.len() as f64 * n.ln();
                (drop, own)
            };
            let new = self.candidates.iter().filter(|c| !found.iter().any(|f| f == c.mechanism));
            let weighed = new.map(|candidate| (gain(candidate), candidate));
            let Some(((drop, own), best)) = weighed.max_by(|a, b| a.0.0.total_cmp(&b.0.0)) else { break };
            if drop <= 0.0 {
                break;
            }
            left = project(&left, &own);
            basis.extend(own);
            found.push(best.mechanism.to_owned());
        }
        found
    }

    /// Mechanisms that are left by sequentially thresholded least squares (Brunton, Proctor and Kutz, PNAS 113, 2016) over the
    /// columns of all mechanisms that act from the beginning, largest first.
    pub fn by_sparse_regression(&self) -> Vec<String> {
        let columns = self.library();
        let mut active: Vec<usize> = (0..columns.len()).collect();
        let mut sizes = vec![0.0; columns.len()];
        let least = THRESHOLD * self.mean_w * (self.errors_w.len() as f64).sqrt();
        for _ in 0..ROUNDS {
            sizes = self.ridge(&columns, &active);
            let kept: Vec<usize> = active.iter().copied().filter(|i| sizes[*i].abs() >= least).collect();
            if kept.len() == active.len() {
                break;
            }
            active = kept;
        }
        active.sort_by(|a, b| sizes[*b].abs().total_cmp(&sizes[*a].abs()));
        let mut names: Vec<String> = Vec::new();
        for i in active {
            if !names.iter().any(|n| n == columns[i].0) {
                names.push(columns[i].0.to_owned());
            }
        }
        names
    }

    /// One column of length one for each parameter, and the mechanism that it belongs to.
    fn library(&self) -> Vec<(&'static str, DVector<f64>)> {
        let basis = orthonormal(&self.always);
        let mut columns: Vec<(&'static str, DVector<f64>)> = Vec::new();
        for (i, candidate) in self.candidates.iter().enumerate() {
            // The first of a mechanism acts from the beginning, with nothing taken from a grid beyond its first value.
            if self.candidates[..i].iter().any(|other| other.mechanism == candidate.mechanism) {
                continue;
            }
            for column in &candidate.columns {
                let column = DVector::from_column_slice(column);
                let left = project(&column, &basis);
                if left.norm() > LEAST_OWN * column.norm() {
                    columns.push((candidate.mechanism, left.normalize()));
                }
            }
        }
        columns
    }

    /// Coefficients of the active columns by ridge regression; 0 of the others.
    fn ridge(&self, columns: &[(&'static str, DVector<f64>)], active: &[usize]) -> Vec<f64> {
        let count = active.len();
        let square = DMatrix::from_fn(count, count, |i, j| {
            let ridge = if i == j { RIDGE } else { 0.0 };
            columns[active[i]].1.dot(&columns[active[j]].1) + ridge
        });
        let right = DVector::from_fn(count, |i, _| columns[active[i]].1.dot(&self.errors_w));
        let mut sizes = vec![0.0; columns.len()];
        if let Some(root) = square.cholesky() {
            let solved = root.solve(&right);
            active.iter().zip(solved.iter()).for_each(|(i, size)| sizes[*i] = *size);
        }
        sizes
    }
}

/// Share of a column's length that has to be its own, so that dividing by it makes sense.
const LEAST_OWN: f64 = 1e-3;

/// Directions that columns span.
fn orthonormal(columns: &[Vec<f64>]) -> Vec<DVector<f64>> {
    own(&[], columns)
}

/// Directions that columns span beyond a basis, by Gram and Schmidt.
fn own(basis: &[DVector<f64>], columns: &[Vec<f64>]) -> Vec<DVector<f64>> {
    let mut new: Vec<DVector<f64>> = Vec::new();
    for column in columns {
        let column = DVector::from_column_slice(column);
        // Twice, because once leaves rounding behind.
        let left = (0..2).fold(column.clone(), |left, _| project(&project(&left, basis), &new));
        if left.norm() > LEAST_OWN * column.norm() {
            new.push(left.normalize());
        }
    }
    new
}

/// What is left of a vector beside orthonormal directions.
fn project(vector: &DVector<f64>, basis: &[DVector<f64>]) -> DVector<f64> {
    let mut left = vector.clone();
    for direction in basis {
        let along = direction.dot(&left);
        left.axpy(-along, direction, 1.0);
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waves(frequency: f64) -> Vec<f64> {
        (0..400).map(|i| (frequency * f64::from(i)).sin()).collect()
    }

    fn plain(weights: &[(f64, &'static str, f64)], noise_w: f64) -> Plain {
        let mut errors_w =
            DVector::from_fn(400, |i, _| noise_w * f64::from((i * 7919 % 101) as i32 - 50) / 50.0);
        let mut candidates = Vec::new();
        for (frequency, mechanism, weight) in weights {
            errors_w.axpy(*weight, &DVector::from_vec(waves(*frequency)), 1.0);
            candidates.push(Candidate { mechanism, columns: vec![waves(*frequency)] });
        }
        Plain { errors_w, always: vec![vec![1.0; 400]], candidates, mean_w: 100.0 }
    }

    #[test]
    fn both_name_what_is_there_largest_first_and_nothing_else() {
        let plain = plain(&[(0.3, "wind", 2.5), (0.7, "payload", 6.0), (1.1, "inertia", 0.0)], 0.5);
        assert_eq!(plain.by_information(), ["payload", "wind"]);
        assert_eq!(plain.by_sparse_regression(), ["payload", "wind"]);
    }

    #[test]
    fn neither_names_anything_in_noise_that_is_independent() {
        let plain = plain(&[(0.3, "wind", 0.0), (0.7, "payload", 0.0)], 0.5);
        assert!(plain.by_information().is_empty() && plain.by_sparse_regression().is_empty());
    }
}
