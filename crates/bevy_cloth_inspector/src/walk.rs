//! Tests that walk through all sections, without a window.

use bevy::camera::Exposure;
use bevy::diagnostic::DiagnosticsPlugin;
use bevy::light::EnvironmentMapLight;
use bevy::prelude::*;
use bevy_cloth::*;
use bevy_egui::egui;

use crate::widgets::recorded;
use crate::{InspectorAppExt, InspectorLayout, Selected, panel};

/// A world in which every section has something to show, and what can be selected in it.
fn full() -> (App, Vec<Entity>) {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        DiagnosticsPlugin,
        AssetPlugin::default(),
        ClothPlugin::default(),
        ClothDiagnosticsPlugin,
    ));
    app.init_asset::<StandardMaterial>().init_asset::<Mesh>().init_asset::<Image>();
    // A tick in each update, however fast the machine.
    let tick = std::time::Duration::from_micros(15625);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(tick)).init_resource::<ClothPicking>();
    crate::init_resources(app.world_mut());
    app.add_inspector_section("Own", true, |InMut(ui): InMut<egui::Ui>| {
        crate::widgets::reading(ui, "own", "Something of the app.", "yes");
    });
    let world = app.world_mut();
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial::default());
    let cloth = (
        Cloth::rectangle(1.0, 1.0).with_cells(8, 8),
        Pins::rods(3),
        Tearable::default(),
        Flammable::default(),
        SelfContact::default(),
        Air::default(),
        ContactView::default(),
        ClothLook::default().with_pattern(Pattern::Stripes { width: 0.1, across: true }, Color::BLACK),
    );
    let mut objects = vec![world.spawn(cloth).id()];
    let chance = Flammable::Contagion(Contagion::default());
    objects.push(world.spawn((Cloth::rectangle(1.0, 1.0), chance, MeshMaterial3d(material.clone()))).id());
    let shapes = [
        ClothCollider::Sphere { radius: 0.4 },
        ClothCollider::Capsule { radius: 0.1, length: 0.4 },
        ClothCollider::Cuboid { size: Vec3::ONE },
        ClothCollider::RoundedCuboid { size: Vec3::ONE, radius: 0.1 },
        ClothCollider::Pyramid { base: Vec2::ONE, height: 1.0 },
        ClothCollider::Cylinder { radius: 0.2, height: 1.0 },
        ClothCollider::Ellipsoid { radii: Vec3::ONE },
        ClothCollider::Ground,
    ];
    let extras = (ColliderFriction::default(), ContactEvents, ClothForce::default());
    let far = Transform::from_xyz(-123.4, -123.4, 50.0).with_rotation(Quat::from_rotation_y(2.1));
    objects.extend(shapes.map(|shape| world.spawn((shape, extras, MeshMaterial3d(material.clone()), far)).id()));
    objects.push(world.spawn(Fan { oscillation: Some(Oscillation::default()), ..default() }).id());
    objects.push(world.spawn(WindZone::default()).id());
    objects.push(world.spawn(WindZone { shape: ZoneShape::Cuboid { size: Vec3::ONE }, ..default() }).id());
    world.spawn((Name::new("Sun"), DirectionalLight::default()));
    let light = EnvironmentMapLight { intensity: 500.0, ..default() };
    world.spawn((Camera3d::default(), Transform::from_xyz(0.0, 1.0, 3.0), Exposure::default(), light));
    (0..3).for_each(|_| app.update());
    (app, objects)
}

/// Draws the panel a few times in a window so wide and high, logical pixels; what egui tells a screen reader of it.
fn draw(context: &egui::Context, app: &mut App, size: [f32; 2]) -> egui::accesskit::TreeUpdate {
    context.enable_accesskit();
    recorded::open_all(context);
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
    let mut told = None;
    for _ in 0..3 {
        recorded::take(context);
        recorded::take_fields(context);
        let input = egui::RawInput { screen_rect: Some(screen), ..default() };
        let output = context.run_ui(input, |ui| _ = panel::draw(&ui.ctx().clone(), app.world_mut()));
        told = output.platform_output.accesskit_update;
    }
    told.expect("egui tells what it shows")
}

#[test]
fn every_value_of_every_section_has_a_tooltip_a_unit_and_goes_through_the_rows() {
    let (mut app, objects) = full();
    let mut labels = Vec::new();
    for object in objects {
        app.world_mut().resource_mut::<Selected>().0 = Some(object);
        let context = egui::Context::default();
        let told = draw(&context, &mut app, [1280.0, 720.0]);
        let rows = recorded::take(&context);
        for row in &rows {
            assert!(!row.label.is_empty(), "{row:?}");
            let is_sentence = row.hint.ends_with('.') && row.hint.len() > 5;
            assert!(is_sentence, "a tooltip is a sentence: {row:?}");
        }
        let of_role = |role| told.nodes.iter().filter(|(_, node)| node.role() == role).count();
        // A number that was drawn without a `Value` has neither.
        assert_eq!(of_role(egui::accesskit::Role::SpinButton), recorded::take_fields(&context));
        assert_eq!(of_role(egui::accesskit::Role::Slider), 0);
        labels.extend(rows.into_iter().map(|row| row.label));
    }
    for section in
        ["own", "mass", "rods", "budget", "candidates", "scale", "ignites at", "burning", "may sleep", "angle"]
    {
        assert!(labels.contains(&section), "{section} was not drawn");
    }
    let others = [
        "illuminance",
        "exposure",
        "image light",
        "roughness",
        "events",
        "adds",
        "there and back",
        "gravity",
        "solve",
        "tolerance",
        "sheen",
    ];
    for section in others {
        assert!(labels.contains(&section), "{section} was not drawn");
    }
}

#[test]
fn in_a_window_of_800_pixels_the_panel_covers_a_third_and_nothing_sticks_out() {
    let (mut app, objects) = full();
    app.world_mut().resource_mut::<InspectorLayout>().width = 500.0;
    for object in objects {
        app.world_mut().resource_mut::<Selected>().0 = Some(object);
        let context = egui::Context::default();
        let told = draw(&context, &mut app, [800.0, 500.0]);
        let left = f64::from(800.0 - (800.0_f32 / 3.0).floor());
        let of_panel = |role| !matches!(role, egui::accesskit::Role::Window | egui::accesskit::Role::ScrollBar);
        let out: Vec<_> = (told.nodes.iter())
            .filter(|(_, node)| of_panel(node.role()))
            .filter_map(|(_, node)| Some((node, node.bounds()?)))
            // The margin of the panel stays free.
            .filter(|(_, bounds)| bounds.x0 < left - 1.0 || bounds.x1 > 796.0)
            .map(|(node, bounds)| format!("{:?} {:?} {:?} {bounds:?}\n", node.role(), node.label(), node.value()))
            .collect();
        assert!(out.is_empty(), "{out:#?}");
    }
}

#[test]
fn dragging_the_edge_makes_the_panel_wider_and_folding_a_section_is_remembered() {
    let (mut app, _) = full();
    let context = egui::Context::default();
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 720.0));
    let frame = |app: &mut App, events: Vec<egui::Event>| {
        let input = egui::RawInput { screen_rect: Some(screen), events, ..default() };
        let mut width = 0.0;
        let _ = context.run_ui(input, |ui| width = panel::draw(&ui.ctx().clone(), app.world_mut()));
        width
    };
    let at = |x: f32, y: f32| egui::pos2(x, y);
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::default(),
    };
    let before = frame(&mut app, vec![]);
    let edge = 1280.0 - before + 2.0;
    frame(&mut app, vec![egui::Event::PointerMoved(at(edge, 300.0))]);
    frame(&mut app, vec![button(at(edge, 300.0), true)]);
    frame(&mut app, vec![egui::Event::PointerMoved(at(edge - 60.0, 300.0))]);
    frame(&mut app, vec![button(at(edge - 60.0, 300.0), false)]);
    let after = frame(&mut app, vec![]);
    assert!((after - before - 60.0).abs() < 8.0, "{before} px, then {after} px");
    let title = at(1280.0 - after + 40.0, 18.0);
    frame(&mut app, vec![egui::Event::PointerMoved(title)]);
    frame(&mut app, vec![button(title, true)]);
    frame(&mut app, vec![button(title, false)]);
    assert_eq!(app.world().resource::<InspectorLayout>().open.get("Time"), Some(&false));
}
