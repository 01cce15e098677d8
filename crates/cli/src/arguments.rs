//! Arguments that several commands take, and what they mean.

use std::{path::PathBuf, str::FromStr, time::Instant};

use clap::Args;
use model::PowerModel;
use service::{
    Limits, Patience,
    routes::{
        plan::{GoalHeading, GoalPose, ObjectiveName, PlanRequest, StartPose},
        robots::RobotChoice,
    },
};
use terrain::{
    Terrain, Warning,
    areas::UnknownGround,
    io::{self, Georeference},
};

use crate::{
    areas_file,
    failure::{BadInput, Refused},
    output,
    robot_arguments::RobotArguments,
    steering::Steering,
};

/// A place on the map with a heading if one is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    coordinates: Coordinates,
    heading_deg: Option<f64>,
}

/// How a place is given.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinates {
    /// The map's x and y [m].
    Metres([f64; 2]),
    /// Of the map's extent, east and north [-].
    Fraction([f64; 2]),
    /// Longitude and latitude on WGS 84 [°].
    Degrees([f64; 2]),
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{text}` is not X,Y or X,Y,HEADING_DEG in metres, nor @FX,FY in fractions of the map, nor latitude and longitude as 46.5046N,93.9217W"
            )
        };
        if let Some(place) = degrees(text) {
            return place;
        }
        let (given, numbers): (fn([f64; 2]) -> Coordinates, _) = match text.strip_prefix('@') {
            Some(rest) => (Coordinates::Fraction, rest),
            None => (Coordinates::Metres, text),
        };
        let parsed: Result<Vec<f64>, _> = numbers.split(',').map(|part| part.trim().parse::<f64>()).collect();
        let values = parsed.map_err(|_| wrong())?;
        if values.iter().any(|v| !v.is_finite()) {
            return Err(wrong());
        }
        match values[..] {
            [x, y] => Ok(Place { coordinates: given([x, y]), heading_deg: None }),
            [x, y, heading] => {
                Ok(Place { coordinates: given([x, y]), heading_deg: Some(checked_heading(text, heading)?) })
            }
            _ => Err(wrong()),
        }
    }
}

fn checked_heading(text: &str, heading_deg: f64) -> Result<f64, String> {
    if heading_deg.abs() <= 360.0 {
        return Ok(heading_deg);
    }
    Err(format!("the heading of `{text}` is {heading_deg}, but must lie in -360 to 360 degrees"))
}

/// Latitude and longitude, each with its letter, in either order, and a heading if one is given; `None` for any other form.
fn degrees(text: &str) -> Option<Result<Place, String>> {
    let mut parts = text.split(',').map(str::trim);
    let mut lettered = || {
        let part = parts.next()?;
        let letter = part.chars().last()?.to_ascii_uppercase();
        let value: f64 =
            part.strip_suffix(|last: char| last.to_ascii_uppercase() == letter)?.trim().parse().ok()?;
        let most = if matches!(letter, 'N' | 'S') { 90.0 } else { 180.0 };
        ("NSEW".contains(letter) && (0.0..=most).contains(&value)).then_some((letter, value))
    };
    let (first, second) = (lettered()?, lettered()?);
    let signed = |letters: [char; 2]| {
        let (letter, value) = [first, second].into_iter().find(|(letter, _)| letters.contains(letter))?;
        Some(if letter == letters[0] { value } else { -value })
    };
    let coordinates = Coordinates::Degrees([signed(['E', 'W'])?, signed(['N', 'S'])?]);
    let heading = parts.next().map(str::parse::<f64>);
    if parts.next().is_some() {
        return None;
    }
    Some(match heading {
        None => Ok(Place { coordinates, heading_deg: None }),
        Some(Ok(heading)) => {
            checked_heading(text, heading).map(|heading| Place { coordinates, heading_deg: Some(heading) })
        }
        Some(Err(_)) => Err(format!("the heading of `{text}` is no number of degrees")),
    })
}

impl Place {
    /// The place as a pose of a map.
    ///
    /// # Errors
    /// Degrees on a map that does not say where on earth it lies.
    pub(crate) fn pose_on(&self, terrain: &Terrain) -> anyhow::Result<StartPose> {
        Ok(StartPose::in_metres(self.on(terrain)?, self.heading_rad()))
    }

    /// The heading, counter-clockwise from east [rad].
    pub(crate) fn heading_rad(&self) -> Option<f64> {
        self.heading_deg.map(f64::to_radians)
    }

    /// The place in metres of a map.
    ///
    /// # Errors
    /// Degrees on a map that does not say where on earth it lies.
    pub(crate) fn on(&self, terrain: &Terrain) -> anyhow::Result<[f64; 2]> {
        match self.coordinates {
            Coordinates::Metres(place_m) => Ok(place_m),
            Coordinates::Fraction([east, north]) => Ok(terrain.grid.at_fraction_m(east, north)),
            Coordinates::Degrees(place_deg) => {
                let place_m = terrain.place_m(place_deg);
                place_m.map_err(|error| {
                    let [lon, lat] = place_deg;
                    BadInput(format!("{lat}N,{lon}E is given in degrees, and {error}: give X,Y in metres"))
                        .into()
                })
            }
        }
    }
}

/// A map and how it is to be read.
#[derive(Args)]
pub(crate) struct MapArguments {
    /// Map file: .json grid, .asc or .asc.gz ESRI ASCII, .tif GeoTIFF, .npy numpy array, .hgt SRTM tile, .yaml ROS map
    #[arg(long)]
    map: PathBuf,
    #[command(flatten)]
    reading: MapReading,
    /// Areas over the map, in place of those that it has: a GeoJSON file of polygons and lines whose properties may be surface,
    /// keep_out, max_speed_mps, cost_factor and one_way_rad; or a GeoTIFF of classes, as ESA WorldCover, with --area-classes
    #[arg(long, value_name = "FILE")]
    areas: Option<PathBuf>,
    /// What the classes of a raster change, for --areas: a JSON file from class to properties, as {"80": {"keep_out": true}}
    #[arg(long, value_name = "FILE", requires = "areas")]
    area_classes: Option<PathBuf>,
    /// Open unknown ground to the robot, as this surface of it
    #[arg(long, value_name = "SURFACE", num_args = 0..=1, default_missing_value = "")]
    unknown_ground: Option<String>,
    /// What a metre of unknown ground weighs besides what it takes [J/m]
    #[arg(long, default_value_t = 0.0, requires = "unknown_ground")]
    risk_j_per_m: f64,
}

/// How a map is to be read.
#[derive(Args)]
struct MapReading {
    /// Fill holes of unknown ground up to this wide from the ground around them [m] [default: none]
    #[arg(long, visible_alias = "fill-voids", value_name = "M")]
    fill_voids_m: Option<f64>,
    /// Elevation of unknown cells, beside those that the map marks [m] [default: none]
    #[arg(long, value_name = "V", allow_hyphen_values = true)]
    nodata: Option<f64>,
    /// Edge of a cell of a numpy array, which needs it [m]
    #[arg(long, value_name = "M")]
    cell_size_m: Option<f64>,
    /// South-west corner of a numpy array [m] [default: 0,0]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = Georeference::parse_origin_m)]
    origin_m: Option<[f64; 2]>,
    /// Coordinate reference system of a numpy array, as EPSG:26915 or WKT [default: unknown]
    #[arg(long)]
    crs: Option<String>,
}

impl MapReading {
    fn options(&self) -> io::Options {
        let georeference =
            Georeference { cell_size_m: self.cell_size_m, origin_m: self.origin_m, crs: self.crs.clone() };
        io::Options {
            nodata_m: self.nodata,
            fill_voids_m: self.fill_voids_m,
            georeference,
            ..io::Options::default()
        }
    }
}

impl MapArguments {
    /// Reads the map; what is doubtful about it goes to standard error.
    pub(crate) fn read(&self) -> anyhow::Result<Terrain> {
        let path = &self.map;
        let terrain = io::read_path_as(path, &self.reading.options()).map_err(|error| {
            let message = error.to_string();
            let named = message.contains(&path.display().to_string());
            BadInput(if named { message } else { format!("{}: {message}", path.display()) })
        })?;
        let terrain = self.with_areas(terrain)?;
        warn(terrain.warnings());
        Ok(terrain)
    }

    /// The map with the areas of a file over it, and unknown ground opened if that is asked for.
    fn with_areas(&self, mut terrain: Terrain) -> anyhow::Result<Terrain> {
        if let Some(path) = &self.areas {
            let areas = areas_file::read(path, self.area_classes.as_deref(), &terrain)?;
            terrain = terrain.with_areas(areas);
        }
        if let Some(surface) = &self.unknown_ground {
            let surface = (!surface.is_empty()).then(|| surface.clone());
            let unknown = UnknownGround { surface, risk_j_per_m: self.risk_j_per_m };
            terrain = terrain
                .with_unknown_ground(unknown)
                .map_err(|error| BadInput(format!("--risk-j-per-m {}", error.what)))?;
        }
        Ok(terrain)
    }
}

/// Prints warnings to standard error, a line each.
pub(crate) fn warn<'a>(warnings: impl IntoIterator<Item = &'a Warning>) {
    for warning in warnings {
        output::note(format_args!("warning: {}", warning.detail));
    }
}

/// Prints those warnings of an answer that are not of its map, which have been printed when it was read.
pub(crate) fn warn_of_answer(warnings: &[Warning], terrain: &Terrain) {
    warn(warnings.iter().filter(|warning| !terrain.warnings().contains(warning)));
}

/// Map, robot and how to drive: what all commands over a map share.
#[derive(Args)]
pub(crate) struct Driving {
    #[command(flatten)]
    map: MapArguments,
    #[command(flatten)]
    robot: RobotArguments,
    /// Forward speed [m/s]; default half the wheels' top speed
    #[arg(long)]
    pub(crate) speed_mps: Option<f64>,
    /// How far a place may be moved to free ground [m]; default one cell
    #[arg(long)]
    pub(crate) snap_radius_m: Option<f64>,
    /// Form of the physics: force-balance or dogru-marques
    #[arg(long, default_value = "force-balance", value_parser = power_model)]
    pub(crate) power_model: PowerModel,
    /// Let the robot back up
    #[arg(long)]
    pub(crate) reverse: bool,
    /// Time for the answer [s] [default: 600]
    #[arg(long)]
    pub(crate) timeout_s: Option<f64>,
    /// Print the answer as the JSON document that the HTTP API returns
    #[arg(long)]
    pub(crate) json: bool,
}

impl Driving {
    /// Reads the map and the robot.
    pub(crate) fn read(&self) -> anyhow::Result<(Terrain, RobotChoice)> {
        Ok((self.map.read()?, self.robot.read()?))
    }
}

/// Hard limits on a path.
#[derive(Args)]
pub(crate) struct PathLimits {
    /// The path may take no longer [s]
    #[arg(long)]
    max_time_s: Option<f64>,
    /// The path may have drawn no more on arrival [J]
    #[arg(long, allow_hyphen_values = true)]
    max_energy_j: Option<f64>,
    /// The path may be no longer [m]
    #[arg(long)]
    max_distance_m: Option<f64>,
    /// Steepest climb, descent or sideways tilt on the way, up to 1.571 [rad]
    #[arg(long)]
    max_slope_rad: Option<f64>,
}

impl PathLimits {
    /// The request within these limits.
    pub(crate) fn on(&self, request: PlanRequest) -> PlanRequest {
        PlanRequest {
            max_time_s: self.max_time_s,
            max_energy_j: self.max_energy_j,
            max_distance_m: self.max_distance_m,
            max_slope_rad: self.max_slope_rad,
            ..request
        }
    }
}

/// Both ends of a path over a map, and how to drive: what `plan` and `compare` share.
#[derive(Args)]
pub(crate) struct Question {
    #[command(flatten)]
    pub(crate) driving: Driving,
    /// X,Y[,HEADING_DEG] in metres of the map, @FX,FY[,HEADING_DEG] in fractions of it, or 46.5046N,93.9217W[,HEADING_DEG]
    #[arg(long, allow_hyphen_values = true)]
    start: Place,
    /// X,Y[,HEADING_DEG] in metres of the map, @FX,FY[,HEADING_DEG] in fractions of it, or 46.5046N,93.9217W[,HEADING_DEG]
    ///
    /// Given several times, the path leads to the place that is best to reach
    #[arg(long, allow_hyphen_values = true, required = true)]
    goal: Vec<Place>,
    #[command(flatten)]
    steering: Steering,
    /// Any pose this close to the goal will do [m]
    #[arg(long, default_value_t = 0.0)]
    tolerance_m: f64,
    /// The path may cost so many times the least: looser bounds are answered sooner
    #[arg(long, default_value_t = 1.0)]
    bound: f64,
    /// Leave the path on the lattice
    #[arg(long)]
    no_refinement: bool,
}

fn power_model(text: &str) -> Result<PowerModel, String> {
    match text {
        "force-balance" => Ok(PowerModel::ForceBalance),
        "dogru-marques" => Ok(PowerModel::DogruMarques),
        _ => Err("give force-balance or dogru-marques".into()),
    }
}

impl Question {
    /// Refuses steering and several goals for a command that has no use for them.
    pub(crate) fn refuse_steering(&self, command: &str) -> anyhow::Result<()> {
        if self.steering.is_any() || self.goal.len() > 1 {
            let why = format!(
                "{command} weigh what paths take between one start and one goal: leave out --price, --forbid, --least-radius-m, --either-way, --partial, --snapped-ends and further --goal, or ask plan"
            );
            return Err(BadInput(why).into());
        }
        Ok(())
    }

    /// Reads the files and puts the question as the service takes it.
    pub(crate) fn read(&self, objective: ObjectiveName) -> anyhow::Result<(Terrain, PlanRequest)> {
        let driving = &self.driving;
        let (terrain, robot) = driving.read()?;
        let goal = |place: &Place| -> anyhow::Result<GoalPose> {
            let goal = GoalPose::in_metres(place.on(&terrain)?, place.heading_rad());
            let heading = self.steering.either_way.then_some(GoalHeading::Either);
            Ok(GoalPose { tolerance_m: self.tolerance_m, heading, ..goal })
        };
        let goals: Vec<GoalPose> = self.goal.iter().map(goal).collect::<anyhow::Result<_>>()?;
        let is_one = goals.len() == 1;
        let request = PlanRequest {
            goals: (!is_one).then(|| goals.clone()),
            objective,
            speed_mps: driving.speed_mps,
            power_model: driving.power_model,
            reverse: driving.reverse,
            snap_radius_m: driving.snap_radius_m,
            bound: self.bound,
            timeout_s: driving.timeout_s,
            refine: !self.no_refinement,
            ..PlanRequest::of(
                robot,
                self.start.pose_on(&terrain)?,
                if is_one { goals[0] } else { GoalPose::absent() },
            )
        };
        let request = self.steering.on(request);
        request.check_steering().map_err(Refused)?;
        Ok((terrain, request))
    }
}

/// When a command's search has to give up: the service's own limit, ten times over.
pub(crate) fn patience() -> Patience {
    const PATIENCE: u32 = 10;
    Patience::until(Instant::now() + Limits::default().plan_time * PATIENCE)
}

#[cfg(test)]
mod tests {
    use terrain::Grid;

    use super::*;

    #[test]
    fn places_are_metres_or_fractions_with_an_optional_heading() {
        let grid = Grid { rows: 10, columns: 20, cell_size_m: 0.5, origin_m: [100.0, -5.0] };
        let mut terrain = Terrain::new(grid, &[1.0; 200]).unwrap();
        let on = |terrain: &Terrain, text: &str| text.parse::<Place>().unwrap().on(terrain);
        let at = |text: &str| on(&terrain, text).unwrap();
        assert_eq!(at("3,-4"), [3.0, -4.0]);
        assert_eq!(at("@0.5,1"), [105.0, 0.0]);
        assert_eq!("1,2,90".parse::<Place>().unwrap().heading_deg, Some(90.0));
        assert!("1,2,361".parse::<Place>().unwrap_err().contains("-360 to 360 degrees"));
        let refused = on(&terrain, "45.0N,93.0W").unwrap_err().to_string();
        assert!(refused.contains("no crs"), "{refused}");
        terrain.crs = Some("EPSG:26915".into());
        for text in ["45.0N,93.0W", "93W, 45n", "45.0N,93.0W,90"] {
            let [x_m, y_m] = on(&terrain, text).unwrap();
            assert!(
                (x_m - 500_000.0).abs() < 1e-3 && (y_m - 4_982_950.400).abs() < 1e-2,
                "{text}: {x_m} {y_m}"
            );
        }
        assert!("45N,93W,361".parse::<Place>().unwrap_err().contains("-360 to 360 degrees"));
        for wrong in
            ["", "1", "1,2,3,4", "a,b", "@", "1,nan", "1;2", "91N,3E", "4N,5S", "4N,5E,6,7", "4°N,5°E"]
        {
            assert!(wrong.parse::<Place>().unwrap_err().contains("X,Y"), "{wrong}");
        }
    }
}
