//! Scene files of cloth, in RON, and a world that plays them without an engine.
//!
//! One file says what hangs where, what it is made of, what it meets and how it is advanced: see [`Scene`]. The demo
//! spawns it as entities, the lab plays it in a [`World`].

mod air;
mod error;
mod fire;
mod scene;
mod world;

pub use air::{SceneFan, SceneZone};
pub use error::SceneError;
pub use fire::SceneFire;
pub use scene::{Scene, SceneCloth, SceneCollider, SceneFabric, ScenePins, ScenePlace, SceneShape, SceneWeight};
pub use world::World;
