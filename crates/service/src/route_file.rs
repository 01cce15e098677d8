//! Paths as a table, as GPS tracks, and as tracks for globes.

use std::io::{self, Write};

use quick_xml::escape::escape;
use serde_json::Value;

use crate::{
    routes::plan::PoseAnswer,
    tracks::{Track, Tracks},
};

/// Writes the poses of paths as CSV, one a line, with a heading of names that end in their units. An empty radius is a straight. Of
/// several paths the first column has the name.
pub(crate) fn csv(found: &Tracks<'_>, out: &mut dyn Write) -> io::Result<()> {
    let has_names = found.tracks.iter().any(|track| track.name.is_some());
    out.write_all(if has_names { b"path," } else { b"" })?;
    out.write_all(b"x_m,y_m,z_m,heading_rad,t_s,distance_m,energy_j,power_w,pitch_rad,roll_rad,radius_m\n")?;
    for track in &found.tracks {
        let name = track.name.as_ref().map_or(String::new(), |name| format!("{name},"));
        for p in track.poses {
            let radius = p.radius_m.map_or(String::new(), |radius_m| radius_m.to_string());
            writeln!(
                out,
                "{name}{},{},{},{},{},{},{},{},{},{},{radius}",
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
    }
    Ok(())
}

/// Metres of a degree along the equator of WGS 84, whose radius is 6 378 137 m.
const M_PER_DEGREE: f64 = 111_319.490_793_273_57;

/// Writes paths as GPX 1.1 tracks, and stops as its waypoints. Of a map without a `crs` the first start is put at 0° N 0° E, where a degree of
/// both is as many metres, and x and y count from there.
///
/// # Errors
/// A pose without longitude and latitude on a map with a `crs`, or an output that cannot be written to.
pub(crate) fn gpx(found: &Tracks<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Some(start) = found.tracks.iter().find_map(|track| track.poses.first()) else {
        return writeln!(out, "{GPX_HEAD}<trk><trkseg>\n</trkseg></trk></gpx>");
    };
    let is_placed = found.crs.is_some();
    let degrees = |lon_deg: Option<f64>, lat_deg: Option<f64>, x_m: f64, y_m: f64| match is_placed {
        true => placed(lon_deg, lat_deg),
        false => Ok(((x_m - start.x_m) / M_PER_DEGREE, (y_m - start.y_m) / M_PER_DEGREE)),
    };
    write!(out, "{GPX_HEAD}")?;
    for stop in found.stops {
        let (east, north) = degrees(stop.lon_deg, stop.lat_deg, stop.x_m, stop.y_m)?;
        let name = stop.name();
        writeln!(out, "<wpt lat=\"{north:.9}\" lon=\"{east:.9}\"><name>{}</name></wpt>", escape(&name))?;
    }
    for track in &found.tracks {
        let name = track.name.as_ref().map_or(String::new(), |name| format!("<name>{}</name>", escape(name)));
        let about = match is_placed {
            true => "",
            false => "<desc>Metres east and north of the start, as degrees at 0 N 0 E</desc>",
        };
        writeln!(out, "<trk>{name}{about}<trkseg>")?;
        for p in track.poses {
            let (east, north) = degrees(p.lon_deg, p.lat_deg, p.x_m, p.y_m)?;
            writeln!(out, "<trkpt lat=\"{north:.9}\" lon=\"{east:.9}\"><ele>{:.3}</ele></trkpt>", p.z_m)?;
        }
        write!(out, "</trkseg></trk>")?;
    }
    out.write_all(b"</gpx>\n")
}

/// Writes paths as KML 2.2 (OGC 07-147r2): lines on the ground in longitude and latitude, a point where start and goal are one place,
/// with the totals as data, and stops as points. Heights are the map's own.
///
/// # Errors
/// A pose without longitude and latitude, or an output that cannot be written to.
pub(crate) fn kml(found: &Tracks<'_>, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "{KML_HEAD}")?;
    for (i, color) in KML_COLORS.iter().enumerate().take(found.tracks.len()) {
        write!(
            out,
            "<Style id=\"path{i}\"><LineStyle><color>{color}</color><width>4</width></LineStyle></Style>"
        )?;
    }
    for (i, track) in found.tracks.iter().enumerate() {
        placemark(track, i % KML_COLORS.len(), out)?;
    }
    for stop in found.stops {
        let (lon_deg, lat_deg) = placed(stop.lon_deg, stop.lat_deg)?;
        let name = stop.name();
        write!(
            out,
            "<Placemark><name>{}</name><Point><coordinates>{lon_deg:.9},{lat_deg:.9}</coordinates></Point></Placemark>",
            escape(&name)
        )?;
    }
    writeln!(out, "</Document></kml>")
}

fn placemark(track: &Track<'_>, style: usize, out: &mut dyn Write) -> io::Result<()> {
    let name = track.name.as_deref().unwrap_or("path");
    write!(out, "<Placemark><name>{}</name><styleUrl>#path{style}</styleUrl><ExtendedData>", escape(name))?;
    for (name, value) in &track.totals {
        write!(out, "<Data name=\"{name}\"><value>{}</value></Data>", plain(value))?;
    }
    for warning in track.warnings {
        write!(out, "<Data name=\"warning\"><value>{}</value></Data>", escape(warning.detail.as_str()))?;
    }
    let (opening, closing) = match track.poses {
        [_] => ("<Point>", "</Point>"),
        _ => ("<LineString><tessellate>1</tessellate>", "</LineString>"),
    };
    write!(out, "</ExtendedData>{opening}<altitudeMode>clampToGround</altitudeMode><coordinates>")?;
    for PoseAnswer { lon_deg, lat_deg, z_m, .. } in track.poses {
        let (lon_deg, lat_deg) = placed(*lon_deg, *lat_deg)?;
        writeln!(out, "{lon_deg:.9},{lat_deg:.9},{z_m:.3}")?;
    }
    write!(out, "</coordinates>{closing}</Placemark>")
}

fn placed(lon_deg: Option<f64>, lat_deg: Option<f64>) -> io::Result<(f64, f64)> {
    lon_deg
        .zip(lat_deg)
        .ok_or_else(|| io::Error::other("a pose lies beyond the area that the map's crs is for"))
}

/// A number without an exponent, or several with blanks between.
fn plain(value: &Value) -> String {
    match value {
        Value::Array(values) => values.iter().map(plain).collect::<Vec<_>>().join(" "),
        value => value.as_f64().map_or_else(|| value.to_string(), |number| number.to_string()),
    }
}

/// Colours of lines, as KML has them: opacity, blue, green, red. They stay apart for colour-blind eyes (Okabe & Ito).
const KML_COLORS: [&str; 3] = ["ffb06200", "ff005ed5", "ff5a125a"];

/// What a document begins with.
const KML_HEAD: &str = concat!(
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
    "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><name>joulepath</name>",
);

/// What tracks begin with.
const GPX_HEAD: &str = concat!(
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
    "<gpx version=\"1.1\" creator=\"joulepath\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n",
);
