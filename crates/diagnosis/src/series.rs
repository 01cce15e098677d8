//! Recorded drives as the model sees them: one-second averages of what was recorded, and of what would be with mechanisms.

use calibration::{Drives, average, drives::Stretch, losses, row::Row};
use model::{
    Attitude, Friction, FrictionShape, Manoeuvre, Motion, Robot, Sides,
    mechanism::{Mechanism, Moment},
};
use rayon::prelude::*;
use recording::{Channel, PowerForm, Recording};

use crate::Error;

/// A mechanism at some values from some time on.
#[derive(Clone)]
pub struct Applied {
    /// Which.
    pub mechanism: &'static dyn Mechanism,
    /// Values of its parameters.
    pub values: Vec<f64>,
    /// It acts from so long after the beginning of each suspect drive on [s].
    pub from_s: f64,
}

impl std::fmt::Debug for Applied {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {:?} from {} s", self.mechanism.name(), self.values, self.from_s)
    }
}

/// Drives of one kind: those under suspicion, or healthy ones.
struct Part {
    drives: Drives,
    suspect: bool,
    /// By row [rad].
    heading_rad: Vec<f64>,
    /// By row: beginning of the run [s].
    began_s: Vec<f64>,
}

/// All drives.
pub struct Series {
    parts: Vec<Part>,
    form: PowerForm,
    /// What was recorded, average by average; see [`Series::averages`].
    pub recorded: Vec<f64>,
    /// What each value is of, in the same order.
    pub averages: Vec<Average>,
    channels: usize,
}

/// What one value is an average of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Average {
    /// 0 and 1 for left and right power, or 0 for that of the battery.
    pub channel: usize,
    /// Which drive; drives under suspicion and healthy ones count on.
    pub run: usize,
    /// Whether the drive is under suspicion.
    pub suspect: bool,
    /// Time since the drive began [s].
    pub t_s: f64,
    /// Means of the inputs.
    pub input: Input,
}

/// Means of what drives the robot, over one average.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    /// Mean of both rim speeds, and right less left [m/s].
    pub speed_mps: f64,
    /// See [`Input::speed_mps`].
    pub difference_mps: f64,
    /// Rim speed of the channel's own side, or the mean [m/s].
    pub rim_mps: f64,
    /// Pitch and roll [rad].
    pub pitch_rad: f64,
    /// See [`Input::pitch_rad`].
    pub roll_rad: f64,
    /// Rate of change of speed [m/s²].
    pub accel_mps2: f64,
    /// Heading; NaN where unknown [rad].
    pub heading_rad: f64,
}

impl Series {
    /// Prepares drives under suspicion and, if there are any, healthy ones.
    ///
    /// # Errors
    /// As [`Drives::new`]; drives that tell power in different forms.
    pub fn new(robot: &Robot, suspect: &Recording, healthy: Option<&Recording>) -> Result<Self, Error> {
        let mut parts = vec![Part::new(robot, suspect, true)?];
        if let Some(healthy) = healthy {
            parts.push(Part::new(robot, healthy, false)?);
        }
        let form = parts[0].drives.form.unwrap_or(PowerForm::Battery);
        if form == PowerForm::MotorCurrents || parts.iter().any(|part| part.drives.form != Some(form)) {
            return Err(Error::Form);
        }
        let channels = if form == PowerForm::Sides { 2 } else { 1 };
        let mut series = Series { parts, form, recorded: Vec::new(), averages: Vec::new(), channels };
        let mut runs = 0;
        for part in &series.parts {
            series.recorded.extend(part.drives.recorded_averages());
            for channel in 0..channels {
                series.averages.extend(part.averages(channel, runs));
            }
            runs += part.drives.runs.len();
        }
        Ok(series)
    }

    /// Number of channels of power.
    pub fn channels(&self) -> usize {
        self.channels
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

    /// Time between rows of the drives under suspicion [s].
    pub fn row_s(&self) -> f64 {
        let rows = &self.parts[0].drives.rows;
        let mut steps: Vec<f64> = rows.iter().map(|row| row.step_s).filter(|step_s| *step_s > 0.0).collect();
        crate::noise::median(&mut steps)
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
            let rows = part.predict(robot, if part.suspect { suspect } else { healthy }, self.form)?;
            let channels = 0..self.channels;
            channels.for_each(|channel| seen.extend(part.drives.averaged_by(|row| rows[row][channel])));
        }
        Ok(seen)
    }
}

impl Part {
    fn new(robot: &Robot, recording: &Recording, suspect: bool) -> Result<Self, Error> {
        // Being stuck is a mechanism's business here.
        let drives = Drives::new(robot, recording)?.including_stuck();
        let mut began_s = vec![0.0; recording.rows()];
        for run in &recording.runs {
            let first = run.rows.clone().next().map_or(0.0, |row| recording.t_s[row]);
            began_s[run.rows.clone()].fill(first);
        }
        Ok(Part { heading_rad: headings(recording, &drives), began_s, drives, suspect })
    }

    fn averages(&self, channel: usize, first_run: usize) -> Vec<Average> {
        let rows = &self.drives.rows;
        let mean = |value: &(dyn Fn(usize) -> f64 + Sync)| self.drives.averaged_by(value);
        let inputs = [
            mean(&|i| rows[i].speed_mps()),
            mean(&|i| rows[i].difference_mps()),
            mean(&|i| match channel {
                _ if self.drives.recorded.len() == 1 => rows[i].speed_mps(),
                0 => rows[i].rim_mps.left,
                _ => rows[i].rim_mps.right,
            }),
            mean(&|i| rows[i].pitch_rad),
            mean(&|i| rows[i].roll_rad),
            mean(&|i| rows[i].rim_mps2.sum() / 2.0),
            mean(&|i| self.heading_rad[i].cos()),
            mean(&|i| self.heading_rad[i].sin()),
        ];
        let of = |(i, average): (usize, &average::Average)| Average {
            channel,
            run: first_run + average.run,
            suspect: self.suspect,
            t_s: average.t_s - self.began_s[average.rows.start],
            input: Input {
                speed_mps: inputs[0][i],
                difference_mps: inputs[1][i],
                rim_mps: inputs[2][i],
                pitch_rad: inputs[3][i],
                roll_rad: inputs[4][i],
                accel_mps2: inputs[5][i],
                heading_rad: inputs[7][i].atan2(inputs[6][i]),
            },
        };
        self.drives.averages.iter().enumerate().map(of).collect()
    }

    /// What each channel would show, by row.
    fn predict(&self, robot: &Robot, applied: &[Applied], form: PowerForm) -> Result<Vec<[f64; 2]>, Error> {
        let mut changed = robot.clone();
        for applied in applied {
            changed = applied.mechanism.robot(&changed, &applied.values).unwrap_or(changed);
        }
        let memory_s = applied.iter().find_map(|a| a.mechanism.memory_s(&a.values));
        let loss_w = match memory_s {
            Some(memory_s) => losses::averaged(&self.drives, robot, memory_s),
            None => Vec::new(),
        };
        let mut seen = vec![[0.0; 2]; self.drives.rows.len()];
        for stretch in &self.drives.stretches {
            let name = &self.drives.surfaces[stretch.surface];
            let surface_of =
                |robot: &Robot| robot.surface(name).cloned().map_err(|_| Error::surface(name, robot));
            let (plain, other) = (surface_of(robot)?, surface_of(&changed)?);
            let rows: Vec<[f64; 2]> = stretch
                .rows
                .clone()
                .into_par_iter()
                .with_min_len(512)
                .map(|i| {
                    let t_s = self.drives.rows[i].t_s - self.began_s[i];
                    let acting: Vec<&Applied> = applied.iter().filter(|a| t_s >= a.from_s).collect();
                    let (robot, surface) =
                        if acting.is_empty() { (robot, &plain) } else { (&changed, &other) };
                    let moment =
                        self.moment(robot, i, loss_w.get(i).copied().unwrap_or(self.drives.rows[i].loss_w));
                    seen_w(robot, surface, &self.drives.rows[i], moment, &acting, form)
                })
                .collect();
            let delay_s: f64 = applied.iter().map(|a| a.mechanism.delay_s(&a.values)).sum();
            for (i, row) in stretch.rows.clone().enumerate() {
                seen[row] = if delay_s == 0.0 { rows[i] } else { self.at(stretch, &rows, i, delay_s) };
            }
        }
        Ok(seen)
    }

    /// The row's values so much earlier, between rows in proportion; the first or last where the stretch does not reach.
    fn at(&self, stretch: &Stretch, rows: &[[f64; 2]], i: usize, delay_s: f64) -> [f64; 2] {
        let times = &self.drives.rows[stretch.rows.clone()];
        let wanted_s = times[i].t_s - delay_s;
        let after = times.partition_point(|row| row.t_s < wanted_s);
        if after == 0 || after == times.len() {
            return rows[after.min(times.len() - 1)];
        }
        let span_s = times[after].t_s - times[after - 1].t_s;
        let share = (wanted_s - times[after - 1].t_s) / span_s;
        [0, 1].map(|c| rows[after - 1][c] * (1.0 - share) + rows[after][c] * share)
    }

    fn moment(&self, robot: &Robot, i: usize, loss_w: Sides<f64>) -> Moment {
        let row = &self.drives.rows[i];
        let rims = if row.stands() { Sides::both(0.0) } else { row.rim_mps };
        Moment {
            motion: Motion::of_wheels(robot, rims).heading(self.heading_rad[i]),
            acceleration: row.acceleration(robot),
            rim_mps2: row.rim_mps2,
            attitude: Attitude { pitch_rad: row.pitch_rad, roll_rad: row.roll_rad },
            loss_w,
        }
    }
}

/// What the channels show of one row.
fn seen_w(
    robot: &Robot,
    surface: &model::robot::Surface,
    row: &Row,
    mut moment: Moment,
    acting: &[&Applied],
    form: PowerForm,
) -> [f64; 2] {
    for applied in acting {
        applied.mechanism.measure(&applied.values, &mut moment);
    }
    let mut adjustment = robot.adjustment(surface, &moment);
    for applied in acting {
        adjustment = adjustment.and(applied.mechanism.adjust(robot, &applied.values, &moment));
    }
    let shape = FrictionShape::new(robot, surface.slip_angle_scale_rad, &moment.motion);
    let manoeuvre = Manoeuvre::adjusted(
        robot,
        &Friction::new(robot, surface),
        moment.motion,
        &shape,
        row.motor_c,
        &adjustment,
    );
    let power = manoeuvre.power_accelerating(moment.attitude, moment.acceleration);
    calibration::power::seen_w(robot, form, row, &power).map(|true_w| {
        acting.iter().fold(true_w, |w, applied| applied.mechanism.reading_w(&applied.values, w))
    })
}

/// Headings by row: recorded, or from the yaw rate or the wheels, beginning at 0.
fn headings(recording: &Recording, drives: &Drives) -> Vec<f64> {
    if let Some(recorded) = recording.channel(Channel::Heading) {
        return recorded.to_vec();
    }
    let mut headings = vec![f64::NAN; drives.rows.len()];
    let (mut heading_rad, mut run) = (0.0, usize::MAX);
    for stretch in &drives.stretches {
        if stretch.run != run {
            heading_rad = 0.0;
        }
        run = stretch.run;
        for i in stretch.rows.clone() {
            let row = &drives.rows[i];
            if row.yaw_rate_radps.is_finite() {
                heading_rad += row.yaw_rate_radps * row.step_s;
            }
            headings[i] = heading_rad;
        }
    }
    headings
}
