//! `--out FILE`: an answer as a file whose ending says in which form.

use std::{ffi::OsStr, io::Write, path::PathBuf, str::FromStr};

use anyhow::Context;
use base64::{Engine as _, engine::general_purpose::STANDARD};
use report::{RoutePage, route_page};
use serde::Serialize;
use service::TrackForm;
use terrain::{Terrain, Warning, crs::EarthError};

use crate::{failure::BadInput, files, output, picture};

/// A form that an answer is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Coordinates with totals.
    Tracks(TrackForm),
    /// A picture of pixels.
    Png,
    /// A picture of lines.
    Svg,
    /// A page with picture and table.
    Html,
    /// The document that the HTTP API returns.
    Json,
}

/// Endings and what they stand for.
const ENDINGS: [(&str, Form); 8] = [
    ("geojson", Form::Tracks(TrackForm::GeoJson)),
    ("gpx", Form::Tracks(TrackForm::Gpx)),
    ("kml", Form::Tracks(TrackForm::Kml)),
    ("csv", Form::Tracks(TrackForm::Csv)),
    ("png", Form::Png),
    ("svg", Form::Svg),
    ("html", Form::Html),
    ("json", Form::Json),
];

/// A file to write, and its form.
#[derive(Clone, Debug)]
pub(crate) struct OutFile {
    path: PathBuf,
    form: Form,
}

impl FromStr for OutFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default();
        let found = ENDINGS.iter().find(|(known, _)| known.eq_ignore_ascii_case(ending));
        let Some((_, form)) = found else {
            let known: Vec<String> = ENDINGS.iter().map(|(ending, _)| format!(".{ending}")).collect();
            return Err(format!("the ending of a file says its form; give one of {}", known.join(", ")));
        };
        Ok(OutFile { form: *form, path })
    }
}

/// What an answer is written from.
pub(crate) struct Answer<'a, D> {
    /// The document of the HTTP API.
    pub(crate) document: &'a D,
    /// Writes coordinates.
    pub(crate) tracks: &'a dyn Fn(TrackForm, &mut dyn Write) -> anyhow::Result<()>,
    /// What is drawn.
    pub(crate) scene: picture::Scene<'a>,
    /// Figures, a heading first.
    pub(crate) table: Vec<Vec<String>>,
    /// What is doubtful.
    pub(crate) warnings: Vec<String>,
}

impl OutFile {
    /// Refuses what cannot be written, before long work is done for it.
    ///
    /// # Errors
    /// A missing folder, or a form that needs a place on earth which the map does not have.
    pub(crate) fn check(&self, terrain: &Terrain) -> Result<(), BadInput> {
        self.check_of(match self.form {
            Form::Tracks(form) => form.unplaced(terrain),
            _ => None,
        })
    }

    /// The same for contours, which GPX has no local metres for.
    ///
    /// # Errors
    /// As [`OutFile::check`].
    pub(crate) fn check_contours(&self, terrain: &Terrain) -> Result<(), BadInput> {
        self.check_of(match self.form {
            Form::Tracks(TrackForm::Kml | TrackForm::Gpx) => terrain.earth().err(),
            _ => None,
        })
    }

    fn check_of(&self, unplaced: Option<EarthError>) -> Result<(), BadInput> {
        files::check(&self.path).map_err(|BadInput(why)| BadInput(format!("--out {why}")))?;
        let path = self.path.display();
        unplaced.map_or(Ok(()), |error| {
            Err(BadInput(format!(
                "--out {path}: this form is longitude and latitude, and {error}: give the map a `crs`, as EPSG:32632, or write .geojson or .csv"
            )))
        })
    }

    /// Writes an answer, and says where to.
    ///
    /// # Errors
    /// A picture that cannot be drawn, or a file that cannot be written.
    pub(crate) fn write<D: Serialize>(&self, answer: Answer<'_, D>) -> anyhow::Result<()> {
        let path = &self.path;
        match self.form {
            Form::Tracks(form) => files::write_with(path, |out| (answer.tracks)(form, out))?,
            Form::Png => files::write(path, picture::png(&answer.scene)?)?,
            Form::Svg => files::write(path, picture::svg(&answer.scene)?)?,
            Form::Html => files::write(path, html(answer)?)?,
            Form::Json => files::write_with(path, |out| {
                serde_json::to_writer(&mut *out, answer.document)?;
                Ok(writeln!(out)?)
            })?,
        }
        // Standard output is for the answer.
        output::note(format_args!("wrote {}", path.display()));
        Ok(())
    }
}

/// Warnings as they are read.
pub(crate) fn details(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(|warning| warning.detail.clone()).collect()
}

fn html<D>(answer: Answer<'_, D>) -> anyhow::Result<String> {
    let svg = picture::svg(&answer.scene).context("picture of the page")?;
    let picture = format!("data:image/svg+xml;base64,{}", STANDARD.encode(svg));
    let scene = answer.scene;
    Ok(route_page(&RoutePage {
        title: &scene.headline,
        about: &scene.about,
        table: &answer.table,
        picture: &picture,
        warnings: &answer.warnings,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_says_the_form_and_an_unknown_one_is_told_all_of_them() {
        assert_eq!("a/b.GeoJSON".parse::<OutFile>().unwrap().form, Form::Tracks(TrackForm::GeoJson));
        assert_eq!("plan.v2.png".parse::<OutFile>().unwrap().form, Form::Png);
        for wrong in ["plan", "plan.", "plan.pdf", ".svg", ""] {
            let said = wrong.parse::<OutFile>().unwrap_err();
            assert!(
                ENDINGS.iter().all(|(ending, _)| said.contains(&format!(".{ending}"))),
                "{wrong}: {said}"
            );
        }
    }
}
