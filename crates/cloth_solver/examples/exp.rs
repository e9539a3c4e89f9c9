//! experiment
use cloth_solver::*;
use cloth_solver::constraint::*;
use glam::*;
use std::sync::Arc;
fn main() {
    let n: u32 = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(63);
    let sub: u32 = std::env::args().nth(2).and_then(|s| s.parse().ok()).unwrap_or(10);
    let mode = std::env::args().nth(3).unwrap_or("top".into());
    let topo = Arc::new(Topology::rectangle(Vec2::ONE, topology::Resolution::Cells(UVec2::splat(n))).unwrap());
    let mut c = Cloth::new(topo.clone(), &Fabric::COTTON_POPLIN).unwrap();
    let g = topo.grid.unwrap();
    let pins: Vec<u32> = match mode.as_str() { "top" => (0..g.columns).collect(), "corner" => vec![0, g.columns-1], _ => vec![] };
    let pins = Pins { frames: vec![Motion::default()], pins: pins.into_iter().map(|p| Pin{particle:p, frame:0, local: topo.rest[p as usize]}).collect() };
    c.constraints.set_pins(&mut c.particles, pins).unwrap();
    let tick = Tick { dt: 1.0/60.0, substeps: sub };
    if let Some(a) = std::env::args().nth(4) { let a: f32 = a.parse().unwrap(); let mut seed=1u32; for p in topo.particles() { seed = seed.wrapping_mul(1664525).wrapping_add(1013904223); if c.particles.inverse_mass[p as usize]>0.0 { c.particles.position.z[p as usize] += a*((seed>>8) as f32/8388608.0-1.0); } } }
    println!("constraints {}", c.constraints.count());
    let mut t = std::time::Duration::ZERO;
    for i in 0..600 {
        let t0 = std::time::Instant::now();
        c.step(tick, Vec3::new(0.0,-9.81,0.0));
        t += t0.elapsed();
        if i % 60 == 59 {
            let mut worst: f32 = 0.0;
            for r in 0..g.rows { for col in 0..g.columns {
                let a = c.particles.position.get(g.slot(r,col) as usize);
                if r+1<g.rows { worst = worst.max(a.distance(c.particles.position.get(g.slot(r+1,col) as usize))/g.spacing.y-1.0); }
                if col+1<g.columns { worst = worst.max(a.distance(c.particles.position.get(g.slot(r,col+1) as usize))/g.spacing.x-1.0); }
            }}
            let rms = (topo.particles().map(|p| c.particles.velocity.get(p as usize).length_squared()).sum::<f32>()/topo.particle_count() as f32).sqrt();
            println!("{i} strain {:.4}% rms {:.4} need {} low {:?} ms/tick {:.3} ns/constraint {:.2}", worst*100.0, rms, c.constraints.scaled_particles(&c.particles), c.particles.position.get(g.slot(g.rows-1, g.columns/2) as usize), t.as_secs_f64()*1e3/60.0, t.as_secs_f64()*1e9/60.0/sub as f64/c.constraints.count() as f64);
            t = std::time::Duration::ZERO;
        }
    }
}
