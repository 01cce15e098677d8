//! A walk through a message's bytes that stops at the numbers wanted and steps over everything else.

use crate::{
    cursor::{Cursor, Dialect, Encoding, Short, Wide},
    definition::{Base, Count, Definition, Field, Primitive},
    field::{Angle, Pick, Resolved, Segment, resolve},
    packs,
    quaternion::Lengths,
    walk::{Found, Node, Picked},
};

/// Deepest nesting and most fields that a message may have; real ones stay below 10 and 300.
const DEEPEST: usize = 32;
const MOST_NODES: usize = 20_000;

/// The walk through one type of message.
#[derive(Debug)]
pub(crate) struct Layout {
    encoding: Encoding,
    root: Node,
    slots: usize,
    keys: usize,
    values: Vec<Value>,
    /// Slots of the header's seconds and nanoseconds.
    stamp: Option<[usize; 2]>,
    /// Whether it has wide texts, whose width only the end of a message tells.
    is_wide: bool,
    /// Whether the file leaves out a definition that it needs, so that only the end of a message tells whether it is right.
    pub(crate) is_standard: bool,
}

/// The type of messages that tell a simulation's time.
const CLOCK_TYPE: &str = "rosgraph_msgs/Clock";

/// Bytes up to which a message is padded by its writer.
const PADDING_BYTES: usize = 3;

#[derive(Clone, Copy, Debug)]
struct Value {
    kind: ValueKind,
    /// The slot of the first covariance, which `sensor_msgs/Imu` sets to −1 where the value is not known.
    unknown_when_negative: Option<usize>,
}

#[derive(Clone, Copy, Debug)]
enum ValueKind {
    Slot(usize),
    /// Texts, as one number.
    Texts([Option<usize>; packs::NAMES.len()]),
    Angle([usize; 4], Angle, Lengths),
}

/// A number wanted: the rest of its path, and the slots that it goes to.
#[derive(Clone, Debug)]
struct Want<'p> {
    path: &'p [Segment],
    slots: [usize; 2],
}

impl Layout {
    /// Plans the walk; every path must exist in the definition. With `names`, one number more tells which pack a message is of.
    pub(crate) fn new(
        definition: &Definition,
        paths: &[&str],
        names: bool,
        encoding: Encoding,
    ) -> Result<Layout, (String, String)> {
        let mut plan: Vec<(Vec<Segment>, [usize; 2])> = Vec::new();
        let mut slots = 0;
        let mut slot = |path: Vec<Segment>| {
            // Roll and pitch want the same four numbers.
            if let Some((_, [known, _])) = plan.iter().find(|(planned, _)| *planned == path) {
                return *known;
            }
            slots += 1;
            plan.push((path, [slots - 1; 2]));
            slots - 1
        };
        let mut values = Vec::new();
        for &path in paths {
            let (kind, root) = match resolve(definition, path).map_err(|reason| (path.to_owned(), reason))? {
                Resolved::Number(segments) => {
                    let root = segments.first().cloned();
                    (ValueKind::Slot(slot(segments)), root)
                }
                Resolved::Angle(segments, angle) => {
                    let part = |name: &str| {
                        let last = Segment { name: name.into(), pick: None };
                        segments.iter().cloned().chain([last]).collect()
                    };
                    let parts = ["x", "y", "z", "w"].map(part);
                    (ValueKind::Angle(parts.map(&mut slot), angle, Lengths::NONE), segments.first().cloned())
                }
            };
            let covariance = root.and_then(|root| covariance(definition, &root.name));
            values.push(Value { kind, unknown_when_negative: covariance.map(&mut slot) });
        }
        if names {
            let texts = packs::NAMES.map(|path| text(definition, path).map(&mut slot));
            values.push(Value { kind: ValueKind::Texts(texts), unknown_when_negative: None });
        }
        let stamp = stamp_names(definition).map(|names| {
            let path = names.iter().map(|name| Segment { name: (*name).into(), pick: None }).collect();
            plan.push((path, [slots, slots + 1]));
            slots += 2;
            [slots - 2, slots - 1]
        });
        let wants = plan.iter().map(|(path, slots)| Want { path, slots: *slots }).collect::<Vec<_>>();
        let is_standard = !definition.holds(definition.name());
        let mut builder = Builder { definition, encoding, nodes: 0, keys: 0, is_wide: false, is_standard };
        let root = builder.message(definition.root(), &wants, 0).map_err(|reason| (String::new(), reason))?;
        let Builder { keys, is_wide, is_standard, .. } = builder;
        Ok(Layout { encoding, root: Node::Message(root), slots, keys, values, stamp, is_wide, is_standard })
    }

    /// Whether its messages have a time of their own.
    pub(crate) fn has_stamp(&self) -> bool {
        self.stamp.is_some()
    }

    /// Whether its messages are CDR, whose header no compressed one has.
    pub(crate) fn is_cdr(&self) -> bool {
        self.encoding == Encoding::Cdr
    }

    /// Reads a message into `values`, one per path, NaN where it has none; returns its stamp \[ns\].
    pub(crate) fn read(
        &mut self,
        bytes: &[u8],
        found: &mut Found,
        values: &mut [f64],
    ) -> Result<Option<i64>, String> {
        let cursor = Cursor::message(bytes, self.encoding)?;
        self.find(cursor, bytes.len(), found)?;
        for (value, wanted) in values.iter_mut().zip(&mut self.values) {
            *value = wanted.of(&found.slots);
        }
        // Seconds and nanoseconds are whole numbers below 2³², which doubles hold exactly.
        let [seconds, nanoseconds] = self.stamp.unwrap_or_default().map(|slot| found.slots.get(slot));
        let whole = |part: Option<&f64>| part.map(|part| *part as i64);
        let stamp = whole(seconds)
            .zip(whole(nanoseconds))
            .and_then(|(s, ns)| s.checked_mul(1_000_000_000)?.checked_add(ns));
        Ok(stamp.filter(|_| self.stamp.is_some()))
    }

    /// What has to be said of the orientations that were read.
    pub(crate) fn told(&self) -> Option<String> {
        let of_angle =
            |value: &Value| if let ValueKind::Angle(.., lengths) = value.kind { Some(lengths) } else { None };
        self.values.iter().filter_map(of_angle).max_by_key(Lengths::count)?.told()
    }
}

impl Layout {
    /// Finds the numbers wanted. Where more than one way of writing fits the header, that one which meets the message's end.
    fn find(&self, cursor: Cursor<'_>, bytes: usize, found: &mut Found) -> Result<(), String> {
        let short = |Short| format!("its {bytes} bytes end too soon");
        if !self.is_wide && !self.is_standard && !cursor.is_second {
            return self.walk(cursor, found, false).map(|_| ()).map_err(short);
        }
        let widths = if self.is_wide { &[Wide::Four, Wide::Two, Wide::Counted][..] } else { &[Wide::Four] };
        let lengths = if cursor.is_second { &[true, false][..] } else { &[true] };
        for (&wide, &collection_lengths) in widths.iter().flat_map(|w| lengths.iter().map(move |l| (w, l))) {
            let mut tried = cursor;
            tried.dialect = Dialect { wide, collection_lengths };
            if self.walk(tried, found, true).is_ok_and(|left| left <= PADDING_BYTES) {
                return Ok(());
            }
        }
        if self.is_standard {
            return Err(format!(
                "its {bytes} bytes are not those of the standard definition, and the file holds none of its own"
            ));
        }
        // What is wanted may lie before all that is open.
        self.walk(cursor, found, false).map_err(short)?;
        match found.is_guess {
            true => Err("it has a `wstring` before what is wanted, of a width that is not known".into()),
            false => Ok(()),
        }
    }

    /// Walks to the last number wanted, or to the message's end; returns how many bytes are left.
    fn walk(&self, mut cursor: Cursor<'_>, found: &mut Found, to_the_end: bool) -> Result<usize, Short> {
        found.slots.clear();
        found.slots.resize(self.slots, f64::NAN);
        found.keys.clear();
        found.keys.resize(self.keys, None);
        found.wanted = self.slots + usize::from(to_the_end);
        found.is_guess = false;
        self.root.walk(&mut cursor, found)?;
        Ok(cursor.left())
    }
}

impl Value {
    fn of(&mut self, slots: &[f64]) -> f64 {
        if self.unknown_when_negative.is_some_and(|slot| slots[slot] == -1.0) {
            return f64::NAN;
        }
        let value = match &mut self.kind {
            ValueKind::Slot(slot) => slots[*slot],
            // Texts that are told one by one: places keep them apart.
            ValueKind::Texts(texts) => {
                let told = texts.iter().flatten().zip(1..);
                told.map(|(slot, place)| f64::from(place) * slots[*slot])
                    .filter(|text| text.is_finite())
                    .sum()
            }
            ValueKind::Angle(parts, angle, lengths) => lengths
                .rotation(parts.map(|slot| slots[slot]))
                .map_or(f64::NAN, |rotation| angle.of(rotation)),
        };
        // An infinity is no measurement: drivers use it as NaN.
        if value.is_finite() { value } else { f64::NAN }
    }
}

/// The path of a text in a definition, where it has one.
fn text(definition: &Definition, path: &str) -> Option<Vec<Segment>> {
    let mut fields = Some(definition.root());
    let mut segments = Vec::new();
    for name in path.split('.') {
        let field = fields?.iter().find(|field| field.name == name && field.count == Count::One)?;
        segments.push(Segment { name: name.to_owned(), pick: None });
        fields = match &field.base {
            Base::Text => return Some(segments),
            Base::Message(name) => definition.fields(name),
            _ => return None,
        };
    }
    None
}

/// The path of the first element of the covariance that belongs to a field of the message.
fn covariance(definition: &Definition, field: &str) -> Option<Vec<Segment>> {
    let name = format!("{field}_covariance");
    let there = |field: &&Field| field.name == name && matches!(field.base, Base::Number(_));
    definition.root().iter().find(there).filter(|field| field.count != Count::One)?;
    Some(vec![Segment { name, pick: Some(Pick::At(0)) }])
}

/// Where a message has its time: in its header, or as a clock's.
fn stamp_names(definition: &Definition) -> Option<&'static [&'static str]> {
    let is_time = |field: &Field| field.base == Base::Time && field.count == Count::One;
    let is_clock = |field: &Field| field.name == "clock" && is_time(field);
    if definition.name() == CLOCK_TYPE && definition.root().iter().any(is_clock) {
        return Some(&["clock"]);
    }
    let header = definition.root().iter().find(|field| field.name == "header" && field.count == Count::One);
    let Some(Base::Message(name)) = header.map(|field| &field.base) else { return None };
    let is_stamp = |field: &Field| field.name == "stamp" && is_time(field);
    definition.fields(name)?.iter().any(is_stamp).then_some(&["header", "stamp"])
}

struct Builder<'d> {
    definition: &'d Definition,
    encoding: Encoding,
    nodes: usize,
    keys: usize,
    is_wide: bool,
    is_standard: bool,
}

impl Builder<'_> {
    fn message(&mut self, fields: &[Field], wants: &[Want<'_>], depth: usize) -> Result<Vec<Node>, String> {
        if depth > DEEPEST {
            return Err("its definition nests too deeply".into());
        }
        if fields.is_empty() && self.encoding == Encoding::Cdr {
            // ROS 2 gives a message without fields one byte: the OMG IDL that it becomes has no empty structs.
            return Ok(vec![Node::Number(Primitive::U8, None)]);
        }
        let mut nodes = Vec::with_capacity(fields.len());
        // Texts that pick elements of the arrays behind: (text array, text, key).
        let mut keys: Vec<(&str, &str, usize)> = Vec::new();
        for want in wants {
            if let Some(Segment { pick: Some(Pick::Named { array, text }), .. }) = want.path.first()
                && !keys.iter().any(|(a, t, _)| a == array && t == text)
            {
                keys.push((array, text, self.keys));
                self.keys += 1;
            }
        }
        for field in fields {
            nodes.push(self.field(field, wants, &keys, depth)?);
        }
        Ok(nodes)
    }

    fn field(
        &mut self,
        field: &Field,
        wants: &[Want<'_>],
        keys: &[(&str, &str, usize)],
        depth: usize,
    ) -> Result<Node, String> {
        self.nodes += 1;
        if self.nodes > MOST_NODES {
            return Err("its definition has too many fields".into());
        }
        let mut wanted: Vec<(Option<Pick>, Want<'_>)> = Vec::new();
        for want in wants {
            if let Some((segment, rest)) = want.path.split_first()
                && segment.name == field.name
            {
                wanted.push((segment.pick.clone(), Want { path: rest, slots: want.slots }));
            }
        }
        if field.count == Count::One {
            let wants: Vec<Want<'_>> = wanted.into_iter().map(|(_, want)| want).collect();
            return self.one(&field.base, &wants, depth);
        }
        let element = Box::new(self.one(&field.base, &[], depth)?);
        let mut picks = Vec::new();
        for (pick, want) in wanted {
            let picked = match pick {
                Some(Pick::At(place)) => Picked::At(place),
                Some(Pick::Named { array, text }) => {
                    let key = keys.iter().find(|(a, t, _)| *a == array && *t == text).map(|(_, _, key)| *key);
                    Picked::Key(key.ok_or("its keys were not planned")?)
                }
                None => return Err(format!("`{}` is an array", field.name)),
            };
            picks.push((picked, self.one(&field.base, &[want], depth)?));
        }
        let looked_for = keys.iter().filter(|(array, ..)| *array == field.name);
        Ok(Node::Array {
            count: if let Count::Fixed(count) = field.count { Some(count) } else { None },
            element,
            picks,
            keys: looked_for.map(|(_, text, key)| ((*text).to_owned(), *key)).collect(),
        })
    }

    fn one(&mut self, base: &Base, wants: &[Want<'_>], depth: usize) -> Result<Node, String> {
        let slots = wants.iter().find(|want| want.path.is_empty()).map(|want| want.slots);
        Ok(match base {
            Base::Number(primitive) => Node::Number(*primitive, slots.map(|slots| slots[0])),
            Base::Text => Node::Text(slots.map(|slots| slots[0])),
            Base::WideText => {
                self.is_wide = true;
                Node::WideText
            }
            Base::Time => Node::Time(slots),
            Base::Message(name) => {
                let fields = self.definition.fields(name);
                let fields = fields.ok_or_else(|| format!("its definition lacks {name}"))?;
                self.is_standard |= !self.definition.holds(name);
                Node::Message(self.message(fields, wants, depth + 1)?)
            }
        })
    }
}
