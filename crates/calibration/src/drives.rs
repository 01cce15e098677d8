//! A recording made ready for fitting: stretches without gaps, accelerations, one-second averages.

use std::ops::Range;

use model::{Acceleration, Robot, Sides};
use recording::{Channel, PowerForm, Recording};

use crate::{Error, stuck};

/// Length of the averages that are fitted and judged \[s\]: longer than the delay between a motor's driver and an encoder
/// (0.1-0.2 s on a Husky), shorter than a manoeuvre.
pub const AVERAGE_S: f64 = 1.0;

/// Rim speeds below this are standstill \[m/s\]: half of a Husky A200's encoder step of 0.008 m/s.
pub const STANDSTILL_MPS: f64 = 0.004;

/// The inputs of one row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time \[s\].
    pub t_s: f64,
    /// Time since the row before, 0 at the start of a stretch \[s\].
    pub step_s: f64,
    /// Rim speeds \[m/s\].
    pub rim_mps: Sides<f64>,
    /// Their rates of change, by central differences \[m/s²\].
    pub rim_mps2: Sides<f64>,
    /// Measured yaw rate; NaN where there is none \[rad/s\].
    pub yaw_rate_radps: f64,
    /// Pitch, 0 where the recording has no such channel \[rad\].
    pub pitch_rad: f64,
    /// Roll, 0 where the recording has no such channel \[rad\].
    pub roll_rad: f64,
    /// Motor temperatures \[°C\]; the robot's reference where the recording has none.
    pub motor_c: Sides<f64>,
    /// Enters averages: everything needed is there and the wheels hold the ground.
    pub used: bool,
    /// The wheels turn against each other and the robot does not (`stuck`).
    pub stuck: bool,
}

impl Row {
    /// v: mean of the rim speeds \[m/s\].
    pub fn speed_mps(&self) -> f64 {
        self.rim_mps.sum() / 2.0
    }

    /// u_right − u_left \[m/s\].
    pub fn difference_mps(&self) -> f64 {
        self.rim_mps.right - self.rim_mps.left
    }

    /// dv/dt and dω/dt of a robot whose wheels move so.
    pub fn acceleration(&self, slip_track_m: f64) -> Acceleration {
        Acceleration {
            forward_mps2: self.rim_mps2.sum() / 2.0,
            yaw_radps2: (self.rim_mps2.right - self.rim_mps2.left) / slip_track_m,
        }
    }

    /// Both sides stand.
    pub fn stands(&self) -> bool {
        self.rim_mps.left.abs() < STANDSTILL_MPS && self.rim_mps.right.abs() < STANDSTILL_MPS
    }
}

/// Rows of one run on one surface without a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Which run, an index into [`Drives::runs`].
    pub run: usize,
    /// Which surface, an index into [`Drives::surfaces`].
    pub surface: usize,
    /// Its rows.
    pub rows: Range<usize>,
}

/// About a second of one stretch: what is fitted and judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Average {
    /// Which run.
    pub run: usize,
    /// Which surface.
    pub surface: usize,
    /// Its rows, of which the used ones count.
    pub rows: Range<usize>,
    /// How many are used; at least one.
    pub used: usize,
    /// Time that they stand for \[s\].
    pub duration_s: f64,
    /// Beginning of the second \[s\].
    pub t_s: f64,
}

/// A recording made ready for fitting.
#[derive(Clone, Debug, Default)]
pub struct Drives {
    /// Names of the runs.
    pub runs: Vec<String>,
    /// Names of the surfaces.
    pub surfaces: Vec<String>,
    /// In what form power was recorded.
    pub form: Option<PowerForm>,
    /// Inputs by row.
    pub rows: Vec<Row>,
    /// What was recorded, by row: left and right, or one column of battery power; NaN is a gap.
    pub recorded: Vec<Vec<f64>>,
    /// Stretches in order of rows.
    pub stretches: Vec<Stretch>,
    /// Averages in order of rows.
    pub averages: Vec<Average>,
}

impl Drives {
    /// Prepares a recording. Rows without wheel speeds end a stretch, as do gaps and changes of the surface; ground that
    /// names no surface is the robot's default one. Runs whose recorded rows repeat another run's are left out.
    ///
    /// # Errors
    /// [`Error::NothingToFit`] where no row is left that could be judged.
    pub fn new(robot: &Robot, recording: &Recording) -> Result<Self, Error> {
        let form = recording.power_form().ok_or(Error::NothingToFit { reason: "it tells no power" })?;
        let recorded = recorded(recording, form);
        let mut drives = Drives {
            runs: recording.runs.iter().map(|run| run.name.clone()).collect(),
            form: Some(form),
            rows: inputs(robot, recording, &recorded),
            recorded,
            ..Drives::default()
        };
        let copies = copies(recording);
        for (run, rows) in recording.runs.iter().enumerate().map(|(i, run)| (i, run.rows.clone())) {
            if !copies.contains(&run) {
                drives.split(robot, recording, run, rows);
            }
        }
        for stretch in &drives.stretches {
            accelerations(&mut drives.rows[stretch.rows.clone()]);
        }
        stuck::flag(&mut drives, robot);
        drives.average();
        if drives.averages.is_empty() {
            return Err(Error::NothingToFit {
                reason: "no second of it has speeds and power of wheels that hold the ground",
            });
        }
        Ok(drives)
    }

    /// Cuts one run where it pauses or the surface changes.
    fn split(&mut self, robot: &Robot, recording: &Recording, run: usize, rows: Range<usize>) {
        let gap_s = recording.runs[run].gap_s;
        let mut open: Option<Stretch> = None;
        for row in rows {
            let here = self.rows[row];
            if !(here.rim_mps.left.is_finite() && here.rim_mps.right.is_finite()) {
                self.stretches.extend(open.take());
                continue;
            }
            let label = recording.surface.as_ref().and_then(|labels| labels.get(row));
            let surface = self.surface_index(label.unwrap_or(&robot.default_surface));
            if let Some(stretch) = open.as_mut() {
                let step_s = here.t_s - self.rows[row - 1].t_s;
                if step_s <= gap_s && stretch.surface == surface {
                    self.rows[row].step_s = step_s;
                    stretch.rows.end = row + 1;
                    continue;
                }
                self.stretches.extend(open.take());
            }
            open = Some(Stretch { run, surface, rows: row..row + 1 });
        }
        self.stretches.extend(open);
    }

    fn surface_index(&mut self, name: &str) -> usize {
        self.surfaces.iter().position(|known| known == name).unwrap_or_else(|| {
            self.surfaces.push(name.to_owned());
            self.surfaces.len() - 1
        })
    }

    /// Renews the averages after rows were marked.
    pub(crate) fn average(&mut self) {
        self.averages.clear();
        for stretch in &self.stretches {
            let rhythm_s = rhythm_s(&self.rows[stretch.rows.clone()]);
            let second = |row: usize| ((self.rows[row].t_s + 1e-6) / AVERAGE_S).floor();
            let mut start = stretch.rows.start;
            while start < stretch.rows.end {
                let t_s = second(start);
                let end = (start..stretch.rows.end).find(|&r| second(r) != t_s).unwrap_or(stretch.rows.end);
                let used = self.rows[start..end].iter().filter(|row| row.used && !row.stuck).count();
                if used > 0 {
                    self.averages.push(Average {
                        run: stretch.run,
                        surface: stretch.surface,
                        rows: start..end,
                        used,
                        duration_s: used as f64 * rhythm_s,
                        t_s: t_s * AVERAGE_S,
                    });
                }
                start = end;
            }
        }
    }

    /// The stretches that satisfy a condition, with their rows and averages.
    pub fn select(&self, keep: impl Fn(&Stretch) -> bool) -> Drives {
        self.only(self.stretches.iter().filter(|stretch| keep(stretch)).cloned())
    }

    /// About so many rows at most, in pieces spread evenly over all stretches.
    pub fn thinned(&self, most_rows: usize) -> Drives {
        /// Long enough that the cuts between pieces do not matter, short enough to meet every manoeuvre.
        const PIECE_ROWS: usize = 512;
        let every = self.rows.len().div_ceil(most_rows.max(1)).max(1);
        let pieces = self.stretches.iter().flat_map(|stretch| {
            stretch.rows.clone().step_by(PIECE_ROWS).map(|start| {
                let rows = start..(start + PIECE_ROWS).min(stretch.rows.end);
                Stretch { rows, ..stretch.clone() }
            })
        });
        self.only(pieces.step_by(every))
    }

    fn only(&self, stretches: impl Iterator<Item = Stretch>) -> Drives {
        let mut part = Drives {
            runs: self.runs.clone(),
            surfaces: self.surfaces.clone(),
            form: self.form,
            recorded: vec![Vec::new(); self.recorded.len()],
            ..Drives::default()
        };
        for stretch in stretches {
            let start = part.rows.len();
            part.rows.extend_from_slice(&self.rows[stretch.rows.clone()]);
            for (to, from) in part.recorded.iter_mut().zip(&self.recorded) {
                to.extend_from_slice(&from[stretch.rows.clone()]);
            }
            part.stretches.push(Stretch { rows: start..part.rows.len(), ..stretch });
        }
        part.average();
        part
    }

    /// The same drives with stuck rows counted like any other.
    #[must_use]
    pub fn including_stuck(mut self) -> Drives {
        self.rows.iter_mut().for_each(|row| row.stuck = false);
        self.average();
        self
    }

    /// The drives on one surface.
    pub fn on_surface(&self, surface: usize) -> Drives {
        self.select(|stretch| stretch.surface == surface)
    }

    /// Averages of a quantity by row.
    pub fn averaged(&self, by_row: &[f64]) -> Vec<f64> {
        self.averaged_by(|row| by_row[row])
    }

    /// Averages of a function of the row.
    pub fn averaged_by(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let mean = |average: &Average| {
            let used = average.rows.clone().filter(|&row| self.rows[row].used && !self.rows[row].stuck);
            used.map(&value).sum::<f64>() / average.used as f64
        };
        self.averages.iter().map(mean).collect()
    }

    /// Averages of what was recorded, column behind column.
    pub fn recorded_averages(&self) -> Vec<f64> {
        self.recorded.iter().flat_map(|column| self.averaged(column)).collect()
    }

    /// The runs that have averages, in order of their names.
    pub fn judged_runs(&self) -> Vec<usize> {
        let mut runs: Vec<usize> = self.averages.iter().map(|average| average.run).collect();
        runs.sort_unstable();
        runs.dedup();
        runs.sort_by(|a, b| self.runs[*a].cmp(&self.runs[*b]));
        runs
    }
}

fn recorded(recording: &Recording, form: PowerForm) -> Vec<Vec<f64>> {
    let column = |channel| recording.channel(channel).map(<[f64]>::to_vec).unwrap_or_default();
    match form {
        PowerForm::Sides => vec![column(Channel::LeftPower), column(Channel::RightPower)],
        PowerForm::Battery => vec![column(Channel::Power)],
        PowerForm::CurrentAndVoltage => {
            let (amperes, volts) = (column(Channel::Current), column(Channel::Voltage));
            vec![amperes.iter().zip(&volts).map(|(i, v)| i * v).collect()]
        }
        // Many drivers report no sign, so none is relied on.
        PowerForm::MotorCurrents => [Channel::LeftMotorCurrent, Channel::RightMotorCurrent]
            .map(|channel| column(channel).into_iter().map(f64::abs).collect())
            .to_vec(),
    }
}

fn inputs(robot: &Robot, recording: &Recording, recorded: &[Vec<f64>]) -> Vec<Row> {
    let channel = |channel| recording.channel(channel);
    let at = |values: Option<&[f64]>, row: usize, absent: f64| values.map_or(absent, |v| v[row]);
    let (left, right) = (channel(Channel::LeftSpeed), channel(Channel::RightSpeed));
    let (yaw, pitch, roll) = (channel(Channel::YawRate), channel(Channel::Pitch), channel(Channel::Roll));
    let warm = (channel(Channel::LeftMotorTemperature), channel(Channel::RightMotorTemperature));
    let reference_c = robot.motors.reference_temperature_c;
    let row = |i: usize| {
        let rim_mps = Sides { left: at(left, i, f64::NAN), right: at(right, i, f64::NAN) };
        let (pitch_rad, roll_rad) = (at(pitch, i, 0.0), at(roll, i, 0.0));
        let motor_c = Sides { left: at(warm.0, i, reference_c), right: at(warm.1, i, reference_c) };
        let whole = recorded.iter().all(|column| column[i].is_finite())
            && [rim_mps.left, rim_mps.right, pitch_rad, roll_rad].iter().all(|x| x.is_finite());
        let or = |x: f64, other: f64| if x.is_finite() { x } else { other };
        Row {
            t_s: recording.t_s[i],
            rim_mps,
            yaw_rate_radps: at(yaw, i, f64::NAN),
            pitch_rad: or(pitch_rad, 0.0),
            roll_rad: or(roll_rad, 0.0),
            motor_c: motor_c.map(|c| or(c, reference_c)),
            used: whole,
            ..Row::default()
        }
    };
    (0..recording.rows()).map(row).collect()
}

/// Runs whose wheel speeds and power repeat those of a longer or earlier run from its first row on.
fn copies(recording: &Recording) -> Vec<usize> {
    let channels = [
        Channel::LeftSpeed,
        Channel::RightSpeed,
        Channel::LeftMotorCurrent,
        Channel::Power,
        Channel::LeftPower,
    ];
    let columns: Vec<&[f64]> = channels.iter().filter_map(|channel| recording.channel(*channel)).collect();
    let same = |a: usize, b: usize, count: usize| {
        columns.iter().all(|column| (0..count).all(|i| column[a + i].to_bits() == column[b + i].to_bits()))
    };
    let repeats = |(i, run): &(usize, &recording::Run)| {
        recording.runs.iter().enumerate().any(|(j, other)| {
            let longer = (other.rows.len(), *i) > (run.rows.len(), j);
            longer
                && run.rows.len() >= LEAST_COPY_ROWS
                && same(run.rows.start, other.rows.start, run.rows.len())
        })
    };
    recording.runs.iter().enumerate().filter(repeats).map(|(i, _)| i).collect()
}

/// Fewer equal rows may be chance, such as two runs that begin at standstill.
const LEAST_COPY_ROWS: usize = 20;

fn accelerations(rows: &mut [Row]) {
    let last = rows.len() - 1;
    for i in 0..rows.len() {
        let (before, after) = (rows[i.saturating_sub(1)], rows[(i + 1).min(last)]);
        let span_s = after.t_s - before.t_s;
        if span_s > 0.0 {
            rows[i].rim_mps2 = after.rim_mps.zip(before.rim_mps).map(|(b, a)| (b - a) / span_s);
        }
    }
}

/// The mean step of a stretch \[s\]; a second for a lone row.
fn rhythm_s(rows: &[Row]) -> f64 {
    match rows {
        [first, .., last] => (last.t_s - first.t_s) / (rows.len() - 1) as f64,
        _ => AVERAGE_S,
    }
}
