//! The scenes of the demo and how one is opened.

mod catalog;
pub mod curtain_rod;
mod dress;
mod finish;
mod hardware;
mod mannequin;
mod moving;
mod riders;
mod save;
mod setting;
mod sliding;
mod spawn;
mod viewpoint;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_cloth::{ClothClock, ClothColoring, ClothSubdivision, ClothTime, Gravity, Shared, Substeps, Wind};
use bevy_cloth_inspector::{InspectorOpen, Selected};
use cloth_scene::Scene;

use crate::camera::Viewpoint;
use crate::cli::{Coloring, Options};
use crate::look::View;
use crate::tools::ReopenScene;
pub use catalog::{Entry, MENU, MORE, SANDBOX, names, open};
pub use finish::paint;
pub use mannequin::Mannequin;
pub use save::Present;

/// Opens scenes, first of all the one that was asked for.
pub struct ScenesPlugin {
    /// What the command line says.
    pub options: Options,
}

/// Closes the scene that is open and opens this one.
#[derive(Event, Clone, Debug)]
pub struct OpenScene(pub Box<Scene>);

/// The scene that is open, as its file says.
#[derive(Resource, Clone, Debug, Default)]
pub struct Opened {
    /// What the file says.
    pub scene: Box<Scene>,
    /// Reading of the cloth's clock when it was opened, s.
    pub at: f64,
}

/// What belongs to the scene that is open, and goes with it. Children of such an entity need no mark of their own.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct OfScene;

impl Plugin for ScenesPlugin {
    fn build(&self, app: &mut App) {
        let coloring = match self.options.coloring {
            Coloring::Material => ClothColoring::Material,
            Coloring::Stress => ClothColoring::Stress,
            Coloring::Strain => ClothColoring::Strain,
            Coloring::Temperature => ClothColoring::Temperature,
            Coloring::Speed => ClothColoring::Speed,
            Coloring::Contact => ClothColoring::Contact,
        };
        let first = self.options.scene.clone();
        app.init_resource::<Opened>()
            .insert_resource(Shared(coloring))
            .insert_resource(Shared(ClothSubdivision::X2))
            .insert_resource(InspectorOpen(self.options.screenshot.is_none() || self.options.ui))
            .add_plugins((
                curtain_rod::CurtainRodPlugin,
                sliding::SlidingPlugin,
                hardware::HardwarePlugin,
                mannequin::MannequinPlugin,
                moving::MovingPlugin,
                riders::RidersPlugin,
            ))
            .add_plugins((finish::FinishPlugin, setting::SettingPlugin))
            .add_observer(open_scene)
            .add_observer(reopen)
            .add_systems(Startup, move |mut commands: Commands| commands.trigger(OpenScene(first.clone())))
            .add_systems(Update, spawn::light);
        if self.options.paused {
            app.world_mut().resource_mut::<Time<ClothClock>>().pause();
        }
    }
}

/// Sets the clock and what every cloth shares, and spawns what the scene says in place of what was there.
fn open_scene(
    open: On<OpenScene>,
    old: Query<Entity, (With<OfScene>, Allow<Disabled>)>,
    clock: Res<Time<ClothClock>>,
    mut fixed: ResMut<Time<Fixed>>,
    mut selected: ResMut<Selected>,
    mut commands: Commands,
) {
    let scene = &open.0;
    // A curtain goes with its rod.
    old.iter().for_each(|entity| commands.entity(entity).try_despawn());
    selected.0 = None;
    let (count, iterations) = (scene.substeps.min(200), scene.iterations.min(100));
    fixed.set_timestep_hz(f64::from(scene.rate));
    commands.insert_resource(Shared(Substeps { count, max: count.max(Substeps::default().max), iterations }));
    commands.insert_resource(Shared(scene.method));
    commands.insert_resource(Shared(Gravity(scene.gravity)));
    commands.insert_resource(Shared(Wind(scene.wind)));
    commands.insert_resource(Shared(scene.gusts));
    let (low, high) = viewpoint::bounds(scene);
    commands.insert_resource(match scene.view.camera {
        Some(camera) => Viewpoint { from: camera.from, to: camera.to, field: camera.field },
        None => viewpoint::of(low, high),
    });
    commands.insert_resource(View(scene.view.clone()));
    commands.insert_resource(Opened { scene: scene.clone(), at: clock.elapsed_secs_f64() });
    let scene = scene.clone();
    commands.queue(move |world: &mut World| {
        if let Err(error) = world.run_system_cached_with(spawn::spawn, (scene, low)) {
            error!("the scene could not be spawned: {error}");
        }
    });
}

/// Opens the scene that is open anew, and forgets what was set while it was played.
fn reopen(
    _: On<ReopenScene>,
    opened: Res<Opened>,
    mut coloring: ResMut<Shared<ClothColoring>>,
    mut clock: ResMut<Time<ClothClock>>,
    mut commands: Commands,
) {
    coloring.0 = ClothColoring::default();
    clock.unpause();
    commands.trigger(OpenScene(opened.scene.clone()));
}
