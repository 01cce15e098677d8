//! Where a raster lies: the map from pixels to coordinates as its tags have it.

use tiff::tags::Tag;

use super::directory::Tags;
use crate::{Error, resample::Affine};

impl Affine {
    /// Whether a file says where it lies.
    pub(super) fn is_in(tags: &mut Tags<'_, '_>) -> Result<bool, Error> {
        let is_there = |found: Option<Vec<f64>>| found.is_some();
        Ok(is_there(tags.doubles(Tag::ModelTransformationTag)?)
            || is_there(tags.doubles(Tag::ModelPixelScaleTag)?))
    }

    /// The map from pixels to coordinates in the file's own units, by its transformation or by tie point and scale.
    ///
    /// # Errors
    /// Missing or useless tags, by name.
    pub(super) fn read(tags: &mut Tags<'_, '_>) -> Result<Self, Error> {
        let affine = match tags.doubles(Tag::ModelTransformationTag)? {
            Some(matrix) => Self::from_matrix(&matrix)?,
            None => Self::from_tie_point(tags)?,
        };
        let numbers = [affine.origin, affine.column, affine.row].concat();
        if numbers.iter().any(|number| !number.is_finite()) || affine.area() == 0.0 {
            let value = format!("{:?} by {:?}", affine.column, affine.row);
            return Err(Error::TiffValue { tag: "pixel size", value, expected: "finite and not zero" });
        }
        Ok(affine)
    }

    fn from_tie_point(tags: &mut Tags<'_, '_>) -> Result<Self, Error> {
        let tie = tags.doubles(Tag::ModelTiepointTag)?;
        let Some(scale) = tags.doubles(Tag::ModelPixelScaleTag)? else {
            let several = tie.is_some_and(|tie| tie.len() > 6);
            // Ground control points say where pixels lie without saying how the raster is bent between them.
            let tag = if several {
                "ModelPixelScale, only ground control points (`gdalwarp` lays it out by them)"
            } else {
                "ModelPixelScale"
            };
            return Err(Error::TiffTag { tag });
        };
        let tie = tie.ok_or(Error::TiffTag { tag: "ModelTiepoint" })?;
        let (&[width, height, ..], &[column, row, _, x, y, ..]) = (scale.as_slice(), tie.as_slice()) else {
            return Err(Error::TiffTag { tag: "ModelTiepoint of six numbers and ModelPixelScale of three" });
        };
        // The raster runs east and south; a height below zero is a slip of writers, which GDAL reads so too.
        let height = height.abs();
        Ok(Affine {
            origin: [x - column * width, y + row * height],
            column: [width, 0.0],
            row: [0.0, -height],
        })
    }

    fn from_matrix(matrix: &[f64]) -> Result<Self, Error> {
        let &[a, b, _, x, d, e, _, y, ..] = matrix else {
            return Err(Error::TiffTag { tag: "ModelTransformation of sixteen numbers" });
        };
        Ok(Affine { origin: [x, y], column: [a, d], row: [b, e] })
    }
}
