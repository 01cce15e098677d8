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
pub(crate) fn others(map: &Map, streams: &[Named], names: &[String]) -> Result<Option<Others>, Error> {
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
        rivals = strangers(map, &told, names);
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

/// Robots of which one tells the wheel speeds and the other the power, so that no robot tells both. Parts of one robot have namespaces too:
/// of different robots are those whose names differ by a number alone, or that both have a topic by which the map tells wheel speeds.
fn strangers<'s>(
    map: &Map,
    told: &BTreeMap<&'s str, BTreeSet<&Target>>,
    names: &[String],
) -> BTreeSet<&'s str> {
    let power = |target: &Target| matches!(target, Target::Channel(channel) if channel.tells_power());
    let with = |is: &dyn Fn(&Target) -> bool| -> Vec<&'s str> {
        told.iter()
            .filter(|(_, targets)| targets.iter().any(|target| is(target)))
            .map(|(own, _)| *own)
            .collect()
    };
    let (wheels, powers) = (with(&Target::is_wheel_speed), with(&power));
    if wheels.iter().any(|own| powers.contains(own)) {
        return BTreeSet::new();
    }
    let are_strangers = |one: &str, other: &str| {
        is_alike_but_for_a_number(one, other) || {
            let of_wheels = map.sources.iter().filter(|source| source.target.is_wheel_speed());
            let patterns = of_wheels.filter_map(|source| match &source.place {
                Place::Topic { topic, .. } => topic.strip_prefix('*'),
                Place::Columns(_) => None,
            });
            let has = |own: &str, rest: &str| {
                names.iter().any(|name| robot(name) == Some(own) && name.ends_with(rest))
            };
            patterns.into_iter().any(|rest| has(one, rest) && has(other, rest))
        }
    };
    let pairs = wheels.iter().flat_map(|one| powers.iter().map(move |other| (*one, *other)));
    pairs.filter(|(one, other)| are_strangers(one, other)).flat_map(|(one, other)| [one, other]).collect()
}

fn is_alike_but_for_a_number(one: &str, other: &str) -> bool {
    let without = |name: &str| name.chars().filter(|sign| !sign.is_ascii_digit()).collect::<String>();
    one != other && without(one) == without(other)
}
