//! One law each, values in, values out: what eight links, cells or triangles at a time do to the particles.

pub(in crate::constraint) mod bending;
pub(in crate::constraint) mod cells;
pub(in crate::constraint) mod hinges;
pub(in crate::constraint) mod lines;
pub(in crate::constraint) mod links;
pub(in crate::constraint) mod mesh_shear;
pub(in crate::constraint) mod plan;
pub(in crate::constraint) mod quad_bends;
pub(in crate::constraint) mod quad_cells;
pub(in crate::constraint) mod rigid;
pub(in crate::constraint) mod shear;
pub(in crate::constraint) mod strips;
pub(in crate::constraint) mod sweep;
pub(in crate::constraint) mod triangles;
pub(in crate::constraint) mod waves;
