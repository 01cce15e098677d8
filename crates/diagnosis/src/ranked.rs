//! Terms in the order of what they explain.

use rayon::prelude::*;

use crate::{
    baseline::Baseline,
    everywhere,
    evidence::{System, TOGETHER},
    null::Null,
    series::Series,
    term::Term,
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
    let white = base.whitening(series);
    let (common, choice) = (null.common_discount(system.blocks()), (system.blocks() as f64).ln());
    let pair = |term: &Term| everywhere::of_term(series, base, term).map(|column| white.of(&column));
    let of_some = terms.par_chunks(TOGETHER).flat_map_iter(|some| {
        let pairs: Vec<[Vec<f64>; 2]> = some.iter().map(|term| pair(term)).collect();
        let explained = system.explained_beyond(&pairs).into_iter().zip(some);
        explained
            .map(|(explained, term)| (explained / common - term.choices() as f64 * choice, *term))
            .collect::<Vec<_>>()
    });
    let mut ranked: Vec<(f64, &Term)> = of_some.collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked
}
