//! What is to be written, as a tree.

use core::fmt;

use serde::ser::{
    Error, Impossible, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple, SerializeTupleStruct,
    SerializeTupleVariant, Serializer,
};
use serde::{Serialize, ser};

/// A part of what is to be written.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    /// A number, a text, a name.
    Leaf(String),
    /// A list.
    List(Vec<Self>),
    /// A tuple, or a variant with values.
    Tuple {
        /// The variant; empty if it is none.
        name: &'static str,
        entries: Vec<Self>,
    },
    /// A structure, or a variant with named values.
    Struct {
        /// The type of a structure; empty for a variant.
        of: &'static str,
        /// The variant; empty if it is none.
        name: &'static str,
        fields: Vec<(&'static str, Self)>,
    },
}

impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let listed = |f: &mut fmt::Formatter<'_>, entries: &[Self]| {
            for (i, entry) in entries.iter().enumerate() {
                write!(f, "{}{entry}", if i == 0 { "" } else { ", " })?;
            }
            Ok(())
        };
        match self {
            Self::Leaf(text) => f.write_str(text),
            Self::List(entries) => {
                f.write_str("[")?;
                listed(f, entries)?;
                f.write_str("]")
            }
            Self::Tuple { name, entries } => {
                write!(f, "{name}(")?;
                listed(f, entries)?;
                f.write_str(")")
            }
            Self::Struct { name, fields, .. } => {
                write!(f, "{name}(")?;
                for (i, (field, value)) in fields.iter().enumerate() {
                    write!(f, "{}{field}: {value}", if i == 0 { "" } else { ", " })?;
                }
                f.write_str(")")
            }
        }
    }
}

/// Makes a [`Node`] of what a scene consists of. There are no maps, bytes or characters in one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Builder;

/// Something that no scene consists of.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct NotOfAScene(String);

impl ser::Error for NotOfAScene {
    fn custom<T: fmt::Display>(reason: T) -> Self {
        Self(reason.to_string())
    }
}

type Built = Result<Node, NotOfAScene>;

/// Entries that are still to come.
#[derive(Debug)]
pub(super) struct Entries {
    name: Option<&'static str>,
    entries: Vec<Node>,
}

/// Fields that are still to come.
#[derive(Debug)]
pub(super) struct Fields {
    of: &'static str,
    name: &'static str,
    fields: Vec<(&'static str, Node)>,
}

impl Entries {
    fn new(name: Option<&'static str>) -> Self {
        Self { name, entries: Vec::new() }
    }

    fn add<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotOfAScene> {
        self.entries.push(value.serialize(Builder)?);
        Ok(())
    }

    fn tuple(self) -> Built {
        Ok(Node::Tuple { name: self.name.unwrap_or_default(), entries: self.entries })
    }
}

impl Fields {
    fn add<T: Serialize + ?Sized>(&mut self, field: &'static str, value: &T) -> Result<(), NotOfAScene> {
        self.fields.push((field, value.serialize(Builder)?));
        Ok(())
    }

    fn build(self) -> Built {
        let Self { of, name, fields } = self;
        Ok(Node::Struct { of, name, fields })
    }
}

macro_rules! leaves {
    ($($method:ident: $type:ty),*) => {
        $(fn $method(self, value: $type) -> Built {
            Ok(Node::Leaf(value.to_string()))
        })*
    };
}

impl Serializer for Builder {
    type Ok = Node;
    type Error = NotOfAScene;
    type SerializeSeq = Entries;
    type SerializeTuple = Entries;
    type SerializeTupleStruct = Entries;
    type SerializeTupleVariant = Entries;
    type SerializeMap = Impossible<Node, NotOfAScene>;
    type SerializeStruct = Fields;
    type SerializeStructVariant = Fields;

    leaves!(
        serialize_bool: bool, serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64, serialize_f32: f32, serialize_f64: f64
    );

    fn serialize_str(self, text: &str) -> Built {
        ron::to_string(text).map(Node::Leaf).map_err(NotOfAScene::custom)
    }

    fn serialize_char(self, _: char) -> Built {
        Err(NotOfAScene::custom("a character"))
    }

    fn serialize_bytes(self, _: &[u8]) -> Built {
        Err(NotOfAScene::custom("bytes"))
    }

    fn serialize_none(self) -> Built {
        Ok(Node::Leaf("None".into()))
    }

    /// What is read from a scene file needs no `Some`.
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Built {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Built {
        Ok(Node::Leaf("()".into()))
    }

    fn serialize_unit_struct(self, _: &'static str) -> Built {
        self.serialize_unit()
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, name: &'static str) -> Built {
        Ok(Node::Leaf(name.into()))
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Built {
        Ok(Node::Tuple { name: "", entries: vec![value.serialize(self)?] })
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        value: &T,
    ) -> Built {
        Ok(Node::Tuple { name, entries: vec![value.serialize(self)?] })
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Entries, NotOfAScene> {
        Ok(Entries::new(None))
    }

    fn serialize_tuple(self, _: usize) -> Result<Entries, NotOfAScene> {
        Ok(Entries::new(Some("")))
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Entries, NotOfAScene> {
        Ok(Entries::new(Some("")))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Entries, NotOfAScene> {
        Ok(Entries::new(Some(name)))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, NotOfAScene> {
        Err(NotOfAScene::custom("a map"))
    }

    fn serialize_struct(self, of: &'static str, _: usize) -> Result<Fields, NotOfAScene> {
        Ok(Fields { of, name: "", fields: Vec::new() })
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Fields, NotOfAScene> {
        Ok(Fields { of: "", name, fields: Vec::new() })
    }
}

impl SerializeSeq for Entries {
    type Ok = Node;
    type Error = NotOfAScene;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotOfAScene> {
        self.add(value)
    }

    fn end(self) -> Built {
        Ok(Node::List(self.entries))
    }
}

impl SerializeTuple for Entries {
    type Ok = Node;
    type Error = NotOfAScene;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotOfAScene> {
        self.add(value)
    }

    fn end(self) -> Built {
        self.tuple()
    }
}

impl SerializeTupleStruct for Entries {
    type Ok = Node;
    type Error = NotOfAScene;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotOfAScene> {
        self.add(value)
    }

    fn end(self) -> Built {
        self.tuple()
    }
}

impl SerializeTupleVariant for Entries {
    type Ok = Node;
    type Error = NotOfAScene;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NotOfAScene> {
        self.add(value)
    }

    fn end(self) -> Built {
        self.tuple()
    }
}

impl SerializeStruct for Fields {
    type Ok = Node;
    type Error = NotOfAScene;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, field: &'static str, value: &T) -> Result<(), NotOfAScene> {
        self.add(field, value)
    }

    fn end(self) -> Built {
        self.build()
    }
}

impl SerializeStructVariant for Fields {
    type Ok = Node;
    type Error = NotOfAScene;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, field: &'static str, value: &T) -> Result<(), NotOfAScene> {
        self.add(field, value)
    }

    fn end(self) -> Built {
        self.build()
    }
}
