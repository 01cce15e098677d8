#![no_main]
//! Any text is read as a robot, as a map of columns and topics and as a map of terrain, or refused.

use libfuzzer_sys::fuzz_target;
use model::Robot;
use recording::Map;
use terrain::io;

/// Most cells of an image.
const MOST_CELLS: u64 = 1 << 16;

fuzz_target!(|text: &str| {
    let _ = Robot::from_json(text);
    let _ = Map::from_json(text);
    let _ = io::json::read(text);
    let bytes = text.as_bytes();
    let options = io::Options {
        nodata_m: Some(0.0),
        fill_voids_m: Some(10.0),
        most_cells: MOST_CELLS,
        ..io::Options::default()
    };
    for format in [io::Format::Ascii, io::Format::Json] {
        let _ = io::read_bytes(format, bytes, &options);
    }
    let _ = io::read_ros_map(bytes, &options, |_| Ok(bytes.to_vec()));
});
