//! The zone of Universal Transverse Mercator (UTM) that a place lies in, and the command that brings a raster there.

/// EPSG code of the WGS 84 / UTM zone of a place; beyond 84° north and 80° south that of Universal Polar Stereographic.
///
/// ```
/// use terrain::crs::utm_epsg;
/// assert_eq!(utm_epsg(9.5, 48.0), 32632);
/// assert_eq!(utm_epsg(-70.0, -33.0), 32719);
/// assert_eq!(utm_epsg(180.0, 10.0), 32660);
/// ```
pub fn utm_epsg(longitude_deg: f64, latitude_deg: f64) -> u32 {
    const ZONE_WIDTH_DEG: f64 = 6.0;
    let wrapped_deg = (longitude_deg + 180.0).rem_euclid(360.0);
    let wrapped_deg = if wrapped_deg == 0.0 && longitude_deg > 0.0 { 359.0 } else { wrapped_deg };
    let zone = (wrapped_deg / ZONE_WIDTH_DEG).floor().clamp(0.0, 59.0) as u32 + 1;
    match latitude_deg {
        north if north > 84.0 => 32_661,
        south if south < -80.0 => 32_761,
        north if north >= 0.0 => 32_600 + zone,
        _ => 32_700 + zone,
    }
}

/// The GDAL command that makes a raster in metres of the ground out of one about a place.
pub fn warp_command(longitude_deg: f64, latitude_deg: f64) -> String {
    format!("gdalwarp -t_srs EPSG:{} -r bilinear in.tif out.tif", utm_epsg(longitude_deg, latitude_deg))
}
