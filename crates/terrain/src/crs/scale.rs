//! Whether a projection's metres are metres of the ground where a map lies, and what is done where they are not.

mod refusal;

pub use self::refusal::ScaleRefusal;
use super::{
    Crs, Projection, Size, UTM_SCALE_ERROR, multiplied,
    projection::{AxisScale, Conversion},
};
use crate::{Error, Warning, WarningKind, io::degrees::utm_epsg, resample::Affine};

/// Projections of the world that are not computed here, and whose metres are those of the ground nowhere or on a line alone.
const STRETCHED: [&str; 10] =
    ["eqearth", "sinu", "robin", "wintri", "vandg", "gall", "eck4", "eck6", "natearth", "igh"];

/// Scales that are so near to the ground's leave coordinates as they are: places that people have are in these, and no friction is known as well
/// (the paper's errors of power are 3 % and more, Table IV). A zone of UTM or a national grid far beyond its own strip is within.
const NEAR_GROUND: f64 = 0.01;

/// Brings coordinates in metres of a projection to metres of the ground. Scales within [`NEAR_GROUND`] stay, and are said beyond that of UTM at
/// a zone's edges; where the scale is
/// the same in all directions, coordinates are multiplied by it. Returns the text of the system that they are in then.
///
/// # Errors
/// A scale that differs between directions or over the map, with the command that brings the map to UTM.
pub(super) fn projected_to_ground(
    affine: Affine,
    size: Size,
    crs: &Crs,
    ending: &'static str,
    warnings: &mut Vec<Warning>,
) -> Result<(Affine, Option<String>), Error> {
    let as_it_stands = (affine, crs.text.clone());
    let name = || crs.name();
    let middle_m = affine.at(size.columns as f64 / 2.0, size.rows as f64 / 2.0);
    crs.refuse_south_orientated(middle_m, ending)?;
    let (columns, rows) = (size.columns as f64, size.rows as f64);
    let corners_m = [(0.0, 0.0), (columns, 0.0), (0.0, rows), (columns, rows)].map(|(c, r)| affine.at(c, r));
    let Some(conversion) = crs.conversion() else {
        warnings.extend(crs.unchecked_scale(&corners_m, ending)?);
        return Ok(as_it_stands);
    };
    let scale_at = |place_m: &[f64; 2]| conversion.axis_scale(*place_m);
    let scales: Option<Vec<AxisScale>> = [middle_m].iter().chain(&corners_m).map(scale_at).collect();
    let (Some(scales), Some([longitude_deg, latitude_deg])) = (scales, conversion.place_deg(middle_m)) else {
        let [x_m, y_m] = middle_m;
        warnings.push(unknown(&format!(
            "x {x_m} and y {y_m} lie beyond the area of the projection ({})",
            name()
        )));
        return Ok(as_it_stands);
    };
    let epsg = utm_epsg(longitude_deg, latitude_deg);
    let departure = scales.iter().map(AxisScale::departure).fold(0.0, f64::max);
    if departure <= NEAR_GROUND {
        warnings.extend((departure > UTM_SCALE_ERROR).then(|| off_by(&name(), departure)));
        return Ok(as_it_stands);
    }
    if let Some(uneven) = scales.iter().find(|scale| scale.unevenness() > UTM_SCALE_ERROR) {
        let AxisScale { x, y, shear } = *uneven;
        let angle_deg = shear.acos().to_degrees();
        return Err(ScaleRefusal::Uneven { crs: name(), x, y, angle_deg, ending, epsg }.into());
    }
    let means = || scales.iter().map(AxisScale::mean);
    let scale = scales[0].mean();
    let (least, most) = (means().fold(f64::INFINITY, f64::min), means().fold(0.0, f64::max));
    if (least / scale - 1.0).abs().max((most / scale - 1.0).abs()) > UTM_SCALE_ERROR {
        return Err(ScaleRefusal::Varying { crs: name(), least, most, ending, epsg }.into());
    }
    let detail = format!(
        "a metre of the projection ({}) is {scale:.4} m of ground here: coordinates were multiplied by that",
        name()
    );
    warnings.push(Warning::new(WarningKind::ProjectionScale, detail));
    Ok((affine.scaled(scale, scale), multiplied::text(crs, [scale; 2])))
}

impl Crs {
    /// The beginning of its text, for messages.
    pub(super) fn name(&self) -> String {
        self.text.as_deref().unwrap_or("of the file's own").chars().take(60).collect()
    }

    fn conversion(&self) -> Option<Conversion> {
        self.projection.as_ref()?.conversion()
    }

    /// Refuses coordinates that run west or south.
    ///
    /// # Errors
    /// [`ScaleRefusal::SouthOrientated`].
    pub(super) fn refuse_south_orientated(
        &self,
        middle_m: [f64; 2],
        ending: &'static str,
    ) -> Result<(), ScaleRefusal> {
        if !self.projection.as_ref().is_some_and(Projection::is_south_orientated) {
            return Ok(());
        }
        let place_deg = self.conversion().and_then(|conversion| conversion.place_deg(middle_m));
        let epsg = place_deg.map(|[longitude_deg, latitude_deg]| utm_epsg(longitude_deg, latitude_deg));
        Err(ScaleRefusal::SouthOrientated { crs: self.name(), ending, epsg })
    }

    /// A warning that nothing is known of the system's scale, where it is a projected one that is not computed here.
    ///
    /// # Errors
    /// A projection of the world, which is refused by name.
    pub(super) fn unchecked_scale(
        &self,
        places_m: &[[f64; 2]],
        ending: &'static str,
    ) -> Result<Option<Warning>, ScaleRefusal> {
        if self.mercator.is_some() || self.is_geographic {
            return Ok(None);
        }
        let name = self.name();
        let Some(projection) = &self.projection else {
            // A local frame has no projection; a code that is not known here may stand for any.
            let is_unknown = self.is_code_alone();
            return Ok(is_unknown.then(|| unknown(&format!("the projection of {name} is not known here"))));
        };
        if !projection.is_of_earth() {
            return Ok(Some(unknown(&format!("the system ({name}) is of another body than the earth"))));
        }
        if projection.conversion().is_some() {
            return Ok(None);
        }
        if let Some(departure) = projection.cassini_departure(places_m).filter(|off| *off <= NEAR_GROUND) {
            return Ok((departure > UTM_SCALE_ERROR).then(|| off_by(&name, departure)));
        }
        projection.refuse_world(&name, ending)?;
        let method = projection.name();
        Ok(Some(unknown(&format!("the projection ({name}, {method}) is not computed here"))))
    }
}

impl Projection {
    /// Refuses a projection of the world that is not computed here.
    ///
    /// # Errors
    /// [`ScaleRefusal::World`].
    pub(super) fn refuse_world(&self, crs: &str, ending: &'static str) -> Result<(), ScaleRefusal> {
        let method = self.name().to_owned();
        if !STRETCHED.contains(&method.as_str()) {
            return Ok(());
        }
        Err(ScaleRefusal::World { crs: crs.chars().take(60).collect(), method, ending })
    }
}

fn off_by(crs: &str, departure: f64) -> Warning {
    let detail = format!(
        "metres of the projection ({crs}) are off those of the ground by {:.2} % here, and lengths with them; coordinates stay as they are",
        100.0 * departure
    );
    Warning::new(WarningKind::ProjectionScale, detail)
}

fn unknown(why: &str) -> Warning {
    let detail = format!(
        "{why}, so that nothing is known of how long its metres are on the ground: they were taken for the ground's; \
         `gdalwarp` brings a map to its UTM zone"
    );
    Warning::new(WarningKind::ProjectionScale, detail)
}
