//! experiment
use cloth_solver::*;
use cloth_solver::contact::*;
use glam::*;
use std::sync::Arc;
fn main() {
    let l: f32 = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(0.025);
    let fab = match std::env::args().nth(2).as_deref() { Some("silk") => Fabric::SILK_CHARMEUSE, Some("velvet") => Fabric::VELVET_CURTAIN, Some("denim")=>Fabric::DENIM_11_OZ, Some("jersey")=>Fabric::COTTON_JERSEY, _ => Fabric::COTTON_POPLIN };
    let topo = Arc::new(Topology::rectangle(Vec2::ONE, topology::Resolution::Spacing(l)).unwrap());
    let flat = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    for (name, shape, rot, off) in [
        ("sphere", Shape::sphere(0.3).unwrap(), Quat::IDENTITY, 0.0),
        ("capsule", Shape::capsule(0.15, 0.5).unwrap(), Quat::from_rotation_z(1.57), 0.0),
        ("pyramid apex", Shape::pyramid(Vec2::new(0.6,0.6), 0.5).unwrap(), Quat::IDENTITY, 0.0),
        ("pyramid edge", Shape::pyramid(Vec2::new(0.6,0.6), 0.5).unwrap(), Quat::from_rotation_x(1.2)*Quat::from_rotation_y(0.785), 0.0),
        ("pyramid face", Shape::pyramid(Vec2::new(0.6,0.6), 0.5).unwrap(), Quat::from_rotation_x(-1.03), 0.2),
        ("box", Shape::cuboid(Vec3::splat(0.5)).unwrap(), Quat::IDENTITY, 0.0),
        ("box corner", Shape::cuboid(Vec3::splat(0.5)).unwrap(), Quat::from_rotation_x(0.6154)*Quat::from_rotation_z(0.785), 0.0),
        ("ground", Shape::HalfSpace, Quat::IDENTITY, -0.3),
    ] {
        let mut c = Cloth::new(topo.clone(), &fab).unwrap();
        for p in 0..topo.slots() { let r = topo.rest[p]; c.particles.position.set(p, flat*r + Vec3::new(off,0.6,0.03)); c.particles.previous.set(p, flat*r); }
        let col = |shape, y, rot| Collider { shape, motion: Motion::at_rest(Pose::new(Vec3::new(0.0,y,0.0), rot)), friction: fab.friction };
        c.contacts.set_colliders([col(shape.clone(), 0.2, rot), col(Shape::HalfSpace, -0.3, Quat::IDENTITY)]);
        let tick = Tick { dt: 1.0/60.0, substeps: 10 };
        let mut t = std::time::Duration::ZERO;
        let mut maxrms: f32 = 0.0;
        for i in 0..1200 {
            let t0 = std::time::Instant::now();
            c.step(tick, Vec3::new(0.0,-9.81,0.0));
            t += t0.elapsed();
            let rms = (topo.particles().map(|p| c.particles.velocity.get(p as usize).length_squared()).sum::<f32>()/topo.particle_count() as f32).sqrt();
            if i >= 600 { maxrms = maxrms.max(rms); }
            if i % 200 == 199 { print!(" {:.4}", rms); }
        }
        let ys: Vec<f32> = topo.particles().map(|p| c.particles.position.get(p as usize).y).collect();
        println!(" {name}: max rms 10-20s {:.4} contacts {} deepest {:.5} off {:.5} ms {:.3} ymean {:.3} strain {:.4}", maxrms, c.contacts.touching, c.contacts.deepest, c.contacts.offset, t.as_secs_f64()*1e3/1200.0, ys.iter().sum::<f32>()/ys.len() as f32, measure::largest_strain(&topo, &c.particles));
    }
}
