//! A layer of a JSON grid, read row by row into one flat list of cells.

use std::{fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer,
    de::{DeserializeSeed, IgnoredAny, SeqAccess, Visitor},
};

use crate::{Error, Surfaces};

/// Cells as they are kept, to which those of JSON are added one by one.
pub trait Cells: Default {
    /// A cell as JSON has it.
    type Cell: for<'de> Deserialize<'de>;

    /// Adds a cell.
    fn push(&mut self, cell: Self::Cell);
}

/// Elevations, NaN where unknown [m].
impl Cells for Vec<f64> {
    type Cell = Option<f64>;

    fn push(&mut self, cell: Option<f64>) {
        Vec::push(self, cell.unwrap_or(f64::NAN));
    }
}

impl Cells for Vec<bool> {
    type Cell = bool;

    fn push(&mut self, cell: bool) {
        Vec::push(self, cell);
    }
}

/// Surface names as classes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceNames {
    surfaces: Surfaces,
    /// First name beyond those that there can be.
    surplus: Option<String>,
}

impl SurfaceNames {
    pub(super) fn into_surfaces(self) -> Result<Surfaces, Error> {
        match self.surplus {
            Some(name) => Err(Error::TooManySurfaces { name, limit: usize::from(Surfaces::UNNAMED) }),
            None => Ok(self.surfaces),
        }
    }
}

impl Cells for SurfaceNames {
    type Cell = Option<String>;

    fn push(&mut self, name: Option<String>) {
        let class = match self.surfaces.class_of(name.as_deref()) {
            _ if self.surplus.is_some() => return,
            Ok(class) => class,
            Err(_) => {
                self.surplus = name;
                return;
            }
        };
        self.surfaces.class.push(class);
    }
}

/// Rows of cells. Of rows after the first one that is longer or shorter than the first, no cell is kept: it is refused for
/// its length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer<C> {
    pub(super) cells: C,
    rows: usize,
    /// Cells of the first row.
    columns: usize,
    /// First row of another length, and its length.
    ragged: Option<(usize, usize)>,
}

impl<C> Layer<C> {
    /// A layer of cells that are in memory, row by row from the south-west. Whether there are as many as rows and columns say is for
    /// who made them to see to.
    pub fn new(cells: C, rows: usize, columns: usize) -> Self {
        Layer { cells, rows, columns, ragged: None }
    }

    /// Number of cells that were kept.
    pub fn cells(&self) -> usize {
        self.rows.saturating_mul(self.columns)
    }

    /// The cells, if there are so many rows and columns.
    pub(super) fn shaped(self, layer: &'static str, (rows, columns): (usize, usize)) -> Result<C, Error> {
        if self.rows != rows {
            return Err(Error::RowCount { layer, found: self.rows, expected: rows });
        }
        let wrong = if self.columns == columns { self.ragged } else { Some((0, self.columns)) };
        match wrong {
            Some((row, found)) => Err(Error::RowLength { layer, row, found, expected: columns }),
            None => Ok(self.cells),
        }
    }
}

impl<'de, C: Cells> Deserialize<'de> for Layer<C> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Rows(PhantomData))
    }
}

struct Rows<C>(PhantomData<C>);

impl<'de, C: Cells> Visitor<'de> for Rows<C> {
    type Value = Layer<C>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of rows")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<Layer<C>, A::Error> {
        let mut layer = Layer { cells: C::default(), rows: 0, columns: usize::MAX, ragged: None };
        while let Some(found) = rows.next_element_seed(Row(&mut layer))? {
            let row = layer.rows;
            layer.rows += 1;
            if row == 0 {
                layer.columns = found;
            } else if found != layer.columns && layer.ragged.is_none() {
                layer.ragged = Some((row, found));
            }
        }
        layer.columns = if layer.rows == 0 { 0 } else { layer.columns };
        Ok(layer)
    }
}

/// A row, whose cells are added to its layer.
struct Row<'a, C>(&'a mut Layer<C>);

impl<'de, C: Cells> DeserializeSeed<'de> for Row<'_, C> {
    type Value = usize;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<usize, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, C: Cells> Visitor<'de> for Row<'_, C> {
    type Value = usize;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a row: a list of cells")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut cells: A) -> Result<usize, A::Error> {
        let layer = self.0;
        let mut count = 0;
        while layer.ragged.is_none() && count < layer.columns {
            let Some(cell) = cells.next_element()? else { return Ok(count) };
            layer.cells.push(cell);
            count += 1;
        }
        while cells.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        Ok(count)
    }
}
