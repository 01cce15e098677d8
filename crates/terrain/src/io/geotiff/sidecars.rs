//! Files that lie beside a GeoTIFF, as GDAL names them: world file (`.tfw`), GDAL's own metadata (`.tif.aux.xml`) and mask (`.tif.msk`).

use std::{
    ffi::OsString,
    fs,
    io::{ErrorKind, Read},
    path::{Path, PathBuf},
};

use super::aux_xml::AuxXml;
use crate::{Error, Warning, WarningKind, resample::Affine};

/// Longest text that is read [bytes]: statistics and histograms of many bands take some megabytes.
const LONGEST_TEXT: u64 = 1 << 26;

/// What lies beside a GeoTIFF.
#[derive(Debug, Default)]
pub struct Sidecars {
    /// World file: its name, and the placement that it holds if it can be read.
    world: Option<(String, Option<Affine>)>,
    /// GDAL's metadata, which stand above those within the file.
    pub(super) aux: AuxXml,
    /// A TIFF that is zero where the elevation is left out.
    pub(super) mask: Option<Vec<u8>>,
    /// What could not be used.
    pub(super) warnings: Vec<Warning>,
}

impl Sidecars {
    /// Reads the files beside a GeoTIFF; those that are not there say nothing.
    ///
    /// # Errors
    /// One that is there and cannot be read.
    pub fn beside(path: &Path) -> Result<Self, Error> {
        let world = ["tfw", "tifw", "tiffw", "wld", "TFW", "TIFW", "WLD"];
        let world = world.iter().map(|ending| path.with_extension(ending)).find(|world| world.is_file());
        let world = world.map(|world| {
            let text = read(&world, LONGEST_TEXT)?.unwrap_or_default();
            Ok::<_, Error>((name_of(&world), world_affine(&String::from_utf8_lossy(&text))))
        });
        let mut sidecars = Sidecars { world: world.transpose()?, ..Sidecars::default() };
        let aux = with_ending(path, ".aux.xml");
        if let Some(text) = read(&aux, LONGEST_TEXT)? {
            let (found, unused) = AuxXml::parse(&String::from_utf8_lossy(&text));
            sidecars.aux = found;
            sidecars.warnings.extend(unused.map(|why| ignored(&name_of(&aux), &why)));
        }
        sidecars.mask = read(&with_ending(path, ".msk"), u64::MAX)?;
        Ok(sidecars)
    }

    /// The placement by these files and the GeoTIFF's own, if it has one: that of GDAL's metadata stands above the file's, and a world
    /// file below it. Doubts are added to the warnings.
    ///
    /// # Errors
    /// No placement anywhere, or none that can be read.
    pub(super) fn affine(
        &self,
        own: Result<Affine, Error>,
        is_own: bool,
        warnings: &mut Vec<Warning>,
    ) -> Result<Affine, Error> {
        if let Some(affine) = self.aux.affine {
            let differs = own.is_ok_and(|own| is_own && !is_same(&own, &affine));
            let detail = "the file beside it (.aux.xml) places the GeoTIFF elsewhere than its own tags do: it was followed, as GDAL does";
            warnings.extend(differs.then(|| Warning::new(WarningKind::BesideFile, detail)));
            return Ok(affine);
        }
        match &self.world {
            None => own,
            Some((name, None)) if is_own => {
                warnings.push(ignored(name, "it holds no six numbers"));
                own
            }
            Some((name, None)) => Err(Error::WorldFile { file: name.clone() }),
            Some((name, Some(affine))) if is_own => {
                let own = own?;
                if !is_same(&own, affine) {
                    let why = "it places the map elsewhere than the GeoTIFF's own tags, which were followed";
                    warnings.push(ignored(name, why));
                }
                Ok(own)
            }
            Some((_, Some(affine))) => Ok(*affine),
        }
    }
}

/// The warnings with all about files beside the map as one: a map keeps one of each kind.
pub(super) fn joined(warnings: Vec<Warning>) -> Vec<Warning> {
    let is_beside = |warning: &Warning| warning.kind == WarningKind::BesideFile;
    let (beside, mut others): (Vec<Warning>, Vec<Warning>) = warnings.into_iter().partition(is_beside);
    let details: Vec<String> = beside.into_iter().map(|warning| warning.detail).collect();
    others.extend((!details.is_empty()).then(|| Warning::new(WarningKind::BesideFile, details.join("; "))));
    others
}

fn ignored(name: &str, why: &str) -> Warning {
    let detail = format!("{name}, which lies beside the map, was left aside: {why}");
    Warning::new(WarningKind::BesideFile, detail)
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name: OsString = path.into();
    name.push(ending);
    name.into()
}

/// The bytes of a file, if it is there.
fn read(path: &Path, most_bytes: u64) -> Result<Option<Vec<u8>>, Error> {
    let failed = |source| Error::Read { path: path.display().to_string(), source };
    let file = match fs::File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(failed(error)),
    };
    let mut bytes = Vec::new();
    file.take(most_bytes).read_to_end(&mut bytes).map_err(failed)?;
    Ok(Some(bytes))
}

/// Whether two placements of a raster differ by no more than the digits that they are written with.
fn is_same(one: &Affine, other: &Affine) -> bool {
    /// A hundredth of a pixel.
    const WRITTEN_DIGITS: f64 = 0.01;
    let [width, height] = one.edges();
    let origins = [0, 1].map(|axis| (one.origin[axis] - other.origin[axis]).abs());
    let edges = [0, 1]
        .map(|axis| (one.column[axis] - other.column[axis]).abs() + (one.row[axis] - other.row[axis]).abs());
    origins.iter().chain(&edges).all(|off| *off <= WRITTEN_DIGITS * width.min(height))
}

/// The placement of a world file: width, two turns, height, and the centre of the first pixel, a number to a line.
fn world_affine(text: &str) -> Option<Affine> {
    let numbers = text.split_whitespace().map(|word| word.replace(',', ".").parse::<f64>().ok());
    let numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
    let &[width, turn_y, turn_x, height, x, y] = numbers.as_slice() else { return None };
    let affine =
        Affine { origin: [x, y], column: [width, turn_y], row: [turn_x, height] }.with_centred_pixels();
    (numbers.iter().all(|number| number.is_finite()) && affine.area() != 0.0).then_some(affine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_world_file_counts_from_the_centre_of_the_first_pixel() {
        let affine = world_affine("0.5\n0\n0\n-0,5\n500000.25\n4000.75\n").unwrap();
        assert_eq!(affine, Affine { origin: [500_000.0, 4001.0], column: [0.5, 0.0], row: [0.0, -0.5] });
        for wrong in ["", "1 0 0 -1 5", "1 0 0 0 5 6", "a b c d e f", "1 0 0 nan 5 6"] {
            assert_eq!(world_affine(wrong), None, "{wrong}");
        }
    }
}
