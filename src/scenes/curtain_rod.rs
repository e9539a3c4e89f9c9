//! A rod that a curtain hangs on by rings, fitted to the curtain's width and to the number of its pins.
//!
//! The curtain is a child of the rod, a ring's drop below it. Its pins follow its own transform, so that moving or
//! turning the rod takes the curtain with it.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothSource, PinSelect, Pins, Resolution};

use crate::select::Selectable;

/// Radius of the bar, m.
const BAR_RADIUS: f32 = 0.018;
/// How far the bar stands out at each end, m.
const OVERHANG: f32 = 0.12;
/// Radius of the knobs at its ends, m.
const KNOB_RADIUS: f32 = 0.04;
/// Radius of a ring, and of the wire it is bent from, m.
const RING: (f32, f32) = (0.034, 0.005);
/// Width, height and depth of the clip below a ring, m.
const CLIP: Vec3 = Vec3::new(0.02, 0.03, 0.014);
/// From the middle of the bar down to the edge of the curtain, m.
pub const DROP: f32 = 2.0 * RING.0 - BAR_RADIUS + CLIP.y * 0.7;

/// A rod; its curtain is among its children.
#[derive(Component, Clone, Copy, Debug)]
pub struct CurtainRod {
    /// To which part of the curtain's width its rings are drawn together.
    pub gather: f32,
    /// Whether they slide along it.
    pub slides: bool,
    /// Vertices in a row of the curtain's mesh, and the height of a row, m.
    mesh: (u32, f32),
}

impl CurtainRod {
    /// How many vertices below a vertex of the top edge the one is that hangs so far (m) under it.
    pub fn row_below(&self, depth: f32) -> u32 {
        self.mesh.0 * (depth / self.mesh.1).round().max(1.0) as u32
    }
}

/// A part of a rod that is made anew when the curtain's width or pins change.
#[derive(Component, Clone, Copy)]
struct Fitting;

/// A ring with its clip: what slides along the rod, of which it is a child.
#[derive(Component, Clone, Copy, Debug)]
pub struct Ring {
    /// The how-manyth from the left it is.
    pub number: u32,
    /// The column of the curtain's mesh that hangs on it.
    pub column: u32,
    /// Where along the rod it is at first, m.
    pub home: f32,
}

/// Meshes and material of all rods.
#[derive(Resource)]
struct Hardware {
    bar: Handle<Mesh>,
    knob: Handle<Mesh>,
    ring: Handle<Mesh>,
    clip: Handle<Mesh>,
    brass: Handle<StandardMaterial>,
}

/// Keeps every rod fitted to its curtain.
pub struct CurtainRodPlugin;

impl Plugin for CurtainRodPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreStartup, forge).add_systems(Update, fit);
    }
}

fn forge(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.insert_resource(Hardware {
        bar: meshes.add(Cylinder::new(BAR_RADIUS, 1.0).mesh().resolution(24)),
        knob: meshes.add(Sphere::new(KNOB_RADIUS).mesh().uv(32, 20)),
        ring: meshes.add(Torus { minor_radius: RING.1, major_radius: RING.0 }),
        clip: meshes.add(Cuboid::from_size(CLIP)),
        brass: materials.add(StandardMaterial {
            base_color: Color::srgb(0.72, 0.56, 0.30),
            metallic: 0.7,
            perceptual_roughness: 0.35,
            ..default()
        }),
    });
}

/// Hangs a curtain that is there on a new rod at `place`; its rings are drawn together to the part `gather` of its width.
pub fn hang(commands: &mut Commands, place: Transform, curtain: Entity, gather: f32, slides: bool) -> Entity {
    let rod = CurtainRod { gather, slides, mesh: (1, 1.0) };
    let rod = (super::OfScene, rod, Name::new("rod"), Selectable(0), place, Visibility::default());
    commands.entity(curtain).insert(Transform::IDENTITY);
    commands.spawn(rod).add_child(curtain).id()
}

/// Makes bar and rings anew for a curtain whose size or pins changed, and hangs it below the bar.
fn fit(
    mut commands: Commands,
    hardware: Res<Hardware>,
    mut curtains: Query<(&Cloth, &Pins, &ChildOf, &mut Transform), Or<(Changed<Cloth>, Changed<Pins>)>>,
    mut rods: Query<(&Children, &mut CurtainRod)>,
    fittings: Query<(), With<Fitting>>,
) {
    for (cloth, pins, parent, mut transform) in &mut curtains {
        let (Ok((children, mut rod)), ClothSource::Rectangle { size, resolution }) =
            (rods.get_mut(parent.parent()), &cloth.source)
        else {
            continue;
        };
        // A size that is refused leaves curtain and rod as they are.
        if !(size.is_finite() && size.min_element() > 0.0) {
            continue;
        }
        for child in children.iter().filter(|child| fittings.contains(*child)) {
            commands.entity(child).despawn();
        }
        rod.mesh = (cells(size.x, *resolution) as u32 + 1, size.y / rows(size.y, *resolution));
        transform.translation.y = -DROP - size.y / 2.0;
        let mut part = |mesh: &Handle<Mesh>, place: Transform| {
            let look = (Mesh3d(mesh.clone()), MeshMaterial3d(hardware.brass.clone()));
            commands.spawn((Fitting, look, place, ChildOf(parent.parent())));
        };
        let half_bar = size.x / 2.0 + OVERHANG;
        let across = Quat::from_rotation_z(FRAC_PI_2);
        part(&hardware.bar, Transform::from_rotation(across).with_scale(Vec3::new(1.0, 2.0 * half_bar, 1.0)));
        for side in [-half_bar, half_bar] {
            part(&hardware.knob, Transform::from_xyz(side, 0.0, 0.0));
        }
        for (number, home) in (0..).zip(pin_places(pins, size.x, *resolution)) {
            let column = ((home / size.x + 0.5) * cells(size.x, *resolution)).round() as u32;
            let ring = (Fitting, Ring { number, column, home }, Transform::from_xyz(home, 0.0, 0.0));
            let part = |mesh: &Handle<Mesh>, place: Transform| {
                (Mesh3d(mesh.clone()), MeshMaterial3d(hardware.brass.clone()), place)
            };
            commands.spawn((ring, Visibility::default(), ChildOf(parent.parent()))).with_children(|ring| {
                let turned = Transform::from_xyz(0.0, BAR_RADIUS - RING.0, 0.0).with_rotation(across);
                ring.spawn(part(&hardware.ring, turned));
                ring.spawn(part(&hardware.clip, Transform::from_xyz(0.0, -DROP + CLIP.y * 0.2, 0.0)));
            });
        }
    }
}

/// Where along the width the pins are: at the columns nearest to points spread evenly, as [`PinSelect::Rods`] says.
fn pin_places(pins: &Pins, width: f32, resolution: Resolution) -> Vec<f32> {
    let rods = pins.0.iter().find_map(|group| match group.select {
        PinSelect::Rods(rods) => Some(rods),
        _ => None,
    });
    let cells = cells(width, resolution);
    let share = |rod: u32, rods: u32| if rods > 1 { rod as f32 / (rods - 1) as f32 } else { 0.5 };
    let rods = rods.unwrap_or(0).min(cells as u32 + 1);
    (0..rods).map(|rod| ((share(rod, rods) * cells).round() / cells - 0.5) * width).collect()
}

/// The number of rows of cells of the curtain's mesh.
fn rows(height: f32, resolution: Resolution) -> f32 {
    match resolution {
        Resolution::Spacing(spacing) => (height / spacing).round().max(1.0),
        Resolution::Cells(cells) => cells.y.max(1) as f32,
    }
}

/// The number of cells of the curtain's mesh along its width.
fn cells(width: f32, resolution: Resolution) -> f32 {
    match resolution {
        Resolution::Spacing(spacing) => (width / spacing).round().max(1.0),
        Resolution::Cells(cells) => cells.x.max(1) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_spread_over_the_whole_width_whatever_it_is() {
        for width in [0.5, 2.0, 3.7] {
            let places = pin_places(&Pins::rods(5), width, Resolution::Spacing(0.025));
            assert_eq!(places.len(), 5);
            assert_eq!((places[0], places[4]), (-width / 2.0, width / 2.0));
            assert!(places.windows(2).all(|pair| (pair[1] - pair[0] - width / 4.0).abs() < 0.03));
        }
    }

    #[test]
    fn one_ring_is_in_the_middle_and_none_is_none() {
        let place = |rods| pin_places(&Pins::rods(rods), 2.0, Resolution::Cells(UVec2::new(8, 8)));
        assert_eq!(place(1), [0.0]);
        assert_eq!(place(0), [0.0; 0]);
        assert_eq!(place(1000).len(), 9, "no more rings than columns");
    }
}
