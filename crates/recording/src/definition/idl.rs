//! Message definitions in OMG IDL 4.2, as `rosidl` writes them of ROS 2 packages.

use std::collections::BTreeMap;

use super::{
    Base, Count, Definition, Field, Primitive, add,
    token::{Tokens, tokens},
};

/// Deepest nesting of modules, sequences and names for types.
const DEEPEST: usize = 16;

/// A type as it is written, before all names are known.
#[derive(Clone)]
enum Written {
    Base(Base),
    Named(String),
    Sequence(Box<Written>),
}

/// A type with the size of the array that it stands for.
#[derive(Clone)]
struct Declared {
    name: String,
    written: Written,
    array: Option<usize>,
}

#[derive(Default)]
struct Parser<'t> {
    tokens: Tokens<'t>,
    structs: BTreeMap<String, Vec<Declared>>,
    names: BTreeMap<String, Declared>,
    enums: Vec<String>,
}

/// Parses a definition with its dependencies, each behind a line of `=` and one of `IDL:`.
pub(crate) fn parse(type_name: &str, text: &str) -> Result<Definition, String> {
    let in_idl = |reason: String| format!("its definition in IDL: {reason}");
    let mut parser = Parser { tokens: tokens(text).map_err(in_idl)?, ..Parser::default() };
    while !parser.tokens.is_empty() {
        parser.item("", 0).map_err(in_idl)?;
    }
    let mut definition = Definition::empty(type_name);
    for (name, members) in &parser.structs {
        let scope = name.rsplit_once("::").map_or("", |(scope, _)| scope);
        let message = message_name(name);
        definition.begin(&message);
        for member in members {
            let (base, count) = parser.resolve(&member.written, member.array, scope, 0).map_err(in_idl)?;
            add(&mut definition, &message, Field { name: member.name.clone(), base, count })?;
        }
    }
    Ok(definition)
}

impl Parser<'_> {
    /// A module, or something that one may hold.
    fn item(&mut self, scope: &str, depth: usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("modules nest too deeply".into());
        }
        match self.tokens.next()? {
            "@" => self.tokens.skip_annotation(),
            ";" => Ok(()),
            "module" => {
                let inside = within(scope, self.tokens.name()?);
                self.tokens.expect("{")?;
                while !self.tokens.take("}") {
                    self.item(&inside, depth + 1)?;
                }
                Ok(())
            }
            "struct" => {
                let name = within(scope, self.tokens.name()?);
                self.tokens.expect("{")?;
                let mut members = Vec::new();
                while !self.tokens.take("}") {
                    if self.tokens.take("@") {
                        self.tokens.skip_annotation()?;
                    } else {
                        members.extend(self.declared()?);
                    }
                }
                self.structs.insert(name, members);
                Ok(())
            }
            "typedef" => {
                for declared in self.declared()? {
                    self.names.insert(within(scope, &declared.name), declared);
                }
                Ok(())
            }
            "enum" => {
                self.enums.push(within(scope, self.tokens.name()?));
                self.tokens.skip_to("}")
            }
            "const" => self.tokens.skip_to(";"),
            other => Err(format!("`{other}` is not read")),
        }
    }

    /// A type and the names that have it, up to the semicolon.
    fn declared(&mut self) -> Result<Vec<Declared>, String> {
        let written = self.written(0)?;
        let mut declared = Vec::new();
        loop {
            let name = self.tokens.name()?.to_owned();
            let mut array: Option<usize> = None;
            while self.tokens.take("[") {
                let size: usize = self.tokens.number()?;
                let all = array.unwrap_or(1).checked_mul(size).ok_or("an array is too large")?;
                array = Some(all);
                self.tokens.expect("]")?;
            }
            declared.push(Declared { name, written: written.clone(), array });
            if !self.tokens.take(",") {
                break;
            }
        }
        self.tokens.expect(";")?;
        Ok(declared)
    }

    fn written(&mut self, depth: usize) -> Result<Written, String> {
        if depth > DEEPEST {
            return Err("sequences nest too deeply".into());
        }
        let number = |primitive| Ok(Written::Base(Base::Number(primitive)));
        match self.tokens.next()? {
            "boolean" | "octet" | "uint8" | "char" => number(Primitive::U8),
            "int8" => number(Primitive::I8),
            "short" | "int16" => number(Primitive::I16),
            "uint16" => number(Primitive::U16),
            "int32" => number(Primitive::I32),
            "uint32" => number(Primitive::U32),
            "int64" => number(Primitive::I64),
            "uint64" => number(Primitive::U64),
            "float" => number(Primitive::F32),
            "double" => number(Primitive::F64),
            "long" if self.tokens.take("long") => number(Primitive::I64),
            "long" if self.tokens.take("double") => Err("`long double` is not read".into()),
            "long" => number(Primitive::I32),
            "unsigned" => match self.tokens.next()? {
                "short" => number(Primitive::U16),
                "long" if self.tokens.take("long") => number(Primitive::U64),
                "long" => number(Primitive::U32),
                other => Err(format!("`unsigned {other}` is no type")),
            },
            kind @ ("string" | "wstring") => {
                if self.tokens.take("<") {
                    self.tokens.skip_to(">")?;
                }
                Ok(Written::Base(if kind == "string" { Base::Text } else { Base::WideText }))
            }
            "sequence" => {
                self.tokens.expect("<")?;
                let element = self.written(depth + 1)?;
                if self.tokens.take(",") {
                    self.tokens.next()?;
                }
                self.tokens.expect(">")?;
                Ok(Written::Sequence(Box::new(element)))
            }
            kind @ ("wchar" | "map" | "any" | "fixed" | "@") => Err(format!("`{kind}` is not read")),
            first => {
                let mut name = first.to_owned();
                while self.tokens.take("::") {
                    name = within(&name, self.tokens.name()?);
                }
                Ok(Written::Named(name))
            }
        }
    }

    /// What a type is made of, and how many of it.
    fn resolve(
        &self,
        written: &Written,
        array: Option<usize>,
        scope: &str,
        depth: usize,
    ) -> Result<(Base, Count), String> {
        if depth > DEEPEST {
            return Err("types name one another too deeply".into());
        }
        let (base, count) = match written {
            Written::Base(base) => (base.clone(), Count::One),
            Written::Named(name) => self.resolve_name(name, scope, depth)?,
            Written::Sequence(element) => match self.resolve(element, None, scope, depth + 1)? {
                (base, Count::One) => (base, Count::Sequence),
                _ => return Err("a sequence of arrays is not read".into()),
            },
        };
        let count = match (array, count) {
            (None, count) => count,
            (Some(size), Count::One) => Count::Fixed(size),
            (Some(size), Count::Fixed(inner)) => {
                Count::Fixed(size.checked_mul(inner).ok_or("an array is too large")?)
            }
            (Some(_), Count::Sequence) => return Err("an array of sequences is not read".into()),
        };
        Ok((base, count))
    }

    /// The type of a name, looked for from the innermost scope outwards.
    fn resolve_name(&self, name: &str, scope: &str, depth: usize) -> Result<(Base, Count), String> {
        let mut scope = Some(scope);
        while let Some(here) = scope {
            let full = within(here, name);
            if let Some(declared) = self.names.get(&full) {
                return self.resolve(&declared.written, declared.array, here, depth + 1);
            }
            if self.enums.contains(&full) {
                return Ok((Base::Number(Primitive::U32), Count::One));
            }
            if self.structs.contains_key(&full) {
                return Ok((Base::of_message(message_name(&full)), Count::One));
            }
            scope = (!here.is_empty()).then(|| here.rsplit_once("::").map_or("", |(outer, _)| outer));
        }
        Ok((Base::of_message(message_name(name)), Count::One))
    }
}

/// `scope::name`.
fn within(scope: &str, name: &str) -> String {
    if scope.is_empty() { name.to_owned() } else { format!("{scope}::{name}") }
}

/// `package/Name` of `package::msg::Name`.
fn message_name(scoped: &str) -> String {
    match scoped.split_once("::") {
        Some((package, rest)) => format!("{package}/{}", rest.rsplit("::").next().unwrap_or(rest)),
        None => scoped.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        parse("a/msg/B", text).unwrap_err()
    }

    #[test]
    fn names_of_types_are_found_wherever_they_are_defined() {
        let text = "module a { module msg { typedef float pair[2]; typedef pair pairs[3]; struct B { pairs p; c::msg::D d; \
                    State s; sequence<builtin_interfaces::msg::Time> t; }; enum State { X }; }; };\n\
                    ====\nIDL: c/msg/D\nmodule c { module msg { struct D { a::msg::State s; }; }; };";
        let definition = parse("a/msg/B", text).unwrap();
        let fields = definition.root();
        assert_eq!((&fields[0].base, fields[0].count), (&Base::Number(Primitive::F32), Count::Fixed(6)));
        assert_eq!(fields[1].base, Base::Message("c/D".into()));
        assert_eq!(fields[2].base, Base::Number(Primitive::U32));
        assert_eq!((&fields[3].base, fields[3].count), (&Base::Time, Count::Sequence));
        assert_eq!(definition.fields("c/D").unwrap()[0].base, Base::Number(Primitive::U32));
    }

    #[test]
    fn what_is_not_read_is_refused_in_words() {
        for (text, said) in [
            ("union U switch (long) {};", "`union` is not read"),
            ("struct B { long double x; };", "long double"),
            ("struct B { sequence<sequence<long>> x; };", "sequence of arrays"),
            ("struct B { long x", "ends too soon"),
            ("struct B { long x[y]; };", "`y` is no number"),
            ("module a { typedef b b; struct B { b x; }; };", "too deeply"),
            ("struct B { long \"x\"; };", "is no name"),
            ("/* never closed", "comment"),
        ] {
            let message = refused(text);
            assert!(message.contains("IDL") && message.contains(said), "{text}: {message}");
        }
        refused(&"module a {".repeat(100_000));
        refused(&format!("struct B {{ {} }}", "sequence<".repeat(100_000)));
    }
}
