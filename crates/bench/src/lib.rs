//! What the planner takes, and what general-purpose searches take on the same graphs, measured in one run.
//!
//! Speeds depend on the machine and on what else it does; ratios between rows of one run hardly do.

mod case;
mod error;
mod parts;
mod peers;
mod scene;

use serde::Serialize;
use terrain::Terrain;

pub use case::Case;
pub use error::Error;
pub use parts::Parts;
pub use peers::Peer;
use scene::{Ground, Scene};

/// Everything that one run measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Plans by size of the map, kind of ground and bound.
    pub cases: Vec<Case>,
    /// General-purpose searches on the smallest maps.
    pub peers: Vec<Peer>,
    /// What plans are made of, by size of the map.
    pub parts: Vec<Parts>,
    /// Cores at hand; everything but `parts.two_core_ratio` runs on one.
    pub cores: usize,
}

/// Sides of the maps that are measured when no other is asked for [cells].
pub const SIDES: [usize; 4] = [250, 500, 1000, 2000];
/// Largest side on which the exact field over all headings is measured [cells].
const LARGEST_EXACT: usize = 1000;
/// Largest side on which peers search [cells]: an explicit graph of 1000 × 1000 cells takes more memory than many machines have.
const LARGEST_PEER: usize = 500;

/// Measures maps of the given sides, made of a terrain that is mirrored to size; `progress` hears what comes next.
///
/// # Errors
/// A terrain that the built-in Husky cannot cross from corner to corner.
pub fn run(tile: &Terrain, sides: &[usize], mut progress: impl FnMut(&str)) -> Result<Report, Error> {
    let one_core =
        rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| Error::Threads(e.to_string()))?;
    let mut report = Report {
        cases: Vec::new(),
        peers: Vec::new(),
        parts: Vec::new(),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
    };
    for &side in sides {
        for ground in [Ground::Relief, Ground::Obstacles] {
            progress(&format!("{side} × {side} cells, {}", ground.name()));
            let scene = Scene::new(tile, side, ground)?;
            one_core.install(|| measure(&scene, &mut report))?;
            if ground == Ground::Relief {
                progress(&format!("{side} × {side} cells, batches"));
                let ratio = parts::batch_ratio(&scene)?;
                if let Some(parts) = report.parts.last_mut() {
                    parts.all_cores_ratio = ratio;
                }
            }
        }
    }
    Ok(report)
}

fn measure(scene: &Scene, report: &mut Report) -> Result<(), Error> {
    let built = parts::build(scene)?;
    let cases = case::measure(scene, &built)?;
    if scene.ground == Ground::Relief {
        report.parts.push(parts::measure(scene, &built, scene.side <= LARGEST_EXACT)?);
        if scene.side <= LARGEST_PEER
            && let Some(exact) = cases.iter().find(|case| case.bound == 1.0)
        {
            report.peers.extend(peers::measure(scene, &built, exact)?);
        }
    }
    report.cases.extend(cases);
    Ok(())
}
