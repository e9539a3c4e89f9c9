//! Behaviour of the plugin and of the game, through real apps, schedules and pointer events.
//!
//! One program for all files: each program holds all of Bevy, and linking takes longer than most tests. The tests of
//! one file: `cargo test --test behaviour FILE::`.

mod common;

mod air;
mod ambiguity;
mod bad_cloth;
mod bad_collider;
mod bones;
mod bound;
mod changes;
mod clock;
mod cloth_contact;
mod collider_shapes;
mod contact_events;
mod damage;
mod despawn;
mod detail;
mod diagnostics;
mod drawing;
mod engines;
mod fan;
mod fire;
mod flames;
mod follow;
mod frame_rate;
#[cfg(feature = "gltf")]
mod gltf;
mod grab;
mod late_mesh;
mod look;
mod many;
mod meshes;
mod method;
mod moving_frame;
mod particle_pins;
mod phases;
mod picture;
mod pins;
mod recovery;
mod reflection;
mod saved;
mod scene_files;
mod self_contact;
mod shared_mesh;
mod skinned;
mod sleep;
mod snapshot;
mod subdivision;
mod teleport;
mod wake;
mod wake_surroundings;
mod weights;
mod worn;
