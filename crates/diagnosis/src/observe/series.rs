//! Recorded drives as the model sees them: one-second averages of what was recorded, and of what would be with mechanisms.
//!
//! Power is what is to be explained. What the battery gives beyond both sides tells standing loads and faults of the meters
//! apart, and speed over ground and yaw rate tell slipping wheels and encoders that are wrong; each is used where it was recorded.

use std::ops::ControlFlow;

use calibration::DrivesCoverage;
use model::{Robot, Sides};
use recording::{PowerForm, Recording, Watch, unwatched};

use crate::{
    Applied, Error,
    observe::{
        average::{Average, Meter},
        part::Part,
        region::EDGES,
        span::{Span, Timeline},
        turning::{self, Left, Line},
    },
};

/// All drives.
pub struct Series {
    parts: Vec<Part>,
    pub(crate) meters: Vec<Meter>,
    /// What was recorded, average by average; see [`Series::averages`].
    pub recorded: Vec<f64>,
    /// What each value is of, in the same order.
    pub averages: Vec<Average>,
    /// Names of the drives under suspicion.
    pub(crate) names: Vec<String>,
    watch: Watch,
    /// What repeats with every turn of the wheels, if anything does.
    pub(crate) turning: Option<Line>,
}

impl Series {
    /// Prepares drives under suspicion and, if there are any, healthy ones.
    ///
    /// # Errors
    /// As [`Drives::new`]; drives that tell power in different forms.
    pub fn new(robot: &Robot, suspect: &Recording, healthy: Option<&Recording>) -> Result<Self, Error> {
        Series::watched(robot, suspect, healthy, &unwatched())
    }

    /// Prepares drives as [`Series::new`] does; predictions end when the watch breaks.
    ///
    /// # Errors
    /// As [`Series::new`].
    pub fn watched(
        robot: &Robot,
        suspect: &Recording,
        healthy: Option<&Recording>,
        watch: &Watch,
    ) -> Result<Self, Error> {
        let mut parts = vec![Part::new(robot, suspect, true, watch)?];
        if let Some(healthy) = healthy {
            parts.push(Part::new(robot, healthy, false, watch)?);
        }
        let form = parts[0].drives.form.unwrap_or(PowerForm::Battery);
        if parts.iter().any(|part| part.drives.form != Some(form)) {
            return Err(Error::Form);
        }
        if form == PowerForm::MotorCurrents {
            let watts_per_a = Some(parts[0].mean_watts_per_a(robot)?);
            parts.iter_mut().for_each(|part| part.watts_per_a = watts_per_a);
        }
        // Healthy drives show how voltages follow currents; whatever a meter reads is the same in all of them.
        let source = parts.last().and_then(Part::source);
        parts.iter_mut().for_each(|part| part.set_source(source));
        let is_told = |meter: &Meter| parts.iter().all(|part| part.tells(*meter));
        let meters: Vec<Meter> = Meter::of(form).into_iter().filter(is_told).collect();
        let watch = Watch::clone(watch);
        let mut series = Series {
            parts,
            meters,
            recorded: Vec::new(),
            averages: Vec::new(),
            names: suspect.runs.iter().map(|run| run.name.clone()).collect(),
            watch,
            turning: None,
        };
        let mut runs = 0;
        for part in &series.parts {
            for meter in &series.meters {
                series.recorded.extend(part.recorded(*meter));
                series.averages.extend(part.averages(*meter, runs));
            }
            runs += part.drives.runs.len();
        }
        Ok(series)
    }

    /// The same drives, with what repeats with every turn of the wheels looked for.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn with_turns(mut self, robot: &Robot) -> Result<Self, Error> {
        self.turning = self.line(robot)?;
        let Some(line) = &self.turning else { return Ok(self) };
        let nearness = self.parts[0].drives.averaged(&line.nearness);
        let is_own = |channel: usize| self.channels() == 1 || channel == line.side;
        for channel in (0..self.channels()).filter(|channel| is_own(*channel)).collect::<Vec<_>>() {
            let own = self.averages.iter_mut().filter(|a| a.suspect && a.channel == channel);
            own.zip(&nearness).for_each(|(average, nearness)| average.input.nearness = *nearness);
        }
        Ok(self)
    }

    /// What repeats with every turn of the wheels, of the robot's file as it is.
    fn line(&self, robot: &Robot) -> Result<Option<Line>, Error> {
        let errors_w = |part: &Part| -> Result<Vec<Vec<f64>>, Error> {
            let seen = part.predict(robot, &[], &self.meters)?;
            let of = |(channel, recorded): (usize, &Vec<f64>)| {
                (0..recorded.len()).map(|row| part.recorded_w(channel, row) - seen[row][channel]).collect()
            };
            Ok(part.drives.recorded.iter().enumerate().map(of).collect())
        };
        let errors_w: Vec<Vec<Vec<f64>>> = self.parts.iter().map(errors_w).collect::<Result<_, _>>()?;
        let left: Vec<Left<'_>> = self
            .parts
            .iter()
            .zip(&errors_w)
            .map(|(part, errors_w)| Left { drives: &part.drives, errors_w })
            .collect();
        Ok(turning::line(robot, &left[0], left.get(1)))
    }

    /// Who is asked whether to go on.
    pub(crate) fn watch(&self) -> &Watch {
        &self.watch
    }

    /// Asks the watch whether to go on.
    ///
    /// # Errors
    /// [`calibration::Error::Stopped`] when it breaks.
    pub(crate) fn go_on(&self) -> Result<(), Error> {
        match (self.watch)(0) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(calibration::Error::Stopped.into()),
        }
    }

    /// What an ampere of each side's motor counts as, where motor currents were recorded [W/A].
    pub(crate) fn watts_per_a(&self) -> Option<Sides<f64>> {
        self.parts[0].watts_per_a
    }

    /// What a report says of drives that were not compared as a whole.
    pub(crate) fn sampled(&self) -> Vec<String> {
        let of = |part: &Part| part.sample.words(if part.suspect { "driving" } else { "healthy driving" });
        self.parts.iter().filter_map(of).collect()
    }

    /// Time between the rows of the coarsest log, in the median [s].
    pub(crate) fn row_s(&self) -> f64 {
        let of = |part: &Part| {
            let mut steps_s: Vec<f64> = part.drives.rows.iter().map(|row| row.step_s).collect();
            steps_s.retain(|step_s| *step_s > 0.0);
            steps_s.sort_unstable_by(f64::total_cmp);
            steps_s.get(steps_s.len() / 2).copied().unwrap_or(0.0)
        };
        self.parts.iter().map(of).fold(0.0, f64::max)
    }

    /// Length of the averages [s].
    pub(crate) fn average_s(&self) -> f64 {
        self.parts.iter().map(|part| part.drives.average_s()).fold(0.0, f64::max)
    }

    /// What is to be said of power meters that are slower than the wheels.
    pub(crate) fn meter_note(&self) -> Option<String> {
        self.parts.iter().find_map(|part| part.drives.meter_note())
    }

    /// What of the drives is compared, of those under suspicion and, where there are any, of healthy ones.
    pub(crate) fn coverage(&self) -> (DrivesCoverage, Option<DrivesCoverage>) {
        let of = |suspect: bool| self.parts.iter().find(|part| part.suspect == suspect);
        let coverage = |part: &Part| part.coverage.clone();
        (of(true).map(coverage).unwrap_or_default(), of(false).map(coverage))
    }

    /// Driving under suspicion that is compared, where that is not all of it [s].
    pub(crate) fn compared_s(&self) -> Option<f64> {
        let sample = &self.parts.first()?.sample;
        (sample.compared_s < sample.driven_s).then_some(sample.compared_s)
    }

    /// Name of the drive that an average is of.
    pub(crate) fn run_name(&self, average: &Average) -> String {
        let healthy = self.parts.last().filter(|part| !part.suspect);
        let name = match average.suspect {
            true => self.names.get(average.run),
            false => {
                healthy.and_then(|part| part.drives.runs.get(average.run.checked_sub(self.names.len())?))
            }
        };
        name.cloned().unwrap_or_default()
    }

    /// Number of channels of power.
    pub fn channels(&self) -> usize {
        self.meters.iter().filter(|meter| meter.is_power()).count()
    }

    /// Whether there are healthy drives.
    pub fn has_healthy(&self) -> bool {
        self.parts.len() > 1
    }

    /// Surfaces that were driven on.
    pub fn surfaces(&self) -> Vec<String> {
        let mut names: Vec<String> =
            self.parts.iter().flat_map(|part| part.drives.surfaces.iter().cloned()).collect();
        names.sort();
        names.dedup();
        names
    }

    /// The longest drive under suspicion [s].
    pub fn longest_s(&self) -> f64 {
        self.averages.iter().filter(|a| a.suspect).map(|a| a.t_s).fold(0.0, f64::max)
    }

    /// The drives under suspicion, one behind the other.
    pub(crate) fn timeline(&self) -> Timeline {
        let seconds = self.averages.iter().filter(|a| a.suspect).map(|a| (a.run, a.t_s));
        Timeline::of(self.names.len(), seconds)
    }

    /// What bounds a span: names, values and units, none for what always acts.
    pub fn bounds(&self, span: Span) -> Vec<(&'static str, f64, &'static str)> {
        match span {
            Span::Within(region) => {
                let edges = EDGES.into_iter().zip(region.edges_m()).filter(|(_, edge_m)| edge_m.is_finite());
                edges.map(|(name, edge_m)| (name, edge_m, "m")).collect()
            }
            Span::EachDrive(_) if span.is_all() => Vec::new(),
            Span::Until { .. } => vec![("until_s", self.timeline().driven_s(span), "s")],
            Span::EachDrive(_) | Span::From { .. } => vec![("from_s", self.timeline().driven_s(span), "s")],
        }
    }

    /// What would have been recorded of a robot on which mechanisms act in the drives under suspicion.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub fn predict(&self, robot: &Robot, applied: &[Applied]) -> Result<Vec<f64>, Error> {
        self.predict_with(robot, applied, &[])
    }

    /// The same with mechanisms in healthy drives too.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub fn predict_with(
        &self,
        robot: &Robot,
        suspect: &[Applied],
        healthy: &[Applied],
    ) -> Result<Vec<f64>, Error> {
        let mut seen = Vec::with_capacity(self.recorded.len());
        for part in &self.parts {
            let applied = if part.suspect { suspect } else { healthy };
            seen.extend(part.predict_averages(robot, applied, &self.meters)?);
        }
        Ok(seen)
    }
}
