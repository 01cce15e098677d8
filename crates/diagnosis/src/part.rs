//! Drives of one kind, row by row: those under suspicion, or healthy ones.

use calibration::{Drives, average, drives::Stretch, losses, power::seen_w, row::Row};
use model::{
    Attitude, Friction, FrictionShape, Manoeuvre, Motion, Robot, Sides, mechanism::Moment, robot::Surface,
};
use rayon::prelude::*;
use recording::{Channel, PowerForm, Recording, Watch};

use crate::{
    Error, ground,
    meter::Meter,
    series::{Applied, Average, Input},
};

/// Drives of one kind.
pub(crate) struct Part {
    pub(crate) drives: Drives,
    pub(crate) suspect: bool,
    /// By row [rad].
    heading_rad: Vec<f64>,
    /// By row, above the mean [m].
    height_m: Vec<f64>,
    /// By row: beginning of the run [s].
    began_s: Vec<f64>,
    /// What the battery gave beyond both sides, by average; NaN where it was not recorded [W].
    rest_w: Vec<f64>,
    /// Speed over ground by average; NaN where no positions were recorded [m/s].
    ground_mps: Vec<f64>,
    /// Yaw rate by average; NaN where no gyroscope was recorded [rad/s].
    yaw_rate_radps: Vec<f64>,
}

/// What would be recorded of one row: power of both sides, or of the battery and nothing; what the battery gives beyond [W];
/// velocity over ground along the axes that headings count from [m/s]; yaw rate [rad/s].
pub(crate) type Seen = [f64; 6];

impl Part {
    pub(crate) fn new(
        robot: &Robot,
        recording: &Recording,
        suspect: bool,
        watch: &Watch,
    ) -> Result<Self, Error> {
        // Being stuck is a mechanism's business here.
        let drives = Drives::watched(robot, recording, watch)?.including_stuck();
        let mut began_s = vec![0.0; recording.rows()];
        for run in &recording.runs {
            let first = run.rows.clone().next().map_or(0.0, |row| recording.t_s[row]);
            began_s[run.rows.clone()].fill(first);
        }
        let heading_rad = ground::headings(recording, &drives);
        let rest_w = match (drives.form, recording.channel(Channel::Power), &drives.recorded[..]) {
            (Some(PowerForm::Sides), Some(battery_w), [left_w, right_w]) => {
                drives.averaged_by(|i| battery_w[i] - left_w[i] - right_w[i])
            }
            _ => vec![f64::NAN; drives.averages.len()],
        };
        let mut ground_mps = ground::speeds_mps(robot, recording, &drives);
        for (speed_mps, average) in ground_mps.iter_mut().zip(&drives.averages) {
            // Without headings nothing tells how velocities add up.
            if average.rows.clone().any(|i| !heading_rad[i].is_finite()) {
                *speed_mps = f64::NAN;
            }
        }
        let yaw_rate_radps = match recording.channel(Channel::YawRate) {
            Some(yaw_rate_radps) => drives.averaged(yaw_rate_radps),
            None => vec![f64::NAN; drives.averages.len()],
        };
        let height_m = ground::heights_m(recording);
        Ok(Part { heading_rad, height_m, began_s, rest_w, ground_mps, yaw_rate_radps, drives, suspect })
    }

    /// Whether enough of a quantity was recorded to be compared with: half of the drives.
    pub(crate) fn tells(&self, meter: Meter) -> bool {
        2 * self.recorded(meter).len() >= self.drives.averages.len()
    }

    /// What was recorded, average by average, where it was.
    pub(crate) fn recorded(&self, meter: Meter) -> Vec<f64> {
        let known = |values: &[f64]| values.iter().copied().filter(|x| x.is_finite()).collect();
        match meter {
            Meter::Left | Meter::Battery => self.drives.averaged(&self.drives.recorded[0]),
            Meter::Right => self.drives.averaged(&self.drives.recorded[1]),
            Meter::Rest => known(&self.rest_w),
            Meter::Ground => known(&self.ground_mps),
            Meter::Yaw => known(&self.yaw_rate_radps),
        }
    }

    /// Those of one value for each average in which a quantity was recorded.
    fn told<T: Copy>(&self, meter: Meter, values: &[T]) -> Vec<T> {
        let of = |recorded: &[f64]| {
            values.iter().zip(recorded).filter(|(_, x)| x.is_finite()).map(|(value, _)| *value).collect()
        };
        match meter {
            Meter::Rest => of(&self.rest_w),
            Meter::Ground => of(&self.ground_mps),
            Meter::Yaw => of(&self.yaw_rate_radps),
            Meter::Left | Meter::Right | Meter::Battery => values.to_vec(),
        }
    }

    /// Averages of what would be recorded by row, where it was.
    pub(crate) fn averaged(&self, meter: Meter, rows: &[Seen]) -> Vec<f64> {
        let mean = |value: usize| self.drives.averaged_by(|row| rows[row][value]);
        let all = match meter {
            Meter::Left | Meter::Battery => mean(0),
            Meter::Right => mean(1),
            Meter::Rest => mean(2),
            Meter::Ground => mean(3).iter().zip(mean(4)).map(|(x, y)| x.hypot(y)).collect(),
            Meter::Yaw => mean(5),
        };
        self.told(meter, &all)
    }

    /// What the averages of a quantity are of; drives count from `first_run`.
    pub(crate) fn averages(&self, meter: Meter, first_run: usize) -> Vec<Average> {
        let rows = &self.drives.rows;
        let mean = |value: &(dyn Fn(usize) -> f64 + Sync)| self.drives.averaged_by(value);
        let inputs = [
            mean(&|i| rows[i].speed_mps()),
            mean(&|i| rows[i].difference_mps()),
            mean(&|i| match meter {
                Meter::Left => rows[i].rim_mps.left,
                Meter::Right => rows[i].rim_mps.right,
                _ => rows[i].speed_mps(),
            }),
            mean(&|i| rows[i].pitch_rad),
            mean(&|i| rows[i].roll_rad),
            mean(&|i| rows[i].rim_mps2.sum() / 2.0),
            mean(&|i| self.heading_rad[i].cos()),
            mean(&|i| self.heading_rad[i].sin()),
            mean(&|i| self.height_m[i]),
        ];
        let of = |(i, average): (usize, &average::Average)| Average {
            channel: meter.channel(),
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
                height_m: inputs[8][i],
            },
        };
        let all: Vec<Average> = self.drives.averages.iter().enumerate().map(of).collect();
        self.told(meter, &all)
    }

    /// What would be recorded, by row, as far as meters ask for it.
    pub(crate) fn predict(
        &self,
        robot: &Robot,
        applied: &[Applied],
        meters: &[Meter],
    ) -> Result<Vec<Seen>, Error> {
        self.drives.go_on()?;
        let mut changed = robot.clone();
        for applied in applied {
            changed = applied.mechanism.robot(&changed, &applied.values).unwrap_or(changed);
        }
        let memory_s = applied.iter().find_map(|a| a.mechanism.memory_s(&a.values));
        let loss_w = match memory_s {
            Some(memory_s) => losses::averaged(&self.drives, robot, memory_s),
            None => Vec::new(),
        };
        let mut seen = vec![Seen::default(); self.drives.rows.len()];
        for stretch in &self.drives.stretches {
            let name = &self.drives.surfaces[stretch.surface];
            let surface_of =
                |robot: &Robot| robot.surface(name).cloned().map_err(|_| Error::surface(name, robot));
            let (plain, other) = (surface_of(robot)?, surface_of(&changed)?);
            let rows: Vec<Seen> = stretch
                .rows
                .clone()
                .into_par_iter()
                .with_min_len(512)
                .map(|i| {
                    let t_s = self.drives.rows[i].t_s - self.began_s[i];
                    let acting: Vec<&Applied> = applied.iter().filter(|a| t_s >= a.from_s).collect();
                    let (robot, surface) =
                        if acting.is_empty() { (robot, &plain) } else { (&changed, &other) };
                    let loss_w = loss_w.get(i).copied().unwrap_or(self.drives.rows[i].loss_w);
                    self.seen(robot, surface, i, self.moment(robot, i, loss_w), &acting, meters)
                })
                .collect();
            let delay_s: f64 = applied.iter().map(|a| a.mechanism.delay_s(&a.values)).sum();
            for (i, row) in stretch.rows.clone().enumerate() {
                seen[row] = if delay_s == 0.0 { rows[i] } else { self.late(stretch, &rows, i, delay_s) };
            }
        }
        Ok(seen)
    }

    /// The row with the powers of so much earlier, between rows in proportion; the first or last where the stretch does not
    /// reach.
    fn late(&self, stretch: &Stretch, rows: &[Seen], i: usize, delay_s: f64) -> Seen {
        let times = &self.drives.rows[stretch.rows.clone()];
        let wanted_s = times[i].t_s - delay_s;
        let after = times.partition_point(|row| row.t_s < wanted_s);
        let last = times.len() - 1;
        let (from, to) = (after.saturating_sub(1).min(last), after.min(last));
        let span_s = times[to].t_s - times[from].t_s;
        let share = if after <= last && span_s > 0.0 { (wanted_s - times[from].t_s) / span_s } else { 0.0 };
        let mut late = rows[i];
        (0..3).for_each(|c| late[c] = rows[from][c] * (1.0 - share) + rows[to][c] * share);
        late
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

    /// What would be recorded of one row.
    fn seen(
        &self,
        robot: &Robot,
        surface: &Surface,
        i: usize,
        mut moment: Moment,
        acting: &[&Applied],
        meters: &[Meter],
    ) -> Seen {
        for applied in acting {
            applied.mechanism.measure(&applied.values, &mut moment);
        }
        let mut adjustment = robot.adjustment(surface, &moment);
        for applied in acting {
            adjustment = adjustment.and(applied.mechanism.adjust(robot, &applied.values, &moment));
        }
        let row: &Row = &self.drives.rows[i];
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
        let read = |true_w: f64| acting.iter().fold(true_w, |w, a| a.mechanism.reading_w(&a.values, w));
        let sides_w = || seen_w(robot, PowerForm::Sides, row, &power).map(read);
        let battery_w = || read(seen_w(robot, PowerForm::Battery, row, &power)[0]);
        let [first_w, second_w] = match meters.first() {
            Some(Meter::Battery) => [battery_w(), 0.0],
            _ => sides_w(),
        };
        let rest_w = if meters.contains(&Meter::Rest) { battery_w() - first_w - second_w } else { 0.0 };
        let (sin, cos) = self.heading_rad[i].sin_cos();
        let Motion { speed_mps, yaw_rate_radps, .. } = moment.motion;
        [first_w, second_w, rest_w, speed_mps * cos, speed_mps * sin, yaw_rate_radps]
    }
}
