//! A path as a table and as a GPS track.

use std::io::{self, Write};

use crate::routes::plan::PlanAnswer;

/// Writes the poses of a path as CSV, one a line, with a heading of names that end in their units. An empty radius is a straight.
pub(crate) fn csv(plan: &PlanAnswer, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(b"x_m,y_m,z_m,heading_rad,t_s,distance_m,energy_j,power_w,pitch_rad,roll_rad,radius_m\n")?;
    for p in &plan.poses {
        let radius = p.radius_m.map_or(String::new(), |radius_m| radius_m.to_string());
        writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{radius}",
            p.x_m,
            p.y_m,
            p.z_m,
            p.heading_rad,
            p.t_s,
            p.distance_m,
            p.energy_j,
            p.power_w,
            p.pitch_rad,
            p.roll_rad
        )?;
    }
    Ok(())
}

/// Metres of a degree along the equator of WGS 84, whose radius is 6 378 137 m.
const M_PER_DEGREE: f64 = 111_319.490_793_273_57;

/// Writes a path as a GPX 1.1 track. Of a map that does not say where on earth it lies the start is put at 0° N 0° E, where a degree
/// of both is as many metres, and x and y count from there.
pub(crate) fn gpx(plan: &PlanAnswer, out: &mut dyn Write) -> io::Result<()> {
    let is_placed = plan.poses.first().is_some_and(|pose| pose.lon_deg.is_some());
    let about =
        if is_placed { "" } else { "<desc>Metres east and north of the start, as degrees at 0 N 0 E</desc>" };
    writeln!(out, "{HEAD}{about}<trkseg>")?;
    if let Some(start) = plan.poses.first() {
        for p in &plan.poses {
            let (east, north) = match (p.lon_deg, p.lat_deg) {
                (Some(lon_deg), Some(lat_deg)) => (lon_deg, lat_deg),
                _ => ((p.x_m - start.x_m) / M_PER_DEGREE, (p.y_m - start.y_m) / M_PER_DEGREE),
            };
            writeln!(out, "<trkpt lat=\"{north:.9}\" lon=\"{east:.9}\"><ele>{:.3}</ele></trkpt>", p.z_m)?;
        }
    }
    out.write_all(b"</trkseg></trk></gpx>\n")
}

/// What a track begins with.
const HEAD: &str = concat!(
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
    "<gpx version=\"1.1\" creator=\"joulepath\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n",
    "<trk>"
);
