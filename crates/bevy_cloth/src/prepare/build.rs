//! Takes changes of a cloth's authored components over into its runtime state.

use std::sync::Arc;

use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::constraint::Pins as SolverPins;
use cloth_solver::contact::{Contacts, SelfContacts};
use cloth_solver::forces::Gusts;
use cloth_solver::rest::Rest;
use cloth_solver::{Cloth as SolverCloth, ClothError, Fabric, Particles, Pose, Soa3, Topology};

use super::anchors::{self, Anchors};
use super::armature::{Armature, Skins, influences};
use super::authored::{WaitsFor, Wanted, WantedItem, user_mesh};
use super::placement::{Placement, Placements};
use super::shared::{SharedSettings, SharedValues};
use super::source::shape;
use super::{ClothSkin, DrawnMesh, Follow, StepPlan};
use crate::air::Wind;
use crate::cloth::{Cloth, ClothFrame, ClothHistory, ClothMended, ClothRejection, ClothSource, ClothTopology};
use crate::damage::{ClothFire, ClothPieces, Flammable, TearState, Tearable};
use crate::events::ClothRejected;
use crate::freedom::Freedom;
use crate::particle_pins::ParticlePins;
use crate::pins::Pins;
use crate::report::{report, warn_of};
use crate::settings::{Grabs, Gravity, Substeps};
use crate::shown::ShownShape;
use crate::sleep::{ClothAsleep, ClothSleep, wake_up};
use crate::teleport::Teleport;
use crate::weights::{Loads, Weights};
use crate::{Air, Method, SelfContact};

/// The runtime state of one cloth, as far as a change of fabric or pins touches it.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Running {
    topology: &'static ClothTopology,
    skin: &'static ClothSkin,
    frame: &'static ClothFrame,
    particles: &'static mut Particles,
    constraints: &'static mut Constraints,
    contacts: &'static mut Contacts,
    anchors: &'static mut Anchors,
    armature: Option<&'static Armature>,
    loads: &'static mut Loads,
    fire: Option<&'static mut ClothFire>,
}

/// Everything a build reads beside the cloth itself.
#[derive(SystemParam)]
pub(crate) struct Surroundings<'w, 's> {
    placements: Placements<'w, 's>,
    meshes: Option<Res<'w, Assets<Mesh>>>,
    skins: Skins<'w>,
    shared: SharedSettings<'w>,
}

/// The cloths that have to be looked at if neither a shared setting nor a mesh changed: all that are awake, and those of the
/// others of which someone wrote to a component.
type Touched = (
    With<Cloth>,
    Or<(
        Without<ClothAsleep>,
        Or<(Changed<Cloth>, Changed<Fabric>, Changed<Pins>, Changed<Weights>, Changed<Transform>, Changed<Mesh3d>)>,
        Or<(Changed<Gravity>, Changed<Substeps>, Changed<Method>, Changed<Teleport>, Changed<ClothSleep>)>,
        Or<(Changed<SelfContact>, Changed<ParticlePins>, Changed<Freedom>, Changed<SkinnedMesh>)>,
        Or<(Changed<Grabs>, Changed<Tearable>, Changed<Flammable>, Changed<Air>, Changed<Wind>, Changed<Gusts>)>,
    )>,
);

/// Looks at every cloth that is awake or touched, and renews what changed, no more. In a quiet tick it only compares.
pub(crate) fn build(
    mut cloths: Query<(Wanted, Option<Running>)>,
    touched: Query<Entity, Touched>,
    asleep: Query<(Entity, &Mesh3d, Option<&DrawnMesh>), With<ClothAsleep>>,
    around: Surroundings,
    mesh_events: Option<MessageReader<AssetEvent<Mesh>>>,
    mut modified: Local<HashSet<AssetId<Mesh>>>,
    mut seen: Local<SharedValues>,
    mut commands: Commands,
) {
    modified.clear();
    if let Some(mut events) = mesh_events {
        modified.extend(events.read().filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(*id),
            _ => None,
        }));
    }
    let shared_changes = around.shared.changes(&mut seen);
    let mut look = |(mut wanted, mut running): (WantedItem, Option<RunningItem>)| {
        let shared = &around.shared;
        let placement = around.placements.get(wanted.entity);
        let changes = wanted.notice(placement, around.meshes.as_deref(), &modified, shared, running.is_some());
        if let Some(cause) = wanted.wakes(&changes, &shared_changes) {
            wake_up(&mut commands, wanted.entity, cause);
        }
        if changes == default() {
            return;
        }
        if changes.settings || changes.self_contact || changes.shared {
            wanted.check_settings(shared);
        }
        if changes.shape || (wanted.authored.stale && changes.fabric) {
            wanted.build_shape(placement, &around, running.is_some(), &mut commands);
        } else if let Some(running) = running.as_mut().filter(|_| !wanted.authored.stale) {
            if changes.weights {
                wanted.authored.faults.weights = running.change_weights(&wanted).err();
            }
            if changes.fabric || changes.weights {
                wanted.authored.faults.fabric = running.change_fabric(&wanted.fabric()).err();
            }
            if changes.fabric || changes.self_contact {
                wanted.renew_self_contacts(&running.topology.0, &mut commands);
            }
            if changes.pins {
                wanted.authored.faults.pins = running.change_pins(&wanted, &around.placements).err();
            }
            if changes.pins || changes.particle_pins {
                let edits = wanted.particle_pins();
                wanted.authored.faults.particle_pins = running.edit_pins(edits, &around.placements).err();
            }
        }
        if changes.grabs {
            wanted.check_grabs(running.map(|running| &*running.topology.0));
        }
        wanted.tell(&mut commands);
    };
    if shared_changes.touched {
        cloths.iter_mut().for_each(look);
        return;
    }
    let is_modified = |mesh, drawn| user_mesh(Some(mesh), drawn).is_some_and(|id| modified.contains(&id));
    let remade = asleep.iter().filter(|(_, mesh, drawn)| !modified.is_empty() && is_modified(mesh, *drawn));
    for entity in touched.iter().chain(remade.map(|(entity, ..)| entity)) {
        if let Ok(cloth) = cloths.get_mut(entity) {
            look(cloth);
        }
    }
}

impl WantedItem<'_, '_> {
    /// Builds the runtime state from nothing, or says what is wrong or waited for.
    fn build_shape(
        &mut self,
        placement: Option<Placement>,
        around: &Surroundings,
        renew: bool,
        commands: &mut Commands,
    ) {
        let placement = placement.unwrap_or(Placement { pose: Pose::IDENTITY, scale: Vec3::ONE });
        self.authored.waits_for = None;
        self.authored.faults.source = None;
        self.authored.faults.fabric = self.fabric().validate().err();
        if !placement.is_finite() {
            self.authored.waits_for = Some(WaitsFor::FiniteTransform);
            self.authored.faults.source = Some(not_finite("Transform", &placement));
            return;
        }
        let mesh = match self.source() {
            ClothSource::Rectangle { .. } => None,
            ClothSource::Mesh => {
                let mesh = self.user_mesh().and_then(|id| around.meshes.as_ref()?.get(id));
                if mesh.is_none() {
                    self.authored.waits_for = Some(WaitsFor::Mesh);
                    return;
                }
                mesh
            }
        };
        let skin = self.skin().filter(|_| mesh.is_some());
        let binding = match (skin, mesh.and_then(influences)) {
            (Some(skin), Some(influences)) => match around.skins.bind(influences, &skin, &around.placements) {
                Ok(Some(binding)) => Some((binding, skin)),
                Ok(None) => {
                    self.authored.waits_for = Some(WaitsFor::Skin);
                    return;
                }
                Err(error) => {
                    self.authored.faults.source = Some(error);
                    return;
                }
            },
            _ => None,
        };
        let scale = binding.as_ref().map_or(placement.scale, |(binding, _)| binding.scale);
        match shape(self.source(), scale, mesh) {
            Err(error) => self.authored.faults.source = Some(error),
            Ok(_) if self.authored.faults.fabric.is_some() => {}
            Ok((topology, skin)) => {
                let (topology, skin) = (ClothTopology(Arc::new(topology)), ClothSkin(Arc::new(skin)));
                let whole = topology.0.clone();
                let armature = binding.as_ref().map(|(binding, _)| binding.armature(&whole));
                match self.assemble(topology, skin, placement, armature.as_ref(), &around.placements, renew) {
                    Err(error) => self.authored.faults.fabric = Some(error),
                    Ok(state) => {
                        self.authored.stale = false;
                        self.authored.origin = whole.fingerprint();
                        let mut entity = commands.entity(self.entity);
                        entity.try_insert(state);
                        match armature.zip(binding) {
                            Some((armature, (_, taken))) => {
                                // The cloth is drawn where its joints take it: nobody is to do that once more.
                                entity.try_insert((armature, taken)).try_remove::<SkinnedMesh>();
                            }
                            None => _ = entity.try_remove::<Armature>(),
                        }
                        if renew {
                            // What was held, torn or burnt is no more.
                            entity
                                .try_remove::<(Grabs, ParticlePins, ClothPieces, TearState, ClothFire, SelfContacts)>();
                        }
                        self.renew_self_contacts(&whole, commands);
                        self.tell_mended(&whole, commands);
                    }
                }
            }
        }
    }

    /// All runtime components of a cloth at rest. Wrong pins are noted and left away.
    fn assemble(
        &mut self,
        topology: ClothTopology,
        skin: ClothSkin,
        placement: Placement,
        armature: Option<&Armature>,
        placements: &Placements,
        renew: bool,
    ) -> Result<impl Bundle + use<>, ClothError> {
        let fabric = self.fabric();
        let pose = placement.pose;
        let frame = ClothFrame {
            pose,
            scale: placement.scale,
            before: pose,
            follow: Follow::new(pose),
            carried: false,
            lost: false,
        };
        let SolverCloth { mut particles, mut constraints, contacts, .. } =
            SolverCloth::new(topology.0.clone(), &fabric)?;
        if let Some(armature) = armature {
            particles.position = Soa3::from_slice(&armature.now(&frame, placements));
            particles.previous.copy_from(&particles.position);
        }
        let history = ClothHistory { position: particles.position.clone(), strokes: Default::default() };
        let loads = Loads::find(self.weights(), &topology, &skin.0);
        self.authored.faults.weights = loads.as_ref().err().cloned();
        let loads = loads.unwrap_or_default();
        loads.hang(&mut particles)?;
        let mut anchors = Anchors::default();
        self.authored.faults.pins = None;
        if let Some(worn) = self.worn(armature) {
            let made = anchors::make(worn, &topology, &skin.0, &particles.position, &frame, placements);
            let hung = made.and_then(|(pins, anchors)| constraints.set_pins(&mut particles, pins).map(|()| anchors));
            match hung {
                Ok(made) => anchors = made,
                Err(error) => self.authored.faults.pins = Some(error),
            }
        }
        self.authored.faults.particle_pins = None;
        // Those of a cloth that is rebuilt name particles that are no more, and are removed.
        if let Some(edits) = self.particle_pins().filter(|_| !renew) {
            let (pins, mass) = (constraints.pins(), &particles.mass);
            let edited = anchors::edit(pins, &mut anchors, Some(edits), &topology, mass, &frame, placements);
            let held = edited.and_then(|pins| constraints.set_pins(&mut particles, pins));
            self.authored.faults.particle_pins = held.err();
        }
        constraints.set_skin(&particles, anchors.skin(self.particle_pins().filter(|_| !renew)))?;
        let plan = (StepPlan::default(), Rest::default(), ShownShape::default());
        Ok((topology, skin, frame, particles, constraints, contacts, history, anchors, loads, plan))
    }

    /// Contact with itself, over `topology`, as it is wanted now: none, or anew. What is refused changes nothing.
    fn renew_self_contacts(&self, topology: &Topology, commands: &mut Commands) {
        let mut entity = commands.entity(self.entity);
        match self.self_contact() {
            None => {
                entity.try_remove::<SelfContacts>();
            }
            Some(settings) if self.authored.faults.fabric.is_none() => {
                if let Ok(own) = SelfContacts::new(topology, &self.fabric(), settings) {
                    entity.try_insert(own);
                }
            }
            Some(_) => {}
        }
    }

    /// Tells what was wrong with the mesh and is mended, if that is something new.
    fn tell_mended(&mut self, topology: &Topology, commands: &mut Commands) {
        let mended = topology.mended;
        if mended == std::mem::replace(&mut self.authored.mended, mended) {
            return;
        }
        if mended.is_nothing() {
            commands.entity(self.entity).try_remove::<ClothMended>();
        } else {
            commands.entity(self.entity).try_insert(ClothMended(mended));
            warn_of(commands, self.entity, move |name| format!("the mesh of cloth {name} was mended: {mended}"));
        }
    }

    /// Tells what is wrong if it was not told before, and takes the refusal back if nothing is.
    fn tell(&self, commands: &mut Commands) {
        match (self.authored.faults.first(), self.rejection) {
            // Compared as text, since a NaN is different from itself.
            (Some(error), Some(known)) if error.to_string() == known.0.to_string() => {}
            (Some(error), _) => {
                commands.entity(self.entity).try_insert(ClothRejection(error.clone()));
                report(commands, ClothRejected { entity: self.entity, error: error.clone() });
            }
            (None, Some(_)) => {
                commands.entity(self.entity).try_remove::<ClothRejection>();
            }
            (None, None) => {}
        }
    }
}

impl RunningItem<'_, '_> {
    /// Other weights; [`change_fabric`](Self::change_fabric) hangs them on. If they are refused it has none.
    fn change_weights(&mut self, wanted: &WantedItem) -> Result<(), ClothError> {
        let loads = Loads::find(wanted.weights(), &self.topology.0, &self.skin.0);
        let result = loads.as_ref().map(|_| ()).map_err(Clone::clone);
        *self.loads = loads.unwrap_or_default();
        result
    }

    /// Another fabric, or other weights, over the same topology: shape, speed and pins stay.
    fn change_fabric(&mut self, fabric: &Fabric) -> Result<(), ClothError> {
        let new = SolverCloth::new(self.topology.0.clone(), fabric)?;
        let (mut particles, mut constraints) = (new.particles, new.constraints);
        self.loads.hang(&mut particles)?;
        let pins = self.constraints.pins().clone();
        constraints.set_pins(&mut particles, pins)?;
        constraints.set_skin(&particles, self.constraints.skin().cloned())?;
        let old = &mut *self.particles;
        std::mem::swap(&mut particles.position, &mut old.position);
        std::mem::swap(&mut particles.previous, &mut old.previous);
        std::mem::swap(&mut particles.velocity, &mut old.velocity);
        particles.force = old.force.take();
        *old = particles;
        constraints.grabs = std::mem::take(&mut self.constraints.grabs);
        *self.constraints = constraints;
        *self.contacts = new.contacts;
        if let Some(fire) = &mut self.fire {
            fire.renew();
        }
        Ok(())
    }

    /// Other pins on the same cloth. If they are refused it has none.
    fn change_pins(&mut self, wanted: &WantedItem, placements: &Placements) -> Result<(), ClothError> {
        let made = match wanted.worn(self.armature) {
            Some(worn) => {
                let position = &self.particles.position;
                anchors::make(worn, &self.topology.0, &self.skin.0, position, self.frame, placements)
            }
            None => Ok((SolverPins::default(), Anchors::default())),
        };
        let (pins, anchors, result) = match made {
            Ok((pins, anchors)) => (pins, anchors, Ok(())),
            Err(error) => (SolverPins::default(), Anchors::default(), Err(error)),
        };
        *self.anchors = anchors;
        self.constraints.set_skin(&self.particles, None)?;
        self.constraints.set_pins(&mut self.particles, pins)?;
        self.constraints.set_skin(&self.particles, self.anchors.skin(None))?;
        result
    }

    /// Other pins on single particles. If they are refused there are only those of `Pins`.
    fn edit_pins(&mut self, edits: Option<&ParticlePins>, placements: &Placements) -> Result<(), ClothError> {
        let mut edit = |edits| {
            let (pins, mass) = (self.constraints.pins(), &self.particles.mass);
            anchors::edit(pins, &mut self.anchors, edits, &self.topology.0, mass, self.frame, placements)
        };
        let (pins, result) = match edit(edits) {
            Ok(pins) => (pins, Ok(())),
            Err(error) => (edit(None)?, Err(error)),
        };
        self.constraints.set_pins(&mut self.particles, pins)?;
        let edits = edits.filter(|_| result.is_ok());
        self.constraints.set_skin(&self.particles, self.anchors.skin(edits))?;
        result
    }
}

/// The error for a transform that is not finite.
pub(crate) fn not_finite(field: &'static str, placement: &Placement) -> ClothError {
    let Placement { pose, scale } = placement;
    let numbers = pose.position.to_array().into_iter().chain(pose.rotation.to_array()).chain(scale.to_array());
    let value = numbers.into_iter().find(|x| !x.is_finite()).unwrap_or(f32::NAN);
    ClothError::OutOfRange { field, value, allowed: "finite numbers, and a rotation that is not zero" }
}
