//! Doubts whether a map holds elevations: said of what is none, and never of ground.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use terrain::{Grid, SlopeMap, Terrain, WarningKind, hillshade, io, synthetic};

fn grid(rows: usize, columns: usize, cell_size_m: f64) -> Grid {
    Grid { rows, columns, cell_size_m, origin_m: [500_000.0, 5_000_000.0] }
}

fn minnesota() -> Terrain {
    io::read_path(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/minnesota.tif")).unwrap()
}

/// Elevations of the shipped map, of which every so many cells are taken, each so long [m].
fn thinned(every: usize) -> (Grid, Vec<f64>) {
    let map = minnesota();
    let side = map.grid.rows / every;
    let grid = grid(side, side, every as f64);
    let z = |index| {
        let cell = grid.cell(index);
        let of_map = terrain::Cell { row: cell.row * every, column: cell.column * every };
        map.elevation_m(of_map).unwrap()
    };
    (grid, (0..grid.cells()).map(z).collect())
}

fn doubts(grid: Grid, elevation_m: &[f64]) -> Vec<WarningKind> {
    let terrain = Terrain::new(grid, elevation_m).unwrap().with_doubts();
    terrain.warnings().iter().map(|warning| warning.kind).collect()
}

/// Ground of many kinds, with what it is called.
fn grounds() -> Vec<(String, Grid, Vec<f64>)> {
    let mut grounds = Vec::new();
    for every in [1, 2, 5, 10, 20] {
        let (grid, z) = thinned(every);
        let lowest_m = z.iter().copied().fold(f64::INFINITY, f64::min);
        let whole = z.iter().map(|z| z.round()).collect();
        let from_nought = z.iter().map(|z| (z - lowest_m).round()).collect();
        let lake = z.iter().map(|z| (z - lowest_m - 8.0).max(0.0)).collect();
        grounds.push((format!("whole metres at {every} m"), grid, whole));
        grounds.push((format!("whole metres from nought at {every} m"), grid, from_nought));
        grounds.push((format!("a lake at nought at {every} m"), grid, lake));
        grounds.push((format!("lidar at {every} m"), grid, z));
    }
    for seed in 0..20 {
        for (cell_size_m, longest_m, height_m) in [(0.1, 5.0, 1.0), (1.0, 60.0, 12.0), (10.0, 900.0, 300.0)] {
            let grid = grid(80, 90, cell_size_m);
            let z = synthetic::relief(grid, seed, longest_m, height_m);
            let walled: Vec<f64> =
                z.iter().enumerate().map(|(i, z)| if i % 90 == 40 { z + 2.5 } else { *z }).collect();
            grounds.push((format!("relief {seed} at {cell_size_m} m"), grid, z));
            grounds.push((format!("relief with a wall {seed} at {cell_size_m} m"), grid, walled));
        }
    }
    let floor = |height: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
        (0..60 * 60).map(|i| height(i / 60, i % 60)).collect()
    };
    let in_block = |row: usize, column: usize| (20..30).contains(&row) && (20..40).contains(&column);
    for height_m in [0.2, 2.0, 10.0, 45.0] {
        let block = floor(&|row, column| if in_block(row, column) { height_m } else { 0.0 });
        let pit = floor(&|row, column| if in_block(row, column) { -height_m } else { 0.0 });
        grounds.push((format!("a block of {height_m} m on a level floor"), grid(60, 60, 1.0), block));
        grounds.push((format!("a pit of {height_m} m"), grid(60, 60, 1.0), pit));
    }
    grounds.push(("level ground".into(), grid(60, 60, 0.1), vec![0.0; 3600]));
    grounds.push((
        "a plane".into(),
        grid(60, 60, 1.0),
        floor(&|row, column| 0.6 * row as f64 - 0.2 * column as f64),
    ));
    grounds
}

#[test]
fn no_ground_is_doubted() {
    for (name, grid, z) in grounds() {
        let mut said = doubts(grid, &z);
        // That heights are rounded is no doubt whether they are heights.
        said.retain(|kind| *kind != WarningKind::CoarseHeights || !name.starts_with("whole metres"));
        assert_eq!(said, [], "{name}");
    }
    let yard = io::read_path(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/yard.json")).unwrap();
    assert_eq!(yard.warnings(), []);
    assert_eq!(minnesota().warnings(), []);
}

#[test]
fn collars_and_holes_of_a_fill_value_are_said() {
    for every in [1, 5, 20] {
        let (grid, z) = thinned(every);
        for fill in [0.0, -999.0, 999.0, -99.0, 9999.0, -100.0] {
            let collar: Vec<f64> = (0..z.len())
                .map(|i| (grid.cell(i), z[i]))
                .map(|(cell, z)| if cell.row < 3 || cell.column >= grid.columns - 2 { fill } else { z })
                .collect();
            let terrain = Terrain::new(grid, &collar).unwrap().with_doubts();
            let said: Vec<&str> = terrain
                .warnings()
                .iter()
                .filter(|warning| warning.kind == WarningKind::FillValue)
                .map(|warning| warning.detail.as_str())
                .collect();
            let cells = collar.iter().filter(|z| **z == fill).count();
            assert!(
                said.len() == 1 && said[0].starts_with(&format!("{cells} cells hold exactly {fill} ")),
                "{fill} at {every} m: {said:?}"
            );
            let mended = terrain.with_nodata(fill).unwrap().with_doubts();
            assert!(
                mended.warnings().iter().all(|w| w.kind == WarningKind::GivenNodata),
                "{:?}",
                mended.warnings()
            );
        }
    }
    let level: Vec<f64> = (0..1600)
        .map(|i| if (8..32).contains(&(i / 40)) && (8..32).contains(&(i % 40)) { 300.0 } else { 0.0 })
        .collect();
    assert_eq!(doubts(grid(40, 40, 1.0), &level), [WarningKind::FillValue]);
}

#[test]
fn pictures_of_ground_are_no_elevation() {
    for every in [1, 5] {
        let (grid, z) = thinned(every);
        let ground = Terrain::new(grid, &z).unwrap();
        let shade = hillshade::hillshade(&ground, &SlopeMap::new(&ground), 1.0);
        let shade: Vec<f64> = shade.iter().map(|s| f64::from(*s)).collect();
        let (least, most) = shade.iter().fold((f64::MAX, f64::MIN), |(l, h), s| (l.min(*s), h.max(*s)));
        let stretched: Vec<f64> =
            shade.iter().map(|s| (255.0 * (s - least) / (most - least)).round()).collect();
        assert_eq!(doubts(grid, &stretched), [WarningKind::Image], "stretched, at {every} m");
        let aspect: Vec<f64> = (0..z.len()).map(|index| aspect_deg(&grid, &z, index)).collect();
        assert_eq!(doubts(grid, &aspect), [WarningKind::Aspect], "at {every} m");
    }
}

/// A GeoTIFF of bytes, rows from the south.
fn byte_tiff(grid: &Grid, bytes: &[u8]) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).unwrap();
    let mut image =
        encoder.new_image::<tiff::encoder::colortype::Gray8>(grid.columns as u32, grid.rows as u32).unwrap();
    let tags = image.encoder();
    let size = grid.cell_size_m;
    tags.write_tag(tiff::tags::Tag::ModelPixelScaleTag, &[size, size, 0.0][..]).unwrap();
    let corner = [0.0, 0.0, 0.0, grid.origin_m[0], grid.far_corner_m()[1], 0.0];
    tags.write_tag(tiff::tags::Tag::ModelTiepointTag, &corner[..]).unwrap();
    tags.write_tag(tiff::tags::Tag::GeoKeyDirectoryTag, &[1u16, 1, 0, 1, 1024, 0, 1, 1][..]).unwrap();
    let from_north: Vec<u8> = bytes.chunks(grid.columns).rev().flatten().copied().collect();
    image.write_data(&from_north).unwrap();
    file.into_inner()
}

#[test]
fn hillshades_in_bytes_are_said_at_any_scale() {
    for every in [1, 5, 10, 20] {
        let (grid, z) = thinned(every);
        let ground = Terrain::new(grid, &z).unwrap();
        let shade = byte_tiff(&grid, &hillshade::hillshade(&ground, &SlopeMap::new(&ground), 1.0));
        let shade = io::read_bytes(io::Format::GeoTiff, &shade, &io::Options::default()).unwrap();
        let kinds: Vec<WarningKind> = shade.warnings().iter().map(|warning| warning.kind).collect();
        assert!(kinds.contains(&WarningKind::Image), "a hillshade at {every} m: {kinds:?}");
    }
}

/// Direction of the steepest descent, clockwise from north [deg].
fn aspect_deg(grid: &Grid, z: &[f64], index: usize) -> f64 {
    let cell = grid.cell(index);
    let at =
        |row: usize, column: usize| z[row.min(grid.rows - 1) * grid.columns + column.min(grid.columns - 1)];
    let east = at(cell.row, cell.column + 1) - at(cell.row, cell.column.saturating_sub(1));
    let north = at(cell.row + 1, cell.column) - at(cell.row.saturating_sub(1), cell.column);
    (-east).atan2(-north).to_degrees().rem_euclid(360.0)
}

#[test]
fn heights_in_another_unit_than_cells_and_heights_of_another_planet_are_said() {
    let (grid, z) = thinned(1);
    let centimetres: Vec<f64> = z.iter().map(|z| (z - 370.0) * 100.0).collect();
    assert_eq!(doubts(grid, &centimetres), [WarningKind::ImpossibleSlopes]);
    let mars: Vec<f64> = z.iter().map(|z| z - 4900.0).collect();
    assert_eq!(doubts(grid, &mars), [WarningKind::UnusualElevation]);
    let sea_floor: Vec<f64> = z.iter().map(|z| z - 400.0 - 440.0).collect();
    assert_eq!(doubts(grid, &sea_floor), []);
}

#[test]
fn doubts_of_before_go_when_the_cells_are_mended() {
    let (grid, z) = thinned(20);
    let high: Vec<f64> = z.iter().map(|z| z + 10_000.0).collect();
    let doubted = Terrain::new(grid, &high).unwrap().with_doubts();
    assert_eq!(doubted.warnings().len(), 1);
    assert_eq!(doubted.clone().with_doubts().warnings(), doubted.warnings());
}

/// Gentle ground of 3 % with waves, on cells of so many metres, in multiples of a step [m].
fn rounded(cell_m: f64, step_m: f64, slope: f64) -> (Grid, Vec<f64>) {
    let grid = grid(40, 400, cell_m);
    let z = |index| {
        let x_m = grid.center_m(grid.cell(index))[0] - 500_000.0;
        ((300.0 + slope * x_m + 50.0 * slope * (x_m / 25.0).sin()) / step_m).round() * step_m
    };
    (grid, (0..grid.cells()).map(z).collect())
}

#[test]
fn heights_whose_steps_are_most_of_the_slopes_are_said() {
    for (cell_m, step_m, slope, is_coarse) in [
        (1.0, 1.0, 0.03, true),
        (2.0, 1.0, 0.03, true),
        (10.0, 1.0, 0.02, true),
        (0.5, 0.1, 0.03, true),
        (3.0, 0.3048, 0.02, true),
        // Steep beside the steps, steps that are too low to brake on, and centimetres.
        (10.0, 1.0, 0.3, false),
        (30.0, 1.0, 0.003, false),
        (1.0, 0.01, 0.03, false),
    ] {
        let (grid, z) = rounded(cell_m, step_m, slope);
        let said = doubts(grid, &z);
        assert_eq!(
            said.contains(&WarningKind::CoarseHeights),
            is_coarse,
            "{cell_m} {step_m} {slope}: {said:?}"
        );
    }
    let level = grid(40, 40, 0.25);
    let kerb = |index: usize| if index % 40 < 20 { 0.0 } else { 0.1 };
    assert_eq!(doubts(level, &(0..1600).map(kerb).collect::<Vec<_>>()), []);
}
