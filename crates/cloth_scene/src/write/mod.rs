//! Scenes written as RON: what is as by default is left out, and what fits on a line stays on it.

mod defaults;
mod tree;

use serde::Serialize;

use crate::Scene;
use defaults::Defaults;
use tree::Node;

/// Columns of a line, at most: what is longer is divided, if it can be.
const COLUMNS: usize = 120;

impl Scene {
    /// The scene as RON, as short as people write it: [`Scene::from_ron`] reads the same scene from it.
    pub fn to_ron(&self) -> String {
        // Scenes consist of numbers, text, lists and structures: none of them can fail to be written.
        let Ok(node) = self.serialize(tree::Builder) else { return String::new() };
        let mut text = String::new();
        print(&Defaults::new().without(node), 0, true, &mut text);
        text.push('\n');
        text
    }
}

/// Adds `node`, on one line if it fits behind what is there already and need not `break_up`.
fn print(node: &Node, depth: usize, break_up: bool, text: &mut String) {
    let column = text.len() - text.rfind('\n').map_or(0, |end| end + 1);
    let line = node.to_string();
    let is_leaf = !matches!(node, Node::Struct { .. } | Node::List(_) | Node::Tuple { .. });
    if is_leaf || (!break_up && column + line.len() < COLUMNS) {
        text.push_str(&line);
        return;
    }
    let (open, entries, close): (String, Vec<(Option<&str>, &Node)>, char) = match node {
        Node::Struct { name, fields, .. } => {
            (format!("{name}("), fields.iter().map(|(field, value)| (Some(*field), value)).collect(), ')')
        }
        Node::Tuple { name, entries } => (format!("{name}("), entries.iter().map(|entry| (None, entry)).collect(), ')'),
        Node::List(entries) => ("[".into(), entries.iter().map(|entry| (None, entry)).collect(), ']'),
        Node::Leaf(_) => return,
    };
    text.push_str(&open);
    let (outer, inner) = ("    ".repeat(depth), "    ".repeat(depth + 1));
    for (field, value) in entries {
        text.push('\n');
        text.push_str(&inner);
        if let Some(field) = field {
            text.push_str(field);
            text.push_str(": ");
        }
        print(value, depth + 1, false, text);
        text.push(',');
    }
    text.push('\n');
    text.push_str(&outer);
    text.push(close);
}
