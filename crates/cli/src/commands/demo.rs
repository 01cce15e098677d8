//! `joulepath demo`: the whole product in one go, over real terrain and through the running service.

mod savings;

use std::{net::TcpListener, path::PathBuf, time::Instant};

use anyhow::Context;
use clap::Args;
use model::{Robot, builtin, robot::RobotFile};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use service::{Engine, Limits, routes::compare::CompareAnswer, start};
use terrain::{Terrain, io};

use crate::{files, output, picture, scenes, table};

/// Bare-earth lidar of 400 m × 400 m in Minnesota; `maps/README.md` states its origin and licence.
const MAP: &[u8] = include_bytes!("../../../../maps/minnesota.tif");
/// Both ends as fractions of the map: from a valley in the south-west over the ridges to the north-east.
const START: [f64; 2] = [0.08, 0.12];
const GOAL: [f64; 2] = [0.90, 0.88];
/// A Husky A200 with its electronics on, on sandy loam, whose drivers give back half of what braking gives.
const ROBOT: &str = "husky-a200-field";
/// Three paths of a few thousand poses take about a megabyte.
const LARGEST_ANSWER_BYTES: u64 = 64 << 20;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Where to write the picture
    #[arg(long, default_value = "joulepath-demo.svg")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    files::check(&arguments.out)?;
    let began = Instant::now();
    let listener = TcpListener::bind("127.0.0.1:0").context("no free loopback port")?;
    let service = start(listener, Engine::new(Limits::default(), None)?)?;
    let url = format!("http://{}", service.address);
    output::line(format_args!("service    {url}, started in {:.0} ms", milliseconds(began)))?;

    let terrain = io::geotiff::read(MAP, Terrain::MAX_CELLS)?;
    let (robot, question) = (builtin::by_name(ROBOT)?, Question::on(url, &terrain)?);
    output::line(format_args!("robot      {} of {} kg", robot.name, robot.mass_kg))?;
    output::line(scenes::conditions(&terrain, &robot))?;
    let began = Instant::now();
    let answer: CompareAnswer = question.ask("compare", &robot, json!({}))?;
    output::line(format_args!("compare    three best paths in {:.1} s\n", began.elapsed().as_secs_f64()))?;
    output::line(format_args!("{}\n", table::compare(&answer)))?;
    output::line(savings::table(&question, &robot)?)?;
    let mut scene = scenes::compare(&terrain, &robot, &answer);
    scene.caption = "Minnesota, 1 m lidar: shaded relief, north up".to_owned();
    files::write(&arguments.out, picture::svg(&scene)?)?;
    output::line(format_args!("picture    {}", std::path::absolute(&arguments.out)?.display()))?;
    Ok(())
}

/// What is asked of the service for every robot.
struct Question {
    url: String,
    map_id: Value,
    ends: [Value; 2],
}

impl Question {
    /// Posts the map, and says how it went.
    fn on(url: String, terrain: &Terrain) -> anyhow::Result<Self> {
        let began = Instant::now();
        let stored: Value = ureq::post(format!("{url}/v1/maps"))
            .content_type("image/tiff")
            .send(MAP)
            .context("POST /v1/maps")?
            .body_mut()
            .read_json()?;
        let height_m = |i: usize| stored["elevation_range_m"][i].as_f64().unwrap_or(f64::NAN);
        output::line(format_args!(
            "map        {} × {} cells of {} m, {:.0} to {:.0} m above the sea, posted in {:.0} ms",
            stored["rows"],
            stored["columns"],
            stored["cell_size_m"],
            height_m(0),
            height_m(1),
            milliseconds(began)
        ))?;
        let place = |[east, north]: [f64; 2]| {
            let [x_m, y_m] = terrain.grid.at_fraction_m(east, north);
            json!({ "x_m": x_m, "y_m": y_m })
        };
        Ok(Question { url, map_id: stored["id"].clone(), ends: [START, GOAL].map(place) })
    }

    /// Asks for a robot's path or paths, with further fields of the request.
    fn ask<T: DeserializeOwned>(&self, route: &str, robot: &Robot, more: Value) -> anyhow::Result<T> {
        let [start, goal] = &self.ends;
        let mut request = json!({ "map_id": self.map_id, "robot": RobotFile::from(robot.clone()), "start": start, "goal": goal });
        if let (Some(request), Value::Object(more)) = (request.as_object_mut(), more) {
            request.extend(more);
        }
        let mut answer = ureq::post(format!("{}/v1/{route}", self.url))
            .send_json(request)
            .with_context(|| format!("POST /v1/{route}"))?;
        Ok(answer.body_mut().with_config().limit(LARGEST_ANSWER_BYTES).read_json()?)
    }
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
