//! A deserializer of JSON that accepts one form of each type.

use std::{cell::Cell, fmt};

use serde::{
    Deserializer,
    de::{Error as _, MapAccess, SeqAccess, Unexpected, Visitor, value::StrDeserializer},
    forward_to_deserialize_any,
};

use crate::{
    access::{Elements, Fields, Variant},
    fault::{Carrier, Fault},
};

/// What one reading of a document shares.
#[derive(Default)]
pub(crate) struct Reading<'a> {
    pub(crate) carrier: Carrier,
    /// Objects begun so far.
    objects: Cell<usize>,
    /// Fields that are missing, each with the object that lacks it: they are filled in, to find the next that is missing.
    pub(crate) filled: &'a [(usize, &'static str)],
}

impl<'a> Reading<'a> {
    pub(crate) fn new(filled: &'a [(usize, &'static str)]) -> Self {
        Reading { filled, ..Reading::default() }
    }
}

/// A value of JSON, read strictly.
pub(crate) struct Strict<'a, D> {
    pub(crate) inner: D,
    pub(crate) reading: &'a Reading<'a>,
}

/// Fields of a struct that an object stands for; none for a map.
pub(crate) type Names = &'static [&'static str];

impl<'de, D: Deserializer<'de>> Strict<'_, D> {
    fn any<V: Visitor<'de>>(self, visitor: V, form: Form) -> Result<V::Value, Fault> {
        let reading = self.reading;
        let strict = StrictVisitor { visitor, form, reading };
        self.inner.deserialize_any(strict).map_err(|error| reading.carrier.take(&error))
    }
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<'_, D> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.any(visitor, Form::Any)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        names: Names,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.any(visitor, Form::Object(names))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: Names,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.any(visitor, Form::Enum)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let reading = self.reading;
        let strict = StrictVisitor { visitor, form: Form::Any, reading };
        self.inner.deserialize_option(strict).map_err(|error| reading.carrier.take(&error))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let reading = self.reading;
        self.inner.deserialize_ignored_any(visitor).map_err(|error| reading.carrier.take(&error))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map identifier
    }
}

/// The form in which a type is written.
#[derive(Clone, Copy)]
enum Form {
    /// Whatever the type takes.
    Any,
    /// An object with these fields.
    Object(Names),
    /// The name of a variant, or an object of the name and its content.
    Enum,
}

/// A visitor that sees values of its form alone.
struct StrictVisitor<'a, V> {
    visitor: V,
    form: Form,
    reading: &'a Reading<'a>,
}

impl<'de, V: Visitor<'de>> StrictVisitor<'_, V> {
    /// Visits a value that is neither array nor object.
    fn plain<E: serde::de::Error>(
        self,
        found: Unexpected<'_>,
        visit: impl FnOnce(V) -> Result<V::Value, Fault>,
    ) -> Result<V::Value, E> {
        let carrier = &self.reading.carrier;
        match self.form {
            Form::Any => visit(self.visitor),
            Form::Object(_) | Form::Enum => Err(Fault::invalid_type(found, &self)),
        }
        .map_err(|fault| carrier.keep(fault))
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for StrictVisitor<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.form {
            Form::Any => self.visitor.expecting(f),
            Form::Enum => f.write_str("a name"),
            Form::Object([]) => f.write_str("an object"),
            Form::Object(names) => {
                let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
                write!(f, "an object with {}", names.join(", "))
            }
        }
    }

    fn visit_bool<E: serde::de::Error>(self, value: bool) -> Result<V::Value, E> {
        self.plain(Unexpected::Bool(value), |visitor| visitor.visit_bool(value))
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<V::Value, E> {
        self.plain(Unexpected::Signed(value), |visitor| visitor.visit_i64(value))
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<V::Value, E> {
        self.plain(Unexpected::Unsigned(value), |visitor| visitor.visit_u64(value))
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<V::Value, E> {
        self.plain(Unexpected::Float(value), |visitor| visitor.visit_f64(value))
    }

    fn visit_str<E: serde::de::Error>(self, value: &str) -> Result<V::Value, E> {
        let carrier = &self.reading.carrier;
        match self.form {
            Form::Enum => {
                let name = StrDeserializer::<Fault>::new(value);
                self.visitor.visit_enum(name).map_err(|fault| carrier.keep(fault))
            }
            _ => self.plain(Unexpected::Str(value), |visitor| visitor.visit_str(value)),
        }
    }

    fn visit_unit<E: serde::de::Error>(self) -> Result<V::Value, E> {
        self.plain(Unexpected::Unit, V::visit_unit)
    }

    fn visit_none<E: serde::de::Error>(self) -> Result<V::Value, E> {
        self.plain(Unexpected::Unit, V::visit_none)
    }

    fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        let carrier = &self.reading.carrier;
        let content = Strict { inner, reading: self.reading };
        self.visitor.visit_some(content).map_err(|fault| carrier.keep(fault))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, elements: A) -> Result<V::Value, A::Error> {
        let carrier = &self.reading.carrier;
        match self.form {
            Form::Any => self.visitor.visit_seq(Elements { inner: elements, reading: self.reading }),
            Form::Object(_) | Form::Enum => Err(Fault::invalid_type(Unexpected::Seq, &self)),
        }
        .map_err(|fault| carrier.keep(fault))
    }

    fn visit_map<A: MapAccess<'de>>(self, entries: A) -> Result<V::Value, A::Error> {
        let reading = self.reading;
        let object = reading.objects.replace(reading.objects.get() + 1);
        let names = if let Form::Object(names) = self.form { names } else { &[] };
        let fields = Fields::new(entries, names, object, reading);
        match self.form {
            Form::Enum => self.visitor.visit_enum(Variant(fields)),
            Form::Any | Form::Object(_) => self.visitor.visit_map(fields),
        }
        .map_err(|fault| reading.carrier.keep(fault.within(object)))
    }
}
