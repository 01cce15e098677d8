//! Several robots in one file: all channels come from one of them.

use std::collections::{BTreeMap, BTreeSet};

use crate::{Error, Map, Target, map::Place, merge::Named};

/// Robots that are left aside, and the one that is taken.
pub(crate) struct Others {
    taken: String,
    others: BTreeSet<String>,
}

impl Others {
    /// Why a topic is not read, where it is another robot's.
    pub(crate) fn why_not(&self, topic: &str) -> Option<String> {
        let own = robot(topic)?;
        self.others.contains(own).then(|| format!("it is of robot `{own}`; `{}` is taken", self.taken))
    }
}

/// The first part of a topic's name: the robot's namespace, where the name has one.
fn robot(topic: &str) -> Option<&str> {
    let (first, rest) = topic.trim_start_matches('/').split_once('/')?;
    (!rest.is_empty()).then_some(first)
}

/// The robots that are not meant, where the same source matches topics of several: that which the map names is taken, else the only one that
/// tells both wheel speeds and power.
///
/// # Errors
/// [`Error::SeveralRobots`] where that is none or several.
pub(crate) fn others(map: &Map, streams: &[Named]) -> Result<Option<Others>, Error> {
    let mut told = BTreeMap::<&str, BTreeSet<&Target>>::new();
    let mut rivals = BTreeSet::new();
    for (index, source) in map.sources.iter().enumerate() {
        let Place::Topic { topic: pattern, .. } = &source.place else { continue };
        if !pattern.starts_with('*') {
            continue;
        }
        let mut of_source = BTreeSet::new();
        for named in streams {
            let column = named.sources.iter().position(|(source, _)| *source == index);
            let holds = column.is_some_and(|at| named.stream.columns[at].iter().any(|value| !value.is_nan()));
            if let (true, Some(own)) = (holds, robot(&named.topic)) {
                told.entry(own).or_default().insert(&source.target);
                of_source.insert(own);
            }
        }
        if of_source.len() > 1 {
            rivals.extend(of_source);
        }
    }
    if rivals.is_empty() {
        return Ok(None);
    }
    let is_whole = |own: &&&str| {
        let targets = &told[**own];
        let tells_power =
            |target: &&&Target| matches!(target, Target::Channel(channel) if channel.tells_power());
        targets.iter().filter(|target| target.is_wheel_speed()).count() == 2
            && targets.iter().any(|target| tells_power(&target))
    };
    let taken = match map.namespace.as_deref().map(|name| name.trim_matches('/')) {
        Some(name) => rivals.get(name).copied(),
        None => {
            let whole: Vec<&&str> = rivals.iter().filter(is_whole).collect();
            if let [one] = whole[..] { Some(*one) } else { None }
        }
    };
    let Some(taken) = taken else {
        return Err(Error::SeveralRobots {
            namespaces: rivals.iter().map(|own| format!("/{own}")).collect(),
        });
    };
    let others = rivals.iter().filter(|own| **own != taken).map(|own| (*own).to_owned()).collect();
    Ok(Some(Others { taken: taken.to_owned(), others }))
}
