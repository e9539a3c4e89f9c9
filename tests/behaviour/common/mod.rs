//! What several tests need: an app without renderer, time by hand, and a look at the bits.

pub mod figure;
pub mod sleep;
pub mod wearer;

use std::time::Duration;

pub use cloth_cases::cases;

use bevy::camera::{NormalizedRenderTarget, RenderTarget, RenderTargetInfo};
use bevy::mesh::{MeshVertexAttribute, VertexAttributeValues};
use bevy::picking::pointer::{Location, PointerAction, PointerId, PointerInput};
use bevy::picking::{InteractionPlugin, PickingPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::window::PrimaryWindow;
use bevy_cloth::*;

/// Length of a tick in these tests: Bevy's default fixed timestep, 64 Hz.
pub const TICK: Duration = Duration::from_micros(15625);

/// An app without renderer, window or assets. Each update after the first is one tick.
pub fn headless() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ClothPlugin::default()));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    // The first update only starts the clock.
    app.update();
    app
}

/// With mesh assets and transforms that are propagated, before its first update.
pub fn with_transforms() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        bevy::mesh::MeshPlugin,
        ClothPlugin::default(),
    ));
    app
}

/// The same with mesh assets, as a game without a window has them.
pub fn with_meshes() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), bevy::mesh::MeshPlugin, ClothPlugin::default()));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    app.update();
    app
}

/// Updates the app so many times.
pub fn run(app: &mut App, updates: usize) {
    for _ in 0..updates {
        app.update();
    }
}

/// The component of an entity that must have it.
pub fn get<T: Component>(app: &App, entity: Entity) -> &T {
    app.world().get::<T>(entity).unwrap_or_else(|| panic!("{entity} has no {}", std::any::type_name::<T>()))
}

/// Every bit of a cloth's positions and velocities. Printed as their number and a hash.
#[derive(Clone, PartialEq)]
pub struct Bits(Vec<u32>);

impl Bits {
    pub fn of(particles: &Particles) -> Self {
        let [p, v] = [&particles.position, &particles.velocity];
        Self([&p.x, &p.y, &p.z, &v.x, &v.y, &v.z].into_iter().flatten().map(|x| x.to_bits()).collect())
    }
}

impl std::fmt::Debug for Bits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // FNV-1a.
        let hash = self
            .0
            .iter()
            .fold(0xcbf2_9ce4_8422_2325, |hash, bits| (hash ^ u64::from(*bits)).wrapping_mul(0x100_0000_01b3));
        write!(f, "{} numbers with hash {hash:016x}", self.0.len())
    }
}

/// Every bit of a cloth's positions and velocities.
pub fn bits(app: &App, cloth: Entity) -> Bits {
    Bits::of(get::<Particles>(app, cloth))
}

/// The mesh that an entity draws.
pub fn mesh(app: &App, entity: Entity) -> &Mesh {
    app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(app, entity).0).expect("it draws a mesh")
}

/// An attribute of the mesh that an entity draws, one vector for each vertex.
pub fn vectors(app: &App, entity: Entity, attribute: MeshVertexAttribute) -> Vec<Vec3> {
    match mesh(app, entity).attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => values.iter().map(|v| Vec3::from_array(*v)).collect(),
        other => panic!("{attribute:?} is {other:?}"),
    }
}

/// The vertices of each triangle that an entity draws.
pub fn triangles(app: &App, entity: Entity) -> Vec<[usize; 3]> {
    let indices: Vec<usize> = mesh(app, entity).indices().expect("indices").iter().collect();
    indices.as_chunks().0.to_vec()
}

/// The present positions of all particles, in the world, m.
pub fn world_positions(app: &App, cloth: Entity) -> Vec<Vec3> {
    let (frame, topology) = (get::<ClothFrame>(app, cloth), get::<ClothTopology>(app, cloth));
    let position = &get::<Particles>(app, cloth).position;
    topology.particles().map(|slot| frame.to_world(position.get(slot as usize))).collect()
}

/// The mean of all particles' positions, in the world, m.
pub fn centre(app: &App, cloth: Entity) -> Vec3 {
    let positions = world_positions(app, cloth);
    positions.iter().sum::<Vec3>() / positions.len() as f32
}

/// How far any particle is from where it was in `before`, m.
pub fn largest_move(before: &[Vec3], now: &[Vec3]) -> f32 {
    before.iter().zip(now).map(|(before, now)| before.distance(*now)).fold(0.0, f32::max)
}

/// All messages of a kind since the last two updates, taken out.
pub fn take_messages<M: Message>(app: &mut App) -> Vec<M> {
    app.world_mut().resource_mut::<Messages<M>>().drain().collect()
}

/// Counts the events of a kind at entities.
#[derive(Resource)]
pub struct Seen<E: Send + Sync + 'static>(pub Vec<E>);

/// Begins to note every event of the kind.
pub fn note_events<E: EntityEvent + Clone>(app: &mut App)
where
    for<'a> E::Trigger<'a>: Default,
{
    app.insert_resource(Seen::<E>(Vec::new()));
    app.add_observer(|event: On<E>, mut seen: ResMut<Seen<E>>| seen.0.push(event.event().clone()));
}

/// The events noted so far.
pub fn seen<E: EntityEvent + Clone>(app: &App) -> &[E] {
    &app.world().resource::<Seen<E>>().0
}

/// What the camera of [`with_pointer`] draws to.
const PIXELS: UVec2 = UVec2::new(800, 600);

/// An app with a camera 2 m before the origin, and a pointer.
pub fn with_pointer() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, PickingPlugin, InteractionPlugin, ClothPlugin::default()));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    app.world_mut().spawn((Window::default(), PrimaryWindow));
    let mut camera = Camera::default();
    camera.computed.target_info = Some(RenderTargetInfo { physical_size: PIXELS, scale_factor: 1.0 });
    let lens = PerspectiveProjection { aspect_ratio: PIXELS.x as f32 / PIXELS.y as f32, ..default() };
    camera.computed.clip_from_view = bevy::camera::CameraProjection::get_clip_from_view(&lens);
    app.world_mut().spawn((camera, RenderTarget::None { size: PIXELS }, Transform::from_xyz(0.0, 0.0, 2.0)));
    app.world_mut().spawn(PointerId::Mouse);
    app
}

/// Tells the app of an action of that pointer, at a pixel.
pub fn send(app: &mut App, at: [f32; 2], action: PointerAction) {
    let target = NormalizedRenderTarget::None { width: PIXELS.x, height: PIXELS.y };
    let location = Location { target, position: Vec2::from(at) };
    app.world_mut().write_message(PointerInput::new(PointerId::Mouse, location, action));
}
