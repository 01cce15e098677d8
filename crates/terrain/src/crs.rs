//! Coordinate reference systems: what a name (`EPSG:32632`) or a text (WKT, `.prj`) says of a map's axes.
//!
//! A [`crate::Terrain`] keeps the name or text. Its x and y are the easting and northing of that system **in metres**, whatever unit
//! the system itself has.

mod earth;
mod epsg;
mod geographic;
mod ground;
mod mercator;
mod method;
mod multiplied;
mod prj;
mod projection;
mod scale;
mod unit;
mod warp;
mod wkt;

use self::method::Described;
pub(crate) use self::{
    earth::registered_code,
    ground::{GridSystem, Size, UNTOLD_CELLS, UTM_SCALE_ERROR, square_cells, to_ground},
    warp::{DegreeFrame, Regridding, Unwarped, Warp},
};
pub use self::{
    earth::{Earth, EarthError},
    epsg::vertical,
    mercator::{GroundScale, Mercator, Spacing},
    projection::Projection,
    scale::ScaleRefusal,
    unit::{LinearUnit, by_epsg_code, by_name},
    warp::WarpRefusal,
};

use crate::Error;

/// A system's axes, as far as a map needs to know them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crs {
    /// `EPSG:` and a code, or WKT; `None` where only some properties of it are known.
    pub text: Option<String>,
    /// Whether its axes are longitude and latitude.
    pub is_geographic: bool,
    /// Unit of its easting and northing, if it is projected and says so.
    pub unit: Option<LinearUnit>,
    /// Its projection, where that is a Mercator or equidistant cylindrical one, whose metres are no metres of the ground.
    pub mercator: Option<Mercator>,
    /// Any other projection, where it is known.
    pub projection: Option<Projection>,
    /// Unit and direction of its heights, if it has any.
    pub vertical: Option<Vertical>,
}

/// Unit and direction of a vertical system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertical {
    /// Unit of its numbers.
    pub unit: LinearUnit,
    /// Whether they grow downwards.
    pub is_depth: bool,
}

/// Longest text that is looked at [bytes]; the longest of the EPSG registry has some 5 kB.
const LONGEST_TEXT: usize = 1 << 16;

impl Crs {
    /// What `EPSG:code`, `EPSG:code+vertical code`, WKT (1 or 2) or the text of a `.prj` file says; `None` for any other text.
    ///
    /// ```
    /// use terrain::crs::Crs;
    /// let long_island = Crs::parse("EPSG:2263").unwrap();
    /// assert!((long_island.unit.unwrap().metres - 1200.0 / 3937.0).abs() < 1e-12);
    /// assert!(Crs::parse("EPSG:4326").unwrap().is_geographic);
    /// assert!(Crs::parse("somewhere in Minnesota").is_none());
    /// ```
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        if text.len() > LONGEST_TEXT {
            return None;
        }
        if let Some(codes) =
            text.get(..5).filter(|head| head.eq_ignore_ascii_case("EPSG:")).map(|_| &text[5..])
        {
            let (code, vertical_code) = codes.split_once('+').map_or((codes, None), |(h, v)| (h, Some(v)));
            let mut crs = Crs::from_epsg(code.parse().ok()?);
            if let Some(code) = vertical_code {
                crs.vertical = epsg::vertical(code.parse().ok()?);
            }
            return Some(crs);
        }
        wkt::parse(text)
    }

    /// What a PROJ definition (`+proj=utm +zone=32 +datum=WGS84`) says of axes, units and projection, but for a name; `None` for one
    /// without a projection.
    pub(crate) fn from_proj(definition: &str) -> Option<Self> {
        let is_named = definition.len() <= LONGEST_TEXT
            && definition.split_ascii_whitespace().any(|word| word.starts_with("+proj="));
        is_named.then(|| epsg::by_definition(definition))
    }

    /// The text of a system that a map in metres may be in.
    ///
    /// # Errors
    /// A text that names no system, one in degrees, or a code of anything but a projected system, as of heights or of a unit.
    pub fn of_metres(text: String) -> Result<String, Error> {
        let is_of_another_kind = |crs: &Crs| crs.is_geographic || crs.is_code_alone() && crs.unit.is_none();
        match Crs::parse(&text).filter(|crs| !is_of_another_kind(crs)) {
            Some(_) => Ok(text),
            None => Err(Error::Crs { found: text.chars().take(60).collect() }),
        }
    }

    /// Whether coordinates of the system that a text names are metres, as those of a map are; so is a text that names none.
    ///
    /// ```
    /// use terrain::crs::Crs;
    /// assert!(Crs::counts_metres("EPSG:27700") && !Crs::counts_metres("EPSG:32040"));
    /// ```
    pub fn counts_metres(text: &str) -> bool {
        Crs::parse(text).and_then(|crs| crs.unit).is_none_or(|unit| unit.is_metre())
    }

    /// Its projection, whichever kind it is.
    fn any_projection(&self) -> Option<Projection> {
        let of_mercator = || self.mercator.map(|mercator| Projection::of(mercator.definition()));
        self.projection.clone().or_else(of_mercator)
    }

    /// Whether nothing is known of the system but what the registry says of its code.
    fn is_code_alone(&self) -> bool {
        self.text.as_ref().is_some_and(|text| text.starts_with("EPSG:"))
    }

    /// What the EPSG registry says of a code. Of a code that is not known here nothing but itself is known.
    pub fn from_epsg(code: u32) -> Self {
        epsg::horizontal(code)
    }
}
