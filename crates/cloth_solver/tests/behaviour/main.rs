//! Behaviour of the solver, without an engine. The tests of one file: `cargo test -p cloth_solver --test behaviour FILE::`.

mod common;

mod air;
mod bending;
mod cloth_contact;
mod contact;
mod contact_floor;
mod contact_rest;
mod contact_starts;
mod damage;
mod damage_random;
mod fabric;
mod fan;
mod fire;
mod fire_balance;
mod fire_contagion;
mod fire_cut;
mod fire_limits;
mod grab;
mod gust;
mod hanging;
mod mended;
mod mesh;
mod methods;
mod motion;
mod overload;
mod properties;
mod quads;
mod self_contact;
mod shapes;
mod shapes_contact;
#[cfg(feature = "parry")]
mod shapes_mesh;
mod starts;
mod tear;
mod topology;
mod touch;
