//! What was authored: noticing what changed, and remembering what is wrong.

use bevy::ecs::query::QueryData;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use cloth_solver::forces::Gusts;
use cloth_solver::topology::Mended;
use cloth_solver::{ClothError, Fabric, Topology};

use super::DrawnMesh;
use super::anchors::{self, Worn};
use super::armature::{Armature, TakenSkin};
use super::placement::Placement;
use super::shared::{SharedChanges, SharedSettings};
use crate::air::Wind;
use crate::cloth::{Cloth, ClothRejection, ClothSource};
use crate::damage::{Flammable, Tearable};
use crate::detail::ClothDetail;
use crate::freedom::Freedom;
use crate::particle_pins::ParticlePins;
use crate::pins::Pins;
use crate::settings::{Grabs, Gravity, Substeps};
use crate::sleep::{ClothAsleep, ClothSleep, WakeCause};
use crate::teleport::Teleport;
use crate::weights::Weights;
use crate::{Air, Method, SelfContact};

/// A scale that changes by less than this part of itself is the same scale: taken out of the matrices of a turning
/// hierarchy it is never twice the same to the last bit.
const SCALE_TOLERANCE: f32 = 1e-4;

/// What a cloth was last seen to be, what is still to be done about it, and what was wrong with it.
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Authored {
    source: Option<ClothSource>,
    mesh: Option<AssetId<Mesh>>,
    scale: Vec3,
    fabric: Option<Fabric>,
    pins: Option<Pins>,
    particle_pins: Option<ParticlePins>,
    freedom: Option<Freedom>,
    weights: Option<Weights>,
    gravity: Option<Gravity>,
    substeps: Option<Substeps>,
    tearable: Option<Tearable>,
    flammable: Option<Flammable>,
    air: Option<Air>,
    wind: Option<Wind>,
    gusts: Option<Gusts>,
    teleport: Option<Teleport>,
    detail: Option<ClothDetail>,
    method: Option<Method>,
    sleep: Option<ClothSleep>,
    self_contact: Option<SelfContact>,
    /// The runtime state does not show the shape seen here.
    pub stale: bool,
    /// Fingerprint of the topology that it was built to.
    pub origin: u64,
    /// What the shape still waits for.
    pub waits_for: Option<WaitsFor>,
    /// Grabs that came before there was a topology to check them against.
    grabs_unchecked: bool,
    pub faults: Faults,
    /// What was mended of the mesh that it is made of.
    pub mended: Mended,
}

/// What the shape of a cloth can wait for without anything being wrong with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum WaitsFor {
    Mesh,
    /// The joints of a skinned mesh, or its bind poses.
    Skin,
    FiniteTransform,
}

/// What is wrong with each part of the authored data.
#[derive(Clone, Debug, Default)]
pub(crate) struct Faults {
    pub source: Option<ClothError>,
    pub fabric: Option<ClothError>,
    pub pins: Option<ClothError>,
    pub particle_pins: Option<ClothError>,
    pub weights: Option<ClothError>,
    pub settings: Option<ClothError>,
    pub grabs: Option<ClothError>,
}

impl Authored {
    /// The shape is to be built anew, as if it had never been seen.
    pub fn forget_shape(&mut self) {
        self.source = None;
    }

    /// The runtime state shows these pins on single particles already.
    pub fn know_particle_pins(&mut self, pins: Option<ParticlePins>) {
        self.particle_pins = pins;
        self.faults.particle_pins = None;
    }
}

impl Faults {
    pub fn first(&self) -> Option<&ClothError> {
        [&self.source, &self.fabric, &self.pins, &self.particle_pins, &self.weights, &self.settings, &self.grabs]
            .into_iter()
            .flatten()
            .next()
    }
}

/// Which parts of the authored data want something done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Changes {
    pub shape: bool,
    pub fabric: bool,
    pub pins: bool,
    pub particle_pins: bool,
    pub weights: bool,
    pub settings: bool,
    pub self_contact: bool,
    /// The shared settings were touched, and it has not all of its own.
    pub shared: bool,
    pub grabs: bool,
}

/// The authored components of one cloth.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Wanted {
    pub entity: Entity,
    cloth: Ref<'static, Cloth>,
    fabric: Option<Ref<'static, Fabric>>,
    pins: Option<Ref<'static, Pins>>,
    particle_pins: Option<Ref<'static, ParticlePins>>,
    freedom: Option<Ref<'static, Freedom>>,
    skinned: Option<Ref<'static, SkinnedMesh>>,
    taken: Option<&'static TakenSkin>,
    weights: Option<Ref<'static, Weights>>,
    gravity: Option<Ref<'static, Gravity>>,
    substeps: Option<Ref<'static, Substeps>>,
    tearable: Option<Ref<'static, Tearable>>,
    flammable: Option<Ref<'static, Flammable>>,
    air: Option<Ref<'static, Air>>,
    wind: Option<Ref<'static, Wind>>,
    gusts: Option<Ref<'static, Gusts>>,
    teleport: Option<Ref<'static, Teleport>>,
    detail: Option<Ref<'static, ClothDetail>>,
    method: Option<Ref<'static, Method>>,
    sleep: Option<Ref<'static, ClothSleep>>,
    self_contact: Option<Ref<'static, SelfContact>>,
    grabs: Option<Ref<'static, Grabs>>,
    mesh: Option<&'static Mesh3d>,
    drawn: Option<&'static DrawnMesh>,
    pub authored: &'static mut Authored,
    asleep: Has<ClothAsleep>,
    pub rejection: Option<&'static ClothRejection>,
}

/// Whether a cloth of this `scale` is another shape than one that is `known`.
pub(crate) fn differs_in_scale(scale: Vec3, known: Vec3) -> bool {
    (scale - known).abs().max_element() > SCALE_TOLERANCE * known.abs().max_element()
}

/// Whether an optional component is another one than was last seen. The change flag comes first, since a NaN is
/// different from itself; the value second, since inspectors touch what they do not change.
fn differs<T: PartialEq>(now: &Option<Ref<T>>, seen: &Option<T>) -> bool {
    match (now, seen) {
        (Some(now), Some(seen)) => now.is_changed() && **now != *seen,
        (None, None) => false,
        _ => true,
    }
}

/// The mesh the user gave an entity, seen past the one the cloth draws.
pub(crate) fn user_mesh(mesh: Option<&Mesh3d>, drawn: Option<&DrawnMesh>) -> Option<AssetId<Mesh>> {
    match (mesh, drawn) {
        (Some(mesh), Some(drawn)) if mesh.id() == drawn.drawn.id() => drawn.source.as_ref().map(Handle::id),
        (Some(mesh), _) => Some(mesh.id()),
        (None, _) => None,
    }
}

impl WantedItem<'_, '_> {
    pub fn source(&self) -> &ClothSource {
        &self.cloth.source
    }

    pub fn fabric(&self) -> Fabric {
        self.fabric.as_deref().copied().unwrap_or_default()
    }

    pub fn pins(&self) -> Option<&Pins> {
        self.pins.as_deref()
    }

    pub fn particle_pins(&self) -> Option<&ParticlePins> {
        self.particle_pins.as_deref()
    }

    /// What holds it where, by `armature` if it has one; `None` if nothing does.
    pub fn worn<'a>(&'a self, armature: Option<&'a Armature>) -> Option<Worn<'a>> {
        let (pins, freedom) = (self.pins(), self.freedom.as_deref());
        (pins.is_some() || freedom.is_some()).then_some(Worn { pins, freedom, armature })
    }

    /// The skin of the entity's mesh, seen past that a cloth took it off.
    pub fn skin(&self) -> Option<TakenSkin> {
        self.skinned.as_deref().map(TakenSkin::new).or_else(|| self.taken.cloned())
    }

    pub fn weights(&self) -> Option<&Weights> {
        self.weights.as_deref()
    }

    pub fn self_contact(&self) -> Option<&SelfContact> {
        self.self_contact.as_deref()
    }

    /// The mesh the user gave the entity, seen past the one the cloth draws.
    pub fn user_mesh(&self) -> Option<AssetId<Mesh>> {
        user_mesh(self.mesh, self.drawn)
    }

    /// Why a cloth that is asleep has to wake after `changes` of its own, and those of the shared settings.
    pub fn wakes(&self, changes: &Changes, shared: &SharedChanges) -> Option<WakeCause> {
        if !self.asleep {
            return None;
        }
        if changes.grabs && self.grabs.as_ref().is_some_and(|grabs| !grabs.0.is_empty()) {
            return Some(WakeCause::Hand);
        }
        let wind = (shared.wind && self.wind.is_none()) || (shared.gusts && self.gusts.is_none());
        let by_shared = (shared.gravity && self.gravity.is_none())
            || (shared.substeps && self.substeps.is_none())
            || (shared.method && self.method.is_none())
            || (shared.teleport && self.teleport.is_none())
            || (shared.sleep && self.sleep.is_none());
        let own = Changes { grabs: false, shared: false, ..*changes } != Changes::default();
        match (own || by_shared, wind && self.air.is_some()) {
            (true, _) => Some(WakeCause::Change),
            (false, true) => Some(WakeCause::Wind),
            (false, false) => None,
        }
    }

    /// What changed since the last call. Remembers what it saw.
    pub fn notice(
        &mut self,
        placement: Option<Placement>,
        meshes: Option<&Assets<Mesh>>,
        modified: &HashSet<AssetId<Mesh>>,
        shared: &SharedSettings,
        running: bool,
    ) -> Changes {
        let seen = &self.authored;
        let first = seen.source.is_none();
        let mesh = self.user_mesh().filter(|_| self.cloth.source == ClothSource::Mesh);
        let placement = placement.filter(Placement::is_finite);
        let scale = placement.map_or(seen.scale, |placement| placement.scale);
        let arrived = match seen.waits_for {
            Some(WaitsFor::Mesh) => mesh.is_some_and(|id| meshes.is_some_and(|meshes| meshes.contains(id))),
            Some(WaitsFor::Skin) => true,
            Some(WaitsFor::FiniteTransform) => placement.is_some(),
            None => false,
        };
        let new_mesh = mesh.is_some_and(|id| Some(id) != seen.mesh || modified.contains(&id));
        let changes = Changes {
            shape: first
                // Someone took a part of the runtime state away.
                || (!running && !seen.stale)
                || arrived
                || new_mesh
                || (mesh.is_some() && self.skinned.as_ref().is_some_and(|skin| skin.is_changed()))
                || (self.cloth.is_changed() && seen.source.as_ref() != Some(&self.cloth.source))
                || differs_in_scale(scale, seen.scale),
            fabric: differs(&self.fabric, &seen.fabric),
            pins: differs(&self.pins, &seen.pins)
                || differs(&self.freedom, &seen.freedom)
                || seen.faults.pins.as_ref().is_some_and(anchors::waits_for_entity),
            particle_pins: differs(&self.particle_pins, &seen.particle_pins)
                || seen.faults.particle_pins.as_ref().is_some_and(anchors::waits_for_entity),
            weights: differs(&self.weights, &seen.weights),
            settings: first
                || differs(&self.gravity, &seen.gravity)
                || differs(&self.substeps, &seen.substeps)
                || differs(&self.tearable, &seen.tearable)
                || differs(&self.flammable, &seen.flammable)
                || differs(&self.air, &seen.air)
                || differs(&self.wind, &seen.wind)
                || differs(&self.gusts, &seen.gusts)
                || differs(&self.teleport, &seen.teleport)
                || differs(&self.detail, &seen.detail)
                || differs(&self.method, &seen.method)
                || differs(&self.sleep, &seen.sleep),
            self_contact: differs(&self.self_contact, &seen.self_contact),
            shared: (self.gravity.is_none() && shared.gravity.is_changed())
                || (self.substeps.is_none() && shared.substeps.is_changed())
                || (self.wind.is_none() && shared.wind.is_changed())
                || (self.gusts.is_none() && shared.gusts.is_changed())
                || (self.teleport.is_none() && shared.teleport.is_changed())
                || (self.sleep.is_none() && shared.sleep.is_changed()),
            grabs: match &self.grabs {
                Some(grabs) => grabs.is_changed() || (seen.grabs_unchecked && running),
                None => seen.faults.grabs.is_some(),
            },
        };
        if changes == Changes::default() {
            return changes;
        }
        let seen = &mut *self.authored;
        seen.stale |= changes.shape;
        seen.scale = scale;
        seen.mesh = mesh.or(seen.mesh);
        if changes.shape {
            seen.source = Some(self.cloth.source.clone());
        }
        if changes.fabric {
            seen.fabric = self.fabric.as_deref().copied();
        }
        if changes.pins {
            seen.pins = self.pins.as_deref().cloned();
            seen.freedom = self.freedom.as_deref().copied();
        }
        if changes.particle_pins {
            seen.particle_pins = self.particle_pins.as_deref().cloned();
        }
        if changes.weights {
            seen.weights = self.weights.as_deref().cloned();
        }
        seen.gravity = self.gravity.as_deref().copied();
        seen.substeps = self.substeps.as_deref().copied();
        seen.tearable = self.tearable.as_deref().copied();
        seen.flammable = self.flammable.as_deref().copied();
        seen.air = self.air.as_deref().copied();
        seen.wind = self.wind.as_deref().copied();
        seen.gusts = self.gusts.as_deref().copied();
        seen.teleport = self.teleport.as_deref().copied();
        seen.detail = self.detail.as_deref().copied();
        seen.method = self.method.as_deref().copied();
        seen.sleep = self.sleep.as_deref().copied();
        seen.self_contact = self.self_contact.as_deref().copied();
        changes
    }

    /// Checks the settings that hold for this cloth, its own or the shared ones.
    pub fn check_settings(&mut self, shared: &SharedSettings) {
        let gravity = self.gravity.as_deref().unwrap_or(&shared.gravity).validate();
        let substeps = self.substeps.as_deref().unwrap_or(&shared.substeps).validate();
        let air = self.air.as_deref().map_or(Ok(()), Air::validate);
        let tearable = self.tearable.as_deref().map_or(Ok(()), Tearable::validate);
        let flammable = self.flammable.as_deref().map_or(Ok(()), Flammable::validate);
        let wind = self.wind.as_deref().unwrap_or(&shared.wind).validate();
        let gusts = self.gusts.as_deref().unwrap_or(&shared.gusts).validate();
        let teleport = self.teleport.as_deref().unwrap_or(&shared.teleport).validate();
        let sleep = self.sleep.as_deref().unwrap_or(&shared.sleep).validate();
        let self_contact = self.self_contact.as_deref().map_or(Ok(()), SelfContact::validate);
        let detail = self.detail.as_deref().map_or(Ok(()), ClothDetail::validate);
        let own = tearable.and(flammable).and(air).and(self_contact).and(detail);
        self.authored.faults.settings =
            gravity.and(substeps).and(own).and(wind).and(gusts).and(teleport).and(sleep).err();
    }

    /// Checks the hands on the cloth, or remembers to do so once there is a `topology`.
    pub fn check_grabs(&mut self, topology: Option<&Topology>) {
        let result = match (&self.grabs, topology) {
            (Some(grabs), Some(topology)) => grabs.validate(topology.triangles.len()),
            _ => Ok(()),
        };
        self.authored.grabs_unchecked = topology.is_none();
        self.authored.faults.grabs = result.err();
    }
}
