//! A mannequin walks as people do: its feet stand still while they are on the ground, and its joints turn as far as theirs.

use cloth_scene::{Body, FigurePart, Gait, Scene, SceneFigure, Walk, World};
use cloth_solver::{Pose, measure};
use glam::Vec3;

const TICK: f32 = 1.0 / 240.0;
const SPEEDS: [f32; 7] = [0.3, 0.7, 1.4, 1.9, 2.3, 3.0, 4.0];

/// The poses of so many strides at a steady speed, on a circle of 2.5 m.
fn strides(speed: f32, count: f32) -> Vec<[Pose; FigurePart::COUNT]> {
    let gait = Gait::new(1.75, 2.5);
    let mut walk = Walk { speed, ..Walk::default() };
    let ticks = (count * gait.stride(speed) / speed / TICK) as usize;
    let mut poses = || {
        gait.advance(&mut walk, speed, TICK);
        gait.poses(&walk)
    };
    (0..ticks).map(|_| poses()).collect()
}

fn at(poses: &[Pose; FigurePart::COUNT], part: FigurePart) -> Pose {
    poses[part as usize]
}

#[test]
fn what_of_a_foot_is_on_the_ground_does_not_slide() {
    let body = Body::new(1.75);
    for speed in SPEEDS {
        let (mut stands, mut most) = (0, 0.0_f32);
        for pair in strides(speed, 3.0).windows(2) {
            for foot in [FigurePart::LeftFoot, FigurePart::RightFoot] {
                for along in [body.heel, -body.ball] {
                    let [before, after] = [0, 1].map(|i| at(&pair[i], foot).point(Vec3::new(0.0, -body.ankle, along)));
                    assert!(after.y > -2e-3, "{speed} m/s: {} m under the ground", after.y);
                    if before.y.max(after.y) < 2e-5 {
                        stands += 1;
                        most = most.max(before.distance(after) / TICK);
                    }
                }
            }
        }
        println!("{speed} m/s: {stands} ticks, at most {most} m/s");
        assert!(stands > 100 && most < 0.06, "{speed} m/s: {stands} ticks, {most} m/s");
    }
}

#[test]
fn hips_and_knees_turn_as_far_as_those_of_people_who_walk() {
    // Winter (2009), natural cadence: hip from −20° to 20°, knee from 0° to 65°.
    let (mut hips, mut knees) = ((f32::MAX, f32::MIN), (f32::MAX, f32::MIN));
    for poses in strides(1.4, 2.0) {
        let [thigh, shank] = [FigurePart::LeftThigh, FigurePart::LeftShank].map(|part| at(&poses, part).rotation);
        let heading = at(&poses, FigurePart::Head).rotation;
        let down = heading.conjugate() * (thigh * Vec3::NEG_Y);
        let hip = (-down.z).atan2(-down.y).to_degrees();
        let knee = (thigh * Vec3::Y).angle_between(shank * Vec3::Y).to_degrees();
        hips = (hips.0.min(hip), hips.1.max(hip));
        knees = (knees.0.min(knee), knees.1.max(knee));
    }
    println!("hips {hips:?}, knees {knees:?}");
    assert!((-30.0..-12.0).contains(&hips.0) && (18.0..38.0).contains(&hips.1), "{hips:?}");
    assert!(knees.0 < 15.0 && (48.0..75.0).contains(&knees.1), "{knees:?}");
}

#[test]
fn joints_stay_together_at_any_speed() {
    use FigurePart::*;
    let body = Body::new(1.75);
    for poses in SPEEDS.into_iter().flat_map(|speed| strides(speed, 1.0)) {
        for (upper, length, lower) in [
            (LeftThigh, body.thigh, LeftShank),
            (RightShank, body.shank, RightFoot),
            (LeftUpperArm, body.upper_arm, LeftForearm),
            (RightForearm, body.forearm, RightHand),
        ] {
            let end = at(&poses, upper).point(Vec3::NEG_Y * length);
            assert!(end.distance(at(&poses, lower).position) < 1e-4, "{upper:?}");
        }
        assert!(poses.iter().all(|pose| pose.is_finite() && (pose.rotation.length() - 1.0).abs() < 1e-4));
    }
}

#[test]
fn a_leg_goes_on_without_a_jump_through_stride_and_change_of_speed() {
    let gait = Gait::new(1.75, 2.5);
    let (mut walk, mut before) = (Walk::default(), gait.poses(&Walk::default()));
    let mut most = 0.0_f32;
    for tick in 0..(12.0 / TICK) as usize {
        let wanted = [4.0, 0.0, 1.4, 4.0, 0.5, 0.0][tick * 6 / (12.0 / TICK) as usize];
        gait.advance(&mut walk, wanted, TICK);
        let poses = gait.poses(&walk);
        for (now, then) in poses.iter().zip(&before) {
            most = most.max(now.position.distance(then.position) / TICK);
        }
        before = poses;
    }
    println!("at most {most} m/s");
    assert!(most < 14.0, "{most} m/s");
    assert_eq!(walk.speed, 0.0, "it stands in the end");
}

#[test]
fn a_mannequin_that_stands_is_as_tall_as_its_file_says() {
    for height in [1.2, 1.75, 2.0] {
        let figure = SceneFigure { height, ..SceneFigure::default() };
        let poses = figure.poses(&Walk::default());
        let solids = Body::new(height).solids();
        let head = solids.iter().filter(|(part, ..)| *part == FigurePart::Head);
        let top = head.map(|(part, shape, pose)| {
            let cloth_scene::SceneShape::Capsule { radius, length } = shape else { panic!("{shape:?}") };
            at(&poses, *part).point(pose.position).y + length / 2.0 + radius
        });
        let top = top.fold(0.0, f32::max);
        assert!((top / height - 1.0).abs() < 0.01, "{top} of {height} m");
    }
}

#[test]
fn a_skirt_in_a_world_without_engine_hangs_on_the_hips_of_a_mannequin_that_stands() {
    let text = "(
        figures: [(place: (at: (1, 0, 2)))],
        cloths: [(
            cells: (32, 10), pins: [Top], worn: (), place: (at: (0, 0.12, 0)),
            wrap: (rings: [(at: 0, radii: (0.14, 0.12)), (at: -0.5, radii: (0.3, 0.3))], pleats: 8, depth: 0.02),
        )],
    )";
    let scene = Scene::from_ron(text).expect("valid");
    let mut world = World::new(&scene).expect("built");
    (0..60).for_each(|_| world.tick());
    let (cloth, frame) = (&world.cloths[0], world.frames[0]);
    assert_eq!(cloth.topology.particles().count(), 32 * 11, "left and right edge are one");
    assert_eq!(cloth.constraints.pins().pins.len(), 32);
    let middle = frame.point(measure::centre_of_mass(&cloth.particles).as_vec3());
    assert!((middle.x - 3.5).abs() < 0.05 && (middle.z - 2.0).abs() < 0.05, "{middle}");
    assert!((0.6..0.95).contains(&middle.y), "{middle}");
    assert!(measure::largest_strain(&cloth.topology, &cloth.particles) < 0.05);
}

#[test]
fn what_a_scene_says_wrong_of_mannequins_and_what_they_wear_is_told() {
    let ring = "(at: 0, radii: (0.1, 0.1))";
    for (text, told) in [
        ("(figures: [(), (height: 9)])".to_string(), "figure 1: `SceneFigure::height` is 9, allowed is 0.5..=3 m"),
        ("(figures: [(speed: -1)])".into(), "figure 0: `SceneFigure::speed` is -1, allowed is 0..=4 m/s"),
        ("(figures: [(radius: 0)])".into(), "figure 0: `SceneFigure::radius` is 0, allowed is 1..=100 m"),
        ("(figures: [(place: (at: (0, NaN, 0)))])".into(), "figure 0: `SceneFigure::place` is NaN"),
        ("(figures: [(finish: Paint((2, 0, 0)))])".into(), "figure 0: `Finish::color` is 2"),
        ("(cloths: [(worn: (part: Head))])".into(), "cloth 0: `SceneWorn::figure` is 0, allowed is the number of one"),
        (format!("(cloths: [(wrap: (rings: [{ring}]))])"), "cloth 0: `SceneWrap::rings` is 1, allowed is 2..=100"),
        (format!("(cloths: [(wrap: (rings: [{ring}, (at: 11, radii: (1, 1))]))])"), "`SceneRing::at` is 11"),
        (format!("(cloths: [(wrap: (rings: [{ring}, (at: 1, radii: (0, 1))]))])"), "`SceneRing::radii` is 0"),
        ("(cloths: [(pins: [Rows(0)])])".into(), "cloth 0: `ScenePins::Rows` is 0, allowed is 1..=10,000"),
        ("(cloths: [(wrap: (arc: 5))])".into(), "cloth 0: `SceneWrap::arc` is 5, allowed is 10..=360°"),
        ("(cloths: [(wrap: (pleats: 201))])".into(), "cloth 0: `SceneWrap::pleats` is 201, allowed is 0..=200"),
        ("(cloths: [(wrap: (depth: 1))])".into(), "cloth 0: `SceneWrap::depth` is 1, allowed is 0..=0.2 m"),
    ] {
        let error = Scene::from_ron(&text).expect_err(&text).to_string();
        assert!(error.contains(told), "{text}: {error}");
    }
}
