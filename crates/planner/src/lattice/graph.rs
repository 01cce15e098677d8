//! The graph of poses: a robot on a terrain at a speed.

use std::sync::Arc;

use model::{
    Manoeuvre, Motion as BodyMotion, PowerModel, PreparedSurface, Robot, STANDARD_GRAVITY_MPS2, Sides,
};
use terrain::{Cell, Terrain};

use crate::{
    error::{Blocked, Error},
    grid::{
        heading::{HEADINGS, Heading},
        layout::Layout,
        state::State,
    },
    ground::{
        clearance::Clearance,
        footprint::Footprint,
        ground_tiles::Ground,
        spans::{Span, first_blocked, shifted},
        stance::Stance,
    },
    lattice::{
        edge::{Chain, Edge},
        ground_class::{GroundClass, GroundClasses},
        objective::{Objective, Weights},
        preparation::Preparation,
        prices::Prices,
        primitive::{LONGEST_LEAD, Motion, Piece, motions},
        step::{Limits, Step},
        swept::Rectangle,
    },
    patience::Patience,
};

/// How the robot is to be driven; the defaults are what a plain request gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Forward speed, lowered in arcs whose outer wheel would exceed its limit [m/s].
    pub speed_mps: f64,
    /// Form of the physics.
    pub power_model: PowerModel,
    /// Whether the robot may back up.
    pub reverse: bool,
    /// Temperature of both motors [°C].
    pub motor_temperature_c: f64,
    /// What manoeuvres weigh in comparisons besides what they take.
    pub prices: Prices,
    /// Whether the robot may turn on the spot.
    pub spin: bool,
    /// No turn is tighter; above 0 the robot does not turn on the spot [m].
    pub least_radius_m: f64,
    /// Whether cost factors of areas and risks of unknown ground count in comparisons.
    pub heed_preferences: bool,
}

impl Settings {
    /// Half the wheels' top speed, the default physics, forward only, motors at their reference temperature.
    ///
    /// At half the top speed the tightest forward turn, at R', just keeps its outer wheel within the limit.
    pub fn of(robot: &Robot) -> Self {
        Settings {
            speed_mps: robot.max_wheel_speed_mps / 2.0,
            power_model: PowerModel::default(),
            reverse: false,
            motor_temperature_c: robot.motors.reference_temperature_c,
            prices: Prices::default(),
            spin: true,
            least_radius_m: 0.0,
            heed_preferences: true,
        }
    }

    /// Whether the robot turns on the spot.
    pub(crate) fn spins(&self) -> bool {
        self.spin && self.least_radius_m == 0.0
    }

    /// Radius of the tightest arc: half the slip track, or the least that is asked for [m].
    pub(crate) fn tightest_m(&self, robot: &Robot) -> f64 {
        robot.half_slip_track_m().max(self.least_radius_m)
    }
}

/// A robot on a terrain: its motions, their costs, and where it may stand.
pub struct Lattice {
    /// The ground.
    pub terrain: Terrain,
    /// The robot.
    pub robot: Robot,
    /// How it is driven.
    pub settings: Settings,
    /// Distance to blocked ground.
    pub clearance: Clearance,
    /// Motions by start heading.
    pub motions: [Vec<Motion>; HEADINGS],
    pub(crate) layout: Layout,
    pub(crate) limits: Limits,
    pub(crate) ground: Ground,
    pub(crate) chains: Arc<[Vec<Vec<Chain>>; HEADINGS]>,
    pub(crate) classes: GroundClasses,
    stand: [Vec<Span>; HEADINGS],
}

impl Lattice {
    /// Returns the lattice of a robot on a terrain, however long its preparation takes.
    ///
    /// # Errors
    /// As [`Lattice::prepare`], but for the deadline.
    pub fn new(terrain: &Terrain, robot: &Robot, settings: Settings) -> Result<Arc<Self>, Error> {
        Self::prepare(terrain, robot, settings, &Patience::default())
    }

    /// Returns the lattice of a robot on a terrain: its motions, their manoeuvres and the cells they sweep.
    ///
    /// # Errors
    /// A speed out of range, a surface that the robot does not know, cells too fine for the robot, too many surfaces, or
    /// patience that ended.
    pub fn prepare(
        terrain: &Terrain,
        robot: &Robot,
        settings: Settings,
        patience: &Patience,
    ) -> Result<Arc<Self>, Error> {
        check_speed(robot, settings.speed_mps)?;
        settings.prices.check()?;
        let terrain = &as_driven(terrain, patience)?;
        let classes = GroundClasses::of(terrain, robot, &settings)?;
        let cell_size_m = terrain.grid.cell_size_m;
        let (rows, columns) = (terrain.grid.rows, terrain.grid.columns);
        let layout = Layout::new(&terrain.grid).ok_or(Error::TooManyStates { rows, columns })?;
        check_cells(robot, cell_size_m)?;
        let motions = motions(robot, cell_size_m, &settings)?;
        let preparation =
            Preparation { robot, settings: &settings, classes: &classes.list, cell_size_m, patience };
        let chains = Arc::new(preparation.chains(&motions)?);
        let outline = Footprint::of(robot);
        let standing = |h| Rectangle::of(&outline, [0.0, 0.0, Heading::new(h).angle_rad()]);
        Ok(Arc::new(Lattice {
            terrain: terrain.clone(),
            robot: robot.clone(),
            settings,
            clearance: Clearance::new(terrain),
            motions,
            layout,
            limits: Limits::of(robot),
            ground: Ground::new(terrain, Arc::new(Stance::new(robot, cell_size_m)), robot.clearance_m()),
            chains,
            classes,
            stand: std::array::from_fn(|h| standing(h).spans(cell_size_m).collect()),
        }))
    }

    /// Returns the lattice of the same robot and settings on other ground, which shares the motions where it can.
    ///
    /// # Errors
    /// As [`Lattice::prepare`].
    pub fn over(&self, terrain: &Terrain, patience: &Patience) -> Result<Arc<Self>, Error> {
        let terrain = &as_driven(terrain, patience)?;
        if terrain.grid != self.terrain.grid
            || GroundClasses::of(terrain, &self.robot, &self.settings)? != self.classes
        {
            return Self::prepare(terrain, &self.robot, self.settings, patience);
        }
        Ok(Arc::new(Lattice {
            terrain: terrain.clone(),
            robot: self.robot.clone(),
            settings: self.settings,
            clearance: Clearance::new(terrain),
            motions: self.motions.clone(),
            layout: self.layout,
            limits: self.limits,
            ground: Ground::new(terrain, Arc::clone(self.ground.stance()), self.robot.clearance_m()),
            chains: Arc::clone(&self.chains),
            classes: self.classes.clone(),
            stand: self.stand.clone(),
        }))
    }

    /// Whether anything counts in comparisons besides what paths take: cost factors, risks or prices.
    pub fn has_preferences(&self) -> bool {
        let rules = self.classes.list.iter().map(|class| class.rule);
        self.settings.prices != Prices::default()
            || rules.into_iter().any(|rule| rule.cost_factor != 1.0 || rule.risk_j_per_m != 0.0)
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.terrain.grid.cells() * HEADINGS
    }

    /// Motions per state, the same for every heading.
    pub fn motions_per_state(&self) -> usize {
        self.motions[0].len()
    }

    /// Position of a state in dense storage.
    pub fn index(&self, state: State) -> usize {
        self.terrain.grid.index(state.cell) * HEADINGS + state.heading.index()
    }

    /// The state at a position in dense storage.
    pub fn state(&self, index: usize) -> State {
        State { cell: self.terrain.grid.cell(index / HEADINGS), heading: Heading::new(index % HEADINGS) }
    }

    /// The smaller k2 at the motors' temperature: what lifting costs at least, per joule lifted.
    pub fn kappa(&self) -> f64 {
        let k2 = self
            .robot
            .motor_sides()
            .map(|m| m.at_temperature(&self.robot.motors, self.settings.motor_temperature_c).k2);
        k2.left.min(k2.right)
    }

    /// Height potential φ = κ m g z of a cell, z being [`Lattice::height_m`] [J].
    ///
    /// `E − Δφ` is never negative: of each side's electrical power P ≥ κ F u holds, driving because κ ≤ k2, back-driven
    /// because 1/k2 ≤ k2; and of all wheel work only friction is left once gravity is taken out. Adding Δφ along any path
    /// from one place to another gives the same sum, so the search may use `E − Δφ` and stay exact (Johnson 1977).
    pub fn potential_j(&self, cell: Cell) -> f64 {
        f64::from(self.height_m(cell)) * self.lift_j_per_m()
    }

    /// Height of the robot in a cell above the map's lowest ground: the mean over the disc that its wheels go round in a turn
    /// on the spot, NaN where the ground is unknown [m].
    pub fn height_m(&self, cell: Cell) -> f32 {
        self.ground.height_m(&self.terrain, cell)
    }

    /// κ m g: the potential per metre of height [J/m].
    pub(crate) fn lift_j_per_m(&self) -> f64 {
        self.kappa() * self.robot.lifted_mass_kg() * STANDARD_GRAVITY_MPS2
    }

    /// Energy of a step without lifting, E − κ m g Δz [J].
    pub(crate) fn unlifted_j(&self, step: &Step) -> f64 {
        step.energy_j() - step.rise_m * self.lift_j_per_m()
    }

    /// Whether the robot can stand in a pose, and if not, why.
    ///
    /// # Errors
    /// The first reason found: obstacle, unknown ground, map edge, pitch, roll, ground that the body would touch.
    pub fn stand(&self, state: State) -> Result<(), Blocked> {
        if let Some(touched) = first_blocked(&self.clearance, state.cell, &self.stand[state.heading.index()])
        {
            return Err(match touched {
                None => Blocked::Edge,
                Some(cell) if self.terrain.elevation_m(cell).is_none() => Blocked::Unknown { cell },
                Some(cell) if self.terrain.is_keep_out(cell) => Blocked::KeepOut { cell },
                Some(cell) => Blocked::Obstacle { cell },
            });
        }
        let (pitch_rad, roll_rad) = self.tilt_rad(state);
        let limits = &self.robot.limits;
        if pitch_rad.abs() > limits.max_pitch_rad {
            return Err(Blocked::Pitch { pitch_rad, limit_rad: limits.max_pitch_rad });
        }
        if roll_rad.abs() > limits.max_roll_rad {
            return Err(Blocked::Roll { roll_rad, limit_rad: limits.max_roll_rad });
        }
        if self.ground.touches(&self.terrain, state.cell, state.heading) {
            let rises_m = self.ground.rises_m(&self.terrain, state.cell, state.heading).unwrap_or(f64::NAN);
            return Err(Blocked::Body { rises_m, clearance_m: self.robot.clearance_m() });
        }
        Ok(())
    }

    /// Pitch and roll of the robot standing in a pose, on the plane through the ground at its wheels [rad].
    pub fn tilt_rad(&self, state: State) -> (f64, f64) {
        let [east, north] =
            self.ground.plane(&self.terrain, state.cell, state.heading).gradient.map(f64::from);
        let (sin, cos) = state.heading.angle_rad().sin_cos();
        ((east * cos + north * sin).atan(), (north * cos - east * sin).atan())
    }

    /// The ways to drive a motion from a cell: one evaluation per variant, `None` where limits or ground forbid it.
    pub fn variants(
        &self,
        cell: Cell,
        heading: Heading,
        motion: usize,
    ) -> impl Iterator<Item = Option<Edge>> + '_ {
        self.chains[heading.index()][motion].iter().map(move |chain| chain.edge(self, cell))
    }

    /// One way to drive a motion, step by step.
    pub(crate) fn chain(&self, heading: Heading, motion: usize, variant: usize) -> &Chain {
        &self.chains[heading.index()][motion][variant]
    }

    /// Totals of a step east on level ground.
    pub(crate) fn level_step(&self) -> Edge {
        self.chain(Heading::new(0), 0, 0).on_level_ground()
    }

    /// An objective's weights for this robot.
    pub(crate) fn weights(&self, objective: Objective) -> Weights {
        objective.weights(&self.level_step(), self.reference_j())
    }

    /// Energy of the smallest step that counts: what a friction of 0.02 takes over one cell of level ground [J].
    ///
    /// A robot without any friction still needs a scale of costs. Tyres on asphalt roll at 0.01 to 0.02 (Wong, *Theory of
    /// Ground Vehicles*), and no robot that slips its wheels to turn does better.
    pub(crate) fn reference_j(&self) -> f64 {
        const LEAST_FRICTION: f64 = 0.02;
        LEAST_FRICTION * self.lift_j_per_m() * self.terrain.grid.cell_size_m
    }

    /// Cost of a motion that was driven, between places whose height potentials differ by `lifted_j`.
    pub fn cost(&self, objective: Objective, edge: &Edge, lifted_j: f64) -> f64 {
        self.weights(objective).cost(edge, lifted_j)
    }

    /// The state a motion leads to, if it lies on the map.
    pub fn successor(&self, state: State, motion: usize) -> Option<State> {
        let m = &self.motions[state.heading.index()][motion];
        let cell = shifted(&self.terrain, state.cell, (m.columns, m.rows))?;
        Some(State { cell, heading: m.to })
    }
}

/// The ground with its areas laid over it.
fn as_driven(terrain: &Terrain, patience: &Patience) -> Result<Terrain, Error> {
    terrain.as_driven(&|| patience.is_over()).map_err(|error| match error {
        terrain::Error::OutOfTime => Error::Timeout { expanded: 0 },
        other => Error::Areas(other.to_string()),
    })
}

fn check_speed(robot: &Robot, speed_mps: f64) -> Result<(), Error> {
    let (min, max) = (0.001, robot.max_wheel_speed_mps);
    if (min..=max).contains(&speed_mps) {
        return Ok(());
    }
    Err(Error::OutOfRange { field: "speed_mps", value: speed_mps, min, max })
}

/// Most cells along the robot: with more, the ground that a motion depends on is many tiles wide.
const MOST_CELLS_ALONG: f64 = 160.0;

/// Arcs at R' must fit a corner of at most 64 lattice steps, and the robot a bearable number of cells.
fn check_cells(robot: &Robot, cell_size_m: f64) -> Result<(), Error> {
    // Sharpest corner: 45° between legs of one cell.
    let for_arcs_m = robot.half_slip_track_m() * std::f64::consts::FRAC_PI_8.tan() / f64::from(LONGEST_LEAD);
    let footprint = Footprint::of(robot);
    let for_sweeps_m = footprint.length_m.max(footprint.width_m) / MOST_CELLS_ALONG;
    let least_m = for_arcs_m.max(for_sweeps_m);
    if cell_size_m >= least_m { Ok(()) } else { Err(Error::CellsTooFine { cell_size_m, least_m }) }
}

/// A piece as driven on a kind of ground at a heading [rad], at the motors' temperature.
pub(crate) fn manoeuvre(
    robot: &Robot,
    settings: &Settings,
    (piece, reverse, heading_rad): (&Piece, bool, f64),
    class: &GroundClass,
) -> Manoeuvre {
    let prepared = PreparedSurface::new(settings.power_model, robot, &class.surface);
    prepared_manoeuvre(&prepared, (robot, settings), (piece, reverse, heading_rad), class)
}

/// The same with the surface of that kind of ground prepared.
pub(crate) fn prepared_manoeuvre(
    prepared: &PreparedSurface<'_>,
    (robot, settings): (&Robot, &Settings),
    (piece, reverse, heading_rad): (&Piece, bool, f64),
    class: &GroundClass,
) -> Manoeuvre {
    let settings = class.settings(settings);
    let motion = piece_motion(robot, &settings, piece, reverse).heading(heading_rad);
    prepared.manoeuvre(motion, Sides::both(settings.motor_temperature_c))
}

/// Body speeds on a piece at the speed asked for.
fn piece_motion(robot: &Robot, settings: &Settings, piece: &Piece, reverse: bool) -> BodyMotion {
    body_motion(robot, settings.speed_mps, piece.radius_m(), piece.turn_rad, reverse)
}

/// Body speeds at a speed asked for and a signed radius of the path, `None` when straight: the speed is lowered where the outer
/// wheel would exceed its limit. On the spot, where the radius is 0, `turn` tells by its sign which way.
pub fn body_motion(
    robot: &Robot,
    speed_mps: f64,
    radius_m: Option<f64>,
    turn: f64,
    reverse: bool,
) -> BodyMotion {
    let half_m = robot.half_slip_track_m();
    let way = if reverse { -1.0 } else { 1.0 };
    match radius_m {
        None => BodyMotion::of_body(robot, way * speed_mps, 0.0),
        Some(0.0) => BodyMotion::of_body(robot, 0.0, turn.signum() * speed_mps / half_m),
        Some(radius_m) => {
            let outer_per_speed = 1.0 + half_m / radius_m.abs();
            let speed_mps = speed_mps.min(robot.max_wheel_speed_mps / outer_per_speed);
            BodyMotion::of_body(robot, way * speed_mps, speed_mps / radius_m)
        }
    }
}
