//! `joulepath demo`: the whole product in one go, over real terrain and through the running service.

use std::{
    net::TcpListener,
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::Context;
use clap::Args;
use serde_json::json;
use service::{Engine, Limits, routes::compare::CompareAnswer, start};
use terrain::{Terrain, io};

use crate::{output, picture, table};

/// Bare-earth lidar of 400 m × 400 m in Minnesota; `maps/README.md` states its origin and licence.
const MAP: &[u8] = include_bytes!("../../../../maps/minnesota.tif");
/// Both ends as fractions of the map: from a valley in the south-west over the ridges to the north-east.
const START: [f64; 2] = [0.08, 0.12];
const GOAL: [f64; 2] = [0.90, 0.88];

#[derive(Args)]
pub(crate) struct Arguments {
    /// Where to write the picture
    #[arg(long, default_value = "joulepath-demo.svg")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let began = Instant::now();
    let listener = TcpListener::bind("127.0.0.1:0").context("no free loopback port")?;
    let service = start(listener, Engine::new(Limits::default(), None)?)?;
    let url = format!("http://{}", service.address);
    output::line(format_args!("service    {url}, started in {:.0} ms", milliseconds(began)))?;

    let terrain = io::geotiff::read(MAP, Terrain::MAX_CELLS)?;
    let began = Instant::now();
    let stored: serde_json::Value = ureq::post(format!("{url}/v1/maps"))
        .content_type("image/tiff")
        .send(MAP)
        .context("POST /v1/maps")?
        .body_mut()
        .read_json()?;
    output::line(format_args!(
        "map        {} × {} cells of {} m, {:.0} to {:.0} m above the sea, posted in {:.0} ms",
        stored["rows"],
        stored["columns"],
        stored["cell_size_m"],
        stored["elevation_range_m"][0].as_f64().unwrap_or(f64::NAN),
        stored["elevation_range_m"][1].as_f64().unwrap_or(f64::NAN),
        milliseconds(began)
    ))?;

    let began = Instant::now();
    let place = |[east, north]: [f64; 2]| {
        let [x_m, y_m] = terrain.grid.at_fraction_m(east, north);
        json!({ "x_m": x_m, "y_m": y_m })
    };
    let answer: CompareAnswer = ureq::post(format!("{url}/v1/compare"))
        .send_json(json!({ "map_id": stored["id"], "robot": "husky-a200", "start": place(START), "goal": place(GOAL) }))
        .context("POST /v1/compare")?
        .body_mut()
        .with_config()
        .limit(LARGEST_ANSWER_BYTES)
        .read_json()?;
    output::line(format_args!(
        "compare    three best paths of a Husky A200 in {:.1} s\n",
        began.elapsed().as_secs_f64()
    ))?;
    output::line(format_args!("{}\n", table::compare(&answer)))?;
    write_picture(&arguments.out, &picture::draw(&terrain, &answer)?)?;
    output::line(format_args!("picture    {}", std::path::absolute(&arguments.out)?.display()))?;
    Ok(())
}

/// Three paths of a few thousand poses take about a megabyte.
const LARGEST_ANSWER_BYTES: u64 = 64 << 20;

fn write_picture(path: &Path, svg: &str) -> anyhow::Result<()> {
    std::fs::write(path, svg).with_context(|| format!("cannot write the picture to {}", path.display()))
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
