//! The material of cloth that has a [`ClothLook`]: made, updated and taken away.

use bevy::light::TransmittedShadowReceiver;
use bevy::pbr::{ExtendedMaterial, MaterialExtension, MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use bevy::shader::ShaderRef;

use super::look::{ClothLook, Pattern, Weave};
use super::weave::WeaveTextures;
use super::write::Drawing;
use super::{ClothColoring, material, wear};
use crate::settings::Shared;

/// Where in the cloth light that shines through is shadowed, m behind its surface: beyond its other face and the bias of
/// shadow maps.
const THROUGH: f32 = 0.03;

/// The material of a cloth with a [`ClothLook`]. The plugin makes one for each such cloth.
pub type ClothMaterial = ExtendedMaterial<StandardMaterial, FabricExtension>;

/// What a fabric has beside a [`StandardMaterial`]. Follows from the cloth's [`ClothLook`].
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
pub struct FabricExtension {
    #[uniform(100)]
    fabric: FabricUniform,
    #[texture(101)]
    #[sampler(102)]
    weave: Handle<Image>,
    #[texture(103)]
    noise: Handle<Image>,
}

/// What the shader is told. Its twin is in `fabric_types.wgsl`.
#[derive(ShaderType, Clone, Debug, Default, PartialEq)]
pub(super) struct FabricUniform {
    color: LinearRgba,
    second: LinearRgba,
    /// Metres of cloth along a unit of u and of v.
    metres: Vec2,
    /// Metres of cloth along the texture of the weave.
    tile: f32,
    /// Threads per metre.
    threads: f32,
    /// Width of stripes, m.
    pattern_width: f32,
    /// 0 none, 1 stripes down, 2 stripes across, 3 check, 4 border.
    pattern: u32,
    sheen: f32,
    gloss: f32,
    translucency: f32,
    /// How much the threads stand out.
    relief: f32,
    /// How creased it is.
    crumple: f32,
    /// How uneven the threads are.
    slub: f32,
    /// 1 for a pile, which is dark where it is looked into.
    pile: f32,
    /// Distance from a torn edge within which cloth frays, m.
    fray_reach: f32,
    /// Whether the colours of the vertices tell something and are to be seen as they are.
    tells: u32,
}

impl MaterialExtension for FabricExtension {
    fn fragment_shader() -> ShaderRef {
        "embedded://bevy_cloth/render/fabric.wgsl".into()
    }

    fn prepass_fragment_shader() -> ShaderRef {
        "embedded://bevy_cloth/render/fabric_prepass.wgsl".into()
    }

    /// Fringes and holes are left out in every pass. The shader does so itself.
    fn alpha_mode() -> Option<AlphaMode> {
        Some(AlphaMode::Mask(0.5))
    }
}

/// The cloth shows this material, and the one it had before was put aside.
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct LookMaterial {
    shown: Handle<ClothMaterial>,
    uniform: FabricUniform,
    own: Option<Handle<StandardMaterial>>,
}

/// Whether `entity` shows a look, so that it needs no other material.
pub(super) fn dresses(world: &World, entity: Entity) -> bool {
    world.contains_resource::<Assets<ClothMaterial>>() && world.get::<ClothLook>(entity).is_some()
}

/// Makes the material of cloth that was given a look, and lets it follow the look.
pub(crate) fn dress(
    mut cloths: Query<(
        Entity,
        Ref<ClothLook>,
        &Drawing,
        Option<&ClothColoring>,
        Option<&mut LookMaterial>,
        Option<&MeshMaterial3d<StandardMaterial>>,
    )>,
    shared: Res<Shared<ClothColoring>>,
    mut materials: ResMut<Assets<ClothMaterial>>,
    mut images: ResMut<Assets<Image>>,
    mut textures: Local<WeaveTextures>,
    mut commands: Commands,
) {
    for (entity, look, drawing, coloring, material, standard) in &mut cloths {
        let tells = *coloring.unwrap_or(&shared) != ClothColoring::Material;
        let uniform = FabricUniform::new(&look, drawing.metres(), tells);
        let mut make = || {
            let weave = textures.weave(look.weave, &mut images);
            ClothMaterial {
                base: base(&look),
                extension: FabricExtension { fabric: uniform.clone(), weave, noise: textures.noise(&mut images) },
            }
        };
        match material {
            Some(mut known) => {
                if known.uniform != uniform || look.is_changed() {
                    if let Err(error) = materials.insert(known.shown.id(), make()) {
                        error!("the look of cloth {entity} could not be changed: {error}");
                    }
                    known.uniform = uniform;
                }
                if let Some(standard) = standard {
                    // The user gave it another one meanwhile.
                    known.own = Some(standard.0.clone());
                    commands.entity(entity).try_remove::<MeshMaterial3d<StandardMaterial>>();
                }
            }
            None => {
                let shown = materials.add(make());
                commands.queue(move |world: &mut World| put_on(world, entity, shown, uniform));
            }
        }
    }
}

fn put_on(world: &mut World, entity: Entity, shown: Handle<ClothMaterial>, uniform: FabricUniform) {
    let Ok(mut entity) = world.get_entity_mut(entity) else { return };
    material::take_back(&mut entity);
    let own = entity.take::<MeshMaterial3d<StandardMaterial>>().map(|material| material.0);
    entity.insert((MeshMaterial3d(shown.clone()), LookMaterial { shown, uniform, own }, TransmittedShadowReceiver));
}

/// Takes the material off cloth whose look was removed, and gives it back its own.
pub(crate) fn undress(cloths: Query<Entity, (With<LookMaterial>, Without<ClothLook>)>, mut commands: Commands) {
    for entity in &cloths {
        commands.queue(move |world: &mut World| {
            if let Ok(mut entity) = world.get_entity_mut(entity) {
                take_back(&mut entity);
            }
            material::give_default(world, entity);
        });
    }
}

/// Undoes what was done to show a look.
pub(crate) fn take_back(entity: &mut EntityWorldMut) {
    let Some(known) = entity.take::<LookMaterial>() else { return };
    entity.remove::<(MeshMaterial3d<ClothMaterial>, TransmittedShadowReceiver)>();
    if let Some(own) = known.own
        && !entity.contains::<MeshMaterial3d<StandardMaterial>>()
    {
        entity.insert(MeshMaterial3d(own));
    }
}

/// The standard part. All looks have the same pipeline, so that none has to be compiled when one changes.
fn base(look: &ClothLook) -> StandardMaterial {
    let gloss = look.gloss.clamp(0.0, 1.0);
    StandardMaterial {
        perceptual_roughness: 0.95 - 0.45 * gloss,
        reflectance: 0.2 + 0.2 * gloss,
        diffuse_transmission: look.translucency.clamp(0.001, 1.0),
        thickness: THROUGH,
        ..default()
    }
}

impl FabricUniform {
    fn new(look: &ClothLook, metres: Vec2, tells: bool) -> Self {
        let threads = if look.threads.is_finite() { look.threads.clamp(50.0, 20_000.0) } else { 1000.0 };
        let (pattern, width) = match look.pattern {
            Pattern::None => (0, 1.0),
            Pattern::Stripes { width, across } => (1 + u32::from(across), width),
            Pattern::Check { width } => (3, width),
            Pattern::Border { width } => (4, width),
            Pattern::Bands { count, across } => {
                let whole = if across { metres.y } else { metres.x };
                (1 + u32::from(across), whole / count.clamp(1, 100) as f32)
            }
        };
        // How the threads stand out, how creased and how uneven the fabric is.
        let (relief, crumple, slub) = match look.weave {
            Weave::Plain => (0.8, 0.3, 0.35),
            Weave::Twill => (0.9, 0.25, 0.5),
            Weave::Satin => (0.25, 0.08, 0.2),
            Weave::Terry => (1.2, 0.3, 0.5),
            Weave::Knit => (0.9, 0.25, 0.4),
            Weave::Ripstop => (0.5, 0.5, 0.2),
            Weave::Velvet => (0.7, 0.25, 0.5),
        };
        let color = LinearRgba::from(look.color);
        let other = if look.pattern == Pattern::None { color } else { LinearRgba::WHITE };
        Self {
            color,
            second: look.second.map_or(other, LinearRgba::from),
            metres,
            tile: super::weave::threads_a_tile(look.weave) / threads,
            threads,
            pattern_width: width.max(0.001),
            pattern,
            sheen: look.sheen.clamp(0.0, 1.0),
            gloss: look.gloss.clamp(0.0, 1.0),
            translucency: look.translucency.clamp(0.0, 1.0),
            relief,
            crumple,
            slub,
            pile: f32::from(look.weave == Weave::Velvet) + 0.4 * f32::from(look.weave == Weave::Terry),
            fray_reach: wear::FRAY_REACH,
            tells: u32::from(tells),
        }
    }
}
