//! A trial from the first case drawn to the scoreboard.

use std::path::{Path, PathBuf};

use world::{Case, RobotFile, World, simulate};

use crate::{
    Boards, CaseScore, Commitments, Dealt, Diagnosis, Error, Kind, Misled, Outcome, PeerAnswer, PeerScore,
    Progress, SealedKey, Stage, Twin, Way, WayBoard, deal, files, score, scoreboard, sealed, stage::each,
    strength::z,
};

/// A trial.
pub struct Trial<'a> {
    /// How many cases.
    pub cases: usize,
    /// Seed that they are dealt from.
    pub seed: u64,
    /// The only kind of case that is dealt, if not all are.
    pub only: Option<Kind>,
    /// How strong all effects are, as a share of power, if they are not of all strengths.
    pub share: Option<f64>,
    /// The robot when it is healthy, as its file says.
    pub robot_json: &'a str,
    /// Where everything is written.
    pub out: &'a Path,
    /// How to diagnose.
    pub diagnosis: Diagnosis,
    /// What it is given, in the order of [`Way::ALL`].
    pub ways: &'a [Way],
    /// Other methods, asked about the folder of each case.
    pub peers: &'a (dyn Fn(&Path) -> Vec<PeerAnswer> + Sync),
    /// Cases that are worked on at the same time.
    pub at_once: usize,
    /// Told of progress: stage, cases done, cases in all.
    pub progress: &'a Progress<'a>,
    /// Told the hash of the list of commitments as soon as it is published.
    pub published: &'a (dyn Fn(&str) + Sync),
}

/// Seeds tried for a case whose drive leaves the ground or cannot be made.
const DRAWS: u64 = 5;

impl Trial<'_> {
    /// Runs it.
    ///
    /// # Errors
    /// Files that cannot be written; a key or case that changed between commitment and opening.
    pub fn run(&self) -> Result<Boards, Error> {
        let robot = RobotFile::from_json(self.robot_json).map_err(Error::Robot)?;
        let dealt = deal(self.cases, self.seed, self.only, self.share);
        for folder in ["cases", "keys", "twins"] {
            files::folder(&self.out.join(folder))?;
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.at_once).build()?;
        let keys =
            pool.install(|| each(self.progress, Stage::Drawing, &dealt, |dealt| self.draw(dealt, &robot)))?;
        let (commitments, commitment) = self.commit(&dealt, &keys)?;
        let outcomes = pool.install(|| {
            each(self.progress, Stage::Diagnosing, &dealt, |dealt| {
                let case = self.case(dealt);
                let outcomes = self.ways.iter().map(|way| self.diagnosis.run(&case, *way));
                Ok((outcomes.collect::<Result<_, Error>>()?, (self.peers)(&case)))
            })
        })?;
        let pairs: Vec<(Dealt, Said)> = dealt.into_iter().zip(outcomes).collect();
        let scores = pool.install(|| {
            each(self.progress, Stage::Scoring, &pairs, |(dealt, said)| {
                self.open(dealt, said, &commitments, &robot)
            })
        })?;
        let board = |way: usize| {
            let own = scores.iter().filter_map(|of_case| of_case.get(way)).cloned().collect();
            scoreboard(self.seed, commitment.clone(), own)
        };
        let ways: Vec<WayBoard> =
            self.ways.iter().enumerate().map(|(i, way)| WayBoard { way: *way, board: board(i) }).collect();
        let boards = Boards { most: board(self.ways.len().saturating_sub(1)), ways };
        self.write(&boards)?;
        Ok(boards)
    }

    fn case(&self, dealt: &Dealt) -> PathBuf {
        self.out.join("cases").join(&dealt.name)
    }

    fn key(&self, dealt: &Dealt) -> PathBuf {
        self.out.join("keys").join(sealed::file_name(&dealt.name))
    }

    /// Draws a case, writes what the diagnosis gets, and seals the key.
    fn draw(&self, dealt: &Dealt, robot: &RobotFile) -> Result<Vec<u8>, Error> {
        let world_error = |source| Error::World { case: dealt.name.clone(), source };
        // A strong effect may tip over what it is found by; what cannot be driven is drawn again.
        let draw = |another: u64| {
            let case = Case::draw(dealt.seed.wrapping_add(another), dealt.kind, dealt.share, robot)?;
            simulate(&case.world, robot, &case.drive).map(|suspect| (case, suspect))
        };
        let mut drawn = draw(0);
        for another in 1..DRAWS {
            if drawn.is_err() {
                drawn = draw(another);
            }
        }
        let (case, suspect) = drawn.map_err(world_error)?;
        let folder = self.case(dealt);
        files::folder(&folder)?;
        files::write(&folder.join(files::ROBOT), self.robot_json)?;
        files::write_log(&suspect, &folder.join(files::RECORDING))?;
        let healthy = case.reference(robot).map_err(world_error)?;
        files::write_log(&healthy, &folder.join(files::REFERENCE))?;
        SealedKey::seal(dealt, &case, robot, &folder)?.bytes(&self.key(dealt))
    }

    /// Writes the keys and publishes their hashes, before anything is diagnosed.
    fn commit(&self, dealt: &[Dealt], keys: &[Vec<u8>]) -> Result<(Commitments, String), Error> {
        let named = dealt.iter().zip(keys).map(|(dealt, bytes)| (dealt.name.as_str(), bytes.as_slice()));
        let (commitments, commitment) = sealed::commit(&self.out.join("keys"), named)?;
        (self.published)(&commitment);
        Ok((commitments, commitment))
    }

    /// Opens a key and scores its case.
    fn open(
        &self,
        dealt: &Dealt,
        (outcomes, answers): &Said,
        commitments: &Commitments,
        robot: &RobotFile,
    ) -> Result<Vec<CaseScore>, Error> {
        let case = self.case(dealt);
        let key = SealedKey::open(&self.key(dealt), commitments, &case)?;
        let (strengths_z, twins) =
            if key.kind.conceals() { self.twin(&key, &case, robot)? } else { (Vec::new(), Vec::new()) };
        let scored = outcomes.iter().enumerate().map(|(i, outcome)| {
            let mut scored = score(&key, &strengths_z, outcome, twins.get(i).cloned());
            // They get what the last way gives.
            if i + 1 == outcomes.len() {
                scored.peers = answers.iter().map(|answer| PeerScore::new(answer, &key)).collect();
            }
            scored
        });
        Ok(scored.collect())
    }

    /// The same drive without the effects: how strong each of them is, and what the diagnosis says where there is none.
    fn twin(&self, key: &SealedKey, case: &Path, robot: &RobotFile) -> Result<(Vec<f64>, Vec<Twin>), Error> {
        let drive = |world: &World| {
            simulate(world, robot, &key.drive)
                .map_err(|source| Error::World { case: key.case.clone(), source })
        };
        let plain = drive(&key.world.without_effects())?;
        let strength = |effect: &world::Effect| {
            let alone = World { effects: vec![effect.clone()], ..key.world.clone() };
            let is_fault = effect.effect.family() == world::Family::Measurement;
            let misled = if is_fault { Misled::Yes } else { Misled::No };
            Ok(z(&drive(&alone)?, &plain, robot, misled))
        };
        let strengths_z = key.world.effects.iter().map(strength).collect::<Result<_, Error>>()?;
        let folder = self.out.join("twins").join(&key.case);
        files::folder(&folder)?;
        files::write_log(&plain, &folder.join(files::RECORDING))?;
        let is_there = |name: &&str| case.join(name).is_file();
        for name in [files::ROBOT, files::REFERENCE, files::CALIBRATED].into_iter().filter(is_there) {
            files::copy(&case.join(name), &folder.join(name))?;
        }
        let twins = self.ways.iter().map(|way| Ok(Twin::new(&self.diagnosis.run(&folder, *way)?)));
        Ok((strengths_z, twins.collect::<Result<_, Error>>()?))
    }

    fn write(&self, boards: &Boards) -> Result<(), Error> {
        let path = self.out.join(files::SCOREBOARD);
        let json = serde_json::to_string_pretty(boards)
            .map_err(|source| Error::Content { path: path.clone(), source })?;
        files::write(&path, &(json + "\n"))
    }
}

/// What the diagnosis and the other methods said of a case.
type Said = (Vec<Outcome>, Vec<PeerAnswer>);
