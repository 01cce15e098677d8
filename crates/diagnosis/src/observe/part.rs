//! Drives of one kind, row by row: those under suspicion, or healthy ones.

mod predict;

use calibration::{Drives, DrivesCoverage, average};
use model::{Grade, Robot, Sides};
use rayon::prelude::*;
use recording::{Channel, PowerForm, Recording, Watch};

use crate::{
    Error,
    observe::{
        average::Meter,
        average::{Average, Input},
        climb::Climb,
        ground,
        kept::Kept,
        kept::Shapes,
        sag::{Sag, Source},
        sample::Sample,
    },
};

/// Drives of one kind.
pub(crate) struct Part {
    pub(crate) drives: Drives,
    pub(crate) suspect: bool,
    /// By row [rad].
    pub(crate) heading_rad: Vec<f64>,
    /// By row: cosine and sine of the heading.
    towards: Vec<[f64; 2]>,
    /// By row [m].
    position_m: Vec<[f64; 2]>,
    /// By row: since the robot last stood still [s].
    moving_s: Vec<f64>,
    /// By row: beginning of the run [s].
    began_s: Vec<f64>,
    /// What the battery gave beyond both sides, by average; NaN where it was not recorded [W].
    rest_w: Vec<f64>,
    /// Speed over ground by average; NaN where no positions were recorded [m/s].
    ground_mps: Vec<f64>,
    /// Yaw rate by average; NaN where no gyroscope was recorded [rad/s].
    yaw_rate_radps: Vec<f64>,
    /// Voltages, where they were recorded.
    sag: Option<Sag>,
    /// How voltages follow currents, where drives tell it.
    source: Option<Source>,
    /// What an ampere of each side's motor counts as, where motor currents were recorded [W/A].
    pub(crate) watts_per_a: Option<Sides<f64>>,
    /// Climbs, where heights were recorded.
    climb: Option<Climb>,
    /// How the ground carries the weight, by row.
    grade: Vec<Grade<f64>>,
    shapes: Shapes,
    /// What the last robots would have shown on which nothing acts.
    with_nothing: Kept<(Robot, Vec<Meter>), Vec<f64>>,
    /// Which stretches are compared.
    pub(crate) sample: Sample,
    /// What of the recording is compared, and why the rest is not.
    pub(crate) coverage: DrivesCoverage,
}

/// What would be recorded of one row: power of both sides, or of the battery and nothing; what the battery gives beyond [W];
/// velocity over ground along the axes that headings count from [m/s]; yaw rate [rad/s]; current by the power that was recorded, as
/// mechanisms have it read [A]; rate of climbing [m/s].
pub(crate) type Seen = [f64; 8];

/// Time that an average stands for at least \[s\]: a row that is left of a second, as where a drive ends, is as noisy as rows are, and would
/// count for as much as a second does.
const LEAST_S: f64 = 0.15;

impl Part {
    pub(crate) fn new(
        robot: &Robot,
        recording: &Recording,
        suspect: bool,
        watch: &Watch,
    ) -> Result<Self, Error> {
        // Being stuck is a mechanism's business here.
        let mut drives = Drives::watched(robot, recording, watch)?.including_stuck();
        drives.averages.retain(|average| average.duration_s >= LEAST_S);
        let sample = Sample::of(&mut drives);
        let coverage = DrivesCoverage::of(recording, &drives);
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
        let position_m = ground::positions_m(recording);
        let grade = drives.rows.par_iter().map(|row| row.attitude().grade()).collect();
        let shapes = Shapes::default();
        let towards = heading_rad.iter().map(|heading_rad| [heading_rad.cos(), heading_rad.sin()]).collect();
        Ok(Part {
            heading_rad,
            towards,
            position_m,
            moving_s: moving_s(&drives),
            began_s,
            rest_w,
            ground_mps,
            yaw_rate_radps,
            sag: Sag::of(recording, &drives),
            source: None,
            watts_per_a: None,
            climb: Climb::of(recording, &drives),
            grade,
            shapes,
            with_nothing: Kept::default(),
            sample,
            coverage,
            drives,
            suspect,
        })
    }

    /// How voltages follow currents in these drives.
    pub(crate) fn source(&self) -> Option<Source> {
        let sag = self.sag.as_ref()?;
        Source::of(sag, &self.drives.averaged_by(|row| sag.current_a(row, |w| w)))
    }

    /// Lets voltages follow currents so.
    pub(crate) fn set_source(&mut self, source: Option<Source>) {
        self.source = source;
    }

    /// Whether enough of a quantity was recorded to be compared with: half of the drives.
    pub(crate) fn tells(&self, meter: Meter) -> bool {
        // Of a climb only its end counts.
        meter == Meter::Climb && self.climb.is_some()
            || 2 * self.recorded(meter).len() >= self.drives.averages.len()
    }

    /// What was recorded, average by average, where it was.
    pub(crate) fn recorded(&self, meter: Meter) -> Vec<f64> {
        let known = |values: &[f64]| values.iter().copied().filter(|x| x.is_finite()).collect();
        match meter {
            Meter::Left | Meter::Battery => self.drives.averaged_by(|row| self.recorded_w(0, row)),
            Meter::Right => self.drives.averaged_by(|row| self.recorded_w(1, row)),
            Meter::Rest => known(&self.rest_w),
            Meter::Ground => known(&self.ground_mps),
            Meter::Yaw => known(&self.yaw_rate_radps),
            Meter::Sag => known(self.beyond_v()),
            Meter::Climb => known(self.risen_m()),
        }
    }

    /// Power of a channel as it was recorded, or what its motor current counts as [W].
    pub(crate) fn recorded_w(&self, channel: usize, row: usize) -> f64 {
        let value = self.drives.recorded[channel][row];
        // Currents come without a sign.
        self.watts_per_a
            .map_or(value, |per_a| value.abs() * if channel == 0 { per_a.left } else { per_a.right })
    }

    /// Climbs by heights, average by average; NaN where none ends [m].
    fn risen_m(&self) -> &[f64] {
        self.climb.as_ref().map_or(&[], Climb::risen_m)
    }

    /// Voltages, average by average, where there are any that tell something [V].
    fn beyond_v(&self) -> &[f64] {
        match (&self.sag, self.source) {
            (Some(sag), Some(_)) => sag.beyond_v(),
            _ => &[],
        }
    }

    /// Voltages by currents, average by average [V].
    fn sagging_v(&self, current_a: &[f64]) -> Vec<f64> {
        let Some((sag, source)) = self.sag.as_ref().zip(self.source) else { return Vec::new() };
        sag.beyond_a(current_a).iter().map(|a| -source.resistance_ohm * a).collect()
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
            Meter::Sag => of(self.beyond_v()),
            Meter::Climb => of(self.risen_m()),
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
                Meter::Sag => self.sagging_v(&of(&|mean| mean[6])),
                Meter::Climb => {
                    self.climb.as_ref().map_or(Vec::new(), |climb| climb.summed(&of(&|mean| mean[7])))
                }
            };
            self.told(*meter, &all)
        };
        meters.iter().flat_map(averages).collect()
    }

    /// What the averages of a quantity are of; drives count from `first_run`.
    pub(crate) fn averages(&self, meter: Meter, first_run: usize) -> Vec<Average> {
        let rows = &self.drives.rows;
        let mean = |value: &(dyn Fn(usize) -> f64 + Sync)| self.drives.averaged_by(value);
        let speed_mps = mean(&|i| rows[i].speed_mps());
        let difference_mps = mean(&|i| rows[i].difference_mps());
        let pitch_rad = mean(&|i| rows[i].pitch_rad);
        let roll_rad = mean(&|i| rows[i].roll_rad);
        let accel_mps2 = mean(&|i| rows[i].rim_mps2.sum() / 2.0);
        let towards = [0, 1].map(|axis| mean(&|i| self.towards[i][axis]));
        let position_m = [0, 1].map(|axis| mean(&|i| self.position_m[i][axis]));
        let moving_s = mean(&|i| self.moving_s[i]);
        let of = |(i, average): (usize, &average::Average)| Average {
            channel: meter.channel(),
            run: first_run + average.run,
            suspect: self.suspect,
            t_s: average.t_s - self.began_s[average.rows.start],
            input: Input {
                speed_mps: speed_mps[i],
                difference_mps: difference_mps[i],
                pitch_rad: pitch_rad[i],
                roll_rad: roll_rad[i],
                accel_mps2: accel_mps2[i],
                heading_rad: towards[1][i].atan2(towards[0][i]),
                position_m: position_m.each_ref().map(|axis| axis[i]),
                moving_s: moving_s[i],
                nearness: 0.0,
            },
        };
        let all: Vec<Average> = self.drives.averages.iter().enumerate().map(of).collect();
        self.told(meter, &all)
    }
}

/// By row: time since the robot last stood still, as far as the stretch tells [s].
fn moving_s(drives: &Drives) -> Vec<f64> {
    let mut moving_s = vec![0.0; drives.rows.len()];
    for stretch in &drives.stretches {
        let mut since_s = 0.0;
        for i in stretch.rows.clone() {
            let row = &drives.rows[i];
            since_s = if row.stands() { 0.0 } else { since_s + row.step_s };
            moving_s[i] = since_s;
        }
    }
    moving_s
}
