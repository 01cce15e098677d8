//! Why a grid of degrees is not warped.

use crate::crs::EarthError;

/// A grid of degrees that is not brought to metres here, with what mends it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WarpRefusal {
    /// A datum that differs from WGS 84, or that is not known.
    #[error(
        "the file is in degrees of a system ({found}) that is not known to be WGS 84 within two metres, and metres are needed: project it by `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.{ending} out.tif`"
    )]
    System {
        /// The system, or what is known of it.
        found: String,
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the UTM zone of the middle.
        epsg: u32,
    },
    /// Columns that do not run along parallels.
    #[error(
        "pixels of degrees are turned against north, and metres are needed: project the file by `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.{ending} out.tif`"
    )]
    Turned {
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the UTM zone of the middle.
        epsg: u32,
    },
    /// Numbers that are no longitudes and latitudes.
    #[error(
        "the file's system is in degrees, but its coordinates, {west_deg} to {east_deg} and {south_deg} to {north_deg}, are no longitudes and latitudes: name the system that they are in, as by `gdal_edit.py -a_srs EPSG:CODE FILE` or a .prj file"
    )]
    OffGlobe {
        /// First x.
        west_deg: f64,
        /// First y.
        south_deg: f64,
        /// Last x.
        east_deg: f64,
        /// Last y.
        north_deg: f64,
    },
    /// Latitudes that UTM is not for.
    #[error(
        "latitudes {south_deg} to {north_deg} reach beyond those of UTM, 80° S to 84° N: project the file by `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.{ending} out.tif`"
    )]
    Polar {
        /// South edge [°].
        south_deg: f64,
        /// North edge [°].
        north_deg: f64,
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the polar stereographic grid.
        epsg: u32,
    },
    /// More longitudes than one zone serves.
    #[error(
        "the file is {width_deg}° of longitude wide, more than the {widest_deg}° that one UTM zone serves: cut out what is driven on, as by `gdal_translate -projwin {west_deg} {north_deg} {} {south_deg} in.{ending} out.tif`",
        west_deg + widest_deg
    )]
    Wide {
        /// Width [°].
        width_deg: f64,
        /// West edge [°].
        west_deg: f64,
        /// North edge [°].
        north_deg: f64,
        /// South edge [°].
        south_deg: f64,
        /// Widest that is warped [°].
        widest_deg: f64,
        /// Ending of the file's name.
        ending: &'static str,
    },
    /// Cells too large or too small for a map.
    #[error(
        "cells of {cell_deg}° are {value_m} m here, but a map's cells must be {min_m} to {max_m} m: give a model of that resolution"
    )]
    CellSize {
        /// Northern edge of a cell of the file [°].
        cell_deg: f64,
        /// Its shorter edge [m].
        value_m: f64,
        /// Smallest accepted [m].
        min_m: f64,
        /// Largest accepted [m].
        max_m: f64,
    },
    /// A place that the projection does not reach.
    #[error("{0}")]
    Projection(EarthError),
}
