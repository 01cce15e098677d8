//! Prints Table II and the fits of Fig. 13 beside the force-balance model's, and draws both.
//!
//!     cargo run --release -p joulepath-model --example paper_tables [-- FIGURE.svg]

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::error::Error;

use plotters::prelude::*;

#[path = "../tests/paper_tables/mod.rs"]
mod paper_tables;

use paper_tables::{SpeedFit, TableII};

/// One row of Table II: what it is, the paper's value, the model's.
type Row = (&'static str, f64, f64);

/// The paper's Table II beside the model; M1 is the slower, M2 the faster side.
fn rows(table: &TableII) -> Vec<Row> {
    vec![
        ("R = 0, M1 mean", 0.1734, table.spin.left),
        ("R = 0, M2 mean", 0.1703, table.spin.right),
        ("R = inf, M1 mean", 0.0381, table.straight.left),
        ("R = inf, M2 mean", 0.0248, table.straight.right),
        ("R > Rc, M2 mean", 0.1340, table.outer_mean),
        ("R > Rc, M2 max", 0.1787, table.outer_max),
        ("R > Rc, M2 min", 0.0232, table.outer_min),
        ("R > Rc, M1 mean", -0.0252, table.inner_mean),
        ("R > Rc, M1 min", -0.0973, table.inner_min),
    ]
}

fn main() -> Result<(), Box<dyn Error>> {
    let (table, fits) = (paper_tables::table_ii(), paper_tables::fig_13());
    println!("Side force over m g; one constant set: mu_R = 0.063, mu_S = 0.29, alpha_s = 0.30 rad\n");
    println!("{:<18} {:>9} {:>9}", "Table II", "paper", "model");
    for (name, paper, model) in rows(&table) {
        println!("{name:<18} {paper:>9.4} {model:>9.4}");
    }
    println!("\nEq. 16 fitted speed by speed to the model's outer side (Fig. 13's procedure)\n");
    println!("{:>9} {:>9} {:>9} {:>12}", "v [m/s]", "mu_R", "mu_S", "R <= Rc [%]");
    for f in &fits {
        println!(
            "{:>9.1} {:>9.4} {:>9.4} {:>12.0}",
            f.speed_mps,
            f.mu_roll,
            f.mu_skid,
            100.0 * f.share_inside
        );
    }
    println!(
        "\nThe model has no speed dependence: mu_R falls and mu_S rises because slow runs lie inside Rc."
    );
    if let Some(path) = std::env::args().nth(1) {
        draw(&path, &rows(&table), &fits)?;
        println!("figure: {path}");
    }
    Ok(())
}

const PAPER: RGBColor = RGBColor(0xc4, 0x4e, 0x10);
const MODEL: RGBColor = RGBColor(0x1f, 0x5f, 0xa8);

fn draw(path: &str, rows: &[Row], fits: &[SpeedFit]) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, (1000, 420)).into_drawing_area();
    area.fill(&WHITE)?;
    let (left, right) = area.split_horizontally(560);
    let mut chart = ChartBuilder::on(&left)
        .caption("Side force over m g: Table II and the model", ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(120)
        .build_cartesian_2d(-0.15f64..0.2, -0.5f64..(rows.len() as f64 - 0.5))?;
    let names: Vec<&str> = rows.iter().rev().map(|r| r.0).collect();
    chart
        .configure_mesh()
        .disable_y_mesh()
        .light_line_style(TRANSPARENT)
        .y_labels(rows.len())
        .y_label_formatter(&|y| names.get(y.round() as usize).map_or(String::new(), |n| (*n).to_owned()))
        .x_desc("side force / (m g)")
        .draw()?;
    let points = rows.iter().rev().enumerate();
    let paper = points.clone().map(|(i, r)| Circle::new((r.1, i as f64 + 0.12), 5, PAPER.filled()));
    chart.draw_series(paper)?.label("paper").legend(|(x, y)| Circle::new((x + 8, y), 5, PAPER.filled()));
    let model = points.map(|(i, r)| TriangleMarker::new((r.2, i as f64 - 0.12), 6, MODEL.filled()));
    chart
        .draw_series(model)?
        .label("model")
        .legend(|(x, y)| TriangleMarker::new((x + 8, y), 6, MODEL.filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE)
        .border_style(BLACK.mix(0.3))
        .draw()?;

    let mut chart = ChartBuilder::on(&right)
        .caption("Eq. 16 fitted per speed (as Fig. 13)", ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(44)
        .build_cartesian_2d(0.0f64..1.0, 0.0f64..0.5)?;
    chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("speed [m/s]").draw()?;
    let series = [
        ("mu_R", PAPER, fits.iter().map(|f| (f.speed_mps, f.mu_roll)).collect::<Vec<_>>()),
        ("mu_S", MODEL, fits.iter().map(|f| (f.speed_mps, f.mu_skid)).collect::<Vec<_>>()),
    ];
    for (name, color, line) in series {
        chart
            .draw_series(LineSeries::new(line, color.stroke_width(2)).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE)
        .border_style(BLACK.mix(0.3))
        .draw()?;
    area.present()?;
    Ok(())
}
