//! A map as bytes, exactly as it is held: what a store keeps and reads back in milliseconds, and what large maps are sent as.
//!
//! Little-endian, southernmost row first:
//!
//! ```text
//! 4 bytes  "JPT1"
//! u64 × 2  rows, columns
//! f64 × 4  cell_size_m, x and y of the south-west corner [m], elevation that the others count from [m]
//! u8       sum of 1: surfaces follow, 2: obstacles follow, 4: a system follows, 8: filled cells follow, 16: warnings follow, 32: areas follow
//! f32 each elevation above it, NaN where unknown [m]
//! u16      how many surfaces, then each name as u32 length and UTF-8, then u8 each cell: its class
//! u8 each  1 where there is an obstacle
//! u8 each  1 where the elevation was filled in
//! u32      length of the warnings, then as many bytes of them as JSON
//! u32      length of the system's name or text, then its UTF-8
//! u32      length of the areas, then as many bytes of them as GeoJSON
//! ```

mod sent;

use std::{
    io::{self, Read, Write},
    sync::Arc,
};

pub use sent::{claimed, read_sent};

use crate::{Surfaces, Terrain, Warning, areas::Areas};

const MAGIC: &[u8; 4] = b"JPT1";
const SURFACES: u8 = 1;
const OBSTACLES: u8 = 2;
const CRS: u8 = 4;
const FILLED: u8 = 8;
const WARNINGS: u8 = 16;
const AREAS: u8 = 32;
/// All of them.
const LAYERS: u8 = SURFACES | OBSTACLES | CRS | FILLED | WARNINGS | AREAS;
/// Where the byte of layers stands.
const LAYERS_AT: usize = 4 + 2 * 8 + 4 * 8;
/// Cells that are converted at a time.
const CHUNK_CELLS: usize = 16_384;
/// Longest name of a surface or system that is read [bytes].
const LONGEST_NAME: u32 = 1 << 16;
/// Longest warnings that are read [bytes]; escapes of JSON make six bytes of one at most.
const LONGEST_WARNINGS: u32 = (Warning::MOST * (100 + 6 * Warning::LONGEST_DETAIL)) as u32;

/// Writes a map.
///
/// # Errors
/// What the writer says.
pub fn write(terrain: &Terrain, mut to: impl Write) -> io::Result<()> {
    let grid = &terrain.grid;
    to.write_all(MAGIC)?;
    for count in [grid.rows, grid.columns] {
        to.write_all(&(count as u64).to_le_bytes())?;
    }
    for number in [grid.cell_size_m, grid.origin_m[0], grid.origin_m[1], terrain.base_m] {
        to.write_all(&number.to_le_bytes())?;
    }
    let layers = terrain.surfaces.as_ref().map_or(0, |_| SURFACES)
        | terrain.obstacle.as_ref().map_or(0, |_| OBSTACLES)
        | terrain.filled.as_ref().map_or(0, |_| FILLED)
        | if terrain.warnings.is_empty() { 0 } else { WARNINGS }
        | terrain.crs.as_ref().map_or(0, |_| CRS)
        | terrain.areas.as_ref().map_or(0, |_| AREAS);
    to.write_all(&[layers])?;
    for chunk in terrain.relative_m.chunks(CHUNK_CELLS) {
        let bytes: Vec<u8> = chunk.iter().flat_map(|z| z.to_le_bytes()).collect();
        to.write_all(&bytes)?;
    }
    if let Some(surfaces) = &terrain.surfaces {
        to.write_all(&(surfaces.names.len() as u16).to_le_bytes())?;
        for name in &surfaces.names {
            write_text(name, &mut to)?;
        }
        to.write_all(&surfaces.class)?;
    }
    for flags in [&terrain.obstacle, &terrain.filled].into_iter().flatten() {
        for chunk in flags.chunks(CHUNK_CELLS) {
            let bytes: Vec<u8> = chunk.iter().map(|&flag| u8::from(flag)).collect();
            to.write_all(&bytes)?;
        }
    }
    if !terrain.warnings.is_empty() {
        let text = serde_json::to_vec(&*terrain.warnings)?;
        to.write_all(&(text.len() as u32).to_le_bytes())?;
        to.write_all(&text)?;
    }
    if let Some(crs) = &terrain.crs {
        write_text(crs, &mut to)?;
    }
    if let Some(areas) = &terrain.areas {
        write_text(areas.text(), &mut to)?;
    }
    to.flush()
}

fn write_text(text: &str, to: &mut impl Write) -> io::Result<()> {
    to.write_all(&(text.len() as u32).to_le_bytes())?;
    to.write_all(text.as_bytes())
}

/// Reads what [`write`] wrote.
///
/// # Errors
/// What the reader says, and `InvalidData` for bytes that are no such map.
pub fn read(mut from: impl Read) -> io::Result<Terrain> {
    if array(&mut from)? != *MAGIC {
        return Err(invalid("it does not begin as a map"));
    }
    let [rows, columns] = [u64::from_le_bytes(array(&mut from)?), u64::from_le_bytes(array(&mut from)?)];
    let mut number = || Ok::<f64, io::Error>(f64::from_le_bytes(array(&mut from)?));
    let [cell_size_m, x_m, y_m, base_m] = [number()?, number()?, number()?, number()?];
    let grid = Terrain::check_size(rows, columns, cell_size_m, [x_m, y_m]).map_err(invalid)?;
    let [layers] = array(&mut from)?;
    let z = bytes(&mut from, 4 * grid.cells())?;
    let relative_m: Vec<f32> = z.as_chunks().0.iter().map(|z| f32::from_le_bytes(*z)).collect();
    drop(z);
    let mut terrain = Terrain::of_relative(grid, base_m, relative_m);
    let cells = terrain.grid.cells();
    if layers & SURFACES != 0 {
        let count = u16::from_le_bytes(array(&mut from)?);
        let names = (0..count).map(|_| name(&mut from)).collect::<io::Result<Vec<String>>>()?;
        let class = bytes(&mut from, cells)?;
        if class.iter().any(|&class| class != Surfaces::UNNAMED && usize::from(class) >= names.len()) {
            return Err(invalid("a cell is of a surface without a name"));
        }
        terrain = terrain.with_surfaces(Surfaces { names, class });
    }
    if layers & OBSTACLES != 0 {
        terrain = terrain.with_obstacles(flags(&mut from, cells)?);
    }
    if layers & FILLED != 0 {
        terrain = terrain.with_filled(flags(&mut from, cells)?);
    }
    if layers & WARNINGS != 0 {
        let length = u32::from_le_bytes(array(&mut from)?);
        if length > LONGEST_WARNINGS {
            return Err(invalid("its warnings are too long"));
        }
        let text = bytes(&mut from, length as usize)?;
        terrain.warnings = Arc::new(serde_json::from_slice(&text).map_err(invalid)?);
    }
    if layers & CRS != 0 {
        terrain.crs = Some(name(&mut from)?);
    }
    if layers & AREAS != 0 {
        let length = u32::from_le_bytes(array(&mut from)?);
        if length as usize > Areas::LONGEST_TEXT {
            return Err(invalid("its areas are too long"));
        }
        let text = bytes(&mut from, length as usize)?;
        let areas = Areas::of(&serde_json::from_slice(&text).map_err(invalid)?, &terrain).map_err(invalid)?;
        terrain = terrain.with_areas(areas);
    }
    Ok(terrain)
}

fn flags(from: &mut impl Read, cells: usize) -> io::Result<Vec<bool>> {
    Ok(bytes(from, cells)?.into_iter().map(|flag| flag != 0).collect())
}

fn name(from: &mut impl Read) -> io::Result<String> {
    let length = u32::from_le_bytes(array(from)?);
    if length > LONGEST_NAME {
        return Err(invalid("a name is too long"));
    }
    String::from_utf8(bytes(from, length as usize)?).map_err(invalid)
}

fn array<const N: usize>(from: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// So many bytes; room is taken as they come, so that a false count costs nothing.
fn bytes(from: &mut impl Read, count: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(count as u64).read_to_end(&mut bytes)?;
    if bytes.len() == count { Ok(bytes) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
}

fn invalid(why: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, why)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, WarningKind};

    fn layered() -> Terrain {
        let grid = Grid { rows: 3, columns: 4, cell_size_m: 0.1, origin_m: [1e6, -0.3] };
        let z: Vec<f64> =
            (0..12).map(|i| if i == 5 { f64::NAN } else { 1234.567 + 0.1 * f64::from(i) }).collect();
        let names = ["grass", "", "wet clay"];
        let surfaces = Surfaces::from_names((0..12).map(|i| (i % 5 != 0).then(|| names[i % 3]))).unwrap();
        Terrain::new(grid, &z)
            .unwrap()
            .with_surfaces(surfaces)
            .with_obstacles((0..12).map(|i| i == 7).collect())
    }

    fn warned() -> Terrain {
        let filled = (0..12).map(|i| i == 3).collect();
        let warning = Warning::new(WarningKind::FilledVoids, "1 cell \"é\"");
        let terrain =
            Terrain { crs: Some("EPSG:32632".into()), ..layered().with_filled(filled).with_warning(warning) };
        let line = serde_json::json!({"type": "FeatureCollection", "crs": null, "features": [
            {"type": "Feature", "properties": {"keep_out": true},
             "geometry": {"type": "LineString", "coordinates": [[1e6, 0.0], [1e6 + 0.2, -0.1]]}}]});
        let areas = Areas::of(&line, &terrain).unwrap();
        terrain.with_areas(areas)
    }

    fn written(terrain: &Terrain) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(terrain, &mut bytes).unwrap();
        bytes
    }

    #[test]
    fn what_is_read_back_is_the_same_map_to_the_last_bit() {
        let plain =
            Terrain::new(Grid { rows: 1, columns: 2, cell_size_m: 1.0, origin_m: [0.0; 2] }, &[0.1, 0.3]);
        for terrain in [layered(), warned(), plain.unwrap()] {
            let bytes = written(&terrain);
            let again = read(&bytes[..]).unwrap();
            assert_eq!(again.content_id(), terrain.content_id());
            assert_eq!(again.warnings(), terrain.warnings());
            assert_eq!(again.crs, terrain.crs);
            assert_eq!(written(&again), bytes);
        }
    }

    #[test]
    fn bytes_that_break_off_anywhere_are_refused() {
        let bytes = written(&warned());
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end]).is_err(), "{end} bytes");
        }
    }

    #[test]
    fn false_counts_and_classes_are_refused_without_taking_room_for_them() {
        let good = written(&layered());
        let with = |at: usize, byte: u8| {
            let mut bytes = good.clone();
            bytes[at] = byte;
            read(&bytes[..])
        };
        assert!(with(0, b'X').is_err(), "another beginning");
        assert!(with(10, 1).is_err(), "more rows than a map may have");
        assert!(with(6, 3).is_err(), "more rows than there are bytes");
        let first_class = good.len() - 24;
        assert!(with(first_class, 9).is_err(), "a class without a name");
    }
}
