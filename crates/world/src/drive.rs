//! The drive file: which manoeuvres, for how long, from where.

use serde::{Deserialize, Serialize};

use crate::{Error, limits::within};

/// What the robot is told to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Which manoeuvres.
    pub kind: DriveKind,
    /// How long each run lasts, 1 to 100 000 [s].
    pub duration_s: f64,
    /// Which of its kind, below 2⁵³. Default 0.
    #[serde(default)]
    pub seed: u64,
    /// How many runs, one after the other, each from another place. Default 1.
    #[serde(default = "one")]
    pub runs: usize,
    /// Fastest speed [m/s]. Default: 0.9 of what the wheels can do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_mps: Option<f64>,
    /// Where it begins; default: near the middle of the ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Waypoint>,
    /// The poses of a `path`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<Waypoint>,
}

/// Kinds of drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveKind {
    /// Straights, arcs, point turns and stops of many speeds and radii, forward and back.
    Rich,
    /// Lanes side by side.
    LawnMower,
    /// One heading at changing speed, turned round at the end of the ground.
    Straight,
    /// Starts and stops.
    StopAndGo,
    /// Up and down the steepest slope.
    Hill,
    /// Along given poses, such as a plan's.
    Path,
}

/// A pose to begin at or to pass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// East [m].
    pub x_m: f64,
    /// North [m].
    pub y_m: f64,
    /// Heading, counter-clockwise from east [rad]. Default: towards the next pose, or any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading_rad: Option<f64>,
}

/// The part of a plan's answer that a drive needs.
#[derive(Deserialize)]
struct Plan {
    duration_s: f64,
    poses: Vec<PlanPose>,
}

#[derive(Deserialize)]
struct PlanPose {
    x_m: f64,
    y_m: f64,
    heading_rad: Option<f64>,
}

/// Drives take longer than plans say: they start, stop and steer.
const LONGER_THAN_PLANNED: f64 = 1.5;

impl Drive {
    /// A drive of a kind near the middle of the ground.
    pub fn new(kind: DriveKind, duration_s: f64, seed: u64) -> Self {
        Drive { kind, duration_s, seed, runs: 1, speed_mps: None, start: None, poses: Vec::new() }
    }

    /// Reads and checks a drive, or the answer of `joulepath plan --json`, which is driven as a `path`.
    ///
    /// # Errors
    /// The place of whatever is missing, unknown or out of range.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let document: serde_json::Value = document::from_json(text.as_bytes())?;
        let is_plan = document.get("kind").is_none() && document.get("poses").is_some();
        let drive = if is_plan {
            Self::of_plan(&document::from_json(text.as_bytes())?)
        } else {
            document::from_json(text.as_bytes())?
        };
        drive.check()?;
        Ok(drive)
    }

    fn of_plan(plan: &Plan) -> Self {
        let waypoint = |p: &PlanPose| Waypoint { x_m: p.x_m, y_m: p.y_m, heading_rad: p.heading_rad };
        Drive {
            poses: plan.poses.iter().map(waypoint).collect(),
            ..Drive::new(DriveKind::Path, (LONGER_THAN_PLANNED * plan.duration_s + 10.0).ceil(), 0)
        }
    }

    /// Checks every range; reading does this already.
    ///
    /// # Errors
    /// The first field that cannot be right.
    pub fn check(&self) -> Result<(), Error> {
        const FAR_M: [f64; 2] = [-5e7, 5e7];
        within("duration_s", self.duration_s, [1.0, 1e5], "give seconds")?;
        within("seed", self.seed as f64, [0.0, 9_007_199_254_740_991.0], "give a number below 2^53")?;
        within("runs", self.runs as f64, [1.0, 1000.0], "give a number of runs")?;
        if let Some(speed_mps) = self.speed_mps {
            within("speed_mps", speed_mps, [0.05, 20.0], "give metres per second")?;
        }
        for (i, pose) in self.poses.iter().chain(&self.start).enumerate() {
            let field = if i < self.poses.len() { format!("poses[{i}]") } else { "start".into() };
            within(format!("{field}.x_m"), pose.x_m, FAR_M, "give metres")?;
            within(format!("{field}.y_m"), pose.y_m, FAR_M, "give metres")?;
            if let Some(heading_rad) = pose.heading_rad {
                within(format!("{field}.heading_rad"), heading_rad, [-10.0, 10.0], "give radians")?;
            }
        }
        if self.kind == DriveKind::Path && self.poses.len() < 2 {
            return Err(Error::Missing { field: "poses".into(), hint: "a path needs two poses or more" });
        }
        Ok(())
    }
}

fn one() -> usize {
    1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_is_driven_as_a_path_and_its_other_fields_do_not_matter() {
        let plan = r#"{"energy_j": 5, "duration_s": 20, "poses": [
            {"x_m": 0, "y_m": 0, "heading_rad": 0, "z_m": 1}, {"x_m": 5, "y_m": 0, "heading_rad": 0, "z_m": 1}]}"#;
        let drive = Drive::from_json(plan).unwrap();
        assert_eq!((drive.kind, drive.poses.len(), drive.duration_s), (DriveKind::Path, 2, 40.0));
    }

    #[test]
    fn bad_drives_are_refused_by_field() {
        for (text, field) in [
            (r#"{"kind": "rich"}"#, "duration_s"),
            (r#"{"kind": "rich", "duration_s": -5}"#, "duration_s"),
            (r#"{"kind": "rich", "duration_s": 1e300}"#, "duration_s"),
            (r#"{"kind": "rich", "duration_s": 1e999}"#, "duration_s"),
            (r#"{"duration_s": 1e300, "poses": [{"x_m": 0, "y_m": 0}, {"x_m": 1, "y_m": 0}]}"#, "duration_s"),
            (r#"{"kind": "rich", "duration_s": 5, "runs": 1000000000000}"#, "runs"),
            (r#"{"kind": "waltz", "duration_s": 5}"#, "waltz"),
            (r#"{"kind": "rich", "duration_s": 5, "colour": 1}"#, "colour"),
            (r#"{"kind": "path", "duration_s": 5}"#, "poses"),
            (r#"{"kind": "rich", "duration_s": 5, "start": {"x_m": 1e99, "y_m": 0}}"#, "start.x_m"),
        ] {
            let message = Drive::from_json(text).unwrap_err().to_string();
            assert!(message.contains(field), "{text} said {message}");
        }
    }
}
