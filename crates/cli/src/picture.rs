//! The comparison as one self-contained picture: hillshade with the paths, elevation and power along them.

use anyhow::anyhow;
use base64::{Engine as _, engine::general_purpose::STANDARD};
use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
};
use service::routes::{
    compare::CompareAnswer,
    plan::{PlanAnswer, PoseAnswer},
};
use terrain::{SlopeMap, Terrain, hillshade::hillshade};

const WIDTH: u32 = 1180;
const MAP_SIDE: u32 = 700;
const HEIGHT: u32 = 1180;
/// Vertical exaggeration of the shading: slopes of ten degrees read as relief.
const EXAGGERATION: f32 = 2.0;

/// A path, its name and its colour; the colours stay apart for colour-blind eyes (Okabe & Ito).
type Series<'a> = (&'static str, RGBColor, &'a PlanAnswer);

/// The one that is drawn in dashes.
const FASTEST: &str = "fastest";

/// Draws the picture as an SVG document.
pub(crate) fn draw(terrain: &Terrain, answer: &CompareAnswer) -> anyhow::Result<String> {
    // The fastest path often lies on the shortest: it is drawn after it, in dashes.
    let series: [Series<'_>; 3] = [
        ("shortest", RGBColor(0xD5, 0x5E, 0x00), &answer.distance),
        (FASTEST, RGBColor(0x5A, 0x12, 0x5A), &answer.time),
        ("energy-minimal", RGBColor(0x00, 0x62, 0xB0), &answer.energy),
    ];
    let mut svg = String::new();
    let backdrop;
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, HEIGHT)).into_drawing_area();
        let (upper, lower) = root.split_vertically(MAP_SIDE);
        let (map, legend) = upper.split_horizontally(MAP_SIDE);
        backdrop = draw_map(&map, terrain, &series).map_err(failed)?;
        draw_legend(&legend, answer, &series).map_err(failed)?;
        let (elevation, power) = lower.split_vertically((HEIGHT - MAP_SIDE) / 2);
        let z = |p: &PoseAnswer| p.z_m;
        draw_profile(&elevation, "Elevation along the path [m]", &series, z).map_err(failed)?;
        let watts = |p: &PoseAnswer| p.power_w;
        draw_profile(&power, "Power from the battery [W], averaged over 10 m", &series, watts)
            .map_err(failed)?;
        root.present().map_err(failed)?;
    }
    with_backdrop(&svg, terrain, backdrop)
}

fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("the picture cannot be drawn: {error}")
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn<T> = Result<T, DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>>;

/// Pixel rectangle of the map: left, top, width, height.
type Pixels = (i32, i32, i32, i32);

fn draw_map(area: &Area<'_>, terrain: &Terrain, series: &[Series<'_>]) -> Drawn<Pixels> {
    let grid = &terrain.grid;
    let extent_m = [grid.columns as f64 * grid.cell_size_m, grid.rows as f64 * grid.cell_size_m];
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_top(30)
        .x_label_area_size(34)
        .y_label_area_size(46)
        .caption("Minnesota, 1 m lidar: shaded relief, north up", ("sans-serif", 16))
        .build_cartesian_2d(0.0..extent_m[0], 0.0..extent_m[1])?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_label_formatter(&whole)
        .y_label_formatter(&whole)
        .x_desc("metres east")
        .y_desc("metres north")
        .draw()?;
    let local = |p: &PoseAnswer| (p.x_m - grid.origin_m[0], p.y_m - grid.origin_m[1]);
    let line = |plan: &PlanAnswer| plan.poses.iter().map(local).collect::<Vec<(f64, f64)>>();
    for (_, _, plan) in series {
        chart.draw_series(LineSeries::new(line(plan), WHITE.mix(0.85).stroke_width(6)))?;
    }
    for (name, color, plan) in series {
        draw_line(&mut chart, name, line(plan), color.stroke_width(3))?;
    }
    if let (Some(first), Some(last)) = (series[2].2.poses.first(), series[2].2.poses.last()) {
        for (pose, name) in [(first, "start"), (last, "goal")] {
            let at = local(pose);
            chart.draw_series([Circle::new(at, 7, WHITE.filled()), Circle::new(at, 5, BLACK.filled())])?;
            let label = ("sans-serif", 17).into_font().style(FontStyle::Bold).color(&BLACK);
            chart.draw_series([EmptyElement::at(at) + Text::new(name, (9, -18), label)])?;
        }
    }
    let (x, y) = chart.plotting_area().get_pixel_range();
    Ok((x.start, y.start, x.end - x.start, y.end - y.start))
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

fn draw_line(chart: &mut Chart<'_, '_>, name: &str, line: Vec<(f64, f64)>, style: ShapeStyle) -> Drawn<()> {
    if name == FASTEST {
        chart.draw_series(DashedLineSeries::new(line, 9, 9, style))?;
    } else {
        chart.draw_series(LineSeries::new(line, style))?;
    }
    Ok(())
}

fn draw_legend(area: &Area<'_>, answer: &CompareAnswer, series: &[Series<'_>; 3]) -> Drawn<()> {
    let title = ("sans-serif", 22).into_font().style(FontStyle::Bold).color(&BLACK);
    let headline = format!("{:.0} % less energy", 100.0 * answer.saving_fraction);
    area.draw_text(&headline, &title, (18, 40))?;
    let text = ("sans-serif", 15).into_font().color(&RGBColor(40, 40, 40));
    let further = 100.0 * (answer.energy.distance_m / answer.distance.distance_m - 1.0);
    let lines = [
        "than the shortest path of a Husky A200,".to_owned(),
        format!("by driving {further:.0} % further round the hills."),
    ];
    for (i, line) in lines.iter().enumerate() {
        area.draw_text(line, &text, (18, 72 + 20 * i as i32))?;
    }
    let [shortest, fastest, energy] = series;
    for (i, (name, color, plan)) in [energy, shortest, fastest].into_iter().enumerate() {
        let top = 150 + 165 * i as i32;
        let dash = if *name == FASTEST { 12 } else { 28 };
        for left in (18..46).step_by(16).take(if dash < 28 { 2 } else { 1 }) {
            area.draw(&Rectangle::new([(left, top + 5), (left + dash, top + 11)], color.filled()))?;
        }
        let name_style = ("sans-serif", 18).into_font().style(FontStyle::Bold).color(color);
        area.draw_text(name, &name_style, (56, top - 2))?;
        let [low, high] = plan.energy_interval_j.map(|j| j / 1e3);
        let figures = [
            format!("{:.1} kJ  (95 %: {low:.1} to {high:.1} kJ)", plan.energy_j / 1e3),
            format!("{:.0} m, {:.1} min", plan.distance_m, plan.duration_s / 60.0),
            format!("climbs {:.1} m, descends {:.1} m", plan.climb_m, plan.descent_m),
            format!("{:.1} kJ recovered on descents", plan.recovered_j / 1e3),
        ];
        for (j, line) in figures.iter().enumerate() {
            area.draw_text(line, &text, (56, top + 28 + 22 * j as i32))?;
        }
    }
    Ok(())
}

/// A path's name, its colour and a quantity along it.
type Profile<'a> = (&'a str, RGBColor, Vec<(f64, f64)>);

/// A quantity against the distance along each path, as means over stretches.
fn draw_profile(
    area: &Area<'_>,
    caption: &str,
    series: &[Series<'_>],
    value: impl Fn(&PoseAnswer) -> f64,
) -> Drawn<()> {
    let lines: Vec<Profile<'_>> =
        series.iter().map(|(name, color, plan)| (*name, *color, stretches(&plan.poses, &value))).collect();
    let points = || lines.iter().flat_map(|(_, _, line)| line);
    let longest_m = points().map(|p| p.0).fold(1.0, f64::max);
    let (low, high) = points().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.1), h.max(p.1)));
    let room = (high - low).max(1e-3) * 0.06;
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(30)
        .x_label_area_size(34)
        .y_label_area_size(46)
        .caption(caption, ("sans-serif", 16))
        .build_cartesian_2d(0.0..longest_m, low - room..high + room)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_label_formatter(&whole)
        .y_label_formatter(&whole)
        .y_labels(6)
        .x_desc("metres along the path")
        .draw()?;
    if low < 0.0 && high > 0.0 {
        chart.draw_series(LineSeries::new([(0.0, 0.0), (longest_m, 0.0)], BLACK.mix(0.6)))?;
    }
    for (name, color, line) in lines {
        draw_line(&mut chart, name, line, color.stroke_width(2))?;
    }
    Ok(())
}

fn whole(value: &f64) -> String {
    format!("{value:.0}")
}

/// Length over which a profile is averaged [m].
const STRETCH_M: f64 = 10.0;

/// Time-weighted means over stretches of the path, at their middle.
fn stretches(poses: &[PoseAnswer], value: &impl Fn(&PoseAnswer) -> f64) -> Vec<(f64, f64)> {
    let mut line = Vec::new();
    let (mut from_m, mut sum, mut time_s) = (0.0, 0.0, 0.0);
    for pair in poses.windows(2) {
        let [before, now] = pair else { continue };
        let dt = now.t_s - before.t_s;
        sum += value(now) * dt;
        time_s += dt;
        if now.distance_m - from_m >= STRETCH_M && time_s > 0.0 {
            line.push(((from_m + now.distance_m) / 2.0, sum / time_s));
            (from_m, sum, time_s) = (now.distance_m, 0.0, 0.0);
        }
    }
    line
}

/// Puts the background and the shaded relief behind what plotters drew.
fn with_backdrop(svg: &str, terrain: &Terrain, (x, y, width, height): Pixels) -> anyhow::Result<String> {
    let shade = STANDARD.encode(shaded_png(terrain)?);
    let head_end = svg.find('>').ok_or_else(|| failed("no SVG head"))? + 1;
    let (head, drawing) = svg.split_at(head_end);
    Ok(format!(
        "{head}\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,{shade}\"/>{drawing}"
    ))
}

/// The shaded relief as a PNG, northernmost row first.
fn shaded_png(terrain: &Terrain) -> anyhow::Result<Vec<u8>> {
    let grid = &terrain.grid;
    let shade = hillshade(terrain, &SlopeMap::new(terrain), EXAGGERATION);
    // Lightened, so that the paths stand out.
    let north_up: Vec<u8> =
        shade.chunks(grid.columns).rev().flatten().map(|s| 90 + (u16::from(*s) * 160 / 255) as u8).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, grid.columns as u32, grid.rows as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(&north_up)?;
    Ok(bytes)
}
