//! Cloths that step together and keep off one another: for tests, benchmarks and engines without an ECS.

use glam::Vec3;

use crate::contact::GroupContacts;
use crate::tick::Pace;
use crate::{Cloth, ClothError, Pose, Tick};

/// Cloths that keep off one another.
#[derive(Clone, Debug)]
pub struct Group {
    cloths: Vec<Cloth>,
    frames: Vec<Pose>,
    contacts: GroupContacts,
}

impl Group {
    /// Of `cloths`, each with the pose of its frame, which stays as it is.
    ///
    /// # Errors
    /// A cloth without contact with itself: see [`Cloth::set_self_contact`].
    pub fn new(cloths: impl IntoIterator<Item = (Cloth, Pose)>) -> Result<Self, ClothError> {
        let (cloths, frames): (Vec<Cloth>, Vec<Pose>) = cloths.into_iter().unzip();
        let contacts = Self::contacts_of(&cloths)?;
        Ok(Self { cloths, frames, contacts })
    }

    fn contacts_of<'a>(cloths: &'a [Cloth]) -> Result<GroupContacts, ClothError> {
        let part = |(index, cloth): (usize, &'a Cloth)| match &cloth.self_contacts {
            Some(own) => Ok((&*cloth.topology, own)),
            None => Err(ClothError::NoSelfContact { index }),
        };
        Ok(GroupContacts::new(cloths.iter().enumerate().map(part).collect::<Result<Vec<_>, _>>()?))
    }

    /// The cloths, in their order.
    pub fn cloths(&self) -> &[Cloth] {
        &self.cloths
    }

    /// Changes one of them, which keeps its contact with itself.
    ///
    /// # Errors
    /// If it has none any more.
    ///
    /// # Panics
    /// If there is no cloth of that index.
    pub fn change(&mut self, index: usize, change: impl FnOnce(&mut Cloth)) -> Result<(), ClothError> {
        change(&mut self.cloths[index]);
        self.contacts = Self::contacts_of(&self.cloths)?;
        Ok(())
    }

    /// Advances all of them by one tick under `gravity` (m/s²), in the frame that theirs are placed in. They take the same substeps:
    /// as many as the one that needs most.
    pub fn step(&mut self, tick: Tick, gravity: Vec3) {
        let Self { cloths, frames, contacts } = self;
        let ticks: Vec<Tick> = (cloths.iter_mut().zip(&*frames))
            .map(|(cloth, frame)| cloth.begin_tick(tick, frame.rotation.conjugate() * gravity))
            .collect();
        let parts = cloths.iter().zip(&*frames).map(|(cloth, frame)| (*frame, &cloth.particles, &cloth.contacts));
        contacts.begin_tick(parts);
        let at_least = contacts.least_substeps(cloths.iter().map(|cloth| &cloth.particles), tick.dt);
        for (cloth, tick) in cloths.iter_mut().zip(&ticks) {
            cloth.pace.begin(tick, at_least);
        }
        let mut all: Vec<(&mut Cloth, Tick)> = cloths.iter_mut().zip(ticks).collect();
        while let Some(left) = all.iter().map(|(cloth, tick)| cloth.pace.left(tick)).reduce(f32::max) {
            let mut subs = Vec::with_capacity(all.len());
            subs.extend(all.iter().map_while(|(cloth, tick)| cloth.pace.substep_of(tick, left)));
            let Some(sub) = subs.first().copied() else { break };
            let before: Vec<Pace> = all.iter().map(|(cloth, _)| cloth.pace).collect();
            let mut is_accepted = true;
            for ((cloth, tick), sub) in all.iter_mut().zip(&subs) {
                let effort = cloth.solve(sub);
                is_accepted &= cloth.pace.accept(tick, sub, &effort);
            }
            if !is_accepted {
                all.iter_mut().zip(before).for_each(|((cloth, _), before)| cloth.pace.repeat(before));
                continue;
            }
            for (index, ((cloth, _), sub)) in all.iter_mut().zip(&subs).enumerate() {
                cloth.accept(sub);
                contacts.take(index, &cloth.particles);
            }
            contacts.collide(&sub);
            for (index, (cloth, _)) in all.iter_mut().enumerate() {
                contacts.give(index, &mut cloth.particles);
            }
        }
        for (index, cloth) in self.cloths.iter_mut().enumerate() {
            if let Some(own) = &mut cloth.self_contacts {
                self.contacts.report(index, own);
            }
        }
    }
}
