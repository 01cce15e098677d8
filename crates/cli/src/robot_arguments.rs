//! Which robot drives, under what load and on which ground.

use clap::Args;
use model::{Robot, builtin, robot::RobotFile};
use service::routes::robots::RobotChoice;

use crate::{failure::BadInput, recorded::robot};

/// Robot, load and ground of a plan.
#[derive(Args)]
pub(crate) struct RobotArguments {
    /// Name of a built-in robot, or a robot file
    #[arg(long, default_value = "husky-a200")]
    robot: String,
    /// Ground where the map names none, one of the robot's surfaces [default: the robot's default surface]
    #[arg(long)]
    surface: Option<String>,
    /// Load on the middle of the robot, besides its mass [kg] [default: none]
    #[arg(long, allow_hyphen_values = true)]
    payload_kg: Option<f64>,
}

impl RobotArguments {
    /// Reads the robot. A built-in one as it is stays a name.
    ///
    /// # Errors
    /// No such robot, a file that describes none, a surface that it lacks, or a load that is no mass.
    pub(crate) fn read(&self) -> anyhow::Result<RobotChoice> {
        let is_changed = self.surface.is_some() || self.payload_kg.is_some();
        if !is_changed && builtin::by_name(&self.robot).is_ok() {
            return Ok(RobotChoice::Name(self.robot.clone()));
        }
        let robot = self.loaded(self.grounded(robot(&self.robot)?)?)?;
        Ok(RobotChoice::File(Box::new(RobotFile::from(robot))))
    }

    fn grounded(&self, mut robot: Robot) -> Result<Robot, BadInput> {
        let Some(surface) = &self.surface else { return Ok(robot) };
        if !robot.surfaces.contains_key(surface) {
            let known: Vec<&str> = robot.surfaces.keys().map(String::as_str).collect();
            let detail = format!(
                "--surface {surface}: `{}` has no such surface; it has {}: give one of these, or add it to the robot file",
                robot.name,
                known.join(", ")
            );
            return Err(BadInput(detail));
        }
        robot.default_surface.clone_from(surface);
        Ok(robot)
    }

    fn loaded(&self, mut robot: Robot) -> Result<Robot, BadInput> {
        let Some(payload_kg) = self.payload_kg else { return Ok(robot) };
        if !(payload_kg >= 0.0 && payload_kg.is_finite()) {
            return Err(BadInput(format!("--payload-kg is {payload_kg}, but must be 0 or more")));
        }
        robot.mass_kg += payload_kg;
        robot.validate().map_err(|error| BadInput(format!("--payload-kg {payload_kg}: {error}")))?;
        Ok(robot)
    }
}
