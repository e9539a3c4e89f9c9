//! Tells the user: an event at the entity, a message, and a line in the log.

use bevy::prelude::*;

use crate::events::{
    ClothBurntOut, ClothBurntThrough, ClothCut, ClothExtinguished, ClothFellAsleep, ClothIgnited, ClothRecovered,
    ClothRejected, ClothReset, ClothTangled, ClothTorn, ClothUntangled, ClothWoke, ColliderRejected, ContactBegan,
    ContactEnded, DebrisGone, PiecesSeparated, WindRejected,
};

/// What can be told.
pub(crate) trait Report: EntityEvent + Message + Clone + for<'a> Event<Trigger<'a>: Default> {
    /// Writes the line in the log; `name` is the entity as the user knows it.
    fn log(&self, name: &str);
}

impl Report for ClothRejected {
    fn log(&self, name: &str) {
        warn!("cloth {name} is out of the simulation: {}", self.error);
    }
}

impl Report for ColliderRejected {
    fn log(&self, name: &str) {
        warn!("collider {name} was refused: {}", self.error);
    }
}

#[cfg(feature = "render")]
impl Report for crate::events::BoundRejected {
    fn log(&self, name: &str) {
        warn!("mesh {name} was not bound to its cloth: {}", self.error);
    }
}

impl Report for WindRejected {
    fn log(&self, name: &str) {
        warn!("fan or wind zone {name} was refused: {}", self.error);
    }
}

impl Report for ClothRecovered {
    fn log(&self, name: &str) {
        warn!("cloth {name} had a number that is not finite and is back in its last finite shape");
    }
}

impl Report for ClothReset {
    fn log(&self, name: &str) {
        debug!("cloth {name} was put back to its rest pose");
    }
}

impl Report for ClothTorn {
    fn log(&self, name: &str) {
        trace!("cloth {name} tore at particle {}", self.particle);
    }
}

impl Report for ClothCut {
    fn log(&self, name: &str) {
        trace!("cloth {name} was cut along {} edges", self.edges);
    }
}

impl Report for PiecesSeparated {
    fn log(&self, name: &str) {
        debug!("cloth {name} consists of {} pieces", self.pieces);
    }
}

impl Report for DebrisGone {
    fn log(&self, name: &str) {
        debug!("cloth {name} lost debris of {} triangles", self.triangles);
    }
}

impl Report for ClothIgnited {
    fn log(&self, name: &str) {
        debug!("cloth {name} burst into flame at particle {}", self.particle);
    }
}

impl Report for ClothBurntThrough {
    fn log(&self, name: &str) {
        trace!("{} triangles of cloth {name} burnt through", self.triangles);
    }
}

impl Report for ClothExtinguished {
    fn log(&self, name: &str) {
        debug!("the fire of cloth {name} went out at particle {}", self.particle);
    }
}

impl Report for ClothBurntOut {
    fn log(&self, name: &str) {
        debug!("cloth {name} burnt out");
    }
}

impl Report for ClothFellAsleep {
    fn log(&self, name: &str) {
        trace!("cloth {name} fell asleep");
    }
}

impl Report for ClothWoke {
    fn log(&self, name: &str) {
        trace!("cloth {name} woke: {:?}", self.cause);
    }
}

impl Report for ContactBegan {
    fn log(&self, name: &str) {
        trace!("collider {name} is touched by cloth {} at {} m/s", self.cloth, self.speed);
    }
}

impl Report for ContactEnded {
    fn log(&self, name: &str) {
        trace!("collider {name} was left by cloth {} after {} s", self.cloth, self.duration);
    }
}

impl Report for ClothTangled {
    fn log(&self, name: &str) {
        debug!("cloth {name} passes through itself with {} edges", self.crossings);
    }
}

impl Report for ClothUntangled {
    fn log(&self, name: &str) {
        debug!("cloth {name} is untangled");
    }
}

/// Tells `report` once the present system is done.
pub(crate) fn report(commands: &mut Commands, report: impl Report) {
    commands.queue(move |world: &mut World| report_now(world, report));
}

/// Writes a warning about `entity` to the log once the present system is done; `text` is given its name.
pub(crate) fn warn_of(commands: &mut Commands, entity: Entity, text: impl FnOnce(&str) -> String + Send + 'static) {
    commands.queue(move |world: &mut World| warn!("{}", text(&name_of(world, entity))));
}

/// The entity as the user knows it.
fn name_of(world: &World, entity: Entity) -> String {
    world.get::<Name>(entity).map_or(entity.to_string(), |name| format!("`{name}` ({entity})"))
}

/// Tells `report` at once.
pub(crate) fn report_now(world: &mut World, report: impl Report) {
    report.log(&name_of(world, report.event_target()));
    world.write_message(report.clone());
    world.trigger(report);
}
