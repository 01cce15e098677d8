#![no_main]
//! Any text is read as a robot, as a map of columns and topics and as a map of terrain, or refused.

use libfuzzer_sys::fuzz_target;
use model::Robot;
use recording::Map;
use terrain::io;

fuzz_target!(|text: &str| {
    let _ = Robot::from_json(text);
    let _ = Map::from_json(text);
    let _ = io::json::read(text);
    let _ = io::ascii::read(text);
});
