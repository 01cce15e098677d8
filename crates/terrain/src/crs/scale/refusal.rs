//! Why a projection's metres are not brought to the ground.

/// A map in metres that are none of the ground, with the command that brings it to UTM.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScaleRefusal {
    /// A scale that differs between directions.
    #[error(
        "the map is in a projection ({crs}) of which a metre is {x:.4} m of ground along x and {y:.4} m along y, at {angle_deg:.1}° to each other: bring it to UTM with `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.{ending} out.tif`"
    )]
    Uneven {
        /// The coordinate reference system.
        crs: String,
        /// Ground by map along x.
        x: f64,
        /// Ground by map along y.
        y: f64,
        /// Angle on the ground between the map's axes [°].
        angle_deg: f64,
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the UTM zone of the middle.
        epsg: u32,
    },
    /// A scale that differs over the map.
    #[error(
        "the map is in a projection ({crs}) of which a metre is {least:.4} to {most:.4} m of ground over the map: bring it to UTM with `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.{ending} out.tif`"
    )]
    Varying {
        /// The coordinate reference system.
        crs: String,
        /// Least ground by map.
        least: f64,
        /// Most ground by map.
        most: f64,
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the UTM zone of the middle.
        epsg: u32,
    },
    /// A projection of the world.
    #[error(
        "the map is in a projection of the world ({crs}, {method}), whose metres are not those of the ground: bring it to UTM with `gdalwarp -t_srs EPSG:32632 -r bilinear in.{ending} out.tif`, with 326 and the number of its zone, or 327 south of the equator"
    )]
    World {
        /// The coordinate reference system.
        crs: String,
        /// PROJ's name of the projection.
        method: String,
        /// Ending of the file's name.
        ending: &'static str,
    },
    /// Coordinates that run west or south.
    #[error(
        "the map is in a system ({crs}) whose coordinates run west and south, but x must point east and y north: bring it to UTM with `gdalwarp -t_srs EPSG:{} -r bilinear in.{ending} out.tif`{}",
        epsg.unwrap_or(EXAMPLE_ZONE),
        if epsg.is_none() { ", with 326 and the number of its zone, or 327 south of the equator" } else { "" }
    )]
    SouthOrientated {
        /// The coordinate reference system.
        crs: String,
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the UTM zone of the middle, where that is known.
        epsg: Option<u32>,
    },
}

/// A zone of UTM, to show the form of a command.
const EXAMPLE_ZONE: u32 = 32_632;
