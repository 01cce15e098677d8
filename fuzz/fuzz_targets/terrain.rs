#![no_main]
//! Any bytes are read as a GeoTIFF, as cells in bytes and as an array of numpy, or refused.

use libfuzzer_sys::fuzz_target;
use terrain::io;

/// Small, so that a claim of many cells is refused before it is believed.
const MOST_CELLS: u64 = 1 << 16;

fuzz_target!(|bytes: &[u8]| {
    let _ = io::geotiff::read(bytes, MOST_CELLS);
    if io::cells::claimed(bytes).is_ok_and(|cells| cells <= MOST_CELLS) {
        let _ = io::cells::read_sent(bytes);
    }
    let georeference = io::Georeference { cell_size_m: Some(0.5), ..io::Georeference::default() };
    let _ = io::npy::read(bytes, &io::Options { most_cells: MOST_CELLS, georeference, ..io::Options::default() });
});
