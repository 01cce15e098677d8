//! An answer as one self-contained picture: ground with paths and stops, a key with figures, elevation and power along the paths.

mod frame;
mod letters;
mod profile;

use std::{borrow::Cow, sync::Once};

use anyhow::anyhow;
use base64::{Engine as _, engine::general_purpose::STANDARD};
use plotters::{
    coord::Shift,
    prelude::*,
    style::{FontStyle, register_font},
};
use service::routes::plan::PoseAnswer;
use terrain::Terrain;

use crate::raster::{Raster, Window, encode, plain};
use frame::{Frame, WIDTH};
use letters::Lettered;

/// What is drawn.
pub(crate) struct Scene<'a> {
    pub(crate) terrain: &'a Terrain,
    /// What map it is.
    pub(crate) caption: String,
    /// The answer in a few words.
    pub(crate) headline: String,
    /// What it holds for, a line each.
    pub(crate) about: Vec<String>,
    /// Paths, the last on top.
    pub(crate) lines: Vec<Line<'a>>,
    /// Places with names.
    pub(crate) marks: Vec<Mark>,
    /// Ground in place of the plain relief about the paths.
    pub(crate) ground: Option<Raster>,
    /// What the tints of that ground stand for.
    pub(crate) key: Vec<KeyEntry>,
}

/// A path.
pub(crate) struct Line<'a> {
    pub(crate) entry: KeyEntry,
    pub(crate) is_dashed: bool,
    pub(crate) poses: Cow<'a, [PoseAnswer]>,
}

/// A name, its colour and its figures.
pub(crate) struct KeyEntry {
    pub(crate) name: String,
    pub(crate) color: [u8; 3],
    pub(crate) figures: Vec<String>,
}

/// A named place [m].
pub(crate) struct Mark {
    pub(crate) place_m: [f64; 2],
    pub(crate) name: String,
}

impl KeyEntry {
    fn color(&self) -> RGBColor {
        let [red, green, blue] = self.color;
        RGBColor(red, green, blue)
    }
}

type Area<DB> = DrawingArea<DB, Shift>;
type Drawn<T, DB> = Result<T, DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// The family of all text. Pixels are drawn from the font that is registered under it, and texts are measured by it.
const FONT: &str = "sans-serif";

/// Draws the picture as an SVG document.
///
/// # Errors
/// A picture that cannot be drawn.
pub(crate) fn svg(scene: &Scene<'_>) -> anyhow::Result<String> {
    let ground = scene.ground();
    let frame = Frame::of(scene, ground.window);
    let mut svg = String::new();
    let at;
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, frame.height)).into_drawing_area();
        at = scene.draw(&root, &frame, None).map_err(failed)?;
        root.present().map_err(failed)?;
    }
    let png = STANDARD.encode(ground.png()?);
    let (x, y, width, height) = at;
    let head_end = svg.find('>').ok_or_else(|| failed("no SVG head"))? + 1;
    let (head, drawing) = svg.split_at(head_end);
    Ok(format!(
        "{head}\n<rect width=\"{WIDTH}\" height=\"{}\" fill=\"#ffffff\"/>\n<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,{png}\"/>{drawing}",
        frame.height
    ))
}

/// Draws the picture as a PNG.
///
/// # Errors
/// As [`svg`].
pub(crate) fn png(scene: &Scene<'_>) -> anyhow::Result<Vec<u8>> {
    let ground = scene.ground();
    let frame = Frame::of(scene, ground.window);
    let mut rgb = vec![255; 3 * (WIDTH * frame.height) as usize];
    {
        let pixels = BitMapBackend::with_buffer(&mut rgb, (WIDTH, frame.height));
        let root = Lettered(pixels).into_drawing_area();
        scene.draw(&root, &frame, Some(&ground)).map_err(failed)?;
        root.present().map_err(failed)?;
    }
    encode(&rgb, WIDTH as usize, frame.height as usize)
}

fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("the picture cannot be drawn: {error}")
}

/// Registers the font once: DejaVu Sans, which has the letters of most names.
fn with_font() {
    static FONTS: Once = Once::new();
    FONTS.call_once(|| {
        // A font that cannot be read leaves the one that is registered before, or an error of the drawing.
        let _ = register_font(FONT, FontStyle::Normal, dejavu::sans::regular());
        let _ = register_font(FONT, FontStyle::Bold, dejavu::sans::bold());
    });
}

impl Scene<'_> {
    fn ground(&self) -> Cow<'_, Raster> {
        match &self.ground {
            Some(ground) => Cow::Borrowed(ground),
            None => {
                let places_m = self.lines.iter().flat_map(|line| line.poses.iter()).map(|p| [p.x_m, p.y_m]);
                let window = Window::about(&self.terrain.grid, places_m);
                Cow::Owned(Raster::of(self.terrain, window, &plain))
            }
        }
    }

    /// Draws everything, the ground only where it is given, and says where the ground lies [pixels].
    fn draw<DB: DrawingBackend>(
        &self,
        root: &Area<DB>,
        frame: &Frame,
        ground: Option<&Raster>,
    ) -> Drawn<frame::Pixels, DB> {
        with_font();
        let (upper, lower) = root.split_vertically(frame.upper_height);
        let (map, key) = upper.split_horizontally(frame::MAP_SIDE);
        let at = frame.draw_map(&map, self, ground)?;
        self.draw_key(&key)?;
        if !self.lines.is_empty() {
            let (elevation, power) = lower.split_vertically(frame::PROFILE_HEIGHT);
            profile::draw(&elevation, "Elevation along the path [m]", self, |p| p.z_m)?;
            profile::draw(&power, "Power from the battery [W]", self, |p| p.power_w)?;
        }
        Ok(at)
    }

    fn draw_key<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<(), DB> {
        let bold = |size: i32| (FONT, size).into_font().style(FontStyle::Bold);
        area.draw_text(&self.headline, &bold(22).color(&BLACK), (18, 40))?;
        let text = (FONT, 14).into_font().color(&RGBColor(40, 40, 40));
        let mut top = 72;
        for line in &self.about {
            area.draw_text(line, &text, (18, top))?;
            top += frame::LINE_HEIGHT;
        }
        // What is drawn last lies on top, and is what was asked for.
        for (entry, is_dashed) in self.entries() {
            top += frame::ENTRY_GAP;
            let dash = if is_dashed { 12 } else { 28 };
            for left in (18..46).step_by(16).take(if is_dashed { 2 } else { 1 }) {
                area.draw(&Rectangle::new(
                    [(left, top + 5), (left + dash, top + 11)],
                    entry.color().filled(),
                ))?;
            }
            area.draw_text(&entry.name, &bold(17).color(&entry.color()), (56, top - 2))?;
            top += 6;
            for line in &entry.figures {
                top += frame::LINE_HEIGHT;
                area.draw_text(line, &text, (56, top))?;
            }
            top += frame::LINE_HEIGHT;
        }
        Ok(())
    }

    /// Entries of the key from the top, and whether their lines are dashed.
    fn entries(&self) -> impl Iterator<Item = (&KeyEntry, bool)> {
        let lines = self.lines.iter().rev().map(|line| (&line.entry, line.is_dashed));
        lines.chain(self.key.iter().map(|entry| (entry, false)))
    }
}

fn whole(value: &f64) -> String {
    format!("{value:.0}")
}

fn draw_line<DB: DrawingBackend>(
    chart: &mut frame::Chart<'_, DB>,
    line: Vec<(f64, f64)>,
    style: ShapeStyle,
    is_dashed: bool,
) -> Drawn<(), DB> {
    match is_dashed {
        true => chart.draw_series(DashedLineSeries::new(line, 9, 9, style))?,
        false => chart.draw_series(LineSeries::new(line, style))?,
    };
    Ok(())
}
