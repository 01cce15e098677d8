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
/// Share by which speed over ground and yaw rate are missed where no drives tell: a constant slip track does not follow how slip grows with
/// turn, speed and ground. That of one Husky A200 is 0.8 to 1.0 m on hard ground alone (BorealTC), a tenth to either side.
pub(crate) const MOTION_ERROR: f64 = 0.1;

/// Share of the power's amplitude by which what the battery gives beyond both sides is missed: meters at both ends of a wire see the same power but for what it loses.
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

/// Amplitudes of the discrepancy, as shares of what it multiplies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shares {
    /// Of powers.
    pub(crate) power: f64,
    /// Of speed over ground and yaw rate.
    pub(crate) motion: f64,
}

impl Shares {
    /// Of powers, with the usual one of motion.
    pub(crate) fn of_power(power: f64) -> Self {
        Shares { power, motion: MOTION_ERROR }
    }
}

/// Columns of the discrepancy, of prior standard deviation one.
pub(crate) fn columns(observed: &Observations<'_>, components: &Components, shares: Shares) -> Vec<Vec<f64>> {
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
            add(shares.power, component, &|channel| channel == side);
        }
    }
    for (channel, amplitude) in
        [(REST, REST_SHARE * shares.power), (GROUND_SPEED, shares.motion), (YAW_RATE, shares.motion)]
    {
        if observed.has_channel(channel) {
            add(amplitude, &components.total, &|other| other == channel);
        }
    }
    all
}

/// Runs from which drives tell how much runs differ: two show one difference.
pub(crate) const LEAST_RUNS: usize = 3;
/// Most runs that have columns of their own: each adds three, and the time of a diagnosis grows with the square of all columns.
const MOST_RUNS: usize = 60;

/// Columns of unit amplitude: rolling and skid resistance of every run, and its yaw rate where that was recorded; none where there are too few
/// or too many runs.
pub(crate) fn run_columns(observed: &Observations<'_>, components: &Components) -> Vec<Vec<f64>> {
    let averages = observed.averages();
    if !(LEAST_RUNS..=MOST_RUNS).contains(&(observed.runs(false).len() + observed.runs(true).len())) {
        return Vec::new();
    }
    let of_run = |suspect: bool, run: usize, component: &[f64]| -> Vec<f64> {
        let value = |i: usize| {
            let is_own = averages[i].suspect == suspect && averages[i].run == run;
            if is_own { component[i] } else { 0.0 }
        };
        (0..averages.len()).map(value).collect()
    };
    let of = |component: &[f64], belongs: &dyn Fn(usize) -> bool| -> Vec<f64> {
        (0..averages.len()).map(|i| if belongs(i) { component[i] } else { 0.0 }).collect()
    };
    let is_power = |i: usize| observed.is_power(i);
    let mut of_ground = [&components.rolling, &components.skid].map(|one| of(one, &is_power)).to_vec();
    if observed.has_channel(YAW_RATE) {
        of_ground.push(of(&components.total, &|i| averages[i].channel == YAW_RATE));
    }
    let mut all = Vec::new();
    for suspect in [true, false] {
        for run in observed.runs(suspect) {
            all.extend(of_ground.iter().map(|one| of_run(suspect, run, one)));
        }
    }
    all
}
