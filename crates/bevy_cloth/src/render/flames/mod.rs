//! Flames, smoke, steam and sparks on hot cloth: wisps that face the camera, in one mesh for each cloth, and the light that flames
//! throw.
//!
//! All follows from where the cloth is hot and from its clock: nothing is remembered from frame to frame, and where
//! nothing is hot there is nothing.

mod smoke;
mod wisp;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::{NoFrustumCulling, RenderLayers};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::math::{Affine3A, Vec3A, ops};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;
use cloth_solver::Topology;
use cloth_solver::damage::fire::{BURNT, Stage};

use self::smoke::{Kind, Source};
use self::wisp::{A_ROOT, Root, TILES, Wisp, hash, unit};
use super::ClothColoring;
use super::write::Drawing;
use crate::clock::{ClothClock, ClothTime};
use crate::cloth::{ClothFrame, ClothTopology};
use crate::damage::ClothFire;
use crate::settings::Shared;
use crate::shown::ShownShape;

/// Most roots of flames that are drawn on one cloth; of more burning particles each stands for several.
const MOST_ROOTS: f32 = 160.0;

/// The widest piece of cloth that one root stands for, m.
const WIDEST_ROOT: f32 = 0.12;

/// Wind lays flames down but does not draw them out for ever: the fastest stream that is drawn, m/s.
const FASTEST: f32 = 2.5;

/// Fuel that is burnt until a flame stands in full, and that it has left when it begins to shrink.
const GROWTH: f32 = 0.08;

/// Light of flames on a square metre of cloth, lm: cotton burns with 480 kW/m² (0.03 kg/(m²·s) of 16 MJ/kg), and a
/// candle makes 12.6 lm of its 80 W.
const LUMINOUS_EXITANCE: f32 = 75e3;

/// How far from the flames the light stands, towards the camera and with the stream, m: in the plane of the cloth it would
/// not light it.
const LIGHT: Vec2 = Vec2::new(0.35, 0.2);

/// Colour of that light, and how far it reaches, m.
const LIGHT_COLOR: Color = Color::srgb(1.0, 0.62, 0.28);
const LIGHT_RANGE: f32 = 8.0;

/// Whether flames, smoke, steam and sparks are drawn on cloth that burns.
///
/// A component on a cloth overrides the resource [`Shared<ClothFlames>`](crate::Shared). Where a [`ClothColoring`] tells
/// something no flames hide it. They are turned towards one camera: of the active 3D cameras the one that draws first.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub enum ClothFlames {
    /// Flames and the light they throw, smoke and sparks; steam where wet cloth is hot.
    #[default]
    Shown,
    /// None: for those who draw their own.
    Hidden,
}

/// The entity, a child of the cloth, that shows its flames and what else rises from it. While nothing is in flames it has no light.
#[derive(Component, Clone, Copy, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct DrawnFlames(Entity);

/// The material of all flames. Made when something burns for the first time.
#[derive(Resource, Clone, Debug)]
pub(crate) struct FlameMaterial(Handle<StandardMaterial>);

impl FromWorld for FlameMaterial {
    fn from_world(world: &mut World) -> Self {
        let texture = world.resource_mut::<Assets<Image>>().add(wisp::texture());
        let material = StandardMaterial {
            base_color_texture: Some(texture),
            unlit: true,
            alpha_mode: AlphaMode::Premultiplied,
            cull_mode: None,
            fog_enabled: false,
            ..default()
        };
        Self(world.resource_mut::<Assets<StandardMaterial>>().add(material))
    }
}

/// What holds for cloth that has no settings of its own.
#[derive(SystemParam)]
pub(crate) struct Settings<'w> {
    flames: Res<'w, Shared<ClothFlames>>,
    coloring: Res<'w, Shared<ClothColoring>>,
}

/// What of a burning cloth its flames follow from.
#[derive(QueryData)]
pub(crate) struct Burning {
    entity: Entity,
    fire: &'static ClothFire,
    topology: &'static ClothTopology,
    drawing: &'static Drawing,
    shown: &'static ShownShape,
    frame: &'static ClothFrame,
    place: &'static GlobalTransform,
    layers: Option<&'static RenderLayers>,
    own: Option<&'static ClothFlames>,
    coloring: Option<&'static ClothColoring>,
    drawn: Option<&'static DrawnFlames>,
}

impl BurningItem<'_, '_> {
    /// Whether there may be something to show.
    fn shows_flames(&self, shared: &Settings) -> bool {
        self.fire.is_warm()
            && *self.own.unwrap_or(&shared.flames) == ClothFlames::Shown
            && *self.coloring.unwrap_or(&shared.coloring) == ClothColoring::Material
    }
}

/// Takes flames off cloth that is cold.
pub(crate) fn quench(
    cloths: Query<Burning, With<DrawnFlames>>,
    without: Query<(Entity, &DrawnFlames), Without<ClothFire>>,
    shared: Settings,
    mut commands: Commands,
) {
    let out = cloths.iter().filter(|cloth| !cloth.shows_flames(&shared));
    let out = out.filter_map(|cloth| Some((cloth.entity, cloth.drawn?)));
    for (cloth, flames) in out.chain(&without) {
        commands.entity(flames.0).try_despawn();
        commands.entity(cloth).try_remove::<DrawnFlames>();
    }
}

/// Draws the flames as they stand now, as the camera sees them.
pub(crate) fn draw(
    cloths: Query<Burning>,
    mut flames: Query<(&Mesh3d, &mut Transform, &mut GlobalTransform), (Without<Drawing>, Without<Camera>)>,
    cameras: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
    shared: Settings,
    clock: Res<Time<ClothClock>>,
    material: Option<Res<FlameMaterial>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut found: Local<Found>,
    mut commands: Commands,
) {
    let time = clock.elapsed_secs_f64() + f64::from(clock.interpolation()) * clock.timestep().as_secs_f64();
    for cloth in cloths.iter().filter(|cloth| cloth.shows_flames(&shared)) {
        let active = cameras.iter().filter(|(camera, _)| camera.is_active);
        let Some((_, camera)) = active.min_by_key(|(camera, _)| camera.order) else { return };
        let Some(material) = &material else { return commands.init_resource::<FlameMaterial>() };
        let seen = Sight::new(&cloth, camera.translation(), time, &mut found);
        let drawn = cloth.drawn.and_then(|drawn| Some((drawn.0, flames.get_mut(drawn.0).ok()?)));
        let entity = match (seen, drawn) {
            (None, None) => continue,
            (None, Some((entity, _))) => {
                commands.entity(entity).try_despawn();
                commands.entity(cloth.entity).try_remove::<DrawnFlames>();
                continue;
            }
            (Some(seen), Some((entity, (mesh, mut transform, mut global)))) => {
                (*transform, *global) = (seen.transform, *cloth.place * seen.transform);
                if let Err(error) = meshes.insert(mesh.id(), seen.mesh) {
                    error!("flames could not be drawn: {error}");
                }
                (entity, seen.lumens)
            }
            (Some(seen), None) => {
                let lumens = seen.lumens;
                (spawn(&cloth, seen, &mut meshes, material, &mut commands), lumens)
            }
        };
        light(entity, &mut commands);
    }
}

/// Takes the flames off an entity that is no cloth any more.
pub(crate) fn undraw(entity: &mut EntityWorldMut) {
    if let Some(flames) = entity.take::<DrawnFlames>() {
        entity.world_scope(|world| world.despawn(flames.0));
    }
}

/// Lets flames shine with so many lumens.
fn light((flames, lumens): (Entity, f32), commands: &mut Commands) {
    if lumens > 0.0 {
        let light = PointLight { intensity: lumens, color: LIGHT_COLOR, range: LIGHT_RANGE, ..default() };
        commands.entity(flames).insert(light);
    } else {
        commands.entity(flames).remove::<PointLight>();
    }
}

fn spawn(
    cloth: &BurningItem,
    seen: Sight,
    meshes: &mut Assets<Mesh>,
    material: &FlameMaterial,
    commands: &mut Commands,
) -> Entity {
    let flames = commands.spawn((
        Name::new("flames"),
        Mesh3d(meshes.add(seen.mesh)),
        MeshMaterial3d(material.0.clone()),
        (NotShadowCaster, NotShadowReceiver, NoFrustumCulling),
        (seen.transform, *cloth.place * seen.transform),
        ChildOf(cloth.entity),
    ));
    let flames = flames.id();
    #[cfg(feature = "picking")]
    commands.entity(flames).insert(crate::picking::unseen());
    if let Some(layers) = cloth.layers {
        commands.entity(flames).insert(layers.clone());
    }
    commands.entity(cloth.entity).insert(DrawnFlames(flames));
    flames
}

/// Where flames and what else is seen stand.
#[derive(Default)]
pub(crate) struct Found {
    roots: Vec<Root>,
    sources: Vec<Source>,
}

/// How the flames of one cloth look at a moment.
struct Sight {
    mesh: Mesh,
    /// Where mesh and light are, in the frame of the cloth's entity.
    transform: Transform,
    /// Light, lm.
    lumens: f32,
}

impl Sight {
    /// `None` where nothing is to be seen, or the cloth's place is none that can be undone.
    fn new(cloth: &BurningItem, camera: Vec3, time: f64, Found { roots, sources }: &mut Found) -> Option<Self> {
        // Worked out along the axes of the world from the cloth's place, then taken back: flames know no scale.
        let turn = Affine3A { matrix3: cloth.place.affine().matrix3, translation: Vec3A::ZERO };
        let (back, there) = (turn.inverse(), turn * *cloth.drawing.relation());
        let eye = camera - cloth.place.translation();
        let stream = (cloth.frame.pose.rotation * cloth.fire.stream()).clamp_length_max(FASTEST);
        let place = |slot: usize| there.transform_point3(cloth.shown.positions()[slot]);
        let area = find_roots(cloth.fire, cloth.topology, place, roots);
        smoke::find(cloth.fire, cloth.topology, place, sources);
        let all = || sources.iter().map(|source| source.root.at);
        let middle = match roots.len() {
            0 => all().sum::<Vec3>() / sources.len() as f32,
            count => roots.iter().map(|root| root.at).sum::<Vec3>() / count as f32,
        };
        if roots.is_empty() && sources.is_empty() || !back.is_finite() || !middle.is_finite() {
            return None;
        }
        let stand = middle + (eye - middle).normalize_or_zero() * LIGHT.x + stream.normalize_or_zero() * LIGHT.y;
        let mut quads = Quads { origin: stand, back, ..default() };
        // What hides comes before what shines: sparks fly before the flames, and those stand before the smoke.
        let (sparks, plumes): (Vec<&Source>, _) = sources.iter().partition(|source| source.kind == Kind::Spark);
        for wisp in plumes.iter().flat_map(|source| source.wisps(time, stream)) {
            quads.add(&wisp, eye, stream);
        }
        for root in &*roots {
            (0..A_ROOT).for_each(|k| quads.add(&root.wisp(k, time, stream), eye, stream));
        }
        for wisp in sparks.iter().flat_map(|source| source.wisps(time, stream)) {
            quads.add(&wisp, eye, stream);
        }
        let transform = Transform::from_translation(back.transform_point3(stand));
        Some(Self { mesh: quads.mesh(), transform, lumens: area * LUMINOUS_EXITANCE * wisp::flicker(time) })
    }
}

/// Finds where flames stand, and gives the area that burns, m².
fn find_roots(fire: &ClothFire, topology: &Topology, place: impl Fn(usize) -> Vec3, roots: &mut Vec<Root>) -> f32 {
    roots.clear();
    let share = (MOST_ROOTS / fire.flaming().max(1) as f32).min(1.0);
    let mut burning = 0.0;
    for slot in topology.particles().filter(|slot| fire.stage(*slot) == Stage::Flaming) {
        let area = topology.area[slot as usize];
        burning += area;
        // The same particles whatever else burns, so that flames do not jump about.
        if unit(hash(slot)) >= share {
            continue;
        }
        let fuel = fire.fuel()[slot as usize];
        let strength = growth(fuel);
        let width = (area / share).sqrt().min(WIDEST_ROOT);
        roots.push(Root { at: place(slot as usize), width, strength, seed: slot });
    }
    burning
}

/// How far a flame stands where so much fuel is left, 0..=1.
fn growth(fuel: f32) -> f32 {
    ((1.0 - fuel) / GROWTH).min((fuel - BURNT) / GROWTH).clamp(0.0, 1.0)
}

/// Wisps as quads of four vertices, in the frame of the cloth's entity.
#[derive(Default)]
struct Quads {
    /// What positions are relative to, m.
    origin: Vec3,
    /// From the axes of the world to those of the frame.
    back: Affine3A,
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

impl Quads {
    /// Adds a wisp, turned towards `eye`, its length along `stream` as far as that is seen from the side.
    fn add(&mut self, wisp: &Wisp, eye: Vec3, stream: Vec3) {
        let view = (eye - wisp.at).normalize_or(Vec3::Z);
        let across = stream.cross(view).try_normalize().unwrap_or_else(|| view.any_orthonormal_vector());
        let along = view.cross(across);
        let (sin, cos) = ops::sin_cos(wisp.turn);
        let (across, along) = (across * cos + along * sin, along * cos - across * sin);
        // Before the cloth that it burns on, or that would cut it in two.
        let at = wisp.at + view * wisp.half.x - self.origin;
        let (tile, tiles) = (UVec2::new(wisp.tile % TILES.x, wisp.tile / TILES.x).as_vec2(), TILES.as_vec2());
        let first = self.positions.len() as u32;
        for corner in [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::ONE, Vec2::new(-1.0, 1.0)] {
            let Vec2 { x, y } = corner * wisp.half;
            self.positions.push(self.back.transform_vector3(at + across * x + along * y).to_array());
            let within = Vec2::new(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y);
            self.uvs.push(((tile + within) / tiles).to_array());
            self.colors.push(wisp.color);
        }
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }

    fn mesh(self) -> Mesh {
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.positions)
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, self.uvs)
            .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, self.colors)
            .with_inserted_indices(Indices::U32(self.indices))
    }
}
