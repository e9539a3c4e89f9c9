//! Where there is no graphics processor: says so in a sentence, and draws less.

use bevy::prelude::*;
use bevy::render::render_resource::WgpuAdapterInfo;
use bevy::render::renderer::RenderAdapterInfo;
use bevy::window::PrimaryWindow;
use bevy_cloth::{ClothSubdivision, Shared};
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui};

/// Size of the window without a graphics processor, unless another was asked for, pixels.
const SMALL: (f32, f32) = (640.0, 400.0);

/// Looks at what draws.
pub struct ProcessorPlugin {
    /// Whether the size of the window was asked for.
    pub sized: bool,
}

/// The notice is shown until it is closed.
#[derive(Resource)]
struct Notice;

impl Plugin for ProcessorPlugin {
    fn build(&self, app: &mut App) {
        let sized = self.sized;
        let economize = move |adapter: Option<Res<RenderAdapterInfo>>,
                              mut windows: Query<&mut Window, With<PrimaryWindow>>,
                              mut smooth: ResMut<Shared<ClothSubdivision>>,
                              cameras: Query<Entity, With<Camera>>,
                              mut commands: Commands| {
            if !adapter.is_some_and(|adapter| is_software(&adapter.0)) {
                return;
            }
            commands.insert_resource(Notice);
            smooth.0 = ClothSubdivision::None;
            for camera in &cameras {
                commands.entity(camera).insert(Msaa::Off);
            }
            if !sized {
                windows.iter_mut().for_each(|mut window| window.resolution.set(SMALL.0, SMALL.1));
            }
        };
        app.add_systems(PostStartup, economize)
            .add_systems(EguiPrimaryContextPass, show.run_if(resource_exists::<Notice>));
    }
}

fn is_software(adapter: &WgpuAdapterInfo) -> bool {
    // Bevy does not export the type of the field, only its name is to be had.
    format!("{:?}", adapter.device_type) == "Cpu"
}

fn show(mut contexts: EguiContexts, mut commands: Commands) -> Result {
    let context = contexts.ctx_mut()?;
    egui::Area::new("processor".into()).anchor(egui::Align2::LEFT_BOTTOM, [12.0, -92.0]).show(context, |ui| {
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label("No graphics processor was found: pictures are computed slowly, without smoothing.");
                if ui.button("OK").clicked() {
                    commands.remove_resource::<Notice>();
                }
            });
        });
    });
    Ok(())
}
