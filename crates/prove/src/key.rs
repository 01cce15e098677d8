//! The key of a case: what is true of it, and which files it speaks of.

use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};
use world::{Case, CaseKind, Drive, EffectName, Family, RobotFile, World};

use crate::{Commitments, Dealt, Error, sealed};

/// What kind of case it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Nothing concealed.
    Healthy,
    /// Nothing concealed, but it looks as if.
    Decoy,
    /// One effect of the list.
    One,
    /// Two effects of the list.
    Two,
    /// An effect that no name stands for.
    Unlisted,
}

/// What is kept apart until all diagnoses have ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SealedKey {
    /// The case.
    pub case: String,
    /// What kind it is.
    pub kind: Kind,
    /// The strength asked for, as a share of power.
    pub share: f64,
    /// Seed it was drawn from; secret, so that a hash cannot be guessed at.
    pub seed: u64,
    /// What is true.
    pub truths: Vec<Truth>,
    /// SHA-256 of the files that the diagnosis gets.
    pub files: BTreeMap<String, String>,
    /// The world with its effects.
    pub world: World,
    /// The drive through it.
    pub drive: Drive,
}

/// One effect as it was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// Its name.
    pub effect: EffectName,
    /// Physics, measurement, or none that is listed.
    pub family: Family,
    /// Its size.
    pub parameters: Vec<Parameter>,
    /// From when on it acted [s].
    pub onset_s: f64,
    /// Root mean square change of power over its mean, as it came out.
    pub power_change: f64,
}

/// A quantity of an effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// What is measured.
    pub name: String,
    /// How much.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

impl SealedKey {
    /// The key of a case whose files lie in a folder.
    ///
    /// # Errors
    /// Files that cannot be read; a world that cannot be driven.
    pub fn seal(dealt: &Dealt, case: &Case, robot: &RobotFile, folder: &Path) -> Result<Self, Error> {
        let world_error = |source| Error::World { case: dealt.name.clone(), source };
        let truths = case.key(robot).map_err(world_error)?.truths.into_iter().map(Truth::of).collect();
        Ok(SealedKey {
            case: dealt.name.clone(),
            kind: Kind::of(dealt.kind),
            share: dealt.share,
            seed: dealt.seed,
            truths,
            files: sealed::hashes(folder)?,
            world: case.world.clone(),
            drive: case.drive.clone(),
        })
    }

    /// The file that it is kept in.
    ///
    /// # Errors
    /// Numbers that JSON cannot hold.
    pub fn bytes(&self, path: &Path) -> Result<Vec<u8>, Error> {
        sealed::bytes(self, path)
    }

    /// Opens a key, if it is the one that was committed to and its case's files are those that it speaks of.
    ///
    /// # Errors
    /// A key or a file that has changed.
    pub fn open(path: &Path, commitments: &Commitments, folder: &Path) -> Result<Self, Error> {
        sealed::open(path, commitments, folder)
    }
}

impl sealed::Sealed for SealedKey {
    fn files(&self) -> &BTreeMap<String, String> {
        &self.files
    }
}

impl Kind {
    fn of(kind: CaseKind) -> Self {
        match kind {
            CaseKind::Healthy => Kind::Healthy,
            CaseKind::Decoy => Kind::Decoy,
            CaseKind::One(name) if name.family() == Family::Unlisted => Kind::Unlisted,
            CaseKind::One(_) => Kind::One,
            CaseKind::Two(..) => Kind::Two,
        }
    }

    /// Whether something is concealed.
    pub fn conceals(self) -> bool {
        !matches!(self, Kind::Healthy | Kind::Decoy)
    }
}

impl Truth {
    fn of(truth: world::Truth) -> Self {
        let parameter = |p: world::TruthParameter| Parameter {
            name: p.name.to_owned(),
            value: p.value,
            unit: p.unit.to_owned(),
        };
        Truth {
            effect: truth.effect,
            family: truth.family,
            parameters: truth.parameters.into_iter().map(parameter).collect(),
            onset_s: truth.onset_s,
            power_change: truth.power_change,
        }
    }
}
