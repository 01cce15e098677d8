//! A path as a table, as a GPS track, and as a track for globes.

use std::io::{self, Write};

use quick_xml::escape::escape;

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

/// Media type of KML.
pub(crate) const KML: &str = "application/vnd.google-earth.kml+xml";

/// Writes a path as KML 2.2 (OGC 07-147r2): a line on the ground in longitude and latitude, a point where start and goal are one place,
/// with the totals as data. Heights are the map's own.
///
/// # Errors
/// A pose without longitude and latitude, or an output that cannot be written to.
pub(crate) fn kml(plan: &PlanAnswer, out: &mut dyn Write) -> io::Result<()> {
    let [low_j, high_j] = plan.energy_interval_j;
    let mut data = vec![
        ("energy_j", plan.energy_j.to_string()),
        ("energy_interval_j", format!("{low_j} {high_j}")),
        ("duration_s", plan.duration_s.to_string()),
        ("distance_m", plan.distance_m.to_string()),
    ];
    data.extend(plan.warnings.iter().map(|warning| ("warning", warning.detail.clone())));
    write!(out, "{KML_HEAD}")?;
    for (name, value) in data {
        write!(out, "<Data name=\"{name}\"><value>{}</value></Data>", escape(value.as_str()))?;
    }
    let (opening, closing) = match plan.poses.as_slice() {
        [_] => ("<Point>", "</Point>"),
        _ => ("<LineString><tessellate>1</tessellate>", "</LineString>"),
    };
    write!(out, "</ExtendedData>{opening}<altitudeMode>clampToGround</altitudeMode><coordinates>")?;
    for pose in &plan.poses {
        let (Some(lon_deg), Some(lat_deg)) = (pose.lon_deg, pose.lat_deg) else {
            return Err(io::Error::other("a pose lies beyond the area that the map's crs is for"));
        };
        writeln!(out, "{lon_deg:.9},{lat_deg:.9},{:.3}", pose.z_m)?;
    }
    writeln!(out, "</coordinates>{closing}</Placemark></Document></kml>")
}

/// What a document begins with.
const KML_HEAD: &str = concat!(
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
    "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><name>joulepath</name>",
    "<Style id=\"path\"><LineStyle><color>ff1f6feb</color><width>4</width></LineStyle></Style>",
    "<Placemark><name>path</name><styleUrl>#path</styleUrl><ExtendedData>"
);

/// What a track begins with.
const HEAD: &str = concat!(
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
    "<gpx version=\"1.1\" creator=\"joulepath\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n",
    "<trk>"
);
