//! What a scene tells beside its picture.

mod compare;
mod fire;
mod walk;

use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use cloth_scene::Readout;

use crate::scenes::{Mannequin, Opened};

/// Shows what the scene that is open wants to be told.
pub struct ReadoutPlugin;

impl Plugin for ReadoutPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<compare::Compared>().init_resource::<fire::Burnt>().add_systems(
            EguiPrimaryContextPass,
            (
                compare::show.run_if(is(Readout::Compare)),
                fire::show.run_if(is(Readout::Fire)),
                walk::show.run_if(any_with_component::<Mannequin>),
            ),
        );
        app.add_systems(Update, (compare::note.run_if(is(Readout::Compare)), fire::note.run_if(is(Readout::Fire))));
    }
}

fn is(wanted: Readout) -> impl Fn(Res<Opened>) -> bool + Clone {
    move |opened| opened.scene.view.readout == wanted
}
