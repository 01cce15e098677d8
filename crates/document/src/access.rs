//! Arrays, objects and enums as a strict deserializer hands them to types.

use std::collections::BTreeSet;

use serde::{
    Deserializer,
    de::{
        DeserializeSeed, EnumAccess, Error as _, IgnoredAny, MapAccess, SeqAccess, Unexpected, VariantAccess,
        Visitor,
        value::{StrDeserializer, StringDeserializer},
    },
};

use crate::{
    fault::{Fault, Kind, twice},
    placeholder::Placeholder,
    strict::{Names, Reading, Strict},
};

/// Hands a seed a strict deserializer.
struct Seed<'a, S> {
    seed: S,
    reading: &'a Reading<'a>,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Seed<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        let carrier = &self.reading.carrier;
        self.seed.deserialize(Strict { inner, reading: self.reading }).map_err(|fault| carrier.keep(fault))
    }
}

/// The elements of an array.
pub(crate) struct Elements<'a, A> {
    pub(crate) inner: A,
    pub(crate) reading: &'a Reading<'a>,
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Elements<'_, A> {
    type Error = Fault;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, Fault> {
        let reading = self.reading;
        self.inner.next_element_seed(Seed { seed, reading }).map_err(|error| reading.carrier.take(&error))
    }

    fn size_hint(&self) -> Option<usize> {
        self.inner.size_hint()
    }
}

/// The fields of an object, and after them those that are filled in.
pub(crate) struct Fields<'a, A> {
    inner: A,
    names: Names,
    object: usize,
    reading: &'a Reading<'a>,
    seen: BTreeSet<String>,
    last: String,
    filled: usize,
}

impl<'a, A> Fields<'a, A> {
    pub(crate) fn new(inner: A, names: Names, object: usize, reading: &'a Reading<'a>) -> Self {
        Fields { inner, names, object, reading, seen: BTreeSet::new(), last: String::new(), filled: 0 }
    }

    /// The next field to fill in.
    fn fill(&mut self) -> Option<&'static str> {
        let mut of_object = self.reading.filled.iter().filter(|(object, _)| *object == self.object);
        let (_, field) = of_object.nth(self.filled)?;
        self.filled += 1;
        Some(field)
    }

    /// Suggests the field that takes an id, where an object was expected and a string found.
    fn suggest_id(&self, fault: Fault) -> Fault {
        let id_field = format!("{}_id", self.last);
        let is_text = matches!(fault.kind(), Kind::Type { is_text: true, .. });
        match self.names.iter().find(|name| **name == id_field) {
            Some(name) if is_text => fault.hinted(format!("did you mean `{name}`?")),
            _ => fault,
        }
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Fields<'_, A> {
    type Error = Fault;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, Fault> {
        let key = self.inner.next_key::<String>().map_err(|error| self.reading.carrier.take(&error))?;
        let Some(key) = key else {
            let Some(field) = self.fill() else { return Ok(None) };
            return seed.deserialize(StrDeserializer::new(field)).map(Some);
        };
        if !self.seen.insert(key.clone()) {
            return Err(twice(&key));
        }
        self.last.clone_from(&key);
        seed.deserialize(StringDeserializer::new(key)).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Fault> {
        if self.filled > 0 {
            return seed.deserialize(Placeholder);
        }
        let reading = self.reading;
        let value = self.inner.next_value_seed(Seed { seed, reading });
        value.map_err(|error| self.suggest_id(reading.carrier.take(&error)))
    }

    fn size_hint(&self) -> Option<usize> {
        self.inner.size_hint()
    }
}

/// A variant with content, written as an object of its name and its content.
pub(crate) struct Variant<'a, A>(pub(crate) Fields<'a, A>);

impl<'de, A: MapAccess<'de>> EnumAccess<'de> for Variant<'_, A> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'de>>(mut self, seed: S) -> Result<(S::Value, Self), Fault> {
        match self.0.next_key_seed(seed)? {
            Some(name) => Ok((name, self)),
            None => Err(Fault::custom("expected a name, but found an empty object")),
        }
    }
}

impl<'de, A: MapAccess<'de>> Variant<'_, A> {
    /// Reads the content; nothing may stand beside it.
    fn content<S: DeserializeSeed<'de>>(mut self, seed: S) -> Result<S::Value, Fault> {
        let value = self.0.next_value_seed(seed)?;
        match self.0.next_key::<IgnoredAny>()? {
            None => Ok(value),
            Some(_) => Err(Fault::custom("expected one name with its content, but found several")),
        }
    }
}

impl<'de, A: MapAccess<'de>> VariantAccess<'de> for Variant<'_, A> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        Err(Fault::invalid_type(Unexpected::Map, &"a name as a string"))
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, Fault> {
        self.content(seed)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Fault> {
        self.content(Content { names: None, length, visitor })
    }

    fn struct_variant<V: Visitor<'de>>(self, names: Names, visitor: V) -> Result<V::Value, Fault> {
        self.content(Content { names: Some(names), length: 0, visitor })
    }
}

/// The content of a variant: the fields of a struct or, without names, of a tuple.
struct Content<V> {
    names: Option<Names>,
    length: usize,
    visitor: V,
}

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Content<V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        match self.names {
            Some(names) => deserializer.deserialize_struct("", names, self.visitor),
            None => deserializer.deserialize_tuple(self.length, self.visitor),
        }
    }
}
