//! Makes the pins of a cloth, and its skin, from what is authored.

use bevy::prelude::*;
use cloth_solver::constraint::{Pin, Pins as SolverPins, Skin as SolverSkin, SkinLimit, SkinPoint};
use cloth_solver::{ClothError, Soa3, Topology};

use super::{Anchor, Anchors};
use crate::cloth::ClothFrame;
use crate::freedom::Freedom;
use crate::pins::{PinTarget, Pins};
use crate::prepare::armature::{Armature, normals};
use crate::prepare::placement::Placements;
use crate::prepare::select::{freedom, select};
use crate::prepare::source::Skin;

/// What holds a cloth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Worn<'a> {
    pub pins: Option<&'a Pins>,
    pub freedom: Option<&'a Freedom>,
    pub armature: Option<&'a Armature>,
}

/// The solver's pins for what is `worn`, made at the present `position` of the particles, and what they hang on.
pub(crate) fn make(
    worn: Worn,
    topology: &Topology,
    skin: &Skin,
    position: &Soa3,
    frame: &ClothFrame,
    placements: &Placements,
) -> Result<(SolverPins, Anchors), ClothError> {
    let mut made = SolverPins::default();
    let mut anchors = Anchors::default();
    let mut held = SolverSkin::default();
    let mut taken = vec![false; topology.slots()];
    for joint in worn.armature.iter().flat_map(|armature| &armature.joints) {
        let mut anchor = Anchor::new(PinTarget::Entity(*joint), frame, placements)?;
        made.frames.push(anchor.advance(frame));
        anchors.all.push(anchor);
    }
    let mut hold = |slots: &[u32], to: PinTarget, made: &mut SolverPins, anchors: &mut Anchors| {
        let joints = worn.armature.filter(|_| to == PinTarget::Cloth);
        let index = match joints {
            Some(_) => 0,
            None => anchors.index(to, made, frame, placements)?,
        };
        for slot in slots.iter().copied() {
            if std::mem::replace(&mut taken[slot as usize], true) {
                continue;
            }
            let pin = match (joints, to) {
                (Some(armature), _) => {
                    let point = armature.points[slot as usize];
                    held.pins.push((slot, point));
                    Pin { particle: slot, frame: point.frames[0], local: point.locals[0] }
                }
                (None, PinTarget::Cloth) => Pin { particle: slot, frame: index, local: topology.rest[slot as usize] },
                (None, _) => {
                    let local = made.frames[index as usize].to.inverse_point(position.get(slot as usize));
                    Pin { particle: slot, frame: index, local }
                }
            };
            made.pins.push(pin);
        }
        Ok::<(), ClothError>(())
    };
    for group in worn.pins.iter().flat_map(|pins| &pins.0) {
        hold(&select(&group.select, topology, skin)?, group.to, &mut made, &mut anchors)?;
    }
    if let Some(limits) = worn.freedom {
        limits.validate()?;
        let free = freedom(topology, skin)?;
        let pinned: Vec<u32> = topology.particles().filter(|slot| free[*slot as usize] == 0.0).collect();
        hold(&pinned, PinTarget::Cloth, &mut made, &mut anchors)?;
        if limits.limits() {
            let points = match worn.armature {
                Some(armature) => armature.points.clone(),
                None => {
                    let index = anchors.index(PinTarget::Cloth, &mut made, frame, placements)?;
                    fixed_points(topology, index)
                }
            };
            let free = topology.particles().filter(|slot| !taken[*slot as usize]).map(|particle| SkinLimit {
                particle,
                point: points[particle as usize],
                distance: limits.distance * free[particle as usize],
                backstop: limits.backstop,
            });
            held.limits.extend(free);
        }
    }
    anchors.authored = anchors.all.len();
    anchors.pins.clone_from(&made.pins);
    anchors.skin = (held != SolverSkin::default()).then_some(held);
    Ok((made, anchors))
}

/// For each slot its rest position in one frame.
fn fixed_points(topology: &Topology, frame: u32) -> Vec<SkinPoint> {
    let normals = normals(topology);
    let point = |(rest, normal): (&Vec3, Vec3)| SkinPoint {
        frames: [frame; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        locals: [*rest; 4],
        normals: [normal; 4],
    };
    topology.rest.iter().zip(normals).map(point).collect()
}
