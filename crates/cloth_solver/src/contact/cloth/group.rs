//! Contact among several cloths that step together: what keeps one cloth off itself, over the particles of all of them.
//!
//! A group has its own copy of their particles, in one frame that does not move with any of them. In each substep it takes them in,
//! keeps them off one another, and gives every cloth what changed: so momentum stays to rounding, whatever frames the cloths have.

use std::ops::Range;

use glam::{DVec3, Vec3};

use super::features::Features;
use super::hierarchy::Hierarchy;
use super::state::{Solids, State};
use super::surfaces::{Settings, Surfaces};
use super::{Found, SelfContacts};
use crate::contact::{Collider, Contacts};
use crate::tick::Substep;
use crate::{Motion, Particles, Pose, Soa3, Topology};

/// A group whose frame is farther from one of its cloths than this, m, takes another one: beyond, positions are not exact enough.
const FARTHEST: f32 = 64.0;

/// Contact among cloths that step together: each off itself and off the others.
///
/// All of them have to take the same substeps; in each of them, after [`collide`](crate::contact::collide), first [`take`](Self::take)
/// in every cloth, then [`collide`](Self::collide), then [`give`](Self::give) to every cloth; after the last of a tick
/// [`report`](Self::report).
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub struct GroupContacts {
    members: Vec<Member>,
    /// All of them in one, as far as contact needs to know.
    topology: Topology,
    particles: Particles,
    pub(super) state: State,
}

#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
struct Member {
    slots: Range<u32>,
    triangles: Range<u32>,
    settings: Settings,
    /// Its frame as seen from that of the group.
    frame: Pose,
    /// The solids that stop it, in the frame of the group.
    contacts: Contacts,
}

impl GroupContacts {
    /// Of the cloths with these topologies and this contact with themselves, in the order in which they are to be named.
    pub fn new<'a>(cloths: impl IntoIterator<Item = (&'a Topology, &'a SelfContacts)>) -> Self {
        let cloths: Vec<(&Topology, &SelfContacts)> = cloths.into_iter().collect();
        let mut topology = Topology::default();
        let mut members = Vec::with_capacity(cloths.len());
        for (cloth, own) in &cloths {
            let (slot, triangle) = (topology.rest.len() as u32, topology.triangles.len() as u32);
            topology.rest.extend(&cloth.rest);
            topology.area.extend(&cloth.area);
            topology.triangles.extend(cloth.triangles.iter().map(|corners| corners.map(|corner| corner + slot)));
            members.push(Member {
                slots: slot..topology.rest.len() as u32,
                triangles: triangle..topology.triangles.len() as u32,
                settings: own.settings,
                frame: Pose::IDENTITY,
                contacts: Contacts::default(),
            });
        }
        let states = || cloths.iter().map(|(cloth, own)| (*cloth, &own.state));
        let surfaces = Surfaces::new(cloths.iter().map(|(cloth, own)| (own.settings, cloth.slots())));
        let hierarchy = Hierarchy::join(
            states().map(|(cloth, state)| (&state.watch.hierarchy, cloth.slots() as u32, cloth.triangles.len() as u32)),
        );
        let features = Features::join(states().map(|(_, state)| state.pairs.features()));
        let slots = topology.slots();
        let zeros = || Soa3::zeros(slots);
        let particles = Particles {
            position: zeros(),
            previous: zeros(),
            velocity: zeros(),
            mass: vec![0.0; slots],
            inverse_mass: vec![0.0; slots],
            ..Particles::default()
        };
        Self { members, topology, particles, state: State::of(surfaces, hierarchy, features) }
    }

    /// Whether it is of cloths with this contact with themselves.
    pub fn is_of<'a>(&self, cloths: impl Iterator<Item = &'a SelfContacts>) -> bool {
        self.members.iter().map(|member| &member.settings).eq(cloths.map(|own| &own.settings))
    }

    /// Whether the frame of each cloth, as seen from that of the group, is near enough for positions to be exact: nearer than 64 m. If not
    /// it has to be made anew, with another frame.
    pub fn is_near(&self, mut frames: impl Iterator<Item = Pose>) -> bool {
        frames.all(|frame| frame.position.length() < FARTHEST)
    }

    /// Begins a tick in which the frame of each cloth stands so, as seen from that of the group; in their order.
    pub fn begin_tick<'a>(&mut self, cloths: impl IntoIterator<Item = (Pose, &'a Particles, &'a Contacts)>) {
        for (member, (frame, particles, contacts)) in self.members.iter_mut().zip(cloths) {
            member.frame = frame;
            let slots = member.slots.start as usize..member.slots.end as usize;
            self.particles.mass[slots].copy_from_slice(&particles.mass);
            member.contacts.offset = contacts.offset;
            member.contacts.set_colliders(contacts.colliders.iter().map(|collider| Collider {
                motion: Motion { from: placed(&frame, &collider.motion.from), to: placed(&frame, &collider.motion.to) },
                ..collider.clone()
            }));
        }
    }

    /// The least number of substeps of a tick of `dt` s in which no two particles move farther against each other than half an edge in
    /// one: what meets is then stopped where it is met, and there are not too many pairs that may.
    pub fn least_substeps<'a>(&self, cloths: impl Iterator<Item = &'a Particles> + Clone, dt: f32) -> f32 {
        let (mut mass, mut momentum) = (0.0_f64, DVec3::ZERO);
        let velocities = self.members.iter().zip(cloths).map(|(member, particles)| {
            let velocity = move |slot: usize| member.frame.rotation * particles.velocity.get(slot);
            (particles, velocity)
        });
        for (particles, velocity) in velocities.clone() {
            for (slot, m) in particles.mass.iter().enumerate() {
                mass += f64::from(*m);
                momentum += (velocity(slot) * *m).as_dvec3();
            }
        }
        let mean = if mass > 0.0 { (momentum / mass).as_vec3() } else { Vec3::ZERO };
        let all = velocities.flat_map(|(particles, velocity)| {
            let free = (0..particles.slots()).filter(|slot| particles.mass[*slot] > 0.0);
            free.map(move |slot| velocity(slot).distance_squared(mean))
        });
        4.0 * all.fold(0.0, f32::max).sqrt() * dt / self.state.surfaces.edge
    }

    /// Takes in cloth number `index` as it is after it was kept off solids.
    ///
    /// # Panics
    /// If there is no such cloth, or it has another number of slots than it had.
    pub fn take(&mut self, index: usize, particles: &Particles) {
        let Member { slots, frame, .. } = &self.members[index];
        let slots = slots.start as usize..slots.end as usize;
        let turn = Pose::new(Vec3::ZERO, frame.rotation);
        let joint = &mut self.particles;
        joint.inverse_mass[slots.clone()].copy_from_slice(&particles.inverse_mass);
        let all = [
            (&mut joint.position, &particles.position, frame),
            (&mut joint.previous, &particles.previous, frame),
            (&mut joint.velocity, &particles.velocity, &turn),
        ];
        for (to, from, frame) in all {
            if *frame == Pose::IDENTITY {
                to.x[slots.clone()].copy_from_slice(&from.x);
                to.y[slots.clone()].copy_from_slice(&from.y);
                to.z[slots.clone()].copy_from_slice(&from.z);
            } else {
                for (slot, at) in slots.clone().enumerate() {
                    to.set(at, frame.point(from.get(slot)));
                }
            }
        }
    }

    /// One substep's worth of contact.
    pub fn collide(&mut self, sub: &Substep) {
        let Self { members, topology, particles, state } = self;
        let solids: Vec<Solids> =
            (members.iter()).map(|member| Solids { slots: member.slots.clone(), contacts: &member.contacts }).collect();
        state.collide(topology, particles, &solids, sub);
    }

    /// Gives cloth number `index` what changed.
    ///
    /// # Panics
    /// If there is no such cloth, or it has another number of slots than it had.
    pub fn give(&self, index: usize, particles: &mut Particles) {
        let Member { slots, frame, .. } = &self.members[index];
        let turn = Pose::new(Vec3::ZERO, frame.rotation);
        let slots = slots.start as usize..slots.end as usize;
        let joint = &self.particles;
        let all =
            [(&mut particles.position, &joint.position, frame), (&mut particles.velocity, &joint.velocity, &turn)];
        for (to, from, frame) in all {
            if *frame == Pose::IDENTITY {
                to.x.copy_from_slice(&from.x[slots.clone()]);
                to.y.copy_from_slice(&from.y[slots.clone()]);
                to.z.copy_from_slice(&from.z[slots.clone()]);
            } else {
                for (slot, at) in slots.clone().enumerate() {
                    // The change has the precision of a small number; what did not change stays as it is.
                    let before = to.get(slot);
                    let change = from.get(at) - frame.point(before);
                    if change != Vec3::ZERO {
                        to.set(slot, before + frame.rotation.conjugate() * change);
                    }
                }
            }
        }
    }

    /// Says in the contact of cloth number `index` with itself what was found of it in the last substep.
    ///
    /// # Panics
    /// If there is no such cloth.
    pub fn report(&self, index: usize, own: &mut SelfContacts) {
        let Member { slots, triangles, .. } = &self.members[index];
        let State { response, pairs, tangle, .. } = &self.state;
        let is_of = |ids: &[u32; 4]| ids.iter().any(|id| slots.contains(id));
        own.found = Found {
            touching: response.pressing().filter(|ids| is_of(ids)).count() as u32,
            candidates: pairs.iter().filter(|pair| is_of(&pair.ids)).count(),
            tangled: (tangle.passages.iter())
                .filter(|passage| slots.contains(&passage.edge[0]) || triangles.contains(&passage.triangle))
                .count(),
            is_bounded: pairs.is_bounded,
        };
    }

    /// The slots of a cloth among those of the group, and its frame as seen from that of the group.
    pub(super) fn slots_and_frame(&self, index: usize) -> Option<(Range<u32>, Pose)> {
        self.members.get(index).map(|member| (member.slots.clone(), member.frame))
    }

    /// How often candidates have been looked for so far, everywhere or around some particles.
    pub fn searches(&self) -> u32 {
        self.state.watch.searches
    }
}

/// `frame ∘ inner`.
fn placed(frame: &Pose, inner: &Pose) -> Pose {
    if *frame == Pose::IDENTITY {
        return *inner;
    }
    Pose::new(frame.point(inner.position), (frame.rotation * inner.rotation).normalize())
}
