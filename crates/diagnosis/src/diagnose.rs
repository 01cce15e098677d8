//! A diagnosis from beginning to end.

use calibration::with_powers;
use model::Robot;
use recording::{Channel, PowerForm, Recording, Watch, unwatched};

use crate::{
    Error,
    alternatives::{Explanation, alternatives, detectable},
    baseline::{Baseline, differences},
    corrected::corrected,
    discover::{Discovered, discover},
    doubts::doubts,
    explainable::explained_share,
    locate,
    next_drive::next_drive,
    refitted::{Refitted, bias_w, rmse_w},
    report::{
        BaselineFit, CorrectedFit, Diagnosis, EvidenceFigures, Finding, FindingFit, FoundParameter, Place,
        Range, Trace, Verdict,
    },
    search::{Found, Search, search},
    series::{Applied, Series},
    weigh::BLOCK_S,
    words,
};

/// Driving that a diagnosis needs [s]: six blocks, the visits that evidence takes.
pub(crate) const NEEDED_S: usize = 6 * BLOCK_S as usize;
/// Share of held-out errors that may be explainable where nothing is missing.
const LITTLE: f64 = 0.06;
/// Share of what was explainable before that may remain so.
const REMAINS: f64 = 0.35;
/// Share of power that may be explainable where nothing is missing: of drives of another kind than the healthy ones, what the
/// model misses of a robot in order reaches 1.1 %.
const MISFIT: f64 = 0.015;

/// What a diagnosis without healthy drives has to say of itself.
const ALONE: &str = "without drives known to be healthy (`--reference`) only what sets in during a drive or grows with time can be \
     told; what acts all the time looks like what the model itself misses";

/// What a diagnosis of motor currents has to say of itself.
const BY_CURRENT: &str = "motor currents were taken for forces by `force_n_per_a` of the robot's file and for power by its k1 and k2";

/// What a finding outside the list has to say of itself.
const OUTSIDE: &str = "what is outside the list is described, not understood: no robot's file can hold it, and the corrected \
     robot is without it";

/// Says where model and recording differ, which physics was left out, how big it is, and how sure that is.
///
/// `healthy` are drives of the same robot known to be in order; what they share with the suspect ones is not looked for.
/// `progress` is told the step and how much of all is done, 0 to 1.
///
/// # Errors
/// Drives that are too short, tell no power, or drove on a surface that the robot does not know.
pub fn diagnose(
    robot: &Robot,
    suspect: &Recording,
    healthy: Option<&Recording>,
    progress: &dyn Fn(&str, f64),
) -> Result<Diagnosis, Error> {
    diagnose_watched(robot, suspect, healthy, progress, &unwatched())
}

/// Diagnoses as [`diagnose()`] does, followed by a watch, which is asked before every prediction.
///
/// # Errors
/// As [`diagnose()`], and [`calibration::Error::Stopped`] soon after the watch breaks.
pub fn diagnose_watched(
    robot: &Robot,
    suspect: &Recording,
    healthy: Option<&Recording>,
    progress: &dyn Fn(&str, f64),
    watch: &Watch,
) -> Result<Diagnosis, Error> {
    progress("preparing the drives", 0.0);
    let by_current = suspect.power_form() == Some(PowerForm::MotorCurrents);
    let suspect = &with_powers(robot, suspect, watch)?;
    let healthy = healthy.map(|healthy| with_powers(robot, healthy, watch)).transpose()?;
    let healthy = healthy.as_ref();
    let series = Series::watched(robot, suspect, healthy, watch)?;
    let seconds = series.averages.iter().filter(|a| a.suspect && a.channel == 0).count();
    if seconds < NEEDED_S {
        return Err(Error::TooShort { seconds, needed: NEEDED_S });
    }
    let found = search(&series, robot, healthy, &|step, share| progress(step, 0.1 + 0.6 * share.min(1.0)))?;
    progress("judging what is left", 0.7);
    let mut judged = Judged::new(&series, robot, &found)?;
    let applied: Vec<Applied> = found.found.iter().map(|f| f.applied.clone()).collect();
    // Alone, what the model itself misses would pass for a discovery.
    if judged.verdict(&found) == Verdict::Unexplained && series.has_healthy() {
        progress("looking outside the list", 0.75);
        judged.take_up(&series, &found, discover(&series, &found.after, &applied, &found.null)?)?;
    }
    progress("locating the difference", 0.8);
    let places = judged.places(&series, &found, suspect)?;
    progress("planning the next drive", 0.85);
    let next_drive = decisive_drive(&series, robot, &found)?;
    let (corrected_robot, mut notes) = corrected(&found.after.robot, &applied, &series.surfaces());
    progress("weighing what could have been seen", 0.95);
    let (detectable, not_judged) = detectable(&series, &found.after, &applied)?;
    let mut doubts = doubts(robot, suspect, &series, &found.after)?;
    doubts.append(&mut notes);
    if healthy.is_none() {
        doubts.push(ALONE.to_owned());
    }
    if by_current {
        doubts.push(BY_CURRENT.to_owned());
    }
    let findings = judged.findings(&series, &found);
    if !judged.discovered.is_empty() {
        doubts.push(OUTSIDE.to_owned());
    }
    let mut diagnosis = Diagnosis {
        verdict: judged.verdict(&found),
        sentence: String::new(),
        baseline: judged.baseline,
        places,
        findings,
        corrected: judged.corrected,
        next_drive,
        explainable: judged.explainable,
        detectable,
        not_judged,
        notes: doubts,
        corrected_robot,
        trace: judged.trace(&series, suspect),
    };
    diagnosis.sentence = words::sentence(&diagnosis);
    progress("done", 1.0);
    Ok(diagnosis)
}

/// What the fits before, with each finding, and after say.
struct Judged {
    baseline: BaselineFit,
    corrected: CorrectedFit,
    /// Before, and with each finding more.
    steps: Vec<Refitted>,
    held_out_rmse_w: Vec<f64>,
    explainable: [f64; 2],
    /// Mean size of the power under suspicion.
    mean_w: f64,
    filed_w: Vec<f64>,
    /// Terms outside the list, which the last steps have.
    discovered: Vec<Discovered>,
}

impl Judged {
    fn new(series: &Series, file: &Robot, found: &Search) -> Result<Self, Error> {
        let filed_w = series.predict(file, &[])?;
        let filed_errors_w = differences(&series.recorded, &filed_w);
        let mut steps = vec![Refitted::new(series, &found.before, &[], &[])?];
        for count in 1..=found.found.len() {
            let part: Vec<&Found> = found.found.iter().take(count).collect();
            let applied: Vec<Applied> = part.iter().map(|f| f.applied.clone()).collect();
            let base = Baseline::fit(series, file, &applied)?;
            steps.push(Refitted::new(series, &base, &part, &[])?);
        }
        let held_out_rmse_w: Vec<f64> = steps.iter().map(|step| rmse_w(series, &step.held_out_w)).collect();
        let last = steps.len() - 1;
        let corrected = CorrectedFit {
            rmse_w: rmse_w(series, &steps[last].errors_w),
            held_out_rmse_w: held_out_rmse_w[last],
        };
        let baseline = BaselineFit {
            rmse_w: rmse_w(series, &filed_errors_w),
            bias_w: bias_w(series, &filed_errors_w),
            held_out_rmse_w: held_out_rmse_w[0],
            noise_floor_w: floor_w(series, &found.after).min(corrected.rmse_w),
        };
        let before = explained_share(series, &found.before, &steps[0].errors_w);
        let after = if found.found.is_empty() {
            before
        } else {
            explained_share(series, &found.after, &steps[last].errors_w)
        };
        let explainable = [before, after];
        let discovered = Vec::new();
        let sizes: Vec<f64> = series.recorded.iter().map(|w| w.abs()).collect();
        let mean_w = bias_w(series, &sizes);
        Ok(Judged { baseline, corrected, steps, held_out_rmse_w, explainable, mean_w, filed_w, discovered })
    }

    /// Adds terms outside the list, one after the other.
    fn take_up(&mut self, series: &Series, found: &Search, discovered: Vec<Discovered>) -> Result<(), Error> {
        let mechanisms: Vec<&Found> = found.found.iter().collect();
        for count in 1..=discovered.len() {
            let step = Refitted::new(series, &found.after, &mechanisms, &discovered[..count])?;
            self.corrected = CorrectedFit {
                rmse_w: rmse_w(series, &step.errors_w),
                held_out_rmse_w: rmse_w(series, &step.held_out_w),
            };
            self.held_out_rmse_w.push(self.corrected.held_out_rmse_w);
            self.steps.push(step);
        }
        self.discovered = discovered;
        Ok(())
    }

    fn verdict(&self, found: &Search) -> Verdict {
        let [before, after] = self.explainable;
        let is_little = |explainable: f64| {
            explainable <= LITTLE || explainable.sqrt() * self.corrected.rmse_w <= MISFIT * self.mean_w
        };
        let is_alone = found.found.iter().all(|f| f.indistinguishable_from.is_empty());
        match found.found.is_empty() {
            true if is_little(before) => Verdict::Consistent,
            true => Verdict::Unexplained,
            false if !is_little(after) && after > REMAINS * before => Verdict::Unexplained,
            false if is_alone => Verdict::Explained,
            false => Verdict::Ambiguous,
        }
    }

    fn findings(&self, series: &Series, found: &Search) -> Vec<Finding> {
        let mut rmse_w = self.held_out_rmse_w.windows(2).map(|pair| [pair[0], pair[1]]);
        let mut findings: Vec<Finding> =
            found.found.iter().zip(&mut rmse_w).map(|(f, rmse_w)| finding(f, rmse_w)).collect();
        findings.extend(self.discovered.iter().zip(rmse_w).map(|(d, rmse_w)| d.finding(series, rmse_w)));
        findings
    }

    /// Where the errors are that the findings take away; where nothing was found, those beyond noise.
    fn places(&self, series: &Series, found: &Search, suspect: &Recording) -> Result<Vec<Place>, Error> {
        if self.verdict(found) == Verdict::Consistent {
            return Ok(Vec::new());
        }
        let after = &found.after;
        let variance = |i: usize| after.noise.sigma(&series.averages[i], after.predicted_w[i]).powi(2);
        let errors_w = self.steps.last().map_or(&[][..], |step| &step.errors_w);
        let excess: Vec<f64> = if found.found.is_empty() {
            errors_w.iter().enumerate().map(|(i, e)| e * e / variance(i) - 1.0).collect()
        } else {
            // The corrected robot with what was found switched off.
            let without_w = series.predict(&after.robot, &[])?;
            let off = |i: usize| errors_w[i] + after.predicted_w[i] - without_w[i];
            (0..errors_w.len()).map(|i| (off(i).powi(2) - errors_w[i].powi(2)) / variance(i)).collect()
        };
        let runs: Vec<String> = suspect.runs.iter().map(|run| run.name.clone()).collect();
        let mut places = locate::places(series, &excess, &runs);
        if places.is_empty() {
            let range = Range { quantity: "t_s", from: None, to: None, name: None };
            let statement = "all through the drives, nowhere in particular".into();
            places.push(Place { kind: "time", statement, range, share_of_excess: 1.0 });
        }
        Ok(places)
    }

    fn trace(&self, series: &Series, recording: &Recording) -> Trace {
        let count = series.averages.iter().filter(|a| a.suspect && a.channel == 0).count();
        let errors_w = self.steps.last().map_or(&[][..], |step| &step.errors_w);
        let all = |values: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..count).map(|i| (0..series.channels()).map(|c| values(i + c * count)).sum()).collect()
        };
        let averages = &series.averages[..count];
        Trace {
            run: averages.iter().map(|a| a.run).collect(),
            t_s: averages.iter().map(|a| a.t_s).collect(),
            recorded_w: all(&|i| series.recorded[i]),
            filed_w: all(&|i| self.filed_w[i]),
            corrected_w: all(&|i| series.recorded[i] - errors_w[i]),
            runs: recording.runs.iter().map(|run| run.name.clone()).collect(),
            position_m: averages.iter().map(|a| position_m(recording, a.run, a.t_s)).collect(),
        }
    }
}

/// Where the robot was so long after a drive began.
fn position_m(recording: &Recording, run: usize, t_s: f64) -> Option<[f64; 2]> {
    let rows = recording.runs.get(run)?.rows.clone();
    let times = recording.t_s.get(rows.clone())?;
    let wanted_s = times.first()? + t_s;
    let row = rows.start + times.partition_point(|t| *t < wanted_s).min(times.len() - 1);
    let at = [Channel::X, Channel::Y].map(|channel| recording.channel(channel).map(|values| values[row]));
    match at {
        [Some(x), Some(y)] if x.is_finite() && y.is_finite() => Some([x, y]),
        _ => None,
    }
}

/// What neither the inputs nor the second before tell of an error, over the drives under suspicion [W].
fn floor_w(series: &Series, base: &Baseline) -> f64 {
    let counts = (0..series.averages.len()).filter(|i| series.averages[*i].suspect && series.is_power(*i));
    let fresh = |i: usize| base.noise.fresh_sigma(&series.averages[i], base.predicted_w[i]).powi(2);
    let squares: Vec<f64> = counts.map(fresh).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// The drive that tells the first ambiguous finding from its alternatives.
fn decisive_drive(series: &Series, file: &Robot, found: &Search) -> Result<Option<String>, Error> {
    let ambiguous = found.found.iter().position(|f| !f.indistinguishable_from.is_empty());
    let Some(which) = ambiguous else { return Ok(None) };
    let others = alternatives(series, file, &found.found, which)?;
    let best = Explanation {
        name: found.found[which].applied.mechanism.name(),
        applied: found.found.iter().map(|f| f.applied.clone()).collect(),
        robot: found.after.robot.clone(),
    };
    let surfaces = series.surfaces();
    let surface = surfaces.first().unwrap_or(&file.default_surface);
    Ok(next_drive(&best, &others, &found.after.noise, surface, series.channels() == 2))
}

fn finding(found: &Found, [before_w, after_w]: [f64; 2]) -> Finding {
    let applied = &found.applied;
    let mechanism = applied.mechanism;
    let numbers = mechanism.parameters().iter().zip(applied.values.iter().zip(&found.half_widths));
    let mut parameters: Vec<FoundParameter> = numbers
        .map(|(parameter, (&value, half))| FoundParameter {
            name: parameter.name,
            value,
            unit: parameter.unit,
            interval_95: half.map(|half| [value - half, value + half]),
        })
        .collect();
    let mut statement = words::capital(&mechanism.statement(&applied.values));
    if applied.from_s > 0.0 {
        parameters.push(FoundParameter {
            name: "from_s",
            value: applied.from_s,
            unit: "s",
            interval_95: found.onset_95_s,
        });
        statement += &format!(", from about {:.0} s on", applied.from_s);
    }
    Finding {
        mechanism: mechanism.name().to_owned(),
        statement,
        equation: mechanism.equation().to_owned(),
        parameters,
        evidence: EvidenceFigures {
            p_value: found.p_value,
            delta_bic: found.delta_bic,
            held_out_gain: found.held_out_gain,
        },
        indistinguishable_from: found.indistinguishable_from.clone(),
        fit: FindingFit { held_out_rmse_before_w: before_w, held_out_rmse_after_w: after_w },
    }
}
