//! From a system's coordinates to metres of the ground, or the refusal that says how to bring a map there.

use super::{
    Crs, GroundScale, Mercator, ScaleRefusal, mercator::ECCENTRICITY_2, multiplied, projection::AxisScale,
    scale::projected_to_ground,
};
use crate::{
    Error, Grid, Terrain, Warning, WarningKind,
    io::degrees::{Coordinates, utm_epsg},
    resample::Affine,
};

/// Largest displacement that a grid cannot tell: half a cell.
pub(crate) const UNTOLD_CELLS: f64 = 0.5;

/// Scale error that is left to maps in UTM, which has 0.9996 on a zone's meridian and 1.0010 at its edges (Snyder 1987, page 58).
pub(crate) const UTM_SCALE_ERROR: f64 = 1e-3;

/// Pixels of a raster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
}

impl Size {
    /// Their number.
    pub(crate) fn pixels(self) -> u64 {
        self.columns as u64 * self.rows as u64
    }
}

impl Affine {
    /// Where a raster of some size lies, in the unit of its coordinates.
    pub(crate) fn coordinates(&self, size: Size) -> Coordinates {
        let [west, south, ..] = self.bounds(size.columns, size.rows);
        let [width, _] = self.edges();
        Coordinates {
            origin: [west, south],
            cell_size: width,
            rows: size.rows as u64,
            columns: size.columns as u64,
        }
    }
}

/// The system of a grid whose cells are metres of the ground, with what is doubtful of it.
pub(crate) struct GridSystem {
    text: Option<String>,
    doubt: Option<Warning>,
}

impl GridSystem {
    /// The system that a text names.
    ///
    /// # Errors
    /// A system that is none of metres, or whose metres are no metres of the ground there.
    pub(crate) fn of(text: Option<String>, grid: &Grid) -> Result<Self, Error> {
        let text = text.map(Crs::of_metres).transpose()?;
        let doubt = text.as_deref().map_or(Ok(None), |text| refuse_stretched(grid, text))?;
        Ok(GridSystem { text, doubt })
    }

    /// The ground in this system.
    pub(crate) fn on(self, terrain: Terrain) -> Terrain {
        let terrain = Terrain { crs: self.text, ..terrain };
        self.doubt.into_iter().fold(terrain, Terrain::with_warning)
    }
}

/// Refuses a system whose metres are no metres of the ground where a grid lies, of a grid that says that they are. Up to e² of the
/// ellipsoid, 0.7 %, the metres of a sphere are taken for those of the ground, as they are where a Mercator is brought to it. Returns a
/// warning where nothing is known of the system's scale.
///
/// # Errors
/// [`Error::StretchedCrs`] with the command that mends.
fn refuse_stretched(grid: &Grid, text: &str) -> Result<Option<Warning>, Error> {
    let Some(crs) = Crs::parse(text) else { return Ok(None) };
    let half_m = |cells: usize| cells as f64 * grid.cell_size_m / 2.0;
    let middle_m = [grid.origin_m[0] + half_m(grid.columns), grid.origin_m[1] + half_m(grid.rows)];
    crs.refuse_south_orientated(middle_m, "tif")?;
    if let Some(warning) = crs.unchecked_scale(&[middle_m], "tif")? {
        return Ok(Some(warning));
    }
    let Some((scale, [longitude_deg, latitude_deg])) = scale_at(&crs, middle_m) else { return Ok(None) };
    let epsg = utm_epsg(longitude_deg, latitude_deg);
    let found = || text.chars().take(60).collect::<String>();
    let AxisScale { x, y, shear } = scale;
    if (scale.mean() - 1.0).abs() > ECCENTRICITY_2 {
        return Err(Error::StretchedCrs { found: found(), scale: scale.mean(), epsg });
    }
    if scale.unevenness() > 2.0 * ECCENTRICITY_2 {
        let angle_deg = shear.acos().to_degrees();
        return Err(ScaleRefusal::Uneven { crs: found(), x, y, angle_deg, ending: "tif", epsg }.into());
    }
    Ok(None)
}

/// Ground by map at a place, and its longitude and latitude, of a projection that is computed here.
fn scale_at(crs: &Crs, place_m: [f64; 2]) -> Option<(AxisScale, [f64; 2])> {
    if let Some(mercator) = crs.mercator {
        let GroundScale { east, north } = mercator.ground_scale(place_m[1]);
        let scale = AxisScale { x: east, y: north, shear: 0.0 };
        return Some((scale, mercator.place_deg(place_m[0], place_m[1])));
    }
    let conversion = crs.projection.as_ref()?.conversion()?;
    conversion.axis_scale(place_m).zip(conversion.place_deg(place_m))
}

/// Brings projected coordinates to metres of the ground: by the system's unit and by the scale of its projection. Returns the text of the
/// system that they are in then. What was changed is added to the warnings.
///
/// # Errors
/// A scale that changes over the map by more than its cells can tell, or that differs between directions.
pub(crate) fn to_ground(
    affine: Affine,
    size: Size,
    crs: &Crs,
    ending: &'static str,
    warnings: &mut Vec<Warning>,
) -> Result<(Affine, Option<String>), Error> {
    let metres = crs.unit.map_or(1.0, |unit| unit.metres);
    let affine = affine.scaled(metres, metres);
    match &crs.mercator {
        Some(mercator) => mercator_to_ground(affine, size, mercator, (crs, ending), warnings),
        None => projected_to_ground(affine, size, crs, ending, warnings),
    }
}

/// Brings a Mercator's metres to those of the ground, if one scale serves all the map.
fn mercator_to_ground(
    affine: Affine,
    size: Size,
    mercator: &Mercator,
    (crs, ending): (&Crs, &'static str),
    warnings: &mut Vec<Warning>,
) -> Result<(Affine, Option<String>), Error> {
    let [west, south, east, north] = affine.bounds(size.columns, size.rows);
    let middle_m = [(west + east) / 2.0, (south + north) / 2.0];
    let [at_south, scale, at_north] = [south, middle_m[1], north].map(|y_m| mercator.ground_scale(y_m));
    let (columns, rows) = (size.columns as f64, size.rows as f64);
    // Rows grow shorter towards a pole, by as much on either side of the middle; their distances do too.
    let sideways = (at_north.east - at_south.east).abs() / scale.east * columns / 4.0;
    let lengthways = (at_north.north - at_south.north).abs() / scale.north * rows / 8.0;
    let name = crs.text.clone().unwrap_or_else(|| "of the file's own".into());
    let displaced = sideways + lengthways;
    if displaced.is_nan() || displaced > UNTOLD_CELLS {
        let [longitude_deg, latitude_deg] = mercator.place_deg(middle_m[0], middle_m[1]);
        return Err(Error::MercatorScale {
            crs: name,
            south: at_south.east,
            north: at_north.east,
            ending,
            epsg: utm_epsg(longitude_deg, latitude_deg),
        });
    }
    let longest = columns.max(rows);
    if (scale.east - 1.0).abs().max((scale.north - 1.0).abs()) <= UTM_SCALE_ERROR {
        return Ok((affine, crs.text.clone()));
    }
    let mean = (scale.east * scale.north).sqrt();
    let detail = format!(
        "a metre of the projection ({name}) is {:.4} m of ground eastwards and {:.4} m northwards here: coordinates were multiplied by that",
        scale.east, scale.north
    );
    warnings.push(Warning::new(WarningKind::ProjectionScale, detail));
    if (scale.east / mean - 1.0).abs() * longest <= UNTOLD_CELLS {
        return Ok((affine.scaled(mean, mean), multiplied::text(crs, [mean; 2])));
    }
    Ok((affine.scaled(scale.east, scale.north), multiplied::text(crs, [scale.east, scale.north])))
}

/// The grid of upright square cells in some system, brought to metres of the ground, and the text of the system that it is in then;
/// `ending` is that of the file's name.
///
/// # Errors
/// A projection that no one scale brings to the ground, or a grid that no map may have.
pub(crate) fn square_cells(
    affine: Affine,
    size: Size,
    crs: &Crs,
    ending: &'static str,
    warnings: &mut Vec<Warning>,
) -> Result<(Grid, Option<String>), Error> {
    let [cell, _] = affine.edges();
    let (affine, text) = to_ground(affine, size, crs, ending, warnings)?;
    let (columns, rows) = (size.columns as u64, size.rows as u64);
    let [width_m, height_m] = affine.edges();
    let displaced = (width_m - height_m).abs() / width_m * columns.max(rows) as f64;
    if let Some(mercator) = crs.mercator.filter(|_| displaced > UNTOLD_CELLS) {
        let [longitude_deg, latitude_deg] = mercator.place_deg(affine.origin[0], affine.origin[1]);
        return Err(Error::MercatorScale {
            crs: crs.text.clone().unwrap_or_else(|| "of the file's own".into()),
            south: width_m / cell,
            north: height_m / cell,
            ending,
            epsg: utm_epsg(longitude_deg, latitude_deg),
        });
    }
    Ok((Terrain::check_size(rows, columns, width_m, affine.origin)?, text))
}
