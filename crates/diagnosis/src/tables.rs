//! What terms are made of, worked out once for all of them: scales and groups over the averages of each side.

use crate::{
    average::Average,
    baseline::Baseline,
    channel,
    group::GROUPS,
    nuisance::means,
    series::Series,
    term::{Scale, Term},
};

/// Scales and groups over the averages of one channel of power.
pub(crate) struct Table<'a> {
    averages: &'a [Average],
    fastest_mps: f64,
    /// Averages of the channel.
    pub(crate) places: Vec<usize>,
    /// By [`Scale`] \[W\].
    scales_w: Vec<Vec<f64>>,
    /// By place among [`GROUPS`].
    groups: Vec<Vec<f64>>,
    /// Mean size of what is predicted \[W\].
    mean_w: f64,
}

impl<'a> Table<'a> {
    /// One of each channel of power.
    pub(crate) fn of_sides(series: &'a Series, base: &Baseline) -> Vec<Table<'a>> {
        let driven = base.driven(series);
        let means_w = means(&series.averages, &base.predicted_w);
        let is_both = series.channels() == 1;
        let fastest_mps = base.robot.max_wheel_speed_mps;
        let of = |channel: usize| {
            let places = channel::places(&series.averages, channel);
            let scale = |scale: Scale| places.iter().map(|i| scale.value_w(&driven, *i, is_both)).collect();
            let scales_w = Scale::ALL.map(scale).into();
            let group = |value: fn(&Average, f64) -> f64| {
                places.iter().map(|i| value(&series.averages[*i], fastest_mps)).collect()
            };
            let groups = GROUPS.iter().map(|one| group(one.value)).collect();
            let mean_w = means_w[channel].max(1e-9);
            Table { averages: &series.averages, fastest_mps, places, scales_w, groups, mean_w }
        };
        (0..series.channels()).map(of).collect()
    }

    /// A term as if it acted on this side alone, in all drives, by average of the channel \[W\].
    pub(crate) fn everywhere(&self, term: &Term) -> Vec<f64> {
        let mut column = self.scales_w[term.scale as usize].clone();
        for group in &term.groups {
            let is_tabled = term.span.is_all() || !group.is_of_time();
            match group.place().filter(|_| is_tabled) {
                Some(place) => column.iter_mut().zip(&self.groups[place]).for_each(|(w, by)| *w *= by),
                None => {
                    let value =
                        |i: &usize| (group.value)(&self.averages[*i].since(term.span), self.fastest_mps);
                    column.iter_mut().zip(&self.places).for_each(|(w, i)| *w *= value(i));
                }
            }
        }
        self.keep(&mut column, |average| average.is_in(term.span));
        column
    }

    /// The same in the drives under suspicion.
    pub(crate) fn suspect(&self, term: &Term) -> Vec<f64> {
        let mut column = self.everywhere(term);
        self.keep(&mut column, |average| average.suspect);
        column
    }

    fn keep(&self, column: &mut [f64], is_kept: impl Fn(&Average) -> bool) {
        let cut = column.iter_mut().zip(&self.places).filter(|(_, i)| !is_kept(&self.averages[**i]));
        cut.for_each(|(w, _)| *w = 0.0);
    }

    /// Sum of a column's squares, as shares of mean power.
    pub(crate) fn squares(&self, column: &[f64]) -> f64 {
        column.iter().map(|w| (w / self.mean_w).powi(2)).sum()
    }
}
