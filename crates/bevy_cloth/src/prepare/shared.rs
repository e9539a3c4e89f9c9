//! The settings that cloths share, and which of them are others than they were.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use cloth_solver::forces::Gusts;

use crate::Method;
use crate::air::Wind;
use crate::settings::{Gravity, Shared, Substeps};
use crate::sleep::ClothSleep;
use crate::teleport::Teleport;

/// What a cloth falls back on where it has no settings of its own.
#[derive(SystemParam)]
pub(crate) struct SharedSettings<'w> {
    pub gravity: Res<'w, Shared<Gravity>>,
    pub substeps: Res<'w, Shared<Substeps>>,
    pub method: Res<'w, Shared<Method>>,
    pub wind: Res<'w, Shared<Wind>>,
    pub gusts: Res<'w, Shared<Gusts>>,
    pub teleport: Res<'w, Shared<Teleport>>,
    pub sleep: Res<'w, Shared<ClothSleep>>,
}

/// The values that were last seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SharedValues {
    gravity: Gravity,
    substeps: Substeps,
    method: Method,
    wind: Wind,
    gusts: Gusts,
    teleport: Teleport,
    sleep: ClothSleep,
}

/// Which of them are others than before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SharedChanges {
    /// Someone wrote to one of them, be it the value that it had.
    pub touched: bool,
    pub gravity: bool,
    pub substeps: bool,
    pub method: bool,
    pub wind: bool,
    pub gusts: bool,
    pub teleport: bool,
    pub sleep: bool,
}

impl SharedSettings<'_> {
    /// What changed since the last call, which saw `seen`.
    pub fn changes(&self, seen: &mut SharedValues) -> SharedChanges {
        let touched = self.gravity.is_changed()
            || self.substeps.is_changed()
            || self.method.is_changed()
            || self.wind.is_changed()
            || self.gusts.is_changed()
            || self.teleport.is_changed()
            || self.sleep.is_changed();
        if !touched {
            return SharedChanges::default();
        }
        let now = SharedValues {
            gravity: self.gravity.0,
            substeps: self.substeps.0,
            method: self.method.0,
            wind: self.wind.0,
            gusts: self.gusts.0,
            teleport: self.teleport.0,
            sleep: self.sleep.0,
        };
        let was = std::mem::replace(seen, now);
        SharedChanges {
            touched,
            gravity: now.gravity != was.gravity,
            substeps: now.substeps != was.substeps,
            method: now.method != was.method,
            wind: now.wind != was.wind,
            gusts: now.gusts != was.gusts,
            teleport: now.teleport != was.teleport,
            sleep: now.sleep != was.sleep,
        }
    }
}
