//! Everything that is fitted whatever the candidate.

use crate::{
    average::Average,
    baseline::{Baseline, differences},
    discrepancy::Ground,
    evidence::{Fitted, System},
    regime::Regime,
    series::Series,
};

/// Length of a block [s]: longer than a manoeuvre, so that errors of different blocks hardly hang together.
pub(crate) const BLOCK_S: f64 = 20.0;

/// What of mechanisms that act is fitted whatever the candidate. What is found later may take over a part of what was found first, so
/// that nothing is ranked on what a frozen size left.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sizes {
    /// All sizes, and what forms leave open: what goes with either is no second thing.
    Open,
    /// All sizes.
    Free,
    /// All sizes but those of one mechanism, by its number.
    FreeBut(usize),
    /// None.
    Fixed,
}

/// Everything that is fitted whatever the candidate.
pub(crate) fn system(series: &Series, base: &Baseline) -> System {
    system_by(series, (base, Sizes::Open), base, true, (&[], Ground::Even))
}

/// The same with less of mechanisms that act fitted, beside columns that are.
pub(crate) fn system_at(series: &Series, base: &Baseline, sizes: Sizes, beside: &[Vec<f64>]) -> System {
    system_by(series, (base, sizes), base, true, (beside, Ground::Even))
}

/// The same for what acts in a place only, on ground that is as uneven as healthy drives show it.
pub(crate) fn system_in_place(series: &Series, base: &Baseline, beside: &[Vec<f64>]) -> System {
    system_by(series, (base, Sizes::Open), base, true, (beside, Ground::Uneven))
}

/// Whitened errors that nothing takes, average by average.
pub(crate) fn left(series: &Series, base: &Baseline) -> Vec<f64> {
    system(series, base).left().iter().take(series.recorded.len()).copied().collect()
}

/// The same beside columns that are fitted too.
pub(crate) fn system_with(series: &Series, base: &Baseline, beside: &[Vec<f64>]) -> System {
    system_at(series, base, Sizes::Open, beside)
}

/// The same for the candidate that is a delay itself.
pub(crate) fn undelayed(series: &Series, base: &Baseline) -> System {
    system_by(series, (base, Sizes::Open), base, false, (&[], Ground::Even))
}

/// Everything that is fitted whatever the candidate, of a fit by the noise of another, so that fits can be compared.
pub(crate) fn system_of(series: &Series, fit: &Baseline, sizes: Sizes, by: &Baseline) -> System {
    system_by(series, (fit, sizes), by, true, (&[], Ground::Even))
}

fn system_by(
    series: &Series,
    (base, sizes): (&Baseline, Sizes),
    by: &Baseline,
    delayed: bool,
    (beside, ground): (&[Vec<f64>], Ground),
) -> System {
    let white = by.whitening(series);
    let about = &base.sensitivities;
    let mut columns: Vec<Vec<f64>> = about.columns.iter().map(|c| white.of(c)).collect();
    let mut offset: Vec<f64> = base.moved.iter().map(|m| -m).collect();
    if series.has_healthy() {
        columns.push(white.of(&about.delays[1]));
    }
    if delayed {
        columns.push(white.of(&about.delays[0]));
    }
    let everywhere = series.told().everywhere.get().into_iter().flatten();
    columns.extend(about.sags.iter().chain(&about.tilts).chain(everywhere).map(|c| white.of(c)));
    if sizes == Sizes::Open {
        columns.extend(about.forms.iter().map(|c| white.of(c)));
    }
    let mut known = vec![1.0; columns.len()];
    // Of sizes and of what stands beside nothing is known before.
    let is_free = |which: usize| match sizes {
        Sizes::Open | Sizes::Free => true,
        Sizes::FreeBut(one) => which != one,
        Sizes::Fixed => false,
    };
    let free = (0..about.sizes.len()).filter(|which| is_free(*which)).flat_map(|which| &about.sizes[which]);
    columns.extend(free.chain(beside).map(|c| white.of(c)));
    known.resize(columns.len(), 0.0);
    offset.resize(columns.len(), 0.0);
    let errors = white.of(&differences(&series.recorded, &base.predicted_w));
    let regimes = series.averages.iter().map(|average| Regime::of(average) as usize).collect();
    let fitted =
        Fitted { columns: &columns, known: &known, offset: &offset, shared: &by.missed(series, ground) };
    System::new(errors, &fitted, (blocks(series), regimes))
}

/// Blocks of neighbouring averages of a drive; channels of the same time share one.
pub(crate) fn blocks(series: &Series) -> Vec<usize> {
    let key = |a: &Average| (a.run, (a.t_s / BLOCK_S) as usize);
    let names: Vec<(usize, usize)> = series.averages.iter().map(key).collect();
    let mut distinct = names.clone();
    distinct.sort_unstable();
    distinct.dedup();
    names.iter().map(|name| distinct.partition_point(|d| d < name)).collect()
}
