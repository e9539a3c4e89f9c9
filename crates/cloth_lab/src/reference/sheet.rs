//! A rectangle of cloth as the reference sees it.

use cloth_scene::{Scene, ScenePins, SceneShape};
use cloth_solver::Fabric;
use cloth_solver::forces::Air;
use glam::{DVec2, DVec3, UVec2, Vec3};

/// The air around: what it is, and how it moves, m/s.
#[derive(Clone, Copy, Debug)]
pub struct Wind {
    /// Density and coefficients.
    pub air: Air,
    /// Velocity in the cloth's frame, m/s.
    pub velocity: DVec3,
}

/// A ball that cloth cannot enter.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Centre in the cloth's frame, m.
    pub centre: DVec3,
    /// Distance particles keep from the centre, m.
    pub reach: f64,
    /// Coulomb friction coefficient, dimensionless.
    pub friction: f64,
}

/// A spring along a thread.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub ends: [usize; 2],
    /// Rest length, m.
    pub length: f64,
    /// Stiffness, N/m.
    pub stiffness: f64,
}

/// A sum of positions whose square costs energy, `½ k |Σ cᵢ xᵢ|²`: bending and twist.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    pub at: [usize; 4],
    pub weight: [f64; 4],
    /// Stiffness k, N/m.
    pub stiffness: f64,
}

/// A rectangle of particles, row by row from the top left, its springs, and what acts on it.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Particles in a row.
    pub columns: usize,
    /// Particles in a column.
    pub rows: usize,
    /// Rest distance along a row (x) and down a column (y), m.
    pub spacing: DVec2,
    /// Where each particle is at rest, m.
    pub flat: Vec<DVec3>,
    /// Mass of each particle, kg.
    pub mass: Vec<f64>,
    /// Whether each particle stays where it is.
    pub pinned: Vec<bool>,
    /// Gravity, m/s².
    pub gravity: DVec3,
    /// Rate of internal friction, 1/s.
    pub damping: f64,
    /// The air, if any.
    pub wind: Option<Wind>,
    /// What it may meet.
    pub balls: Vec<Ball>,
    pub(super) links: Vec<Link>,
    pub(super) bends: Vec<Bend>,
    /// Shear stiffness times area of a cell, J.
    pub(super) shear: f64,
}

impl Sheet {
    /// A free rectangle of `fabric`, without gravity. `size` in m, `cells` along width and height, each at least 1.
    pub fn new(size: DVec2, cells: [usize; 2], fabric: &Fabric) -> Self {
        let [columns, rows] = cells.map(|count| count.max(1) + 1);
        let spacing = DVec2::new(size.x / (columns - 1) as f64, size.y / (rows - 1) as f64);
        let mut sheet = Self {
            columns,
            rows,
            spacing,
            flat: Vec::new(),
            mass: Vec::new(),
            pinned: vec![false; columns * rows],
            gravity: DVec3::ZERO,
            damping: f64::from(fabric.damping),
            wind: None,
            balls: Vec::new(),
            links: Vec::new(),
            bends: Vec::new(),
            shear: f64::from(fabric.shear) * spacing.x * spacing.y,
        };
        for row in 0..rows {
            for column in 0..columns {
                let (x, y) = (column as f64 * spacing.x - 0.5 * size.x, 0.5 * size.y - row as f64 * spacing.y);
                sheet.flat.push(DVec3::new(x, y, 0.0));
                let area = spacing.x * spacing.y * border(row, rows) * border(column, columns);
                sheet.mass.push(f64::from(fabric.areal_density) * area);
            }
        }
        sheet.thread(fabric);
        sheet
    }

    /// Springs along rows and columns and across cells.
    fn thread(&mut self, fabric: &Fabric) {
        let (columns, rows, spacing) = (self.columns, self.rows, self.spacing);
        let at = |row: usize, column: usize| row * columns + column;
        for row in 0..rows {
            for column in 0..columns {
                let weft = spacing.y * border(row, rows) / spacing.x;
                let warp = spacing.x * border(column, columns) / spacing.y;
                let here = at(row, column);
                if column + 1 < columns {
                    self.link([here, at(row, column + 1)], spacing.x, f64::from(fabric.stretch_weft) * weft);
                }
                if row + 1 < rows {
                    self.link([here, at(row + 1, column)], spacing.y, f64::from(fabric.stretch_warp) * warp);
                }
                if column + 2 < columns {
                    let line = [here, at(row, column + 1), at(row, column + 2)];
                    self.bend(line, f64::from(fabric.bend_weft) * weft / spacing.x.powi(2));
                }
                if row + 2 < rows {
                    let line = [here, at(row + 1, column), at(row + 2, column)];
                    self.bend(line, f64::from(fabric.bend_warp) * warp / spacing.y.powi(2));
                }
                if row + 1 < rows && column + 1 < columns {
                    let twist = f64::from(fabric.bend_warp) + f64::from(fabric.bend_weft);
                    self.bends.push(Bend {
                        at: [here, here + 1, here + columns, here + columns + 1],
                        weight: [1.0, -1.0, -1.0, 1.0],
                        stiffness: twist / (spacing.x * spacing.y),
                    });
                }
            }
        }
        self.bends.retain(|bend| bend.stiffness > 0.0);
    }

    fn link(&mut self, ends: [usize; 2], length: f64, stiffness: f64) {
        self.links.push(Link { ends, length, stiffness });
    }

    fn bend(&mut self, [a, b, c]: [usize; 3], stiffness: f64) {
        self.bends.push(Bend { at: [a, b, c, c], weight: [1.0, -2.0, 1.0, 0.0], stiffness });
    }

    /// The first cloth of a scene, in its own frame. `offset` is the distance (m) it keeps from colliders, of which only
    /// balls are known here.
    ///
    /// `None` without a cloth, or with a fabric that is not known.
    pub fn from_scene(scene: &Scene, offset: f64) -> Option<Self> {
        let spec = scene.cloths.first()?;
        let fabric = spec.fabric().ok()?;
        let cells = spec.cells.to_array().map(|count| count as usize);
        let mut sheet = Self::new(spec.size.as_dvec2(), cells, &fabric);
        let place = spec.place.pose();
        let turn = |v: Vec3| (place.rotation.conjugate() * v).as_dvec3();
        sheet.gravity = turn(scene.gravity);
        sheet.wind = scene.air.map(|air| Wind { air, velocity: turn(scene.wind) });
        for pins in &spec.pins {
            sheet.pin(pins);
        }
        for weight in &spec.weights {
            let nearest = |part: f32, count: usize| (part * (count - 1) as f32).round() as usize;
            let slot = nearest(weight.at.y, sheet.rows) * sheet.columns + nearest(weight.at.x, sheet.columns);
            *sheet.mass.get_mut(slot)? += f64::from(weight.mass);
        }
        for collider in &scene.colliders {
            if let SceneShape::Sphere { radius } = collider.shape {
                let centre = place.inverse_pose(&collider.place.pose()).position.as_dvec3();
                let friction = f64::from(collider.friction.unwrap_or(fabric.friction));
                sheet.balls.push(Ball { centre, reach: f64::from(radius) + offset, friction });
            }
        }
        Some(sheet)
    }

    /// Pins particles as a scene names them.
    fn pin(&mut self, pins: &ScenePins) {
        let cells = UVec2::new(self.columns as u32 - 1, self.rows as u32 - 1);
        for place in pins.rows_and_columns(cells) {
            self.pinned[place.x as usize * self.columns + place.y as usize] = true;
        }
    }

    /// The largest tensile strain along warp or weft; 0 where nothing is stretched.
    pub fn largest_strain(&self, x: &[DVec3]) -> f64 {
        self.links.iter().map(|link| x[link.ends[0]].distance(x[link.ends[1]]) / link.length - 1.0).fold(0.0, f64::max)
    }

    /// Weight of all particles, N.
    pub fn weight(&self) -> f64 {
        self.mass.iter().sum::<f64>() * self.gravity.length()
    }

    /// The triangles that the air takes hold of, two to a cell with alternating diagonals.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        (0..self.rows - 1).flat_map(move |row| (0..self.columns - 1).map(move |column| (row, column))).flat_map(
            |(row, column)| {
                let a = row * self.columns + column;
                let [b, c, d] = [a + 1, a + self.columns, a + self.columns + 1];
                if (row + column).is_multiple_of(2) { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] }
            },
        )
    }
}

/// The part of a spacing that line `index` of `count` stands for.
fn border(index: usize, count: usize) -> f64 {
    if index == 0 || index + 1 == count { 0.5 } else { 1.0 }
}
