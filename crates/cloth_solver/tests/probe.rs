mod common;
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::forces::Air;
use cloth_solver::{Cloth, Fabric, Motion, Pose, Tick, measure};
use common::*;
use glam::{Quat, Vec3};
use std::time::Instant;
fn fastest(cloth: &Cloth) -> (f32, usize) {
    cloth.topology.particles().map(|p| (cloth.particles.velocity.get(p as usize).length(), p as usize)).fold((0.0, 0), |a, b| if b.0 > a.0 || b.0.is_nan() { b } else { a })
}
#[test]
fn reset() {
    for below in [0.3_f32, 0.6, 1.0] {
        let mut cloth = rectangle(1.2, 1.5, 48, 60, &Fabric::COTTON_POPLIN);
        cloth.air = Some(Air::default());
        pin_top(&mut cloth, (0..=48).step_by(8));
        cloth.contacts.set_colliders([collider(Shape::HalfSpace, Vec3::Y * (-0.75 + below), Quat::IDENTITY, 0.3)]);
        let (mut most, mut moved) = (0.0_f32, 0.0_f32);
        for tick in 0..600 {
            let before = positions(&cloth);
            cloth.step(TICK, GRAVITY);
            moved = moved.max(positions(&cloth).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max) / TICK.dt);
            most = most.max(fastest(&cloth).0);
            if [5, 10, 15, 20, 30, 60, 599].contains(&tick) { println!("reset {below} tick {tick} moved {moved} velocity {most} {:?} rms {} strain {} taken {}", fastest(&cloth), measure::rms_speed(&cloth.topology, &cloth.particles), measure::largest_strain(&cloth.topology, &cloth.particles), cloth.pace.taken()); }
        }
    }
}
#[test]
fn curtain() {
    for (fabric_name, fabric) in [("poplin", Fabric::COTTON_POPLIN), ("velvet", Fabric::VELVET_CURTAIN)] {
    for (name, from, way, length) in [("front", Vec3::new(0.0, -0.2, 0.7), Vec3::NEG_Z, 1.4_f32), ("down", Vec3::new(0.2, 0.2 - 0.9 + 0.6 - 0.1, 0.0), Vec3::NEG_Y, 0.0)] {
        if length == 0.0 { continue; }
        for speed in [1.0_f32, 5.0, 20.0] {
          for tick in [TICK, Tick::fixed(1.0 / 60.0, 200)] {
            if tick != TICK && (std::env::var("REF").is_err() || speed > 5.0 || fabric_name != "poplin") { continue; }
            let mut cloth = rectangle(2.0, 1.8, 80, 72, &fabric);
            cloth.air = Some(Air::default());
            pin_top(&mut cloth, (0..=80).step_by(16));
            run(&mut cloth, 1.0);
            let (mut at, mut most, mut strained, mut after) = (0.0_f32, 0.0_f32, 0.0_f32, 0.0_f32);
            let count = (length / speed * 60.0).ceil() as u32;
            let start = Instant::now();
            let mut which = 0;
            let mut hit_time = 0.0;
            for i in 0..count + 300 {
                if tick != TICK && i > count + 30 { break; }
                let next = (at + speed / 60.0).min(length);
                let pose = |d: f32| Pose::new(from + way * d, Quat::IDENTITY);
                cloth.contacts.set_colliders([Collider { shape: Shape::sphere(0.3).unwrap(), motion: Motion { from: pose(at), to: pose(next) }, friction: 0.3 }]);
                at = next;
                cloth.step(tick, GRAVITY);
                let f = fastest(&cloth);
                if f.0 > most { most = f.0; which = f.1; hit_time = i as f32 / 60.0; }
                if i < count { strained = strained.max(measure::largest_strain(&cloth.topology, &cloth.particles)); } else { after = after.max(measure::largest_strain(&cloth.topology, &cloth.particles)); }
            }
            let stride = cloth.topology.grid.unwrap().stride as usize;
            println!("{fabric_name} {name} {speed} m/s most {} fastest {most} at row {} column {} t {hit_time} strain {strained} after {after} rms {} time {:?}", tick.most, which / stride, which % stride, measure::rms_speed(&cloth.topology, &cloth.particles), start.elapsed());
          }
        }
    }
    }
}

#[test]
fn hang() {
    let mut cloth = rectangle(1.2, 1.5, 48, 60, &Fabric::COTTON_POPLIN);
    cloth.air = Some(Air::default());
    pin_top(&mut cloth, (0..=48).step_by(8));
    for second in 0..6 {
        run(&mut cloth, 1.0);
        println!("hang {second} fastest {:?} rms {} taken {}", fastest(&cloth), measure::rms_speed(&cloth.topology, &cloth.particles), cloth.pace.taken());
    }
}
