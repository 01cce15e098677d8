//! Where things stand in the picture, and the map with its axes.

use plotters::{coord::types::RangedCoordf64, prelude::*, style::FontStyle};

use super::{Area, Drawn, FONT, Scene, draw_line, whole};
use crate::raster::{Raster, Window};

/// Width of the picture [pixels].
pub(super) const WIDTH: u32 = 1180;
/// Width of the map with its axis [pixels].
pub(super) const MAP_SIDE: u32 = 700;
/// Height of a profile [pixels].
pub(super) const PROFILE_HEIGHT: u32 = 240;
/// Between lines of text, and before an entry of the key [pixels].
pub(super) const LINE_HEIGHT: i32 = 21;
pub(super) const ENTRY_GAP: i32 = 24;
/// Around the map [pixels].
const MARGIN: u32 = 12;
const CAPTION: u32 = 36;
const X_LABELS: u32 = 34;
const Y_LABELS: u32 = 54;
/// The longer side of the ground, and the least that a side is drawn with [pixels].
const GROUND_SIDE: f64 = (MAP_SIDE - 2 * MARGIN - Y_LABELS) as f64;
const LEAST_SIDE: f64 = 60.0;

/// Pixel rectangle of the ground: left, top, width, height.
pub(super) type Pixels = (i32, i32, i32, i32);

pub(super) type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Sizes of the parts [pixels].
pub(super) struct Frame {
    window: Window,
    ground: [u32; 2],
    /// Of map and key.
    pub(super) upper_height: u32,
    /// Of the picture.
    pub(super) height: u32,
}

impl Frame {
    pub(super) fn of(scene: &Scene<'_>, window: Window) -> Self {
        let extent_m = window.extent_m();
        let scale = GROUND_SIDE / extent_m[0].max(extent_m[1]);
        let ground = extent_m.map(|side_m| (side_m * scale).max(LEAST_SIDE).round() as u32);
        let lines =
            scene.about.len() + scene.entries().map(|(entry, _)| entry.figures.len() + 1).sum::<usize>();
        let key = 90 + LINE_HEIGHT * lines as i32 + (ENTRY_GAP + 6) * scene.entries().count() as i32;
        let upper_height = (ground[1] + CAPTION + X_LABELS + MARGIN).max(key as u32);
        let profiles = if scene.lines.is_empty() { 0 } else { 2 * PROFILE_HEIGHT };
        Frame { window, ground, upper_height, height: upper_height + profiles }
    }

    /// Draws map, paths and places, and says where the ground lies.
    pub(super) fn draw_map<DB: DrawingBackend>(
        &self,
        area: &Area<DB>,
        scene: &Scene<'_>,
        ground: Option<&Raster>,
    ) -> Drawn<Pixels, DB> {
        let [width, height] = self.ground;
        let caption = (FONT, 15).into_font().color(&BLACK);
        area.draw_text(&scene.caption, &caption, ((MARGIN + Y_LABELS) as i32, 12))?;
        let extent_m = self.window.extent_m();
        // Distances count from the south-west corner of the map, as in `@0,0`.
        let corner_m = scene.terrain.grid.origin_m;
        let [west_m, south_m] = [0, 1].map(|i| self.window.low_m[i] - corner_m[i]);
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .margin_top(CAPTION)
            .margin_right(MAP_SIDE - MARGIN - Y_LABELS - width)
            .margin_bottom(self.upper_height - CAPTION - X_LABELS - height)
            .x_label_area_size(X_LABELS)
            .y_label_area_size(Y_LABELS)
            .build_cartesian_2d(west_m..west_m + extent_m[0], south_m..south_m + extent_m[1])?;
        let (x, y) = chart.plotting_area().get_pixel_range();
        let at = (x.start, y.start, x.end - x.start, y.end - y.start);
        if let Some(ground) = ground {
            lay(area, ground, at)?;
        }
        chart
            .configure_mesh()
            .disable_mesh()
            .x_labels(labels(width))
            .y_labels(labels(height))
            .x_label_formatter(&whole)
            .y_label_formatter(&whole)
            .x_desc("metres east")
            .y_desc("metres north")
            .draw()?;
        let local = |[x_m, y_m]: [f64; 2]| (x_m - corner_m[0], y_m - corner_m[1]);
        let line = |line: &super::Line<'_>| -> Vec<(f64, f64)> {
            line.poses.iter().map(|p| local([p.x_m, p.y_m])).collect()
        };
        for path in &scene.lines {
            chart.draw_series(LineSeries::new(line(path), WHITE.mix(0.85).stroke_width(6)))?;
        }
        for path in &scene.lines {
            draw_line(&mut chart, line(path), path.entry.color().stroke_width(3), path.is_dashed)?;
        }
        for mark in &scene.marks {
            let at = local(mark.place_m);
            chart.draw_series([Circle::new(at, 7, WHITE.filled()), Circle::new(at, 5, BLACK.filled())])?;
            let label = (FONT, 16).into_font().style(FontStyle::Bold).color(&BLACK);
            chart.draw_series([EmptyElement::at(at) + Text::new(mark.name.clone(), (9, -18), label)])?;
        }
        Ok(at)
    }
}

/// Labels along a side: one for every eighty pixels or so.
fn labels(side: u32) -> usize {
    (side as usize / 80).clamp(2, 10)
}

/// Paints the ground, pixel by pixel.
fn lay<DB: DrawingBackend>(area: &Area<DB>, ground: &Raster, at: Pixels) -> Drawn<(), DB> {
    let (left, top, width, height) = at;
    for y in 0..height {
        for x in 0..width {
            let share = |at: i32, of: i32| (f64::from(at) + 0.5) / f64::from(of);
            let [red, green, blue] = ground.color_at(share(x, width), share(y, height));
            area.draw_pixel((left + x, top + y), &RGBColor(red, green, blue))?;
        }
    }
    Ok(())
}
