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
    pub(crate) fn power_w(robot: &Robot, row: &Row, force_n: Sides<f64>) -> Sides<f64> {
        PowerKernel::of_motors(robot, row.rim_mps, row.motor_c).side_w(force_n)
    }

    /// One-second averages of recorded less needed power, and of needed power, by side [W].
    pub(crate) fn averages_w(&self, robot: &Robot) -> [SideAverages; 2] {
        let of_row = |i: usize| {
            let row = &self.drives.rows[i];
            let [recorded, needed] =
                [self.recorded_n[i], self.needed_n[i]].map(|force_n| Reading::power_w(robot, row, force_n));
            [recorded.left - needed.left, needed.left, recorded.right - needed.right, needed.right]
        };
        let means = self.drives.means(of_row);
        [0, 2].map(|side| SideAverages {
            difference_w: means.iter().map(|mean| mean[side]).collect(),
            needed_w: means.iter().map(|mean| mean[side + 1]).collect(),
        })
    }
}

/// One-second averages of one side, in the order of the drives' averages.
pub(crate) struct SideAverages {
    /// Recorded less needed power [W].
    pub(crate) difference_w: Vec<f64>,
    /// Needed power [W].
    pub(crate) needed_w: Vec<f64>,
}
