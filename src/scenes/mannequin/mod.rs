//! Mannequins that walk: their bodies, what cloth meets of them, and their walk, by the clock of the cloth.

mod body;
#[cfg(test)]
mod tests;

use bevy::prelude::*;
use bevy_cloth::cloth_solver::Pose;
use bevy_cloth::{ClothSchedule, ClothSystems};
use cloth_scene::{Body, FigurePart, Gait, SceneFigure, Walk};

use super::OfScene;
use super::finish::Finishes;
use super::save::Said;
use super::spawn::shape;
use crate::select::Selectable;
use crate::tools::ResetScene;

/// A mannequin. Its entity stands in the middle of the circle; its parts are children.
#[derive(Component, Clone, Debug)]
#[require(Transform, Visibility)]
pub struct Mannequin {
    /// What it is to do: its speed may be changed at any time.
    pub figure: SceneFigure,
    /// How far it has come.
    pub walk: Walk,
}

/// A part of the mannequin that is its parent.
#[derive(Component, Clone, Copy, Debug)]
#[require(Transform, Visibility)]
pub struct Part(pub FigurePart);

/// Lets mannequins walk.
pub struct MannequinPlugin;

impl Plugin for MannequinPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(ClothSchedule, walk.before(ClothSystems::Prepare)).add_observer(go_back);
    }
}

/// Spawns a mannequin, the `index`th of its scene, and gives its parts in order.
pub fn spawn(
    commands: &mut Commands,
    meshes: &mut Assets<Mesh>,
    finishes: &mut Finishes,
    (figure, index): (&SceneFigure, usize),
    named: (Name, Selectable),
) -> [Entity; FigurePart::COUNT] {
    let walk = Walk::default();
    let mannequin = Mannequin { figure: figure.clone(), walk };
    let place = transform(&figure.place.pose());
    let root = commands.spawn((OfScene, named, Said(figure.clone(), index), mannequin, place)).id();
    let poses = figure.poses(&walk);
    let parts =
        FigurePart::ALL.map(|part| commands.spawn((Part(part), transform(&poses[part as usize]), ChildOf(root))).id());
    let size = Body::new(figure.height);
    for (part, form, place) in size.solids() {
        commands.spawn((shape(&form), transform(&place), ChildOf(parts[part as usize])));
    }
    let [limbs, joints] = [figure.finish, figure.joints].map(|finish| finishes.material(finish));
    for piece in body::pieces(&size) {
        let material = if piece.is_joint { &joints } else { &limbs };
        if let Some(material) = material {
            let mesh = Mesh3d(meshes.add(piece.mesh));
            commands.spawn((mesh, material.clone(), piece.place, ChildOf(parts[piece.part as usize])));
        }
    }
    parts
}

/// One tick of all walks.
fn walk(
    mut mannequins: Query<(&mut Mannequin, &Children)>,
    mut parts: Query<(&Part, &mut Transform)>,
    time: Res<Time>,
) {
    for (mut mannequin, children) in &mut mannequins {
        let Mannequin { figure, walk } = &mut *mannequin;
        Gait::new(figure.height, figure.radius).advance(walk, figure.speed, time.delta_secs());
        put(&mannequin, children, &mut parts);
    }
}

/// Puts all parts to where the walk has come.
fn put(mannequin: &Mannequin, children: &Children, parts: &mut Query<(&Part, &mut Transform)>) {
    let poses = mannequin.figure.poses(&mannequin.walk);
    for child in children.iter() {
        if let Ok((Part(part), mut place)) = parts.get_mut(child) {
            place.set_if_neq(transform(&poses[*part as usize]));
        }
    }
}

/// Takes all mannequins back to where they began.
fn go_back(
    _: On<ResetScene>,
    mut mannequins: Query<(&mut Mannequin, &Children)>,
    mut parts: Query<(&Part, &mut Transform)>,
) {
    for (mut mannequin, children) in &mut mannequins {
        mannequin.walk = Walk::default();
        put(&mannequin, children, &mut parts);
    }
}

fn transform(pose: &Pose) -> Transform {
    Transform::from_translation(pose.position).with_rotation(pose.rotation)
}
