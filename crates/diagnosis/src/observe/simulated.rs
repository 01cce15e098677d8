//! Another simulator's log of the same drives, in place of what the robot's file predicts.
//!
//! What is to be explained is then the recorded power less that of the other simulation. The robot's model stays what mechanisms are added
//! to: power is handed on as the file's prediction and that difference on top, so that every later step is the same.

use model::Robot;
use recording::{Channel, PowerForm, Recording, Run};

use crate::{Error, observe::imitate::imitate};

/// Share of the recorded rows that the simulation has to tell power of, and by which both may last longer than the other.
const LEAST_COVERED: f64 = 0.95;
/// Differences of clocks that are looked for \[s\].
const MOST_LATE_S: f64 = 10.0;
/// Step of that search \[s\].
const LATE_STEP_S: f64 = 0.1;
/// Differences of clocks below are no fault of a clock: half an average.
const LEAST_LATE_S: f64 = 0.5;
/// Correlation of motion, or of power where the simulation tells no motion, below which it is not of the same drive.
const LEAST_ALIKE: [f64; 2] = [0.8, 0.3];
/// Ratios of wheel speeds beyond which it is another robot's: a wheel may be worn by some per cent, and not by a fifth.
const SAME_WHEELS: [f64; 2] = [0.8, 1.25];

/// Recorded drives beside another simulation.
pub(crate) struct BesideSimulation {
    /// The drives, with power as the file's prediction and what the simulation misses on top.
    pub(crate) recording: Recording,
    /// By row: power of the simulation less that of the file, of all channels together; NaN where it is not known [W].
    pub(crate) offset_w: Vec<f64>,
}

impl BesideSimulation {
    /// Puts a simulation of the same drives in the place of the file's prediction; both tell power in watts.
    ///
    /// # Errors
    /// A simulation of other drives, of another length, clock or robot, or without the power that was recorded.
    pub(crate) fn new(robot: &Robot, recorded: &Recording, simulated: &Recording) -> Result<Self, Error> {
        let pairs = paired(recorded, simulated)?;
        let at_rows = |values: &[f64]| -> Vec<f64> {
            let mut all = vec![f64::NAN; recorded.rows()];
            for (run, other) in &pairs {
                resampled((recorded, run), (simulated, other), values, &mut all[run.rows.clone()]);
            }
            all
        };
        are_same_drive(recorded, &pairs, &|channel| Some(at_rows(simulated.channel(channel)?)))?;
        let mut reduced = recorded.clone();
        let channels = compared(&mut reduced, simulated)?;
        let predicted = imitate(robot, &reduced, &[])?;
        let mut offset_w = vec![0.0; recorded.rows()];
        for channel in &channels {
            let said = simulated_w(simulated, *channel).ok_or_else(|| lacks(&channels))?;
            let (said, filed) = (at_rows(&said), predicted.channel(*channel).unwrap_or(&[]));
            covers(recorded, &pairs, &said)?;
            for (offset, (said, filed)) in offset_w.iter_mut().zip(said.iter().zip(filed)) {
                *offset += said - filed;
            }
            if let Some(power_w) = reduced.channels.get_mut(channel) {
                for (power, (said, filed)) in power_w.iter_mut().zip(said.iter().zip(filed)) {
                    *power += filed - said;
                }
            }
        }
        // The battery gives what both sides take and what it gave beyond them.
        if channels.len() == 2
            && let Some(power_w) = reduced.channels.get_mut(&Channel::Power)
        {
            power_w.iter_mut().zip(&offset_w).for_each(|(power, offset)| *power -= offset);
        }
        // Voltages sag with the power that was really drawn.
        reduced.channels.remove(&Channel::Voltage);
        Ok(BesideSimulation { recording: reduced, offset_w })
    }
}

/// Runs of the recording with those of the simulation, in order.
fn paired<'a>(recorded: &'a Recording, simulated: &'a Recording) -> Result<Vec<(&'a Run, &'a Run)>, Error> {
    let counts = [recorded.runs.len(), simulated.runs.len()];
    if counts[0] != counts[1] {
        return Err(refused(format!(
            "it has {} drives and the recording {}: log every drive of the recording, in the same order",
            counts[1], counts[0]
        )));
    }
    for (run, other) in recorded.runs.iter().zip(&simulated.runs) {
        let [real_s, made_s] = [(recorded, run), (simulated, other)].map(|(all, run)| duration_s(all, run));
        if made_s < LEAST_COVERED * real_s || real_s < LEAST_COVERED * made_s {
            return Err(refused(format!(
                "drive `{}` lasts {made_s:.1} s in it and {real_s:.1} s in the recording: log the same drive from its beginning to its end",
                run.name
            )));
        }
    }
    Ok(recorded.runs.iter().zip(&simulated.runs).collect())
}

fn duration_s(recording: &Recording, run: &Run) -> f64 {
    let times = recording.t_s.get(run.rows.clone()).unwrap_or(&[]);
    times.first().zip(times.last()).map_or(0.0, |(first, last)| last - first)
}

/// Values of a simulated run at the times of the recorded one, counted from where each begins; NaN in gaps.
fn resampled(
    (recorded, run): (&Recording, &Run),
    (simulated, other): (&Recording, &Run),
    values: &[f64],
    to: &mut [f64],
) {
    let (Some(real_s), Some(made_s)) =
        (recorded.t_s.get(run.rows.clone()), simulated.t_s.get(other.rows.clone()))
    else {
        return;
    };
    let (Some(values), Some((began_s, other_began_s))) =
        (values.get(other.rows.clone()), real_s.first().zip(made_s.first()))
    else {
        return;
    };
    // A row is the state at its time; the last one holds to the end of a slower recording's step.
    let tolerance_s = run.gap_s.min(other.gap_s);
    for (value, t_s) in to.iter_mut().zip(real_s) {
        let wanted_s = t_s - began_s + other_began_s;
        let after = made_s.partition_point(|t| *t < wanted_s);
        let (before, after) = (after.saturating_sub(1), after.min(made_s.len() - 1));
        let span_s = made_s[after] - made_s[before];
        *value = if span_s <= 0.0 {
            if (made_s[after] - wanted_s).abs() <= tolerance_s { values[after] } else { f64::NAN }
        } else if span_s > other.gap_s {
            f64::NAN
        } else {
            let share = (wanted_s - made_s[before]) / span_s;
            if share > 1.0 + tolerance_s / span_s {
                f64::NAN
            } else {
                let share = share.clamp(0.0, 1.0);
                values[before] * (1.0 - share) + values[after] * share
            }
        };
    }
}

/// Channels of power that are compared, with the recording reduced to them.
fn compared(recorded: &mut Recording, simulated: &Recording) -> Result<Vec<Channel>, Error> {
    let form = recorded.power_form().ok_or(Error::Form)?;
    let sides = vec![Channel::LeftPower, Channel::RightPower];
    if form == PowerForm::Sides && sides.iter().all(|side| simulated.channels.contains_key(side)) {
        return Ok(sides);
    }
    if simulated_w(simulated, Channel::Power).is_none() {
        return Err(lacks(if form == PowerForm::Sides { &sides } else { &[Channel::Power] }));
    }
    let Some(battery_w) = simulated_w(recorded, Channel::Power) else { return Err(lacks(&sides)) };
    for channel in sides.into_iter().chain([Channel::Current]) {
        recorded.channels.remove(&channel);
    }
    recorded.channels.insert(Channel::Power, battery_w);
    Ok(vec![Channel::Power])
}

/// Power of a channel, that of the battery by current and voltage too [W].
fn simulated_w(recording: &Recording, channel: Channel) -> Option<Vec<f64>> {
    if let Some(power_w) = recording.channel(channel) {
        return Some(power_w.to_vec());
    }
    let is_battery = channel == Channel::Power;
    let (current_a, volts) = (recording.channel(Channel::Current)?, recording.channel(Channel::Voltage)?);
    is_battery.then(|| current_a.iter().zip(volts).map(|(a, v)| a * v).collect())
}

/// Refuses a simulation that leaves out too much of what was recorded.
fn covers(recorded: &Recording, pairs: &[(&Run, &Run)], said: &[f64]) -> Result<(), Error> {
    for (run, _) in pairs {
        let rows = run.rows.clone();
        let told = rows.clone().filter(|row| said[*row].is_finite()).count() as f64;
        let all = rows.len() as f64;
        if told < LEAST_COVERED * all {
            return Err(refused(format!(
                "of drive `{}` it tells power in {:.0} % of the {:.0} s that were recorded, which takes {:.0} % at least",
                run.name,
                100.0 * told / all,
                duration_s(recorded, run),
                100.0 * LEAST_COVERED
            )));
        }
    }
    Ok(())
}

/// Refuses a simulation whose robot moved otherwise, at another time, or on other wheels.
fn are_same_drive(
    recorded: &Recording,
    pairs: &[(&Run, &Run)],
    simulated: &dyn Fn(Channel) -> Option<Vec<f64>>,
) -> Result<(), Error> {
    let motion = [Channel::LeftSpeed, Channel::RightSpeed];
    let powers = [Channel::LeftPower, Channel::RightPower, Channel::Power];
    let kinds = [(&motion[..], LEAST_ALIKE[0], "wheel speeds"), (&powers[..], LEAST_ALIKE[1], "power")];
    for (channels, least, what) in kinds {
        let both: Vec<(&[f64], Vec<f64>)> = channels
            .iter()
            .filter_map(|channel| Some((recorded.channel(*channel)?, simulated(*channel)?)))
            .collect();
        if both.is_empty() {
            continue;
        }
        let alike = |late_s: f64| correlation(recorded, pairs, &both, late_s);
        let steps = (MOST_LATE_S / LATE_STEP_S) as i32;
        let lates = (-steps..=steps).map(|step| f64::from(step) * LATE_STEP_S);
        let best = lates.map(|late_s| (alike(late_s), late_s)).max_by(|a, b| a.0.total_cmp(&b.0));
        let (best, late_s) = best.unwrap_or_default();
        if best < least {
            return Err(refused(format!(
                "its {what} do not follow those of the recording (correlation {best:.2}, at any clock within {MOST_LATE_S} s): it is of another drive"
            )));
        }
        let gained = (1.0 - alike(0.0)) > 2.0 * (1.0 - best);
        if late_s.abs() > LEAST_LATE_S && gained {
            let way = if late_s > 0.0 { "late" } else { "early" };
            return Err(refused(format!(
                "its clock is {:.1} s {way}, by its {what}: subtract {late_s:.1} s from its t_s",
                late_s.abs()
            )));
        }
        if channels == motion {
            same_wheels(&both)?;
        }
        return Ok(());
    }
    Ok(())
}

/// Refuses wheel speeds that are in a fixed ratio to those that were recorded.
fn same_wheels(both: &[(&[f64], Vec<f64>)]) -> Result<(), Error> {
    let [mut product, mut square] = [0.0; 2];
    for (real, made) in both {
        for (real, made) in real.iter().zip(made).filter(|(real, made)| (**real * **made).is_finite()) {
            product += real * made;
            square += real * real;
        }
    }
    let ratio = product / square;
    let [low, high] = SAME_WHEELS;
    if square > 0.0 && !(low..high).contains(&ratio) {
        return Err(refused(format!(
            "its wheels turn {ratio:.2} times as fast as they were recorded to: it is of another robot, or its speeds are in other units"
        )));
    }
    Ok(())
}

/// Correlation of what was recorded with what the simulation says so much later, over all runs and channels.
fn correlation(
    recorded: &Recording,
    pairs: &[(&Run, &Run)],
    both: &[(&[f64], Vec<f64>)],
    late_s: f64,
) -> f64 {
    let mut sums = [0.0; 6];
    for (run, _) in pairs {
        let rows = run.rows.clone();
        let step_s = duration_s(recorded, run) / (rows.len().max(2) - 1) as f64;
        if step_s <= 0.0 {
            continue;
        }
        let shift = (late_s / step_s).round() as isize;
        // Some thousand rows tell it.
        let stride = (rows.len() / 4000).max(1);
        for row in rows.clone().step_by(stride) {
            let Some(other) = row.checked_add_signed(shift).filter(|other| rows.contains(other)) else {
                continue;
            };
            for (real, made) in both {
                let (a, b) = (real[row], made[other]);
                if (a * b).is_finite() {
                    let terms = [1.0, a, b, a * a, b * b, a * b];
                    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
                }
            }
        }
    }
    let [n, a, b, aa, bb, ab] = sums;
    let scatter = ((aa - a * a / n) * (bb - b * b / n)).sqrt();
    if scatter > 0.0 { (ab - a * b / n) / scatter } else { 0.0 }
}

fn lacks(channels: &[Channel]) -> Error {
    let names: Vec<String> = channels.iter().map(|channel| format!("`{}`", channel.name())).collect();
    refused(format!("it lacks {}, which the recording tells power by", names.join(" and ")))
}

fn refused(why: String) -> Error {
    Error::Simulated(why)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Applied, Span, observe::hills::drive};

    fn beside(simulated: &Recording) -> Result<BesideSimulation, Error> {
        let robot = model::builtin::husky_a200();
        BesideSimulation::new(&robot, &drive(&robot, 0.0, &[]), simulated)
    }

    fn husky_drive() -> Recording {
        drive(&model::builtin::husky_a200(), 0.0, &[])
    }

    #[test]
    fn a_simulation_that_is_the_files_own_leaves_what_was_recorded() {
        let robot = model::builtin::husky_a200();
        let recorded = husky_drive();
        let made = imitate(&robot, &recorded, &[]).unwrap();
        let beside = beside(&made).unwrap();
        for side in [Channel::LeftPower, Channel::RightPower] {
            let [now, before] = [&beside.recording, &recorded].map(|one| one.channel(side).unwrap());
            for (now, before) in now.iter().zip(before).filter(|(now, _)| now.is_finite()) {
                assert!((now - before).abs() < 1e-9, "{now} {before}");
            }
        }
        assert!(beside.offset_w.iter().filter(|w| w.is_finite()).all(|w| w.abs() < 1e-9));
    }

    #[test]
    fn what_the_simulation_has_beyond_the_file_is_taken_off_what_was_recorded() {
        let robot = model::builtin::husky_a200();
        let load = model::mechanism::by_name("drivetrain_drag").unwrap();
        let applied = Applied { mechanism: load, values: vec![10.0, 0.0], span: Span::ALL };
        let (plain, more) = (
            imitate(&robot, &husky_drive(), &[]).unwrap(),
            imitate(&robot, &husky_drive(), &[applied]).unwrap(),
        );
        let of = |one: &Recording, row: usize| one.channel(Channel::LeftPower).unwrap()[row];
        let (made, kept) = (beside(&more).unwrap(), beside(&plain).unwrap());
        for row in [100, 2000, 8000] {
            let taken = of(&kept.recording, row) - of(&made.recording, row);
            assert!((taken - (of(&more, row) - of(&plain, row))).abs() < 1e-9);
            assert!((made.offset_w[row] - taken).abs() < 1e-9);
        }
    }

    #[test]
    fn another_length_clock_drive_or_robot_is_refused_with_what_is_wrong() {
        let said = |change: &dyn Fn(&mut Recording)| {
            let mut made = imitate(&model::builtin::husky_a200(), &husky_drive(), &[]).unwrap();
            change(&mut made);
            beside(&made).map(|_| ()).unwrap_err().to_string()
        };
        let cut = said(&|made| {
            made.runs[0].rows.end = 6000;
            made.t_s.truncate(6000);
            made.channels.values_mut().for_each(|values| values.truncate(6000));
        });
        assert!(cut.contains("599.9 s") && cut.contains("899.9 s"), "{cut}");
        let late = said(&|made| {
            for values in made.channels.values_mut() {
                values.rotate_right(30);
            }
        });
        assert!(late.contains("3.0 s late"), "{late}");
        let faster = said(&|made| {
            for speed in [Channel::LeftSpeed, Channel::RightSpeed] {
                made.channels.get_mut(&speed).unwrap().iter_mut().for_each(|mps| *mps *= 2.0);
            }
        });
        assert!(faster.contains("2.00 times"), "{faster}");
        let other = said(&|made| {
            // The same half minutes in another order.
            let dealt = |values: &Vec<f64>| -> Vec<f64> {
                (0..values.len()).map(|row| values[(row / 300 * 7 + 3) % 30 * 300 + row % 300]).collect()
            };
            made.channels.values_mut().for_each(|values| *values = dealt(values));
        });
        assert!(other.contains("another drive"), "{other}");
        let without = said(&|made| {
            made.channels.remove(&Channel::LeftPower);
        });
        assert!(without.contains("power_left_w"), "{without}");
    }
}
