//! What the fits say: the verdict, the findings, and where the drives differed.

use model::Robot;
use recording::{Channel, Recording};

use crate::{
    Error,
    baseline::{Baseline, differences},
    discovered::Discovered,
    event::Event,
    explainable::explained_share,
    locate,
    missed::{MISFIT, Missed, REMAINS, floor_w, open_w, usual_w},
    refitted::{Refitted, bias_w, of_healthy_alone_w, rmse_w},
    report::{
        BaselineFit, CorrectedFit, EvidenceFigures, Finding, FindingFit, FoundParameter, Place, Range, Trace,
        Verdict,
    },
    search::{Found, Search},
    series::{Applied, Series},
    words,
};

/// Share of held-out errors that may be explainable where nothing is missing.
const LITTLE: f64 = 0.06;
/// What the fits before, with each finding, and after say.
pub(crate) struct Judged {
    pub(crate) baseline: BaselineFit,
    pub(crate) corrected: CorrectedFit,
    /// Before, and with each finding more.
    steps: Vec<Refitted>,
    held_out_rmse_w: Vec<f64>,
    pub(crate) explainable: [f64; 2],
    /// Mean size of the power under suspicion.
    mean_w: f64,
    /// What is left of errors held out beyond noise in healthy drives [W].
    usual_w: f64,
    /// One sigma of what healthy drives show the model to miss [W].
    open_w: f64,
    filed_w: Vec<f64>,
    /// What happened in some stretches, where nothing was found and far more is left than usual.
    event: Option<Event>,
    /// Terms outside the list, which the last steps have.
    pub(crate) discovered: Vec<Discovered>,
}

impl Judged {
    pub(crate) fn new(series: &Series, file: &Robot, found: &Search) -> Result<Self, Error> {
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
        // Where nothing is taken for what is missing, that is in the fit to all drives.
        let usual_w = match found.found.is_empty() {
            true => usual_w(series, &found.before, &of_healthy_alone_w(series, &found.before)),
            false => usual_w(series, &found.after, &steps[last].held_out_w),
        };
        let mut judged = Judged {
            baseline,
            corrected,
            steps,
            held_out_rmse_w,
            explainable,
            mean_w,
            usual_w,
            open_w: open_w(series, mean_w),
            filed_w,
            event: None,
            discovered,
        };
        if found.found.is_empty() && judged.missed().is_most() {
            judged.event = Event::of(series, &found.after, &judged.steps[0].held_out_w);
        }
        Ok(judged)
    }

    /// Adds terms outside the list, one after the other. Where something comes again and again, terms that leave most of it, as often as before,
    /// are not what is missing: they are left out.
    pub(crate) fn take_up(
        &mut self,
        series: &Series,
        found: &Search,
        discovered: Vec<Discovered>,
    ) -> Result<(), Error> {
        let mechanisms: Vec<&Found> = found.found.iter().collect();
        let more = (1..=discovered.len())
            .map(|count| Refitted::new(series, &found.after, &mechanisms, &discovered[..count]));
        let more = more.collect::<Result<Vec<Refitted>, Error>>()?;
        let Some(last) = more.last() else { return Ok(()) };
        let corrected = CorrectedFit {
            rmse_w: rmse_w(series, &last.errors_w),
            held_out_rmse_w: rmse_w(series, &last.held_out_w),
        };
        let missed = Missed { after_w: corrected.held_out_rmse_w, ..self.missed() };
        let comes_still =
            || Event::of(series, &found.after, &last.held_out_w).is_some_and(|event| event.comes_again());
        if self.event.as_ref().is_some_and(Event::comes_again) && missed.is_most() && comes_still() {
            return Ok(());
        }
        self.corrected = corrected;
        // What a term tells was no noise, though neither inputs nor the second before had told it.
        self.baseline.noise_floor_w = self.baseline.noise_floor_w.min(corrected.rmse_w);
        self.held_out_rmse_w.extend(more.iter().map(|step| rmse_w(series, &step.held_out_w)));
        self.steps.extend(more);
        self.discovered = discovered;
        Ok(())
    }

    pub(crate) fn verdict(&self, found: &Search) -> Verdict {
        match self.verdict_by_inputs(found) {
            Verdict::Consistent if self.event.as_ref().is_some_and(Event::comes_again) => {
                Verdict::Unexplained
            }
            verdict => verdict,
        }
    }

    /// The verdict if nothing counted but what follows what was recorded.
    pub(crate) fn verdict_by_inputs(&self, found: &Search) -> Verdict {
        let [before, after] = self.explainable;
        let missed = self.missed();
        let is_little = |explainable: f64| {
            explainable <= LITTLE || missed.is_usual(explainable.sqrt() * self.corrected.rmse_w)
        };
        let is_missed = missed.is_most();
        // What follows inputs, or happened once and is far more than usual, is missing though its name was refused, and so is what was sure.
        let is_much = is_missed || !is_little(before);
        if found.refused.iter().any(|refused| refused.leaves_something(is_much)) {
            return Verdict::Unexplained;
        }
        let is_alone = found.found.iter().all(|f| f.indistinguishable_from.is_empty());
        match found.found.is_empty() {
            true if is_little(before) && self.discovered.is_empty() => Verdict::Consistent,
            true => Verdict::Unexplained,
            false
                if missed.is_most_beside_a_name()
                    || !self.discovered.is_empty()
                    || !is_little(after) && after > REMAINS * before =>
            {
                Verdict::Unexplained
            }
            false if is_alone => Verdict::Explained,
            false => Verdict::Ambiguous,
        }
    }

    /// What is left beside names that stand though it is more than usual, in words.
    pub(crate) fn left_beside_names(&self, found: &Search) -> Option<String> {
        let missed = self.missed();
        let is_left = !found.found.is_empty() && self.discovered.is_empty() && missed.is_most();
        (is_left && !missed.is_most_beside_a_name()).then(|| {
            format!(
                "beside what was found {:.1} W are left beyond noise; healthy drives show the model to be off by up to {:.1} W as well, so \
                 that it is no sign of anything more. Healthy drives on the same ground would tell",
                missed.left_w(),
                self.open_w
            )
        })
    }

    /// What happened in some stretches and follows nothing that was recorded, where nothing else is missing.
    pub(crate) fn event(&self) -> Option<&Event> {
        self.event.as_ref().filter(|_| self.discovered.is_empty())
    }

    /// What is left of the difference.
    fn missed(&self) -> Missed {
        Missed {
            before_w: self.baseline.held_out_rmse_w,
            after_w: self.corrected.held_out_rmse_w,
            floor_w: self.baseline.noise_floor_w,
            usual_w: self.usual_w.max(MISFIT * self.mean_w),
            open_w: self.open_w,
        }
    }

    pub(crate) fn findings(&self, series: &Series, robot: &Robot, found: &Search) -> Vec<Finding> {
        let mut rmse_w = self.held_out_rmse_w.windows(2).map(|pair| [pair[0], pair[1]]);
        let mut findings: Vec<Finding> = found
            .found
            .iter()
            .zip(&mut rmse_w)
            .map(|(f, rmse_w)| finding(series, robot, f, rmse_w))
            .collect();
        findings.extend(self.discovered.iter().zip(rmse_w).map(|(d, rmse_w)| d.finding(series, rmse_w)));
        findings
    }

    /// Where the errors are that the findings take away; where nothing was found, what follows nothing, or else those beyond noise.
    pub(crate) fn places(&self, series: &Series, robot: &Robot, found: &Search) -> Result<Vec<Place>, Error> {
        if let Some(event) = self.event() {
            return Ok(event.places.clone());
        }
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
        let mut places = locate::places(series, robot, &excess);
        if places.is_empty() {
            let range = Range::of("t_s", [None, None]);
            let statement = "all through the drives, nowhere in particular".into();
            places.push(Place { kind: "time", statement, range, share_of_excess: 1.0 });
        }
        Ok(places)
    }

    pub(crate) fn trace(&self, series: &Series, recording: &Recording) -> Trace {
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
pub(crate) fn position_m(recording: &Recording, run: usize, t_s: f64) -> Option<[f64; 2]> {
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

fn finding(series: &Series, robot: &Robot, found: &Found, [before_w, after_w]: [f64; 2]) -> Finding {
    let applied = &found.applied;
    let mechanism = applied.mechanism;
    let numbers = mechanism.parameters().iter().zip(applied.values.iter().zip(&found.half_widths));
    let mut parameters: Vec<FoundParameter> = numbers
        .map(|(parameter, (&value, half))| {
            // Beyond what there can be is no interval.
            let [low, high] = parameter.bounds_of(robot);
            let interval_95 = half.map(|half| [value - half, value + half].map(|edge| edge.clamp(low, high)));
            FoundParameter { name: parameter.name, value, unit: parameter.unit, interval_95 }
        })
        .collect();
    let mut statement = words::capital(&mechanism.statement(&applied.values));
    if !applied.span.is_all() {
        for (j, (name, value, unit)) in series.bounds(applied.span).into_iter().enumerate() {
            parameters.push(FoundParameter {
                name,
                value,
                unit,
                interval_95: found.limits_95.get(j).copied(),
            });
        }
        statement += &format!(", {}", applied.span.words(&series.names));
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
        probability: None,
        scope: None,
    }
}
