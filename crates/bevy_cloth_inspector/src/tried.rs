//! A part that the user has left out to see what happens, and what there was before.

use bevy::prelude::*;
use bevy_cloth::{Air, Cloth, ClothSource, Fabric, Resolution, SelfContact, Shared, Substeps, Tearable};
use cloth_advice::Change;

/// A change of a cloth that can be taken back.
#[derive(Clone, Debug)]
pub struct Tried {
    /// What is tried, in words.
    pub name: String,
    before: Before,
}

/// What there was before.
#[derive(Clone, Debug)]
enum Before {
    /// Along warp and weft.
    Bending([f32; 2]),
    Shear(f32),
    Air(Air),
    SelfContact(SelfContact),
    Tearable(Tearable),
    Source(ClothSource),
    /// Those that the cloth had of its own.
    Substeps(Option<Substeps>),
}

impl Tried {
    /// What trying `change` does, in a sentence.
    pub fn hint(change: &Change) -> &'static str {
        match change {
            Change::Coarser(_) => "Does it, and the cloth begins anew from its rest shape; it can be taken back below.",
            _ => "Does it; it can be taken back below.",
        }
    }

    /// Changes `cloth`. `None` if it does not have what is left out.
    pub fn apply(world: &mut World, cloth: Entity, change: &Change) -> Option<Self> {
        let shared = world.get_resource::<Shared<Substeps>>().map(|shared| shared.0).unwrap_or_default();
        let mut entity = world.get_entity_mut(cloth).ok()?;
        let before = match *change {
            Change::NoBending | Change::NoShear => {
                let mut fabric = entity.get_mut::<Fabric>()?;
                let Fabric { bend_warp, bend_weft, shear, .. } = *fabric;
                change.change_fabric(&mut fabric);
                if *change == Change::NoShear { Before::Shear(shear) } else { Before::Bending([bend_warp, bend_weft]) }
            }
            Change::NoAir => Before::Air(entity.take()?),
            Change::NoSelfContact => Before::SelfContact(entity.take()?),
            Change::NoTearing => Before::Tearable(entity.take()?),
            Change::Coarser(times) => {
                let mut cloth = entity.get_mut::<Cloth>()?;
                let before = cloth.source.clone();
                let ClothSource::Rectangle { resolution, .. } = &mut cloth.source else { return None };
                *resolution = match *resolution {
                    Resolution::Spacing(spacing) => Resolution::Spacing(spacing * times as f32),
                    Resolution::Cells(cells) => Resolution::Cells((cells / times.max(1)).max(UVec2::ONE)),
                };
                Before::Source(before)
            }
            Change::Budget { substeps, iterations, .. } => {
                let own = entity.get::<Substeps>().copied();
                let now = own.unwrap_or(shared);
                entity.insert(Substeps { count: substeps, iterations, ..now });
                Before::Substeps(own)
            }
            Change::Inextensible | Change::NoFriction | Change::NoColliders(_) => return None,
        };
        let name = match change {
            Change::Coarser(_) | Change::Budget { .. } => change.name(),
            _ => format!("no {}", change.name()),
        };
        Some(Self { name, before })
    }

    /// Puts back what there was, and leaves all else as it is now.
    pub fn take_back(self, world: &mut World, cloth: Entity) {
        let Ok(mut entity) = world.get_entity_mut(cloth) else { return };
        match self.before {
            Before::Bending([warp, weft]) => {
                if let Some(mut fabric) = entity.get_mut::<Fabric>() {
                    (fabric.bend_warp, fabric.bend_weft) = (warp, weft);
                }
            }
            Before::Shear(shear) => {
                if let Some(mut fabric) = entity.get_mut::<Fabric>() {
                    fabric.shear = shear;
                }
            }
            Before::Air(air) => _ = entity.insert(air),
            Before::SelfContact(settings) => _ = entity.insert(settings),
            Before::Tearable(tearable) => _ = entity.insert(tearable),
            Before::Source(source) => {
                if let Some(mut cloth) = entity.get_mut::<Cloth>() {
                    cloth.source = source;
                }
            }
            Before::Substeps(Some(substeps)) => _ = entity.insert(substeps),
            Before::Substeps(None) => _ = entity.remove::<Substeps>(),
        }
    }
}

#[cfg(test)]
mod tests {
    use bevy_cloth::Method;

    use super::*;

    type Parts = (Cloth, Fabric, Option<Air>, Option<SelfContact>, Option<Tearable>, Option<Substeps>);

    fn parts(world: &World, cloth: Entity) -> Parts {
        let entity = world.entity(cloth);
        let (source, fabric) = (entity.get().cloned().unwrap(), *entity.get().unwrap());
        (source, fabric, entity.get().copied(), entity.get().copied(), entity.get().copied(), entity.get().copied())
    }

    #[test]
    fn whatever_is_tried_changes_the_cloth_and_is_taken_back_in_any_order() {
        let mut world = World::new();
        world.init_resource::<Shared<Substeps>>();
        let extras = (Air::default(), SelfContact::default(), Tearable::default());
        let cloth = world.spawn((Cloth::rectangle(1.0, 1.0), extras)).id();
        let before = parts(&world, cloth);
        let changes = [
            Change::NoBending,
            Change::NoShear,
            Change::NoAir,
            Change::NoSelfContact,
            Change::NoTearing,
            Change::Coarser(2),
            Change::Budget { method: Method::default(), substeps: 3, iterations: 1 },
        ];
        let mut tried = Vec::new();
        for change in &changes {
            let was = parts(&world, cloth);
            tried.push(Tried::apply(&mut world, cloth, change).unwrap());
            assert_ne!(parts(&world, cloth), was, "{change:?}");
        }
        tried.into_iter().for_each(|tried| tried.take_back(&mut world, cloth));
        assert_eq!(parts(&world, cloth), before);
    }
}
