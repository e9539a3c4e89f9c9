mod common;
use cloth_solver::contact::Shape;
use cloth_solver::{Cloth, Fabric, measure};
use common::*;
use glam::{Quat, Vec3};
use std::f32::consts::FRAC_PI_2;
fn fastest(cloth: &Cloth) -> (f32, usize) {
    cloth.topology.particles().map(|p| (cloth.particles.velocity.get(p as usize).length(), p as usize)).fold((0.0, 0), |a, b| if b.0 > a.0 || b.0.is_nan() { b } else { a })
}
#[test]
fn half() {
    for (name, shape) in [("sphere", Shape::sphere(0.4).unwrap()), ("box", Shape::cuboid(Vec3::splat(0.8)).unwrap())] {
        let mut cloth = rectangle(0.4, 0.4, 16, 16, &Fabric::COTTON_POPLIN);
        place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::Y * 0.33);
        cloth.contacts.set_colliders([collider(shape, Vec3::ZERO, Quat::IDENTITY, 0.3)]);
        for tick in 0..40 {
            let before = positions(&cloth);
            cloth.step(TICK, Vec3::ZERO);
            let moved = positions(&cloth).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            println!("{name} {tick} moved {} fastest {:?} touching {} deepest {} taken {}", moved / TICK.dt, fastest(&cloth), cloth.contacts.touching, cloth.contacts.deepest, cloth.pace.taken());
        }
    }
}
#[test]
fn corner() {
    let fabric = Fabric::COTTON_POPLIN;
    let mut cloth = rectangle(1.0, 1.0, 40, 40, &fabric);
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(0.0, 0.6, 0.03));
    let rotation = Quat::from_rotation_x(0.6154) * Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
    let solid = collider(Shape::cuboid(Vec3::splat(0.5)).unwrap(), Vec3::new(0.0, 0.2, 0.0), rotation, fabric.friction);
    let ground = collider(Shape::HalfSpace, Vec3::new(0.0, -0.3, 0.0), Quat::IDENTITY, fabric.friction);
    cloth.contacts.set_colliders([solid, ground]);
    for second in 0..20 {
        run(&mut cloth, 1.0);
        println!("{second} rms {} fastest {:?} touching {} taken {}", measure::rms_speed(&cloth.topology, &cloth.particles), fastest(&cloth), cloth.contacts.touching, cloth.pace.taken());
    }
    let (_, p) = fastest(&cloth);
    println!("{:?}", cloth.particles.position.get(p));
}
#[test]
fn corner_detail() {
    let fabric = Fabric::COTTON_POPLIN;
    let mut cloth = rectangle(1.0, 1.0, 40, 40, &fabric);
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(0.0, 0.6, 0.03));
    let rotation = Quat::from_rotation_x(0.6154) * Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
    let solid = collider(Shape::cuboid(Vec3::splat(0.5)).unwrap(), Vec3::new(0.0, 0.2, 0.0), rotation, fabric.friction);
    let ground = collider(Shape::HalfSpace, Vec3::new(0.0, -0.3, 0.0), Quat::IDENTITY, fabric.friction);
    cloth.contacts.set_colliders([solid.clone(), ground]);
    run(&mut cloth, 5.0);
    let (_, p) = fastest(&cloth);
    for _ in 0..2 {
        for d in [-49, -48, -47, -1, 0, 1, 47, 48, 49_i32] {
            let i = (p as i32 + d) as usize;
            let x = cloth.particles.position.get(i);
            let (dist, n) = solid.shape.distance_and_normal(solid.motion.to.inverse_point(x));
            println!("{i} x {x:?} v {:?} moved {:?} dist {dist} n {n:?}", cloth.particles.velocity.get(i), x - cloth.particles.previous.get(i));
        }
        cloth.step(TICK, GRAVITY);
    }
    let mut worst: Vec<(f32, usize)> = cloth.topology.particles().map(|p| (cloth.particles.velocity.get(p as usize).length(), p as usize)).collect();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("{:?}", &worst[..20]);
}
