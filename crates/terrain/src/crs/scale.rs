//! Whether a projection's metres are metres of the ground where a map lies, and what is done where they are not.

mod refusal;

pub use self::refusal::ScaleRefusal;
use super::{Crs, Projection, Size, UTM_SCALE_ERROR, multiplied, projection::AxisScale};
use crate::{Error, Warning, WarningKind, io::degrees::utm_epsg, resample::Affine};

/// Projections that are not computed here and stay close to the ground in the country or strip that each was made for.
const FAITHFUL: [&str; 6] = ["omerc", "somerc", "krovak", "cass", "nzmg", "labrd"];

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
    let Some(projection) = &crs.projection else { return Ok(as_it_stands) };
    let name = || {
        crs.text.clone().unwrap_or_else(|| "of the file's own".into()).chars().take(60).collect::<String>()
    };
    let Some(conversion) = projection.conversion() else {
        projection.refuse_world(&name(), ending)?;
        let method = projection.name();
        if !FAITHFUL.contains(&method) {
            warnings.push(unknown(&format!("the projection ({}, {method}) is not computed here", name())));
        }
        return Ok(as_it_stands);
    };
    let (columns, rows) = (size.columns as f64, size.rows as f64);
    let middle_m = affine.at(columns / 2.0, rows / 2.0);
    let corners_m = [(0.0, 0.0), (columns, 0.0), (0.0, rows), (columns, rows)].map(|(c, r)| affine.at(c, r));
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
    if projection.is_south_orientated() {
        return Err(ScaleRefusal::SouthOrientated { crs: name(), ending, epsg }.into());
    }
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
    let text = crs.text.as_deref().and_then(|text| multiplied::text(text, scale));
    Ok((affine.scaled(scale, scale), text))
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
