//! Screening: evidence of every effect in every window, and of pairs, from products of linear columns.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    evidence::{
        linear_model::matrix,
        reduced::{Evidence, Half, Reduced, log_sum},
        width::{self, WIDTHS},
    },
    fit::{joint::Joint, member::Member},
    hypothesis::{
        atoms::Atoms,
        effect::Effect,
        window::{Grid, Window},
    },
};

/// Sizes from which refits begin, at most in standard deviations of the prior of their width; refits may go farther.
const MOST_SIGMAS: f64 = 3.0;

/// One effect in one window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Which effect.
    pub(crate) effect: usize,
    /// Its window.
    pub(crate) window: Window,
    /// Log prior of form and window.
    pub(crate) log_prior: f64,
    /// Place of its first column among all.
    first: usize,
}

/// A set of candidates with its log evidence and log priors of forms and windows.
#[derive(Clone, Debug)]
pub(crate) struct Scored {
    /// Which candidates.
    pub(crate) set: Vec<usize>,
    /// Log evidence plus log priors of forms and windows.
    pub(crate) log: f64,
}

/// All candidates with what their evidence is made of.
pub(crate) struct Screen<'a> {
    joint: &'a Joint<'a>,
    grid: &'a Grid,
    pub(crate) effects: Vec<Effect>,
    pub(crate) candidates: Vec<Candidate>,
    atoms: Atoms,
    /// By effect, its first column among the unmasked ones.
    offsets: Vec<usize>,
    /// E'r by column of all candidates.
    with_residual: Vec<f64>,
    /// L⁻¹ B'E/s² at every scale, column by column of all candidates, and of the residual.
    halves: Vec<DMatrix<f64>>,
    residual_halves: Vec<DVector<f64>>,
    residual_norm2: f64,
}

impl<'a> Screen<'a> {
    /// Prepares effects in all of their windows.
    pub(crate) fn new(joint: &'a Joint<'a>, grid: &'a Grid, effects: Vec<Effect>) -> Self {
        let mut offsets = Vec::new();
        let mut columns = Vec::new();
        for effect in &effects {
            offsets.push(columns.len());
            columns.extend(joint.whiten(&effect.columns));
        }
        let atoms = Atoms::new(joint, grid, &matrix(joint.observed.test_rows, &columns));
        let mut candidates = Vec::new();
        let (mut with_basis, mut with_residual) = (Vec::new(), Vec::new());
        for (e, effect) in effects.iter().enumerate() {
            for (window, log_prior) in grid.windows(effect.mechanism) {
                let log_prior = log_prior + effect.log_prior;
                candidates.push(Candidate { effect: e, window, log_prior, first: with_basis.len() });
                for j in 0..effect.free.len() {
                    let (basis, residual) = atoms.column(offsets[e] + j, window);
                    with_basis.push(basis);
                    with_residual.push(residual);
                }
            }
        }
        let halves = joint.model.halves(&matrix(joint.model.transposed().nrows(), &with_basis));
        let by_basis = joint.model.with_basis(&DMatrix::from_columns(std::slice::from_ref(&joint.residual)));
        let residual_halves =
            joint.model.halves(&by_basis).into_iter().map(|half| half.column(0).into_owned()).collect();
        let residual_norm2 = joint.residual.norm_squared();
        Screen {
            joint,
            grid,
            effects,
            candidates,
            atoms,
            offsets,
            with_residual,
            halves,
            residual_halves,
            residual_norm2,
        }
    }

    /// The mechanism of a candidate.
    pub(crate) fn name(&self, candidate: usize) -> &'static str {
        self.effects[self.candidates[candidate].effect].mechanism.name()
    }

    /// Every candidate by itself.
    pub(crate) fn singles(&self) -> Vec<Scored> {
        (0..self.candidates.len()).into_par_iter().map(|i| self.score(&[i])).collect()
    }

    /// Candidates added to a set: each effect all the time, in its best window by itself, and in the windows of the set.
    pub(crate) fn grown(&self, set: &[usize], singles: &[Scored]) -> Vec<Scored> {
        let names: Vec<&str> = set.iter().map(|i| self.name(*i)).collect();
        let windows: Vec<Window> = set.iter().map(|i| self.candidates[*i].window).collect();
        let best = self.best_windows(singles);
        let is_tried = |i: &usize| {
            let candidate = &self.candidates[*i];
            let is_new = !names.contains(&self.name(*i));
            let window = candidate.window;
            is_new && (window == Window::Always || best[candidate.effect] == *i || windows.contains(&window))
        };
        let tried: Vec<usize> = (0..self.candidates.len()).filter(is_tried).collect();
        tried.into_par_iter().map(|i| self.score(&[set, &[i]].concat())).collect()
    }

    /// By effect, the candidate of its likeliest window.
    fn best_windows(&self, singles: &[Scored]) -> Vec<usize> {
        let mut best: Vec<usize> = vec![usize::MAX; self.effects.len()];
        for (i, candidate) in self.candidates.iter().enumerate() {
            let known = &mut best[candidate.effect];
            if *known == usize::MAX || singles[i].log > singles[*known].log {
                *known = i;
            }
        }
        best
    }

    /// Log evidence of a set.
    pub(crate) fn score(&self, set: &[usize]) -> Scored {
        let (evidence, _, of_widths) = self.at_widths(set);
        let priors: f64 = set.iter().map(|i| self.candidates[*i].log_prior).sum();
        Scored { set: set.to_vec(), log: evidence.log + of_widths + priors }
    }

    /// Evidence of a set with the widths of its priors that its sizes ask for, these by column, and their log prior.
    fn at_widths(&self, set: &[usize]) -> (Evidence, Vec<f64>, f64) {
        let (reduced, halves) = self.reduced(set);
        let mut widths = vec![WIDTHS[0]; halves.len()];
        let mut log_prior = set.len() as f64 * width::log_priors()[0];
        let mut evidence = reduced.evidence(&halves);
        // A wider prior shrinks sizes less, which may ask for one that is wider still.
        for _ in 1..WIDTHS.len() {
            let sizes: Vec<f64> = evidence.mean.iter().zip(&widths).map(|(x, by)| x * by).collect();
            let (next, of_next) = self.widths(set, &sizes);
            if next == widths {
                break;
            }
            (widths, log_prior) = (next, of_next);
            evidence = reduced.scaled(&widths).evidence(&halves);
        }
        (evidence, widths, log_prior)
    }

    /// Likeliest widths of the sizes of a set, by column, and their log prior.
    fn widths(&self, set: &[usize], sizes: &[f64]) -> (Vec<f64>, f64) {
        let (mut widths, mut log_prior, mut next) = (Vec::new(), 0.0, 0);
        for i in set {
            let count = self.effects[self.candidates[*i].effect].free.len();
            let (by, of_width, _) = width::likeliest(&sizes[next..next + count]);
            widths.resize(next + count, by);
            (log_prior, next) = (log_prior + of_width, next + count);
        }
        (widths, log_prior)
    }

    /// Members of a set at their posterior means.
    pub(crate) fn members(&self, set: &[usize]) -> Vec<Member> {
        let (evidence, widths, _) = self.at_widths(set);
        let mut next = 0;
        let member = |i: &usize| {
            let candidate = &self.candidates[*i];
            let effect = &self.effects[candidate.effect];
            let least = |half: Half| if half == Half::Positive { 0.01 } else { -MOST_SIGMAS };
            let sizes: Vec<f64> = effect
                .free
                .iter()
                .enumerate()
                .map(|(j, size)| {
                    widths[next + j] * evidence.mean[next + j].clamp(least(size.half), MOST_SIGMAS)
                })
                .collect();
            next += sizes.len();
            let mut member = Member {
                mechanism: effect.mechanism,
                values: effect.values.clone(),
                free: effect.free.clone(),
                width: WIDTHS[0],
                correlation: effect.correlation,
                span: self.grid.span(candidate.window),
                log_prior: candidate.log_prior,
            };
            member.set(self.joint.file, &sizes);
            member
        };
        set.iter().map(member).collect()
    }

    /// Reduced square of each effect's first size that acts all the time, at the likeliest noise: what the drives tell of it, per prior
    /// standard deviation.
    pub(crate) fn information(&self) -> Vec<(&Effect, f64)> {
        let always = (0..self.candidates.len()).filter(|i| self.candidates[*i].window == Window::Always);
        always
            .map(|i| {
                let (reduced, _) = self.reduced(&[i]);
                (&self.effects[self.candidates[i].effect], reduced.information())
            })
            .collect()
    }

    /// Columns of a set: place among the unmasked ones, window, place among all, sign.
    fn columns(&self, set: &[usize]) -> Vec<(usize, Window, usize, Half)> {
        let of = |i: &usize| {
            let Candidate { effect, window, first, .. } = self.candidates[*i];
            let free = &self.effects[effect].free;
            let offset = self.offsets[effect];
            (0..free.len()).map(move |j| (offset + j, window, first + j, free[j].half))
        };
        set.iter().flat_map(of).collect()
    }

    fn reduced(&self, set: &[usize]) -> (Reduced, Vec<Half>) {
        let columns = self.columns(set);
        let count = columns.len();
        let product = |i: usize, j: usize| {
            let ((a, in_a, ..), (b, in_b, ..)) = (columns[i], columns[j]);
            self.atoms.product((a, in_a), (b, in_b))
        };
        let own = DMatrix::from_fn(count, count, |i, j| if j <= i { product(i, j) } else { 0.0 });
        let precisions = self.joint.model.precisions();
        let gram = |k: usize| {
            let (halves, of_residual) = (&self.halves[k], &self.residual_halves[k]);
            let mut gram = DMatrix::zeros(count + 1, count + 1);
            for (i, (.., place, _)) in columns.iter().enumerate() {
                let half = halves.column(*place);
                for (j, (.., other, _)) in columns.iter().enumerate().take(i + 1) {
                    let value = own[(i, j)] * precisions[k] - half.dot(&halves.column(*other));
                    (gram[(i, j)], gram[(j, i)]) = (value, value);
                }
                let value = self.with_residual[*place] * precisions[k] - half.dot(of_residual);
                (gram[(i, count)], gram[(count, i)]) = (value, value);
            }
            gram[(count, count)] = self.residual_norm2 * precisions[k] - of_residual.norm_squared();
            gram
        };
        let grams = (0..precisions.len()).map(gram).collect();
        let halves = columns.iter().map(|column| column.3).collect();
        (Reduced::of(grams, self.joint.model.log_weights()), halves)
    }

    /// By set of names, the best of some scored sets and by how much all of that name together are likelier.
    pub(crate) fn by_names(&self, scored: &[Scored]) -> Vec<(Vec<&'static str>, Scored, f64)> {
        let mut groups = std::collections::BTreeMap::<Vec<&'static str>, Vec<&Scored>>::new();
        for one in scored {
            let mut names: Vec<&'static str> = one.set.iter().map(|i| self.name(*i)).collect();
            names.sort_unstable();
            groups.entry(names).or_default().push(one);
        }
        let best = |(names, all): (Vec<&'static str>, Vec<&Scored>)| {
            let best = all.iter().max_by(|a, b| a.log.total_cmp(&b.log))?;
            let together = log_sum(all.iter().map(|one| one.log));
            Some((names, (*best).clone(), together - best.log))
        };
        let mut ranked: Vec<_> = groups.into_iter().filter_map(best).collect();
        ranked.sort_by(|a, b| (b.1.log + b.2).total_cmp(&(a.1.log + a.2)));
        ranked
    }
}

#[cfg(test)]
mod tests {
    use model::mechanism::{self, Scale};

    use super::*;
    use crate::{
        Series,
        evidence::linear_model::Amplitudes,
        fit::{baseline::Baseline, discrepancy::Shares},
        hypothesis::{
            effect::{Beside, effects},
            window::Windows,
        },
        observe::{hills::drive, observations::Observations},
    };

    #[test]
    fn products_by_piece_give_the_evidence_of_masked_columns() {
        let robot = model::builtin::husky_a200();
        let series = Series::new(&robot, &drive(&robot, 0.0, &[]), None).unwrap();
        let observed = Observations::new(&series, &robot);
        let baseline = Baseline::fit(&observed, &robot).unwrap();
        let white = baseline.noise.whitening(&baseline.predicted, &observed.places);
        let others = baseline.discrepancy(&observed, Shares::of_power(0.03));
        let joint =
            Joint::new(&observed, (&baseline, &robot), &others, white, 4.0, &Amplitudes::as_they_are());
        let library = ["payload", "surface_change"].map(|name| mechanism::by_name(name).unwrap());
        let scale =
            Scale { robot: &robot, meter_zero_w: 7.0, mean_power_w: 90.0, mean_loss_w: 9.0, row_s: 0.1 };
        let (series, robot) = (&series, &baseline.robot);
        let beside =
            Beside { series, robot, applied: &[], predicted: &baseline.predicted, everywhere: false };
        let effects = effects(&library, &scale, &beside).unwrap();
        let grid = Grid::new(&observed, Windows::All);
        let screen = Screen::new(&joint, &grid, effects.clone());
        for window in [Window::Always, Window::From(6), Window::Until(9)] {
            let is_it = |c: &Candidate| c.effect == 1 && c.window == window;
            let place = screen.candidates.iter().position(is_it).unwrap();
            let masked = |column: &DVector<f64>| {
                let holds = |i: usize| window.holds(grid.piece(observed.driven_s[i]), None);
                DVector::from_fn(column.len(), |i, _| if holds(i) { column[i] } else { 0.0 })
            };
            let columns: Vec<_> = joint.whiten(&effects[1].columns).iter().map(masked).collect();
            let group = joint.model.group(DMatrix::from_columns(&columns));
            let residual = joint.model.group(DMatrix::from_columns(std::slice::from_ref(&joint.residual)));
            let whole = joint.model.reduce(&[&group, &residual]).evidence(&[]);
            assert!(width::likeliest(whole.mean.as_slice()).0 == WIDTHS[0], "{window:?}: {}", whole.mean);
            let expected = whole.log + width::log_priors()[0] + screen.candidates[place].log_prior;
            let found = screen.score(&[place]).log;
            assert!((found - expected).abs() < 1e-6 * expected.abs(), "{window:?}: {found} for {expected}");
        }
    }
}
