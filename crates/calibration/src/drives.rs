//! A recording made ready for fitting: stretches without gaps, accelerations, one-second averages.

use std::ops::Range;

use model::{Robot, Sides};
use rayon::prelude::*;
use recording::{Channel, PowerForm, Recording, Watch};

use crate::{
    Error,
    average::Average,
    copies::copies,
    losses,
    meter::{Laid, Placement, best_placement, laid},
    row,
    row::Row,
    slopes, standstill, stuck,
    watch::Watched,
};

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
    /// What the readings of a power meter tell that is slower than the wheels; `None` where power has the rhythm of the rows.
    pub placement: Option<Placement>,
    /// Asked before every pass over the rows.
    pub(crate) watch: Watched,
}

impl Drives {
    /// Prepares a recording. Rows without wheel speeds end a stretch, as do gaps and changes of the surface; ground that
    /// names no surface is the robot's default one. Runs whose recorded rows repeat another run's are left out.
    ///
    /// # Errors
    /// [`Error::NothingToFit`] where no row is left that could be judged.
    pub fn new(robot: &Robot, recording: &Recording) -> Result<Self, Error> {
        Drives::prepared(robot, recording, Watched::default())
    }

    /// Prepares a recording as [`Drives::new`] does, followed by a watch: it, and all that is computed from these drives, ends soon
    /// after the watch breaks.
    ///
    /// # Errors
    /// As [`Drives::new`], and [`Error::Stopped`] when the watch breaks.
    pub fn watched(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Self, Error> {
        Drives::prepared(robot, recording, Watched::by(watch))
    }

    fn prepared(robot: &Robot, recording: &Recording, watch: Watched) -> Result<Self, Error> {
        watch.go_on()?;
        let form = recording.power_form().ok_or(Error::NothingToFit { reason: "it tells no power" })?;
        let recorded = recorded(recording, form);
        if recording.reading_ends.is_empty() {
            return Drives::laid(robot, recording, (form, Laid { recorded, windows: Vec::new() }), watch);
        }
        let usual = laid(recording, recorded.clone(), Placement::default());
        let mut drives = Drives::laid(robot, recording, (form, usual), watch)?;
        let best = best_placement(robot, recording, &recorded, &drives)?;
        if best != Placement::default() {
            let watch = drives.watch;
            drives = Drives::laid(robot, recording, (form, laid(recording, recorded, best)), watch)?;
        }
        drives.placement = Some(best);
        Ok(drives)
    }

    fn laid(
        robot: &Robot,
        recording: &Recording,
        (form, laid): (PowerForm, Laid),
        watch: Watched,
    ) -> Result<Self, Error> {
        let Laid { recorded, windows } = laid;
        let mut drives = Drives {
            runs: recording.runs.iter().map(|run| run.name.clone()).collect(),
            form: Some(form),
            rows: row::inputs(robot, recording, &recorded, &watch)?,
            recorded,
            watch,
            ..Drives::default()
        };
        drives.rows.iter_mut().zip(windows).for_each(|(row, window)| row.window = window);
        let copies = copies(recording, &drives.watch)?;
        for (run, rows) in recording.runs.iter().enumerate().map(|(i, run)| (i, run.rows.clone())) {
            drives.watch.go_on()?;
            if !copies.contains(&run) {
                drives.split(robot, recording, run, rows);
            }
        }
        standstill::settle(&mut drives)?;
        drives.slopes_by_heights(robot, recording)?;
        drives.watch.go_on()?;
        drives.each_stretch(row::accelerations);
        stuck::flag(&mut drives, robot)?;
        drives.remember_losses(robot)?;
        drives.watch.go_on()?;
        drives.average();
        if drives.averages.is_empty() {
            return Err(Error::NothingToFit {
                reason: "no second of it has speeds and power of wheels that hold the ground",
            });
        }
        Ok(drives)
    }

    /// Fills in slopes where none were recorded and heights were.
    fn slopes_by_heights(&mut self, robot: &Robot, recording: &Recording) -> Result<(), Error> {
        let Some(heights_m) = recording.channel(Channel::Z) else { return Ok(()) };
        if recording.channel(Channel::Pitch).is_some() {
            return Ok(());
        }
        for stretch in &self.stretches {
            let rows = stretch.rows.clone();
            slopes::fill(robot, &mut self.rows[rows.clone()], &heights_m[rows], &self.watch)?;
        }
        Ok(())
    }

    /// Fills in what the robot's own `motor_heating` asks for.
    fn remember_losses(&mut self, robot: &Robot) -> Result<(), Error> {
        let memory_s = robot.mechanisms.iter().find_map(|known| known.mechanism().memory_s(known.values()));
        let Some(memory_s) = memory_s else { return Ok(()) };
        let averaged = losses::averaged(self, robot, memory_s)?;
        self.rows.iter_mut().zip(averaged).for_each(|(row, loss_w)| row.loss_w = loss_w);
        Ok(())
    }

    /// Cuts one run where it pauses or the surface changes.
    fn split(&mut self, robot: &Robot, recording: &Recording, run: usize, rows: Range<usize>) {
        let of_run = &recording.runs[run];
        let mut open: Option<Stretch> = None;
        let mut ground: Option<(&str, usize)> = None;
        for row in rows {
            let Row { t_s, rim_mps, .. } = self.rows[row];
            if !(rim_mps.left.is_finite() && rim_mps.right.is_finite()) {
                self.stretches.extend(open.take());
                continue;
            }
            let label = recording.surface.as_ref().and_then(|labels| labels.get(row));
            let name = label.unwrap_or(&robot.default_surface);
            let surface = match ground {
                Some((known, surface)) if known == name => surface,
                _ => self.surface_index(name),
            };
            ground = Some((name, surface));
            if let Some(stretch) = open.as_mut() {
                if recording.step_s(of_run, row - 1).is_some() && stretch.surface == surface {
                    self.rows[row].step_s = t_s - self.rows[row - 1].t_s;
                    stretch.rows.end = row + 1;
                    continue;
                }
                self.stretches.extend(open.take());
            }
            open = Some(Stretch { run, surface, rows: row..row + 1 });
        }
        self.stretches.extend(open);
    }

    /// Changes the rows of every stretch, stretches side by side.
    pub(crate) fn each_stretch(&mut self, change: impl Fn(&mut [Row]) + Send + Sync) {
        let mut rest = self.rows.as_mut_slice();
        let mut at = 0;
        let mut pieces = Vec::with_capacity(self.stretches.len());
        for stretch in &self.stretches {
            let (rows, after) =
                std::mem::take(&mut rest)[stretch.rows.start - at..].split_at_mut(stretch.rows.len());
            pieces.push(rows);
            (rest, at) = (after, stretch.rows.end);
        }
        pieces.into_par_iter().for_each(change);
    }

    fn surface_index(&mut self, name: &str) -> usize {
        self.surfaces.iter().position(|known| known == name).unwrap_or_else(|| {
            self.surfaces.push(name.to_owned());
            self.surfaces.len() - 1
        })
    }

    /// The stretches that satisfy a condition, with their rows and averages.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the drives' watch breaks.
    pub fn select(&self, keep: impl Fn(&Stretch) -> bool) -> Result<Drives, Error> {
        self.only(self.stretches.iter().filter(|stretch| keep(stretch)).cloned())
    }

    /// About so many rows at most, in pieces spread evenly over all stretches.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the drives' watch breaks.
    pub fn thinned(&self, most_rows: usize) -> Result<Drives, Error> {
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

    fn only(&self, stretches: impl Iterator<Item = Stretch>) -> Result<Drives, Error> {
        let mut part = Drives {
            runs: self.runs.clone(),
            surfaces: self.surfaces.clone(),
            form: self.form,
            placement: self.placement,
            recorded: vec![Vec::new(); self.recorded.len()],
            watch: self.watch.clone(),
            ..Drives::default()
        };
        for stretch in stretches {
            let start = part.rows.len();
            for piece in self.watch.pieces(stretch.rows.clone()) {
                let piece = piece?;
                part.rows.extend_from_slice(&self.rows[piece.clone()]);
                for (to, from) in part.recorded.iter_mut().zip(&self.recorded) {
                    to.extend_from_slice(&from[piece.clone()]);
                }
            }
            part.stretches.push(Stretch { rows: start..part.rows.len(), ..stretch });
        }
        part.average();
        Ok(part)
    }

    /// The same drives with rows counted whose slopes are missing, as on level ground.
    #[must_use]
    pub fn including_level(mut self) -> Drives {
        if self.rows.par_iter().any(|row| row.level) {
            self.rows.par_iter_mut().for_each(|row| row.used |= row.level);
            self.average();
        }
        self
    }

    /// The same drives with stuck rows counted like any other.
    #[must_use]
    pub fn including_stuck(mut self) -> Drives {
        if self.rows.par_iter().any(|row| row.stuck) {
            self.rows.par_iter_mut().for_each(|row| row.stuck = false);
            self.average();
        }
        self
    }

    /// Lowest and highest temperature of each motor \[°C\]; infinite where no row is used.
    pub fn motor_range_c(&self) -> Sides<[f64; 2]> {
        let of = |side: fn(&Row) -> f64| {
            let used = self.rows.iter().filter(|row| row.used).map(side);
            used.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(c), high.max(c)])
        };
        Sides { left: of(|row| row.motor_c.left), right: of(|row| row.motor_c.right) }
    }

    /// Asks the watch whether to go on.
    ///
    /// # Errors
    /// [`Error::Stopped`] when it breaks.
    pub fn go_on(&self) -> Result<(), Error> {
        self.watch.go_on()
    }

    /// The drives on one surface.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the drives' watch breaks.
    pub fn on_surface(&self, surface: usize) -> Result<Drives, Error> {
        self.select(|stretch| stretch.surface == surface)
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
    let column = |channel| recording.channel(channel).unwrap_or_default();
    let copy = |channel| column(channel).par_iter().copied().collect();
    match form {
        PowerForm::Sides => vec![copy(Channel::LeftPower), copy(Channel::RightPower)],
        PowerForm::Battery => vec![copy(Channel::Power)],
        PowerForm::CurrentAndVoltage => {
            let (amperes, volts) = (column(Channel::Current), column(Channel::Voltage));
            vec![amperes.iter().zip(volts).map(|(i, v)| i * v).collect()]
        }
        // Many drivers report no sign, so none is relied on.
        PowerForm::MotorCurrents => [Channel::LeftMotorCurrent, Channel::RightMotorCurrent]
            .map(|channel| column(channel).par_iter().map(|a| a.abs()).collect())
            .to_vec(),
    }
}
