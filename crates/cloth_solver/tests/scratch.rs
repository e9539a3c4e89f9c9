#![allow(missing_docs)]
mod common;
use std::f32::consts::FRAC_PI_2;
use std::time::Instant;
use cloth_solver::contact::{SelfContact, Shape};
use cloth_solver::{Cloth, Fabric, measure};
use common::*;
use glam::{Quat, Vec3};

fn report(cloth: &mut Cloth, seconds: f32, name: &str) {
    let (mut slowest, mut total) = (0.0_f64, 0.0);
    let mut fast = 0.0_f32;
    for tick in 0..(seconds * 60.0) as u32 {
        let t = Instant::now();
        cloth.step(TICK, GRAVITY);
        let ms = t.elapsed().as_secs_f64() * 1e3;
        total += ms;
        slowest = slowest.max(ms);
        if std::env::var("FINE").is_ok() {
            let n = measure::crossings(&cloth.topology, &cloth.particles).len();
            let c = cloth.self_contacts.as_ref().unwrap();
            println!("tick {tick} crossings {n} ms {ms:.2} subs {} pairs {} touching {} tangled {} searches {} rigid {} bounded {}", cloth.pace.taken(), c.candidates(), c.touching(), c.tangled(), c.searches(), c.rigid_substeps(), c.is_bounded());
            if n > 0 { panic!(); }
        }
        fast = cloth.topology.particles().map(|p| cloth.particles.velocity.get(p as usize).length()).fold(fast, f32::max);
        if tick % 60 == 59 {
            let crossings = measure::crossings(&cloth.topology, &cloth.particles).len();
            let rms = measure::rms_speed(&cloth.topology, &cloth.particles);
            let s = match &cloth.self_contacts { Some(c) => format!("pairs {} touching {} tangled {} searches {} rigid {} bounded {}", c.candidates(), c.touching(), c.tangled(), c.searches(), c.rigid_substeps(), c.is_bounded()), None => String::new() };
            println!("{name} {}s: crossings {crossings} rms {rms:.4} fastest {fast:.2} tick {:.2} ms (max {slowest:.2}) subs {} {s}", (tick + 1) / 60, total / 60.0, cloth.pace.taken());
            (slowest, total, fast) = (0.0, 0.0, 0.0);
        }
    }
}

fn cells() -> u32 { std::env::var("CELLS").map_or(31, |s| s.parse().unwrap()) }
fn secs() -> f32 { std::env::var("SECS").map_or(8.0, |s| s.parse().unwrap()) }
fn is_on() -> bool { std::env::var("OFF").is_err() }
fn fabric() -> Fabric { Fabric::PRESETS[std::env::var("FABRIC").map_or(0usize, |s| s.parse().unwrap())].1 }
fn on(cloth: &mut Cloth, fabric: &Fabric) { if is_on() { cloth.set_self_contact(fabric, &SelfContact::default()).unwrap(); } }

#[test]
fn curtain() {
    let f = fabric();
    let mut cloth = rectangle(1.0, 1.0, cells(), cells(), &f);
    let n = cells();
    pin_top(&mut cloth, 0..=n);
    on(&mut cloth, &f);
    report(&mut cloth, secs(), "curtain");
}

#[test]
fn swing() {
    let f = fabric();
    let mut cloth = rectangle(1.0, 1.0, cells(), cells(), &f);
    let n = cells();
    pin_top(&mut cloth, 0..=n);
    for slot in 0..cloth.topology.slots() {
        let x = cloth.topology.rest[slot];
        cloth.particles.velocity.set(slot, Vec3::Z * (0.5 - x.y) * 2.0);
    }
    on(&mut cloth, &f);
    report(&mut cloth, secs(), "swing");
}

#[test]
fn heap() {
    let f = fabric();
    let mut cloth = rectangle(1.0, 1.0, cells(), cells(), &f);
    place(&mut cloth, Quat::from_rotation_x(0.1) * Quat::from_rotation_z(0.3), Vec3::Y * 0.75);
    let ground = collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, f.friction);
    cloth.contacts.set_colliders([ground]);
    on(&mut cloth, &f);
    report(&mut cloth, secs(), "heap");
}

#[test]
fn folded() {
    let f = fabric();
    let mut cloth = rectangle(1.0, 1.0, cells(), cells(), &f);
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::Y * 0.02);
    // Folded over a fold of 1 cm.
    for slot in 0..cloth.topology.slots() {
        let x = cloth.particles.position.get(slot);
        let r = 0.03;
        let y = if x.x <= 0.0 { x } else if x.x < r * std::f32::consts::PI { let a = x.x / r; Vec3::new(r * a.sin(), x.y + r * (1.0 - a.cos()), x.z) } else { Vec3::new(r * std::f32::consts::PI - x.x, x.y + 2.0 * r, x.z) };
        cloth.particles.position.set(slot, y);
        cloth.particles.previous.set(slot, y);
    }
    let ground = collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, f.friction);
    cloth.contacts.set_colliders([ground]);
    on(&mut cloth, &f);
    report(&mut cloth, secs(), "folded");
}

fn fold(x: Vec3, at: f32, radius: f32) -> Vec3 {
    let (along, arc) = (x.x - at, std::f32::consts::PI * radius);
    if along <= 0.0 { x } else if along < arc {
        let (sin, cos) = (along / radius).sin_cos();
        Vec3::new(at + radius * sin, x.y + radius * (1.0 - cos), x.z)
    } else { Vec3::new(at + arc - along, 2.0 * radius + x.y, x.z) }
}

#[test]
fn halves() {
    let f = Fabric { damping: 0.0, ..Fabric::PRESETS[1].1 };
    let mut cloth = rectangle(0.6, 0.3, 16, 8, &f);
    let speed = 16.700552;
    for slot in 0..cloth.topology.slots() {
        let flat = cloth.topology.rest[slot];
        let x = fold(Vec3::new(flat.x, 0.0, flat.y), 0.01, 0.06);
        cloth.particles.position.set(slot, x);
        cloth.particles.previous.set(slot, x);
        if cloth.particles.mass[slot] > 0.0 {
            cloth.particles.velocity.set(slot, if x.y > 0.06 { Vec3::Y * -speed } else { Vec3::Y * speed });
        }
    }
    cloth.set_self_contact(&f, &SelfContact { friction: Some(0.0), ..SelfContact::default() }).unwrap();
    for tick in 0..3 {
        cloth.step(TICK, Vec3::ZERO);
        let all = measure::crossings(&cloth.topology, &cloth.particles);
        let own = cloth.self_contacts.as_ref().unwrap();
        println!("tick {tick} {} rigid {} searches {} pairs {} tangled {} bounded {} subs {}", all.len(), own.rigid_substeps(), own.searches(), own.candidates(), own.tangled(), own.is_bounded(), cloth.pace.taken());
        for p in all.iter().take(4) { println!("{p:?} {:?}", cloth.topology.triangles[p.triangle as usize]); for id in p.edge.iter().chain(&cloth.topology.triangles[p.triangle as usize]) { println!("{id} rest {} from {} to {} v {}", cloth.topology.rest[*id as usize], cloth.particles.previous.get(*id as usize), cloth.particles.position.get(*id as usize), cloth.particles.velocity.get(*id as usize)); } }
    }
}

#[test]
fn layers() {
    let f = fabric();
    let n: u32 = std::env::var("LAYERS").map_or(4, |s| s.parse().unwrap());
    let (length, radius) = (0.25, 0.02);
    let period = length + std::f32::consts::PI * radius;
    let width = period * n as f32;
    let mut cloth = rectangle(width, 0.4, (width / 0.4 * 15 as f32) as u32, 15, &f);
    for slot in 0..cloth.topology.slots() {
        let rest = cloth.topology.rest[slot];
        let along = rest.x + 0.5 * width;
        let layer = ((along / period) as u32).min(n - 1);
        let (rest_of_it, is_back) = (along - layer as f32 * period, layer % 2 == 1);
        let (sin, cos) = ((rest_of_it - length).max(0.0) / radius).sin_cos();
        let x = rest_of_it.min(length) + radius * sin;
        let y = (2 * layer) as f32 * radius + radius * (1.0 - cos) + 0.01;
        let x = Vec3::new(if is_back { length - x } else { x }, y, rest.y);
        cloth.particles.position.set(slot, x);
        cloth.particles.previous.set(slot, x);
    }
    cloth.contacts.set_colliders([collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, f.friction)]);
    on(&mut cloth, &f);
    report(&mut cloth, secs(), "layers");
    let (lo, hi) = measure::bounds(&cloth.topology, &cloth.particles.position);
    println!("{lo} {hi} strain {}", measure::largest_strain(&cloth.topology, &cloth.particles));
}
