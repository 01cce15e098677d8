//! Areas out of a raster of classes, as land cover: what a class changes says a table.
//!
//! The classes that lie over the map become one feature each, of rectangles along the raster's pixels: ordinary areas, which are
//! stored, shown and changed as any others.

use std::{collections::BTreeMap, ops::Range};

use serde_json::{Value, json};

use super::{AreaError, Areas, class_table::ClassTable};
use crate::{
    Error, Terrain,
    crs::{Earth, EarthError, registered_code},
    io::geotiff::ClassRaster,
    resample::Affine,
};

/// Why a raster of classes gives no areas.
#[derive(Debug, thiserror::Error)]
pub enum ClassesError {
    /// A file that holds no classes.
    #[error("the raster of classes: {0}")]
    Raster(#[from] Error),
    /// A table that cannot be, by its place.
    #[error(transparent)]
    Table(#[from] AreaError),
    /// Map or raster does not say where on earth it lies, or in a way that is not known here.
    #[error(
        "the {what} cannot be placed: {why}; `gdalwarp -t_srs EPSG:4326 -r near in.tif out.tif` brings a raster of classes to degrees"
    )]
    Placed {
        /// Which of both.
        what: &'static str,
        /// Why not.
        why: String,
    },
    /// A raster of another place.
    #[error(
        "the raster of classes does not lie over the map: the map's middle is at its column {column:.0} and row {row:.0}, but it has {columns} columns and {rows} rows"
    )]
    Elsewhere {
        /// Place of the map's middle in the raster.
        column: f64,
        /// Place of the map's middle in the raster.
        row: f64,
        /// Columns that there are.
        columns: usize,
        /// Rows that there are.
        rows: usize,
    },
    /// Nothing in the table is in the raster over the map.
    #[error("none of the table's classes ({table}) lies over the map, which holds {found}")]
    NoneOfTable {
        /// Classes of the table.
        table: String,
        /// Classes over the map.
        found: String,
    },
    /// Too fine a pattern.
    #[error(
        "the raster's pattern over the map has {found} rectangles, but at most {most} are read: coarsen it (`gdalwarp -tr 10 10 -r mode in.tif out.tif`)"
    )]
    TooFine {
        /// Rectangles that there are.
        found: usize,
        /// Most that are read.
        most: usize,
    },
}

/// Areas of a raster of classes, and what is to be said about them.
#[derive(Debug)]
pub struct ClassAreas {
    /// A GeoJSON feature collection, as [`Areas::of`] reads it.
    pub document: Value,
    /// Classes over the map that the table does not name, and parts of the map that the raster does not cover.
    pub notes: Vec<String>,
}

impl Areas {
    /// Areas over a map from a GeoTIFF of classes, as ESA WorldCover, and a table from class to properties:
    /// `{"80": {"keep_out": true}, "40": {"surface": "sandy_loam"}, "50": null}`. Only the part over the map is read.
    ///
    /// # Errors
    /// A raster or table that cannot be read, by what is wrong with it; places that cannot be brought together.
    pub fn of_classes(tiff: &[u8], table: &Value, terrain: &Terrain) -> Result<ClassAreas, ClassesError> {
        let table = ClassTable::of(table)?;
        let raster = ClassRaster::open(tiff)?;
        let frames = Frames::of(&raster, terrain)?;
        let window = Window::over(terrain, &raster, &frames)?;
        let classes = raster.window(window.rows.clone(), window.columns.clone(), Terrain::MAX_CELLS)?;
        let found = rectangles(&classes, window.columns.len());
        let wanted = found.iter().filter(|(class, _)| table.properties(**class).is_some());
        let count = wanted.clone().map(|(_, rectangles)| rectangles.len()).sum::<usize>();
        let most = Areas::MOST_POSITIONS / CORNERS;
        if count > most {
            return Err(ClassesError::TooFine { found: count, most });
        }
        let list = |classes: &mut dyn Iterator<Item = i64>| {
            classes.map(|class| class.to_string()).collect::<Vec<_>>().join(", ")
        };
        if count == 0 {
            let table = list(&mut table.classes());
            return Err(ClassesError::NoneOfTable { table, found: list(&mut found.keys().copied()) });
        }
        let mut features = Vec::new();
        for (class, rectangles) in wanted {
            let polygons: Vec<Value> = rectangles
                .iter()
                .map(|rectangle| frames.polygon(rectangle, &window))
                .collect::<Result<_, _>>()?;
            let properties = table.properties(*class);
            features
                .push(json!({"type": "Feature", "id": format!("class {class}"), "properties": properties,
                "geometry": {"type": "MultiPolygon", "coordinates": polygons}}));
        }
        let mut document = json!({"type": "FeatureCollection", "features": features});
        if frames.are_the_same() {
            document["crs"] = Value::Null;
        }
        let unnamed = list(&mut found.keys().copied().filter(|class| !table.knows(*class)));
        let unnamed = (!unnamed.is_empty()).then(|| {
            format!("classes {unnamed} lie over the map, but not in the table: they change nothing")
        });
        let notes = unnamed.into_iter().chain(window.is_cut.then(|| {
            "the raster of classes covers the map only in part: the rest stays as it is".to_owned()
        }));
        Ok(ClassAreas { notes: notes.collect(), document })
    }
}

/// Positions of a rectangle's ring.
const CORNERS: usize = 5;

/// The way between a raster's pixels and a map.
struct Frames {
    /// From pixels to the raster's coordinates, in metres or degrees.
    affine: Affine,
    /// The map's way to degrees, and the raster's if it is not in degrees itself; none where both are in the same system.
    ways: Option<(Earth, Option<Earth>)>,
}

impl Frames {
    fn of(raster: &ClassRaster<'_>, terrain: &Terrain) -> Result<Self, ClassesError> {
        const RASTER: &str = "raster of classes";
        let placed = |what| move |why: EarthError| ClassesError::Placed { what, why: why.to_string() };
        let crs = &raster.crs;
        if crs.is_geographic {
            if crs.earth_centred_degrees().is_none() {
                let name = crs.text.as_deref().unwrap_or("a system of its own");
                let why = format!("its degrees are those of {name}, not of WGS 84");
                return Err(ClassesError::Placed { what: RASTER, why });
            }
            let own = terrain.earth().map_err(placed("map"))?;
            return Ok(Frames { affine: raster.affine, ways: Some((own, None)) });
        }
        // The same registered system, though its coordinates were multiplied to be the map's.
        let [own, other] =
            [terrain.crs.as_deref(), crs.text.as_deref()].map(|text| text.and_then(registered_code));
        if let (Some((own, [unit_x_m, unit_y_m])), Some((other, _))) = (own, other)
            && own == other
        {
            return Ok(Frames { affine: raster.affine.scaled(unit_x_m, unit_y_m), ways: None });
        }
        let unit_m = crs.unit.map_or(1.0, |unit| unit.metres);
        let affine = raster.affine.scaled(unit_m, unit_m);
        if crs.text == terrain.crs {
            return Ok(Frames { affine, ways: None });
        }
        let Some(text) = &crs.text else {
            let why = "it does not say in which system it is".to_owned();
            return Err(ClassesError::Placed { what: RASTER, why });
        };
        let own = terrain.earth().map_err(placed("map"))?;
        let other = Earth::of(text).map_err(placed(RASTER))?;
        Ok(Frames { affine, ways: Some((own, Some(other))) })
    }

    fn are_the_same(&self) -> bool {
        self.ways.is_none()
    }

    /// Column and row of the raster at a place of the map.
    fn pixel(&self, place_m: [f64; 2]) -> Result<[f64; 2], EarthError> {
        let coordinates = match &self.ways {
            None => place_m,
            Some((own, None)) => own.place_deg(place_m)?,
            Some((own, Some(other))) => other.place_m(own.place_deg(place_m)?)?,
        };
        Ok(self.affine.inverse(coordinates))
    }

    /// The place of a pixel's corner as the document has it: metres of the map, or degrees.
    fn corner(&self, column: usize, row: usize) -> Result<[f64; 2], EarthError> {
        let coordinates = self.affine.at(column as f64, row as f64);
        match &self.ways {
            None | Some((_, None)) => Ok(coordinates),
            Some((_, Some(other))) => other.place_deg(coordinates),
        }
    }

    /// A rectangle of a window as the coordinates of a GeoJSON polygon.
    fn polygon(&self, rectangle: &Rectangle, window: &Window) -> Result<Value, ClassesError> {
        let columns = [rectangle.columns.start, rectangle.columns.end].map(|at| at + window.columns.start);
        let rows = [rectangle.rows.start, rectangle.rows.end].map(|at| at + window.rows.start);
        let round = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)];
        let mut ring = Vec::with_capacity(CORNERS);
        for (column, row) in round {
            let corner = self
                .corner(columns[column], rows[row])
                .map_err(|why| ClassesError::Placed { what: "raster of classes", why: why.to_string() })?;
            ring.push(corner);
        }
        // RFC 7946 wants outer rings counter-clockwise.
        if doubled_area(&ring) < 0.0 {
            ring.reverse();
        }
        Ok(json!([ring]))
    }
}

fn doubled_area(ring: &[[f64; 2]]) -> f64 {
    let [x, y] = ring[0];
    ring.windows(2)
        .map(|pair| (pair[0][0] - x) * (pair[1][1] - y) - (pair[1][0] - x) * (pair[0][1] - y))
        .sum()
}

/// The part of a raster that lies over a map.
struct Window {
    rows: Range<usize>,
    columns: Range<usize>,
    /// Whether part of the map lies beyond the raster.
    is_cut: bool,
}

impl Window {
    /// Places along each edge of the map whose pixels are looked up: edges bend between systems, by less than a pixel between two of so many.
    const ALONG_AN_EDGE: usize = 64;

    fn over(terrain: &Terrain, raster: &ClassRaster<'_>, frames: &Frames) -> Result<Self, ClassesError> {
        let placed = |why: EarthError| ClassesError::Placed { what: "map", why: why.to_string() };
        let ([west, south], [east, north]) = (terrain.grid.origin_m, terrain.grid.far_corner_m());
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for step in 0..=Self::ALONG_AN_EDGE {
            let share = step as f64 / Self::ALONG_AN_EDGE as f64;
            let (x, y) = (west + share * (east - west), south + share * (north - south));
            for place_m in [[x, south], [x, north], [west, y], [east, y]] {
                let pixel = frames.pixel(place_m).map_err(placed)?;
                for axis in 0..2 {
                    least[axis] = least[axis].min(pixel[axis]);
                    most[axis] = most[axis].max(pixel[axis]);
                }
            }
        }
        let size = raster.size();
        // A pixel more on each side holds what edges bend by.
        let range = |axis: usize| {
            let inside = |at: f64| at.clamp(0.0, size[axis] as f64) as usize;
            inside(least[axis].floor() - 1.0)..inside(most[axis].ceil() + 1.0)
        };
        let (columns, rows) = (range(0), range(1));
        let is_beside = |axis: usize| most[axis] <= 0.0 || least[axis] >= size[axis] as f64;
        if is_beside(0) || is_beside(1) || columns.is_empty() || rows.is_empty() {
            let [column, row] = [0, 1].map(|axis| (least[axis] + most[axis]) / 2.0);
            return Err(ClassesError::Elsewhere { column, row, columns: size[0], rows: size[1] });
        }
        // What rounding of coordinates leaves is no part of the map.
        const ROUNDING_PIXELS: f64 = 1e-3;
        let is_cut = (0..2)
            .any(|axis| least[axis] < -ROUNDING_PIXELS || most[axis] > size[axis] as f64 + ROUNDING_PIXELS);
        Ok(Window { rows, columns, is_cut })
    }
}

/// Pixels of one class, side by side and one below the other, in a window.
#[derive(Clone, Debug, PartialEq)]
struct Rectangle {
    rows: Range<usize>,
    columns: Range<usize>,
}

/// Each class's pixels as rectangles: runs of rows, those of the same columns joined downwards.
fn rectangles(classes: &[Option<i64>], columns: usize) -> BTreeMap<i64, Vec<Rectangle>> {
    let mut done: BTreeMap<i64, Vec<Rectangle>> = BTreeMap::new();
    let mut open: BTreeMap<(usize, usize, i64), usize> = BTreeMap::new();
    let rows = classes.len() / columns;
    for row in 0..=rows {
        let mut still_open = BTreeMap::new();
        let line = classes.get(row * columns..(row + 1) * columns).unwrap_or_default();
        let mut start = 0;
        for run in line.chunk_by(|a, b| a == b) {
            let end = start + run.len();
            if let Some(class) = run[0] {
                let key = (start, end, class);
                still_open.insert(key, open.remove(&key).unwrap_or(row));
            }
            start = end;
        }
        for ((from, until, class), top) in std::mem::replace(&mut open, still_open) {
            done.entry(class).or_default().push(Rectangle { rows: top..row, columns: from..until });
        }
    }
    done
}
