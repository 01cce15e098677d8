//! What an unsigned motor current reads while a robot drives.

use std::{cell::RefCell, rc::Rc};

use model::{Robot, Sides, rolling, skid};

use crate::{
    Drives, Error,
    lag::{self, ATTITUDE_TIME_S},
    row::Row,
    slip_law,
};

/// The numbers that decide the current of both sides.
///
/// Forces stand in amperes, as the recording has them: c amperes are worth `force_n_per_a` newtons at the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentParameters {
    /// i0: rolling resistance and no-load current of a side, mean of both \[A\].
    pub rolling_a: f64,
    /// D: half of what the right side rolls harder than the left \[A\].
    pub split_a: f64,
    /// S: full skid moment over the track, per side \[A\].
    pub skid_a: f64,
    /// α_s: scale of the slip angle \[rad\].
    pub slip_angle_scale_rad: f64,
    /// C: shape of the slip law \[-\].
    pub slip_shape: f64,
    /// G: current of a side that holds the robot on a vertical wall, m g / 2 c \[A\].
    pub lifting_a: f64,
    /// J: current of a side per forward acceleration \[A s²/m\].
    pub inertia_a_per_mps2: f64,
    /// J_ω: current of a side per change of u_r − u_l \[A s²/m\].
    pub turning_inertia_a_per_mps2: f64,
    /// λ: relaxation length of the tyres \[m\].
    pub relaxation_length_m: f64,
    /// h: height of the centre of mass, which shifts load when the robot rolls \[m\].
    pub load_height_m: f64,
    /// ε: how much larger the right wheels are than the encoders believe \[-\].
    pub wheel_mismatch: f64,
    /// d: current that pulls both sides forward \[A\].
    pub offset_a: f64,
}

/// How many numbers [`CurrentParameters`] holds.
pub const COUNT: usize = 12;

impl CurrentParameters {
    /// The numbers in the order of the fields.
    pub fn to_array(self) -> [f64; COUNT] {
        [
            self.rolling_a,
            self.split_a,
            self.skid_a,
            self.slip_angle_scale_rad,
            self.slip_shape,
            self.lifting_a,
            self.inertia_a_per_mps2,
            self.turning_inertia_a_per_mps2,
            self.relaxation_length_m,
            self.load_height_m,
            self.wheel_mismatch,
            self.offset_a,
        ]
    }

    /// The fields from numbers in their order.
    pub fn from_array(p: [f64; COUNT]) -> Self {
        CurrentParameters {
            rolling_a: p[0],
            split_a: p[1],
            skid_a: p[2],
            slip_angle_scale_rad: p[3],
            slip_shape: p[4],
            lifting_a: p[5],
            inertia_a_per_mps2: p[6],
            turning_inertia_a_per_mps2: p[7],
            relaxation_length_m: p[8],
            load_height_m: p[9],
            wheel_mismatch: p[10],
            offset_a: p[11],
        }
    }
}

/// Where the yaw rate of the robot is taken from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum YawSource {
    /// The wheels, over the slip track.
    #[default]
    Wheels,
    /// The gyroscope, where it measured; needed where wheels spin and the robot does not follow.
    Gyroscope,
}

/// Turning rate over which the skid moment turns round with the robot \[rad/s\]: a third of what one encoder step of a Husky
/// (0.008 m/s) is worth. The gyroscope's own offset asks for more.
const TURNAROUND_RADPS: [f64; 2] = [0.003, 0.02];

/// The current that drivers of unsigned current read.
///
/// ```text
/// X_left  = (i0 − D) s_l N_l − M' N_l − J_ω d(u_r − u_l)/dt + G sin p̂ + J dv/dt + d
/// X_right = (i0 + D) s_r N_r + M' N_r + J_ω d(u_r − u_l)/dt + G sin p̂ + J dv/dt + d
/// reading = |X| where the motor drives, |X| / k2² where the ground drives it, the idle reading at standstill
/// M       = S σ(α) tanh(ω/ω0), relaxed over λ;   ω = (u_r − u_l + ε v) / b
/// N       = 1 ∓ 2 h tan(roll) / b_0,   p̂ = pitch less the attitude filter's mistake
/// ```
///
/// s direction of rolling, σ the [`slip_law`] averaged over the wheels as [`skid`] does, b slip track, b_0 track. The physics
/// is that of the robot's force balance; what is added belongs to the measurement or is too fine for a planner.
/// 1/k2²: a gear that needs k2 to drive gives back 1/k2, and the same force is read as 1/k2² of the current.
pub struct CurrentModel<'a> {
    robot: &'a Robot,
    drives: &'a Drives,
    slip_track_m: f64,
    yaw: YawSource,
    /// Current read while both sides stand \[A\].
    idle_a: f64,
    /// tan(roll) 2 / track by row.
    load_shift_per_m: Vec<f64>,
    /// sin of the pitch without the filter's mistake, by row.
    weight_along: Vec<f64>,
    /// M/S by the three numbers that enter it: it costs the most.
    quasi_static: Kept<3>,
    /// M'/S by these and the relaxation length.
    mobilized: Kept<4>,
}

/// What was worked out last for some of the numbers, by row.
struct Kept<const N: usize>(RefCell<Vec<Point<N>>>);

/// Numbers, and what was worked out for them.
type Point<const N: usize> = ([f64; N], Rc<[f64]>);

/// Points that are kept: that at hand, and those on both sides of it along two numbers, in the order in which derivatives are taken.
const KEPT_POINTS: usize = 5;

impl<const N: usize> Kept<N> {
    fn new() -> Self {
        Kept(RefCell::new(Vec::new()))
    }

    /// What is kept of a point, or is now worked out.
    fn at(
        &self,
        point: [f64; N],
        work_out: impl FnOnce() -> Result<Vec<f64>, Error>,
    ) -> Result<Rc<[f64]>, Error> {
        let known = self.0.borrow().iter().position(|(known, _)| *known == point);
        let values = match known {
            Some(place) => self.0.borrow_mut().remove(place).1,
            None => work_out()?.into(),
        };
        let mut kept = self.0.borrow_mut();
        kept.truncate(KEPT_POINTS - 1);
        kept.insert(0, (point, Rc::clone(&values)));
        Ok(values)
    }
}

impl<'a> CurrentModel<'a> {
    /// Prepares the inputs of drives.
    pub fn new(robot: &'a Robot, drives: &'a Drives, slip_track_m: f64, yaw: YawSource, idle_a: f64) -> Self {
        let mut tilt_rad = vec![0.0; drives.rows.len()];
        // Where no pitch was recorded, no filter can have been mistaken about it.
        if drives.rows.iter().any(|row| row.pitch_rad != 0.0) {
            for stretch in &drives.stretches {
                let rows = stretch.rows.clone();
                tilt_rad[rows.clone()]
                    .copy_from_slice(&lag::tilt_error_rad(&drives.rows[rows], ATTITUDE_TIME_S));
            }
        }
        let load_shift_per_m =
            drives.rows.iter().map(|row| 2.0 * row.roll_rad.tan() / robot.track_m).collect();
        let weight_along = drives
            .rows
            .iter()
            .zip(tilt_rad)
            .map(|(row, error_rad)| (row.pitch_rad - error_rad).sin())
            .collect();
        CurrentModel {
            robot,
            drives,
            slip_track_m,
            yaw,
            idle_a,
            load_shift_per_m,
            weight_along,
            quasi_static: Kept::new(),
            mobilized: Kept::new(),
        }
    }

    /// One-second averages of the reading, left side behind right side.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the drives' watch breaks.
    pub fn averages_a(&self, parameters: &CurrentParameters) -> Result<Vec<f64>, Error> {
        let readings = self.readings_a(parameters)?;
        let left = self.drives.averaged_by(|row| readings[row].left);
        let right = self.drives.averaged_by(|row| readings[row].right);
        Ok([left, right].concat())
    }

    /// The reading of every row \[A\].
    ///
    /// # Errors
    /// [`Error::Stopped`] when the drives' watch breaks.
    pub fn readings_a(&self, parameters: &CurrentParameters) -> Result<Vec<Sides<f64>>, Error> {
        let mobilized = self.mobilized(parameters)?;
        let efficiency = self.robot.motor_sides().map(|motor| motor.k2.powi(-2));
        let reading = |(i, row): (usize, &Row)| {
            if row.stands() {
                return Sides::both(self.idle_a);
            }
            let wheel = self.wheel_a(parameters, i, row, parameters.skid_a * mobilized[i]);
            wheel.zip(row.rim_mps).zip(efficiency).map(|((wheel_a, rim_mps), efficiency)| {
                wheel_a.abs() * if wheel_a * rim_mps >= 0.0 { 1.0 } else { efficiency }
            })
        };
        let rows = &self.drives.rows;
        let mut readings = Vec::with_capacity(rows.len());
        for piece in self.drives.watch.pieces(0..rows.len()) {
            readings.extend(piece?.map(|i| reading((i, &rows[i]))));
        }
        Ok(readings)
    }

    /// X: what the wheels of each side ask for, with its sign \[A\].
    fn wheel_a(&self, p: &CurrentParameters, i: usize, row: &Row, skid_a: f64) -> Sides<f64> {
        let shift = p.load_height_m * self.load_shift_per_m[i];
        let turning_a = p.turning_inertia_a_per_mps2 * (row.rim_mps2.right - row.rim_mps2.left);
        let common_a =
            p.lifting_a * self.weight_along[i] + p.inertia_a_per_mps2 * row.rim_mps2.sum() / 2.0 + p.offset_a;
        let rolling = row.rim_mps.map(rolling::direction);
        Sides {
            left: ((p.rolling_a - p.split_a) * rolling.left - skid_a) * (1.0 - shift) - turning_a + common_a,
            right: ((p.rolling_a + p.split_a) * rolling.right + skid_a) * (1.0 + shift)
                + turning_a
                + common_a,
        }
    }

    /// M'/S by row.
    fn mobilized(&self, p: &CurrentParameters) -> Result<Rc<[f64]>, Error> {
        let [scale, shape, length, mismatch] =
            [p.slip_angle_scale_rad, p.slip_shape, p.relaxation_length_m, p.wheel_mismatch];
        let rows = &self.drives.rows;
        self.mobilized.at([scale, shape, length, mismatch], || {
            let steady = self.quasi_static.at([scale, shape, mismatch], || {
                let mut moments = Vec::with_capacity(rows.len());
                for piece in self.drives.watch.pieces(0..rows.len()) {
                    moments.extend(rows[piece?].iter().map(|row| self.quasi_static(p, row)));
                }
                Ok(moments)
            })?;
            let mut values = steady.to_vec();
            for stretch in &self.drives.stretches {
                let part = stretch.rows.clone();
                lag::relax(&mut values[part.clone()], &rows[part], length);
            }
            Ok(values)
        })
    }

    /// M/S: share of the full skid moment, with the sign of the turn.
    fn quasi_static(&self, p: &CurrentParameters, row: &Row) -> f64 {
        let speed_mps = row.speed_mps();
        let by_wheels = (row.difference_mps() + p.wheel_mismatch * speed_mps) / self.slip_track_m;
        let (yaw_rate_radps, turnaround_radps) = match self.yaw {
            YawSource::Gyroscope if row.yaw_rate_radps.is_finite() => {
                (row.yaw_rate_radps, TURNAROUND_RADPS[1])
            }
            _ => (by_wheels, TURNAROUND_RADPS[0]),
        };
        let law = |angle_rad| slip_law::peaked(angle_rad, p.slip_angle_scale_rad, p.slip_shape);
        let arm_m = skid::mobilized_arm_m(self.robot, speed_mps, yaw_rate_radps, law);
        2.0 * arm_m / self.robot.wheelbase_m * (yaw_rate_radps / turnaround_radps).tanh()
    }
}

/// The median reading of rows in which both sides stand \[A\]; 0 where the robot never stands.
pub fn idle_a(drives: &Drives) -> f64 {
    let standing = (0..drives.rows.len()).filter(|&i| drives.rows[i].used && drives.rows[i].stands());
    let mut readings: Vec<f64> =
        standing.flat_map(|i| drives.recorded.iter().map(move |column| column[i].abs())).collect();
    if readings.is_empty() {
        return 0.0;
    }
    let middle = readings.len() / 2;
    *readings.select_nth_unstable_by(middle, f64::total_cmp).1
}
