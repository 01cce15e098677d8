//! A trial on real drives from the first case drawn to the scoreboard.

use std::path::{Path, PathBuf};

use calibration::{Options, calibrate};
use model::{Robot, Sides, robot::Motors};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use recording::Recording;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::{
    Commitments, Diagnosis, Error, Outcome, PeerAnswer, Progress, Stage, Way, files,
    real::{
        Act, Border, Ground, Noise, Onset, Put, RealBoards, RealCase, RealKey, RealKind, RealPeerScore,
        RealScore, RealWayBoard, Split,
        board::{board, peers},
        csv,
        deal::{Begins, Wanted, deal},
        ground::nameless,
        score::score,
        splice::{longest_last, splice},
        split::split,
    },
    sealed,
    stage::each,
};

/// A trial on real drives.
pub struct RealTrial<'a> {
    /// Grounds that the robot was driven on.
    pub grounds: &'a [Ground],
    /// How many cases.
    pub cases: usize,
    /// Seed that they are dealt from.
    pub seed: u64,
    /// Strengths that changes are given, in standard deviations of the ideal detector.
    pub strengths_z: &'a [f64],
    /// The robot as its raw file has it.
    pub robot: &'a Robot,
    /// Where cases, keys and the scoreboard go.
    pub out: &'a Path,
    /// How to diagnose.
    pub diagnosis: Diagnosis,
    /// What it is given, in the order of [`Way::ALL`].
    pub ways: &'a [Way],
    /// Other methods, asked about the folder of each case.
    pub peers: &'a (dyn Fn(&Path) -> Vec<PeerAnswer> + Sync),
    /// Cases that are worked on at the same time.
    pub at_once: usize,
    /// Told of progress.
    pub progress: &'a Progress<'a>,
    /// Told the hash of the list of commitments as soon as it is published.
    pub published: &'a (dyn Fn(&str) + Sync),
}

/// Splits that are tried for a case, of which some can hold no border or have a healthy half that no robot can be fitted to.
const DRAWS: usize = 8;
/// Share of the driving after which a change that comes late sets in, as in the concealed trial.
const LATE_SHARES: [f64; 2] = [0.2, 0.6];
/// Share of its run after which a border lies.
const BORDER_SHARES: [f64; 2] = [0.4, 0.7];
/// Time that a run is on either side of a border at least [s]: longer than the stretches by which errors hang together.
const LEAST_SIDE_S: f64 = 20.0;

/// What a diagnosis is about, and what is true of it.
struct Drawn {
    robot: Robot,
    healthy: Recording,
    suspect: Recording,
    decimals: csv::Decimals,
    key: RealKey,
}

/// A healthy half, its robot, and the order in which the other runs are given.
struct Halves<'g> {
    ground: &'g Ground,
    split: Split,
    /// The raw file, off by what it states: what the diagnosis gets.
    raw: Robot,
    /// The robot fitted to the healthy half: what forces and strengths are worked out with.
    fitted: Robot,
}

/// What the diagnosis and the other methods said of a case.
type Said = (Vec<Outcome>, Vec<PeerAnswer>);

impl RealTrial<'_> {
    /// Runs it.
    ///
    /// # Errors
    /// Drives that no case can be made of; files that cannot be written; a key or case that changed between commitment and opening.
    pub fn run(&self) -> Result<RealBoards, Error> {
        let dealt = deal(self.cases, self.seed, self.grounds.len(), self.strengths_z);
        let raw = raw(self.robot, self.grounds)?;
        for folder in ["cases", "keys"] {
            files::folder(&self.out.join(folder))?;
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.at_once).build()?;
        let drawing = || each(self.progress, Stage::Drawing, &dealt, |case| self.seal(case, &raw));
        let keys = pool.install(drawing)?;
        let named = dealt.iter().zip(&keys).map(|(case, bytes)| (case.name.as_str(), bytes.as_slice()));
        let (commitments, commitment) = sealed::commit(&self.out.join("keys"), named)?;
        (self.published)(&commitment);
        let diagnosing = || each(self.progress, Stage::Diagnosing, &dealt, |case| self.diagnose(case));
        let said = pool.install(diagnosing)?;
        let pairs: Vec<(RealCase, Said)> = dealt.into_iter().zip(said).collect();
        let scores =
            each(self.progress, Stage::Scoring, &pairs, |(case, said)| self.open(case, said, &commitments))?;
        let of_way = |way: usize| -> Vec<RealScore> {
            scores.iter().filter_map(|of_case| of_case.get(way)).cloned().collect()
        };
        let way = |(i, way): (usize, &Way)| RealWayBoard { way: *way, board: board(of_way(i)) };
        let boards = RealBoards {
            cases: self.cases,
            seed: self.seed,
            commitment,
            ways: self.ways.iter().enumerate().map(way).collect(),
            peers: peers(&of_way(self.ways.len().saturating_sub(1))),
        };
        self.write(&boards)?;
        Ok(boards)
    }

    fn folder(&self, case: &RealCase) -> PathBuf {
        self.out.join("cases").join(&case.name)
    }

    fn key(&self, case: &RealCase) -> PathBuf {
        self.out.join("keys").join(sealed::file_name(&case.name))
    }

    /// Draws a case, writes what the diagnosis gets, and seals the key.
    fn seal(&self, case: &RealCase, raw: &Robot) -> Result<Vec<u8>, Error> {
        let mut random = Pcg64Mcg::seed_from_u64(case.seed);
        let mut drawn = self.draw(case, raw, &mut random);
        for _ in 1..DRAWS {
            if drawn.is_err() {
                drawn = self.draw(case, raw, &mut random);
            }
        }
        let Drawn { robot, healthy, suspect, decimals, key } = drawn.map_err(|source| Error::Drawing {
            case: case.name.clone(),
            ground: self.grounds[case.ground].name.clone(),
            source: Box::new(source),
        })?;
        let folder = self.folder(case);
        files::folder(&folder)?;
        let path = folder.join(files::ROBOT);
        let json = serde_json::to_string_pretty(&robot)
            .map_err(|source| Error::Content { path: path.clone(), source })?;
        files::write(&path, &(json + "\n"))?;
        csv::write(&suspect, &decimals, &folder.join(files::RECORDING))?;
        csv::write(&healthy, &decimals, &folder.join(files::REFERENCE))?;
        let key = RealKey { files: sealed::hashes(&folder)?, ..key };
        sealed::bytes(&key, &self.key(case))
    }

    fn draw(&self, case: &RealCase, raw: &Robot, random: &mut Pcg64Mcg) -> Result<Drawn, Error> {
        let halves = Halves::draw(&self.grounds[case.ground], raw, random)?;
        match (case.wanted, case.onto) {
            (Some(wanted), _) => halves.changed(case, wanted, random),
            (None, Some(onto)) => halves.spliced(case, &self.grounds[onto], random),
            (None, None) => Ok(halves.untouched(case)),
        }
    }

    fn diagnose(&self, case: &RealCase) -> Result<Said, Error> {
        let folder = self.folder(case);
        let outcomes = self.ways.iter().map(|way| self.diagnosis.run(&folder, *way));
        Ok((outcomes.collect::<Result<_, Error>>()?, (self.peers)(&folder)))
    }

    /// Opens a key and scores its case.
    fn open(
        &self,
        case: &RealCase,
        (outcomes, answers): &Said,
        commitments: &Commitments,
    ) -> Result<Vec<RealScore>, Error> {
        let key: RealKey = sealed::open(&self.key(case), commitments, &self.folder(case))?;
        let mut scores: Vec<RealScore> = outcomes.iter().map(|outcome| score(&key, outcome)).collect();
        // Other methods get what the last way gives.
        if let Some(last) = scores.last_mut() {
            last.peers = answers.iter().map(|answer| RealPeerScore::new(answer, &key)).collect();
        }
        Ok(scores)
    }

    fn write(&self, boards: &RealBoards) -> Result<(), Error> {
        let path = self.out.join(files::SCOREBOARD);
        let json = serde_json::to_string_pretty(boards)
            .map_err(|source| Error::Content { path: path.clone(), source })?;
        files::write(&path, &(json + "\n"))
    }
}

impl<'g> Halves<'g> {
    /// Splits the runs of a ground and fits the robot to the healthy half.
    fn draw(ground: &'g Ground, raw: &Robot, random: &mut Pcg64Mcg) -> Result<Self, Error> {
        let split = split(ground, random);
        let fitted = calibrate(raw, &ground.part(&split.healthy), &Options::default())?.robot;
        let fitted = with_force_of(raw, fitted);
        Ok(Halves { ground, split, raw: off_by_stated(raw, &fitted, random), fitted })
    }

    fn untouched(self, case: &RealCase) -> Drawn {
        let suspect = self.ground.part(&self.split.suspect);
        self.drawn(case, suspect, None, None)
    }

    fn changed(self, case: &RealCase, wanted: Wanted, random: &mut Pcg64Mcg) -> Result<Drawn, Error> {
        let suspect = self.ground.part(&self.split.suspect);
        let share = random.random_range(LATE_SHARES[0]..LATE_SHARES[1]);
        let onset = match wanted.begins {
            Begins::AtOnce => Onset::START,
            Begins::Later => Onset::after_share(&suspect, share),
        };
        let Wanted { change, z, direction, side, .. } = wanted;
        let noise = Noise::of(&self.fitted, &Recording { surface: None, ..self.ground.recording.clone() })?;
        let act = Act { change, size: 0.0, direction, side, onset };
        let (act, strength) = noise.sized(&self.fitted, &suspect, act, z)?;
        let changed = act.put_into(&self.fitted, &suspect)?;
        let put = Put { act, asked_z: z, z: strength.z, power_change: strength.power_change };
        Ok(self.drawn(case, changed, Some(put), None))
    }

    fn spliced(mut self, case: &RealCase, other: &Ground, random: &mut Pcg64Mcg) -> Result<Drawn, Error> {
        let order = longest_last(&self.ground.part(&self.split.suspect));
        self.split.suspect = order.iter().map(|i| self.split.suspect[*i]).collect();
        let cut = self.split.suspect.last().copied().unwrap_or_default();
        let share = random.random_range(BORDER_SHARES[0]..BORDER_SHARES[1]);
        let t_s = (share * self.ground.duration_s(cut)).round();
        let long = (0..other.recording.runs.len()).filter(|run| other.duration_s(*run) >= LEAST_SIDE_S);
        let long: Vec<usize> = long.collect();
        if t_s < LEAST_SIDE_S || long.is_empty() {
            return Err(Error::NoBorder { border_s: t_s });
        }
        let run = &other.recording.runs[long[random.random_range(0..long.len())]];
        let spliced = splice(&self.ground.part(&self.split.suspect), t_s, &other.recording, run)?;
        let name = format!("drive-{}", self.split.suspect.len());
        let border = Border { run: name, t_s, onto: other.name.clone() };
        Ok(self.drawn(case, spliced, None, Some(border)))
    }

    fn drawn(self, case: &RealCase, suspect: Recording, put: Option<Put>, border: Option<Border>) -> Drawn {
        let names =
            |runs: &[usize]| runs.iter().map(|run| self.ground.recording.runs[*run].name.clone()).collect();
        Drawn {
            healthy: nameless(self.ground.part(&self.split.healthy)),
            suspect: nameless(suspect),
            decimals: csv::decimals(&self.ground.recording),
            robot: self.raw,
            key: RealKey {
                case: case.name.clone(),
                kind: kind(put.as_ref(), border.as_ref()),
                seed: case.seed,
                ground: self.ground.name.clone(),
                healthy: names(&self.split.healthy),
                suspect: names(&self.split.suspect),
                put,
                border,
                files: Default::default(),
            },
        }
    }
}

/// Share of its stated uncertainty that a raw file is off by, one sigma, as robots of the concealed trial are.
const SCATTER: f64 = 0.5;

/// The raw file of a robot that a healthy half was fitted with: what it states is off by [`SCATTER`] of its stated uncertainty, and nothing
/// of what the fit learnt about its own error is left.
///
/// A file of another ground's constants would itself be a finding in every drive, and no drive by it in order.
fn off_by_stated(raw: &Robot, fitted: &Robot, random: &mut Pcg64Mcg) -> Robot {
    let mut factor = |sigma: f64| {
        let z = Normal::standard().inverse_cdf(random.random_range(f64::EPSILON..1.0));
        (SCATTER * sigma * z).exp()
    };
    let stated = raw.uncertainty;
    let mut off = Robot {
        uncertainty: stated,
        provenance: raw.provenance.clone(),
        posterior: None,
        model_error: raw.model_error.clone(),
        noise: None,
        ..fitted.clone()
    };
    for surface in off.surfaces.values_mut() {
        *surface = surface.scaled(factor(stated.mu_roll), factor(stated.mu_skid));
    }
    for motor in [&mut off.motors.left, &mut off.motors.right] {
        motor.k1_w_per_n2 *= factor(stated.k1);
        motor.k2 *= factor(stated.k2);
    }
    off.mass_kg *= factor(stated.mass_kg);
    off
}

/// A robot that shows the same currents as a fitted one, with the force per ampere of its raw file: level ground does not tell it, and a fit
/// may end anywhere. All friction is in proportion to it.
fn with_force_of(raw: &Robot, mut fitted: Robot) -> Robot {
    let forces = raw.motor_sides().zip(fitted.motor_sides());
    let ratio = forces.map(|(raw, fitted)| Some(raw.force_n_per_a? / fitted.force_n_per_a?));
    if let Sides { left: Some(left), right: Some(right) } = ratio {
        let ratio = (left + right) / 2.0;
        fitted.surfaces.values_mut().for_each(|surface| *surface = surface.scaled(ratio, ratio));
        fitted.motors.left.force_n_per_a = raw.motors.left.force_n_per_a;
        fitted.motors.right.force_n_per_a = raw.motors.right.force_n_per_a;
    }
    fitted
}

/// The raw file, with the force per ampere that all grounds together show where it has none.
///
/// Currents without it are no powers. It belongs to the robot and not to the ground, and level ground does not tell it.
fn raw(robot: &Robot, grounds: &[Ground]) -> Result<Robot, Error> {
    let Motors { left, right, .. } = &robot.motors;
    if left.force_n_per_a.is_some() && right.force_n_per_a.is_some() {
        return Ok(robot.clone());
    }
    let all = Recording::join(grounds.iter().map(Ground::labelled));
    let found = calibrate(robot, &all, &Options::default())?.robot.motors;
    let mut raw = robot.clone();
    raw.motors.left.force_n_per_a = left.force_n_per_a.or(found.left.force_n_per_a);
    raw.motors.right.force_n_per_a = right.force_n_per_a.or(found.right.force_n_per_a);
    Ok(raw)
}

fn kind(put: Option<&Put>, border: Option<&Border>) -> RealKind {
    match (put, border) {
        (Some(_), _) => RealKind::Changed,
        (None, Some(_)) => RealKind::Spliced,
        (None, None) => RealKind::Healthy,
    }
}
