//! The engine from drives to the posterior.

use model::{
    Robot,
    knowledge::Provenance,
    mechanism::{Mechanism, Scale},
};
use nalgebra::DMatrix;

use crate::{
    Error,
    evidence::{
        linear_model::Amplitudes,
        noise::Whitening,
        width::{self, WIDTHS},
    },
    fit::{
        amplitude::Healthy,
        baseline::Baseline,
        held_out::{HeldOut, held_out},
        joint::Joint,
        parameter::IDLE_SIGMA_A,
        temperature,
    },
    hypothesis::{
        effect::{Beside, Effect, effects},
        unlisted::{self, Block},
        window::{Grid, Windows},
    },
    observe::{
        observations::Observations,
        reach::{Beyond, beyond},
    },
    search::{explanation::Explanation, refine::Search, screen::Screen},
};

/// Residuals beyond so many standard deviations count linearly: one second in 2000 by chance.
const LARGE: f64 = 3.5;
/// By how much wider the discrepancy is in the most flexible fit, from which weights are taken: with weights and scale of the base fit the
/// unlisted class wins everything, since what is missing counts as stray there.
const FLEXIBLE: f64 = 5.0;

/// What the engine found.
pub(crate) struct Found {
    /// Explanations, likeliest first.
    pub(crate) explanations: Vec<Explanation>,
    /// Amplitude of the discrepancy.
    pub(crate) model_error: f64,
    /// What the test drives do that those did not by which that is known.
    pub(crate) beyond: Vec<Beyond>,
    /// Standard deviation of ground from run to run, as a share of resistance.
    pub(crate) run_variation: f64,
    /// Divisor of log likelihoods.
    pub(crate) temperature: f64,
    /// Posterior covariance of the robot's parameters before any effect, as independent numbers.
    pub(crate) parameter_covariance: DMatrix<f64>,
    /// The robot before any effect.
    pub(crate) baseline: Baseline,
    /// Unlisted blocks.
    pub(crate) blocks: Vec<Block>,
    /// Held-out errors of power with nothing found, and with the likeliest explanation that names anything.
    pub(crate) held_out: [HeldOut; 2],
    /// Noise of power, root mean square over the test drives [W].
    pub(crate) noise_floor_w: f64,
    /// Sizes that would have been noticed.
    pub(crate) detectable: Vec<(Effect, f64)>,
}

/// Finds the posterior over what is missing in the test drives.
///
/// # Errors
/// A surface that the robot does not know; a watch that breaks.
pub(crate) fn find(
    observed: &Observations<'_>,
    (file, baseline): (&Robot, Baseline),
    library: &[&'static dyn Mechanism],
    windows: Windows,
    progress: &dyn Fn(&str, f64),
) -> Result<Found, Error> {
    let step = |name: &str, share: f64| {
        progress(name, share);
        observed.go_on()
    };
    let scale = scale(observed, &baseline, file);
    let beside = alone(observed, &baseline);
    step("making effects", 0.2)?;
    let effects = effects(library, &scale, &beside)?;
    let common = common(library, &scale, &beside)?;
    let mut shared: Vec<Vec<f64>> = common.iter().flat_map(|effect| effect.columns.clone()).collect();
    shared.extend(healthy_shares(&effects));
    step("learning what the model misses", 0.3)?;
    let plain = baseline.noise.whitening(&baseline.predicted, &observed.places);
    let mut run_variation = 0.0;
    let model_error = if observed.series.has_healthy() {
        let healthy = observed.test_rows..observed.rows();
        let of_runs;
        let healthy = Healthy { observed, baseline: &baseline, whitening: &plain, rows: healthy };
        (run_variation, of_runs) = healthy.run_variation(&shared);
        shared.extend(of_runs);
        healthy.model_error(&shared)
    } else {
        file.model_error_fraction()
    };
    // What a calibration found says nothing of drives that do what its own did not: there constants are fitted ones, and no more is known.
    let beyond = beyond_calibration(observed, file);
    let least = if beyond.is_empty() { 0.0 } else { Provenance::Fitted.model_error() };
    let model_error = model_error.max(least);
    let mut others = baseline.discrepancy(observed, model_error);
    let first = baseline.sensitivities.len();
    let discrepancy = first..first + others.len();
    others.extend(shared);
    let weighted = weighted(observed, (&baseline, file), &others, &plain);
    let temperature = if observed.series.has_healthy() {
        let basis: Vec<&Vec<f64>> = baseline.sensitivities.iter().chain(&others).collect();
        let healthy = observed.test_rows..observed.rows();
        let shares = healthy_shares(&common);
        let columns = temperature::columns((&weighted, healthy), &basis, &shares, &baseline.residual);
        temperature::temperature(observed, &columns)
    } else {
        temperature::UNTOLD
    };
    let whitening = weighted.scaled(|_| 1.0 / temperature.sqrt());
    let each = amplitudes(observed);
    let amplitudes = Amplitudes { columns: discrepancy, each: &each };
    let joint = Joint::new(observed, (&baseline, file), &others, whitening, temperature, &amplitudes);
    drop(others);
    step("screening mechanisms", 0.4)?;
    let grid = Grid::new(observed, windows);
    let screen = Screen::new(&joint, &grid, effects);
    let blocks = unlisted::blocks(&joint);
    step("refitting the leading sets", 0.5)?;
    let search = Search { joint: &joint, screen: &screen, grid: &grid, blocks: &blocks, missed: model_error };
    let explanations = search.posterior()?;
    step("holding stretches out", 0.9)?;
    let held_out = held_outs(&joint, &explanations);
    let detectable = screen.information().into_iter().map(|(effect, g)| (effect.clone(), g)).collect();
    let noise_floor_w = noise_floor_w(observed, &baseline);
    let parameter_covariance = joint.model.covariance_of_first(baseline.parameters.len());
    Ok(Found {
        explanations,
        model_error,
        beyond,
        run_variation,
        temperature,
        parameter_covariance,
        held_out,
        noise_floor_w,
        detectable,
        blocks,
        baseline,
    })
}

/// What the test drives do that those of a calibration did not; healthy drives beside them are rows of the same model.
fn beyond_calibration(observed: &Observations<'_>, file: &Robot) -> Vec<Beyond> {
    let known = file.model_error.as_ref().filter(|_| !observed.series.has_healthy());
    known.map_or_else(Vec::new, |known| beyond(&known.regimes, &observed.covered(0..observed.test_rows)))
}

/// Amplitudes of the discrepancy that are summed over, with their log priors: with healthy drives that which these show.
fn amplitudes(observed: &Observations<'_>) -> Vec<(f64, f64)> {
    if observed.series.has_healthy() {
        return vec![(1.0, 0.0)];
    }
    WIDTHS.into_iter().zip(width::log_priors()).collect()
}

/// Held-out errors of nothing and of the likeliest explanation that names anything.
fn held_outs(joint: &Joint<'_>, explanations: &[Explanation]) -> [HeldOut; 2] {
    let fit = |is_own: &(dyn Fn(&Explanation) -> bool + Sync)| {
        let found = explanations.iter().find(|one| is_own(one))?;
        Some(held_out(joint, found.fitted.as_ref()?))
    };
    let (nothing, named) =
        rayon::join(|| fit(&|one| one.names.is_empty()), || fit(&|one| !one.names.is_empty()));
    let nothing = nothing.unwrap_or_default();
    [nothing, named.unwrap_or(nothing)]
}

/// Noise of the power of the test drives, root mean square [W].
pub(crate) fn noise_floor_w(observed: &Observations<'_>, baseline: &Baseline) -> f64 {
    let sigma = |i: usize| baseline.noise.sigma(observed.averages()[i].channel, baseline.predicted[i]);
    observed.power_rms(&(0..observed.test_rows).map(sigma).collect::<Vec<_>>())
}

/// Figures that prior sizes are measured in.
pub(crate) fn scale<'r>(observed: &Observations<'_>, baseline: &Baseline, file: &'r Robot) -> Scale<'r> {
    let mut sums = [0.0; 2];
    for i in (0..observed.test_rows).filter(|i| observed.is_power(*i)) {
        sums = [sums[0] + baseline.predicted[i].abs(), sums[1] + 1.0];
    }
    let channels = observed.series.channels() as f64;
    let mean_power_w = channels * sums[0] / f64::max(sums[1], 1.0);
    // Of what a side draws about a fifth heats its windings on level ground (Dogru & Marques 2018, Table II: k1 F² of k1 F² + k2 F u).
    let mean_loss_w = 0.2 * mean_power_w / 2.0;
    // Of currents the zero of a sensor, else 15 % of mean power, half of it on each side's meter.
    let meter_zero_w = match observed.series.watts_per_a() {
        Some(per_a) => IDLE_SIGMA_A * per_a.sum() / 2.0,
        None => 0.075 * mean_power_w,
    };
    Scale { robot: file, meter_zero_w, mean_power_w, mean_loss_w }
}

/// With healthy drives, every mechanism's sizes that all drives share: what the file lacks of this robot.
fn common(
    library: &[&'static dyn Mechanism],
    scale: &Scale<'_>,
    beside: &Beside<'_>,
) -> Result<Vec<Effect>, Error> {
    if !beside.series.has_healthy() {
        return Ok(Vec::new());
    }
    let mut effects = effects(library, scale, &Beside { everywhere: true, ..*beside })?;
    // Of the same columns the wider ones would say nothing new.
    effects.retain(|effect| effect.widening <= 1.0);
    Ok(effects)
}

/// Columns of what healthy robots and good logs have of mechanisms: in all drives without healthy ones, in the test drives beside them.
fn healthy_shares(effects: &[Effect]) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for (i, effect) in effects.iter().enumerate() {
        let (name, share) = (effect.mechanism.name(), effect.mechanism.healthy_share());
        if share <= 0.0 {
            continue;
        }
        for (j, size) in effect.free.iter().enumerate() {
            let is_known = |other: &Effect| {
                other.mechanism.name() == name && other.free.iter().any(|s| s.parameter == size.parameter)
            };
            if !effects[..i].iter().any(is_known) {
                columns.push(effect.columns[j].iter().map(|by| share * by).collect());
            }
        }
    }
    columns
}

/// Effects in the test drives with nothing else acting.
pub(crate) fn alone<'a>(observed: &Observations<'a>, baseline: &'a Baseline) -> Beside<'a> {
    Beside {
        series: observed.series,
        robot: &baseline.robot,
        applied: &[],
        predicted: &baseline.predicted,
        everywhere: false,
    }
}

/// Columns of what healthy robots and good logs have of mechanisms, in drives that stand alone.
pub(crate) fn healthy_columns(
    observed: &Observations<'_>,
    baseline: &Baseline,
    file: &Robot,
    library: &[&'static dyn Mechanism],
) -> Result<Vec<Vec<f64>>, Error> {
    let beside = alone(observed, baseline);
    let shared: Vec<_> = library.iter().copied().filter(|one| one.healthy_share() > 0.0).collect();
    Ok(healthy_shares(&effects(&shared, &scale(observed, baseline, file), &beside)?))
}

/// Whitening with weights from what the most flexible fit leaves.
fn weighted(
    observed: &Observations<'_>,
    (baseline, file): (&Baseline, &Robot),
    others: &[Vec<f64>],
    plain: &Whitening,
) -> Whitening {
    let wide: Vec<Vec<f64>> =
        others.iter().map(|column| column.iter().map(|x| FLEXIBLE * x).collect()).collect();
    let joint = Joint::new(observed, (baseline, file), &wide, plain.clone(), 1.0, &Amplitudes::AS_THEY_ARE);
    let left = unlisted::left_by_all(&joint);
    let weight = |i: usize| (LARGE / left[i].abs().max(LARGE)).sqrt();
    plain.scaled(weight)
}
