//! How much of what is left of the errors smooth functions of the inputs explain: none, where nothing is missing.

use crate::{
    average::Average,
    baseline::Baseline,
    linear::{FOLDS, Folded},
    series::Series,
    span::Span,
    weigh::blocks,
};

/// Errors beyond count as this many sigma: a few outliers explain nothing.
const MOST_SIGMAS: f64 = 5.0;
/// Weights of "nothing" on each share, in rows, of which the best is taken; fewer overfit a drive of twenty minutes.
const RIDGES: [f64; 3] = [300.0, 1000.0, 3000.0];

/// Share of the squared errors of the drives under suspicion that functions of the inputs explain where they were not
/// fitted; beside healthy drives, what a fit to those alone explains of the suspect ones does not count.
///
/// Errors count in sigma, but what a second tells of the next stays in: taking it out hides whatever lasts for a manoeuvre.
pub(crate) fn explained_share(series: &Series, base: &Baseline, errors_w: &[f64]) -> f64 {
    let sigma = |i: usize| base.noise.sigma(&series.averages[i], base.predicted_w[i]);
    let sigmas = (0..errors_w.len()).map(|i| errors_w[i] / sigma(i));
    let errors: Vec<f64> = sigmas.map(|z| z.clamp(-MOST_SIGMAS, MOST_SIGMAS)).collect();
    // Neighbouring blocks are judged by each other's fits, so that time itself may be followed.
    let fold: Vec<usize> = blocks(series).iter().map(|block| block % FOLDS).collect();
    let smooth = smooth(series, base);
    let of = |suspect: bool, column: &Vec<f64>| {
        let own = column.iter().zip(&series.averages);
        own.map(|(x, a)| if a.suspect == suspect { *x } else { 0.0 }).collect::<Vec<f64>>()
    };
    let mut columns: Vec<Vec<f64>> = smooth.iter().map(|column| of(true, column)).collect();
    let whole = squared(series, &errors, None);
    let mut shared = whole;
    if series.has_healthy() {
        let healthy: Vec<Vec<f64>> = smooth.iter().map(|column| of(false, column)).collect();
        let told = Folded::new(&healthy, &of(false, &errors), &fold, &series.averages);
        shared = unexplained(series, &errors, &told, &smooth).min(whole);
        columns.extend(smooth);
    }
    let left =
        unexplained(series, &errors, &Folded::new(&columns, &errors, &fold, &series.averages), &columns);
    ((shared - left) / whole.max(1e-300)).max(0.0)
}

/// Squared errors that remain of what a fit, at its best ridge, says of columns.
fn unexplained(series: &Series, errors: &[f64], fit: &Folded<'_>, columns: &[Vec<f64>]) -> f64 {
    let nothing = vec![0.0; columns.len()];
    let rest = |ridge: &f64| {
        let explained = fit.held_out(columns, &vec![*ridge; columns.len()], &nothing);
        squared(series, errors, Some(&explained))
    };
    RIDGES.iter().map(rest).fold(f64::INFINITY, f64::min)
}

fn squared(series: &Series, errors: &[f64], explained: Option<&[f64]>) -> f64 {
    let rest = |i: usize| errors[i] - explained.map_or(0.0, |explained| explained[i]);
    let counts = |i: &usize| series.averages[*i].suspect && series.is_power(*i);
    (0..errors.len()).filter(counts).map(|i| rest(i).powi(2)).sum()
}

/// Inputs, their squares and products, each channel's own, in sigma and of mean square 1.
fn smooth(series: &Series, base: &Baseline) -> Vec<Vec<f64>> {
    let longest_s = series.longest_s().max(1.0);
    let mut inputs: Vec<Vec<f64>> = standardised(&series.averages, longest_s);
    let line = series.timeline();
    if line.drives() > 1 {
        // Healthy drives have no place among those under suspicion: half of the way.
        let driven_s = |a: &Average| {
            let span = Span::From { run: a.run, t_s: a.t_s };
            if a.suspect { line.driven_s(span) } else { 0.5 * line.total_s() }
        };
        inputs.extend(spread(&series.averages, &driven_s));
    }
    let mut products: Vec<Vec<f64>> = inputs.clone();
    for (i, a) in inputs.iter().enumerate() {
        for b in &inputs[i..] {
            products.push(a.iter().zip(b).map(|(a, b)| a * b).collect());
        }
    }
    products.push(vec![1.0; series.averages.len()]);
    let mut columns = Vec::new();
    for channel in 0..series.channels() {
        for product in &products {
            let own = product.iter().zip(&series.averages);
            let own = own.zip(&base.predicted_w);
            let value = |((x, a), p): ((&f64, &Average), &f64)| {
                if a.channel == channel { x / base.noise.sigma(a, *p) } else { 0.0 }
            };
            let column: Vec<f64> = own.map(value).collect();
            let size = (column.iter().map(|x| x * x).sum::<f64>() / column.len().max(1) as f64).sqrt();
            if size > 1e-9 {
                columns.push(column.iter().map(|x| x / size).collect());
            }
        }
    }
    columns
}

/// Each input less its mean, over its spread.
fn standardised(averages: &[Average], longest_s: f64) -> Vec<Vec<f64>> {
    let of: [&dyn Fn(&Average) -> f64; 10] = [
        &|a| a.input.speed_mps,
        &|a| a.input.speed_mps.abs(),
        &|a| a.input.difference_mps,
        &|a| a.input.difference_mps.abs(),
        &|a| a.input.pitch_rad,
        &|a| a.input.roll_rad,
        &|a| a.input.accel_mps2,
        &|a| a.t_s / longest_s,
        &|a| if a.input.heading_rad.is_finite() { a.input.heading_rad.cos() } else { 0.0 },
        &|a| if a.input.heading_rad.is_finite() { a.input.heading_rad.sin() } else { 0.0 },
    ];
    of.into_iter().filter_map(|of| spread(averages, of)).collect()
}

/// An input less its mean, over its spread; `None` where it does not change.
fn spread(averages: &[Average], of: &dyn Fn(&Average) -> f64) -> Option<Vec<f64>> {
    let values: Vec<f64> = averages.iter().map(of).collect();
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
    // Rare extremes would rule the products.
    (spread > 1e-6).then(|| values.iter().map(|x| ((x - mean) / spread).clamp(-3.0, 3.0)).collect())
}
