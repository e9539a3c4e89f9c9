//! The air of a fan, and of a zone, against what is known of it.

use std::f32::consts::PI;

use crate::common::*;
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::forces::{Air, Fan, Oscillation, WindField, WindZone, ZoneShape};
use cloth_solver::{Fabric, Motion, Pose, Tick};
use glam::{Quat, Vec2, Vec3};
use proptest::prelude::*;

/// At the origin, blowing along −z.
const FAN: Fan = Fan { on: true, diameter: 0.4, speed: 5.0, spread: 0.52, oscillation: None };

fn field(fan: Fan, pose: Pose, colliders: &[Collider]) -> WindField {
    let mut field = WindField::default();
    field.set_fans([(fan, pose)], colliders);
    field
}

fn jet() -> WindField {
    field(FAN, Pose::IDENTITY, &[])
}

/// Speed at a distance before the fan and from its axis, m/s.
fn speed(field: &WindField, along: f32, aside: f32) -> f32 {
    field.at(Vec3::new(0.6 * aside, 0.8 * aside, -along)).length()
}

#[test]
fn on_the_axis_the_speed_is_that_of_the_outlet_for_six_diameters_and_falls_with_the_distance_from_there_on() {
    let jet = jet();
    for along in [0.0, 0.1, 1.0, 2.39] {
        assert!((speed(&jet, along, 0.0) - 5.0).abs() < 1e-4);
    }
    for along in [2.41_f32, 4.0, 10.0, 30.0] {
        let expected = 6.0 * 5.0 * 0.4 / along;
        assert!((speed(&jet, along, 0.0) / expected - 1.0).abs() < 1e-4, "at {along} m");
    }
}

#[test]
fn across_the_jet_the_speed_is_a_gaussian_of_a_half_width_of_0_095_of_the_distance() {
    let jet = jet();
    for along in [3.0, 6.0, 20.0] {
        let axis = speed(&jet, along, 0.0);
        for (widths, part) in [(1.0, 0.5), (2.0, 1.0 / 16.0), (0.5, 0.840_896_4)] {
            let found = speed(&jet, along, widths * 0.095 * along) / axis;
            assert!((found - part).abs() < 1e-3, "{found} at {widths} half-widths, {along} m");
        }
    }
}

#[test]
fn the_momentum_flux_is_the_same_at_every_distance() {
    let jet = jet();
    let flux = |along: f32| {
        let step = 0.001 + 0.0005 * along;
        (0..4000)
            .map(|i| (i as f32 + 0.5) * step)
            .map(|r| speed(&jet, along, r).powi(2) * 2.0 * PI * r * step)
            .sum::<f32>()
    };
    let at_outlet = 5.0_f32.powi(2) * PI * 0.2 * 0.2;
    for along in [0.02, 0.4, 1.0, 2.0, 2.4, 3.0, 8.0, 20.0] {
        let part = flux(along) / at_outlet;
        // The known numbers of the far field carry 0.9375 of what an outlet of full speed to its rim would.
        assert!((part / 0.9375 - 1.0).abs() < 0.01, "{part} of the outlet's at {along} m");
    }
}

#[test]
fn the_force_on_a_small_panel_falls_with_the_square_of_the_distance() {
    let force = |along: f32| {
        let mut panel = rectangle(0.04, 0.04, 2, 2, &Fabric::COTTON_POPLIN);
        place(&mut panel, Quat::IDENTITY, Vec3::NEG_Z * along);
        jet().sample(&panel.topology, &mut panel.particles);
        Air::default().blow(&panel.topology, &mut panel.particles, &Tick { dt: 1e-6, ..TICK }.first());
        let force = &panel.particles.airflow.as_ref().unwrap().force;
        (0..force.len()).map(|slot| force.get(slot)).sum::<Vec3>()
    };
    for along in [3.0_f32, 5.0, 9.0, 15.0] {
        let air_speed = 6.0 * 5.0 * 0.4 / along;
        let expected = 0.5 * 1.225 * 1.17 * 0.04 * 0.04 * air_speed * air_speed;
        let found = force(along);
        assert!((found.z / -expected - 1.0).abs() < 0.02, "{found} N at {along} m, not {expected} N");
        assert!((force(2.0 * along).z / found.z * 4.0 - 1.0).abs() < 0.02);
    }
}

#[test]
fn outside_of_the_spread_angle_nothing_moves() {
    for spread in [0.0, 0.1, 0.3, 1.0] {
        let jet = field(Fan { spread, ..FAN }, Pose::IDENTITY, &[]);
        for along in [0.0, 0.5, 2.0, 5.0] {
            let rim = 0.2 + along * (0.5_f32 * spread).tan();
            assert_eq!(speed(&jet, along, rim + 0.01), 0.0, "{spread} rad at {along} m");
            assert!(speed(&jet, along, (rim - 0.01) * 0.3) > 0.0, "{spread} rad at {along} m");
        }
    }
}

#[test]
fn behind_the_fan_the_air_is_drawn_to_it_as_much_as_it_blows() {
    let jet = jet();
    for (at, away) in [(Vec3::Z, 1.0), (Vec3::new(0.6, 0.0, 0.8), 1.0), (Vec3::new(0.0, 1.2, 1.6), 2.0)] {
        let found = jet.at(at);
        assert!(found.normalize().dot(-at.normalize()) > 0.999, "{found} at {at}");
        // What goes through half a sphere over what comes out of the outlet.
        let part = 2.0 * PI * away * away * found.length() / (5.0 * PI * 0.2 * 0.2);
        assert!((0.95..=1.0).contains(&part), "{part} at {at}");
    }
    assert!(speed(&jet, -0.3, 0.0) < 0.2 * 5.0, "gently");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_air_of_a_fan_turns_and_moves_with_it(
        at in prop::array::uniform3(-9.0_f32..9.0), turn in prop::array::uniform3(-2.0_f32..2.0),
        p in prop::array::uniform3(-3.0_f32..3.0)
    ) {
        let pose = Pose::new(Vec3::from(at), Quat::from_scaled_axis(Vec3::from(turn)));
        let p = Vec3::from(p);
        let expected = pose.rotation * jet().at(p);
        let found = field(FAN, pose, &[]).at(pose.point(p));
        // A point at the very rim may fall to either side of it.
        let rim = (p.truncate().length() - 0.2 + p.z * (0.26_f32).tan()).abs() < 1e-3 || p.z.abs() < 1e-4;
        prop_assert!(rim || (found - expected).length() < 1e-3, "{found} and {expected}");
    }

    #[test]
    fn nowhere_is_the_air_faster_than_at_the_outlet(p in prop::array::uniform3(-3.0_f32..3.0)) {
        let found = jet().at(Vec3::from(p)).length();
        prop_assert!(found <= 5.0001, "{found}");
    }
}

#[test]
fn every_shape_shadows_what_is_behind_it_and_not_what_is_before_or_beside_it() {
    let shapes = [
        Shape::sphere(0.15).unwrap(),
        Shape::capsule(0.12, 0.2).unwrap(),
        Shape::cuboid(Vec3::splat(0.25)).unwrap(),
        Shape::pyramid(Vec2::splat(0.3), 0.3).unwrap(),
    ];
    for shape in shapes {
        let body = [collider(shape, Vec3::new(0.3, 0.0, -2.0), Quat::IDENTITY, 0.3)];
        let shadowed = field(Fan { diameter: 1.0, ..FAN }, Pose::IDENTITY, &body);
        let free = field(Fan { diameter: 1.0, ..FAN }, Pose::IDENTITY, &[]);
        let [behind, before, beside] =
            [Vec3::new(0.35, 0.0, -3.0), Vec3::new(0.3, 0.0, -1.5), Vec3::new(-0.3, 0.0, -3.0)];
        assert_eq!(shadowed.at(behind), Vec3::ZERO, "{body:?}");
        assert!(free.at(behind).length() > 1.0);
        assert_eq!(shadowed.at(before), free.at(before), "{body:?}");
        assert_eq!(shadowed.at(beside), free.at(beside), "{body:?}");
    }
}

#[test]
fn the_ground_shadows_what_is_below_it() {
    let turned = Pose::new(Vec3::Y, Quat::from_rotation_x(-0.4));
    let ground = [collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, 0.3)];
    let (free, shadowed) = (field(FAN, turned, &[]), field(FAN, turned, &ground));
    let [above, below] = [2.0, 3.2].map(|away| turned.point(Vec3::NEG_Z * away));
    assert!(above.y > 0.0 && below.y < 0.0);
    assert_eq!(shadowed.at(above), free.at(above));
    assert_eq!(shadowed.at(below), Vec3::ZERO);
}

#[test]
fn what_a_fan_stands_in_does_not_shadow_it_and_a_small_body_before_a_large_outlet_only_a_part() {
    let housing = [collider(Shape::capsule(0.25, 0.1).unwrap(), Vec3::ZERO, Quat::IDENTITY, 0.3)];
    let p = Vec3::new(0.05, 0.0, -1.5);
    assert_eq!(field(FAN, Pose::IDENTITY, &housing).at(p), jet().at(p));
    let hub = [collider(Shape::sphere(0.05).unwrap(), Vec3::NEG_Z * 0.1, Quat::IDENTITY, 0.3)];
    let jet_past_hub = field(FAN, Pose::IDENTITY, &hub);
    assert_eq!(jet_past_hub.at(Vec3::NEG_Z * 1.5), Vec3::ZERO);
    let outer = Vec3::new(0.15, 0.0, -1.0);
    assert_eq!(jet_past_hub.at(outer), jet().at(outer));
    // The air spreads from the rim on, and so does a shadow off the axis.
    let knob = [collider(Shape::sphere(0.03).unwrap(), Vec3::new(0.15, 0.0, -0.3), Quat::IDENTITY, 0.3)];
    let jet_past_knob = field(FAN, Pose::IDENTITY, &knob);
    let [straight_on, outwards] = [Vec3::new(0.15, 0.0, -2.0), Vec3::new(0.39, 0.0, -2.0)];
    assert!(jet_past_knob.at(straight_on) == jet().at(straight_on) && jet().at(outwards) != Vec3::ZERO);
    assert_eq!(jet_past_knob.at(outwards), Vec3::ZERO);
}

#[test]
fn a_fan_that_is_off_and_one_that_was_taken_away_move_nothing() {
    let p = Vec3::NEG_Z;
    assert_eq!(field(Fan { on: false, ..FAN }, Pose::IDENTITY, &[]).at(p), Vec3::ZERO);
    let mut field = jet();
    field.set_fans([], &[]);
    assert_eq!(field.at(p), Vec3::ZERO);
}

#[test]
fn an_oscillating_fan_swings_from_side_to_side_at_its_rate() {
    let fan = Fan { oscillation: Some(Oscillation { angle: 0.8, rate: 6.0 }), ..FAN };
    let angle = |seconds| fan.oscillation.unwrap().angle(seconds);
    for (seconds, expected) in [(0.0, 0.0), (2.5, 0.8), (5.0, 0.0), (7.5, -0.8), (3600.0 * 1e3, 0.0)] {
        assert!((angle(seconds) - expected).abs() < 1e-5, "{} at {seconds} s", angle(seconds));
    }
    let pose = Pose::new(Vec3::X, Quat::from_rotation_z(0.3));
    let turned = fan.turned(pose, 2.5);
    let expected = pose.rotation * Quat::from_rotation_y(0.8) * Vec3::NEG_Z;
    assert!((turned.rotation * Vec3::NEG_Z - expected).length() < 1e-5 && turned.position == Vec3::X);
    assert_eq!(FAN.turned(pose, 2.5), pose);
}

#[test]
fn a_zone_blows_inside_and_comes_up_from_its_edge() {
    let velocity = Vec3::new(0.0, 0.0, -4.0);
    let zone = |shape| WindZone { shape, velocity, falloff: 0.5 };
    let pose = Pose::new(Vec3::Y * 10.0, Quat::from_rotation_y(PI / 2.0));
    let mut field = WindField::uniform(Vec3::X);
    let shapes = [ZoneShape::Sphere { radius: 2.0 }, ZoneShape::Cuboid { size: Vec3::new(4.0, 4.0, 20.0) }];
    for shape in shapes {
        field.set_zones([(zone(shape), pose)]);
        let found = |away: f32| field.at(Vec3::new(0.0, 10.0, away)) - Vec3::X;
        // Turned by a quarter, −z is −x.
        assert!((found(0.0) - Vec3::new(-4.0, 0.0, 0.0)).length() < 1e-5, "{shape:?}");
        assert!((found(1.75) - Vec3::new(-2.0, 0.0, 0.0)).length() < 1e-4, "{shape:?}");
        // Without a kink: t² (3 − 2 t) of it.
        assert!((found(1.9) - Vec3::new(-4.0 * 0.104, 0.0, 0.0)).length() < 1e-4, "{shape:?}");
        assert_eq!(found(2.001), Vec3::ZERO, "{shape:?}");
        field.set_zones([(WindZone { falloff: 0.0, ..zone(shape) }, pose)]);
        assert!((field.at(Vec3::new(0.0, 10.0, 1.999)).x + 3.0).abs() < 1e-5, "{shape:?}");
    }
    field.set_zones([(zone(shapes[0]), pose), (zone(shapes[0]), pose)]);
    assert!((field.at(pose.position).x + 7.0).abs() < 1e-5, "zones add up");
}

#[test]
fn colliders_that_move_shadow_from_where_they_are_at_the_end_of_the_tick() {
    let (from, to) = (Pose::new(Vec3::X * 5.0, Quat::IDENTITY), Pose::new(Vec3::NEG_Z, Quat::IDENTITY));
    let ball = Collider { shape: Shape::sphere(0.3).unwrap(), motion: Motion { from, to }, friction: 0.0 };
    assert_eq!(field(FAN, Pose::IDENTITY, &[ball]).at(Vec3::NEG_Z * 2.0), Vec3::ZERO);
}

#[test]
fn values_out_of_range_are_refused_by_name() {
    let refused = |fan: Fan| fan.validate().unwrap_err().to_string();
    assert!(refused(Fan { diameter: 0.0, ..FAN }).contains("`Fan::diameter` is 0, allowed is 0.01..=100 m"));
    assert!(refused(Fan { speed: f32::NAN, ..FAN }).contains("`Fan::speed` is NaN"));
    assert!(refused(Fan { spread: 3.0, ..FAN }).contains("`Fan::spread` is 3, allowed is 0..=2.5 rad"));
    let swing = |angle, rate| refused(Fan { oscillation: Some(Oscillation { angle, rate }), ..FAN });
    assert!(swing(4.0, 6.0).contains("`Fan::oscillation.angle` is 4"));
    assert!(swing(1.0, -1.0).contains("`Fan::oscillation.rate` is -1"));
    let zone = |zone: WindZone| zone.validate().unwrap_err().to_string();
    let shape = ZoneShape::Cuboid { size: Vec3::new(1.0, 0.0, 1.0) };
    assert!(zone(WindZone { shape, ..WindZone::default() }).contains("`WindZone::shape.size` is 0"));
    let shape = ZoneShape::Sphere { radius: f32::INFINITY };
    assert!(zone(WindZone { shape, ..WindZone::default() }).contains("`WindZone::shape.radius` is inf"));
    assert!(zone(WindZone { velocity: Vec3::X * 2e6, ..WindZone::default() }).contains("`WindZone::velocity`"));
    assert!(zone(WindZone { falloff: -1.0, ..WindZone::default() }).contains("`WindZone::falloff` is -1"));
}
