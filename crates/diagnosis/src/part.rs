//! Drives of one kind, row by row: those under suspicion, or healthy ones.

use std::sync::Arc;

use calibration::{Drives, average, drives::Stretch, losses, power::seen_w, row::Row};
use model::{
    Friction, FrictionShape, Grade, Manoeuvre, Motion, Robot, Sides, mechanism::Moment, robot::Surface,
};
use rayon::prelude::*;
use recording::{Channel, PowerForm, Recording, Watch};

use crate::{
    Error, ground,
    meter::Meter,
    series::{Applied, Average, Input},
    shapes::Shapes,
};

/// Drives of one kind.
pub(crate) struct Part {
    pub(crate) drives: Drives,
    pub(crate) suspect: bool,
    /// By row [rad].
    pub(crate) heading_rad: Vec<f64>,
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
    /// How the ground carries the weight, by row.
    grade: Vec<Grade<f64>>,
    shapes: Shapes,
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
        let grade = drives.rows.par_iter().map(|row| row.attitude().grade()).collect();
        let shapes = Shapes::default();
        Ok(Part {
            heading_rad,
            height_m,
            began_s,
            rest_w,
            ground_mps,
            yaw_rate_radps,
            grade,
            shapes,
            drives,
            suspect,
        })
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

    /// Averages of what would be recorded by row, quantity by quantity, where it was.
    pub(crate) fn averaged(&self, meters: &[Meter], rows: &[Seen]) -> Vec<f64> {
        let means = self.drives.means(|row| rows[row]);
        let of = |value: &dyn Fn(&Seen) -> f64| means.iter().map(value).collect::<Vec<f64>>();
        let averages = |meter: &Meter| {
            let all = match meter {
                Meter::Left | Meter::Battery => of(&|mean| mean[0]),
                Meter::Right => of(&|mean| mean[1]),
                Meter::Rest => of(&|mean| mean[2]),
                Meter::Ground => of(&|mean| mean[3].hypot(mean[4])),
                Meter::Yaw => of(&|mean| mean[5]),
            };
            self.told(*meter, &all)
        };
        meters.iter().flat_map(averages).collect()
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
            mean(&|i| rows[i].rim_mps2.right - rows[i].rim_mps2.left),
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
                swing_mps2: inputs[9][i],
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
        let memory_s = applied.iter().find_map(|a| a.mechanism.memory_s(&a.values));
        let loss_w = match memory_s {
            Some(memory_s) => losses::averaged(&self.drives, robot, memory_s),
            None => Vec::new(),
        };
        let delay_s: f64 = applied.iter().map(|a| a.mechanism.delay_s(&a.values)).sum();
        let phase = self.phases(applied);
        let phases = 1 + phase.iter().max().copied().unwrap_or(0);
        let changed: Vec<Option<Changed<'_>>> = (0..phases)
            .map(|which| phase.contains(&which).then(|| self.changed(robot, applied, which)).transpose())
            .collect::<Result<_, _>>()?;
        let mut seen = vec![Seen::default(); self.drives.rows.len()];
        for stretch in &self.drives.stretches {
            let name = &self.drives.surfaces[stretch.surface];
            let on: Vec<Option<On<'_>>> = changed
                .iter()
                .map(|changed| changed.as_ref().map(|changed| On::new(changed, name, meters)).transpose())
                .collect::<Result<_, _>>()?;
            let places = stretch.rows.clone();
            let rows = &mut seen[places.clone()];
            rows.par_iter_mut().zip(places).with_min_len(512).for_each(|(seen, i)| {
                let loss_w = loss_w.get(i).copied().unwrap_or(self.drives.rows[i].loss_w);
                if let Some(on) = &on[phase[i]] {
                    *seen = self.seen(on, i, loss_w);
                }
            });
            if delay_s != 0.0 {
                let rows = rows.to_vec();
                for (i, row) in stretch.rows.clone().enumerate() {
                    seen[row] = self.late(stretch, &rows, i, delay_s);
                }
            }
        }
        Ok(seen)
    }

    /// By row: which mechanisms act, as the bits of a number.
    fn phases(&self, applied: &[Applied]) -> Vec<usize> {
        let mut phase = vec![0; self.drives.rows.len()];
        for stretch in &self.drives.stretches {
            for i in stretch.rows.clone() {
                let t_s = self.drives.rows[i].t_s - self.began_s[i];
                let bit = |(j, a): (usize, &Applied)| usize::from(a.span.acts(stretch.run, t_s)) << j;
                phase[i] = applied.iter().enumerate().map(bit).sum();
            }
        }
        phase
    }

    /// The robot as the mechanisms of a phase make it.
    fn changed<'a>(&self, robot: &Robot, applied: &'a [Applied], phase: usize) -> Result<Changed<'a>, Error> {
        let acting: Vec<&Applied> =
            applied.iter().enumerate().filter(|(j, _)| phase >> j & 1 == 1).map(|(_, a)| a).collect();
        let mut robot = robot.clone();
        for one in &acting {
            robot = one.mechanism.robot(&robot, &one.values).unwrap_or(robot);
        }
        Ok(Changed { shapes: self.shapes_of(&robot)?, robot, acting })
    }

    /// Friction shapes of every row for a robot, kept from the last robots.
    fn shapes_of(&self, robot: &Robot) -> Result<Arc<Vec<FrictionShape>>, Error> {
        let scales_rad = self.drives.surfaces.iter().map(|name| match robot.surface(name) {
            Ok(surface) => Ok(surface.slip_angle_scale_rad),
            Err(_) => Err(Error::surface(name, robot)),
        });
        let scales_rad: Vec<f64> = scales_rad.collect::<Result<_, _>>()?;
        Ok(self.shapes.of(robot, scales_rad, |scales_rad| {
            let mut shapes = vec![FrictionShape::default(); self.drives.rows.len()];
            for stretch in &self.drives.stretches {
                let scale_rad = scales_rad[stretch.surface];
                let rows = &self.drives.rows[stretch.rows.clone()];
                let shape = |row: &Row| FrictionShape::new(robot, scale_rad, &row.motion(robot));
                let shapes = &mut shapes[stretch.rows.clone()];
                shapes.par_iter_mut().zip(rows).with_min_len(512).for_each(|(to, row)| *to = shape(row));
            }
            shapes
        }))
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

    /// What would be recorded of one row.
    #[inline]
    fn seen(&self, on: &On<'_>, i: usize, loss_w: Sides<f64>) -> Seen {
        let On { changed: Changed { robot, acting, shapes }, surface, friction, meters } = on;
        let row: &Row = &self.drives.rows[i];
        let driven = Moment {
            motion: row.motion(robot).heading(self.heading_rad[i]),
            acceleration: row.acceleration(robot),
            rim_mps2: row.rim_mps2,
            attitude: row.attitude(),
            loss_w,
        };
        let mut moment = driven;
        for applied in acting {
            applied.mechanism.measure(&applied.values, &mut moment);
        }
        let mut adjustment = robot.adjustment(surface, &moment);
        for applied in acting {
            adjustment = adjustment.and(applied.mechanism.adjust(robot, &applied.values, &moment));
        }
        // Few mechanisms change what the wheels or the ground were measured to do.
        let shape = if moment.motion == driven.motion {
            shapes[i]
        } else {
            FrictionShape::new(robot, surface.slip_angle_scale_rad, &moment.motion)
        };
        let grade = if moment.attitude == driven.attitude { self.grade[i] } else { moment.attitude.grade() };
        let manoeuvre = Manoeuvre::adjusted(robot, friction, moment.motion, &shape, row.motor_c, &adjustment);
        let power = manoeuvre.power_on_grade(grade, moment.acceleration);
        let read = |true_w: f64| acting.iter().fold(true_w, |w, a| a.mechanism.reading_w(&a.values, w));
        let sides_w = || seen_w(robot, PowerForm::Sides, row, &power).map(read);
        let battery_w = || read(seen_w(robot, PowerForm::Battery, row, &power)[0]);
        let [first_w, second_w] = match meters.first() {
            Some(Meter::Battery) => [battery_w(), 0.0],
            _ => sides_w(),
        };
        let rest_w = if meters.contains(&Meter::Rest) { battery_w() - first_w - second_w } else { 0.0 };
        let Motion { speed_mps, yaw_rate_radps, .. } = moment.motion;
        let [along_mps, across_mps] = if meters.contains(&Meter::Ground) {
            let (sin, cos) = self.heading_rad[i].sin_cos();
            [speed_mps * cos, speed_mps * sin]
        } else {
            [0.0; 2]
        };
        [first_w, second_w, rest_w, along_mps, across_mps, yaw_rate_radps]
    }
}

/// A robot as mechanisms make it.
struct Changed<'a> {
    robot: Robot,
    acting: Vec<&'a Applied>,
    /// By row of all drives.
    shapes: Arc<Vec<FrictionShape>>,
}

/// A robot on one surface, prepared for many rows.
struct On<'a> {
    changed: &'a Changed<'a>,
    surface: &'a Surface,
    friction: Friction,
    meters: &'a [Meter],
}

impl<'a> On<'a> {
    fn new(changed: &'a Changed<'a>, name: &str, meters: &'a [Meter]) -> Result<Self, Error> {
        let robot = &changed.robot;
        let surface = robot.surface(name).map_err(|_| Error::surface(name, robot))?;
        Ok(On { changed, surface, friction: Friction::new(robot, surface), meters })
    }
}
