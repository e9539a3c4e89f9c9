//! What a fire takes from its cloth: mass and stiffness.

use super::Fire;
use crate::constraint::{Constraints, Wear};
use crate::{Particles, Topology};

impl Fire {
    /// Lets mass and stiffness of the cloth of `topology` be what the fire has left of them. What hangs on it weighs what it
    /// weighed.
    pub fn take_toll(&mut self, topology: &Topology, particles: &mut Particles, constraints: &mut Constraints) {
        let state = &mut self.state;
        for (slot, taken) in state.taken.iter_mut().enumerate() {
            let now = 1.0 - state.mass_factor[slot];
            let before = particles.mass[slot];
            if *taken != now && before > 0.0 {
                // What a cut leaves of a half-burnt triangle is shared by area: a particle may have less fabric than its own fire
                // says. It burns as far, and no more of it than there is.
                let fabric = before.min(self.areal_density * topology.area[slot] * (1.0 - *taken));
                let mass = before - fabric * (now - *taken) / (1.0 - *taken);
                particles.mass[slot] = mass;
                if particles.inverse_mass[slot] > 0.0 {
                    particles.inverse_mass[slot] = 1.0 / mass;
                }
            }
            *taken = now;
        }
        constraints.wear(Some(Wear { stiffness: &state.stiffness, rest: &state.rest_scale }));
    }

    /// To be called when the cloth has its full mass again, as after a change of fabric.
    pub fn forget_toll(&mut self) {
        self.state.taken.fill(0.0);
    }
}
