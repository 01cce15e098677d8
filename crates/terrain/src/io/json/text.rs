//! A map as JSON text, piece by piece.

use crate::Terrain;

/// Cells of a piece, some 40 kB of text.
const PIECE_CELLS: usize = 4096;

/// A JSON grid as pieces of text, which together are the document. What has been read of it takes no memory.
#[derive(Clone, Debug)]
pub struct JsonText {
    terrain: Terrain,
    /// What people call it.
    name: Option<String>,
    /// Layer under way; `None` once all has been given.
    layer: Option<Layer>,
    /// Next cell of it.
    cell: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layer {
    Elevation,
    Surface,
    Obstacle,
    Filled,
}

impl JsonText {
    /// The text of a map, whose cells are shared, not copied.
    pub fn of(terrain: &Terrain) -> Self {
        JsonText { terrain: terrain.clone(), name: None, layer: Some(Layer::Elevation), cell: 0 }
    }

    /// The same with a name of the map.
    pub fn named(self, name: Option<String>) -> Self {
        JsonText { name, ..self }
    }

    fn head(&self, layer: Layer) -> String {
        let grid = &self.terrain.grid;
        match layer {
            Layer::Elevation => format!(
                "{{{}\"cell_size_m\":{},\"origin_m\":[{},{}],{}\"rows\":{},\"columns\":{},\"elevation_m\":[",
                text_member("name", self.name.as_deref()),
                number(grid.cell_size_m),
                number(grid.origin_m[0]),
                number(grid.origin_m[1]),
                text_member("crs", self.terrain.crs.as_deref()),
                grid.rows,
                grid.columns
            ),
            Layer::Surface => ",\"surface\":[".to_owned(),
            Layer::Obstacle => ",\"obstacle\":[".to_owned(),
            Layer::Filled => ",\"filled\":[".to_owned(),
        }
    }

    /// The end of the document.
    fn tail(&self) -> String {
        let warnings = serde_json::to_string(self.terrain.warnings()).unwrap_or_default();
        let warnings = match self.terrain.warnings() {
            [] => String::new(),
            _ => format!(",\"warnings\":{warnings}"),
        };
        let areas = self.terrain.areas().map(|areas| format!(",\"areas\":{}", areas.text()));
        format!("{warnings}{}}}", areas.unwrap_or_default())
    }

    fn value(&self, layer: Layer, index: usize) -> String {
        let terrain = &self.terrain;
        let cell = terrain.grid.cell(index);
        match layer {
            Layer::Elevation => terrain.elevation_m(cell).map_or_else(|| "null".to_owned(), number),
            Layer::Surface => {
                let class = usize::from(terrain.surface_class(cell));
                let name = terrain.surfaces().and_then(|surfaces| surfaces.names.get(class));
                name.map_or_else(
                    || "null".to_owned(),
                    |name| serde_json::Value::from(name.as_str()).to_string(),
                )
            }
            Layer::Obstacle => flag(terrain.obstacles(), index),
            Layer::Filled => flag(terrain.filled(), index),
        }
    }

    /// The layer after another that the map has.
    fn next_layer(&self, layer: Layer) -> Option<Layer> {
        let has = |layer: &Layer| match layer {
            Layer::Elevation => true,
            Layer::Surface => self.terrain.surfaces().is_some(),
            Layer::Obstacle => self.terrain.obstacles().is_some(),
            Layer::Filled => self.terrain.filled().is_some(),
        };
        const ORDER: [Layer; 4] = [Layer::Elevation, Layer::Surface, Layer::Obstacle, Layer::Filled];
        ORDER.into_iter().skip_while(|other| *other != layer).skip(1).find(has)
    }
}

/// A member of the document and a comma, where there is a text.
fn text_member(name: &str, text: Option<&str>) -> String {
    text.map(|text| format!("\"{name}\":{},", serde_json::Value::from(text))).unwrap_or_default()
}

impl Iterator for JsonText {
    type Item = Vec<u8>;

    fn next(&mut self) -> Option<Vec<u8>> {
        let layer = self.layer?;
        let (columns, cells) = (self.terrain.grid.columns, self.terrain.grid.cells());
        let mut text = if self.cell == 0 { self.head(layer) } else { String::new() };
        let until = (self.cell + PIECE_CELLS).min(cells);
        for index in self.cell..until {
            match index % columns {
                0 if index > 0 => text.push_str("],["),
                0 => text.push('['),
                _ => text.push(','),
            }
            text.push_str(&self.value(layer, index));
        }
        self.cell = until;
        if until == cells {
            text.push_str("]]");
            self.cell = 0;
            self.layer = self.next_layer(layer);
            if self.layer.is_none() {
                text.push_str(&self.tail());
            }
        }
        Some(text.into_bytes())
    }
}

/// A cell of a layer of flags.
fn flag(cells: Option<&[bool]>, index: usize) -> String {
    cells.and_then(|cells| cells.get(index)).is_some_and(|flag| *flag).to_string()
}

/// A finite number in the shortest form that reads back the same.
fn number(value: f64) -> String {
    serde_json::Number::from_f64(value).map_or_else(|| "null".to_owned(), |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, Surfaces, io::json::read};

    #[test]
    fn the_pieces_are_the_map() {
        let grid = Grid { rows: 70, columns: 90, cell_size_m: 0.25, origin_m: [-3.5, 1e6] };
        let cells = grid.cells();
        let elevation_m: Vec<f64> =
            (0..cells).map(|i| if i % 11 == 0 { f64::NAN } else { i as f64 * 0.1 }).collect();
        let names = (0..cells).map(|i| [None, Some("a \"b\""), Some("mud")][i % 3]);
        let plain = Terrain::new(grid, &elevation_m).unwrap();
        let full = plain
            .clone()
            .with_surfaces(Surfaces::from_names(names).unwrap())
            .with_obstacles((0..cells).map(|i| i % 5 == 0).collect())
            .with_filled((0..cells).map(|i| i % 7 == 0).collect());
        for terrain in [plain, full] {
            let pieces: Vec<Vec<u8>> = JsonText::of(&terrain).collect();
            assert!(pieces.len() > 1 && pieces.iter().all(|piece| piece.len() < 40 * PIECE_CELLS));
            let text = String::from_utf8(pieces.concat()).unwrap();
            assert_eq!(read(&text).unwrap().content_id(), terrain.content_id());
        }
    }
}
