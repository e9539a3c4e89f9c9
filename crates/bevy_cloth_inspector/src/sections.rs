//! Sections that an app adds to the panel.

use bevy::ecs::system::SystemId;
use bevy::prelude::*;
use bevy_egui::egui;

/// The sections that the app added, in the order in which they were. They stand below "Time".
#[derive(Resource, Clone, Debug, Default)]
pub struct InspectorSections(pub(crate) Vec<AppSection>);

/// A section of the app's own.
#[derive(Clone, Debug)]
pub(crate) struct AppSection {
    pub title: String,
    pub open: bool,
    system: SystemId<InMut<'static, egui::Ui>>,
}

impl AppSection {
    pub fn show(&self, ui: &mut egui::Ui, world: &mut World) {
        if let Err(error) = world.run_system_with(self.system, ui) {
            crate::widgets::refusal(ui, &error.to_string());
        }
    }
}

/// Adds sections to the panel.
pub trait InspectorAppExt {
    /// Adds a section called `title` that `system` draws while it is open; `open` says whether it is at first. Build it from
    /// [`widgets`](crate::widgets) to have it look and behave as the others.
    ///
    /// ```
    /// use bevy::prelude::*;
    /// use bevy_cloth_inspector::InspectorAppExt;
    /// use bevy_cloth_inspector::widgets::{Unit, Value};
    /// use bevy_egui::egui::Ui;
    ///
    /// #[derive(Resource, Default)]
    /// struct Distance(f32);
    ///
    /// App::new().init_resource::<Distance>().add_inspector_section(
    ///     "Scene",
    ///     true,
    ///     |InMut(ui): InMut<Ui>, mut distance: ResMut<Distance>| {
    ///         let row = Value::new("distance", "How far the ball is away.", Unit::METRES, 0.0..=10.0);
    ///         row.show(ui, &mut distance.bypass_change_detection().0, 0.0);
    ///     },
    /// );
    /// ```
    fn add_inspector_section<M>(
        &mut self,
        title: impl Into<String>,
        open: bool,
        system: impl IntoSystem<InMut<'static, egui::Ui>, (), M> + 'static,
    ) -> &mut Self;
}

impl InspectorAppExt for App {
    fn add_inspector_section<M>(
        &mut self,
        title: impl Into<String>,
        open: bool,
        system: impl IntoSystem<InMut<'static, egui::Ui>, (), M> + 'static,
    ) -> &mut Self {
        let system = self.register_system(system);
        let mut sections = self.world_mut().get_resource_or_init::<InspectorSections>();
        sections.0.push(AppSection { title: title.into(), open, system });
        self
    }
}
