//! How a path is to be steered: what it should avoid, where it may go, and which ends will do.

use planner::{Goal, Prices, Settings};
use serde::Deserialize;
use terrain::{
    Terrain,
    areas::{Areas, UnknownGround},
};
use utoipa::ToSchema;

use super::{GoalPose, PlanRequest};
use crate::problem::{Problem, ProblemType};

/// What manoeuvres weigh in comparisons besides what they take: joules where energy is to be least, seconds where time is.
#[derive(Clone, Copy, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PricesRequest {
    /// Of backing up, 0 to 100 000. Default: 0 [J/m].
    #[schema(minimum = 0.0, maximum = 100000.0)]
    pub reverse_j_per_m: f64,
    /// Of backing up, 0 to 100 000. Default: 0 [s/m].
    #[schema(minimum = 0.0, maximum = 100000.0)]
    pub reverse_s_per_m: f64,
    /// Of turning on the spot, 0 to 100 000. Default: 0 [J/rad].
    #[schema(minimum = 0.0, maximum = 100000.0)]
    pub spin_j_per_rad: f64,
    /// Of turning on the spot, 0 to 100 000. Default: 0 [s/rad].
    #[schema(minimum = 0.0, maximum = 100000.0)]
    pub spin_s_per_rad: f64,
    /// Of changing between driving ahead and backing up, 0 to 100 000. Default: 0 [J].
    #[schema(minimum = 0.0, maximum = 100000.0)]
    pub direction_change_j: f64,
    /// Of changing between driving ahead and backing up, 0 to 100 000. Default: 0 [s].
    #[schema(minimum = 0.0, maximum = 100000.0)]
    pub direction_change_s: f64,
    /// Whether stops on the way weigh the energy that they take (`stops_j` of the answer). Default: false.
    pub stops: bool,
}

/// What the robot is not to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ForbidName {
    /// Back up.
    Reverse,
    /// Turn on the spot.
    Spin,
}

/// Which headings will do beside the one that is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GoalHeading {
    /// The opposite one too.
    Either,
}

/// What unknown ground is taken for where the robot may drive on it.
#[derive(Clone, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct UnknownGroundRequest {
    /// What it is made of, one of the robot's surfaces. Default: the robot's default surface.
    pub surface: Option<String>,
    /// What a metre of it weighs besides what it takes, for what may lie there, 0 to 100 000. Default: 0 [J/m].
    #[serde(default)]
    #[schema(minimum = 0.0, maximum = 100000.0)]
    pub risk_j_per_m: f64,
}

impl From<PricesRequest> for Prices {
    fn from(prices: PricesRequest) -> Self {
        Prices {
            reverse_j_per_m: prices.reverse_j_per_m,
            reverse_s_per_m: prices.reverse_s_per_m,
            spin_j_per_rad: prices.spin_j_per_rad,
            spin_s_per_rad: prices.spin_s_per_rad,
            direction_change_j: prices.direction_change_j,
            direction_change_s: prices.direction_change_s,
            stops: prices.stops,
        }
    }
}

impl From<&GoalPose> for Goal {
    fn from(goal: &GoalPose) -> Self {
        Goal {
            x_m: goal.x_m,
            y_m: goal.y_m,
            heading_rad: goal.heading_rad,
            either_way: goal.heading.is_some(),
            tolerance_m: goal.tolerance_m,
        }
    }
}

fn refused(pointer: &str, detail: String) -> Problem {
    Problem::new(ProblemType::InvalidRequest, detail).at(pointer)
}

impl PlanRequest {
    /// Refuses what the request says of steering that contradicts itself, before anything is worked out.
    ///
    /// # Errors
    /// The first contradiction.
    pub fn check_steering(&self) -> Result<(), Problem> {
        match (self.goal.is_given(), &self.goals) {
            (true, Some(_)) => {
                return Err(refused(
                    "/goals",
                    "the request has both goal and goals: give one of them".into(),
                ));
            }
            (false, Some(goals)) if goals.is_empty() || goals.len() > Self::MOST_GOALS => {
                let (found, most) = (goals.len(), Self::MOST_GOALS);
                return Err(refused(
                    "/goals",
                    format!("goals has {found} entries, but 1 to {most} are weighed"),
                ));
            }
            (false, None) => {
                let detail =
                    "missing field `goal`: give goal, or goals for several of which the best is reached";
                return Err(refused("/goal", detail.into()));
            }
            _ => {}
        }
        for (pointer, goal) in self.goals_with_pointers() {
            if goal.heading.is_some() && goal.heading_rad.is_none() {
                let detail = "heading is given without heading_rad: give the heading of which the opposite will do too";
                return Err(refused(&format!("{pointer}/heading"), detail.into()));
            }
        }
        if self.reverse && self.forbids(ForbidName::Reverse) {
            let detail = "reverse is true, but forbid names it too: give one of them";
            return Err(refused("/forbid", detail.into()));
        }
        Ok(())
    }

    /// Most goals of a request.
    const MOST_GOALS: usize = 64;

    fn goals_with_pointers(&self) -> Vec<(String, &GoalPose)> {
        match &self.goals {
            Some(goals) => goals.iter().enumerate().map(|(i, goal)| (format!("/goals/{i}"), goal)).collect(),
            None => vec![("/goal".to_owned(), &self.goal)],
        }
    }

    fn forbids(&self, name: ForbidName) -> bool {
        self.forbid.contains(&name)
    }

    /// The settings with what the request says of steering.
    pub(crate) fn steered(&self, settings: Settings) -> Settings {
        Settings {
            prices: self.prices.unwrap_or_default().into(),
            spin: !self.forbids(ForbidName::Spin),
            least_radius_m: self.least_radius_m.unwrap_or(0.0),
            heed_preferences: self.preferences,
            ..settings
        }
    }

    /// Limits hold amounts that a path takes; they are not sought together with what only comparisons weigh.
    ///
    /// # Errors
    /// A limit on a path that preferences are weighed for.
    pub(crate) fn check_limits(&self, has_preferences: bool) -> Result<(), Problem> {
        let limits = [
            ("max_time_s", self.max_time_s),
            ("max_energy_j", self.max_energy_j),
            ("max_distance_m", self.max_distance_m),
        ];
        match limits.into_iter().find(|(_, limit)| limit.is_some() && (has_preferences || self.partial)) {
            None => Ok(()),
            Some((field, _)) if self.partial => {
                let detail =
                    format!("{field} is held over whole paths, but partial is true: leave out one of them");
                Err(Problem::new(ProblemType::LimitsContradict, detail).at(format!("/{field}")))
            }
            Some((field, _)) => {
                let detail = format!(
                    "{field} cannot be held together with prices, cost factors of areas or a risk of unknown ground: leave out one of them"
                );
                Err(Problem::new(ProblemType::LimitsContradict, detail).at(format!("/{field}")))
            }
        }
    }

    /// The ground with the request's own areas over it, and unknown ground opened if it asks for that; `None` where it changes nothing.
    ///
    /// # Errors
    /// Areas that cannot be, or that lie on a map with areas of its own; a risk out of range.
    pub(crate) fn ground(&self, terrain: &Terrain) -> Result<Option<Terrain>, Problem> {
        let mut changed = None;
        if let Some(areas) = self.areas.as_ref().filter(|areas| !areas.is_null()) {
            let areas = Areas::of(areas, terrain).map_err(|error| Problem::invalid_areas(&error))?;
            changed = Some(terrain.clone().with_areas(areas));
        }
        if let Some(unknown) = &self.unknown_ground {
            let UnknownGroundRequest { surface, risk_j_per_m } = unknown.clone();
            let ground = changed.unwrap_or_else(|| terrain.clone());
            let opened = ground.with_unknown_ground(UnknownGround { surface, risk_j_per_m });
            changed = Some(opened.map_err(|error| Problem::invalid_areas(&error))?);
        }
        Ok(changed)
    }

    /// What tells the request's own ground from that of its map, among planners that are kept.
    pub(crate) fn ground_key(&self, map_id: &str) -> String {
        use sha2::{Digest, Sha256};
        let mut hash = Sha256::new();
        hash.update(self.areas.as_ref().map(ToString::to_string).unwrap_or_default());
        if let Some(UnknownGroundRequest { surface, risk_j_per_m }) = &self.unknown_ground {
            hash.update(format!("{surface:?} {risk_j_per_m}"));
        }
        let digest: String = hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect();
        format!("{map_id}+{digest}")
    }
}

impl GoalPose {
    /// Whether any coordinate is given.
    fn is_given(&self) -> bool {
        !(self.x_m.is_nan() && self.y_m.is_nan() && self.lon_deg.is_none() && self.lat_deg.is_none())
    }

    /// A goal that is not given.
    pub fn absent() -> Self {
        GoalPose::in_metres([f64::NAN, f64::NAN], None)
    }
}
