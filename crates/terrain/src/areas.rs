//! Areas of a map: what people know of the ground and want of the robot there, as GeoJSON.

mod class_table;
mod classes;
mod effect;
mod error;
mod map_frame;
mod parse;
mod placing;
mod raster;
mod shape;
mod unknown_ground;
mod zones;

use self::shape::Shape;
pub use self::{
    classes::{ClassAreas, ClassesError},
    effect::Effect,
    error::AreaError,
    unknown_ground::UnknownGround,
    zones::{Rule, Zones},
};

/// Polygons and lines of a map, each with what it changes there. Later ones lie over earlier ones.
///
/// ```
/// use terrain::{Grid, Terrain, areas::Areas};
/// let grid = Grid { rows: 4, columns: 4, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
/// let terrain = Terrain::new(grid, &[0.0; 16]).unwrap();
/// let areas = Areas::of(
///     &serde_json::json!({"type": "FeatureCollection", "features": [{"type": "Feature",
///         "properties": {"keep_out": true},
///         "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]]}}]}),
///     &terrain,
/// ).unwrap();
/// let driven = terrain.with_areas(areas).as_driven(&|| false).unwrap();
/// assert!(driven.is_blocked(grid.cell(0)) && !driven.is_blocked(grid.cell(15)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Areas {
    /// The document, as it was given.
    text: String,
    areas: Vec<Area>,
    /// How the coordinates were read where that is not plain, and properties that mean nothing here.
    notes: Vec<String>,
}

/// One polygon or line, or several, of one effect.
#[derive(Clone, Debug, PartialEq)]
struct Area {
    /// Position among the document's features.
    feature: usize,
    shapes: Vec<Shape>,
    effect: Effect,
}

impl Areas {
    /// Most features of a document.
    pub const MOST_FEATURES: usize = 2000;
    /// Most positions of all features.
    pub const MOST_POSITIONS: usize = 200_000;

    /// Longest document [bytes].
    pub const LONGEST_TEXT: usize = 1 << 24;

    /// The document, as it was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Number of features.
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty()
    }

    /// How the coordinates were read where that is not plain, and properties that mean nothing here.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Surfaces that the areas name.
    pub fn surfaces(&self) -> impl Iterator<Item = &str> {
        self.areas.iter().filter_map(|area| area.effect.surface.as_deref())
    }
}
