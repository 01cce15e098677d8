//! What the model misses of a healthy robot, the same in all drives: component powers times smooth functions of the regime; and ground that
//! differs from run to run, a random effect of the run.

use crate::{
    fit::features::Features,
    observe::observations::{GROUND_SPEED, Observations, REGIME, REST, YAW_RATE},
};

/// Functions of the regime for each component: random features meet their covariance to about 1/√24, a fifth (Rahimi & Recht, NIPS 2007).
const FUNCTIONS: usize = 24;
/// Length scale of each quantity of the regime, in its scatter: models miss slow curves, not every bend.
const LENGTHS: [f64; REGIME] = [1.5; REGIME];
/// Share of the power's amplitude by which speed over ground and yaw rate are missed: slip is some hundredths of way where rolling takes some
/// hundredths of weight (Wong, Theory of Ground Vehicles, ch. 1), and power is missed by more than motion.
const MOTION_SHARE: f64 = 0.3;

/// The same of what the battery gives beyond both sides: meters at both ends of a wire see the same power but for what it loses.
const REST_SHARE: f64 = 0.3;

/// Powers that the discrepancy multiplies, row by row [W].
pub(crate) struct Components {
    /// Power that goes with rolling resistance: μ_R ∂P/∂μ_R.
    pub(crate) rolling: Vec<f64>,
    /// Power that goes with skid resistance: μ_S ∂P/∂μ_S.
    pub(crate) skid: Vec<f64>,
    /// What is predicted.
    pub(crate) total: Vec<f64>,
}

/// Columns of the discrepancy, of prior standard deviation one, whose amplitude is a share of each component.
pub(crate) fn columns(observed: &Observations<'_>, components: &Components, share: f64) -> Vec<Vec<f64>> {
    let features = Features::<REGIME>::new(FUNCTIONS, LENGTHS);
    let mut all = Vec::new();
    let mut add = |amplitude: f64, component: &[f64], belongs: &dyn Fn(usize) -> bool| {
        for k in 0..features.count() {
            let value = |i: usize| {
                let is_own = belongs(observed.averages()[i].channel);
                if is_own { amplitude * component[i] * features.at(k, &observed.regimes[i]) } else { 0.0 }
            };
            all.push((0..observed.rows()).map(value).collect());
        }
    };
    for side in 0..observed.series.channels() {
        for component in [&components.rolling, &components.skid, &components.total] {
            add(share, component, &|channel| channel == side);
        }
    }
    for (channel, amplitude) in
        [(REST, REST_SHARE * share), (GROUND_SPEED, MOTION_SHARE * share), (YAW_RATE, MOTION_SHARE * share)]
    {
        if observed.has_channel(channel) {
            add(amplitude, &components.total, &|other| other == channel);
        }
    }
    all
}

/// Runs from which healthy drives tell how much runs differ: two show one difference.
const LEAST_RUNS: usize = 3;
/// Most runs that have columns of their own: each adds two, and the time of a diagnosis grows with the square of all columns.
const MOST_RUNS: usize = 60;

/// Columns of unit amplitude: rolling and skid resistance of every run; none where there are too few or too many runs.
pub(crate) fn run_columns(observed: &Observations<'_>, components: &Components) -> Vec<Vec<f64>> {
    let averages = observed.averages();
    let healthy_runs = observed.runs(false);
    if healthy_runs < LEAST_RUNS || healthy_runs + observed.runs(true) > MOST_RUNS {
        return Vec::new();
    }
    let of_run = |suspect: bool, run: usize, component: &[f64]| -> Vec<f64> {
        let value = |i: usize| {
            let is_own = averages[i].suspect == suspect && averages[i].run == run && observed.is_power(i);
            if is_own { component[i] } else { 0.0 }
        };
        (0..averages.len()).map(value).collect()
    };
    let mut all = Vec::new();
    for suspect in [true, false] {
        for run in 0..observed.runs(suspect) {
            all.extend([&components.rolling, &components.skid].map(|one| of_run(suspect, run, one)));
        }
    }
    all
}
