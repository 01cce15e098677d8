//! The file that names a grid's coordinate reference system (`.prj`), as it lies beside the grid.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::{Error, Warning, WarningKind, crs::Crs};

/// What the `.prj` of a grid says.
#[derive(Debug, Default)]
pub(crate) struct ProjectionFile {
    /// The system, if the file is there and names one.
    pub(crate) crs: Option<Crs>,
    /// What of the file could not be used.
    pub(crate) warning: Option<Warning>,
}

impl ProjectionFile {
    /// Reads the file beside a grid: `map.prj`, as GDAL and Esri name it, or `map.asc.prj`, in any case of letters.
    ///
    /// # Errors
    /// One that is there and cannot be read.
    pub(crate) fn beside(path: &Path) -> Result<Self, Error> {
        let files = found_beside(path);
        let Some(file) = files.first() else { return Ok(ProjectionFile::default()) };
        let bytes = read(file)?;
        let crs = text_of(&bytes).and_then(|text| understood(&text));
        let mut doubts = Vec::new();
        match &crs {
            Err(why) => doubts.push(not_understood(file, why)),
            Ok(crs) if crs.unit.is_none() && !crs.is_geographic => doubts.push(without_unit(file)),
            Ok(_) => {}
        }
        for other in files.iter().skip(1) {
            if read(other)? != bytes {
                doubts.push(format!("{} beside it says something else and was left aside", name_of(other)));
            }
        }
        let warning = (!doubts.is_empty()).then(|| Warning::new(WarningKind::BesideFile, doubts.join("; ")));
        Ok(ProjectionFile { crs: crs.ok(), warning })
    }
}

/// The files that may belong to a grid, the one that GDAL reads first.
fn found_beside(path: &Path) -> Vec<PathBuf> {
    let Some(name) = path.file_name().map(|name| name.to_string_lossy().to_lowercase()) else {
        return Vec::new();
    };
    let unpacked = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = unpacked.strip_suffix(".asc").unwrap_or(unpacked);
    let wanted = [stem, unpacked, &name].map(|name| format!("{name}.prj"));
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<(usize, PathBuf)> = entries
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().to_lowercase();
            Some((wanted.iter().position(|wanted| *wanted == name)?, entry.path()))
        })
        .filter(|(_, file)| file.is_file())
        .collect();
    found.sort();
    found.into_iter().map(|(_, file)| file).collect()
}

fn read(file: &Path) -> Result<Vec<u8>, Error> {
    fs::read(file).map_err(|source| Error::Read { path: file.display().to_string(), source })
}

/// The text of a file in UTF-8 or, by its byte order mark, in UTF-16. Names of systems may have letters of an older encoding, which
/// say nothing here.
fn text_of(bytes: &[u8]) -> Result<String, String> {
    let wide = |from: fn([u8; 2]) -> u16| {
        let units = bytes[2..].as_chunks().0.iter().map(|pair| from(*pair));
        char::decode_utf16(units).collect::<Result<String, _>>().map_err(|_| "it is broken UTF-16".to_owned())
    };
    match bytes {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        _ => Ok(String::from_utf8_lossy(bytes).trim_start_matches('\u{feff}').to_owned()),
    }
}

/// The system that a text names, or why it names none.
fn understood(text: &str) -> Result<Crs, String> {
    let text = text.trim();
    if text.is_empty() {
        return Err("it is empty".into());
    }
    if text.starts_with('{') {
        return Err("it is PROJJSON, which is not read".into());
    }
    if text.contains("+proj=") && !text.contains('[') {
        return Crs::from_proj(text).ok_or_else(|| "its PROJ definition is not known here".into());
    }
    let beginning = || text.chars().take(40).collect::<String>();
    Crs::parse(text).ok_or_else(|| format!("what begins `{}` is no system that is known here", beginning()))
}

fn not_understood(file: &Path, why: &str) -> String {
    format!(
        "{0}, which lies beside the map, was left aside: {why}, so that x, y and heights were read as metres; \
         `gdalsrsinfo -o wkt_esri EPSG:CODE > {0}` writes one that names the system",
        name_of(file)
    )
}

fn without_unit(file: &Path) -> String {
    format!(
        "{0}, which lies beside the map, names no unit that is known here, so that x and y were read as metres; \
         `gdalsrsinfo -o wkt_esri EPSG:CODE > {0}` writes one that names the unit",
        name_of(file)
    )
}

fn name_of(file: &Path) -> String {
    file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
