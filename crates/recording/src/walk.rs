//! The steps of a walk through a message's bytes.

use crate::{
    cursor::{Cursor, Short},
    definition::Primitive,
    packs,
};

/// One step: over bytes, into a slot, or through what they contain.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    Number(Primitive, Option<usize>),
    /// A text, of which a number that stands for it may be wanted.
    Text(Option<usize>),
    WideText,
    /// Seconds and nanoseconds; wanted together.
    Time(Option<[usize; 2]>),
    Message(Vec<Node>),
    Array {
        count: Option<usize>,
        element: Box<Node>,
        picks: Vec<(Picked, Node)>,
        /// Texts looked for among the elements, and under which key their place is kept.
        keys: Vec<(String, usize)>,
    },
}

/// Which element of an array is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Picked {
    At(usize),
    Key(usize),
}

/// What a walk has found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    pub(crate) slots: Vec<f64>,
    pub(crate) keys: Vec<Option<usize>>,
    /// Slots that are still to be filled.
    pub(crate) wanted: usize,
    /// Whether a wide text was stepped over, by a width that may be wrong.
    pub(crate) is_guess: bool,
}

impl Node {
    /// Walks over its bytes and keeps what is wanted.
    pub(crate) fn walk(&self, cursor: &mut Cursor<'_>, found: &mut Found) -> Result<(), Short> {
        match self {
            Node::Number(primitive, None) => {
                cursor.align(primitive.bytes())?;
                cursor.skip(primitive.bytes())
            }
            Node::Number(primitive, Some(slot)) => {
                let value = primitive.read(cursor)?;
                found.keep(*slot, value);
                Ok(())
            }
            Node::Text(None) => cursor.text().map(|_| ()),
            Node::Text(Some(slot)) => {
                let text = cursor.text()?;
                found.keep(*slot, packs::number(text));
                Ok(())
            }
            Node::WideText => {
                found.is_guess |= cursor.wide_text()?;
                Ok(())
            }
            Node::Time(slots) => {
                cursor.struct_length()?;
                let (seconds, nanoseconds) = (cursor.u32()?, cursor.u32()?);
                if let Some([first, second]) = slots {
                    found.keep(*first, f64::from(seconds));
                    found.keep(*second, f64::from(nanoseconds));
                }
                Ok(())
            }
            Node::Message(nodes) => {
                cursor.struct_length()?;
                for node in nodes {
                    node.walk(cursor, found)?;
                    if found.wanted == 0 {
                        return Ok(());
                    }
                }
                Ok(())
            }
            Node::Array { count, element, picks, keys } => {
                if !matches!(**element, Node::Number(..)) {
                    cursor.collection_length()?;
                }
                let count = match count {
                    Some(count) => *count,
                    None => cursor.u32()? as usize,
                };
                Node::walk_array(count, element, picks, keys, cursor, found)
            }
        }
    }

    fn walk_array(
        count: usize,
        element: &Node,
        picks: &[(Picked, Node)],
        keys: &[(String, usize)],
        cursor: &mut Cursor<'_>,
        found: &mut Found,
    ) -> Result<(), Short> {
        if count == 0 || element.is_empty() {
            return Ok(());
        }
        // Every element has at least one byte, so a count that lies is caught before it costs time.
        if count > cursor.left() {
            return Err(Short);
        }
        if let Node::Number(primitive, _) = element {
            let bytes = primitive.bytes();
            cursor.align(bytes)?;
            for (picked, node) in picks {
                if let Some(place) = found.place(*picked).filter(|place| *place < count) {
                    let mut there = *cursor;
                    there.skip(place.checked_mul(bytes).ok_or(Short)?)?;
                    node.walk(&mut there, found)?;
                }
            }
            return cursor.skip(count.checked_mul(bytes).ok_or(Short)?);
        }
        for place in 0..count {
            if found.wanted == 0 {
                return Ok(());
            }
            if let (Node::Text(_), false) = (element, keys.is_empty()) {
                let text = cursor.text()?;
                for (_, key) in keys.iter().filter(|(looked_for, _)| looked_for.as_bytes() == text) {
                    found.keys[*key] = Some(place);
                }
                continue;
            }
            let before = *cursor;
            element.walk(cursor, found)?;
            for (picked, node) in picks {
                if found.place(*picked) == Some(place) {
                    node.walk(&mut before.clone(), found)?;
                }
            }
        }
        Ok(())
    }

    /// Whether it takes no bytes at all.
    fn is_empty(&self) -> bool {
        match self {
            Node::Message(nodes) => nodes.iter().all(Node::is_empty),
            Node::Array { count, element, .. } => {
                *count == Some(0) || (count.is_some() && element.is_empty())
            }
            Node::Number(..) | Node::Text(_) | Node::WideText | Node::Time(_) => false,
        }
    }
}

impl Found {
    fn keep(&mut self, slot: usize, value: f64) {
        self.slots[slot] = value;
        self.wanted = self.wanted.saturating_sub(1);
    }

    fn place(&self, picked: Picked) -> Option<usize> {
        match picked {
            Picked::At(place) => Some(place),
            Picked::Key(key) => self.keys.get(key).copied().flatten(),
        }
    }
}

impl Primitive {
    fn read(self, cursor: &mut Cursor<'_>) -> Result<f64, Short> {
        Ok(match self {
            Primitive::I8 => f64::from(i8::from_le_bytes(cursor.number()?)),
            Primitive::U8 => f64::from(u8::from_le_bytes(cursor.number()?)),
            Primitive::I16 => f64::from(i16::from_le_bytes(cursor.number()?)),
            Primitive::U16 => f64::from(u16::from_le_bytes(cursor.number()?)),
            Primitive::I32 => f64::from(i32::from_le_bytes(cursor.number()?)),
            Primitive::U32 => f64::from(u32::from_le_bytes(cursor.number()?)),
            Primitive::I64 => i64::from_le_bytes(cursor.number()?) as f64,
            Primitive::U64 => u64::from_le_bytes(cursor.number()?) as f64,
            Primitive::F32 => f64::from(f32::from_le_bytes(cursor.number()?)),
            Primitive::F64 => f64::from_le_bytes(cursor.number()?),
        })
    }
}
