//! What would be recorded of drives, row by row, of a robot on which mechanisms act.

use std::sync::Arc;

use calibration::{current_readings_a, drives::Stretch, losses, power::seen_w, row::Row};
use model::{
    Friction, FrictionShape, Manoeuvre, Motion, Robot, ShapeLaw, Sides,
    mechanism::{Adjustment, Moment},
    robot::Surface,
};
use rayon::prelude::*;
use recording::PowerForm;

use super::{Part, Seen};
use crate::{
    Error,
    observe::{average::Meter, kept::Key, span::Applied},
};

/// Rows between two looks at the watch: some milliseconds.
const ROWS_A_LOOK: usize = 2048;

impl Part {
    /// Averages of what would be recorded, quantity by quantity, where it was.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn predict_averages(
        &self,
        robot: &Robot,
        applied: &[Applied],
        meters: &[Meter],
    ) -> Result<Vec<f64>, Error> {
        let work_out = |robot: &Robot| Ok(self.averaged(meters, &self.predict(robot, applied, meters)?));
        if applied.is_empty() {
            // Healthy drives are the same whatever acts in the others.
            return Ok(self
                .with_nothing
                .of((robot.clone(), meters.to_vec()), |(robot, _)| work_out(robot))?
                .to_vec());
        }
        work_out(robot)
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
            Some(memory_s) => losses::averaged(&self.drives, robot, memory_s)?,
            None => Vec::new(),
        };
        let phase = self.phases(applied);
        let phases = 1 + phase.iter().max().copied().unwrap_or(0);
        let changed: Vec<Option<Changed<'_>>> = (0..phases)
            .map(|which| phase.contains(&which).then(|| self.changed(robot, applied, which)).transpose())
            .collect::<Result<_, _>>()?;
        let delay_s = |which: usize| {
            let own = applied.iter().enumerate().filter(|(j, _)| which >> j & 1 == 1);
            own.map(|(_, a)| a.mechanism.delay_s(&a.values)).sum::<f64>()
        };
        let delays_s: Vec<f64> = (0..phases).map(delay_s).collect();
        let mut seen = vec![Seen::default(); self.drives.rows.len()];
        for stretch in &self.drives.stretches {
            self.drives.go_on()?;
            let name = &self.drives.surfaces[stretch.surface];
            let on: Vec<Option<On<'_>>> = changed
                .iter()
                .map(|changed| changed.as_ref().map(|changed| On::new(changed, name, meters)).transpose())
                .collect::<Result<_, _>>()?;
            let places = stretch.rows.clone();
            let rows = &mut seen[places.clone()];
            rows.par_chunks_mut(ROWS_A_LOOK).enumerate().try_for_each(|(piece, rows)| {
                self.drives.go_on()?;
                for (i, seen) in (places.start + piece * ROWS_A_LOOK..).zip(rows) {
                    let loss_w = loss_w.get(i).copied().unwrap_or(self.drives.rows[i].loss_w);
                    if let Some(on) = on[phase[i]].as_ref().filter(|_| self.sample.needs(i)) {
                        *seen = self.seen(on, i, loss_w);
                    }
                }
                Ok::<_, Error>(())
            })?;
            if delays_s.iter().any(|delay_s| *delay_s != 0.0) {
                let rows = rows.to_vec();
                for (i, row) in stretch.rows.clone().enumerate() {
                    seen[row] = self.late(stretch, &rows, i, delays_s[phase[row]]);
                }
            }
        }
        Ok(seen)
    }

    /// What an ampere of each side's motor stands for on average in these drives, as a robot's model has them [W/A].
    ///
    /// # Errors
    /// A surface that the robot does not know; a robot that does not say how many newtons an ampere is.
    pub(crate) fn mean_watts_per_a(&self, robot: &Robot) -> Result<Sides<f64>, Error> {
        let mut sums = [Sides::both(0.0); 2];
        self.drives.go_on()?;
        for stretch in &self.drives.stretches {
            let name = &self.drives.surfaces[stretch.surface];
            let surface = robot.surface(name).map_err(|_| Error::surface(name, robot))?;
            let friction = Friction::new(robot, surface);
            let shapes = ShapeLaw::new(robot, surface.slip_angle_scale_rad);
            for row in &self.drives.rows[stretch.rows.clone()] {
                let motion = row.motion(robot);
                let manoeuvre = Manoeuvre::adjusted(
                    robot,
                    &friction,
                    motion,
                    &shapes.shape(&motion),
                    row.motor_c,
                    &Adjustment::default(),
                );
                let power = manoeuvre.power_on_grade(row.attitude().grade(), row.acceleration(robot));
                let read_a = current_readings_a(robot, row, &power)?;
                if !row.stands() && row.step_s > 0.0 {
                    sums[0] = sums[0].zip(power.side_w).map(|(sum, w)| sum + w.max(0.0));
                    sums[1] = sums[1].zip(read_a).map(|(sum, a)| sum + a);
                }
            }
        }
        Ok(sums[0].zip(sums[1]).map(|(w, a)| w / a.max(1e-9)))
    }

    /// By row: which mechanisms act, as the bits of a number.
    fn phases(&self, applied: &[Applied]) -> Vec<usize> {
        let mut phase = vec![0; self.drives.rows.len()];
        for stretch in &self.drives.stretches {
            for i in stretch.rows.clone() {
                let t_s = self.drives.rows[i].t_s - self.began_s[i];
                let acts = |a: &Applied| a.span.acts(stretch.run, t_s, self.position_m[i]);
                let bit = |(j, a): (usize, &Applied)| usize::from(acts(a)) << j;
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
        self.shapes.of(Key::of(robot, scales_rad), |key| {
            let mut shapes = vec![FrictionShape::default(); self.drives.rows.len()];
            for stretch in &self.drives.stretches {
                let law = ShapeLaw::new(robot, key.scales_rad[stretch.surface]);
                let rows = &self.drives.rows[stretch.rows.clone()];
                let shape = |row: &Row| law.shape(&row.motion(robot));
                let shapes = &mut shapes[stretch.rows.clone()];
                let pieces = shapes.par_chunks_mut(ROWS_A_LOOK).zip(rows.par_chunks(ROWS_A_LOOK));
                pieces.enumerate().try_for_each(|(piece, (shapes, rows))| {
                    self.drives.go_on()?;
                    let first = stretch.rows.start + piece * ROWS_A_LOOK;
                    let needed =
                        shapes.iter_mut().zip(rows).enumerate().filter(|(i, _)| self.sample.needs(first + i));
                    needed.for_each(|(_, (to, row))| *to = shape(row));
                    Ok::<_, Error>(())
                })?;
            }
            Ok(shapes)
        })
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
        let read_battery =
            |true_w: f64| acting.iter().fold(true_w, |w, a| a.mechanism.battery_reading_w(&a.values, w));
        let sides_w = || match self.watts_per_a {
            // Drives by motor currents know how many newtons an ampere is.
            Some(watts_per_a) => {
                let read_a = current_readings_a(robot, row, &power).unwrap_or_default();
                let Sides { left, right } = read_a.zip(watts_per_a).map(|(a, w)| read(a * w));
                [left, right]
            }
            None => seen_w(robot, PowerForm::Sides, row, &power).map(read),
        };
        let battery_w = || read_battery(seen_w(robot, PowerForm::Battery, row, &power)[0]);
        let [first_w, second_w] = match meters.first() {
            Some(Meter::Battery) => [battery_w(), 0.0],
            _ => sides_w(),
        };
        let rest_w = if meters.contains(&Meter::Rest) { battery_w() - first_w - second_w } else { 0.0 };
        let Motion { speed_mps, yaw_rate_radps, .. } = moment.motion;
        let [along_mps, across_mps] = if meters.contains(&Meter::Ground) {
            self.towards[i].map(|share| speed_mps * share)
        } else {
            [0.0; 2]
        };
        let current_a = match (&self.sag, meters.contains(&Meter::Sag)) {
            (Some(sag), true) => sag.current_a(i, read_battery),
            _ => 0.0,
        };
        [
            first_w,
            second_w,
            rest_w,
            along_mps,
            across_mps,
            yaw_rate_radps,
            current_a,
            speed_mps * moment.attitude.weight_along(),
        ]
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
