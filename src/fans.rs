//! The visible body of each fan: guard, blades that turn, motor and a stand that reaches the ground.
//!
//! Everything is made for a fan of 1 m across and scaled to its diameter.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_cloth::{ClothClock, ClothCollider, Fan};
use bevy_cloth_inspector::NoOutline;

/// Radius of the wires of the guard, and of its rim.
const WIRE: (f32, f32) = (0.006, 0.014);
/// Depth of the head from the front of the guard to its back.
const DEPTH: (f32, f32) = (-0.06, 0.2);
/// Number of blades.
const BLADES: u16 = 5;
/// Points of a blade along its length and across.
const BLADE_POINTS: (u16, u16) = (12, 6);
/// Turns of the blades in a second for each m/s at the outlet of a fan of 1 m.
const TURNS: f32 = 0.6;
/// Where the stand begins below the middle of the head.
const NECK: f32 = 0.54;
/// Radius of the pole, and of the foot with its height, m.
const STAND: (f32, f32, f32) = (0.016, 0.17, 0.025);

/// A fan without a body: nothing is seen of it, and nothing bumps into it.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Bodiless;

/// Gives every fan a body.
pub struct FansPlugin;

impl Plugin for FansPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreStartup, forge).add_systems(Update, (embody, animate).chain());
    }
}

/// Meshes and materials of all fans.
#[derive(Resource)]
struct Parts {
    rim: Handle<Mesh>,
    wires: Handle<Mesh>,
    blades: Handle<Mesh>,
    motor: Handle<Mesh>,
    pole: Handle<Mesh>,
    foot: Handle<Mesh>,
    metal: Handle<StandardMaterial>,
    paint: Handle<StandardMaterial>,
    plastic: Handle<StandardMaterial>,
}

/// A part of a fan that moves.
#[derive(Component, Clone, Copy)]
enum Part {
    /// Turns with the oscillation.
    Head(Entity),
    /// Turns with the motor.
    Blades(Entity),
    /// Stands upright.
    Pole(Entity),
    /// Lies on the ground.
    Foot(Entity),
}

fn forge(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let mut material = |base_color, metallic, perceptual_roughness, double_sided: bool| {
        let cull_mode = StandardMaterial::default().cull_mode.filter(|_| !double_sided);
        let look =
            StandardMaterial { base_color, metallic, perceptual_roughness, double_sided, cull_mode, ..default() };
        materials.add(look)
    };
    commands.insert_resource(Parts {
        metal: material(Color::srgb(0.75, 0.76, 0.78), 0.8, 0.3, false),
        paint: material(Color::srgb(0.20, 0.22, 0.24), 0.0, 0.5, false),
        plastic: material(Color::srgb(0.30, 0.50, 0.62), 0.0, 0.4, true),
        rim: meshes.add(ring(0.5, WIRE.1, 0.0)),
        wires: meshes.add(wires()),
        blades: meshes.add(blades()),
        motor: meshes.add(motor()),
        pole: meshes.add(Cylinder::new(STAND.0, 1.0).mesh().resolution(20)),
        foot: meshes.add(Cylinder::new(STAND.1, STAND.2).mesh().resolution(40)),
    });
}

/// Builds the body of each new fan that is to have one. Its head is a solid that cloth meets.
fn embody(mut commands: Commands, parts: Res<Parts>, fans: Query<Entity, (Added<Fan>, Without<Bodiless>)>) {
    for fan in &fans {
        commands.entity(fan).insert_if_new(Visibility::default());
        let head = (Part::Head(fan), ClothCollider::Convex { planes: drum() }, Transform::default());
        let head = commands.spawn((head, Visibility::default(), ChildOf(fan))).id();
        let mut part = |mesh: &Handle<Mesh>, material: &Handle<StandardMaterial>, parent| {
            commands.spawn((Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), ChildOf(parent))).id()
        };
        part(&parts.rim, &parts.metal, head);
        part(&parts.motor, &parts.paint, head);
        let (wires, blades) = (part(&parts.wires, &parts.metal, head), part(&parts.blades, &parts.plastic, head));
        let (pole, foot) = (part(&parts.pole, &parts.metal, fan), part(&parts.foot, &parts.paint, fan));
        for (entity, part) in [(blades, Part::Blades(fan)), (pole, Part::Pole(fan)), (foot, Part::Foot(fan))] {
            commands.entity(entity).insert(part);
        }
        for fine in [wires, blades] {
            commands.entity(fine).insert(NoOutline);
        }
    }
}

/// Turns heads and blades with the clock of the cloth, and keeps the stands upright.
fn animate(
    mut parts: Query<(&Part, &mut Transform), Without<Fan>>,
    fans: Query<(&Fan, &Transform)>,
    clock: Res<Time<ClothClock>>,
    mut before: Local<f64>,
) {
    let passed = (clock.elapsed_secs_f64() - *before) as f32;
    *before = clock.elapsed_secs_f64();
    for (part, mut place) in &mut parts {
        let (Part::Head(fan) | Part::Blades(fan) | Part::Pole(fan) | Part::Foot(fan)) = *part;
        let Ok((fan, at)) = fans.get(fan) else { continue };
        let size = if fan.diameter.is_finite() { fan.diameter.max(0.01) } else { 0.01 };
        let neck = Vec3::NEG_Y * (NECK * size);
        let height = (at.translation + at.rotation * neck).y.max(STAND.2);
        let upright = Transform::from_translation(neck).with_rotation(at.rotation.inverse());
        match part {
            Part::Head(_) => {
                let angle = fan.oscillation.map_or(0.0, |swing| swing.angle(clock.elapsed_secs_f64()));
                *place = Transform::from_rotation(Quat::from_rotation_y(angle)).with_scale(Vec3::splat(size));
            }
            Part::Blades(_) if fan.on => place.rotate_local_z(-TAU * TURNS * fan.speed / size * passed),
            Part::Blades(_) => {}
            Part::Pole(_) => {
                let middle = Transform::from_xyz(0.0, -height / 2.0, 0.0);
                *place = upright * middle.with_scale(Vec3::new(1.0, height, 1.0));
            }
            Part::Foot(_) => *place = upright * Transform::from_xyz(0.0, STAND.2 / 2.0 - height, 0.0),
        }
    }
}

/// The head as a solid: a prism of twelve sides.
fn drum() -> Vec<Vec4> {
    let side = |i: u8| Vec2::from_angle(PI / 6.0 * f32::from(i)).extend(0.0).extend(0.5);
    let ends = [Vec4::new(0.0, 0.0, -1.0, -DEPTH.0), Vec4::new(0.0, 0.0, 1.0, DEPTH.1)];
    (0..12).map(side).chain(ends).collect()
}

/// All meshes as one.
fn merged(meshes: impl IntoIterator<Item = Mesh>) -> Mesh {
    let merge = |mut all: Mesh, next: Mesh| {
        // Only meshes of different layouts cannot be merged; all of these are primitives.
        if let Err(error) = all.merge(&next) {
            error!("a part of a fan is missing: {error}");
        }
        all
    };
    meshes.into_iter().reduce(merge).unwrap_or_else(|| Cuboid::default().mesh().build())
}

/// A ring of wire across the axis.
fn ring(radius: f32, wire: f32, z: f32) -> Mesh {
    let turned = Transform::from_xyz(0.0, 0.0, z).with_rotation(Quat::from_rotation_x(FRAC_PI_2));
    let torus = Torus { minor_radius: wire, major_radius: radius - wire };
    torus.mesh().minor_resolution(8).major_resolution(48).build().transformed_by(turned)
}

/// Rings and spokes, bulging before the blades and behind.
fn wires() -> Mesh {
    // Where a wire at a distance from the axis runs, at the front or at the back.
    let bulge = |radius: f32, end: f32| end * (1.0 - (radius / 0.5).powi(2)).max(0.0).sqrt();
    let spoke = |i: u8, end: f32| {
        let (from, to) = (Vec3::new(0.1, 0.0, bulge(0.1, end)), Vec3::new(0.49, 0.0, bulge(0.49, end)));
        let along = Quat::from_rotation_arc(Vec3::Y, (to - from).normalize());
        let wire = Cylinder::new(WIRE.0, from.distance(to)).mesh().resolution(6).build();
        let around = Transform::from_rotation(Quat::from_rotation_z(TAU / 16.0 * f32::from(i)));
        wire.transformed_by(around * Transform::from_translation(from.midpoint(to)).with_rotation(along))
    };
    let front = [0.12_f32, 0.22, 0.32, 0.42].map(|radius| ring(radius, WIRE.0, bulge(radius, DEPTH.0)));
    let spokes = [DEPTH.0, DEPTH.1].into_iter().flat_map(|end| (0..16).map(move |i| spoke(i, end)));
    let cap = Transform::from_xyz(0.0, 0.0, DEPTH.0).with_rotation(Quat::from_rotation_x(FRAC_PI_2));
    let cap = Cylinder::new(0.1, 0.02).mesh().resolution(32).build().transformed_by(cap);
    merged(front.into_iter().chain(spokes).chain([cap]))
}

/// A motor behind the blades, and the yoke that holds it.
fn motor() -> Mesh {
    let backward = Quat::from_rotation_x(FRAC_PI_2);
    let at = |mesh: Mesh, z: f32| mesh.transformed_by(Transform::from_xyz(0.0, 0.0, z).with_rotation(backward));
    let hub = at(Cylinder::new(0.07, 0.12).mesh().resolution(32).build(), 0.06);
    let body = at(Capsule3d::new(0.11, 0.16).mesh().longitudes(32).build(), 0.24);
    let yoke = Transform::from_xyz(0.0, -0.28, 0.09).with_rotation(Quat::from_rotation_x(0.33));
    let yoke = Capsule3d::new(0.022, 0.52).mesh().longitudes(16).build().transformed_by(yoke);
    merged([hub, body, yoke])
}

/// Swept and twisted blades about the z axis.
fn blades() -> Mesh {
    let (long, wide) = BLADE_POINTS;
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for blade in 0..BLADES {
        let first = positions.len() as u16;
        for (i, j) in (0..long).flat_map(|i| (0..wide).map(move |j| (i, j))) {
            let out = f32::from(i) / f32::from(long - 1);
            let across = 2.0 * f32::from(j) / f32::from(wide - 1) - 1.0;
            let radius = 0.06 + 0.38 * out;
            let half = 0.30 + 0.16 * (PI * out).sin() - 0.10 * out;
            let angle = TAU / f32::from(BLADES) * f32::from(blade) + 0.5 * out + across * half;
            let z = 0.06 - across * (0.075 - 0.045 * out) + 0.012 * (1.0 - across * across);
            positions.push((Vec2::from_angle(angle) * radius).extend(z).to_array());
        }
        for (i, j) in (0..long - 1).flat_map(|i| (0..wide - 1).map(move |j| (i, j))) {
            let corner = first + i * wide + j;
            indices.extend([corner, corner + wide, corner + 1, corner + 1, corner + wide, corner + wide + 1]);
        }
    }
    let uvs = vec![[0.0_f32, 0.0]; positions.len()];
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_inserted_indices(Indices::U16(indices))
        .with_computed_smooth_normals()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_triangles_with_normals_and_stays_within_the_stand() {
        for mesh in [ring(0.5, WIRE.1, 0.0), wires(), motor(), blades()] {
            let positions =
                mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|all| all.as_float3()).expect("positions");
            let normals = mesh.attribute(Mesh::ATTRIBUTE_NORMAL).and_then(|all| all.as_float3()).expect("normals");
            assert!(normals.iter().all(|normal| (Vec3::from(*normal).length() - 1.0).abs() < 1e-3));
            let widest = positions.iter().map(|p| Vec2::new(p[0], p[1]).length()).fold(0.0, f32::max);
            assert!(widest <= NECK + 0.05, "{widest} from the axis");
        }
    }
}
