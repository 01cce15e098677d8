//! A file on its way to the service.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::Context;
use serde_json::Value;
use terrain::io;

use crate::failure::BadInput;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Map,
    Robot,
    Recording,
}

impl Kind {
    pub(super) fn word(self) -> &'static str {
        match self {
            Kind::Map => "map",
            Kind::Robot => "robot",
            Kind::Recording => "recording",
        }
    }
}

/// A file, what it holds, and its bytes as the service takes them.
#[derive(Debug)]
pub(super) struct Upload {
    pub(super) path: PathBuf,
    pub(super) kind: Kind,
    media_type: String,
    bytes: Vec<u8>,
}

/// Endings of recordings, and their media types.
const RECORDINGS: [(&str, &str); 5] = [
    ("csv", "text/csv"),
    ("parquet", "application/vnd.apache.parquet"),
    ("mcap", "application/mcap"),
    ("db3", "application/vnd.sqlite3"),
    ("bag", "application/x-rosbag"),
];
/// Endings of maps that are sent as a GeoTIFF of their elevations, with the place that files beside them or their names tell.
const ELEVATIONS: [&str; 4] = [".asc", ".asc.gz", ".hgt", ".hgt.gz"];
/// Between the parts of a form.
const BOUNDARY: &str = "joulepath-open-7c5f0a4e";

impl Upload {
    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, or is none that the page shows.
    pub(super) fn of(path: &Path) -> anyhow::Result<Self> {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_ascii_lowercase();
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        let bytes = || fs::read(path).map_err(|error| refused(path, &error));
        let upload = |kind, media_type: &str, bytes| Upload {
            path: path.to_owned(),
            kind,
            media_type: media_type.to_owned(),
            bytes,
        };
        if let Some((_, media_type)) = RECORDINGS.iter().find(|(known, _)| *known == ending) {
            return Ok(upload(Kind::Recording, media_type, bytes()?));
        }
        if ELEVATIONS.iter().any(|known| name.ends_with(known)) {
            return Ok(upload(Kind::Map, "image/tiff", elevations(path)?));
        }
        Ok(match ending {
            "tif" | "tiff" => upload(Kind::Map, "image/tiff", bytes()?),
            "yaml" | "yml" => {
                let form = format!("multipart/form-data; boundary={BOUNDARY}");
                upload(Kind::Map, &form, ros_map(path, &bytes()?)?)
            }
            "json" => {
                let bytes = bytes()?;
                upload(kind_of_json(path, &bytes)?, "application/json", bytes)
            }
            _ => {
                let endings: Vec<String> =
                    RECORDINGS.iter().map(|(ending, _)| format!(".{ending}")).collect();
                let why = format!(
                    "the page opens maps (.json, .tif, .asc, .hgt, .yaml), robots (.json) and recordings ({})",
                    endings.join(", ")
                );
                return Err(refused(path, &why).into());
            }
        })
    }

    /// Has the service keep the file, and returns the id that it gave.
    ///
    /// # Errors
    /// What the service finds wrong with it.
    pub(super) fn send(&self, url: &str) -> anyhow::Result<String> {
        let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
        let stem = self.path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("file");
        let mut request =
            agent.post(format!("{url}/v1/{}s", self.kind.word())).content_type(&self.media_type);
        if self.kind != Kind::Robot {
            request = request.query("name", stem);
        }
        let mut answer = request.send(&self.bytes[..])?;
        let document: Value = answer.body_mut().read_json().context("answer of the service")?;
        match document["id"].as_str() {
            Some(id) => Ok(id.to_owned()),
            None => Err(refused(&self.path, &document["detail"].as_str().unwrap_or("refused")).into()),
        }
    }
}

fn refused(path: &Path, why: &dyn std::fmt::Display) -> BadInput {
    BadInput(format!("{}: {why}", path.display()))
}

/// What a JSON file holds, by fields that only one kind has.
fn kind_of_json(path: &Path, bytes: &[u8]) -> Result<Kind, BadInput> {
    let document: Value = serde_json::from_slice(bytes).map_err(|error| refused(path, &error))?;
    let has = |name| document.get(name).is_some();
    match () {
        () if has("elevation_m") => Ok(Kind::Map),
        () if has("mass_kg") => Ok(Kind::Robot),
        () => Err(refused(path, &"it is neither a map (no `elevation_m`) nor a robot (no `mass_kg`)")),
    }
}

/// The elevations of a map file as a GeoTIFF.
fn elevations(path: &Path) -> anyhow::Result<Vec<u8>> {
    let terrain = io::read_path(path).map_err(|error| refused(path, &error))?;
    let grid = &terrain.grid;
    let elevation_m = |index| terrain.elevation_m(grid.cell(index)).map_or(f32::NAN, |z_m| z_m as f32);
    let cells: Vec<f32> = (0..grid.cells()).map(elevation_m).collect();
    Ok(io::geotiff::write(grid, &cells, terrain.crs.as_deref()).map_err(|error| refused(path, &error))?)
}

/// A ROS map and its image as a form.
fn ros_map(path: &Path, yaml: &[u8]) -> anyhow::Result<Vec<u8>> {
    let text = String::from_utf8_lossy(yaml);
    let image = text.lines().find_map(|line| line.trim().strip_prefix("image:"));
    let image = image.map(|name| name.split('#').next().unwrap_or_default().trim().trim_matches(['"', '\'']));
    let image = image.filter(|name| !name.is_empty()).ok_or_else(|| refused(path, &"it names no `image`"))?;
    let place = path.parent().unwrap_or(Path::new(".")).join(image);
    let pixels = fs::read(&place).map_err(|error| refused(&place, &error))?;
    let mut form = Vec::new();
    for (name, bytes) in [("yaml", yaml), ("image", &pixels[..])] {
        let head = format!(
            "--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"{name}\"; filename=\"{name}\"\r\n\r\n"
        );
        form.extend_from_slice(head.as_bytes());
        form.extend_from_slice(bytes);
        form.extend_from_slice(b"\r\n");
    }
    form.extend_from_slice(format!("--{BOUNDARY}--\r\n").as_bytes());
    Ok(form)
}
