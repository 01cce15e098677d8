//! The ground within reach, as files that other programs open.

use std::io::{self, Write};

use routing::Reach;

use crate::{
    routes::reachable::{ContourFeature, ReachableAnswer},
    tracks::TrackForm,
};

/// Writes contours in a format. CSV has the cells within the last of them, with the least energy of each.
///
/// # Errors
/// An output that cannot be written to, or GPX and KML of contours that are not in longitude and latitude.
pub(crate) fn write(
    form: TrackForm,
    contours: &ReachableAnswer,
    reach: &Reach,
    out: &mut dyn Write,
) -> io::Result<()> {
    let is_placed = contours.crs.is_none();
    match form {
        TrackForm::GeoJson => {
            serde_json::to_writer(&mut *out, contours)?;
            writeln!(out)
        }
        TrackForm::Csv => csv(contours, reach, out),
        TrackForm::Gpx | TrackForm::Kml if !is_placed => Err(io::Error::other(
            "GPX and KML are longitude and latitude, and the map does not say where on earth it lies: write .geojson or .csv",
        )),
        TrackForm::Gpx => gpx(contours, out),
        TrackForm::Kml => kml(contours, out),
    }
}

fn csv(contours: &ReachableAnswer, reach: &Reach, out: &mut dyn Write) -> io::Result<()> {
    let most_j = contours.features.iter().map(|feature| feature.properties.energy_j).fold(0.0, f64::max);
    out.write_all(b"x_m,y_m,energy_j\n")?;
    for (index, energy_j) in reach.energy_j.iter().enumerate().filter(|(_, energy_j)| **energy_j <= most_j) {
        let [x_m, y_m] = reach.grid.center_m(reach.grid.cell(index));
        writeln!(out, "{x_m},{y_m},{energy_j}")?;
    }
    Ok(())
}

fn name(contour: &ContourFeature) -> String {
    format!("within {:.2} kJ", contour.properties.energy_j / 1e3)
}

fn gpx(contours: &ReachableAnswer, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(
        b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"joulepath\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n",
    )?;
    for contour in &contours.features {
        writeln!(out, "<trk><name>{}</name>", name(contour))?;
        for ring in contour.geometry.coordinates.iter().flatten() {
            out.write_all(b"<trkseg>")?;
            for [lon_deg, lat_deg] in ring {
                write!(out, "<trkpt lat=\"{lat_deg:.9}\" lon=\"{lon_deg:.9}\"/>")?;
            }
            out.write_all(b"</trkseg>\n")?;
        }
        out.write_all(b"</trk>")?;
    }
    out.write_all(b"</gpx>\n")
}

/// KML 2.2: for each contour its polygons, an outer ring with the holes in it.
fn kml(contours: &ReachableAnswer, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(
        b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><name>joulepath</name>",
    )?;
    out.write_all(
        b"<Style id=\"reach\"><LineStyle><color>ffb06200</color><width>3</width></LineStyle><PolyStyle><color>40b06200</color></PolyStyle></Style>\n",
    )?;
    for contour in &contours.features {
        write!(
            out,
            "<Placemark><name>{}</name><styleUrl>#reach</styleUrl><ExtendedData><Data name=\"area_m2\"><value>{}</value></Data></ExtendedData><MultiGeometry>",
            name(contour),
            contour.properties.area_m2
        )?;
        for polygon in &contour.geometry.coordinates {
            out.write_all(b"<Polygon><tessellate>1</tessellate>")?;
            for (i, ring) in polygon.iter().enumerate() {
                let side = if i == 0 { "outerBoundaryIs" } else { "innerBoundaryIs" };
                write!(out, "<{side}><LinearRing><coordinates>")?;
                for [lon_deg, lat_deg] in ring {
                    write!(out, "{lon_deg:.9},{lat_deg:.9} ")?;
                }
                write!(out, "</coordinates></LinearRing></{side}>")?;
            }
            out.write_all(b"</Polygon>")?;
        }
        writeln!(out, "</MultiGeometry></Placemark>")?;
    }
    out.write_all(b"</Document></kml>\n")
}
