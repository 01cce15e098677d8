//! Maps in bytes that others sent.

#![allow(clippy::unwrap_used)]

use terrain::{
    Grid, Surfaces, Terrain,
    io::cells::{claimed, read_sent, write},
};

/// Where the byte of layers stands.
const LAYERS_AT: usize = 52;

fn sent(terrain: &Terrain) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(terrain, &mut bytes).unwrap();
    bytes
}

fn yard() -> Terrain {
    let grid = Grid { rows: 2, columns: 3, cell_size_m: 0.5, origin_m: [10.0, -4.0] };
    let names = [Some("grass"), None, Some("mud"), None, Some("grass"), Some("mud")];
    let terrain = Terrain::new(grid, &[380.25, 380.1, f64::NAN, 381.0, 380.9, 380.7]).unwrap();
    let surfaces = Surfaces::from_names(names.into_iter()).unwrap();
    let mut terrain = terrain.with_surfaces(surfaces).with_obstacles(vec![true; 6]);
    terrain.crs = Some("EPSG:26915".into());
    terrain
}

#[test]
fn a_map_that_was_written_is_the_same_when_it_is_sent() {
    assert_eq!(read_sent(&sent(&yard())).unwrap().content_id(), yard().content_id());
    assert_eq!(claimed(&sent(&yard())).unwrap(), 6);
}

#[test]
fn what_a_json_grid_may_not_hold_is_refused_here_too() {
    let (good, first_z) = (sent(&yard()), LAYERS_AT + 1);
    let with = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        read_sent(&bytes).unwrap_err().to_string()
    };
    assert!(with(first_z, &1e6f32.to_le_bytes()).contains("elevation_m[0][0]"));
    assert!(with(first_z, &f32::INFINITY.to_le_bytes()).contains("elevation_m[0][0]"));
    assert!(with(20, &(-1.0f64).to_le_bytes()).contains("cell_size_m"));
    assert!(with(LAYERS_AT - 8, &f64::NAN.to_le_bytes()).contains("elevation_m"));
    assert!(with(LAYERS_AT, &[0x47]).contains("byte 52"));
    assert!(with(0, b"P").contains("JPT1"));
    let crs = good.len() - 10;
    assert!(with(crs, b"EPSG:04326").contains("crs"));
    let longer = [&good[..], b"!"].concat();
    assert!(read_sent(&longer).unwrap_err().to_string().contains("byte"));
    for end in 0..good.len() {
        assert!(read_sent(&good[..end]).is_err(), "{end} bytes");
    }
}
