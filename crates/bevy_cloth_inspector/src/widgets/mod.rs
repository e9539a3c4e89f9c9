//! What sections of the panel are made of: rows with a name, a value with its unit, a tooltip and a way back to the default.
//!
//! Every row asks for all of that, so that no section can forget it.
//!
//! ```
//! use bevy_cloth_inspector::widgets::{Unit, Value};
//! # use bevy_egui::egui;
//! # fn section(ui: &mut egui::Ui, radius: &mut f32) {
//! let default = 0.5;
//! Value::new("radius", "Radius of the ball.", Unit::METRES, 0.01..=10.0).show(ui, radius, default);
//! # }
//! ```
//!
//! | module | what is in it |
//! |---|---|
//! | `value` | [`Value`]: a number, a vector of numbers, a count; [`Unit`] |
//! | `rows` | [`row`], [`switch`], [`choice`], [`color`], [`reading`], [`note`], [`refusal`] |
//! | `edit` | [`edit`]: write a component back only if it differs |

mod edit;
mod rows;
mod value;

pub use edit::{edit, edit_own_or_shared, edit_resource};
pub use rows::{choice, color, note, reading, refusal, row, switch, value_width};
pub use value::{Unit, Value};

#[cfg(test)]
pub(crate) use rows::recorded;
