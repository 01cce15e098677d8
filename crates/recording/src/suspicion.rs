//! Channels that a person should look at before trusting the numbers. Nothing here changes a recording.

mod absence;
mod magnitude;
mod motion;
mod rhythm;

use absence::{constant, empty, present, saturated, sparse};
use magnitude::{magnitude, mounting, units_of_runs};
use motion::{degrees, lone_flips, mirrored, turning, unsigned};
use rhythm::slow_motion;

use crate::{
    Channel, Error, Recording,
    report::{Suspicion, SuspicionKind as Kind},
    unwatched,
    watch::Looks,
};

/// Fewer rows than this say nothing about a channel.
const LEAST_ROWS: usize = 20;

/// A doubt about each channel, for every test that it fails.
pub fn suspicions(recording: &Recording) -> Vec<Suspicion> {
    suspicions_watched(recording, &Looks::new(&unwatched())).unwrap_or_default()
}

/// Doubts as [`suspicions`] has them, followed by a watch.
pub(crate) fn suspicions_watched(recording: &Recording, looks: &Looks) -> Result<Vec<Suspicion>, Error> {
    let mut looks = looks.clone();
    let mut doubts = Vec::new();
    for (&channel, values) in &recording.channels {
        looks.worked(values.len())?;
        let doubt = |kind, statement| Suspicion { channel, run: None, kind, statement };
        let present = present(values);
        if let Some(statement) = sparse(present.len(), values.len()) {
            doubts.push(doubt(Kind::Sparse, statement));
        }
        if present.len() < LEAST_ROWS {
            continue;
        }
        if let Some(statement) = constant(&present) {
            doubts.push(doubt(Kind::Constant, statement));
            continue;
        }
        doubts.extend(saturated(channel, &present).map(|statement| doubt(Kind::Saturated, statement)));
        doubts.extend(mounting(channel, &present).map(|statement| doubt(Kind::Mounting, statement)));
        doubts.extend(magnitude(channel, &present).map(|statement| doubt(Kind::Unit, statement)));
    }
    let mirrored = mirrored(recording);
    let signs_are_right = mirrored.is_none();
    doubts.extend(mirrored);
    for run in &recording.runs {
        looks.worked(run.rows.len())?;
        doubts.extend(empty(recording, run));
        for channel in [Channel::LeftSpeed, Channel::RightSpeed, Channel::YawRate] {
            let values = recording.channel(channel).and_then(|values| values.get(run.rows.clone()));
            if let Some(statement) = values.and_then(lone_flips) {
                doubts.push(Suspicion { channel, run: Some(run.name.clone()), kind: Kind::Sign, statement });
            }
        }
        doubts.extend(turning(recording, run).filter(|_| signs_are_right));
        doubts.extend(degrees(recording, run));
        doubts.extend(slow_motion(recording, run));
    }
    looks.go_on()?;
    doubts.extend(units_of_runs(recording));
    doubts.extend(unsigned(recording));
    Ok(doubts)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::Run;

    const ROWS: usize = 400;

    /// A healthy drive of weaving, with one channel replaced.
    fn drive(channel: Channel, of: impl Fn(usize, f64) -> f64) -> Vec<(Channel, Kind)> {
        let t_s: Vec<f64> = (0..ROWS).map(|row| row as f64 * 0.1).collect();
        let weave = |phase: f64| -> Vec<f64> { t_s.iter().map(|t| 0.5 + 0.3 * (t + phase).sin()).collect() };
        let (left, right) = (weave(0.0), weave(1.0));
        let yaw_rate = left.iter().zip(&right).map(|(l, r)| (r - l) / 0.9).collect();
        let power_w = left.iter().map(|v| 40.0 + 100.0 * v).collect();
        let mut channels = BTreeMap::from([
            (Channel::LeftSpeed, left),
            (Channel::RightSpeed, right),
            (Channel::YawRate, yaw_rate),
            (Channel::Power, power_w),
        ]);
        let values = channels.entry(channel).or_insert_with(|| t_s.iter().map(|t| t.sin()).collect());
        for (row, value) in values.iter_mut().enumerate() {
            *value = of(row, *value);
        }
        let runs = vec![Run::new("drive".into(), 0..ROWS, &t_s, None)];
        let recording = Recording { t_s, channels, runs, ..Recording::default() };
        suspicions(&recording).into_iter().map(|doubt| (doubt.channel, doubt.kind)).collect()
    }

    #[test]
    fn a_healthy_drive_raises_no_doubt() {
        assert_eq!(drive(Channel::Power, |_, p| p), []);
    }

    #[test]
    fn each_fault_is_named_by_channel_and_kind() {
        use Channel as C;
        assert_eq!(drive(C::Power, |_, _| 7.0), [(C::Power, Kind::Constant)]);
        assert_eq!(drive(C::Power, |_, p| p / 1000.0), [(C::Power, Kind::Unit)]);
        assert_eq!(drive(C::Power, |_, p| p.min(100.0)), [(C::Power, Kind::Saturated)]);
        let counted = |r: usize, v: f64| if r % 100 < 30 { [0.9, 0.6][r / 200] } else { 0.99 * v };
        let steady = drive(C::LeftSpeed, counted);
        assert!(!steady.contains(&(C::LeftSpeed, Kind::Saturated)), "steady speeds by counts of an encoder");
        assert_eq!(drive(C::Power, |_, p| p.max(80.0)), [], "an offset at which a meter rests");
        assert_eq!(drive(C::Power, |r, p| if r < 300 { f64::NAN } else { p }), [(C::Power, Kind::Sparse)]);
        assert_eq!(drive(C::YawRate, |_, w| -w), [(C::YawRate, Kind::Opposed)]);
        assert_eq!(drive(C::YawRate, |r, _| (r as f64).sin()), [(C::YawRate, Kind::Slip)]);
        assert_eq!(drive(C::YawRate, |_, w| w.to_degrees()), [(C::YawRate, Kind::Unit); 2]);
        assert_eq!(drive(C::LeftSpeed, |r, v| if r == 200 { -v } else { v }), [(C::LeftSpeed, Kind::Sign)]);
        assert_eq!(drive(C::Pitch, |_, p| 10.0 * p), [(C::Pitch, Kind::Unit)]);
    }

    #[test]
    fn angles_in_degrees_are_no_unit_on_its_side() {
        let wave = |row: usize| 0.06 * (0.05 * row as f64).sin();
        assert_eq!(drive(Channel::Pitch, |row, _| wave(row)), []);
        assert_eq!(
            drive(Channel::Pitch, |row, _| wave(row).to_degrees()),
            [(Channel::Pitch, Kind::Unit)],
            "up to 3.4 degrees"
        );
        let on_its_side = drive(Channel::Pitch, |row, _| std::f64::consts::FRAC_PI_2 + wave(row));
        assert_eq!(on_its_side, [(Channel::Pitch, Kind::Mounting)]);
    }

    #[test]
    fn without_a_gyroscope_the_heading_tells_swapped_sides_and_its_own_unit() {
        // A minute of weaving on a bearing that drifts round, with the noise of a compass.
        let t_s: Vec<f64> = (0..1200).map(|row| f64::from(row) * 0.1).collect();
        let turn = |t: f64| 0.15 + 0.2 * (0.3 * t).sin();
        let [left, right] =
            [-1.0, 1.0].map(|side| -> Vec<f64> { t_s.iter().map(|t| 0.5 + side * 0.4 * turn(*t)).collect() });
        let heading_rad = |t: &f64| 0.15 * t - 0.2 / 0.3 * (0.3 * t).cos() + 0.02 * (37.0 * t).sin();
        let told = |sides: [&Vec<f64>; 2], of: &dyn Fn(f64) -> f64| -> Vec<(Channel, Kind)> {
            let channels = BTreeMap::from([
                (Channel::LeftSpeed, sides[0].clone()),
                (Channel::RightSpeed, sides[1].clone()),
                (Channel::Heading, t_s.iter().map(heading_rad).map(of).collect()),
            ]);
            let runs = vec![Run::new("drive".into(), 0..t_s.len(), &t_s, None)];
            let recording = Recording { t_s: t_s.clone(), channels, runs, ..Recording::default() };
            suspicions(&recording).into_iter().map(|doubt| (doubt.channel, doubt.kind)).collect()
        };
        let wrapped = |rad: f64| rad.rem_euclid(std::f64::consts::TAU);
        assert_eq!(told([&left, &right], &|rad| rad), []);
        assert_eq!(told([&left, &right], &wrapped), []);
        assert_eq!(told([&right, &left], &wrapped), [(Channel::Heading, Kind::Opposed)]);
        let degrees = told([&left, &right], &|rad| wrapped(rad).to_degrees());
        assert!(degrees.contains(&(Channel::Heading, Kind::Unit)), "{degrees:?}");
        // A drive that went round fifty times, counted on, and one that begins at nothing.
        let (rows, turned) = (1200, |i: usize| 0.27 * (i % 1200) as f64);
        let times: Vec<f64> = (0..2 * rows).map(|i| 0.1 * i as f64).collect();
        let channels = BTreeMap::from([(Channel::Heading, (0..2 * rows).map(turned).collect())]);
        let runs = [0..rows, rows..2 * rows].map(|rows| Run::new("drive".into(), rows, &times, None)).into();
        let two = Recording { t_s: times, channels, runs, ..Recording::default() };
        assert!(suspicions(&two).iter().all(|doubt| !doubt.statement.contains("degrees")));
        // Whatever a compass shows beside motors is no contradiction.
        assert_eq!(told([&left, &right], &|rad| (40.0 * rad).sin()), []);
    }

    #[test]
    fn a_mirrored_side_is_told_and_wheels_that_spin_on_snow_are_not_mirrored() {
        let t_s: Vec<f64> = (0..ROWS).map(|row| row as f64 * 0.1).collect();
        let half = ROWS / 2;
        let told = |wheels: &dyn Fn(usize) -> [f64; 2], rate: &dyn Fn(usize) -> f64| -> Vec<Kind> {
            let side = |side: usize| (0..ROWS).map(|row| wheels(row)[side]).collect();
            let channels = BTreeMap::from([
                (Channel::LeftSpeed, side(0)),
                (Channel::RightSpeed, side(1)),
                (Channel::YawRate, (0..ROWS).map(rate).collect()),
            ]);
            let runs = [0..half, half..ROWS].map(|rows| Run::new("drive".into(), rows, &t_s, None)).into();
            let recording = Recording { t_s: t_s.clone(), channels, runs, ..Recording::default() };
            let kinds = suspicions(&recording).into_iter().map(|doubt| doubt.kind);
            kinds.filter(|kind| matches!(kind, Kind::Opposed | Kind::Slip)).collect()
        };
        let turn = |row: usize| 0.2 * (0.03 * row as f64).sin();
        let mirrored = told(&|row| [-0.5 + turn(row), 0.5 + turn(row)], &|row| 1.2 * turn(row));
        assert_eq!(mirrored, [Kind::Opposed], "once for both drives");
        // On firm ground first; then the wheels turn against each other and the robot hardly does, but for moments when one side takes hold.
        let takes_hold = |row: usize| row % 40 < 4;
        let wheels = |row: usize| match (row < half, takes_hold(row)) {
            (true, _) => [0.5 - turn(row), 0.5 + turn(row)],
            (false, true) => [0.0, 0.3],
            (false, false) => [-0.4, 0.4],
        };
        let rate = |row: usize| match (row < half, takes_hold(row)) {
            (true, _) => 2.4 * turn(row) + 0.01 * (0.9 * row as f64).sin(),
            (false, true) => 0.3 + 0.01 * (0.9 * row as f64).sin(),
            (false, false) => 0.05 * (0.9 * row as f64).sin(),
        };
        assert_eq!(told(&wheels, &rate), [Kind::Slip]);
    }

    #[test]
    fn currents_without_a_sign_are_named_when_the_wheels_turn_both_ways() {
        let t_s: Vec<f64> = (0..ROWS).map(|row| row as f64 * 0.1).collect();
        let speed_mps: Vec<f64> = t_s.iter().map(|t| 0.5 * t.sin()).collect();
        let find = |current: fn(&f64) -> f64| {
            let current_a: Vec<f64> = speed_mps.iter().map(current).collect();
            let channels = BTreeMap::from([
                (Channel::LeftSpeed, speed_mps.clone()),
                (Channel::RightSpeed, speed_mps.clone()),
                (Channel::LeftMotorCurrent, current_a.clone()),
                (Channel::RightMotorCurrent, current_a),
            ]);
            let runs = vec![Run::new("drive".into(), 0..ROWS, &t_s, None)];
            let recording = Recording { t_s: t_s.clone(), channels, runs, ..Recording::default() };
            suspicions(&recording).into_iter().filter(|doubt| doubt.kind == Kind::Unsigned).count()
        };
        assert_eq!((find(|v| 8.0 * v.abs() + 0.5), find(|v| 8.0 * v)), (2, 0));
    }
}
