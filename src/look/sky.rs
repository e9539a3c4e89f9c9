//! What the sky and all around looks like in each direction, at any time of day.

use bevy::prelude::*;
use cloth_scene::{SceneView, Setting};

/// The sun's height at noon, degrees.
const NOON: f32 = 52.0;

/// Colours at one height of the sun, linear: overhead, at the horizon, and around the sun.
#[derive(Clone, Copy)]
struct Palette {
    height: f32,
    zenith: Vec3,
    horizon: Vec3,
    glow: Vec3,
    sun: Vec3,
}

/// From night by sunset to day; heights of the sun in degrees.
const PALETTES: [Palette; 5] = [
    Palette {
        height: -12.0,
        zenith: Vec3::new(0.010, 0.016, 0.036),
        horizon: Vec3::new(0.028, 0.036, 0.060),
        glow: Vec3::ZERO,
        sun: Vec3::new(0.04, 0.05, 0.08),
    },
    Palette {
        height: -2.0,
        zenith: Vec3::new(0.05, 0.08, 0.18),
        horizon: Vec3::new(0.42, 0.24, 0.20),
        glow: Vec3::new(0.9, 0.35, 0.12),
        sun: Vec3::new(0.20, 0.10, 0.06),
    },
    Palette {
        height: 7.0,
        zenith: Vec3::new(0.12, 0.22, 0.44),
        horizon: Vec3::new(0.78, 0.56, 0.40),
        glow: Vec3::new(1.5, 0.75, 0.30),
        sun: Vec3::new(0.95, 0.56, 0.26),
    },
    Palette {
        height: 22.0,
        zenith: Vec3::new(0.13, 0.28, 0.60),
        horizon: Vec3::new(0.62, 0.68, 0.72),
        glow: Vec3::new(0.95, 0.80, 0.58),
        sun: Vec3::new(1.0, 0.86, 0.66),
    },
    Palette {
        height: 52.0,
        zenith: Vec3::new(0.10, 0.27, 0.66),
        horizon: Vec3::new(0.56, 0.70, 0.82),
        glow: Vec3::new(0.8, 0.78, 0.70),
        sun: Vec3::new(1.0, 0.95, 0.86),
    },
];

/// Sky, sun and surroundings of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    setting: Setting,
    /// Towards the sun.
    pub sun: Vec3,
    /// Colour of sunlight, linear, 1 at noon.
    pub sunlight: Vec3,
    zenith: Vec3,
    /// Colour at the horizon, into which the ground fades, linear.
    pub horizon: Vec3,
    glow: Vec3,
    clouds: f32,
}

impl Sky {
    /// As a scene is to be shown.
    pub fn new(view: &SceneView) -> Self {
        let day = (view.hour - 6.0) / 12.0 * core::f32::consts::PI;
        let height = (NOON.to_radians().sin() * day.sin()).asin();
        // Looked at from +z towards −z, the sun goes from the left of its noon to the right.
        let around = view.noon.to_radians() + (view.hour - 12.0) / 12.0 * core::f32::consts::PI;
        let sun = Vec3::new(around.sin() * height.cos(), height.sin(), around.cos() * height.cos());
        let palette = at_height(height.to_degrees());
        let overcast = view.clouds * view.clouds;
        let grey = Vec3::splat(palette.horizon.dot(Vec3::new(0.3, 0.5, 0.2)));
        Self {
            setting: view.setting,
            sun,
            sunlight: palette.sun * (1.0 - overcast),
            zenith: palette.zenith.lerp(grey * 0.9, overcast),
            horizon: palette.horizon.lerp(grey * 1.05, overcast),
            glow: palette.glow * (1.0 - overcast),
            clouds: view.clouds,
        }
    }

    /// What is seen in a direction (a unit vector), linear.
    pub fn seen(&self, at: Vec3) -> Vec3 {
        match self.setting {
            Setting::Studio => studio(at) * self.daylight(),
            Setting::Plain => self.above(at),
            Setting::Meadow | Setting::Room => self.landscape(at),
        }
    }

    /// The light that comes from a direction, linear.
    pub fn lights(&self, at: Vec3) -> Vec3 {
        match self.setting {
            Setting::Studio => studio(at) * self.daylight(),
            Setting::Room => self.indoors(at),
            Setting::Plain => self.above(at).lerp(self.bounced(Vec3::new(0.46, 0.43, 0.39)), below(at)),
            Setting::Meadow => self.above(at).lerp(self.bounced(Vec3::new(0.20, 0.26, 0.10)), below(at)),
        }
    }

    /// How bright the day is, 1 at noon.
    fn daylight(&self) -> f32 {
        (self.horizon.element_sum() / 2.08).clamp(0.06, 1.0)
    }

    /// What ground of that colour throws back.
    fn bounced(&self, ground: Vec3) -> Vec3 {
        ground * (self.sunlight * self.sun.y.max(0.0) + self.zenith.lerp(self.horizon, 0.5)) * 0.8
    }

    fn above(&self, at: Vec3) -> Vec3 {
        let up = at.y.max(0.0);
        let clear = self.horizon.lerp(self.zenith, 1.0 - (1.0 - up).powi(4));
        let near = at.dot(self.sun).max(0.0);
        let halo = self.glow * (0.22 * near.powi(6) + 0.5 * near.powi(40) + 1.6 * near.powi(420));
        let sky = clear + halo * (1.0 - up * 0.4);
        let cover = self.cover(at);
        let lit = self.horizon * 0.75 + self.sunlight * 0.45 + self.glow * 0.3 * near.powi(4);
        sky.lerp(lit, cover)
    }

    /// How much cloud is in a direction, 0..=1.
    fn cover(&self, at: Vec3) -> f32 {
        if at.y < 0.02 || self.clouds <= 0.0 {
            return 0.0;
        }
        let place = Vec2::new(at.x, at.z) / (at.y + 0.14) * 1.3;
        let from = 0.86 - 0.72 * self.clouds;
        let thick = fractal(place + 7.3, 5) - 0.17;
        if thick + 0.35 <= from {
            return 0.0;
        }
        let thick = thick + 0.35 * fractal(place * 2.7 + 41.0, 3);
        let edge = ((thick - from) / 0.28).clamp(0.0, 1.0);
        0.85 * edge * edge * (3.0 - 2.0 * edge) * (at.y * 7.0).min(1.0)
    }

    /// The sky over hills.
    fn landscape(&self, at: Vec3) -> Vec3 {
        let around = Vec2::new(at.x, at.z).normalize_or(Vec2::X);
        // How far down a ridge a direction is, 0..=1. Noise costs much, and most directions are below or above all ridges.
        let inside = |height: f32, wide: f32, seed: f32| {
            let at_most = |of_noise: f32| ((height * (0.35 + of_noise) - at.y) * 160.0).clamp(0.0, 1.0);
            let (least, most) = (at_most(0.0), at_most(1.0));
            if least == most { least } else { at_most(fractal(around * wide + seed, 4)) }
        };
        let wood = Vec3::new(0.10, 0.15, 0.07) * (self.sunlight * 0.9 + self.zenith * 0.6 + self.horizon * 0.3);
        let hills = |pale: f32| wood.lerp(self.horizon, pale);
        // Two ranges, the farther one higher and paler.
        let near = inside(0.045, 5.0, 19.0);
        if near >= 1.0 {
            return hills(0.28);
        }
        let far = inside(0.085, 3.0, 3.0);
        let behind = if far >= 1.0 { hills(0.55) } else { self.above(at).lerp(hills(0.55), far) };
        behind.lerp(hills(0.28), near)
    }

    /// A room by day: light walls, a window on the left, a wooden floor.
    fn indoors(&self, at: Vec3) -> Vec3 {
        let outside = self.zenith.lerp(self.horizon, 0.7) * 1.2 + self.sunlight * 0.25;
        let walls = outside * Vec3::new(0.62, 0.585, 0.54);
        let floor = outside * Vec3::new(0.34, 0.25, 0.17);
        let room = walls.lerp(floor, (-at.y * 2.0).clamp(0.0, 1.0)).lerp(walls * 1.15, at.y.max(0.0));
        let window = |towards: Vec3| ((at.dot(towards) - 0.70) * 5.0).clamp(0.0, 1.0);
        let bright = window(Vec3::new(-0.95, 0.15, 0.30).normalize()).max(0.8 * window(Vec3::new(0.0, 0.12, -1.0)));
        room.lerp(outside * 3.4, bright)
    }
}

fn below(at: Vec3) -> f32 {
    (-at.y * 6.0).clamp(0.0, 1.0)
}

/// A studio: bright softboxes above, a light backdrop.
fn studio(at: Vec3) -> Vec3 {
    let backdrop = Vec3::new(0.60, 0.60, 0.61).lerp(Vec3::new(0.46, 0.46, 0.48), (at.y * 1.5).clamp(0.0, 1.0));
    let lamp =
        |towards: Vec3, width: f32| ((at.dot(towards.normalize()) - width) / (1.0 - width) * 2.0).clamp(0.0, 1.0);
    let key = lamp(Vec3::new(-0.7, 1.0, 0.6), 0.82);
    let fill = lamp(Vec3::new(0.9, 0.7, 0.5), 0.86);
    backdrop + Vec3::new(1.9, 1.85, 1.75) * key + Vec3::new(0.7, 0.75, 0.85) * fill
}

fn at_height(height: f32) -> Palette {
    let after = PALETTES.iter().position(|palette| palette.height > height).unwrap_or(PALETTES.len());
    let low = PALETTES[after.saturating_sub(1)];
    let high = PALETTES[after.min(PALETTES.len() - 1)];
    let part = if high.height > low.height { (height - low.height) / (high.height - low.height) } else { 0.0 };
    let part = part.clamp(0.0, 1.0);
    Palette {
        height,
        zenith: low.zenith.lerp(high.zenith, part),
        horizon: low.horizon.lerp(high.horizon, part),
        glow: low.glow.lerp(high.glow, part),
        sun: low.sun.lerp(high.sun, part),
    }
}

/// Noise in 0..=1 that is the sum of `octaves`, each twice as fine and half as strong.
pub fn fractal(mut at: Vec2, octaves: u32) -> f32 {
    let (mut sum, mut weight, mut whole) = (0.0, 1.0, 0.0);
    for _ in 0..octaves {
        sum += weight * noise(at);
        whole += weight;
        weight *= 0.5;
        at = Vec2::new(1.6 * at.x - 1.2 * at.y, 1.2 * at.x + 1.6 * at.y) + 3.7;
    }
    sum / whole
}

/// Smooth noise in 0..=1 with a wavelength of 1.
fn noise(at: Vec2) -> f32 {
    let (cell, part) = (at.floor(), at.fract_gl());
    let smooth = part * part * (3.0 - 2.0 * part);
    let corner = |x: f32, y: f32| hash(cell + Vec2::new(x, y));
    let low = corner(0.0, 0.0) * (1.0 - smooth.x) + corner(1.0, 0.0) * smooth.x;
    let high = corner(0.0, 1.0) * (1.0 - smooth.x) + corner(1.0, 1.0) * smooth.x;
    low * (1.0 - smooth.y) + high * smooth.y
}

/// A number in 0..1 for a whole place.
pub fn hash(at: Vec2) -> f32 {
    let mut bits = (at.x as i32 as u32).wrapping_mul(0x9E37_79B1) ^ (at.y as i32 as u32).wrapping_mul(0x85EB_CA77);
    bits = (bits ^ (bits >> 15)).wrapping_mul(0x2C1B_3C6D);
    bits = (bits ^ (bits >> 12)).wrapping_mul(0x297A_2D39);
    (bits >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(hour: f32) -> Sky {
        Sky::new(&SceneView { hour, noon: 0.0, clouds: 0.0, ..SceneView::default() })
    }

    #[test]
    fn the_sun_rises_at_six_stands_highest_at_noon_and_sets_at_eighteen() {
        assert!(sky(6.0).sun.y.abs() < 1e-6 && sky(18.0).sun.y.abs() < 1e-6 && sky(0.0).sun.y < -0.7);
        let noon = sky(12.0).sun;
        assert!((noon.y - NOON.to_radians().sin()).abs() < 1e-5 && noon.z > 0.5 && noon.x.abs() < 1e-5, "{noon}");
        assert!(sky(8.0).sun.x < 0.0 && sky(16.0).sun.x > 0.0, "from left to right");
    }

    #[test]
    fn night_is_darker_than_sunset_and_that_than_day() {
        let bright = |hour| sky(hour).seen(Vec3::new(0.0, 0.5, -0.86)).element_sum();
        assert!(bright(0.0) < 0.2 * bright(18.0) && bright(18.0) < 0.6 * bright(12.0));
    }

    #[test]
    fn every_setting_is_lit_from_everywhere_at_any_hour() {
        for setting in [Setting::Plain, Setting::Meadow, Setting::Room, Setting::Studio] {
            for hour in 0..=24 {
                let sky = Sky::new(&SceneView { setting, hour: hour as f32, clouds: 0.5, ..SceneView::default() });
                for at in [Vec3::X, Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Z] {
                    let (light, seen) = (sky.lights(at), sky.seen(at));
                    assert!(light.min_element() > 0.0 && light.max_element() < 20.0, "{setting:?} {hour} {at} {light}");
                    assert!(seen.is_finite() && seen.min_element() >= 0.0);
                }
            }
        }
    }
}
