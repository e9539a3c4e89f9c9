//! The menu of scenes: a picture and a key for each.

use bevy::asset::RenderAssetUsages;
use bevy::image::{CompressedImageFormats, ImageSampler, ImageType};
use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui};

use crate::scenes::{Entry, MENU, MORE, OpenScene, Opened};

/// Width and height of a picture in the menu, logical pixels.
const PICTURE: egui::Vec2 = egui::vec2(144.0, 81.0);
/// Scenes in a row.
const ROW: usize = 4;

/// Whether the menu is open.
#[derive(Resource, Default)]
pub struct MenuOpen(pub bool);

/// A scene as the menu shows it.
struct Card {
    entry: &'static Entry,
    title: String,
    about: String,
    picture: Option<egui::TextureHandle>,
}

/// Shows the menu and the title of the scene that is open.
pub struct MenuPlugin;

impl Plugin for MenuPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<MenuOpen>().add_systems(EguiPrimaryContextPass, (show_title, show_menu).chain());
    }
}

fn card(context: &egui::Context, entry: &'static Entry) -> Card {
    let scene = entry.scene();
    let picture = entry.picture.and_then(decode).map(|picture| context.load_texture(entry.name, picture, default()));
    Card { entry, title: scene.title.clone(), about: scene.about.clone(), picture }
}

fn decode(png: &[u8]) -> Option<egui::ColorImage> {
    let kind = ImageType::Extension("png");
    let formats = CompressedImageFormats::NONE;
    let image =
        Image::from_buffer(png, kind, formats, true, ImageSampler::Default, RenderAssetUsages::MAIN_WORLD).ok()?;
    let size = image.size();
    Some(egui::ColorImage::from_rgba_unmultiplied([size.x as usize, size.y as usize], image.data.as_ref()?))
}

/// The name of the scene, which opens the menu.
fn show_title(mut contexts: EguiContexts, mut open: ResMut<MenuOpen>, opened: Res<Opened>) -> Result {
    let context = contexts.ctx_mut()?;
    egui::Area::new("title".into()).anchor(egui::Align2::LEFT_TOP, [12.0, 10.0]).show(context, |ui| {
        // An area remembers how wide it was: the next scene's name may be longer.
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        let name = if opened.scene.title.is_empty() { "Scenes" } else { &opened.scene.title };
        let button = ui.button(egui::RichText::new(format!("☰  {name}")).size(16.0));
        if button.on_hover_text(format!("{}\nM: all scenes", opened.scene.about)).clicked() {
            open.0 = !open.0;
        }
    });
    Ok(())
}

fn show_menu(
    mut contexts: EguiContexts,
    mut open: ResMut<MenuOpen>,
    mut cards: Local<Vec<Card>>,
    mut commands: Commands,
) -> Result {
    if !open.0 {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    if cards.is_empty() {
        cards.extend(MENU.iter().map(|entry| card(context, entry)));
        cards.extend(MORE.iter().map(|entry| card(context, entry)));
    }
    let (mut is_open, mut chosen) = (true, None);
    egui::Window::new("Scenes").open(&mut is_open).resizable(false).collapsible(false).default_pos([24.0, 48.0]).show(
        context,
        |ui| {
            let (pictured, plain) = cards.split_at(MENU.len());
            egui::Grid::new("scenes").num_columns(ROW).spacing([10.0, 10.0]).show(ui, |ui| {
                for (index, card) in pictured.iter().enumerate() {
                    if show_card(ui, card, index + 1) {
                        chosen = Some(card.entry);
                    }
                    if index % ROW == ROW - 1 {
                        ui.end_row();
                    }
                }
            });
            ui.separator();
            ui.set_max_width(PICTURE.x * ROW as f32 + 20.0);
            ui.horizontal_wrapped(|ui| {
                ui.weak("More:");
                for card in plain {
                    if ui.link(&card.title).on_hover_text(&card.about).clicked() {
                        chosen = Some(card.entry);
                    }
                }
            });
        },
    );
    if let Some(entry) = chosen {
        commands.trigger(OpenScene(entry.scene()));
        is_open = false;
    }
    open.0 = is_open;
    Ok(())
}

/// A picture with title and key; whether it was clicked.
fn show_card(ui: &mut egui::Ui, card: &Card, key: usize) -> bool {
    // The tenth is on the key 0.
    let label = egui::RichText::new(format!("{}  {}", key % 10, card.title));
    let response = ui.vertical(|ui| {
        ui.set_width(PICTURE.x);
        let picture = match &card.picture {
            Some(picture) => ui.add(egui::Button::image((picture.id(), PICTURE))),
            None => ui.add_sized(PICTURE, egui::Button::new(&card.title)),
        };
        ui.label(label);
        picture
    });
    response.inner.on_hover_text(&card.about).clicked()
}
