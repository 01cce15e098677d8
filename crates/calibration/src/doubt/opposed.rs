//! Wheels, gyroscope and positions that turn to different sides.

use model::Robot;
use recording::{Channel, Recording, Run, Suspicion, SuspicionKind, suspicions};

use super::{Doubt, change::turned, driving::STANDS_MPS, scale, time_scale::noise_m};

/// Way of which a course is told \[m\]: farther than positions of satellites err from one second to the next.
const WAY_M: f64 = 1.0;
/// The same in standard deviations of positions: a course is then told to a tenth of a radian and better.
const WAY_SIGMAS: f64 = 10.0;
/// Share of the variance of courses that turning has to explain, as of the yaw rate.
const LEAST_R2: f64 = 0.5;
/// Fewer turns of the course tell nothing.
const LEAST_TURNS: usize = 10;

/// Tells of a sign by which wheels turn the robot to one side and gyroscope, compass or positions to the other.
pub(super) fn opposed(robot: &Robot, recording: &Recording) -> Vec<Doubt> {
    let found: Vec<_> =
        suspicions(recording).into_iter().filter(|one| is_opposed(robot, recording, one)).collect();
    let is_told = |run: &Run| found.is_empty() || found.iter().any(|one| one.run.as_ref() == Some(&run.name));
    let runs = recording.runs.iter().filter(|run| is_told(run));
    let turns: Vec<[f64; 3]> = runs.flat_map(|run| turns(recording, run).unwrap_or_default()).collect();
    let of_course = |witness: usize| course_follows(&turns, witness);
    let Some(first) = found.first() else {
        return mirrored_places(of_course(0), of_course(1)).into_iter().collect();
    };
    let name = match first.channel {
        Channel::LeftSpeed => "left_speed_sign",
        Channel::RightSpeed => "right_speed_sign",
        _ => "turning_sign",
    };
    let mut runs: Vec<String> =
        found.iter().filter_map(|one| one.run.as_ref()).map(|run| format!("`{run}`")).collect();
    runs.dedup();
    let place = if runs.is_empty() { String::new() } else { format!(" (run {})", runs.join(", ")) };
    let (why, cure) = match (of_course(0), of_course(1)) {
        (Some(true), _) => (
            "; positions turn as the wheels do, so that its sign seems wrong",
            "give the source of the yaw rate or heading \"scale\": -1 in a map",
        ),
        (Some(false), _) => (
            "; positions turn against the wheels, so that left and right wheel speeds seem swapped",
            "swap the sources of `v_left_mps` and `v_right_mps` in a map",
        ),
        _ => (
            "",
            "swap the sources of both wheel speeds in a map, or give that of the yaw rate or heading \"scale\": -1",
        ),
    };
    // A mirrored side says itself what mends it.
    let (shown, why, cure) = match first.statement.split_once("; ") {
        Some((shown, cure)) if name != "turning_sign" => (shown, "", cure),
        _ => (first.statement.as_str(), why, cure),
    };
    let statement = format!("`{}`{place}: {shown}{why}", first.channel.name());
    vec![Doubt { name, statement, cure: cure.to_owned() }]
}

/// Whether a suspicion is of a sign. A side that is mirrored turns the robot as robots turn once it is mended; where wheels spin on snow and one
/// takes hold, their sum tells how the robot turns as well, and means no slip track.
fn is_opposed(robot: &Robot, recording: &Recording, one: &Suspicion) -> bool {
    let turns_once_mended = || {
        let mended = turned(recording, &[one.channel]);
        let track_m = mended.and_then(|mended| scale::slip_track_m(&mended));
        track_m
            .is_some_and(|m| (scale::SLIP_TRACKS[0]..=scale::SLIP_TRACKS[1]).contains(&(m / robot.track_m)))
    };
    let is_side = matches!(one.channel, Channel::LeftSpeed | Channel::RightSpeed);
    one.kind == SuspicionKind::Opposed && (!is_side || turns_once_mended())
}

/// Positions that turn against wheels and gyroscope, which agree.
fn mirrored_places(as_wheels: Option<bool>, as_gyroscope: Option<bool>) -> Option<Doubt> {
    (as_wheels == Some(false) && as_gyroscope == Some(false)).then(|| Doubt {
        name: "positions_mirrored",
        statement: "positions turn to the other side than wheels and gyroscope, which agree".to_owned(),
        cure: "are `x_m` and `y_m` swapped, or is one of them counted the other way? x is east and y north"
            .to_owned(),
    })
}

/// Whether courses turn as a witness does, or against it; `None` where they do neither.
fn course_follows(turns: &[[f64; 3]], witness: usize) -> Option<bool> {
    let pairs = || turns.iter().map(|turn| [turn[0], turn[1 + witness]]).filter(|pair| pair[1].is_finite());
    let [cc, cw, ww] = pairs().fold([0.0; 3], |[cc, cw, ww], [course, seen]| {
        [cc + course * course, cw + course * seen, ww + seen * seen]
    });
    (pairs().count() >= LEAST_TURNS && cw * cw > LEAST_R2 * cc * ww).then_some(cw > 0.0)
}

/// A piece of way straight from one position to another: its course \[rad\] and the row in its middle.
type Piece = (f64, usize);

/// From one piece of way to the next: turn of the course \[rad\], way that the right wheels go farther than the left \[m\], and turn by the
/// gyroscope \[rad\].
fn turns(recording: &Recording, run: &Run) -> Option<Vec<[f64; 3]>> {
    let [left, right] = [Channel::LeftSpeed, Channel::RightSpeed].map(|c| recording.channel(c));
    let (left, right) = (left?, right?);
    let rate = recording.channel(Channel::YawRate);
    let between = |from: &Piece, to: &Piece| {
        let turn_rad =
            (to.0 - from.0 + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let (mut way_m, mut yaw_rad) = (0.0, 0.0);
        for row in from.1..to.1 {
            let step_s = recording.t_s[row + 1] - recording.t_s[row];
            way_m += (right[row] - left[row]) * step_s;
            yaw_rad += rate.map_or(f64::NAN, |rate| rate[row]) * step_s;
        }
        [turn_rad, way_m, yaw_rad]
    };
    let stretches = courses(recording, run)?;
    Some(stretches.iter().flat_map(|pieces| pieces.windows(2).map(|w| between(&w[0], &w[1]))).collect())
}

/// Pieces of way of a run behind one another, anew where the robot stands, turns round or leaves a gap.
fn courses(recording: &Recording, run: &Run) -> Option<Vec<Vec<Piece>>> {
    let [x, y, left, right] =
        [Channel::X, Channel::Y, Channel::LeftSpeed, Channel::RightSpeed].map(|c| recording.channel(c));
    let (x, y, left, right) = (x?, y?, left?, right?);
    let speed = |row: usize| (left[row] + right[row]) / 2.0;
    let least_m = (WAY_SIGMAS * noise_m(x).hypot(noise_m(y))).max(WAY_M);
    let (mut all, mut from) = (vec![Vec::new()], run.rows.start);
    for row in run.rows.clone().skip(1) {
        let goes_on = speed(row).abs() > STANDS_MPS && speed(row) * speed(row - 1) > 0.0;
        if !goes_on || !(x[row] - x[from]).is_finite() || recording.step_s(run, row - 1).is_none() {
            all.push(Vec::new());
            from = row;
            continue;
        }
        let (east_m, north_m) = (x[row] - x[from], y[row] - y[from]);
        if east_m.hypot(north_m) >= least_m {
            all.last_mut()?.push((north_m.atan2(east_m), usize::midpoint(from, row)));
            from = row;
        }
    }
    Some(all)
}
