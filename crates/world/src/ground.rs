//! The ground: height, slope and surface at every place.

use terrain::{Surfaces, Terrain};

use crate::{Error, RobotFile, World, random::Random, world::Relief};

/// Height and gradient of one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spot {
    /// Height [m].
    pub(crate) z_m: f64,
    /// ∂z/∂x and ∂z/∂y [-].
    pub(crate) slope: [f64; 2],
}

/// Friction of one surface as the contact needs it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SurfaceLaw {
    pub(crate) name: String,
    pub(crate) mu_roll: f64,
    pub(crate) mu_skid: f64,
    pub(crate) slip_angle_scale_rad: f64,
}

/// The ground of a world under a robot.
#[derive(Clone, Debug)]
pub(crate) struct Ground {
    shape: Shape,
    /// Surfaces that the robot knows; places index them.
    pub(crate) surfaces: Vec<SurfaceLaw>,
    patches: Vec<([f64; 2], [f64; 2], usize)>,
    /// Surface of each class of the map.
    classes: Vec<usize>,
    default: usize,
}

#[derive(Clone, Debug)]
enum Shape {
    Plane { slope: [f64; 2] },
    Waves(Vec<Wave>),
    Map(Box<Terrain>),
}

/// One rolling wave of the ground: height and wave vector.
#[derive(Clone, Copy, Debug)]
struct Wave {
    height_m: f64,
    per_m: [f64; 2],
    phase_rad: f64,
}

/// Waves in a rolling relief: enough that no direction stands out.
const WAVES: usize = 7;
/// The shortest wave as a share of the longest; shorter ones would be bumps, not slopes.
const SHORTEST: f64 = 0.4;

impl Ground {
    /// The ground of a world, its surfaces checked against those of the robot.
    pub(crate) fn new(world: &World, robot: &RobotFile) -> Result<Self, Error> {
        let law = |(name, s): (&String, &crate::robot::SurfaceFile)| SurfaceLaw {
            name: name.clone(),
            mu_roll: s.mu_roll,
            mu_skid: s.mu_skid,
            slip_angle_scale_rad: s.slip_angle_scale_rad,
        };
        let surfaces: Vec<SurfaceLaw> = robot.surfaces.iter().map(law).collect();
        let index = |field: &str, name: &str| {
            robot.check_surface(field, name)?;
            Ok::<usize, Error>(surfaces.iter().position(|s| s.name == name).unwrap_or_default())
        };
        let default = match &world.surface {
            Some(name) => index("surface", name)?,
            None => index("default_surface", &robot.default_surface)?,
        };
        let patches = world.patches.iter().enumerate().map(|(i, patch)| {
            Ok((patch.x_m, patch.y_m, index(&format!("patches[{i}].surface"), &patch.surface)?))
        });
        let patches = patches.collect::<Result<Vec<_>, Error>>()?;
        let shape = Shape::of(world)?;
        let mut classes = Vec::new();
        if let Shape::Map(map) = &shape {
            for name in map.surfaces().map(|s| s.names.as_slice()).unwrap_or_default() {
                classes.push(index("terrain.map: surface", name)?);
            }
        }
        Ok(Ground { shape, surfaces, patches, classes, default })
    }

    /// Height and slope; `None` where the map does not know the ground. Beyond its borders a map goes on mirrored.
    pub(crate) fn spot(&self, x_m: f64, y_m: f64) -> Option<Spot> {
        match &self.shape {
            Shape::Plane { slope } => Some(Spot { z_m: slope[0] * x_m + slope[1] * y_m, slope: *slope }),
            Shape::Waves(waves) => Some(waves.iter().fold(Spot::default(), |mut sum, wave| {
                let (sin, cos) = (wave.per_m[0] * x_m + wave.per_m[1] * y_m + wave.phase_rad).sin_cos();
                sum.z_m += wave.height_m * sin;
                sum.slope[0] += wave.height_m * wave.per_m[0] * cos;
                sum.slope[1] += wave.height_m * wave.per_m[1] * cos;
                sum
            })),
            Shape::Map(map) => map_spot(map, x_m, y_m),
        }
    }

    /// Index of the surface at a place: a patch's, else the map's, else the default.
    pub(crate) fn surface(&self, x_m: f64, y_m: f64) -> usize {
        let inside = |(x, y, _): &&([f64; 2], [f64; 2], usize)| {
            (x[0]..=x[1]).contains(&x_m) && (y[0]..=y[1]).contains(&y_m)
        };
        if let Some((_, _, surface)) = self.patches.iter().rev().find(inside) {
            return *surface;
        }
        match &self.shape {
            Shape::Map(map) if !self.classes.is_empty() => {
                let [column, row] = folded(map, x_m, y_m);
                let cell = terrain::Cell { row: row.0.round() as usize, column: column.0.round() as usize };
                match map.surface_class(cell) {
                    Surfaces::UNNAMED => self.default,
                    class => self.classes.get(usize::from(class)).copied().unwrap_or(self.default),
                }
            }
            _ => self.default,
        }
    }

    /// The middle of the ground, where drives begin, and how far they may stray from it [m].
    pub(crate) fn arena(&self) -> ([f64; 2], f64) {
        match &self.shape {
            Shape::Map(map) => {
                let [x0, y0] = map.grid.at_fraction_m(0.1, 0.1);
                let [x1, y1] = map.grid.at_fraction_m(0.9, 0.9);
                ([(x0 + x1) / 2.0, (y0 + y1) / 2.0], ((x1 - x0).min(y1 - y0) / 2.0).min(ARENA_M))
            }
            _ => ([0.0, 0.0], ARENA_M),
        }
    }
}

/// How far a free drive strays from its middle [m]: a field that a person can watch over.
const ARENA_M: f64 = 25.0;

impl Shape {
    fn of(world: &World) -> Result<Shape, Error> {
        Ok(match &world.terrain {
            Relief::Level => Shape::Plane { slope: [0.0; 2] },
            Relief::Plane { grade, uphill_rad } => {
                Shape::Plane { slope: [grade * uphill_rad.cos(), grade * uphill_rad.sin()] }
            }
            Relief::Rolling { grade, length_m, seed } => Shape::Waves(waves(*grade, *length_m, *seed)),
            Relief::Map(path) => Shape::Map(Box::new(terrain::io::read_path(&path.0)?)),
        })
    }
}

/// Waves in random directions whose slopes have the root mean square `grade`.
fn waves(grade: f64, length_m: f64, seed: u64) -> Vec<Wave> {
    let mut random = Random::new(seed, "relief");
    let wave = |i: usize| {
        // Directions are spread evenly with some play, so that no seed gives a washboard.
        let direction = std::f64::consts::PI * (i as f64 + random.between(0.1, 0.9)) / WAVES as f64;
        let per_m = std::f64::consts::TAU / (length_m * random.between(SHORTEST, 1.0));
        // A sine of slope amplitude A has the mean square A²/2; all waves share the slope.
        let slope = grade * (2.0 / WAVES as f64).sqrt();
        Wave {
            height_m: slope / per_m,
            per_m: [per_m * direction.cos(), per_m * direction.sin()],
            phase_rad: random.between(0.0, std::f64::consts::TAU),
        }
    };
    (0..WAVES).map(wave).collect()
}

/// Column and row of a place in cells from the first centre, folded back into the map, with the direction of the fold.
fn folded(map: &Terrain, x_m: f64, y_m: f64) -> [(f64, f64); 2] {
    let fold = |position_m: f64, origin_m: f64, count: usize| {
        let span = (count - 1) as f64;
        if span == 0.0 {
            return (0.0, 0.0);
        }
        let cells = ((position_m - origin_m) / map.grid.cell_size_m - 0.5).rem_euclid(2.0 * span);
        if cells <= span { (cells, 1.0) } else { (2.0 * span - cells, -1.0) }
    };
    [fold(x_m, map.grid.origin_m[0], map.grid.columns), fold(y_m, map.grid.origin_m[1], map.grid.rows)]
}

/// Bilinear height and its gradient.
fn map_spot(map: &Terrain, x_m: f64, y_m: f64) -> Option<Spot> {
    let [(column, east), (row, north)] = folded(map, x_m, y_m);
    let (c, r) = (column as usize, row as usize);
    let (u, v) = (column - c as f64, row - r as f64);
    let relative_m = map.relative_m();
    let height = |dr: usize, dc: usize| {
        let (row, column) = ((r + dr).min(map.grid.rows - 1), (c + dc).min(map.grid.columns - 1));
        f64::from(relative_m[row * map.grid.columns + column])
    };
    let (sw, se, nw, ne) = (height(0, 0), height(0, 1), height(1, 0), height(1, 1));
    let (south, north_edge) = (sw + u * (se - sw), nw + u * (ne - nw));
    let per_m = 1.0 / map.grid.cell_size_m;
    let slope =
        [east * per_m * ((se - sw) * (1.0 - v) + (ne - nw) * v), north * per_m * (north_edge - south)];
    let z_m = map.base_m() + south + v * (north_edge - south);
    z_m.is_finite().then_some(Spot { z_m, slope })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example_robot;

    fn ground(world: &str) -> Ground {
        Ground::new(&World::from_json(world).unwrap(), &example_robot()).unwrap()
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_height_and_as_steep_as_asked() {
        let ground = ground(r#"{"terrain": {"rolling": {"grade": 0.06, "length_m": 15, "seed": 3}}}"#);
        let z = |x: f64, y: f64| ground.spot(x, y).unwrap().z_m;
        let mut square = 0.0;
        for i in 0..4000 {
            let (x, y) = (f64::from(i % 63) * 1.7, f64::from(i / 63) * 1.7);
            let slope = ground.spot(x, y).unwrap().slope;
            let h = 1e-4;
            assert!((slope[0] - (z(x + h, y) - z(x - h, y)) / (2.0 * h)).abs() < 1e-6);
            assert!((slope[1] - (z(x, y + h) - z(x, y - h)) / (2.0 * h)).abs() < 1e-6);
            square += (slope[0].powi(2) + slope[1].powi(2)) / 4000.0;
        }
        assert!((square.sqrt() - 0.06).abs() < 0.006, "{}", square.sqrt());
    }

    #[test]
    fn patches_lie_over_the_default_surface_and_later_ones_over_earlier() {
        let ground = ground(
            r#"{"terrain": "level", "patches": [
                {"surface": "sandy_loam", "x_m": [0, 10], "y_m": [0, 10]},
                {"surface": "marble", "x_m": [4, 6], "y_m": [4, 6]}]}"#,
        );
        let name = |x, y| ground.surfaces[ground.surface(x, y)].name.as_str();
        assert_eq!([name(-1.0, 5.0), name(1.0, 5.0), name(5.0, 5.0)], ["marble", "sandy_loam", "marble"]);
    }
}
