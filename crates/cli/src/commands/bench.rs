//! `joulepath bench`.

use std::io::IsTerminal;

use bench::{Report, SIDES};
use clap::Args;
use terrain::{Terrain, io};

use crate::{failure::BadInput, output};

/// The lidar terrain of the demo, mirrored to size.
const TILE: &[u8] = include_bytes!("../../../../maps/minnesota.tif");
/// Largest side: its costs of motions take about 6.5 GB.
const LARGEST_SIDE: usize = 4500;
/// Smallest side on which the robot has somewhere to go.
const SMALLEST_SIDE: usize = 60;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Side of the only map to measure, in cells of one metre [default: 250, 500, 1000 and 2000]
    #[arg(long)]
    size: Option<usize>,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let sides = match arguments.size {
        None => SIDES.to_vec(),
        Some(side) if (SMALLEST_SIDE..=LARGEST_SIDE).contains(&side) => vec![side],
        Some(side) => {
            let detail = format!("--size {side} must lie in {SMALLEST_SIDE} to {LARGEST_SIDE} cells");
            return Err(BadInput(detail).into());
        }
    };
    let tile = io::geotiff::read(TILE, Terrain::MAX_CELLS)?;
    let on_terminal = std::io::stderr().is_terminal();
    let report = bench::run(&tile, &sides, |next| {
        if on_terminal {
            output::note(format_args!("measuring {next}"));
        }
    })?;
    if arguments.json {
        output::json(&report)?;
    } else {
        output::line(text(&report))?;
    }
    Ok(())
}

/// Ratios first: they hold on other machines too.
fn text(report: &Report) -> String {
    let mut text =
        String::from("The same search by general-purpose libraries, as multiples of the planner's time\n\n");
    text.push_str(&format!("{:<38} {:>6} {:>10} {:>8}\n", "library", "side", "ms", "ratio"));
    for peer in &report.peers {
        text.push_str(&format!(
            "{:<38} {:>6} {:>10.1} {:>7.1}×\n",
            peer.name, peer.cells_per_side, peer.ms, peer.ratio
        ));
    }
    text.push_str("\nWays across the map, on one core: cold with nothing at hand, warm with costs and the goal's field at hand\n\n");
    text.push_str(&format!(
        "{:>6} {:>10} {:>6} {:>7} {:>9} {:>9} {:>11} {:>13} {:>12}\n",
        "side",
        "terrain",
        "bound",
        "proven",
        "cold ms",
        "warm ms",
        "expansions",
        "ns/expansion",
        "bytes/state"
    ));
    for case in &report.cases {
        text.push_str(&format!(
            "{:>6} {:>10} {:>6.2} {:>7.3} {:>9.1} {:>9.2} {:>11} {:>13.1} {:>12.1}\n",
            case.cells_per_side,
            case.terrain,
            case.bound,
            case.proven,
            case.cold_ms,
            case.warm_ms,
            case.expansions,
            case.ns_per_expansion,
            case.bytes_per_state
        ));
    }
    text.push_str(&format!("\nParts, on one core; batches on {} against one\n\n", report.cores));
    text.push_str(&format!(
        "{:>6} {:>14} {:>14} {:>12} {:>14} {:>15} {:>14} {:>10} {:>8}\n",
        "side",
        "slope Mcells/s",
        "table ns/edge",
        "bytes/edge",
        "field ns/cell",
        "exact ns/state",
        "held goal ms",
        "overrun ms",
        "batches"
    ));
    let or_dash =
        |value: Option<f64>, digits: usize| value.map_or("-".to_owned(), |v| format!("{v:.digits$}"));
    for parts in &report.parts {
        text.push_str(&format!(
            "{:>6} {:>14.0} {:>14.1} {:>12.2} {:>14.1} {:>15} {:>14} {:>10.1} {:>7.2}×\n",
            parts.cells_per_side,
            parts.slope_million_cells_per_s,
            parts.table_ns_per_edge,
            parts.table_bytes_per_edge,
            parts.field_ns_per_cell,
            or_dash(parts.exact_field_ns_per_state, 1),
            or_dash(parts.held_goal_ms, 3),
            parts.deadline_overrun_ms,
            parts.all_cores_ratio
        ));
    }
    text
}
