//! Speeds and powers of a size that another unit would explain.

use model::Robot;
use recording::{Channel, Recording};

use super::{
    Doubt,
    change::FOLLOWS_WELL,
    driving::STANDS_MPS,
    follow::{Followed, Varies},
};

/// Slip tracks over the track of the robot: skid-steered robots turn as with 1 to 2.3 times their track (Mandow et al., IROS 2007: 1.5 to
/// 2.3 on hard ground; BorealTC's Husky: 1.5 to 1.8).
pub(super) const SLIP_TRACKS: [f64; 2] = [0.75, 2.6];
/// Speeds over ground over those of the wheels: wheels slip by a tenth or two, and do not fall behind.
const OVER_GROUND: [f64; 2] = [0.5, 1.25];
/// Speeds beyond so many times the fastest that the robot's file has.
pub(super) const FASTEST: f64 = 1.5;
/// Share of the variance that wheels have to explain before their size is compared.
const LEAST_R2: f64 = 0.5;
/// Fewer rows tell nothing.
const LEAST_ROWS: usize = 50;
/// How far a factor may be from that of a unit.
pub(super) const LIKE_UNIT: f64 = 1.6;
/// Ratios of recorded to predicted power that no friction explains: of what a real Husky draws on flooring it draws 0.30 on ice, and twice as
/// much on loam.
const POWERS: [f64; 2] = [0.1, 3.0];

/// Doubts about the size of wheel speeds, by gyroscope, positions and what the robot can do.
pub fn speeds(robot: &Robot, recording: &Recording) -> Vec<Doubt> {
    let by_yaw_rate = turning(recording).and_then(|[found_m, r2]| {
        let times = found_m / robot.track_m;
        // Wheels that slip turn the robot less, now more and now less; a unit is one factor.
        if times > SLIP_TRACKS[1] && r2 < FOLLOWS_WELL {
            return None;
        }
        (!(SLIP_TRACKS[0]..=SLIP_TRACKS[1]).contains(&times))
            .then(|| of_slip_track(robot, recording, found_m))
    });
    let by_positions = over_ground(recording).and_then(|share| {
        (!(OVER_GROUND[0]..=OVER_GROUND[1]).contains(&share)).then(|| {
            doubt(
                robot,
                1.0 / share,
                &format!("over ground the robot moves {share:.2} times as fast as its wheels say"),
            )
        })
    });
    let by_robot = fastest_mps(recording).and_then(|found_mps| {
        let most_mps = robot.max_wheel_speed_mps;
        (found_mps > FASTEST * most_mps).then(|| {
            let statement = format!(
                "wheels turn as fast as {found_mps:.2} m/s and the robot's file has {most_mps:.2} m/s at most"
            );
            // How fast it drove is not known: a factor is at least this.
            doubt(robot, found_mps / most_mps, &statement)
        })
    });
    by_yaw_rate.or(by_positions).or(by_robot).into_iter().collect()
}

/// A doubt about a slip track that no robot has: by the unit of the yaw rate, by that of wheel speeds, or by the difference of both sides alone.
fn of_slip_track(robot: &Robot, recording: &Recording, found_m: f64) -> Doubt {
    let is_robots = |unit: f64| {
        let times = found_m / unit / robot.track_m;
        (SLIP_TRACKS[0]..=SLIP_TRACKS[1]).contains(&times)
    };
    let file_m = robot.slip_track_m;
    let shown =
        format!("the yaw rate means a slip track of {found_m:.3} m and the robot's file has {file_m:.2} m");
    let degrees = 1.0_f64.to_degrees();
    if is_robots(1.0 / degrees) {
        return Doubt {
            name: "yaw_rate_unit",
            statement: format!("{shown}: the yaw rate seems {degrees:.1} times too large"),
            cure: "is it in degrees per second? Give its source the unit `deg/s` in a map".to_owned(),
        };
    }
    let factor = found_m / file_m;
    // Of speeds that the robot drives at, the difference of both sides alone is wrong.
    if units(robot).iter().any(|(_, unit)| is_robots(*unit)) || !is_possible(robot, recording) {
        return doubt(robot, factor, &shown);
    }
    Doubt {
        name: "wheel_separation",
        statement: format!("the difference of both wheel speeds seems {factor:.2} times what turns the robot: {shown}"),
        cure: "where rim speeds were made of speed and yaw rate, by a map or a controller's odometry, give the wheel separation that it was made \
               with (`wheel_separation_m` in a map), or read the encoders; else correct `track_m` of the robot's file"
            .to_owned(),
    }
}

/// Units that wheel speeds come in, over metres per second.
fn units(robot: &Robot) -> [(&'static str, f64); 8] {
    let per_rad = 1.0 / robot.wheel_radius_m;
    [
        ("km/h", 3.6),
        ("mph", 2.237),
        ("ft/s", 3.281),
        ("cm/s", 100.0),
        ("mm/s", 1000.0),
        ("rad/s of a wheel", per_rad),
        ("turns of a wheel per minute", per_rad * 60.0 / std::f64::consts::TAU),
        ("turns of a wheel per second", per_rad / std::f64::consts::TAU),
    ]
}

/// A doubt about wheel speeds that are so many times what they should be.
fn doubt(robot: &Robot, factor: f64, shown: &str) -> Doubt {
    let units = units(robot);
    let off = |unit: f64| (factor / unit).ln().abs();
    let mut near: Vec<&(&str, f64)> = units.iter().filter(|(_, unit)| off(*unit) < LIKE_UNIT.ln()).collect();
    near.sort_by(|a, b| off(a.1).total_cmp(&off(b.1)));
    let names: Vec<String> = near.iter().map(|(name, unit)| format!("{name} ({unit:.2})")).collect();
    let radius_m = robot.wheel_radius_m;
    let cure = if names.is_empty() {
        format!(
            "look at the unit of wheel speeds, at the encoders' scale and at the robot's wheel_radius_m, {radius_m} m"
        )
    } else {
        format!(
            "are they in {}? Give their unit in a map (wheel_radius_m of the robot's file is {radius_m} m)",
            names.join(", or in ")
        )
    };
    Doubt {
        name: "speed_scale",
        statement: format!("wheel speeds seem {factor:.2} times too large: {shown}"),
        cure,
    }
}

/// The slip track that yaw rate and wheel speeds mean together.
pub(super) fn slip_track_m(recording: &Recording) -> Option<f64> {
    turning(recording).map(|[track_m, _]| track_m)
}

/// The same, and the share of the yaw rate's variance that it explains.
fn turning(recording: &Recording) -> Option<[f64; 2]> {
    let [left, right, rate] =
        [Channel::LeftSpeed, Channel::RightSpeed, Channel::YawRate].map(|c| recording.channel(c));
    let (mut n, mut dd, mut dw, mut ww) = (0_usize, 0.0, 0.0, 0.0);
    for ((left, right), rate) in left?.iter().zip(right?).zip(rate?) {
        let difference = right - left;
        if difference.abs() > 2.0 * STANDS_MPS && rate.is_finite() {
            n += 1;
            (dd, dw, ww) = (dd + difference * difference, dw + difference * rate, ww + rate * rate);
        }
    }
    let r2 = dw * dw / (dd * ww);
    (n >= LEAST_ROWS && dw > 0.0 && r2 > LEAST_R2).then(|| [dd / dw, r2])
}

/// Way by positions over way by wheels, of all seconds that move ahead.
fn over_ground(recording: &Recording) -> Option<f64> {
    let [x, y, left, right] =
        [Channel::X, Channel::Y, Channel::LeftSpeed, Channel::RightSpeed].map(|c| recording.channel(c));
    let (x, y, left, right) = (x?, y?, left?, right?);
    let (mut shares, mut from) = (Vec::new(), 0);
    for run in &recording.runs {
        from = from.max(run.rows.start);
        let mut way_m = 0.0;
        for i in run.rows.clone().skip(1) {
            let step_s = recording.t_s[i] - recording.t_s[i - 1];
            way_m += 0.5 * (left[i] + right[i]) * step_s;
            let span_s = recording.t_s[i] - recording.t_s[from];
            if span_s < 1.0 {
                continue;
            }
            let moved_m = (x[i] - x[from]).hypot(y[i] - y[from]);
            // Positions of a robot that stands or turns on the spot are noise, and gaps tell nothing.
            if span_s < 2.0 && moved_m.is_finite() && way_m.abs() > 0.1 {
                shares.push(moved_m / way_m.abs());
            }
            (from, way_m) = (i, 0.0);
        }
        from = run.rows.end;
    }
    let median = shares.len() / 2;
    (shares.len() >= LEAST_ROWS / 2).then(|| *shares.select_nth_unstable_by(median, f64::total_cmp).1)
}

/// Whether wheels turn no faster than the robot can drive, as far as its file knows.
pub(super) fn is_possible(robot: &Robot, recording: &Recording) -> bool {
    fastest_mps(recording).is_none_or(|found_mps| found_mps <= FASTEST * robot.max_wheel_speed_mps)
}

/// 99th percentile of the sizes of wheel speeds.
fn fastest_mps(recording: &Recording) -> Option<f64> {
    let sides = [Channel::LeftSpeed, Channel::RightSpeed].map(|c| recording.channel(c));
    let mut sizes: Vec<f64> =
        sides.into_iter().flatten().flatten().map(|v| v.abs()).filter(|v| v.is_finite()).collect();
    let at = sizes.len() * 99 / 100;
    (sizes.len() >= LEAST_ROWS).then(|| *sizes.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// Doubt about the size of power that may as well be the file's own: a calibration, which mends the file, tells it and goes on.
pub(crate) const POWER_LEVEL: &str = "power_level";

/// Standard deviations of what the robot's file states by which power lies beyond: by chance one in 370.
const FAR_SIGMAS: f64 = 3.0;

/// A doubt about the size of power on ground that the robot's file knows by name, where it predicts worse than a constant would: power is a sum
/// of products of friction, mass and motor constants, so that no error of its parts makes it more uncertain than all of them together.
pub(super) fn on_known_ground(robot: &Robot, recording: &Recording, followed: &Followed) -> Option<Doubt> {
    let Varies { r, over_predicted, determined, .. } = followed.varies?;
    let labels = recording.surface.as_ref()?;
    let rows = recording.runs.iter().flat_map(|run| run.rows.clone());
    let is_known =
        rows.clone().all(|row| labels.get(row).is_some_and(|name| robot.surfaces.contains_key(name)));
    let u = &robot.uncertainty;
    let sigma = [u.mu_roll, u.mu_skid, u.k1, u.k2, u.mass_kg].iter().map(|u| u * u).sum::<f64>().sqrt();
    let most = (FAR_SIGMAS * sigma).exp();
    // Errors of either leave the truth between the lines of one on the other and the other way round.
    let (low, high) = (over_predicted * r, over_predicted / r);
    let is_beyond = r * r > LEAST_R2 && r > 0.0 && (high < 1.0 / most || low > most);
    (is_known && is_beyond && determined < 0.0).then(|| Doubt {
        name: POWER_LEVEL,
        statement: format!(
            "recorded power varies {over_predicted:.2} times as much as the robot's file predicts on ground that it knows, and its `uncertainty` lets it vary {:.2} to \
             {most:.2} times as much; it predicts worse than the mean does (R² {determined:.1})",
            1.0 / most
        ),
        cure: "does the recording tell the power of one of two batteries or sides, or in another unit? Else the robot's file is not this robot's, or \
               the ground is not what it is called"
            .to_owned(),
    })
}

/// Doubts about the size of power.
pub(super) fn power(followed: &Followed) -> Option<Doubt> {
    let ratio = followed.ratio?;
    // Of the wrong sign something else is told.
    if ratio <= 0.0 || (POWERS[0]..POWERS[1]).contains(&ratio) {
        return None;
    }
    let units =
        [("kilowatts", 1e-3), ("milliwatts", 1e3), ("milliamperes or millivolts", 1e3), ("microwatts", 1e6)];
    let near: Vec<&str> = units
        .iter()
        .filter(|(_, unit)| (ratio / unit).ln().abs() < 2.5_f64.ln())
        .map(|(name, _)| *name)
        .collect();
    let told = match ratio {
        100.0..1e6 => format!("{ratio:.0}"),
        0.01..100.0 => format!("{ratio:.2}"),
        _ => format!("{ratio:.1e}"),
    };
    Some(Doubt {
        name: "power_scale",
        statement: format!("recorded power is {told} times what the robot's file predicts"),
        cure: match near.first() {
            Some(unit) => format!("is it in {unit}? Give its unit in a map"),
            None => "the recording may be another robot's, or power in another unit".to_owned(),
        },
    })
}
