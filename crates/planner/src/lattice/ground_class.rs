//! Kinds of ground as they are driven on: a surface, and the rules of areas over it.

use model::{Robot, robot::Surface};
use terrain::{
    Cell, Surfaces, Terrain,
    areas::{Rule, Zones},
};

use crate::{
    error::Error,
    lattice::{
        graph::{Lattice, Settings},
        objective::{Surcharge, Weights},
        step::PreparedStep,
    },
};

/// A kind of ground.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GroundClass {
    /// Friction there.
    pub(crate) surface: Surface,
    /// Position of its name among [`crate::surface_names`].
    pub(crate) name: usize,
    /// How the robot is to drive there.
    pub(crate) rule: Rule,
}

/// The kinds of ground that a map has, the robot's default without any rule last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GroundClasses {
    pub(crate) list: Vec<GroundClass>,
    /// Kinds by surface and rule, where the map has rules.
    by_rule: Option<Vec<u8>>,
    /// Number of rules.
    rules: usize,
}

/// A quarter turn from a one-way direction is still allowed; rounding must not forbid it.
const SIDEWAYS: f64 = -1e-9;

impl GroundClass {
    /// The settings with which it is driven on.
    pub(crate) fn settings(&self, settings: &Settings) -> Settings {
        Settings { speed_mps: settings.speed_mps.min(self.rule.max_speed_mps), ..*settings }
    }

    /// Whether a step may lead over it in its direction; turns on the spot may always.
    pub(crate) fn allows(&self, step: &PreparedStep) -> bool {
        self.rule.one_way_rad.is_none_or(|way_rad| {
            let (sin, cos) = way_rad.sin_cos();
            step.horizontal_m == 0.0 || step.travel.0 * cos + step.travel.1 * sin >= SIDEWAYS
        })
    }

    /// What preferences add to a step in comparisons, by what it takes of energy beyond lifting, length and time.
    pub(crate) fn surcharge(
        &self,
        settings: &Settings,
        step: &PreparedStep,
        reverse: bool,
        [unlifted_j, length_m, duration_s]: [f64; 3],
    ) -> Surcharge {
        let more = self.rule.cost_factor - 1.0;
        let prices = &settings.prices;
        let reversed_m = if reverse { length_m } else { 0.0 };
        let spun_rad = if step.horizontal_m == 0.0 { step.turn_rad.abs() } else { 0.0 };
        Surcharge {
            j: more * unlifted_j
                + self.rule.risk_j_per_m * length_m
                + prices.reverse_j_per_m * reversed_m
                + prices.spin_j_per_rad * spun_rad,
            m: more * length_m,
            s: more * duration_s + prices.reverse_s_per_m * reversed_m + prices.spin_s_per_rad * spun_rad,
        }
    }

    /// An objective's weights of a step over it, with what preferences add.
    pub(crate) fn weights(
        &self,
        weights: &Weights,
        settings: &Settings,
        step: &PreparedStep,
        reverse: bool,
    ) -> StepWeights {
        // Of steps that take one of something and nothing else.
        let added = |amounts: [f64; 3]| {
            let surcharge = self.surcharge(settings, step, reverse, amounts);
            weights.of_surcharge(&surcharge)
        };
        let fixed = added([0.0; 3]);
        let one = |axis: usize| {
            let mut amounts = [0.0; 3];
            amounts[axis] = 1.0;
            added(amounts) - fixed
        };
        StepWeights {
            per_j: weights.per_j + one(0),
            per_m: weights.per_m + one(1),
            per_s: weights.per_s + one(2),
            fixed,
        }
    }
}

/// Weights of what a step takes, with preferences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepWeights {
    /// Of energy beyond lifting [1/J].
    pub(crate) per_j: f64,
    /// Of length [1/m].
    pub(crate) per_m: f64,
    /// Of time [1/s].
    pub(crate) per_s: f64,
    /// Of the step, whatever it takes.
    pub(crate) fixed: f64,
}

impl GroundClasses {
    /// The kinds of ground of a map for a robot.
    ///
    /// # Errors
    /// A surface that the robot does not know, or more kinds than a byte tells apart.
    pub(crate) fn of(terrain: &Terrain, robot: &Robot, settings: &Settings) -> Result<Self, Error> {
        let names = terrain.surfaces().map_or(&[][..], |surfaces| &surfaces.names);
        let names = names.iter().map(String::as_str).chain([robot.default_surface.as_str()]);
        let surfaces = names.map(|name| {
            robot.surface(name).cloned().map_err(|_| Error::UnknownSurface {
                name: name.to_owned(),
                known: robot.surfaces.keys().cloned().collect(),
            })
        });
        let surfaces: Vec<Surface> = surfaces.collect::<Result<_, Error>>()?;
        match terrain.zones() {
            Some(zones) if zones.rules.len() > 1 => {
                let mut classes = Self::with_rules(terrain, &surfaces, zones)?;
                if !settings.heed_preferences {
                    classes.forget_preferences();
                }
                Ok(classes)
            }
            _ => {
                let plain = |(name, surface)| GroundClass { surface, name, rule: Rule::FREE };
                let list = surfaces.into_iter().enumerate().map(plain).collect();
                Ok(GroundClasses { list, by_rule: None, rules: 1 })
            }
        }
    }

    /// The pairs of surfaces and rules that occur.
    fn with_rules(terrain: &Terrain, surfaces: &[Surface], zones: &Zones) -> Result<Self, Error> {
        let rules = zones.rules.len();
        let mut occurs = vec![false; surfaces.len() * rules];
        for (index, rule) in zones.rule.iter().enumerate() {
            occurs[surface_at(terrain, index) * rules + usize::from(*rule)] = true;
        }
        // The default without any rule stands last, whether it occurs or not.
        let default = (surfaces.len() - 1) * rules;
        let others = occurs.iter().enumerate().filter(|(pair, occurs)| **occurs && *pair != default);
        let pairs: Vec<usize> = others.map(|(pair, _)| pair).chain([default]).collect();
        let mut by_rule = vec![0; occurs.len()];
        let mut list = Vec::with_capacity(pairs.len());
        for (place, pair) in pairs.iter().enumerate() {
            let most = usize::from(u8::MAX);
            by_rule[*pair] =
                u8::try_from(place).map_err(|_| Error::TooManyGrounds { found: pairs.len(), most })?;
            let name = pair / rules;
            list.push(GroundClass { surface: surfaces[name].clone(), name, rule: zones.rules[pair % rules] });
        }
        Ok(GroundClasses { list, by_rule: Some(by_rule), rules })
    }

    /// Leaves out what counts in comparisons only.
    fn forget_preferences(&mut self) {
        for class in &mut self.list {
            (class.rule.cost_factor, class.rule.risk_j_per_m) = (1.0, 0.0);
        }
    }

    /// Position of a cell's kind.
    #[inline]
    pub(crate) fn at(&self, terrain: &Terrain, cell: Cell) -> usize {
        let index = terrain.grid.index(cell);
        let surface = surface_at(terrain, index);
        match (&self.by_rule, terrain.zones()) {
            (Some(by_rule), Some(zones)) => {
                usize::from(by_rule[surface * self.rules + usize::from(zones.rule[index])])
            }
            _ => surface,
        }
    }

    /// Largest risk of any [J/m].
    pub(crate) fn largest_risk_j_per_m(&self) -> f64 {
        self.list.iter().map(|class| class.rule.risk_j_per_m).fold(0.0, f64::max)
    }

    /// Least and largest cost factor of any.
    pub(crate) fn factors(&self) -> [f64; 2] {
        let of = |class: &GroundClass| class.rule.cost_factor;
        let least = self.list.iter().map(of).fold(f64::INFINITY, f64::min);
        [least, self.list.iter().map(of).fold(0.0, f64::max)]
    }
}

/// Position of a cell's surface among the map's, the robot's default last.
#[inline]
fn surface_at(terrain: &Terrain, index: usize) -> usize {
    match terrain.surfaces() {
        None => 0,
        Some(surfaces) => match surfaces.class[index] {
            Surfaces::UNNAMED => surfaces.names.len(),
            class => usize::from(class),
        },
    }
}

/// Names of the surfaces that steps index: the map's, then the robot's default.
pub fn surface_names(lattice: &Lattice) -> Vec<String> {
    let mut names = lattice.terrain.surfaces().map_or(Vec::new(), |s| s.names.clone());
    names.push(lattice.robot.default_surface.clone());
    names
}
