//! The constraints of one cloth, and the order in which a substep solves them.
//!
//! `kernel` has the laws, one to a file; `surface` what owns them: a grid, any other mesh, what was taken apart; `hold` what holds
//! cloth; `tension` is read off, `wear` is what damage does.

mod hold;
mod kernel;
mod surface;
mod tension;
mod wear;

pub use hold::grab::Grab;
pub use hold::pin::{Pin, Pins};
pub use hold::skin::{Skin, SkinLimit, SkinPoint};
pub use tension::{Sums, Tensions};
pub use wear::Wear;

use fearless_simd::dispatch;

use crate::body::Body;
use crate::lanes::LEVEL;
use crate::method::Method;
use crate::tick::{Effort, Substep, Tick};
use crate::topology::{Along, Change, Pieces};
use crate::{ClothError, Fabric, Particles, Soa3, Topology, measure};
use hold::pin::Towed;
use hold::skin::SkinHold;
use hold::tether::Tethers;
use kernel::links::New;
use kernel::rigid;
use surface::grid::{GridConstraints, Sweep};
use surface::mesh::MeshConstraints;
use surface::{Surface, force, nudge};

/// The constraints of one cloth and the working memory to solve them.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component))]
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    /// Hands on the cloth. Set them anew each tick or leave them.
    pub grabs: Vec<Grab>,
    pins: Pins,
    towed: Towed,
    tethers: Option<Tethers>,
    skin: Option<Box<SkinHold>>,
    surface: Surface,
    /// Rate of internal friction, 1/s.
    damping: f32,
    /// What the cloth consists of, if it is more than one piece.
    pieces: Option<Pieces>,
    bodies: Vec<rigid::Body>,
    method: Method,
    /// How worn the fabric is, if it is.
    worn: Option<wear::Kept>,
    /// [`Effort::turned`] of the last substep.
    turned: bool,
    /// [`Substep::square`] of the last substep that was accepted, s².
    square: f32,
    /// Working memory of the methods that step forces.
    pub(crate) explicit: crate::method::explicit::Scratch,
}

/// ω² H² of the fastest wave of bending, and of shear, up to which the longest substep H does. Of what is filtered more strongly, as
/// paper, nothing would stand against folds from cell to cell; and where such folds run across the cells of a grid, its filter of shear,
/// along columns and rows in turn, would no longer keep them from moving for ever.
const STIFFEST: f32 = 100.0;

impl Constraints {
    /// All constraints of a cloth of `fabric` over `topology`; no pins, no grabs, no tethers.
    pub fn new(topology: &Topology, fabric: &Fabric) -> Result<Self, ClothError> {
        fabric.validate()?;
        let surface = match topology.grid {
            Some(grid) => Surface::Grid(Box::new(GridConstraints::new(grid, topology, fabric))),
            None => Surface::Mesh(Box::new(MeshConstraints::new(topology, fabric, Method::default()))),
        };
        let pieces = topology.weave.is_some().then(|| topology.pieces());
        Ok(Self { surface, damping: fabric.damping, pieces, ..Self::default() })
    }

    /// Advances with `method` from now on. `topology` is the one the constraints were made for.
    pub fn set_method(&mut self, topology: &Topology, method: Method) {
        self.method = method;
        match &mut self.surface {
            Surface::Grid(grid) => grid.prepare_forces(topology, method.steps_forces()),
            Surface::Mesh(mesh) => {
                mesh.prepare(topology, method);
                mesh.wear(self.worn.as_ref().map(wear::Kept::wear));
            }
            Surface::Empty => {}
        }
    }

    /// The method it is advanced with.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Replaces all pins: pinned particles get inverse mass 0, released ones their own again.
    ///
    /// # Errors
    /// A pin that names no particle or no frame; then nothing changes.
    pub fn set_pins(&mut self, particles: &mut Particles, pins: Pins) -> Result<(), ClothError> {
        for pin in &pins.pins {
            if particles.mass.get(pin.particle as usize).is_none_or(|m| *m <= 0.0) {
                let particles = particles.mass.iter().filter(|m| **m > 0.0).count();
                return Err(ClothError::NoSuchParticle { field: "Pins", particle: pin.particle, particles });
            }
            if pin.frame as usize >= pins.frames.len() {
                return Err(ClothError::OutOfRange {
                    field: "Pin::frame",
                    value: pin.frame as f32,
                    allowed: "an index of Pins::frames",
                });
            }
        }
        for pin in &self.pins.pins {
            let i = pin.particle as usize;
            particles.inverse_mass[i] = 1.0 / particles.mass[i];
        }
        for pin in &pins.pins {
            particles.inverse_mass[pin.particle as usize] = 0.0;
        }
        self.pins = pins;
        self.towed.retain(|_| false);
        Ok(())
    }

    /// Sets the bodies that the cloth pushes and pulls in this tick, and which of them each frame of the [`pins`](Self::pins) is fixed to:
    /// after those frames. Methods that step forces pull no bodies, but push them.
    pub fn set_bodies(
        &mut self,
        particles: &Particles,
        bodies: impl IntoIterator<Item = Body>,
        of_frame: impl IntoIterator<Item = Option<u32>>,
    ) {
        let towing = !self.method.steps_forces();
        self.towed.begin(particles, &self.pins, bodies, of_frame.into_iter().filter(|_| towing));
    }

    /// The bodies of this tick, and what the cloth has done to them so far.
    pub fn bodies(&self) -> &[Body] {
        &self.towed.bodies
    }

    /// The same, to be pushed by contact.
    pub fn bodies_mut(&mut self) -> &mut [Body] {
        &mut self.towed.bodies
    }

    /// The pins.
    pub fn pins(&self) -> &Pins {
        &self.pins
    }

    /// The frames pins hang on, to be moved each tick.
    pub fn pin_frames_mut(&mut self) -> &mut [crate::Motion] {
        &mut self.pins.frames
    }

    /// Lets pinned particles follow points that several frames of [`pins`](Self::pins) take along, and limits how far others get from
    /// theirs; replaces what there was of both. Set pins first. Solids and other cloth may still push a particle farther.
    ///
    /// # Errors
    /// A limit out of range, or something that names no particle or no frame; then nothing changes.
    pub fn set_skin(&mut self, particles: &Particles, skin: Option<Skin>) -> Result<(), ClothError> {
        skin.iter().try_for_each(|skin| skin.validate(particles, self.pins.frames.len()))?;
        self.skin = skin.map(|skin| Box::new(SkinHold::new(skin)));
        Ok(())
    }

    /// The points that particles follow, and how far others may get from theirs.
    pub fn skin(&self) -> Option<&Skin> {
        self.skin.as_ref().map(|hold| &hold.skin)
    }

    /// Ties every free particle to its nearest pin, with `slack` strain (0 or more) before a tether acts; `None`
    /// removes all tethers. They are found from the pins as they are now: set pins first. Methods that step forces take no
    /// notice.
    ///
    /// They hold stretch that is not solved for, and carry what they hold outside the fabric: no tension tells of it and
    /// nothing tears. Cloth advanced along lines needs none, swept cloth that hangs on few pins stretches many times as far
    /// as its fabric without.
    pub fn set_tethers(&mut self, topology: &Topology, slack: Option<f32>) {
        let pinned = self.pins.pins.iter().map(|pin| pin.particle);
        self.tethers = slack.map(|slack| Tethers::new(topology, pinned, slack));
    }

    /// Takes over that the cloth, which is `now` of this topology, was taken apart. Pins stay with the particles they were
    /// on, and are gone with them; tethers whose way along the cloth has become longer are gone.
    pub(crate) fn follow(&mut self, now: &Topology, change: &Change) {
        self.pins.pins.retain(|pin| !change.gone.contains(&pin.particle));
        self.towed.retain(|pin| !change.gone.contains(&pin.particle));
        if let Some(skin) = &mut self.skin {
            skin.follow(change);
        }
        self.grabs.clear();
        let pieces = now.pieces();
        self.pieces = (pieces.triangles.len() > 1).then_some(pieces);
        match &mut self.surface {
            Surface::Grid(grid) => {
                grid.follow(now);
                grid.prepare_forces(now, self.method.steps_forces());
            }
            Surface::Mesh(mesh) => mesh.follow(now, self.method),
            Surface::Empty => {}
        }
        if let Some(tethers) = &mut self.tethers {
            tethers.follow(now);
        }
        if let Some(worn) = &mut self.worn {
            worn.follow(change);
            self.surface.wear(Some(worn.wear()));
        }
    }

    /// Takes over how worn the fabric is around each particle; `None` makes it as good as new. What is born when the cloth is
    /// taken apart is as worn as its parents. A mesh that is no grid stays as stiff against bending as it was.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        match wear {
            Some(wear) => self.worn.get_or_insert_default().update(wear),
            None => self.worn = None,
        }
        self.surface.wear(wear);
    }

    /// Number of constraints solved in a substep: one per stretched edge or triangle, bend, shear, twist, hinge and tether.
    pub fn count(&self) -> usize {
        let tethers = self.tethers.as_ref().map_or(0, Tethers::count);
        tethers
            + self.grabs.len()
            + match &self.surface {
                Surface::Empty => 0,
                Surface::Grid(grid) => grid.count(),
                Surface::Mesh(mesh) => mesh.count(),
            }
    }

    /// How far the last substep is from having solved the stretch constraints: the root mean square of
    /// `C + α̃ λ` over all links along warp and weft, in rest lengths. `None` for a mesh that is no
    /// grid.
    pub fn residual(&self, particles: &Particles) -> Option<f32> {
        match &self.surface {
            Surface::Grid(grid) => Some(grid.residual(particles, self.square)),
            Surface::Mesh(_) | Surface::Empty => None,
        }
    }

    /// Adds the forces of all energies at `position` to `force`, N.
    pub(crate) fn add_forces(&self, position: &Soa3, force: &mut Soa3) {
        match &self.worn {
            None => self.add_forces_in(New, position, force),
            Some(worn) => self.add_forces_in(worn.wear(), position, force),
        }
    }

    fn add_forces_in(&self, condition: impl wear::Condition, position: &Soa3, force: &mut Soa3) {
        match &self.surface {
            Surface::Empty => {}
            Surface::Grid(grid) => force::of_grid(grid, condition, position, force),
            Surface::Mesh(mesh) => mesh.forces.iter().for_each(|forces| forces.add(condition, position, force)),
        }
    }

    /// Gives pinned particles inverse mass 0, and those in a hand the hand's inertia too.
    pub(crate) fn take_hold(&self, particles: &mut Particles) {
        for pin in &self.pins.pins {
            particles.inverse_mass[pin.particle as usize] = 0.0;
        }
        self.towed.take_hold(particles);
        for grab in &self.grabs {
            grab.take_hold(particles);
        }
    }

    /// Moves pinned particles to where their frames are at the end of `sub`.
    pub(crate) fn apply_pins(&self, particles: &mut Particles, sub: &Substep) {
        self.pins.apply(particles, sub.end);
        self.towed.predict(&self.pins, particles, sub);
        if let Some(skin) = &self.skin {
            skin.skin.move_pins(&self.pins.frames, particles, sub.end);
        }
    }

    /// How `tick` is divided for this cloth: in at least as many substeps as leave bending and shear something of their stiffness. Methods
    /// that do not adapt take as many as they are told.
    pub fn adapt(&self, particles: &Particles, tick: Tick) -> Tick {
        if !self.method.adapts() {
            return Tick { most: tick.substeps, ..tick };
        }
        let h = tick.dt / tick.substeps.max(1) as f32;
        let [bending, shear] = match &self.surface {
            Surface::Grid(grid) => {
                let bending = [Along::Weft, Along::Warp].map(|along| grid.fastest_bending(along, h));
                [bending[0].max(bending[1]), grid.fastest_shear(h)]
            }
            Surface::Mesh(mesh) => mesh.fastest(particles, h),
            Surface::Empty => [0.0; 2],
        };
        let stiffest = bending.max(shear) / STIFFEST;
        let least = tick.substeps.max(1) as f32 * stiffest.sqrt();
        Tick { substeps: tick.substeps.max((least.ceil() as u32).min(tick.most)), ..tick }
    }

    /// Solves the constraints of a substep, soft ones first, so that what is stiff is most exact.
    pub(crate) fn solve(&mut self, particles: &mut Particles, sub: &Substep) -> Effort {
        let compliant = Sweep::Compliant(*sub);
        let mut effort = Effort::default();
        if self.turned {
            rigid::note(particles, self.pieces.as_ref(), &mut self.bodies);
        }
        match (&mut self.surface, self.method) {
            (Surface::Empty, _) => {}
            (Surface::Grid(grid), Method::XpbdSweeps) => {
                dispatch!(*LEVEL, simd => grid.sweep(simd, particles, compliant));
            }
            (Surface::Grid(grid), Method::Pbd) => {
                for _ in 0..sub.iterations {
                    dispatch!(*LEVEL, simd => grid.sweep(simd, particles, Sweep::Rigid));
                }
            }
            (Surface::Grid(grid), _) => effort = dispatch!(*LEVEL, simd => grid.solve(simd, particles, sub)),
            (Surface::Mesh(mesh), Method::Pbd) => {
                for _ in 0..sub.iterations {
                    dispatch!(*LEVEL, simd => mesh.solve_rigidly(simd, particles));
                }
            }
            (Surface::Mesh(mesh), _) => effort = dispatch!(*LEVEL, simd => mesh.solve(simd, particles, sub)),
        }
        if let Some(tethers) = &self.tethers {
            tethers.solve(particles);
        }
        let was_noted = std::mem::replace(&mut self.turned, effort.turned);
        if effort.turned && !was_noted {
            // Once more, and this time it is known what momentum to keep.
            crate::method::integrate(particles, self, sub);
            return self.solve(particles, sub);
        }
        if was_noted {
            let pinned = self.pins.pins.iter().map(|pin| pin.particle);
            let held = pinned.chain(self.grabs.iter().flat_map(|grab| grab.particles));
            rigid::keep(particles, self.pieces.as_ref(), held, &mut self.bodies);
        }
        // Last, where the load of the cloth on the hand is known: the hand damps what it does, not what it undoes.
        for grab in &self.grabs {
            grab.apply(particles, sub);
        }
        effort
    }

    /// Moves the bodies on over a substep that was accepted, before positions and velocities are taken from it.
    pub(crate) fn move_bodies(&mut self, particles: &mut Particles, sub: &Substep) {
        self.towed.accept(&self.pins, particles, sub);
    }

    /// Takes note of a substep that was accepted.
    pub(crate) fn accept(&mut self, particles: &mut Particles, sub: &Substep) {
        self.square = sub.square();
        for grab in &self.grabs {
            grab.let_go(particles);
        }
        self.towed.let_go(particles);
        if let Some(skin) = &mut self.skin {
            skin.limit(&self.pins.frames, particles, sub);
        }
    }

    /// Frees a rectangle that is jammed within its own plane: once a tick, on the velocities.
    pub(crate) fn nudge(&self, particles: &mut Particles) {
        if let Surface::Grid(grid) = &self.surface {
            nudge::nudge(grid, particles);
        }
    }

    /// Internal friction of the fabric over `dt`, s: once a tick, on the velocities.
    pub(crate) fn damp(&mut self, particles: &mut Particles, dt: f32) {
        if self.damping > 0.0 {
            let (pieces, bodies, rate) = (self.pieces.as_ref(), &mut self.bodies, self.damping);
            // A body that the cloth pulls gets what friction takes, and so friction must take no momentum.
            let towed = &self.towed;
            let held = |frame: u32| towed.body_of(frame).is_none();
            dispatch!(*LEVEL, simd => rigid::damp(simd, particles, pieces, (&self.pins, held), bodies, rate, dt));
        }
    }

    /// Finds the tension at each slot at the end of the last substep. From the multipliers where the method keeps
    /// them, else from the strains.
    pub(crate) fn tensions(&mut self, topology: &Topology, particles: &Particles, to: &mut Tensions) {
        to.clear(topology.slots());
        // Before the first substep there are no multipliers.
        let square = if self.square > 0.0 { self.square } else { 1.0 };
        match (&mut self.surface, self.method) {
            (Surface::Grid(grid), Method::XpbdLines) => {
                let spacing = grid.grid.spacing;
                for (along, across) in [(Along::Weft, spacing.y), (Along::Warp, spacing.x)] {
                    let scale = -1.0 / (square * across);
                    dispatch!(*LEVEL, simd => grid.add_tensions(simd, along, scale, to.of(along)));
                }
                if let Some(triangles) = grid.patch.as_mut().and_then(|patch| patch.triangles_mut()) {
                    triangles.add_tensions(square, to);
                }
            }
            (Surface::Mesh(mesh), method) if !method.steps_forces() && method != Method::Pbd => {
                mesh.add_tensions(square, to);
            }
            (Surface::Grid(_) | Surface::Mesh(_), _) => self.strains(topology, particles, to),
            (Surface::Empty, _) => {}
        }
    }

    fn strains(&self, topology: &Topology, particles: &Particles, to: &mut Tensions) {
        let fabric = match &self.surface {
            Surface::Grid(grid) => grid.fabric,
            Surface::Mesh(mesh) => mesh.fabric,
            Surface::Empty => return,
        };
        let stiffness = [fabric.stretch_weft, fabric.stretch_warp];
        for (slots, along, strain) in measure::threads_and_strains(topology, particles) {
            for slot in slots {
                to.add(along, slot, stiffness[along as usize] * strain, 1.0);
            }
        }
    }
}
