//! Letters of pictures made of pixels, each placed by its own bearing and to the fraction of a pixel.
//!
//! Those of plotters stand at whole pixels, without their bearings, so that they run together.

use ab_glyph::{Font, FontRef, PxScaleFont, ScaleFont, point};
use plotters::prelude::BitMapBackend;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontStyle,
    text_anchor::{HPos, Pos, VPos},
};

/// Pixels with these letters.
pub(super) struct Lettered<'a>(pub(super) BitMapBackend<'a>);

type Failed<'a> = DrawingErrorKind<<BitMapBackend<'a> as DrawingBackend>::ErrorType>;

impl<'a> DrawingBackend for Lettered<'a> {
    type ErrorType = <BitMapBackend<'a> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }

    fn ensure_prepared(&mut self) -> Result<(), Failed<'a>> {
        self.0.ensure_prepared()
    }

    fn present(&mut self) -> Result<(), Failed<'a>> {
        self.0.present()
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Result<(), Failed<'a>> {
        self.0.draw_pixel(at, color)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Result<(), Failed<'a>> {
        self.0.draw_line(from, to, style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
        is_filled: bool,
    ) -> Result<(), Failed<'a>> {
        self.0.draw_rect(from, to, style, is_filled)
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Result<(), Failed<'a>> {
        let bytes = match style.style() {
            FontStyle::Bold => dejavu::sans::bold(),
            _ => dejavu::sans::regular(),
        };
        // A font that cannot be read leaves the letters of plotters.
        let Ok(font) = FontRef::try_from_slice(bytes) else { return self.0.draw_text(text, style, (x, y)) };
        let font = font.into_scaled(style.size() as f32);
        let (color, transform) = (style.color(), style.transform());
        let [left, base] = beginning(&style.anchor(), width(&font, text), style.size() as f32);
        let (most_x, most_y) = self.get_size();
        for (dx, dy, share) in pixels(&font, text, [left, base]) {
            let (dx, dy) = transform.transform(dx, dy);
            let (at_x, at_y) = (x + dx, y + dy);
            if (0..most_x as i32).contains(&at_x) && (0..most_y as i32).contains(&at_y) {
                self.draw_pixel((at_x, at_y), color.mix(f64::from(share.min(1.0))))?;
            }
        }
        Ok(())
    }
}

/// Height of the box that plotters lays a text out in, and of its base line above the bottom, as shares of the font's size.
const BOX_HEIGHT: f32 = 1.0 / 1.24;
const BASE: f32 = 0.5;

/// Where a text begins on its base line, relative to the place that it is anchored at [pixels].
fn beginning(anchor: &Pos, width: f32, size: f32) -> [f32; 2] {
    let left = match anchor.h_pos {
        HPos::Left => 0.0,
        HPos::Center => -0.5 * width,
        HPos::Right => -width,
    };
    let top = match anchor.v_pos {
        VPos::Top => 0.0,
        VPos::Center => -0.5 * BOX_HEIGHT * size,
        VPos::Bottom => -BOX_HEIGHT * size,
    };
    // On whole pixels, so that rows of text are equally sharp.
    [left, (top + BASE * size).round()]
}

/// Advance of each letter with the kerning before it [pixels].
fn advances<'t>(
    font: &PxScaleFont<FontRef<'_>>,
    text: &'t str,
) -> impl Iterator<Item = (char, [f32; 2])> + 't {
    let mut before = None;
    let measured: Vec<_> = text
        .chars()
        .map(|letter| {
            let glyph = font.glyph_id(letter);
            let kerning = before.replace(glyph).map_or(0.0, |before| font.kern(before, glyph));
            (letter, [kerning, font.h_advance(glyph)])
        })
        .collect();
    measured.into_iter()
}

/// Width of a text [pixels].
fn width(font: &PxScaleFont<FontRef<'_>>, text: &str) -> f32 {
    advances(font, text).map(|(_, [kerning, advance])| kerning + advance).sum()
}

/// Pixels of a text that begins at a place of its base line, each with the share of it that is covered.
fn pixels(font: &PxScaleFont<FontRef<'_>>, text: &str, [left, base]: [f32; 2]) -> Vec<(i32, i32, f32)> {
    let mut pixels = Vec::new();
    let mut x = left;
    for (letter, [kerning, advance]) in advances(font, text) {
        x += kerning;
        let glyph = font.glyph_id(letter).with_scale_and_position(font.scale(), point(x, base));
        if let Some(outline) = font.outline_glyph(glyph) {
            let corner = outline.px_bounds().min;
            outline.draw(|right, down, share| {
                pixels.push((corner.x as i32 + right as i32, corner.y as i32 + down as i32, share));
            });
        }
        x += advance;
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_stand_apart_by_their_bearings() {
        let font = FontRef::try_from_slice(dejavu::sans::bold()).unwrap().into_scaled(17.0);
        let columns = |text: &str| {
            let mut columns: Vec<i32> =
                pixels(&font, text, [0.0; 2]).iter().filter(|p| p.2 > 0.3).map(|p| p.0).collect();
            columns.sort_unstable();
            columns.dedup();
            columns
        };
        let gaps = |text: &str| columns(text).windows(2).filter(|pair| pair[1] > pair[0] + 1).count();
        assert_eq!(gaps("lll"), 2, "{:?}", columns("lll"));
        assert_eq!(gaps("Hill"), 3, "{:?}", columns("Hill"));
        let most = f64::from(*columns("energy-minimal").last().unwrap());
        assert!(most < f64::from(width(&font, "energy-minimal")), "no letter leaves its text");
    }
}
