//! What the robot's force balance says of recorded drives.

use std::cell::RefCell;

use model::{
    Friction, FrictionShape, Grade, Manoeuvre, Motion, Power, Robot, ShapeLaw,
    mechanism::{Adjustment, Moment},
    robot::Surface,
};
use rayon::prelude::*;
use recording::PowerForm;

use crate::{Drives, Error, average::Average, row::Row, watch::ROWS_A_LOOK};

/// Drives as the force balance sees them, prepared for being asked again and again with other coefficients.
pub struct PowerModel<'a> {
    drives: &'a Drives,
    surface: Vec<u32>,
    /// How the ground carries the weight, by row.
    grade: Vec<Grade<f64>>,
    /// Friction shapes of the last slip-angle scales asked for.
    shapes: RefCell<Vec<Shapes>>,
}

/// The friction shape of every row for slip-angle scales by surface.
#[derive(Clone)]
struct Shapes {
    scales_rad: Vec<f64>,
    by_row: Vec<FrictionShape>,
}

/// Averages between two looks at the watch: some milliseconds, at ten rows each.
const AVERAGES_A_LOOK: usize = 256;

/// Shapes that are kept: those of the point at hand and those on both sides of it.
const KEPT_SHAPES: usize = 3;

impl<'a> PowerModel<'a> {
    /// Prepares drives.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the drives' watch breaks.
    pub fn new(drives: &'a Drives) -> Result<Self, Error> {
        let grade =
            drives.watch.map(drives.rows.len(), ROWS_A_LOOK, |i| drives.rows[i].attitude().grade())?;
        Ok(PowerModel { drives, surface: surface_of_rows(drives), grade, shapes: RefCell::default() })
    }

    /// One-second averages of what is wanted of the power of each row.
    ///
    /// # Errors
    /// [`Error::UnknownSurface`] where the robot lacks a surface that was driven on, [`Error::Stopped`] when the drives' watch breaks.
    pub fn averages<const N: usize>(
        &self,
        robot: &Robot,
        wanted: impl Fn(&Row, &Power) -> [f64; N] + Sync,
    ) -> Result<Vec<[f64; N]>, Error> {
        self.drives.go_on()?;
        let ground = self.prepare(robot)?;
        let kept = self.shapes.borrow();
        let shapes: &[FrictionShape] = kept.first().map_or(&[], |shapes| &shapes.by_row);
        let (drives, grade) = (self.drives, &self.grade);
        let mean = |number: usize| {
            let average: &Average = &drives.averages[number];
            let ground = &ground[average.surface];
            drives.mean(average, |i| {
                let row = &drives.rows[i];
                wanted(row, &power(robot, ground, row, row.motion(robot), &shapes[i], grade[i]))
            })
        };
        drives.watch.map(drives.averages.len(), AVERAGES_A_LOOK, mean)
    }

    /// Friction on each surface; the shapes of its slip-angle scales come to the front of those kept.
    fn prepare<'r>(&self, robot: &'r Robot) -> Result<Vec<Ground<'r>>, Error> {
        let ground = ground(self.drives, robot)?;
        let scales_rad = ground.iter().map(|ground| ground.surface.slip_angle_scale_rad).collect();
        self.prepare_shapes(robot, scales_rad)?;
        Ok(ground)
    }

    /// Brings the shapes of these scales to the front of those kept. Only surfaces whose scale is another are worked out anew.
    fn prepare_shapes(&self, robot: &Robot, scales_rad: Vec<f64>) -> Result<(), Error> {
        let mut kept = self.shapes.borrow_mut();
        if let Some(place) = kept.iter().position(|shapes| shapes.scales_rad == scales_rad) {
            kept[..=place].rotate_right(1);
            return Ok(());
        }
        let mut shapes = match kept.first() {
            Some(_) if kept.len() == KEPT_SHAPES => kept.remove(KEPT_SHAPES - 1),
            Some(first) => first.clone(),
            None => Shapes {
                scales_rad: vec![f64::NAN; scales_rad.len()],
                by_row: vec![FrictionShape::default(); self.drives.rows.len()],
            },
        };
        let (rows, surface, known) = (&self.drives.rows, &self.surface, &shapes.scales_rad);
        let laws: Vec<ShapeLaw> =
            scales_rad.iter().map(|scale_rad| ShapeLaw::new(robot, *scale_rad)).collect();
        let watch = &self.drives.watch;
        shapes.by_row.par_chunks_mut(ROWS_A_LOOK).enumerate().try_for_each(|(piece, shapes)| {
            watch.go_on()?;
            for (i, shape) in (piece * ROWS_A_LOOK..).zip(shapes) {
                let at = surface[i] as usize;
                if known[at] != scales_rad[at] {
                    *shape = laws[at].shape(&rows[i].motion(robot));
                }
            }
            Ok::<_, Error>(())
        })?;
        shapes.scales_rad = scales_rad;
        kept.insert(0, shapes);
        Ok(())
    }
}

/// Power of every row, reduced to what is wanted of the row at an index; for asking once.
///
/// # Errors
/// [`Error::UnknownSurface`] where the robot lacks a surface that was driven on, [`Error::Stopped`] when the drives' watch breaks.
pub fn by_row<T: Send>(
    drives: &Drives,
    robot: &Robot,
    wanted: impl Fn(usize, &Power) -> T + Sync,
) -> Result<Vec<T>, Error> {
    let ground = ground(drives, robot)?;
    let surface = surface_of_rows(drives);
    drives.watch.map(drives.rows.len(), ROWS_A_LOOK, |i| {
        wanted(i, &ground[surface[i] as usize].power(robot, &drives.rows[i]))
    })
}

/// The same for two values of each row, as two columns.
///
/// # Errors
/// As [`by_row`].
pub(crate) fn columns_by_row(
    drives: &Drives,
    robot: &Robot,
    wanted: impl Fn(usize, &Power) -> (f64, f64) + Sync,
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    Ok(by_row(drives, robot, wanted)?.into_iter().unzip())
}

/// Surface of each row, an index into the drives' surfaces.
fn surface_of_rows(drives: &Drives) -> Vec<u32> {
    let mut surface = vec![0; drives.rows.len()];
    for stretch in &drives.stretches {
        surface[stretch.rows.clone()].fill(stretch.surface as u32);
    }
    surface
}

/// Ground as a robot feels it.
pub(crate) struct Ground<'r> {
    surface: &'r Surface,
    friction: Friction,
    shapes: ShapeLaw,
    /// The height of its load, or mechanisms of the robot or of this ground, act.
    adjusted: bool,
}

impl<'r> Ground<'r> {
    pub(crate) fn new(robot: &Robot, surface: &'r Surface) -> Self {
        Ground {
            surface,
            friction: Friction::new(robot, surface),
            shapes: ShapeLaw::new(robot, surface.slip_angle_scale_rad),
            adjusted: robot.is_adjusted(surface),
        }
    }

    /// Power of one row.
    pub(crate) fn power(&self, robot: &Robot, row: &Row) -> Power {
        let motion = row.motion(robot);
        power(robot, self, row, motion, &self.shapes.shape(&motion), row.attitude().grade())
    }
}

/// Each surface of the drives.
fn ground<'r>(drives: &Drives, robot: &'r Robot) -> Result<Vec<Ground<'r>>, Error> {
    let of = |(i, name): (usize, &String)| {
        let surface = robot.surface(name).map_err(|_| unknown_surface(drives, robot, i))?;
        Ok(Ground::new(robot, surface))
    };
    drives.surfaces.iter().enumerate().map(of).collect()
}

fn unknown_surface(drives: &Drives, robot: &Robot, surface: usize) -> Error {
    let place = drives.stretches.iter().find(|stretch| stretch.surface == surface);
    let first_row = |run: usize| drives.stretches.iter().find(|s| s.run == run).map_or(0, |s| s.rows.start);
    Error::UnknownSurface {
        run: place.map(|s| drives.runs[s.run].clone()).unwrap_or_default(),
        row: place.map_or(1, |s| s.rows.start - first_row(s.run) + 1),
        surface: drives.surfaces[surface].clone(),
        known: robot.surfaces.keys().cloned().collect(),
    }
}

/// The power of one row, by the model's one function.
#[inline]
fn power(
    robot: &Robot,
    ground: &Ground<'_>,
    row: &Row,
    motion: Motion,
    shape: &FrictionShape,
    grade: Grade<f64>,
) -> Power {
    let acceleration = row.acceleration(robot);
    let adjustment = if ground.adjusted {
        let attitude = row.attitude();
        let (rim_mps2, loss_w) = (row.rim_mps2, row.loss_w);
        let moment =
            Moment { motion: motion.heading(row.heading_rad), acceleration, rim_mps2, attitude, loss_w };
        robot.adjustment(ground.surface, &moment)
    } else {
        Adjustment::default()
    };
    let manoeuvre = Manoeuvre::adjusted(robot, &ground.friction, motion, shape, row.motor_c, &adjustment);
    manoeuvre.power_on_grade(grade, acceleration)
}

/// What a recording of a form would show of a power: left and right, or battery alone (the second value is then 0) \[W\].
#[inline]
pub fn seen_w(robot: &Robot, form: PowerForm, row: &Row, power: &Power) -> [f64; 2] {
    match form {
        PowerForm::Sides | PowerForm::MotorCurrents => {
            let electronics_w = if row.stands() { 0.0 } else { robot.drive_electronics_w };
            [power.side_w.left + electronics_w, power.side_w.right + electronics_w]
        }
        PowerForm::Battery | PowerForm::CurrentAndVoltage => [power.bus_w, 0.0],
    }
}
