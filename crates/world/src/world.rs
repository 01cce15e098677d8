//! The world file: where the robot drives, how it is measured and what acts on it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::{Effect, Error, Sensors, limits::within};

/// Where a robot drives, with which sensors, and what is concealed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct World {
    /// The shape of the ground.
    pub terrain: Relief,
    /// Surface of ground that neither a patch nor the map names; default: the robot's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
    /// Rectangles of other ground; later ones lie over earlier ones. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub patches: Vec<Patch>,
    /// Air temperature [°C]. Default: the robot's reference temperature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ambient_temp_c: Option<f64>,
    /// Wind that is no secret. Default: no air at all, as the model of a healthy robot has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wind: Option<Wind>,
    /// How the drive is recorded. Default: a good set of sensors.
    #[serde(default)]
    pub sensors: Sensors,
    /// How far the healthy robot may be from its file, in units of the file's own `uncertainty`, 0 to 3. Default 0.
    #[serde(default)]
    pub scatter: f64,
    /// Seed of sensor noise, below 2⁵³. Default 0.
    #[serde(default)]
    pub seed: u64,
    /// Seed of what one robot keeps from drive to drive: the scatter and the sensors' biases. Default: `seed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot_seed: Option<u64>,
    /// Longest step of the integration, 0.0001 to 0.001 [s]; a whole number of steps makes a row. Default 0.001.
    #[serde(default = "step_s")]
    pub step_s: f64,
    /// What acts beyond the robot file. Default: nothing, a healthy robot.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<Effect>,
}

/// The shape of the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Relief {
    /// Flat and level.
    Level,
    /// A slope that is the same everywhere.
    Plane {
        /// Rise over run, 0 to 0.6.
        grade: f64,
        /// Direction of the steepest climb, counter-clockwise from east [rad]. Default 0.
        #[serde(default)]
        uphill_rad: f64,
    },
    /// Smooth hills without an end.
    Rolling {
        /// Root mean square of the slope, 0 to 0.3.
        grade: f64,
        /// Length of the longest waves [m]. Default 20.
        #[serde(default = "length_m")]
        length_m: f64,
        /// Which hills. Default 0.
        #[serde(default)]
        seed: u64,
    },
    /// A map file, as the planner reads it; a relative path counts from the world file. Obstacles do not stop a drive.
    Map(MapPath),
}

/// Where a map file lies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(value_type = String))]
#[serde(transparent)]
pub struct MapPath(pub PathBuf);

/// A rectangle of other ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Its surface, one of the robot's.
    pub surface: String,
    /// From west to east [m].
    pub x_m: [f64; 2],
    /// From south to north [m].
    pub y_m: [f64; 2],
}

/// A steady wind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Its speed, 0 to 40 [m/s].
    pub speed_mps: f64,
    /// Where it blows to, counter-clockwise from east [rad].
    pub toward_rad: f64,
}

impl World {
    /// Reads and checks a world; a relative map counts from the working directory.
    ///
    /// # Errors
    /// The place of whatever is missing, unknown or out of range.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let world: World = document::from_json(text.as_bytes())?;
        world.check()?;
        Ok(world)
    }

    /// The same with a relative map counted from a folder.
    #[must_use]
    pub fn beside(mut self, folder: &Path) -> Self {
        if let Relief::Map(path) = &mut self.terrain {
            path.0 = folder.join(&path.0);
        }
        self
    }

    /// A healthy robot in the same world under the same noise.
    #[must_use]
    pub fn without_effects(&self) -> Self {
        World { effects: Vec::new(), ..self.clone() }
    }

    /// Seed of what the robot keeps from drive to drive.
    pub(crate) fn robot_seed(&self) -> u64 {
        self.robot_seed.unwrap_or(self.seed)
    }

    /// Checks every range; reading does this already, code that builds a world may call it.
    ///
    /// # Errors
    /// The first field that cannot be right.
    pub fn check(&self) -> Result<(), Error> {
        match &self.terrain {
            Relief::Level | Relief::Map(_) => {}
            Relief::Plane { grade, uphill_rad, .. } => {
                within("terrain.plane.uphill_rad", *uphill_rad, [-10.0, 10.0], "give radians")?;
                within("terrain.plane.grade", *grade, [0.0, 0.6], "rise over run")?;
            }
            Relief::Rolling { grade, length_m, .. } => {
                within("terrain.rolling.grade", *grade, [0.0, 0.3], "root mean square of rise over run")?;
                within(
                    "terrain.rolling.length_m",
                    *length_m,
                    [3.0, 1e4],
                    "give metres, longer than the robot",
                )?;
            }
        }
        for (i, patch) in self.patches.iter().enumerate() {
            for (axis, [low, high]) in [("x_m", patch.x_m), ("y_m", patch.y_m)] {
                within(
                    format!("patches[{i}].{axis}[1]"),
                    high,
                    [low, f64::MAX],
                    "give the smaller number first",
                )?;
            }
        }
        if let Some(ambient_temp_c) = self.ambient_temp_c {
            within("ambient_temp_c", ambient_temp_c, [-40.0, 60.0], "give degrees Celsius")?;
        }
        if let Some(wind) = self.wind {
            within("wind.speed_mps", wind.speed_mps, [0.0, 40.0], "give metres per second")?;
            within("wind.toward_rad", wind.toward_rad, [-10.0, 10.0], "give radians")?;
        }
        within("scatter", self.scatter, [0.0, 3.0], "in units of the robot's uncertainty")?;
        for (field, seed) in [("seed", self.seed), ("robot_seed", self.robot_seed())] {
            within(field, seed as f64, [0.0, 9_007_199_254_740_991.0], "give a number below 2^53")?;
        }
        within("step_s", self.step_s, [1e-4, 1e-3], "stiff tyres need a millisecond or less")?;
        self.sensors.check()?;
        self.effects.iter().enumerate().try_for_each(|(i, effect)| effect.check(i))
    }
}

fn step_s() -> f64 {
    0.001
}
fn length_m() -> f64 {
    20.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_right_is_refused_by_field() {
        let level = |rest: &str| format!(r#"{{"terrain": "level", {rest}}}"#);
        for (text, field) in [
            (level(r#""colour": 1"#), "colour"),
            (level(r#""scatter": -1"#), "scatter"),
            (level(r#""step_s": 0.1"#), "step_s"),
            (level(r#""wind": {"speed_mps": 400, "toward_rad": 0}"#), "wind.speed_mps"),
            (
                level(r#""patches": [{"surface": "marble", "x_m": [3, 1], "y_m": [0, 1]}]"#),
                "patches[0].x_m[1]",
            ),
            (level(r#""effects": [{"effect": "gremlins", "strength": 1}]"#), "effects[0].effect"),
            (level(r#""effects": [{"effect": "payload", "strength": 1e6}]"#), "effects[0].strength"),
            (level(r#""effects": [{"effect": "payload"}]"#), "strength"),
            (level(r#""sensors": {"rate_hz": 1e9}"#), "sensors.rate_hz"),
            (level(r#""sensors": {"colour": 1}"#), "colour"),
            (r#"{"terrain": {"plane": {"grade": 2}}}"#.into(), "terrain.plane.grade"),
            (r#"{"terrain": "moon"}"#.into(), "moon"),
            (r#"{}"#.into(), "terrain"),
        ] {
            let message = World::from_json(&text).unwrap_err().to_string();
            assert!(message.contains(field), "{text}\n  said: {message}");
        }
    }

    #[test]
    fn a_world_survives_a_round_trip() {
        let text =
            r#"{"terrain": {"rolling": {"grade": 0.05}}, "effects": [{"effect": "wind", "strength": 9}]}"#;
        let world = World::from_json(text).unwrap();
        assert_eq!(World::from_json(&serde_json::to_string(&world).unwrap()).unwrap(), world);
        assert!(world.without_effects().effects.is_empty());
    }
}
