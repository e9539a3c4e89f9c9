//! What may be left out of a scene file, since it is so by default.

use cloth_solver::Fabric;
use cloth_solver::contact::SelfContact;
use cloth_solver::damage::fire::{Contagion, Flammability};
use cloth_solver::forces::{Air, Fan, Gusts, Oscillation, WindZone};
use glam::{Vec2, Vec3};
use serde::Serialize;

use super::tree::{Builder, Node};
use crate::{
    Finish, Scene, SceneCamera, SceneCloth, SceneCollider, SceneFan, SceneFigure, SceneFire, SceneLook, SceneMotion,
    ScenePlace, SceneProp, SceneRing, SceneShape, SceneTearing, SceneView, SceneWeight, SceneWorn, SceneWrap,
    SceneZone,
};

/// The structures of scene files as they are by default.
#[derive(Debug)]
pub(super) struct Defaults(Vec<Node>);

impl Defaults {
    pub fn new() -> Self {
        // Of those of which a part cannot be left out the rest is as by default; `required` says which part.
        let shape = SceneShape::Ground;
        let place = ScenePlace::default();
        let all = [
            of(&Scene::default()),
            of(&SceneCloth::default()),
            of(&SceneTearing::default()),
            of(&SceneFire::default()),
            of(&SceneLook::default()),
            of(&SceneMotion::default()),
            of(&ScenePlace::default()),
            of(&SceneView::default()),
            of(&SceneFigure::default()),
            of(&SceneWorn::default()),
            of(&SceneWrap::default()),
            of(&SceneRing::default()),
            of(&SceneFan::default()),
            of(&SceneZone::default()),
            of(&SceneCollider::new("", shape, place)),
            of(&SceneProp { shape, finish: Finish::Hidden, place }),
            of(&SceneWeight { at: Vec2::ZERO, mass: 0.0, body: None }),
            of(&SceneCamera { from: Vec3::ZERO, to: Vec3::ZERO, field: crate::view::FIELD }),
            of(&Fabric::default()),
            of(&SelfContact::default()),
            of(&Air::default()),
            of(&Gusts::default()),
            of(&Fan::default()),
            of(&Oscillation::default()),
            of(&WindZone::default()),
            of(&Flammability::default()),
            of(&Contagion::default()),
        ];
        Self(all.into_iter().flatten().collect())
    }

    /// `node` without what is as by default.
    pub fn without(&self, node: Node) -> Node {
        let all = |entries: Vec<Node>| entries.into_iter().map(|entry| self.without(entry)).collect();
        match node {
            Node::Leaf(_) => node,
            Node::List(entries) => Node::List(all(entries)),
            Node::Tuple { name, entries } => Node::Tuple { name, entries: all(entries) },
            Node::Struct { of, name, fields } => {
                let usual = self.fields(of);
                let is_usual = |field: &(&'static str, Node)| !required(of).contains(&field.0) && usual.contains(field);
                let fields = fields.into_iter().filter(|field| !is_usual(field));
                Node::Struct { of, name, fields: fields.map(|(field, value)| (field, self.without(value))).collect() }
            }
        }
    }

    fn fields(&self, wanted: &str) -> &[(&'static str, Node)] {
        let found = self.0.iter().find_map(|node| match node {
            Node::Struct { of, fields, .. } if *of == wanted && !of.is_empty() => Some(&fields[..]),
            _ => None,
        });
        found.unwrap_or(&[])
    }
}

/// What of a structure has to be said.
fn required(of: &str) -> &'static [&'static str] {
    match of {
        "SceneCollider" => &["shape"],
        "SceneProp" => &["shape", "finish"],
        "SceneWeight" => &["at", "mass"],
        "SceneRing" => &["at", "radii"],
        "SceneCamera" => &["from", "to"],
        _ => &[],
    }
}

fn of(structure: &impl Serialize) -> Option<Node> {
    structure.serialize(Builder).ok()
}
