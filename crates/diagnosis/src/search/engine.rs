//! The engine from drives to the posterior.

use model::{
    Robot,
    mechanism::{Mechanism, Scale},
};
use nalgebra::DMatrix;

use crate::{
    Error,
    evidence::{linear_model::Amplitudes, noise::Whitening},
    fit::{
        baseline::Baseline,
        discrepancy::Shares,
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
    observe::{observations::Observations, reach::Beyond},
    search::{
        basis::{Basis, shared, shares},
        explanation::{Explanation, merge},
        refine::Search,
        screen::Screen,
    },
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
    /// Amplitudes of the discrepancy.
    pub(crate) missed: Shares,
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

/// The linear model about a robot: what is missing beside it, and what the model misses anyway.
struct About {
    baseline: Baseline,
    effects: Vec<Effect>,
    basis: Basis,
    /// Columns of what healthy drives have of mechanisms.
    common: Vec<Effect>,
}

/// Finds the posterior over what is missing in the test drives, about one robot or two.
///
/// An explanation is judged well where the linear model is near it. Where it is told about two robots, the likelier of its evidences counts,
/// and the answer is that of the robot about which the likeliest explanation of all is found. Both are judged by the same noise.
///
/// # Errors
/// A surface that the robot does not know; a watch that breaks.
pub(crate) fn find_about(
    observed: &Observations<'_>,
    (file, baseline, other): (&Robot, Baseline, Option<Baseline>),
    library: &[&'static dyn Mechanism],
    windows: Windows,
    progress: &dyn Fn(&str, f64),
) -> Result<Found, Error> {
    progress("making effects", 0.2);
    let about = |baseline| About::new(observed, (file, baseline), library);
    let (one, other) = (about(baseline)?, other.map(about).transpose()?);
    progress("learning what the model misses", 0.3);
    observed.go_on()?;
    let (whitening, strays) = one.weighted(observed, file);
    let Some(other) = other else {
        let part = |name: &str, share: f64| progress(name, 0.4 + 0.6 * share);
        return one.find(observed, file, &whitening, windows, &part);
    };
    // About the robot that the drives lie nearer to, fewer rows are strays.
    let of_other = other.weighted(observed, file);
    let whitening = if of_other.1 < strays { of_other.0 } else { whitening };
    let part = |from: f64| move |name: &str, share: f64| progress(name, from + 0.3 * share);
    let found = one.find(observed, file, &whitening, windows, &part(0.4))?;
    Ok(likelier(found, other.find(observed, file, &whitening, windows, &part(0.7))?))
}

/// What was found about the robot beside which the likeliest explanation lies, each explanation with the better of its evidences.
fn likelier(one: Found, other: Found) -> Found {
    let best = |found: &Found| found.explanations.first().map_or(f64::NEG_INFINITY, |one| one.log);
    let (mut found, other) = if best(&other) > best(&one) { (other, one) } else { (one, other) };
    merge(&mut found.explanations, other.explanations);
    found
}

impl About {
    fn new(
        observed: &Observations<'_>,
        (file, baseline): (&Robot, Baseline),
        library: &[&'static dyn Mechanism],
    ) -> Result<About, Error> {
        observed.go_on()?;
        let scale = scale(observed, &baseline, file);
        let beside = alone(observed, &baseline);
        let effects = effects(library, &scale, &beside)?;
        let common = common(library, &scale, &beside)?;
        let plain = baseline.noise.whitening(&baseline.predicted, &observed.places);
        let shared = shared(observed, &scale, &effects, &common);
        let basis = Basis::new(observed, (&baseline, file), &plain, shared);
        Ok(About { baseline, effects, basis, common })
    }

    /// Whitening with weights from what the most flexible fit leaves, and how many rows are strays, as a share of each.
    fn weighted(&self, observed: &Observations<'_>, file: &Robot) -> (Whitening, f64) {
        let baseline = &self.baseline;
        let plain = baseline.noise.whitening(&baseline.predicted, &observed.places);
        let wide = |column: &Vec<f64>| column.iter().map(|x| FLEXIBLE * x).collect();
        let wide: Vec<Vec<f64>> = self.basis.columns.iter().map(wide).collect();
        let amplitudes = Amplitudes::as_they_are();
        let joint = Joint::new(observed, (baseline, file), &wide, plain.clone(), 1.0, &amplitudes);
        let left = unlisted::left_by_all(&joint);
        let weight = |i: usize| (LARGE / left[i].abs().max(LARGE)).sqrt();
        let strays = (0..left.len()).map(|i| 1.0 - weight(i).powi(2)).sum();
        (plain.scaled(weight), strays)
    }

    /// Divisor of log likelihoods.
    fn temperature(&self, observed: &Observations<'_>, weighted: &Whitening) -> f64 {
        if !observed.series.has_healthy() {
            return temperature::UNTOLD;
        }
        let baseline = &self.baseline;
        let basis: Vec<&Vec<f64>> = baseline.sensitivities.iter().chain(&self.basis.columns).collect();
        let healthy = observed.test_rows..observed.rows();
        let shares = shares(&self.common, |one| one.healthy_share());
        let columns = temperature::columns((weighted, healthy), &basis, &shares, &baseline.residual);
        temperature::temperature(observed, &columns)
    }

    /// The posterior about this robot.
    fn find(
        self,
        observed: &Observations<'_>,
        file: &Robot,
        weighted: &Whitening,
        windows: Windows,
        progress: &dyn Fn(&str, f64),
    ) -> Result<Found, Error> {
        let step = |name: &str, share: f64| {
            progress(name, share);
            observed.go_on()
        };
        let temperature = self.temperature(observed, weighted);
        let About { baseline, effects, basis, .. } = self;
        let Basis { columns, amplitudes, shares: missed, beyond, run_variation } = basis;
        let whitening = weighted.scaled(|_| 1.0 / temperature.sqrt());
        let joint = Joint::new(observed, (&baseline, file), &columns, whitening, temperature, &amplitudes);
        drop(columns);
        step("screening mechanisms", 0.0)?;
        let grid = Grid::new(observed, windows);
        let screen = Screen::new(&joint, &grid, effects);
        let blocks = unlisted::blocks(&joint);
        step("refitting the leading sets", 0.2)?;
        let search =
            Search { joint: &joint, screen: &screen, grid: &grid, blocks: &blocks, missed: missed.power };
        let explanations = search.posterior()?;
        step("holding stretches out", 0.8)?;
        let held_out = held_outs(&joint, &explanations);
        let detectable = screen.information().into_iter().map(|(effect, g)| (effect.clone(), g)).collect();
        let noise_floor_w = noise_floor_w(observed, &baseline);
        let parameter_covariance = joint.model.covariance_of_first(baseline.parameters.len());
        Ok(Found {
            explanations,
            missed,
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
    Scale { robot: file, meter_zero_w, mean_power_w, mean_loss_w, row_s: observed.series.row_s() }
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
    let scale = scale(observed, baseline, file);
    let shared: Vec<_> = library.iter().copied().filter(|one| one.unstated_share(&scale) > 0.0).collect();
    Ok(shares(&effects(&shared, &scale, &beside)?, |one| one.unstated_share(&scale)))
}
