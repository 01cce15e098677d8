//! GeoKeys (OGC GeoTIFF 1.1) that say of a written raster which coordinate reference system it is in.

use super::geokeys::{
    CITATION, ESRI_CITATION, LINEAR_UNITS, MODEL_TYPE, PROJECTED_CITATION, PROJECTED_CRS, RASTER_TYPE,
    USER_DEFINED,
};
use crate::crs::{Crs, LinearUnit, Mercator, Spacing, registered_code};

const METRE: u16 = 9001;
/// Longest citation [bytes]: GDAL reads 511 of them (GTIFGetOGISDefn).
const LONGEST_CITATION: usize = 511;
/// Type of a key whose value stands among the texts.
const IN_TEXT: u16 = 34737;

/// What a raster says of its system.
pub(super) struct SystemKeys {
    /// The GeoKey directory.
    pub(super) directory: Vec<u16>,
    /// The text that the directory refers to.
    pub(super) citation: Option<String>,
    /// Length of the unit that coordinates have to be written in [m].
    pub(super) unit_m: f64,
}

impl SystemKeys {
    /// The keys for a map's `crs`. A code is written only where coordinates in its unit, or divided by the scale that brought them to
    /// the ground, are the map's; a system without a code as its WKT, as Esri does; anything else by name, as a frame of the user's own
    /// in metres.
    pub(super) fn of(crs: Option<&str>) -> Self {
        let Some(text) = crs else { return Self::own_metres(None) };
        if let Some((code, [unit_x_m, unit_y_m])) = registered_code(text)
            && let Ok(code) = u16::try_from(code)
            && unit_x_m == unit_y_m
        {
            return Self::registered(code, unit_x_m);
        }
        let parsed = Crs::parse(text).filter(|crs| text.contains(['[', '(']) && !crs.is_geographic);
        // As maps that were stored by earlier versions are named.
        let mercator = parsed.as_ref().and_then(|crs| crs.mercator);
        if let Some((mercator, code)) = mercator.and_then(|mercator| Some((mercator, base_code(&mercator)?)))
        {
            return Self::registered(code, mercator.equator_scale);
        }
        let citation = format!("{ESRI_CITATION}{text}|");
        match parsed.and_then(|crs| crs.unit) {
            Some(unit) if citation.len() <= LONGEST_CITATION && text.is_ascii() && !text.contains('|') => {
                let length = citation.len() as u16;
                let keys = [[PROJECTED_CRS, 0, 1, USER_DEFINED], [PROJECTED_CITATION, IN_TEXT, length, 0]];
                SystemKeys { directory: directory(&keys), citation: Some(citation), unit_m: unit.metres }
            }
            _ => Self::own_metres(Some(text)),
        }
    }

    /// A system by its code.
    fn registered(code: u16, unit_m: f64) -> Self {
        SystemKeys { directory: directory(&[[PROJECTED_CRS, 0, 1, code]]), citation: None, unit_m }
    }

    /// A frame of the user's own in metres, with the beginning of the name of the system that it comes from.
    fn own_metres(name: Option<&str>) -> Self {
        const LONGEST_NAME: usize = 200;
        let plain = |c: char| if c.is_ascii_graphic() && c != '|' { c } else { ' ' };
        let citation = name.map(|name| {
            let name: String = name.chars().take(LONGEST_NAME).map(plain).collect();
            format!("{name}, in metres|")
        });
        let mut keys = Vec::new();
        if let Some(citation) = &citation {
            keys.push([CITATION, IN_TEXT, citation.len() as u16, 0]);
        }
        keys.extend([[PROJECTED_CRS, 0, 1, USER_DEFINED], [LINEAR_UNITS, 0, 1, METRE]]);
        SystemKeys { directory: directory(&keys), citation, unit_m: LinearUnit::METRE.metres }
    }
}

/// The code of the Mercator of which another is a multiple: both are true to scale on the equator there.
fn base_code(mercator: &Mercator) -> Option<u16> {
    let is_plain =
        mercator.is_on_wgs84 && mercator.central_meridian_deg == 0.0 && mercator.false_origin_m == [0.0; 2];
    match mercator.spacing {
        _ if !is_plain => None,
        Spacing::Spherical => Some(3857),
        Spacing::Conformal => Some(3395),
        Spacing::Even => None,
    }
}

/// A directory that says: projected, a pixel is an area, and these keys, which are in order.
fn directory(keys: &[[u16; 4]]) -> Vec<u16> {
    const PROJECTED: u16 = 1;
    const AREA: u16 = 1;
    let usual = [[MODEL_TYPE, 0, 1, PROJECTED], [RASTER_TYPE, 0, 1, AREA]];
    let head = [1, 1, 0, (usual.len() + keys.len()) as u16];
    [head].into_iter().chain(usual).chain(keys.iter().copied()).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Grid,
        io::geotiff::{read, write},
    };

    /// The grid and the system that a written raster is read with.
    fn round_trip(crs: Option<&str>) -> (Grid, Option<String>) {
        round_trip_at([300_000.0, 5_000_000.0], crs)
    }

    fn round_trip_at(origin_m: [f64; 2], crs: Option<&str>) -> (Grid, Option<String>) {
        let grid = Grid { rows: 2, columns: 3, cell_size_m: 0.5, origin_m };
        let terrain = read(&write(&grid, &[1.0; 6], crs).unwrap(), 6).unwrap();
        let off_m = (0..2).map(|axis| (terrain.grid.origin_m[axis] - grid.origin_m[axis]).abs()).sum::<f64>();
        assert!(off_m < 1e-6 && (terrain.grid.cell_size_m - 0.5).abs() < 1e-9, "{:?}", terrain.grid);
        (terrain.grid, terrain.crs)
    }

    #[test]
    fn codes_are_written_in_their_own_unit_and_read_back() {
        for (crs, origin_m) in [
            ("EPSG:32632", [300_000.0, 5_000_000.0]),
            ("EPSG:2263", [300_000.0, 60_000.0]),
            ("EPSG:27700", [336_000.0, 567_000.0]),
        ] {
            assert_eq!(round_trip_at(origin_m, Some(crs)).1.as_deref(), Some(crs));
        }
        let zone = "PROJCS[\"NAD_1983_UTM_Zone_15N\",GEOGCS[\"g\"],PROJECTION[\"Transverse_Mercator\"],UNIT[\"Foot_US\",0.3048006096012192]]";
        assert_eq!(round_trip(Some(zone)).1.as_deref(), Some("EPSG:26915"));
    }

    /// A Mercator as maps of earlier versions name it.
    fn earlier_text(meridian_deg: f64, extension: &str) -> String {
        format!(
            "PROJCS[\"Mercator in metres of the ground\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
             PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Mercator_1SP\"],\
             PARAMETER[\"central_meridian\",{meridian_deg}],PARAMETER[\"scale_factor\",0.69],PARAMETER[\"false_easting\",0],\
             PARAMETER[\"false_northing\",0],UNIT[\"metre\",1]{extension}]"
        )
    }

    #[test]
    fn a_scaled_mercator_is_written_in_the_coordinates_that_its_scale_was_applied_to() {
        let sphere = ",EXTENSION[\"PROJ4\",\"+proj=merc +a=6378137 +b=6378137 +k=0.69 +nadgrids=@null\"]";
        for (code, text) in [
            (3857, "PROJCS[\"EPSG:3857 times 0.69\",GEOGCS[\"g\"],PROJECTION[\"custom_proj4\"],UNIT[\"metre\",1]]".to_owned()),
            (3857, earlier_text(0.0, sphere)),
            (3395, earlier_text(0.0, "")),
        ] {
            let keys = SystemKeys::of(Some(&text));
            assert!(keys.directory.contains(&code) && (keys.unit_m - 0.69).abs() < 1e-12, "{text}");
        }
        let keys = SystemKeys::of(Some(&earlier_text(100.0, "")));
        assert!(keys.directory.contains(&USER_DEFINED) && keys.citation.is_some() && keys.unit_m == 1.0);
        let of_each_axis = "LOCAL_CS[\"EPSG:3857 times 0.69 and 0.688\",UNIT[\"metre\",1]]";
        assert_eq!(
            round_trip_at([300_000.0, 4_034_000.0], Some(of_each_axis)).1.as_deref(),
            Some(of_each_axis),
            "no unit is two lengths"
        );
    }

    #[test]
    fn what_is_not_known_is_named_and_in_metres() {
        assert_eq!(round_trip(None).1, None);
        for crs in ["EPSG:9473", "EPSG:54030"] {
            let keys = SystemKeys::of(Some(crs));
            assert!(keys.directory.contains(&USER_DEFINED), "{crs}");
            assert_eq!(keys.citation.unwrap(), format!("{crs}, in metres|"));
            assert_eq!(round_trip(Some(crs)).1, None);
        }
    }
}
