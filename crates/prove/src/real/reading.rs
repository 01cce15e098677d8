//! Recorded currents beside what a fitted robot needs on the same rows, as forces and as power.

use calibration::{Drives, force_n_per_a, power::by_row, row::Row, signed_n_per_a};
use model::{PowerKernel, Robot, Sides};
use recording::{Channel, Recording};

use crate::Error;

/// Drives read with the eyes of a robot's file.
pub(crate) struct Reading {
    /// Rows and one-second averages.
    pub(crate) drives: Drives,
    /// Force that the robot needs, by row [N].
    pub(crate) needed_n: Vec<Sides<f64>>,
    /// Force that the recorded currents stand for, with the sign of the force needed, by row [N].
    pub(crate) recorded_n: Vec<Sides<f64>>,
    /// Newtons of an ampere, by side.
    pub(crate) per_a: Sides<f64>,
}

impl Reading {
    /// Reads the motor currents of a recording.
    ///
    /// # Errors
    /// Drives without currents, and a robot that does not say what an ampere stands for.
    pub(crate) fn new(robot: &Robot, recording: &Recording) -> Result<Self, Error> {
        let per_a = force_n_per_a(robot)?;
        let drives = Drives::new(robot, recording)?;
        let needed_n = by_row(&drives, robot, |_, power| power.force_n)?;
        let [left_a, right_a] = [Channel::LeftMotorCurrent, Channel::RightMotorCurrent]
            .map(|side| recording.channel(side).unwrap_or_default());
        let of = |i: usize| {
            let read_a = Sides { left: left_a.get(i), right: right_a.get(i) };
            let signed = signed_n_per_a(robot, per_a, &drives.rows[i], needed_n[i]);
            signed.zip(read_a).map(|(signed, read_a)| signed * read_a.map_or(f64::NAN, |a| a.abs()))
        };
        let recorded_n = (0..drives.rows.len()).map(of).collect();
        Ok(Reading { drives, needed_n, recorded_n, per_a })
    }

    /// Power of each side at forces of a row, by eq. 2 [W].
    fn power_w(robot: &Robot, row: &Row, force_n: Sides<f64>) -> Sides<f64> {
        PowerKernel::of_motors(robot, row.rim_mps, row.motor_c).side_w(force_n)
    }

    /// One-second averages of every meter: current of the left and of the right side \[A\], and yaw rate \[rad/s\].
    ///
    /// The yaw rate needed is that of the wheels over the slip track. What an ampere stands for follows recorded speeds, so that speeds that
    /// are off show in the yaw rate alone.
    pub(crate) fn averages(&self, robot: &Robot) -> [MeterAverages; METERS] {
        let of_row = |i: usize| {
            let row = &self.drives.rows[i];
            let [recorded_a, needed_a] =
                [self.recorded_n[i], self.needed_n[i]].map(|force_n| self.current_a(robot, row, force_n));
            let wheels_radps = row.difference_mps() / robot.slip_track_m;
            [
                recorded_a.left - needed_a.left,
                recorded_a.right - needed_a.right,
                row.yaw_rate_radps - wheels_radps,
                needed_a.left,
                needed_a.right,
                wheels_radps,
            ]
        };
        let means = self.drives.means(of_row);
        std::array::from_fn(|meter| MeterAverages {
            difference: means.iter().map(|mean| mean[meter]).collect(),
            needed: means.iter().map(|mean| mean[METERS + meter]).collect(),
        })
    }

    /// One-second averages of recorded and of needed power of both sides \[W\].
    pub(crate) fn powers_w(&self, robot: &Robot) -> Vec<[f64; 2]> {
        self.drives.means(|i| {
            let power_w = |force_n| Reading::power_w(robot, &self.drives.rows[i], force_n).sum();
            [power_w(self.recorded_n[i]), power_w(self.needed_n[i])]
        })
    }

    /// The unsigned current that a force of a row reads as \[A\].
    pub(crate) fn current_a(&self, robot: &Robot, row: &Row, force_n: Sides<f64>) -> Sides<f64> {
        let signed = signed_n_per_a(robot, self.per_a, row, force_n);
        force_n.zip(signed).map(|(force_n, per_a)| force_n / per_a)
    }
}

/// Meters whose averages are compared.
pub(crate) const METERS: usize = 3;

/// One-second averages of one meter, in the order of the drives' averages.
pub(crate) struct MeterAverages {
    /// Recorded less needed.
    pub(crate) difference: Vec<f64>,
    /// Needed.
    pub(crate) needed: Vec<f64>,
}
