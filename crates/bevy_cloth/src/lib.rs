//! Real-time cloth for the [Bevy](https://bevy.org) game engine, in SI units.
//!
//! # Contents
//! - [Example](#example)
//! - [What a cloth is made of](#what-a-cloth-is-made-of): [`Cloth`], [`Fabric`], [`Pins`], [`Weights`], [`ClothCollider`]
//! - [Skinned meshes](#skinned-meshes): [`Freedom`], [`BoneColliders`]
//! - [Settings](#settings): [`Gravity`], [`Substeps`], [`Method`], [`Teleport`], [`ClothSleep`], [`Shared`]
//! - [Motion and jumps](#motion-and-jumps): [`Teleport`], [`TeleportPolicy`]
//! - [Far and unseen](#far-and-unseen): [`ClothDetail`], [`ClothViewer`]
//! - [Sleep](#sleep): [`ClothSleep`], [`ClothAsleep`], [`WakeCloth`]
//! - [Contact](#contact): [`ContactEvents`], [`ClothForce`], [`ContactView`]
//! - [Rigid bodies](#rigid-bodies): [`ClothBody`], [`ClothPush`]
//! - [Self-contact](#self-contact): [`SelfContact`], [`ClothTangled`], [`ClothUntangled`]
//! - [Air](#air): [`Air`], [`Wind`], [`Gusts`], [`WindZone`], [`Fan`]
//! - [Damage](#damage): [`Tearable`], [`Flammable`], [`CutCloth`], [`ClothPieces`]
//! - [Time](#time): [`ClothClock`], [`ClothTime`]
//! - [What happens in a tick](#what-happens-in-a-tick): [`ClothSystems`], [`ClothSchedule`]
//! - [What is told](#what-is-told): [`ClothRejected`], [`ClothRecovered`], [`ClothStats`], [`ClothDiagnosticsPlugin`]
//! - [Saving and rollback](#saving-and-rollback): [`SavedCloths`], [`RestoreError`]
//! - [Drawing](#drawing): `ClothLook`, `ClothSubdivision`, `BoundTo`, `ClothColoring`, `ClothFlames`
//! - [Picking](#picking): `ClothPicking`, [`Grabs`]
//! - [Features](#features)
//!
//! # Example
//! A curtain on five rods, and a ball that it meets. Without a window this runs as it stands; in a game take
//! `DefaultPlugins` instead.
//! ```
//! use bevy::prelude::*;
//! use bevy_cloth::*;
//!
//! App::new()
//!     .add_plugins((MinimalPlugins, ClothPlugin::default()))
//!     .add_systems(Startup, |mut commands: Commands| {
//!         commands.spawn((Cloth::rectangle(2.0, 1.5), Fabric::COTTON_POPLIN, Pins::rods(5)));
//!         commands.spawn((ClothCollider::Sphere { radius: 0.4 }, Transform::from_xyz(0.0, -0.5, 0.1)));
//!     })
//!     .update();
//! ```
//!
//! # What a cloth is made of
//! One component per concept, each optional beside [`Cloth`], each to be inserted, changed and removed at any time.
//! [`Cloth`] says where the rest shape comes from (a rectangle, or the entity's own mesh, which may load later),
//! [`Fabric`] what it is made of, [`Pins`] what holds it, [`ParticlePins`] what is pinned by hand while it runs ([`PinParticle`],
//! [`UnpinParticle`]), [`Weights`] what hangs on it. Solids are entities with a
//! [`ClothCollider`].
//!
//! # Skinned meshes
//! [`Cloth::mesh`] on an entity with a [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh) starts in the pose of its joints, and what is
//! pinned to the cloth follows them. Paint how free each vertex is ([`ATTRIBUTE_FREEDOM`] or the red of the vertex colours: 0 pinned, 1
//! free) and insert [`Freedom`], which says how far the free ones may get from where the joints take them. While it is a cloth the plugin
//! takes `SkinnedMesh` off the entity, and gives it back with the mesh. [`BoneColliders`] on the root of an armature keeps cloth out of
//! the body, by a capsule along each bone.
//!
//! # Settings
//! [`Gravity`], [`Substeps`], [`Method`], [`Teleport`] and [`ClothSleep`] apply to every cloth as resources, [`Shared<Gravity>`](Shared) and so on; as
//! a component each overrides the shared value for one cloth. The default method suits games; the others are there to be
//! compared, and those that step forces want stiff fabric in very many substeps.
//!
//! # Motion and jumps
//! Pins, colliders, hands and the cloth's own entity may be moved at any time. What a system moves once a frame goes its way
//! evenly over the ticks of the frame, so that a slow frame strikes no harder than a fast one; what is moved in the fixed
//! schedules before each tick is never late. What goes too far for one tick (a blink, a respawn) is no motion but a jump:
//! [`Teleport`] says from where on, and whether the cloth goes along in one piece, goes to rest, or is dragged there. A
//! collider that jumps sweeps nothing along.
//!
//! # Far and unseen
//! A cloth with [`ClothDetail`] takes fewer substeps far from the camera, or from a [`ClothViewer`], and is frozen farther off, or while
//! nobody sees it.
//!
//! # Sleep
//! A cloth that has come to rest falls asleep: it stands still and is not advanced until something could move it. [`ClothSleep`]
//! says what counts as rest, and what wakes it; [`ClothSleep::NEVER`] keeps a cloth awake. A cloth that sleeps has the component
//! [`ClothAsleep`]. [`ClothFellAsleep`] and [`ClothWoke`] report it.
//!
//! # Contact
//! A [`ClothCollider`] with [`ContactEvents`] is told by [`ContactBegan`] and [`ContactEnded`] which cloth touches it, one with
//! [`ClothForce`] with what force all cloth together pushes it. A cloth with [`ContactView`] lists where it touches, for debug views.
//!
//! # Rigid bodies
//! With the feature `avian` or `rapier` cloth and the bodies of that engine push and pull each other, see the module `engines`. Bodies
//! that you move yourself get a [`ClothBody`], and are told by [`ClothPush`] what cloth did to them.
//!
//! # Self-contact
//! A cloth with the component [`SelfContact`] does not pass through itself: its layers lie on each other, the thickness of the
//! fabric apart, and rub. Without it they pass freely, and nothing is computed. Two cloths that both have it do not pass through each other
//! either, wherever their entities are, unless [`SelfContact::others`] of one of them says so. A cloth that is tangled when it is given the
//! component, or is put so, is untangled gently; [`ClothTangled`] and [`ClothUntangled`] tell. [`ClothStats`] counts what touches.
//!
//! # Air
//! A cloth with the component [`Air`] feels the air around it; without it none acts, and none is computed. [`Wind`] and its
//! [`Gusts`] are settings as above. A [`WindZone`] is an entity in which it blows otherwise, a [`Fan`] one that blows a jet,
//! which colliders shadow; both are placed by their [`Transform`](bevy::prelude::Transform), whose scale they take no notice
//! of, and everything adds up.
//!
//! # Damage
//! A cloth that is [`Tearable`] parts where its threads carry more than they can; any cloth is torn by [`TearCloth`] and cut
//! by [`CutCloth`]. What comes apart stays simulated ([`ClothPieces`]). One that is [`Flammable`] is lit by [`IgniteCloth`] and
//! put out by [`WetCloth`]; [`ClothFire`] tells temperature, fuel and char. Each tells what happens by events, and
//! [`ResetCloth`] makes a cloth whole.
//!
//! # Time
//! [`Time<ClothClock>`](ClothClock) is paused, slowed and stepped through the trait [`ClothTime`]. It advances in
//! ticks of the fixed timestep, so that neither the frame rate nor slow motion changes the motion.
//!
//! # What happens in a tick
//! [`ClothPlugin`] runs in [`FixedPostUpdate`](bevy::app::FixedPostUpdate) unless told otherwise. There it takes over what changed
//! ([`ClothSystems::Build`]), advances the clock and runs [`ClothSchedule`] zero or more times
//! ([`ClothSystems::Advance`]). All sets are public: put a system between any two. Beside `Cloth` the entity then
//! carries the solver's state: [`Particles`], [`Constraints`](cloth_solver::cloth::Constraints),
//! [`Contacts`](cloth_solver::contact::Contacts), with [`SelfContact`] [`SelfContacts`](cloth_solver::contact::SelfContacts),
//! [`ClothTopology`], [`ClothFrame`] and [`ClothHistory`].
//!
//! # What is told
//! Wrong data never panics and never stops the rest of the world: [`ClothRejected`], [`ColliderRejected`] and
//! [`WindRejected`] name the entity, the field, the value and what is allowed. A number that is not finite at run time
//! puts that one cloth back to its last finite shape ([`ClothRecovered`]). Each is an event at the entity, a message and a
//! line in the log. A mesh with faults that can be put right is mended: one line in the log says what, and [`ClothMended`].
//! Insert [`ClothStats`] to have a cloth measured, add [`ClothDiagnosticsPlugin`] for times and totals.
//!
//! # Saving and rollback
//! [`SavedCloths`] holds the state of all running cloths and puts it back, in the same world or in another one; what follows is the
//! same to the last bit. What is authored is saved by whoever authored it: all of it reflects.
//!
//! # Drawing
//! With [`Assets<Mesh>`](bevy::asset::Assets) present each cloth draws a mesh of its own: front and back as separate vertices, half
//! the fabric's thickness apart, so that any material lights both. Positions, normals, tangents and the bounding box
//! follow the cloth, interpolated between the last two ticks, and placed where what it hangs on is drawn: a cape does not lag behind
//! its wearer. [`ShownShape`] tells where each particle is drawn. Other attributes of its own mesh stay as they are. Without a
//! material the cloth gets an off-white one.
//! `ClothLook` draws it as a fabric instead: weave, colours and pattern, folds that darken, frayed tears, burnt rims, wet cloth.
//! `ClothSubdivision` draws coarse cloth smoothly, with 4 or 16 times the triangles. `BoundTo` draws a fine mesh of your own on it.
//! Cloth that burns shows flames and the light they throw, unless `ClothFlames` says otherwise.
//!
//! # Picking
//! A backend for [`bevy::picking`] casts against the shape the cloth has now. `ClothPicking` says which `ClothTool` each button is:
//! the left one grabs, the right one cuts, the middle one lights what is flammable, unless you say otherwise. Grabbing, cutting and
//! pinning work while the clock is paused, too. Grabbing by code is inserting
//! [`Grabs`].
//!
//! # Features
//! - `render` (default): drawing. Without it the crate needs no renderer.
//! - `picking` (default): picking. Without it the crate needs no window and no pointer.
//! - `serialize`: [`SavedCloths`] as bytes, and `Serialize` and `Deserialize` for it, [`Pins`], [`ParticlePins`] and [`Weights`].
//! - `avian`, `rapier`: colliders and bodies of [avian](https://docs.rs/avian3d) and [rapier](https://docs.rs/bevy_rapier3d).
//! - `gltf`: custom properties of models from Blender say what is cloth, see the module `gltf`. Needs `bevy_gltf`.

pub mod air;
pub mod bodies;
pub mod bones;
pub mod clock;
pub mod cloth;
pub mod collider;
pub mod contact;
pub mod contact_view;
pub mod damage;
pub mod detail;
pub mod diagnostics;
#[cfg(any(feature = "avian", feature = "rapier"))]
pub mod engines;
pub mod events;
pub mod freedom;
#[cfg(feature = "gltf")]
pub mod gltf;
pub mod particle_pins;
#[cfg(feature = "picking")]
pub mod picking;
pub mod pins;
#[cfg(feature = "render")]
pub mod render;
mod save;
pub mod schedule;
pub mod settings;
pub mod sleep;
mod snapshot;
pub mod stats;
pub mod teleport;
pub mod weights;

mod fault;
mod groups;
mod prepare;
mod report;
mod self_contact;
mod shown;
mod step;
mod substeps;

pub use air::Wind;
pub use bodies::{ClothBody, ClothBodySystems, ClothPush};
pub use bones::BoneColliders;
pub use clock::{ClothClock, ClothTime};
pub use cloth::{Cloth, ClothFrame, ClothHistory, ClothMended, ClothRejection, ClothSource, ClothTopology, Resolution};
pub use cloth_solver::contact::{ContactPoint, SelfContact};
pub use cloth_solver::damage::Direction;
pub use cloth_solver::forces::{Air, Fan, Gusts, Oscillation, WindZone, ZoneShape};
pub use cloth_solver::{self, ClothError, Fabric, Method, Particles};
pub use collider::{ClothCollider, ColliderFriction, ColliderShapes};
pub use contact::{ClothForce, ContactEvents};
pub use contact_view::{ContactLists, ContactView, Crossing};
pub use damage::{
    ATTRIBUTE_STRENGTH, ClothFire, ClothPiece, ClothPieces, Contagion, CutCloth, Flammability, Flammable, IgniteCloth,
    TearCloth, Tearable, WetCloth,
};
pub use detail::{ClothDetail, ClothViewer};
pub use diagnostics::ClothDiagnosticsPlugin;
#[cfg(feature = "avian")]
pub use engines::ClothAvianPlugin;
#[cfg(feature = "rapier")]
pub use engines::ClothRapierPlugin;
#[cfg(any(feature = "avian", feature = "rapier"))]
pub use engines::NoCloth;
#[cfg(feature = "render")]
pub use events::BoundRejected;
pub use events::{
    ClothBurntOut, ClothBurntThrough, ClothCut, ClothExtinguished, ClothFellAsleep, ClothIgnited, ClothRecovered,
    ClothRejected, ClothReset, ClothTangled, ClothTorn, ClothUntangled, ClothWoke, ColliderRejected, ContactBegan,
    ContactEnded, DebrisGone, PiecesSeparated, ResetCloth, WakeCloth, WindRejected,
};
pub use freedom::{ATTRIBUTE_FREEDOM, Freedom};
pub use particle_pins::{ParticlePin, ParticlePins, PinParticle, UnpinParticle};
#[cfg(feature = "picking")]
pub use picking::{ClothHit, ClothPicking, ClothTool};
pub use pins::{PinGroup, PinSelect, PinTarget, Pins};
#[cfg(feature = "render")]
pub use render::{BoundMeshes, BoundTo, ClothColoring, ClothFlames, ClothLook, ClothSubdivision, Pattern, Weave};
pub use save::{RestoreError, SavedCloths};
pub use schedule::{ClothPlugin, ClothSchedule, ClothSubstepSchedule, ClothSystems};
pub use settings::{Grab, Grabs, Gravity, Shared, Substeps};
pub use shown::ShownShape;
pub use sleep::{ClothAsleep, ClothSleep, WakeCause};
pub use snapshot::ClothSnapshot;
pub use stats::ClothStats;
pub use teleport::{Teleport, TeleportPolicy};
pub use weights::{Weight, Weights};
