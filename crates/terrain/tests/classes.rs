//! Areas out of rasters of classes change the cells whose centres rasterio finds in that class.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

mod rasterio;

use rasterio::by_rasterio;
use serde_json::{Value, json};
use terrain::{
    Cell, Grid, Terrain,
    areas::{Areas, ClassesError},
    io::geotiff,
};
use tiff::tags::Tag;

fn ground(grid: Grid, crs: Option<&str>) -> Terrain {
    let mut terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    terrain.crs = crs.map(str::to_owned);
    terrain
}

/// Each class at a speed of its own, which marks it; 50 is known and changes nothing.
fn marked(classes: &[i64]) -> Value {
    let entry = |class: &i64| (class.to_string(), json!({"max_speed_mps": *class as f64 / 100.0}));
    let mut table: serde_json::Map<String, Value> = classes.iter().map(entry).collect();
    table.insert("50".into(), Value::Null);
    table.into()
}

#[test]
fn cells_are_of_the_class_that_rasterio_finds_at_their_centres() {
    let folder = tempfile::tempdir().unwrap();
    let Some(written) = by_rasterio("write_classes.py", folder.path()) else { return };
    let map = &written["map"];
    let number = |name: &str| map[name].as_u64().unwrap() as usize;
    let origin_m = [0, 1].map(|axis| map["origin_m"][axis].as_f64().unwrap());
    let grid = Grid { rows: number("rows"), columns: number("columns"), cell_size_m: 2.0, origin_m };
    let terrain = ground(grid, map["crs"].as_str());
    for (name, expected) in written["rasters"].as_object().unwrap() {
        let tiff = std::fs::read(folder.path().join(format!("{name}.tif"))).unwrap();
        let table = marked(&[10, 30, 40, 80, 90]);
        let found = Areas::of_classes(&tiff, &table, &terrain).unwrap();
        assert!(
            found.notes[0].starts_with("classes 100 lie over the map, but not in the table"),
            "{:?}",
            found.notes
        );
        let areas = Areas::of(&found.document, &terrain).unwrap();
        assert_eq!(areas.notes(), [] as [&str; 0], "{name}");
        let driven = terrain.clone().with_areas(areas).as_driven(&|| false).unwrap();
        let zones = driven.zones().unwrap();
        let mut plain = 0;
        for index in 0..grid.cells() {
            let Cell { row, column } = grid.cell(index);
            if expected["is_plain"][row][column] != true {
                continue;
            }
            let class = expected["classes"][row][column].as_u64().unwrap();
            let wanted = if matches!(class, 0 | 50 | 100) { f64::INFINITY } else { class as f64 / 100.0 };
            let held = zones.rules[usize::from(zones.rule[index])].max_speed_mps;
            assert_eq!(held, wanted, "{name}: class {class} in row {row}, column {column}");
            plain += 1;
        }
        assert!(plain * 10 > grid.cells() * 9, "{name}: {plain} cells were held against rasterio");
    }
}

/// A raster of one class over columns and rows of cells, by our own writer, which makes no whole numbers: refused as such.
#[test]
fn rasters_that_are_no_classes_are_refused() {
    let grid = Grid { rows: 4, columns: 4, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let heights = geotiff::write(&grid, &[1.0; 16], None).unwrap();
    let refused = Areas::of_classes(&heights, &marked(&[1]), &ground(grid, None)).unwrap_err();
    assert!(refused.to_string().contains("whole numbers of one band"), "{refused}");
    let refused = Areas::of_classes(b"GIF89a", &marked(&[1]), &ground(grid, None)).unwrap_err();
    assert!(matches!(refused, ClassesError::Raster(_)), "{refused}");
}

#[test]
fn tables_are_refused_by_their_place() {
    let terrain = ground(Grid { rows: 4, columns: 4, cell_size_m: 1.0, origin_m: [0.0, 0.0] }, None);
    for (table, said) in [
        (json!([10]), "classes is no object"),
        (json!({"water": {"keep_out": true}}), "classes.water is no class"),
        (json!({"80": "keep_out"}), "classes.80 is no object of properties, nor null"),
        (json!({"80": {"keep_out": "yes"}}), "classes.80.keep_out is \"yes\""),
        (json!({"80": {"keepout": true}}), "classes.80.keepout means nothing here"),
        (json!({"80": {}}), "classes.80 says nothing"),
        (json!({"80": {"cost_factor": 0}}), "classes.80.cost_factor is 0"),
    ] {
        let refused = Areas::of_classes(&[], &table, &terrain).unwrap_err().to_string();
        assert!(refused.contains(said), "{refused}\n  lacks {said}");
    }
}

#[test]
fn rasters_of_another_place_or_of_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let Some(_) = by_rasterio("write_classes.py", folder.path()) else { return };
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let grid = |origin_m| Grid { rows: 9, columns: 9, cell_size_m: 2.0, origin_m };
    let refused = |name: &str, terrain: &Terrain| {
        Areas::of_classes(&read(name), &marked(&[10, 30]), terrain).unwrap_err().to_string()
    };
    let far = ground(grid([612_000.0, 5_422_960.0]), Some("EPSG:32632"));
    for name in ["worldcover.tif", "same.tif", "national.tif"] {
        assert!(refused(name, &far).contains("does not lie over the map"), "{name}: {}", refused(name, &far));
    }
    let nameless = ground(grid([512_000.0, 5_422_960.0]), None);
    let said = refused("worldcover.tif", &nameless);
    assert!(said.contains("the map cannot be placed: the map has no crs"), "{said}");
    let here = ground(grid([512_000.0, 5_422_960.0]), Some("EPSG:32632"));
    let said = Areas::of_classes(&read("same.tif"), &json!({"7": {"keep_out": true}}), &here).unwrap_err();
    assert!(
        said.to_string().contains("none of the table's classes (7) lies over the map, which holds"),
        "{said}"
    );
}

#[test]
fn pixels_that_an_internal_mask_leaves_out_have_no_class() {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).unwrap();
    let side = 20;
    let mut image = encoder.new_image::<tiff::encoder::colortype::Gray8>(side, side).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[1.0, 1.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 512_000.0, 5_423_000.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &[1u16, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32_632][..]).unwrap();
    let class = |index: u32| if index % side < 10 { 80u8 } else { 40 };
    image.write_data(&(0..side * side).map(class).collect::<Vec<u8>>()).unwrap();
    let mut mask = encoder.new_image::<tiff::encoder::colortype::Gray8>(side, side).unwrap();
    const MASK: u32 = 4;
    mask.encoder().write_tag(Tag::NewSubfileType, MASK).unwrap();
    let shown = |index: u32| if index % side < 5 { 0u8 } else { 255 };
    mask.write_data(&(0..side * side).map(shown).collect::<Vec<u8>>()).unwrap();
    let grid = Grid { rows: 20, columns: 20, cell_size_m: 1.0, origin_m: [512_000.0, 5_422_980.0] };
    let terrain = ground(grid, Some("EPSG:32632"));
    let table = json!({"80": {"keep_out": true}, "40": null});
    let found = Areas::of_classes(&file.into_inner(), &table, &terrain).unwrap();
    let areas = Areas::of(&found.document, &terrain).unwrap();
    let driven = terrain.with_areas(areas).as_driven(&|| false).unwrap();
    let kept_out: Vec<bool> = (0..20).map(|column| driven.is_blocked(Cell { row: 3, column })).collect();
    // Cells that an edge touches are kept out too.
    let is_in = |columns: std::ops::Range<usize>| kept_out[columns].iter().any(|is_kept_out| *is_kept_out);
    assert!(!is_in(0..4) && kept_out[5..10].iter().all(|is_kept_out| *is_kept_out) && !is_in(11..20));
}
