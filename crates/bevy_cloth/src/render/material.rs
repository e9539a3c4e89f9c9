//! Standard materials: one for a cloth that has none, and white ones under colours that tell something.

use bevy::color::ColorCurve;
use bevy::math::curve::Curve;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;

use super::{ClothColoring, look_material};
use crate::prepare::DrawnMesh;
use crate::settings::Shared;

/// How every Bevy material component is called, whatever its material.
const MATERIAL_COMPONENT: &str = "bevy_pbr::mesh_material::MeshMaterial3d<";

/// The material of cloth that has none: unbleached cotton. Kept while the app runs.
#[derive(Resource, Clone, Debug)]
pub(crate) struct PlainMaterial(Handle<StandardMaterial>);

impl FromWorld for PlainMaterial {
    fn from_world(world: &mut World) -> Self {
        let base_color = Color::srgb(0.93, 0.91, 0.86);
        let plain = StandardMaterial { base_color, perceptual_roughness: 0.9, ..default() };
        Self(world.resource_mut::<Assets<StandardMaterial>>().add(plain))
    }
}

/// The material a cloth had before it was coloured, and the one it shows meanwhile.
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Uncolored {
    own: Handle<StandardMaterial>,
    white: Handle<StandardMaterial>,
}

/// `own` without any colour, for vertex colours that are to be seen as they are.
///
/// It differs only in values, so that the same pipeline draws it: a cloth whose pipeline is yet to be compiled is not seen.
fn whitened(own: &StandardMaterial) -> StandardMaterial {
    StandardMaterial {
        base_color: Color::WHITE.with_alpha(own.base_color.alpha()),
        base_color_texture: None,
        emissive: LinearRgba::BLACK,
        emissive_texture: None,
        metallic: 0.0,
        perceptual_roughness: 0.9,
        metallic_roughness_texture: None,
        ..own.clone()
    }
}

/// The cloth had no material and was given one.
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct GivenMaterial;

/// Gives `entity` a material if it has none of any kind.
pub(crate) fn give_default(world: &mut World, entity: Entity) {
    let is_dressed = look_material::dresses(world, entity);
    if is_dressed || !world.contains_resource::<Assets<StandardMaterial>>() || has_material(world, entity) {
        return;
    }
    world.init_resource::<PlainMaterial>();
    let plain = world.resource::<PlainMaterial>().0.clone();
    if let Ok(mut entity) = world.get_entity_mut(entity) {
        entity.insert((MeshMaterial3d(plain), GivenMaterial));
    }
}

fn has_material(world: &World, entity: Entity) -> bool {
    let Some(registry) = world.get_resource::<AppTypeRegistry>() else { return false };
    let registry = registry.read();
    let Ok(components) = world.inspect_entity(entity) else { return true };
    if world.get::<MeshMaterial3d<StandardMaterial>>(entity).is_some() {
        return true;
    }
    components.filter_map(|component| component.type_id()).any(|id| {
        let path = registry.get_type_info(id).map(|info| info.type_path());
        path.is_some_and(|path| path.starts_with(MATERIAL_COMPONENT))
    })
}

/// Puts a white material under cloths whose colours tell something, and their own back when they no longer do.
pub(crate) fn color(
    mut cloths: Query<
        (Entity, &mut MeshMaterial3d<StandardMaterial>, Option<&ClothColoring>, Option<&Uncolored>),
        With<DrawnMesh>,
    >,
    shared: Res<Shared<ClothColoring>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, mut material, coloring, uncolored) in &mut cloths {
        let tells = *coloring.unwrap_or(&shared) != ClothColoring::Material;
        match uncolored {
            Some(known) if !tells => {
                if material.0 == known.white {
                    material.0 = known.own.clone();
                }
                commands.entity(entity).try_remove::<Uncolored>();
            }
            Some(known) if material.0 == known.white => {}
            _ if tells => {
                let white = materials.get(&material.0).map(whitened).unwrap_or_default();
                let white = materials.add(white);
                commands.entity(entity).try_insert(Uncolored { own: material.0.clone(), white: white.clone() });
                material.0 = white;
            }
            _ => {}
        }
    }
}

/// Undoes what was done to the entity's material.
pub(crate) fn take_back(entity: &mut EntityWorldMut) {
    if let Some(known) = entity.take::<Uncolored>() {
        entity.insert(MeshMaterial3d(known.own));
    }
    take_given(entity);
}

/// Takes away the material that the entity was given.
pub(crate) fn take_given(entity: &mut EntityWorldMut) {
    let plain = entity.get_resource::<PlainMaterial>().map(|plain| plain.0.clone());
    let given = entity.take::<GivenMaterial>().is_some();
    let has = entity.get::<MeshMaterial3d<StandardMaterial>>().map(|material| material.0.clone());
    if given && has == plain {
        entity.remove::<MeshMaterial3d<StandardMaterial>>();
    }
}

/// Number of colours the stress map is sampled at.
const SHADES: usize = 256;

/// The colours of stress, blue by green and yellow to red, evenly spaced to the eye; linear RGBA.
#[derive(Clone, Debug)]
pub(crate) struct StressColors(Vec<[f32; 4]>);

impl Default for StressColors {
    fn default() -> Self {
        let stops = [(0.10, 0.25, 0.85), (0.10, 0.70, 0.30), (0.98, 0.85, 0.10), (0.85, 0.08, 0.08)];
        let stops = stops.map(|(red, green, blue)| Oklaba::from(Srgba::rgb(red, green, blue)));
        let last = stops.len() as f32 - 1.0;
        let shade = |curve: &ColorCurve<Oklaba>, i: usize| {
            LinearRgba::from(curve.sample_clamped(last * i as f32 / (SHADES - 1) as f32)).to_f32_array()
        };
        // Four stops always make a curve; should that change, everything is white.
        let curve = ColorCurve::new(stops);
        Self(curve.map_or(vec![[1.0; 4]; SHADES], |curve| (0..SHADES).map(|i| shade(&curve, i)).collect()))
    }
}

impl StressColors {
    /// The colour of a stress, 0 at rest, 1 at the limit and beyond.
    pub fn at(&self, stress: f32) -> [f32; 4] {
        // A NaN casts to 0.
        let index = (stress.clamp(0.0, 1.0) * (SHADES - 1) as f32) as usize;
        self.0[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::pbr::StandardMaterialKey;

    #[test]
    fn stress_goes_from_blue_by_green_and_yellow_to_red() {
        let colors = StressColors::default();
        let [low, third, two_thirds, high] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|stress| colors.at(stress));
        assert!(low[2] > low[0] && low[2] > low[1], "{low:?}");
        assert!(third[1] > third[0] && third[1] > third[2], "{third:?}");
        assert!(two_thirds[0] > 0.5 && two_thirds[1] > 0.5 && two_thirds[2] < 0.2, "{two_thirds:?}");
        assert!(high[0] > high[1] && high[0] > high[2], "{high:?}");
    }

    #[test]
    fn whatever_the_material_the_same_pipeline_draws_it_white() {
        let textured = StandardMaterial {
            base_color: Color::srgb(0.2, 0.5, 0.1),
            base_color_texture: Some(Handle::default()),
            normal_map_texture: Some(Handle::default()),
            metallic_roughness_texture: Some(Handle::default()),
            emissive_texture: Some(Handle::default()),
            emissive: LinearRgba::RED,
            diffuse_transmission: 0.4,
            clearcoat: 0.3,
            anisotropy_strength: 0.5,
            metallic: 1.0,
            cull_mode: None,
            double_sided: true,
            alpha_mode: AlphaMode::Blend,
            depth_bias: 3.0,
            ..default()
        };
        for own in [StandardMaterial::default(), textured] {
            let white = whitened(&own);
            assert_eq!(StandardMaterialKey::from(&white), StandardMaterialKey::from(&own));
            assert_eq!((white.alpha_mode, white.double_sided), (own.alpha_mode, own.double_sided));
            assert_eq!(white.base_color, Color::WHITE);
        }
    }

    #[test]
    fn any_number_has_a_colour() {
        let colors = StressColors::default();
        assert_eq!(colors.at(7.0), colors.at(1.0));
        assert_eq!(colors.at(-7.0), colors.at(0.0));
        assert_eq!(colors.at(f32::NAN), colors.at(0.0));
    }
}
