//! Forces from outside, one file each.

mod air;
mod fan;
mod gust;
mod wind;
mod zone;

pub use air::{Air, Airflow};
pub use fan::{Fan, Oscillation};
pub use gust::{Gusts, GustyWind};
pub use wind::WindField;
pub use zone::{WindZone, ZoneShape};
