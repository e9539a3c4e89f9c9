//! Scene files of cloth, in RON, and a world that plays them without an engine.
//!
//! One file says what hangs where, what it is made of, what it meets and how it is advanced: see [`Scene`]. The demo
//! spawns it as entities, the lab plays it in a [`World`].

mod air;
mod error;
mod figure;
mod fire;
mod look;
mod motion;
mod piece;
mod pins;
mod scene;
mod shape;
mod view;
mod world;
mod wrap;
mod write;

pub use air::{SceneFan, SceneZone};
pub use error::SceneError;
pub use figure::{Body, FigurePart, Gait, SceneFigure, SceneWorn, Walk};
pub use fire::SceneFire;
pub use look::{SceneLook, ScenePattern, SceneWeave};
pub use motion::SceneMotion;
pub use piece::ScenePiece;
pub use pins::ScenePins;
pub use scene::{Hardware, Scene, SceneCloth, SceneCollider, SceneFabric, ScenePlace, SceneTearing, SceneWeight};
pub use shape::SceneShape;
pub use view::{Finish, Readout, SceneCamera, SceneProp, SceneView, Setting};
pub use world::World;
pub use wrap::{SceneRing, SceneWrap};
