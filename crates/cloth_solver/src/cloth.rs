//! One cloth as a whole, and the loop of one tick.

use std::sync::Arc;

use glam::Vec3;

use crate::contact::{Contacts, SelfContact, SelfContacts};
use crate::damage::fire::{Fire, Surroundings};
use crate::damage::{self, Blade, Cut, Direction, Stroke, Tear, Tearing, Torn};
use crate::forces::{Air, WindField};
use crate::method::Method;
use crate::tick::{Effort, Pace, Substep, Tick};
use crate::topology::Change;
use crate::{ClothError, Fabric, Particles, Topology};

pub use crate::constraint::Constraints;

/// A cloth that steps itself: for tests, benchmarks and engines without an ECS.
#[derive(Clone, Debug)]
pub struct Cloth {
    /// Rest state and connectivity.
    pub topology: Arc<Topology>,
    /// State of motion.
    pub particles: Particles,
    /// Constraints.
    pub constraints: Constraints,
    /// Contact.
    pub contacts: Contacts,
    /// Contact with itself. Default none: it passes through itself, and nothing is computed.
    pub self_contacts: Option<SelfContacts>,
    /// The air around it. Default none: no air acts, and none is computed.
    pub air: Option<Air>,
    /// How that moves in this tick.
    pub wind: WindField,
    /// How its ticks are divided.
    pub pace: Pace,
}

impl Cloth {
    /// At rest at the rest positions, no pins, no colliders, no gravity.
    pub fn new(topology: Arc<Topology>, fabric: &Fabric) -> Result<Self, ClothError> {
        fabric.validate()?;
        Ok(Self {
            particles: Particles::new(&topology, fabric.areal_density),
            constraints: Constraints::new(&topology, fabric)?,
            contacts: Contacts::new(&topology, fabric),
            self_contacts: None,
            air: None,
            wind: WindField::default(),
            pace: Pace::default(),
            topology,
        })
    }

    /// Advances with `method` from now on.
    pub fn set_method(&mut self, method: Method) {
        self.constraints.set_method(&self.topology, method);
    }

    /// Keeps off itself from now on, as a cloth of `fabric`.
    ///
    /// # Errors
    /// A setting out of its range; then nothing changes.
    pub fn set_self_contact(&mut self, fabric: &Fabric, settings: &SelfContact) -> Result<(), ClothError> {
        self.self_contacts = Some(SelfContacts::new(&self.topology, fabric, settings)?);
        Ok(())
    }

    /// Cuts it with `blade`. `None` if that crosses nothing.
    pub fn cut(&mut self, blade: &Blade) -> Option<Cut> {
        self.sweep(&mut Stroke::new(blade.from, &self.particles.position), blade.to)
    }

    /// Cuts it from the last ray of `stroke` to another one: near and far end, m. `None` if that crosses nothing.
    pub fn sweep(&mut self, stroke: &mut Stroke, to: [Vec3; 2]) -> Option<Cut> {
        let before = self.topology.clone();
        let cut = stroke.sweep(&mut self.topology, &self.particles.position, to);
        self.follow(&before, cut.as_ref().map(|cut| &cut.change));
        cut
    }

    /// Tears what `tear` knows to carry more than `tearing` allows. `None` if nothing does.
    pub fn tear(&mut self, tear: &mut Tear, tearing: &Tearing) -> Option<Torn> {
        let before = self.topology.clone();
        let torn = tear.tear(&mut self.topology, &self.constraints.pins().pins, tearing, &[]);
        if let Some(torn) = &torn {
            tear.follow(&torn.change);
        }
        self.follow(&before, torn.as_ref().map(|torn| &torn.change));
        torn
    }

    /// Parts a particle as if it were pulled along `pull`; `None` if it cannot be parted.
    pub fn tear_at(&mut self, particle: u32, pull: Direction) -> Option<Change> {
        let before = self.topology.clone();
        let change = damage::tear_at(&mut self.topology, particle, pull);
        self.follow(&before, change.as_ref());
        change
    }

    /// Burns it with its `fire` for `dt` s; what burns through is taken out. `None` if nothing does.
    ///
    /// # Errors
    /// Those of [`Fire::burn`]; then nothing changes.
    pub fn burn(&mut self, fire: &mut Fire, around: &Surroundings, dt: f32) -> Result<Option<Change>, ClothError> {
        if !fire.is_warm() {
            return Ok(None);
        }
        fire.burn(&self.topology, &self.particles, around, dt)?;
        let change = match fire.burnt_through() {
            [] => None,
            gone => self.remove_triangles(gone),
        };
        if let Some(change) = &change {
            fire.follow(&self.topology, change);
        }
        fire.take_toll(&self.topology, &mut self.particles, &mut self.constraints);
        Ok(change)
    }

    /// Takes triangles out; `None` if there is none of them.
    pub fn remove_triangles(&mut self, triangles: &[u32]) -> Option<Change> {
        let before = self.topology.clone();
        let change = damage::remove(&mut self.topology, triangles);
        self.follow(&before, change.as_ref());
        change
    }

    fn follow(&mut self, before: &Arc<Topology>, change: Option<&Change>) {
        match change {
            Some(change) => {
                damage::follow(before, &self.topology, change, &mut self.particles, &mut self.constraints);
                if let Some(own) = &mut self.self_contacts {
                    own.follow(&self.topology, change, &mut self.particles);
                }
            }
            None => self.topology = before.clone(),
        }
    }

    /// Advances by one tick under `gravity` (m/s²).
    pub fn step(&mut self, tick: Tick, gravity: Vec3) {
        let tick = self.begin_tick(tick, gravity);
        while let Some(sub) = self.pace.substep(&tick) {
            let effort = self.solve(&sub);
            if self.pace.accept(&tick, &sub, &effort) {
                self.accept(&sub);
                if let Some(own) = &mut self.self_contacts {
                    crate::contact::collide_self(&self.topology, &mut self.particles, &self.contacts, own, &sub);
                }
            }
        }
    }

    /// Sets what acts in this tick, and gives it as it is for this cloth.
    pub(crate) fn begin_tick(&mut self, tick: Tick, gravity: Vec3) -> Tick {
        self.particles.acceleration = gravity;
        match self.air {
            Some(_) => self.wind.sample(&self.topology, &mut self.particles),
            None => self.particles.airflow = None,
        }
        let tick = self.constraints.adapt(&self.particles, tick);
        self.pace.begin(&tick, self.contacts.least_substeps(&self.particles));
        tick
    }

    /// Tries a substep.
    pub(crate) fn solve(&mut self, sub: &Substep) -> Effort {
        if let Some(air) = &self.air {
            air.blow(&self.topology, &mut self.particles, sub);
        }
        crate::method::integrate(&mut self.particles, &self.constraints, sub);
        crate::method::solve(&mut self.particles, &mut self.constraints, sub)
    }

    /// Takes the substep that was tried, and keeps off solids.
    pub(crate) fn accept(&mut self, sub: &Substep) {
        crate::method::accept(&mut self.particles, &mut self.constraints, sub);
        let bodies = self.constraints.bodies_mut();
        crate::contact::collide_with(&self.topology, &mut self.particles, &mut self.contacts, bodies, sub);
    }
}
