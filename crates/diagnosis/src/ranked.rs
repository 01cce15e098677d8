//! Terms in the order of what they explain.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::{
    average::Quantity,
    baseline::Baseline,
    everywhere,
    evidence::{Sided, Sides, System},
    noise::Whitening,
    null::Null,
    series::Series,
    tables::Table,
    term::{Scale, Term},
};

/// Terms with the squared errors that each takes beside everything else that is fitted, over their variance, with one discount for all,
/// less what its choices cost; the most first.
///
/// Columns are made for some at a time: all at once would take gigabytes of long drives.
pub(crate) fn ranked<'t>(
    series: &Series,
    base: &Baseline,
    (system, null): (&System, &Null),
    terms: &[&'t Term],
) -> Vec<(f64, &'t Term)> {
    let (common, choice) = (null.common_discount(system.blocks()), (system.blocks() as f64).ln());
    let rank =
        |(explained, term): (f64, &'t Term)| (explained / common - term.choices() as f64 * choice, term);
    let mut ranked: Vec<(f64, &Term)> =
        explained(series, base, system, terms).into_iter().map(rank).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked
}

/// Terms that are the same but for the side on which they act.
type Alike<'a, 't> = &'a [&'t Term];

/// Terms that models may miss the same of, if anything.
struct Family<'a, 't> {
    beside: Option<Term>,
    terms: Vec<Alike<'a, 't>>,
}

/// Terms with the squared errors that each takes beside everything else that is fitted.
fn explained<'t>(
    series: &Series,
    base: &Baseline,
    system: &System,
    terms: &[&'t Term],
) -> Vec<(f64, &'t Term)> {
    let tables = Table::of_sides(series, base);
    let sides = system.sides(tables.iter().map(|table| &table.places[..]));
    let count = series.averages.iter().filter(|a| a.quantity() == Quantity::Power).count();
    let all = Tabled { tables: &tables, white: base.whitening(series), sides, count };
    let together = together(families(terms, series.has_healthy()), system.together());
    together.par_iter().flat_map_iter(|families| all.explained(families)).collect()
}

/// Terms by what models may miss of them: how those go with driving that always act, where healthy drives show that.
fn families<'a, 't>(terms: &'a [&'t Term], has_healthy: bool) -> Vec<Family<'a, 't>> {
    let mut by_driving: BTreeMap<(Scale, Vec<Option<usize>>), Vec<Alike<'a, 't>>> = BTreeMap::new();
    let mut families = Vec::new();
    for alike in terms.chunk_by(|a, b| a.is_but_for_sides(b)) {
        if has_healthy && alike[0].span.is_all() {
            let places = alike[0].of_driving().groups.iter().map(|group| group.place()).collect();
            by_driving.entry((alike[0].scale, places)).or_default().push(alike);
        } else {
            families.push(Family { beside: None, terms: vec![alike] });
        }
    }
    let with_driving =
        by_driving.into_values().map(|terms| Family { beside: Some(terms[0][0].of_driving()), terms });
    families.extend(with_driving);
    families
}

/// Families of so many columns together.
fn together<'a, 't>(families: Vec<Family<'a, 't>>, most: usize) -> Vec<Vec<Family<'a, 't>>> {
    let mut all: Vec<Vec<Family<'a, 't>>> = Vec::new();
    let mut columns = 0;
    for family in families {
        let more = family.columns().count();
        match all.last_mut() {
            Some(last) if columns < most => last.push(family),
            _ => {
                all.push(vec![family]);
                columns = 0;
            }
        }
        columns += more;
    }
    all
}

impl Family<'_, '_> {
    /// One of each of its terms, and at last what models may miss of them.
    fn columns(&self) -> impl Iterator<Item = (&Term, Acts)> {
        let beside = self.beside.iter().map(|term| (term, Acts::Everywhere));
        self.terms.iter().map(|alike| (alike[0], Acts::InSuspect)).chain(beside)
    }
}

/// In which drives a column is that of its term.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Acts {
    InSuspect,
    Everywhere,
}

/// What terms are weighed on.
struct Tabled<'a> {
    tables: &'a [Table<'a>],
    white: Whitening,
    sides: Sides<'a>,
    /// Number of averages of power.
    count: usize,
}

impl Tabled<'_> {
    /// Terms of some families with what each explains.
    fn explained<'t>(&self, families: &[Family<'_, 't>]) -> Vec<(f64, &'t Term)> {
        let columns: Vec<(&Term, Acts)> = families.iter().flat_map(Family::columns).collect();
        let (whitened, squares): (Vec<_>, Vec<_>) =
            self.tables.iter().map(|table| self.whitened(table, &columns)).unzip();
        let products = self.sides.products(whitened);
        let mut explained = Vec::new();
        let mut first = 0;
        for family in families {
            let beside = first + family.terms.len();
            for (column, alike) in (first..).zip(&family.terms) {
                for term in *alike {
                    let signs: Vec<f64> = (0..self.tables.len()).map(|side| term.on.sign(side)).collect();
                    let sided = |column: usize, by: f64| Sided { column, signs: &signs, by };
                    let by = family.beside.as_ref().and_then(|_| {
                        let of = |(squares, sign): (&Vec<f64>, &f64)| sign * sign * squares[beside];
                        everywhere::scale(squares.iter().zip(&signs).map(of).sum(), self.count)
                    });
                    let beside = by.map(|by| sided(beside, by));
                    explained.push((products.explained(sided(column, 1.0), beside), *term));
                }
            }
            first += family.columns().count();
        }
        explained
    }

    /// Columns of one side, whitened, and the sums of their squares as shares of mean power.
    fn whitened(&self, table: &Table<'_>, columns: &[(&Term, Acts)]) -> (DMatrix<f64>, Vec<f64>) {
        let mut whitened = DMatrix::zeros(table.places.len(), columns.len());
        let mut squares = Vec::with_capacity(columns.len());
        for (mut to, (term, acts)) in whitened.column_iter_mut().zip(columns) {
            let column = if *acts == Acts::Everywhere { table.everywhere(term) } else { table.suspect(term) };
            squares.push(table.squares(&column));
            to.copy_from_slice(&self.white.of_channel(&table.places, &column));
        }
        (whitened, squares)
    }
}

#[cfg(test)]
mod tests {
    use model::mechanism;

    use super::*;
    use crate::{
        hills::drive,
        series::Applied,
        span::Span,
        term,
        weigh::{system, system_with},
    };

    /// Checks what each term explains against columns over all averages, made one by one.
    fn agrees(series: &Series, base: &Baseline, system: &System, from: Span) {
        let terms = term::of_drives(series, &base.robot, std::iter::once(from));
        let terms: Vec<&Term> = terms.iter().collect();
        let white = base.whitening(series);
        let explained = explained(series, base, system, &terms);
        assert_eq!(explained.len(), terms.len());
        // Every seventh is enough, and every kind is among them.
        for (explained, term) in explained.into_iter().step_by(7) {
            let pair = everywhere::of_term(series, base, term).map(|column| white.of(&column));
            let one_by_one = system.weigh_beyond(&[pair])[0].as_ref().map_or(0.0, |one| one.explained);
            assert!(
                (explained - one_by_one).abs() <= 1e-6 * (1.0 + one_by_one),
                "{} {:?}: {explained} {one_by_one}",
                term.equation(),
                term.span
            );
        }
    }

    #[test]
    fn what_sides_explain_together_is_what_columns_over_both_do() {
        let robot = model::builtin::husky_a200();
        let payload = mechanism::by_name("payload").unwrap();
        let load = Applied { mechanism: payload, values: vec![10.0], span: Span::ALL };
        let [suspect, healthy] = [(0.0, &[load][..]), (1.0, &[])].map(|(at, with)| {
            // The first second began before the drive did.
            let mut drive = drive(&robot, at, with);
            drive.t_s.iter_mut().for_each(|t_s| *t_s += 0.1);
            drive
        });
        let from = Span::From { run: 0, t_s: 200.0 };
        for healthy in [Some(&healthy), None] {
            let series = Series::new(&robot, &suspect, healthy).unwrap();
            let base = Baseline::fit(&series, &robot, &[]).unwrap();
            agrees(&series, &base, &system(&series, &base), from);
            let taken = [base.predicted_w.clone()];
            agrees(&series, &base, &system_with(&series, &base, &taken), from);
        }
    }

    #[test]
    fn what_one_meter_for_both_sides_explains_is_what_its_column_does() {
        let robot = model::builtin::husky_a200();
        let whole = |phase_rad: f64| {
            let mut drive = drive(&robot, phase_rad, &[]);
            let [left, right] = [recording::Channel::LeftPower, recording::Channel::RightPower]
                .map(|channel| drive.channels.remove(&channel).unwrap());
            let sum = left.iter().zip(&right).map(|(left, right)| left + right).collect();
            drive.channels.insert(recording::Channel::Power, sum);
            drive
        };
        let [suspect, healthy] = [0.0, 1.0].map(whole);
        let series = Series::new(&robot, &suspect, Some(&healthy)).unwrap();
        let base = Baseline::fit(&series, &robot, &[]).unwrap();
        agrees(&series, &base, &system(&series, &base), Span::From { run: 0, t_s: 100.0 });
    }
}
