//! Areas laid over a map's cells: surfaces, obstacles, and rules of driving.

use std::sync::Arc;

use super::{Area, AreaError, Areas, Effect, raster::cover};
use crate::{Cell, Error, Surfaces, Terrain, Warning, WarningKind};

/// How the robot is to drive over a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Highest forward speed, infinite where there is no limit [m/s].
    pub max_speed_mps: f64,
    /// What driving there weighs in comparison, 1 where nothing is said.
    pub cost_factor: f64,
    /// What a metre weighs besides what it takes, for ground that is not known [J/m].
    pub risk_j_per_m: f64,
    /// The direction from which the way may differ by a quarter turn at most, counter-clockwise from east [rad].
    pub one_way_rad: Option<f64>,
}

/// Rules of driving, cell by cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Zones {
    /// The rules that occur; the first is [`Rule::FREE`].
    pub rules: Vec<Rule>,
    /// Rule of each cell, row-major, an index into the rules.
    pub rule: Vec<u8>,
    /// Cells of keep-out areas, row-major.
    keep_out: Vec<bool>,
}

impl Rule {
    /// No rule.
    pub const FREE: Rule =
        Rule { max_speed_mps: f64::INFINITY, cost_factor: 1.0, risk_j_per_m: 0.0, one_way_rad: None };

    /// This rule with an area's effect over it: the lower speed, both factors, and the later direction.
    fn under(self, effect: &Effect) -> Self {
        Rule {
            max_speed_mps: self.max_speed_mps.min(effect.max_speed_mps.unwrap_or(f64::INFINITY)),
            cost_factor: self.cost_factor * effect.cost_factor.unwrap_or(1.0),
            risk_j_per_m: self.risk_j_per_m,
            one_way_rad: effect.one_way_rad.or(self.one_way_rad),
        }
    }
}

impl Zones {
    /// Largest product of cost factors, and one over the least.
    const LARGEST_FACTOR: f64 = 1000.0;
    /// Rules beyond the first that areas may come to.
    const MOST_RULES: usize = 255;

    fn free(cells: usize) -> Self {
        Zones { rules: vec![Rule::FREE], rule: vec![0; cells], keep_out: vec![false; cells] }
    }

    /// Position of the rule of unknown ground, of zones that have no other rules yet.
    pub(super) fn risky(&mut self, risk_j_per_m: f64) -> u8 {
        if risk_j_per_m == 0.0 {
            return 0;
        }
        self.rules.push(Rule { risk_j_per_m, ..Rule::FREE });
        (self.rules.len() - 1) as u8
    }

    /// Position of a rule, which is added if it is new.
    fn place_of(&mut self, rule: Rule, feature: usize) -> Result<u8, AreaError> {
        let (factor, most) = (rule.cost_factor, Self::LARGEST_FACTOR);
        if !(1.0 / most..=most).contains(&factor) {
            let what = format!(
                "is where cost factors that lie over each other come to {factor}, but at most {most} is weighed: make it a keep-out"
            );
            return Err(AreaError::new(&format!("features[{feature}]"), what));
        }
        let place = self.rules.iter().position(|other| *other == rule).unwrap_or_else(|| {
            self.rules.push(rule);
            self.rules.len() - 1
        });
        u8::try_from(place).ok().filter(|place| usize::from(*place) < Self::MOST_RULES).ok_or_else(|| {
            let what = format!(
                "is where areas come to more than {} different rules: let fewer of them lie over each other",
                Self::MOST_RULES
            );
            AreaError::new(&format!("features[{feature}]"), what)
        })
    }
}

impl Terrain {
    /// This ground with areas, which are laid over it when it is driven on.
    pub fn with_areas(mut self, areas: Areas) -> Self {
        if !areas.notes().is_empty() {
            self = self.with_warning(Warning::new(WarningKind::Areas, areas.notes().join("; ")));
        }
        self.areas = (!areas.is_empty()).then(|| Arc::new(areas));
        self.zones = None;
        self
    }

    /// The areas over the map, if it has any.
    pub fn areas(&self) -> Option<&Areas> {
        self.areas.as_deref()
    }

    /// Rules of driving, cell by cell, where areas have been laid over the ground.
    pub fn zones(&self) -> Option<&Zones> {
        self.zones.as_deref()
    }

    /// Whether a cell lies in a keep-out area that has been laid over the ground.
    pub fn is_keep_out(&self, cell: Cell) -> bool {
        self.zones.as_ref().is_some_and(|zones| zones.keep_out[self.grid.index(cell)])
    }

    /// The ground as it is driven on: with its areas laid over surfaces and obstacles. A keep-out covers every cell that it touches,
    /// other areas the cells whose centres they hold, and lines every cell that they pass through.
    ///
    /// # Errors
    /// Too many surfaces or rules, or [`Error::OutOfTime`] as soon as `is_over` says so, which is asked row by row.
    pub fn as_driven(&self, is_over: &dyn Fn() -> bool) -> Result<Self, Error> {
        if self.zones.is_some() || (self.areas.is_none() && self.unknown_ground.is_none()) {
            return Ok(self.clone());
        }
        let mut terrain = self.clone();
        let mut zones = Zones::free(self.grid.cells());
        if let Some(unknown) = &self.unknown_ground {
            terrain.open_unknown(unknown, &mut zones, is_over)?;
        }
        for area in self.areas.iter().flat_map(|areas| &areas.areas) {
            terrain.lay(area, &mut zones, is_over)?;
        }
        if zones.keep_out.contains(&true) {
            let obstacle = terrain.obstacle.get_or_insert_with(|| Arc::new(vec![false; self.grid.cells()]));
            for (obstacle, keep_out) in Arc::make_mut(obstacle).iter_mut().zip(&zones.keep_out) {
                *obstacle |= keep_out;
            }
        }
        terrain.zones = Some(Arc::new(zones));
        Ok(terrain)
    }

    /// Lays one area over the ground.
    fn lay(&mut self, area: &Area, zones: &mut Zones, is_over: &dyn Fn() -> bool) -> Result<(), Error> {
        let (grid, effect) = (self.grid, &area.effect);
        let surface = match &effect.surface {
            None => None,
            Some(name) => {
                let unnamed = || Surfaces { names: Vec::new(), class: vec![Surfaces::UNNAMED; grid.cells()] };
                let surfaces = Arc::make_mut(self.surfaces.get_or_insert_with(|| Arc::new(unnamed())));
                Some((surfaces.class_of(Some(name))?, surfaces))
            }
        };
        // What each rule becomes under this area; cells that a shape visits twice must not weigh twice.
        let mut becomes: Vec<Option<u8>> = Vec::new();
        let mut covered = vec![false; grid.cells()];
        for shape in &area.shapes {
            cover(&grid, shape, effect.keep_out, is_over, &mut |cell| covered[cell] = true)
                .map_err(|_| Error::OutOfTime)?;
        }
        let mut classes = surface.map(|(class, surfaces)| (class, &mut surfaces.class));
        for (cell, _) in covered.iter().enumerate().filter(|(_, covered)| **covered) {
            if let Some((class, classes)) = &mut classes {
                classes[cell] = *class;
            }
            zones.keep_out[cell] |= effect.keep_out;
            let before = usize::from(zones.rule[cell]);
            becomes.resize(becomes.len().max(before + 1), None);
            let after = match becomes[before] {
                Some(after) => after,
                None => zones.place_of(zones.rules[before].under(effect), area.feature)?,
            };
            becomes[before] = Some(after);
            zones.rule[cell] = after;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::needless_pass_by_value)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::Grid;

    const GRID: Grid = Grid { rows: 10, columns: 10, cell_size_m: 1.0, origin_m: [0.0, 0.0] };

    fn laid(features: Value) -> Terrain {
        let terrain = Terrain::new(GRID, &[0.0; 100]).unwrap();
        let document = json!({"type": "FeatureCollection", "features": features});
        let areas = Areas::of(&document, &terrain).unwrap();
        terrain.with_areas(areas).as_driven(&|| false).unwrap()
    }

    fn square(west: f64, south: f64, side: f64, properties: Value) -> Value {
        let (east, north) = (west + side, south + side);
        json!({"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates":
            [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}})
    }

    #[test]
    fn areas_change_what_they_say_where_they_lie() {
        let terrain = laid(json!([
            square(0.0, 0.0, 4.0, json!({"surface": "mud", "cost_factor": 2.0})),
            square(2.0, 2.0, 4.0, json!({"max_speed_mps": 0.2, "cost_factor": 3.0})),
            square(7.0, 7.0, 1.0, json!({"keep_out": true})),
        ]));
        let rule = |row, column| {
            let zones = terrain.zones().unwrap();
            zones.rules[usize::from(zones.rule[GRID.index(Cell { row, column })])]
        };
        assert_eq!(rule(9, 0), Rule::FREE);
        assert_eq!((rule(0, 0).cost_factor, rule(0, 0).max_speed_mps), (2.0, f64::INFINITY));
        assert_eq!((rule(3, 3).cost_factor, rule(3, 3).max_speed_mps), (6.0, 0.2));
        assert_eq!(terrain.surfaces().unwrap().names, ["mud"]);
        assert_eq!(terrain.surface_class(Cell { row: 3, column: 3 }), 0);
        assert_eq!(terrain.surface_class(Cell { row: 5, column: 5 }), Surfaces::UNNAMED);
        for (row, column) in [(6, 6), (7, 7), (8, 8)] {
            let cell = Cell { row, column };
            let touched = row >= 7;
            assert_eq!((terrain.is_keep_out(cell), terrain.is_blocked(cell)), (touched, touched), "{cell:?}");
        }
    }

    #[test]
    fn a_fence_leaves_no_gap_at_corners() {
        let fence = json!([{"type": "Feature", "properties": {"keep_out": true},
            "geometry": {"type": "LineString", "coordinates": [[0.0, 0.3], [10.0, 9.7]]}}]);
        let terrain = laid(fence);
        // From the north-west nothing steps, even diagonally, to the south-east.
        let mut reached = vec![Cell { row: 9, column: 0 }];
        let mut seen = [false; 100];
        while let Some(cell) = reached.pop() {
            for (row, column) in (cell.row.saturating_sub(1)..=(cell.row + 1).min(9)).flat_map(|row| {
                (cell.column.saturating_sub(1)..=(cell.column + 1).min(9)).map(move |c| (row, c))
            }) {
                let next = Cell { row, column };
                if !terrain.is_blocked(next) && !std::mem::replace(&mut seen[GRID.index(next)], true) {
                    reached.push(next);
                }
            }
        }
        assert!(!seen[GRID.index(Cell { row: 0, column: 9 })]);
    }

    #[test]
    fn the_content_id_holds_the_areas_and_patience_ends_the_work() {
        let plain = Terrain::new(GRID, &[0.0; 100]).unwrap();
        let with = |side: f64| {
            let document = json!({"type": "FeatureCollection", "features": [square(1.0, 1.0, side, json!({"keep_out": true}))]});
            plain.clone().with_areas(Areas::of(&document, &plain).unwrap())
        };
        assert_ne!(plain.content_id(), with(2.0).content_id());
        assert_ne!(with(3.0).content_id(), with(2.0).content_id());
        assert!(matches!(with(2.0).as_driven(&|| true), Err(Error::OutOfTime)));
    }
}
