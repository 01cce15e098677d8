//! From the body of a request to a map.

use axum::extract::Request;
use serde::Deserialize;
use terrain::{MapFile, Terrain, io};
use utoipa::ToSchema;

use crate::{
    body::{Content, content_type, from_json},
    form,
    problem::{Problem, ProblemType},
    routes::maps::terrain_from,
};

/// Bytes of a cell while an ESRI ASCII grid is read: as it comes, from the south, and as it is kept.
const ASCII_CELL_BYTES: u64 = 8 + 8 + 4;
/// The same of a GeoTIFF: samples in double precision, what its mask shows, their interpolation onto other cells, and cells as
/// they are kept.
const TIFF_CELL_BYTES: u64 = 8 + 1 + 8 + 4;
/// The same of cells in bytes: an elevation as it comes, as it is read, in double precision and as it is kept, and three layers.
const BYTES_CELL_BYTES: u64 = 4 + 4 + 8 + 4 + 3;
/// The same of a numpy array: a number in double precision and as it is kept.
const NPY_CELL_BYTES: u64 = 8 + 4;
/// The same of a ROS map: a pixel of four colours in 16 bits, as it is decoded and as one colour, and what it stands for.
const PIXEL_BYTES: u64 = ASCII_CELL_BYTES + 8 + 8 + 2;
/// Bytes of a cell while holes are filled: two sums, two marks and its place in a hole.
const FILLING_CELL_BYTES: u64 = 4 + 4 + 1 + 1 + 8;
/// The two files of a ROS `map_server` map.
#[derive(Debug, Deserialize, ToSchema)]
#[allow(dead_code)]
pub(crate) struct RosMapForm {
    /// The YAML file, whose `image` need not be the name of the image that is sent.
    #[schema(value_type = String, format = Binary)]
    yaml: Vec<u8>,
    /// The image: PGM, PNG or BMP, whatever its name.
    #[schema(value_type = String, format = Binary)]
    image: Vec<u8>,
}

/// The reader for a content type.
pub(crate) enum MapReader {
    Json,
    Ascii,
    GeoTiff,
    /// Cells in bytes.
    Cells,
    /// Array of numpy, which every body is that begins as one.
    Npy,
    /// A form with this boundary between its parts.
    RosMap(String),
    /// A content type that no map has: the body may still begin as an array.
    Unknown(String),
}

/// A map as a body holds it.
pub(crate) struct Read {
    pub(crate) terrain: Terrain,
    /// What the body calls it.
    pub(crate) name: Option<String>,
}

impl MapReader {
    /// The reader for a request.
    pub(crate) fn of(request: &Request) -> Result<Self, Problem> {
        let kind = content_type(request);
        Ok(match kind.as_str() {
            "application/json" => MapReader::Json,
            "text/plain" | "text/x-esri-ascii" | "application/x-esri-ascii" => MapReader::Ascii,
            "image/tiff" | "image/geotiff" | "application/geotiff" => MapReader::GeoTiff,
            "application/octet-stream" => MapReader::Cells,
            "application/x-npy" => MapReader::Npy,
            "multipart/form-data" => MapReader::RosMap(form::boundary_of(request)?),
            _ => MapReader::Unknown(kind),
        })
    }

    /// The reader for a body, which is an array whatever its content type if it begins as one, and a GeoTIFF where the content type says no
    /// more than that these are bytes.
    ///
    /// # Errors
    /// Another body of a content type that no map has.
    pub(crate) fn for_body(self, body: &[u8]) -> Result<Self, Problem> {
        match self {
            _ if io::npy::is_npy(body) => Ok(MapReader::Npy),
            MapReader::Cells if io::geotiff::is_tiff(body) => Ok(MapReader::GeoTiff),
            MapReader::Unknown(kind) => Err(unsupported(&kind)),
            known => Ok(known),
        }
    }

    /// The map that a body holds.
    pub(crate) fn read(&self, mut content: Content, options: &io::Options) -> Result<Read, Problem> {
        let length = content.bytes.len() as u64;
        let filling = options.fill_voids_m.map_or(0, |_| FILLING_CELL_BYTES);
        if !matches!(self, MapReader::Npy) {
            options.georeference.refuse().map_err(|error| invalid(&error))?;
        }
        let read = match self {
            MapReader::Json => {
                let mut file: MapFile = content.parsed(from_json)?;
                let name = file.name.take();
                return Ok(Read { terrain: terrain_from(file, options, "")?, name });
            }
            MapReader::Ascii => {
                let words = content.bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
                content.reserved.grow_to(length + (ASCII_CELL_BYTES + filling) * words.count() as u64)?;
                let read = io::read_bytes(io::Format::Ascii, &content.bytes, options);
                let image = read.is_err().then(|| io::ros_map::image_named_in(&content.bytes)).flatten();
                if let Some(image) = image {
                    return Err(ros_yaml_alone(&image));
                }
                read
            }
            MapReader::GeoTiff => {
                let cells = io::geotiff::cells(&content.bytes).map_err(|error| invalid(&error))?;
                let cells = cells.min(options.most_cells);
                content.reserved.grow_to(length + (TIFF_CELL_BYTES + filling) * cells)?;
                io::read_bytes(io::Format::GeoTiff, &content.bytes, options)
            }
            MapReader::Cells => {
                let cells = io::cells::claimed(&content.bytes).map_err(|error| invalid(&error))?;
                let cells = cells.min(options.most_cells).min(length / 4);
                content.reserved.grow_to(length + (BYTES_CELL_BYTES + filling) * cells)?;
                io::read_bytes(io::Format::Cells, &content.bytes, options)
            }
            MapReader::Npy => {
                let cells = io::npy::claimed(&content.bytes).map_err(|error| invalid(&error))?;
                let cells = cells.min(options.most_cells).min(length);
                content.reserved.grow_to(length + (NPY_CELL_BYTES + filling) * cells)?;
                io::read_bytes(io::Format::Npy, &content.bytes, options)
            }
            MapReader::Unknown(kind) => return Err(unsupported(kind)),
            MapReader::RosMap(boundary) => {
                let Content { bytes, mut reserved } = content;
                let example = "-F yaml=@map.yaml -F image=@map.pgm";
                let [yaml, image] = form::two_files(bytes.into(), boundary, ["yaml", "image"], example)?;
                let pixels = io::ros_map::pixels_of(&image).min(options.most_cells);
                reserved.grow_to(length + (PIXEL_BYTES + filling) * pixels)?;
                io::read_ros_map(&yaml, options, |_| Ok(image.to_vec()))
            }
        };
        read.map(|terrain| Read { terrain, name: None }).map_err(|error| invalid(&error))
    }
}

/// The refusal of a content type that no map has.
fn unsupported(kind: &str) -> Problem {
    let detail = format!(
        "a map is application/json, text/plain (ESRI ASCII grid), image/tiff (GeoTIFF), application/x-npy (numpy array), application/octet-stream (cells in bytes, JPT1) or multipart/form-data (ROS map: yaml and image), but the request has `{kind}`; a tile of SRTM (.hgt) is placed by its file's name, which a request does not have: send `gdal_translate N46W094.hgt N46W094.tif`"
    );
    Problem::new(ProblemType::UnsupportedMediaType, detail)
}

/// The YAML of a ROS map that came without its image.
fn ros_yaml_alone(image: &str) -> Problem {
    let shown: String = image.chars().take(80).collect();
    let detail = format!(
        "this is the YAML file of a ROS map: send it together with its image, `{shown}`, as multipart/form-data with the parts yaml and image (curl -F yaml=@map.yaml -F image=@{shown})"
    );
    Problem::new(ProblemType::UnsupportedMediaType, detail)
}

fn invalid(error: &terrain::Error) -> Problem {
    Problem::invalid_map(error, "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_begin_as_a_tiff_are_one_where_nothing_else_is_said_of_them() {
        let reader = |reader: MapReader, body: &[u8]| reader.for_body(body).ok();
        assert!(matches!(reader(MapReader::Cells, b"II*\0rest"), Some(MapReader::GeoTiff)));
        assert!(matches!(reader(MapReader::Cells, b"JPT1rest"), Some(MapReader::Cells)));
        assert!(matches!(reader(MapReader::Ascii, b"II*\0rest"), Some(MapReader::Ascii)));
    }
}
