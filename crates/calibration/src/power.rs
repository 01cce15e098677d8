//! What the robot's force balance says of recorded drives.

use std::cell::RefCell;

use model::{Attitude, FrictionShape, Manoeuvre, Motion, Power, Robot, Sides};
use recording::PowerForm;

use crate::{Drives, Error, drives::Row};

/// Drives as the force balance sees them, prepared for being asked again and again with other coefficients.
pub struct PowerModel<'a> {
    drives: &'a Drives,
    /// Surface of each row, an index into the drives' surfaces.
    surface: Vec<u32>,
    /// Shares of the weight across and along the heading, by row.
    grade: Vec<[f64; 2]>,
    /// Friction shapes of the last slip-angle scales asked for.
    shapes: RefCell<Vec<(Vec<f64>, Vec<FrictionShape>)>>,
}

/// Shapes that are kept: those of the point at hand and those beside it.
const KEPT_SHAPES: usize = 2;

impl<'a> PowerModel<'a> {
    /// Prepares drives.
    pub fn new(drives: &'a Drives) -> Self {
        let mut surface = vec![0; drives.rows.len()];
        for stretch in &drives.stretches {
            surface[stretch.rows.clone()].fill(stretch.surface as u32);
        }
        let grade = |row: &Row| {
            let attitude = Attitude { pitch_rad: row.pitch_rad, roll_rad: row.roll_rad };
            [attitude.weight_normal(), attitude.weight_along()]
        };
        PowerModel {
            drives,
            surface,
            grade: drives.rows.iter().map(grade).collect(),
            shapes: RefCell::default(),
        }
    }

    /// Power of every row, reduced to what is wanted of it.
    ///
    /// # Errors
    /// [`Error::UnknownSurface`] where the robot lacks a surface that was driven on.
    pub fn by_row<T>(&self, robot: &Robot, wanted: impl Fn(&Row, &Power) -> T) -> Result<Vec<T>, Error> {
        let surfaces = self
            .drives
            .surfaces
            .iter()
            .enumerate()
            .map(|(i, name)| robot.surface(name).map_err(|_| self.unknown_surface(robot, i)))
            .collect::<Result<Vec<_>, Error>>()?;
        let scales_rad = surfaces.iter().map(|surface| surface.slip_angle_scale_rad).collect();
        self.prepare_shapes(robot, scales_rad);
        let kept = self.shapes.borrow();
        let Some((_, shapes)) = kept.first() else { return Ok(Vec::new()) };
        let power = |(i, row): (usize, &Row)| {
            let surface = surfaces[self.surface[i] as usize];
            let manoeuvre = Manoeuvre::of_shape(robot, surface, motion(robot, row), &shapes[i], row.motor_c);
            let [normal, along] = self.grade[i];
            wanted(row, &manoeuvre.power_on_grade(normal, along, row.acceleration(robot.slip_track_m)))
        };
        Ok(self.drives.rows.iter().enumerate().map(power).collect())
    }

    /// Brings the shapes of these scales to the front of those kept.
    fn prepare_shapes(&self, robot: &Robot, scales_rad: Vec<f64>) {
        let mut kept = self.shapes.borrow_mut();
        if let Some(place) = kept.iter().position(|(known, _)| *known == scales_rad) {
            kept.swap(0, place);
            return;
        }
        let shape = |(row, surface): (&Row, &u32)| {
            FrictionShape::new(robot, scales_rad[*surface as usize], &motion(robot, row))
        };
        let shapes = self.drives.rows.iter().zip(&self.surface).map(shape).collect();
        kept.insert(0, (scales_rad, shapes));
        kept.truncate(KEPT_SHAPES);
    }

    fn unknown_surface(&self, robot: &Robot, surface: usize) -> Error {
        let drives = self.drives;
        let place = drives.stretches.iter().find(|stretch| stretch.surface == surface);
        let first_row =
            |run: usize| drives.stretches.iter().find(|s| s.run == run).map_or(0, |s| s.rows.start);
        Error::UnknownSurface {
            run: place.map(|s| drives.runs[s.run].clone()).unwrap_or_default(),
            row: place.map_or(1, |s| s.rows.start - first_row(s.run) + 1),
            surface: drives.surfaces[surface].clone(),
            known: robot.surfaces.keys().cloned().collect(),
        }
    }
}

/// Encoders dither about zero while a robot stands; rolling resistance would follow them.
fn motion(robot: &Robot, row: &Row) -> Motion {
    Motion::of_wheels(robot, if row.stands() { Sides::both(0.0) } else { row.rim_mps })
}

/// What a recording of a form would show of a power: left and right, or battery alone (the second value is then 0) \[W\].
pub fn seen_w(robot: &Robot, form: PowerForm, row: &Row, power: &Power) -> [f64; 2] {
    match form {
        PowerForm::Sides | PowerForm::MotorCurrents => {
            let electronics_w = if row.stands() { 0.0 } else { robot.drive_electronics_w };
            [power.side_w.left + electronics_w, power.side_w.right + electronics_w]
        }
        PowerForm::Battery | PowerForm::CurrentAndVoltage => [power.bus_w, 0.0],
    }
}
