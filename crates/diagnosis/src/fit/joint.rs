//! Robot, discrepancy and effects fitted together: one linearisation of the robot, effects as they are.

use model::Robot;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::{
    Applied, Error, Span,
    evidence::{
        linear_model::{Amplitudes, Group, LinearModel, matrix, products, transposed},
        noise::Whitening,
        reduced::{Evidence, Half, Reduced},
    },
    fit::{baseline::Baseline, features::Features, member::Member},
    observe::observations::{Observations, REGIME},
};

/// Shares by which an effect's form may be off, one sigma, each twice as far and a quarter as likely as the one before: in concealed worlds with
/// forms of their own, sizes that noise told to 5 % were off by 8 %, and a few by a third. The evidence is their weighted sum.
const FORM_ERRORS: [f64; 3] = [0.07, 0.14, 0.28];
/// Functions by which it is off, for each member: a third of the discrepancy's.
const FORM_FUNCTIONS: usize = 8;
/// Their length scales: of each quantity of the regime in its scatter, those of the discrepancy, and of time as a share of all time.
const FORM_LENGTHS: [f64; REGIME] = [1.5; REGIME];
const FORM_TIME_LENGTH: f64 = 0.3;
/// Steps of Gauss and Newton at most.
const STEPS: usize = 4;
/// A fit has settled where a step gains less log density: odds change by a tenth, which no threshold of the verdict notices.
const SETTLED: f64 = 0.1;
/// Step of differences, as a share of a size and at least in prior standard deviations.
const DIFFERENCE: f64 = 0.05;
/// Shares of a step that are tried in turn.
const SHARES: [f64; 3] = [1.0, 0.4, 0.15];

/// The linear model of all drives with what it was made of.
pub(crate) struct Joint<'a> {
    /// Rows.
    pub(crate) observed: &'a Observations<'a>,
    /// The robot.
    pub(crate) baseline: &'a Baseline,
    /// The robot's file, whose bounds sizes keep to.
    pub(crate) file: &'a Robot,
    /// Whitening with weights and temperature.
    pub(crate) whitening: Whitening,
    /// The model.
    pub(crate) model: LinearModel,
    /// The whitened residual.
    pub(crate) residual: DVector<f64>,
    /// Cholesky factor of I + J'J, J the whitened sensitivities of the robot's parameters.
    parameters_root: Option<Cholesky<f64, Dyn>>,
}

/// Evidence summed over the shares by which forms may be off.
struct FormErrors {
    evidence: Evidence,
    /// The likeliest share, and the mean of their squares.
    likeliest: f64,
    mean_square: f64,
    /// Log evidence with it alone.
    log_of_likeliest: f64,
}

impl FormErrors {
    /// Of reduced columns of sizes, then of forms that are off by 1, then the residual.
    fn new(reduced: &Reduced, halves: &[Half], forms: usize) -> Self {
        if forms == 0 {
            let evidence = reduced.evidence(halves);
            let likeliest = FORM_ERRORS[0];
            return FormErrors { likeliest, mean_square: 0.0, log_of_likeliest: evidence.log, evidence };
        }
        let weights = FORM_ERRORS.map(|share| (FORM_ERRORS[0] / share).powi(2));
        let total: f64 = weights.iter().sum();
        let of = |share: f64| reduced.scaled(&form_factors(halves.len(), forms, share)).evidence(halves);
        let each = FORM_ERRORS.map(of);
        let log = |i: &usize| each[*i].log + (weights[*i] / total).ln();
        let best = (0..each.len()).max_by(|a, b| log(a).total_cmp(&log(b))).unwrap_or(0);
        let (likeliest, log_of_likeliest) = (FORM_ERRORS[best], each[best].log);
        let logs: Vec<f64> = (0..each.len()).map(|i| log(&i)).collect();
        let evidence = Evidence::mixed(&logs, each.iter().map(|one| (&one.mean, &one.covariance)));
        let squares =
            FORM_ERRORS.iter().zip(&logs).map(|(share, log)| share * share * (log - evidence.log).exp());
        FormErrors { mean_square: squares.sum(), evidence, likeliest, log_of_likeliest }
    }
}

/// Factors of columns of sizes and of forms that are off by a share.
fn form_factors(sizes: usize, forms: usize, share: f64) -> Vec<f64> {
    (0..sizes + forms).map(|i| if i < sizes { 1.0 } else { share }).collect()
}

/// Gives members the likeliest widths of their sizes, and their columns the same units.
fn widen(members: &mut [Member], columns: &mut [Vec<f64>]) {
    let mut columns = columns.iter_mut();
    for member in members {
        let by = member.widen();
        let own = columns.by_ref().take(member.free.len());
        own.flatten().for_each(|x| *x *= by);
    }
}

/// Members, their effect, and the log density that they reach.
type Reached = (Vec<Member>, Vec<f64>, f64);

/// Members fitted beside the robot.
#[derive(Clone)]
pub(crate) struct Fitted {
    /// They at their most probable sizes.
    pub(crate) members: Vec<Member>,
    /// Evidence with the posterior of all sizes, form errors last.
    pub(crate) evidence: Evidence,
    /// Mean square of the share by which forms may be off.
    pub(crate) form_variance: f64,
    /// Log evidence and log priors of forms and windows.
    pub(crate) log: f64,
    /// Log evidence that something unlisted beside [`Fitted::columns`] is compared with: theirs at the first amplitude of the discrepancy,
    /// and what all amplitudes and form errors add to it.
    pub(crate) log_beside: f64,
    /// Change of what the test drives show by all members together, row by row.
    pub(crate) effect: Vec<f64>,
    /// Fitted predictions of the test drives less those of the baseline, row by row.
    pub(crate) change: Vec<f64>,
    /// The robot's parameters, as the independent numbers that their prior is made of, 0 at the file.
    pub(crate) u: DVector<f64>,
    /// Change of the test drives with each free size, per prior standard deviation, and the sizes, one member after the other.
    pub(crate) raw_columns: Vec<Vec<f64>>,
    /// See [`Fitted::raw_columns`].
    pub(crate) sizes: Vec<f64>,
    /// Columns of sizes and form errors, of at most one member, beside which something unlisted is tried; and the residual that goes with them.
    pub(crate) columns: Group,
    /// See [`Fitted::columns`].
    pub(crate) left: Group,
    /// Signs of the columns.
    pub(crate) halves: Vec<Half>,
}

impl<'a> Joint<'a> {
    /// Whitens a basis and the baseline's residual.
    pub(crate) fn new(
        observed: &'a Observations<'a>,
        (baseline, file): (&'a Baseline, &'a Robot),
        others: &[Vec<f64>],
        whitening: Whitening,
        temperature: f64,
        amplitudes: &Amplitudes,
    ) -> Self {
        let white = baseline.sensitivities.iter().chain(others).map(|column| whitening.apply(column));
        let basis = transposed(observed.rows(), baseline.sensitivities.len() + others.len(), white);
        let count = baseline.parameters.len();
        let parameters = basis.rows(0, count).into_owned();
        let gram = products(&parameters) * temperature + DMatrix::identity(count, count);
        let residual = DVector::from_vec(whitening.apply(&baseline.residual));
        let model = LinearModel::new(basis, observed.rows() as f64 / temperature, amplitudes);
        Joint { observed, baseline, file, whitening, model, residual, parameters_root: gram.cholesky() }
    }

    /// Columns of the test drives, whitened.
    pub(crate) fn whiten(&self, columns: &[Vec<f64>]) -> Vec<DVector<f64>> {
        let rows = self.observed.test_rows;
        columns.iter().map(|column| DVector::from_vec(self.whitening.apply(&column[..rows]))).collect()
    }

    /// Fits members from where they stand.
    ///
    /// # Errors
    /// A surface that the robot does not know; a watch that breaks.
    pub(crate) fn fit(&self, members: &[Member]) -> Result<Fitted, Error> {
        let mut members = members.to_vec();
        members.iter_mut().for_each(|member| {
            member.widen();
        });
        let mut effect = self.effect(&members)?;
        let mut objective = self.objective(&effect, &members);
        let mut columns = self.columns(&members, &effect)?;
        for _ in 0..STEPS {
            let sizes: Vec<f64> = members.iter().flat_map(Member::sizes).collect();
            let (group, left) = self.groups(&columns, &effect, &sizes, &[], |all| self.model.group(all));
            let mean = self.model.reduce(&[&group, &left]).evidence(&[]).mean;
            let step: Vec<f64> = mean.iter().zip(&sizes).map(|(to, from)| to - from).collect();
            let Some((next, next_effect, next_objective)) = self.stepped(&members, &step, objective)? else {
                break;
            };
            (members, effect) = (next, next_effect);
            widen(&mut members, &mut columns);
            let gained = next_objective - objective;
            objective = next_objective;
            if gained < SETTLED {
                break;
            }
            columns = self.columns(&members, &effect)?;
        }
        self.fitted(members, &effect, &columns)
    }

    /// Log evidence of members, one of them in other spans at the same time: its effect there is what it would be all the time, where it acts.
    ///
    /// # Errors
    /// A surface that the robot does not know; a watch that breaks.
    pub(crate) fn in_spans(
        &self,
        members: &[Member],
        which: usize,
        spans: &[Span],
    ) -> Result<Vec<f64>, Error> {
        let mut others = members.to_vec();
        others.remove(which);
        let without = self.effect(&others)?;
        let mut always = members.to_vec();
        always[which].span = Span::ALL;
        let effect = self.effect(&always)?;
        let columns = self.columns(&always, &effect)?;
        let first: usize = members[..which].iter().map(|member| member.free.len()).sum();
        let own = first..first + members[which].free.len();
        let sizes: Vec<f64> = members.iter().flat_map(Member::sizes).collect();
        let log = |span: &Span| {
            let acts = |i: usize| {
                let average = &self.observed.averages()[i];
                span.acts(average.run, average.t_s, average.input.position_m)
            };
            let masked = |values: &[f64], elsewhere: &dyn Fn(usize) -> f64| -> Vec<f64> {
                (0..values.len()).map(|i| if acts(i) { values[i] } else { elsewhere(i) }).collect()
            };
            let in_span = masked(&effect, &|i| without[i]);
            let columns: Vec<Vec<f64>> = columns
                .iter()
                .enumerate()
                .map(|(j, column)| if own.contains(&j) { masked(column, &|_| 0.0) } else { column.clone() })
                .collect();
            let (group, left) = self.groups(&columns, &in_span, &sizes, &[], |all| self.model.group(all));
            self.model.reduce(&[&group, &left]).evidence(&[]).log
        };
        Ok(spans.iter().map(log).collect())
    }

    /// The first share of a step that explains more.
    fn stepped(&self, members: &[Member], step: &[f64], objective: f64) -> Result<Option<Reached>, Error> {
        for share in SHARES {
            let mut next = members.to_vec();
            let mut first = 0;
            for member in &mut next {
                let own = &step[first..first + member.free.len()];
                first += member.free.len();
                let sizes: Vec<f64> = member.sizes().iter().zip(own).map(|(x, by)| x + share * by).collect();
                member.set(self.file, &sizes);
            }
            let effect = self.effect(&next)?;
            let reached = self.objective(&effect, &next);
            if reached > objective {
                return Ok(Some((next, effect, reached)));
            }
        }
        Ok(None)
    }

    /// Evidence about the point that was reached, form errors included.
    fn fitted(&self, members: Vec<Member>, effect: &[f64], columns: &[Vec<f64>]) -> Result<Fitted, Error> {
        let sizes: Vec<f64> = members.iter().flat_map(Member::sizes).collect();
        let forms = self.form_columns(&members, effect)?;
        let (group, left) = self.groups(columns, effect, &sizes, &forms, |all| self.model.group_at_all(all));
        let reduced = self.model.reduce(&[&group, &left]);
        let halves: Vec<Half> = members.iter().flat_map(|m| m.free.iter().map(|size| size.half)).collect();
        let FormErrors { evidence, likeliest, mean_square, .. } =
            FormErrors::new(&reduced, &halves, forms.len());
        let (group, left) = (self.model.at_first(&group), self.model.at_first(&left));
        let at_first = FormErrors::new(&reduced.first(left.halves.len()), &halves, forms.len());
        // What the first amplitude has of the evidence, of which the likeliest form error has its part.
        let log_beside = at_first.log_of_likeliest + evidence.log - at_first.evidence.log;
        let reduced = reduced.scaled(&form_factors(halves.len(), forms.len(), likeliest));
        let log = evidence.log + members.iter().map(Member::log_prior).sum::<f64>();
        let weights = self.model.basis_weights(&reduced, &self.less(effect));
        Ok(Fitted {
            log,
            change: self.change(effect, &weights),
            effect: effect.to_vec(),
            u: weights.rows(0, self.baseline.parameters.len()).into_owned(),
            raw_columns: columns.to_vec(),
            sizes,
            log_beside,
            columns: if members.len() <= 1 {
                group.scaled(&form_factors(halves.len(), forms.len(), at_first.likeliest))
            } else {
                Group { columns: DMatrix::zeros(0, 0), halves: Vec::new() }
            },
            left,
            halves,
            members,
            evidence,
            form_variance: mean_square,
        })
    }

    /// Fitted predictions of the test drives less the baseline's at the file's parameters.
    fn change(&self, effect: &[f64], weights: &DVector<f64>) -> Vec<f64> {
        let by_basis = self.by_basis(weights);
        effect.iter().zip(by_basis).map(|(effect, by)| effect + by).collect()
    }

    /// What the basis adds to predictions of the test drives at some weights.
    pub(crate) fn by_basis(&self, weights: &DVector<f64>) -> Vec<f64> {
        let rows = self.model.transposed().columns(0, self.observed.test_rows);
        self.whitening.undo(rows.tr_mul(weights).as_slice())
    }

    /// Change of what the test drives show, by all members together.
    fn effect(&self, members: &[Member]) -> Result<Vec<f64>, Error> {
        let applied: Vec<Applied> = members.iter().map(Member::applied).collect();
        let seen = self.observed.series.predict(&self.baseline.robot, &applied)?;
        let rows = self.observed.test_rows;
        Ok(seen[..rows].iter().zip(&self.baseline.predicted).map(|(a, b)| a - b).collect())
    }

    /// The whitened residual less an effect.
    fn less(&self, effect: &[f64]) -> DVector<f64> {
        let mut left = self.residual.clone();
        left.iter_mut().zip(self.whitening.apply(effect)).for_each(|(left, by)| *left -= by);
        left
    }

    /// Log density of the rows with an effect taken out, and of its sizes.
    fn objective(&self, effect: &[f64], members: &[Member]) -> f64 {
        let alone = self.model.group(DMatrix::from_columns(&[self.less(effect)]));
        let sizes: f64 = members.iter().map(Member::log_density).sum();
        self.model.reduce(&[&alone]).evidence(&[]).log + sizes
    }

    /// Change with each free size, per prior standard deviation, about where members stand.
    fn columns(&self, members: &[Member], effect: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
        let mut columns = Vec::new();
        for (m, member) in members.iter().enumerate() {
            for (j, size) in member.free.iter().enumerate() {
                let sizes = member.sizes();
                let by = DIFFERENCE * sizes[j].abs().max(1.0);
                // Away from a bound that is reached.
                let [low, high] = member.mechanism.bounds(self.file, size.parameter);
                let value = member.values[size.parameter] + size.unit * by;
                let by = if (low..=high).contains(&value) { by } else { -by };
                let mut moved = members.to_vec();
                moved[m].step(j, by);
                let seen = self.effect(&moved)?;
                columns.push(seen.iter().zip(effect).map(|(a, b)| (a - b) / by).collect());
            }
        }
        Ok(columns)
    }

    /// Columns of sizes and form errors, and the residual that is left at size zero of the linearised effect.
    fn groups(
        &self,
        columns: &[Vec<f64>],
        effect: &[f64],
        sizes: &[f64],
        forms: &[DVector<f64>],
        group: impl Fn(DMatrix<f64>) -> Group,
    ) -> (Group, Group) {
        let mut white = self.whiten(columns);
        let mut left = self.less(effect);
        for (column, x) in white.iter().zip(sizes) {
            left.rows_mut(0, column.len()).axpy(*x, column, 1.0);
        }
        white.extend(forms.iter().cloned());
        let rows = self.observed.test_rows;
        if left.len() == rows {
            white.push(left);
            return LinearModel::split_last(&group(matrix(rows, &white)));
        }
        (group(matrix(rows, &white)), group(DMatrix::from_columns(&[left])))
    }

    /// What the form of each member leaves open, off by its own size: its net effect times smooth functions.
    fn form_columns(&self, members: &[Member], effect: &[f64]) -> Result<Vec<DVector<f64>>, Error> {
        let regime = Features::<REGIME>::new(FORM_FUNCTIONS, FORM_LENGTHS);
        let time = Features::<1>::new(FORM_FUNCTIONS, [FORM_TIME_LENGTH]);
        let total_s = self.observed.total_s().max(1.0);
        let mut all = Vec::new();
        for m in 0..members.len() {
            let own: Vec<f64> = if members.len() == 1 {
                effect.to_vec()
            } else {
                let others: Vec<Member> = members
                    .iter()
                    .enumerate()
                    .filter(|(i, _)| *i != m)
                    .map(|(_, other)| other.clone())
                    .collect();
                let without = self.effect(&others)?;
                effect.iter().zip(&without).map(|(all, others)| all - others).collect()
            };
            let net = self.net_of_parameters(DVector::from_vec(self.whitening.apply(&own)));
            for k in 0..FORM_FUNCTIONS {
                let share = |i: usize| match members[m].mechanism.is_windowed() {
                    true => regime.at(k, &self.observed.regimes[i]),
                    // What remembers follows the time.
                    false => time.at(k, &[self.observed.driven_s[i] / total_s]),
                };
                all.push(DVector::from_fn(net.len(), |i, _| net[i] * share(i)));
            }
        }
        Ok(all)
    }

    /// A whitened effect of the test drives less what the robot's parameters can imitate of it.
    fn net_of_parameters(&self, effect: DVector<f64>) -> DVector<f64> {
        let Some(root) = &self.parameters_root else { return effect };
        let count = self.baseline.parameters.len();
        let head = self.model.transposed().view((0, 0), (count, effect.len()));
        let weights = root.solve(&(head * &effect));
        &effect - head.tr_mul(&weights)
    }
}
