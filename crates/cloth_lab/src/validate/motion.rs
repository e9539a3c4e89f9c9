//! Free motion: momentum, energy, falling.

use cloth_solver::{ClothError, Fabric, Method, measure};
use glam::{DVec3, Vec3};

use super::finding::{Bench, Bound, budget};
use super::rig::{self, G, GRAVITY};

/// Methods that keep momentum by their structure.
const METHODS: &[Method] = &[Method::XpbdSweeps, Method::XpbdLines];

/// A free cloth that flies, spins and flaps for 10 s.
pub fn conservation(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "conservation";
    let fabric = Fabric { damping: 0.0, ..Fabric::COTTON_POPLIN };
    for method in bench.with_default(METHODS) {
        let mut cloth = rig::rectangle([1.0, 1.0], [16, 16], &fabric, method)?;
        let spin = Vec3::new(0.4, 1.0, 2.0);
        for slot in 0..cloth.topology.slots() {
            let rest = cloth.topology.rest[slot];
            let flap = Vec3::Z * (3.0 * rest.x * rest.y);
            cloth.particles.velocity.set(slot, Vec3::new(0.05, 0.0, 0.02) + spin.cross(rest) + flap);
        }
        let about = |cloth: &cloth_solver::Cloth| measure::centre_of_mass(&cloth.particles);
        let energy = |cloth: &cloth_solver::Cloth| {
            let middle = rig::midway(cloth);
            measure::kinetic_energy(&middle) + measure::elastic_energy(&cloth.topology, &middle, &fabric)
        };
        let linear: DVec3 = measure::linear_momentum(&cloth.particles);
        let angular = measure::angular_momentum(&cloth.particles, about(&cloth));
        let first = energy(&cloth);
        let (mut drift, mut turn, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
        let worse = |worst: f64, now: f64| if now > worst || now.is_nan() { now } else { worst };
        for _ in 0..600 {
            cloth.step(budget(method), Vec3::ZERO);
            let now = measure::linear_momentum(&cloth.particles);
            drift = worse(drift, (now - linear).length() / linear.length());
            let now = measure::angular_momentum(&cloth.particles, about(&cloth));
            turn = worse(turn, (now - angular).length() / angular.length());
            most = worse(most, energy(&cloth) / first - 1.0);
        }
        bench.claim(CHECK, "drift of linear momentum in 10 s, parts", method, drift, 1e-5, Bound::AtMost);
        bench.claim(CHECK, "drift of angular momentum in 10 s, parts", method, turn, 1e-5, Bound::AtMost);
        bench.claim(CHECK, "rise of energy in 10 s, parts", method, most.max(0.0), 1e-3, Bound::AtMost);
    }
    Ok(())
}

/// Free fall by gt²/2, whatever the stiffness.
pub fn fall(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "free fall";
    for method in bench.with_default(METHODS) {
        for (name, fabric) in
            [("cotton poplin", Fabric::COTTON_POPLIN), ("jersey", Fabric::COTTON_JERSEY), ("paper", Fabric::PAPER)]
        {
            let mut cloth = rig::rectangle([1.0, 1.0], [10, 10], &fabric, method)?;
            rig::run(&mut cloth, budget(method), GRAVITY, 1.0);
            let fallen = -f64::from(rig::mean(&cloth, |_| true).y);
            let what = format!("fall of {name} in 1 s, m");
            bench.claim(CHECK, what, method, fallen, 0.5 * G, Bound::Relative(0.005));
        }
    }
    Ok(())
}
