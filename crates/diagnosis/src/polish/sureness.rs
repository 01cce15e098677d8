//! How sure the numbers of mechanisms are that were fitted together.

use model::Robot;
use nalgebra::DMatrix;

use super::{Polished, Together};
use crate::{
    Error, candidates,
    regime::Regime,
    search::openness,
    series::{Applied, Series},
    weigh::{Sizes, system_at},
    widths::half_width,
};

impl Together {
    /// The fit with the widths of what was fitted.
    pub(super) fn polished(mut self, series: &Series, file: &Robot) -> Result<Polished, Error> {
        self.base = self.base.about_itself(series, file, &self.applied)?;
        let openness = openness(series);
        let mut half_widths = Vec::new();
        for (which, one) in self.applied.iter().enumerate() {
            // Where regimes disagree about a size by more than chance, it is told no better than they agree (the scale factor of the
            // Particle Data Group, Rosenfeld, Annu. Rev. Nucl. Sci. 25, 1975, p. 555).
            let wider = self.discord(series, which)?.sqrt();
            let half = |(parameter, sigma): (usize, &Option<f64>)| {
                sigma.map(|sigma| half_width(one, parameter, wider * sigma, openness))
            };
            half_widths.push(self.sigmas(series, which)?.iter().enumerate().map(half).collect());
        }
        Ok(Polished { base: self.base, applied: self.applied, half_widths })
    }

    /// One sigma of each value of one, with those from a grid as free as the others where the drives tell them; `None` for those that
    /// were not fitted.
    fn sigmas(&self, series: &Series, which: usize) -> Result<Vec<Option<f64>>, Error> {
        let own = self.all_told(which);
        let mut free = self.free.clone();
        free[which] = own.clone();
        let freed = match own.len() > self.free[which].len() {
            true => Together {
                free,
                applied: self.applied.clone(),
                base: self.base.clone(),
                covariance: DMatrix::zeros(0, 0),
            }
            .weighed(series)?
            .map(|(_, covariance)| (own, covariance)),
            false => None,
        };
        let (own, covariance) = freed.unwrap_or_else(|| (self.free[which].clone(), self.covariance.clone()));
        let first: usize = self.free.iter().take(which).map(Vec::len).sum();
        let mut sigmas = vec![None; self.applied[which].values.len()];
        for (j, parameter) in own.into_iter().enumerate() {
            sigmas[parameter] =
                covariance.get((first + j, first + j)).map(|variance| variance.max(0.0).sqrt());
        }
        Ok(sigmas)
    }

    /// What is fitted of one, and its values from a grid unless all of those are nothing.
    fn all_told(&self, which: usize) -> Vec<usize> {
        let (from_grid, are_free) = (self.of_grid(which), self.has_grid(which));
        let is_free = |i: &usize| self.free[which].contains(i) || are_free && from_grid.contains(i);
        (0..self.applied[which].values.len()).filter(is_free).collect()
    }

    /// Whether one has values from a grid that are not all nothing.
    pub(super) fn has_grid(&self, which: usize) -> bool {
        self.of_grid(which).iter().any(|i| self.applied[which].values[*i] != 0.0)
    }

    /// Parameters of one whose values a grid has.
    fn of_grid(&self, which: usize) -> Vec<usize> {
        let Applied { mechanism, values, .. } = &self.applied[which];
        let sizes: Vec<usize> =
            candidates::grids(*mechanism).into_iter().flat_map(|(_, linear)| linear).collect();
        (0..values.len()).filter(|i| !sizes.contains(i)).collect()
    }

    /// How far the size of one scatters from regime to regime, over what chance makes of it, squared.
    fn discord(&self, series: &Series, which: usize) -> Result<f64, Error> {
        let white = self.base.whitening(series);
        let columns: Vec<Vec<f64>> =
            self.columns(series, which)?.iter().map(|column| white.of(column)).collect();
        let values: Vec<f64> = self.free[which].iter().map(|i| self.applied[which].values[*i]).collect();
        let system = system_at(series, &self.base, Sizes::FreeBut(which), &[]);
        let regime: Vec<usize> = series.averages.iter().map(Regime::on_slope).collect();
        let Some(evidence) = system.weigh(&columns) else { return Ok(1.0) };
        Ok(system.discord_on_slopes(&evidence, &values, &regime))
    }
}
