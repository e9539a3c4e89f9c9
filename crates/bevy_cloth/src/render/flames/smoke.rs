//! What else rises from hot cloth: smoke, steam and sparks, as a function of the time alone, as flames are.

use std::f32::consts::TAU;

use bevy::math::ops;
use bevy::prelude::*;
use cloth_solver::Topology;
use cloth_solver::damage::fire::Stage;

use super::growth;
use super::wisp::{self, PUFFS, Root, SPARK, Wisp, hash, unit};
use crate::damage::ClothFire;

/// Most places of one cloth from which smoke or steam rises; of more each stands for several.
const MOST_SOURCES: f32 = 48.0;

/// Most places from which sparks fly.
const MOST_SPARKS: f32 = 40.0;

/// The widest piece of cloth that one of them stands for, m.
const WIDEST_SOURCE: f32 = 0.16;

/// Cloth with more water than this, kg/m², gives off steam and no smoke.
const DAMP: f32 = 0.005;

/// From where to where steam becomes thick, K.
const STEAMS: [f32; 2] = [335.0, 373.0];

/// From where to where cloth without flames begins to smoke: pyrolysis of cellulose, K.
const SMOKES: [f32; 2] = [500.0, 750.0];

/// What rises from hot cloth beside flames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Smoke,
    Steam,
    Spark,
}

/// Where it rises.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub kind: Kind,
    pub root: Root,
}

/// How puffs of smoke or steam go.
struct Puffs {
    /// Of one source at a time.
    count: u32,
    /// How long each lives, s.
    life: f32,
    /// Half the width of a puff when it is born and when it is gone, over that of the cloth it rises from.
    half: [f32; 2],
    /// Colours through its life, premultiplied, linear.
    colors: [[f32; 4]; 4],
}

/// Smoke of cotton: thin and grey, seen only above the flames.
const SMOKE: Puffs = Puffs {
    count: 4,
    life: 2.6,
    half: [0.9, 4.0],
    colors: [[0.0; 4], [0.014, 0.013, 0.012, 0.10], [0.020, 0.019, 0.018, 0.07], [0.0; 4]],
};

/// Steam is white and soon gone.
const STEAM: Puffs = Puffs {
    count: 3,
    life: 1.1,
    half: [0.7, 2.6],
    colors: [[0.0; 4], [0.14, 0.14, 0.145, 0.20], [0.08, 0.08, 0.082, 0.11], [0.0; 4]],
};

/// How long a spark flies, s; half its width and its length, m; how far it strays, m; what part of them is seen.
const SPARK_LIFE: f32 = 1.3;
const SPARK_HALF: Vec2 = Vec2::new(0.0025, 0.004);
const SPARK_STRAYS: f32 = 0.09;
const SPARKS_SEEN: f32 = 0.5;

/// Finds where smoke, steam and sparks rise.
pub(super) fn find(fire: &ClothFire, topology: &Topology, place: impl Fn(usize) -> Vec3, sources: &mut Vec<Source>) {
    sources.clear();
    let part = |value: f32, [from, to]: [f32; 2]| ((value - from) / (to - from)).clamp(0.0, 1.0);
    for slot in topology.particles() {
        let (stage, at) = (fire.stage(slot), slot as usize);
        let (temperature, is_damp) = (fire.temperature()[at], fire.moisture()[at] > DAMP);
        let (kind, strength) = match stage {
            Stage::Gone | Stage::Virgin => continue,
            Stage::Flaming => (Kind::Smoke, growth(fire.fuel()[at])),
            _ if is_damp => (Kind::Steam, part(temperature, STEAMS)),
            _ => (Kind::Smoke, part(temperature, SMOKES)),
        };
        if strength > 0.0 {
            let width = topology.area[at].sqrt();
            sources.push(Source { kind, root: Root { at: Vec3::ZERO, width, strength, seed: slot } });
        }
    }
    let count = sources.len().max(1) as f32;
    let share = (MOST_SOURCES / count).min(1.0);
    let sparks = sources
        .iter()
        .filter(|source| source.kind == Kind::Smoke && unit(hash(source.root.seed ^ 0x5a)) < MOST_SPARKS / count);
    let sparks: Vec<Source> = sparks.map(|source| Source { kind: Kind::Spark, ..*source }).collect();
    // The same places whatever else is hot, so that the plume does not jump about.
    sources.retain(|source| unit(hash(source.root.seed ^ 0x77)) < share);
    for source in &mut *sources {
        source.root.width = (source.root.width / share.sqrt()).min(WIDEST_SOURCE);
    }
    sources.extend(sparks);
    for source in sources {
        source.root.at = place(source.root.seed as usize);
    }
}

impl Source {
    /// What is seen of it at `time` s, where the hot gas streams at `stream` m/s.
    pub fn wisps(&self, time: f64, stream: Vec3) -> impl Iterator<Item = Wisp> {
        let count = match self.kind {
            Kind::Smoke => SMOKE.count,
            Kind::Steam => STEAM.count,
            Kind::Spark => 1,
        };
        (0..count).map(move |k| match self.kind {
            Kind::Smoke => self.puff(&SMOKE, k, time, stream),
            Kind::Steam => self.puff(&STEAM, k, time, stream),
            Kind::Spark => self.spark(time, stream),
        })
    }

    fn puff(&self, puffs: &Puffs, k: u32, time: f64, stream: Vec3) -> Wisp {
        let root = &self.root;
        let life = puffs.life * (0.8 + 0.4 * unit(hash(root.seed)));
        let (age, mut draw) = root.age(k, time / f64::from(life) + f64::from(k) / f64::from(puffs.count));
        let [born, gone] = puffs.half;
        let half = root.width * (born + (gone - born) * age) * (0.8 + 0.4 * draw());
        let aside = (Vec3::new(draw(), draw(), draw()) - 0.5) * (root.width * (0.4 + 3.0 * age));
        // It cools, and rises ever slower.
        let rise = stream * (life * age * (1.0 - 0.35 * age));
        let turn = TAU * draw() + (draw() - 0.5) * 2.0 * age;
        let tile = PUFFS.start + (draw() * PUFFS.len() as f32) as u32 % PUFFS.len() as u32;
        let color = wisp::color(&puffs.colors, age).map(|part| part * root.strength);
        Wisp { at: root.at + rise + aside, half: Vec2::splat(half), turn, color, tile }
    }

    fn spark(&self, time: f64, stream: Vec3) -> Wisp {
        let root = &self.root;
        let life = SPARK_LIFE * (0.6 + 0.8 * unit(hash(root.seed)));
        let (age, mut draw) = root.age(9, time / f64::from(life));
        let is_seen = draw() < SPARKS_SEEN;
        let aside = (Vec3::new(draw(), draw(), draw()) - 0.5) * root.width;
        let (phase, pace) = (TAU * draw(), 4.0 + 5.0 * draw());
        let (sin, cos) = ops::sin_cos(phase + pace * age);
        let strays = Vec3::new(cos, 0.3 * sin, sin) * (SPARK_STRAYS * age);
        let rise = stream * (life * age * (0.9 - 0.2 * age));
        let glow = if is_seen { root.strength * (age * 12.0).min(1.0) * (1.0 - age) } else { 0.0 };
        let color = [3.0, 1.0 - 0.6 * age, 0.15 * (1.0 - age), 0.0].map(|part: f32| part * glow);
        Wisp { at: root.at + aside + strays + rise, half: SPARK_HALF, turn: 0.0, color, tile: SPARK }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: Root = Root { at: Vec3::new(1.0, 2.0, 3.0), width: 0.05, strength: 1.0, seed: 5 };

    #[test]
    fn what_rises_goes_with_the_stream_and_nothing_is_born_or_goes_in_sight() {
        for kind in [Kind::Smoke, Kind::Steam, Kind::Spark] {
            for seed in 0..20 {
                let source = Source { kind, root: Root { seed, ..ROOT } };
                let stream = Vec3::new(0.4, 1.0, 0.0);
                let at = |frame: u32| source.wisps(f64::from(frame) * 1e-3, stream).collect::<Vec<_>>();
                let mut highest = 0.0_f32;
                for frame in 0..4000 {
                    for (before, now) in at(frame).iter().zip(&at(frame + 1)) {
                        let jump = before.at.distance(now.at);
                        let seen = before.color.iter().chain(&now.color).fold(0.0, |most: f32, part| most.max(*part));
                        assert!(jump < 0.01 || seen < 0.05, "{kind:?} {jump} m in a millisecond, {seen} bright");
                        highest = highest.max(now.at.y - ROOT.at.y);
                    }
                }
                assert!((0.4..2.5).contains(&highest), "{kind:?} {highest}");
            }
        }
    }
}
