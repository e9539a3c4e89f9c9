//! What is seen of each particle beside its place: folds that darken, torn edges that fray, burnt and wet cloth.
//!
//! Arrays of one value for each slot; free functions on slices.

use std::borrow::Cow;

use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use cloth_solver::Topology;
use cloth_solver::damage::fire::Fire;

use crate::prepare::Skin;

/// Distance from a torn edge within which cloth frays, m. The shader knows the same number.
pub(crate) const FRAY_REACH: f32 = 0.03;

/// How often the curvature is averaged over neighbors, so that wide folds darken and not only their creases.
const SMOOTHING: usize = 3;

/// Mean curvature whose inside gets half of the light of the surroundings, 1/m: that of a fold of 2 cm radius.
const HALF_LIGHT: f32 = 25.0;

/// The least part of the light that reaches the inside of a fold.
const LEAST_LIGHT: f32 = 0.4;

/// How often water is averaged over neighbors.
const SPREADING: usize = 3;

/// Water that makes cloth look all wet, kg/m².
const SOAKED: f32 = 0.25;

/// Temperatures at which charred cloth begins to glow, and from which it glows fully, K.
const GLOW: (f32, f32) = (650.0, 950.0);

/// Texture coordinates of each render vertex: those of the mesh, or of one without any the metres along x and against y at
/// rest.
pub(crate) fn uvs<'a>(topology: &Topology, skin: &'a Skin) -> Cow<'a, [Vec2]> {
    if skin.uvs.len() == topology.vertex_particle.len() {
        return Cow::Borrowed(&skin.uvs);
    }
    let flat = |slot: &u32| topology.rest[*slot as usize];
    Cow::Owned(topology.vertex_particle.iter().map(flat).map(|p| Vec2::new(p.x, p.z - p.y)).collect())
}

/// Metres of cloth along a unit of u and of v, the mean over all triangles.
pub(crate) fn metres_per_uv(topology: &Topology, uvs: &[Vec2]) -> Vec2 {
    let (mut stretch, mut weight) = (Vec2::ZERO, 0.0);
    for (triangle, vertices) in topology.triangles.iter().zip(&topology.triangle_vertices) {
        let [a, b, c] = triangle.map(|slot| topology.rest[slot as usize]);
        let [u, v, w] = vertices.map(|vertex| uvs[vertex as usize]);
        let (first, second) = (v - u, w - u);
        let area = first.perp_dot(second);
        if area != 0.0 {
            let along_u = ((b - a) * second.y - (c - a) * first.y) / area;
            let along_v = ((c - a) * first.x - (b - a) * second.x) / area;
            stretch += Vec2::new(along_u.length(), along_v.length()) * area.abs();
            weight += area.abs();
        }
    }
    if weight > 0.0 { stretch / weight } else { Vec2::ONE }
}

/// Whether each slot lies on the border that the whole cloth had. `topology` must be whole.
pub(crate) fn hem(topology: &Topology) -> Vec<bool> {
    let mut hem = vec![false; topology.slots()];
    for slot in border(topology).flatten() {
        hem[slot as usize] = true;
    }
    hem
}

/// The edges with a triangle on one side only.
fn border(topology: &Topology) -> impl Iterator<Item = [u32; 2]> {
    let inner: HashSet<[u32; 2]> = topology.hinges.iter().map(|[a, b, ..]| [*a.min(b), *a.max(b)]).collect();
    topology.edges.iter().copied().filter(move |edge| !inner.contains(edge))
}

/// Fills `fray`, one for each slot: 0 at edges that damage made, 1 from [`FRAY_REACH`] on. Edges between two slots on the
/// `hem` of the whole cloth are not torn.
pub(crate) fn fray(topology: &Topology, hem: &[bool], fray: &mut Vec<f32>) {
    fray.clear();
    fray.resize(topology.slots(), 1.0);
    let on_hem = |slot: u32| hem.get(slot as usize).copied().unwrap_or(false);
    let mut is_torn = false;
    for [a, b] in border(topology).filter(|[a, b]| !(on_hem(*a) && on_hem(*b))) {
        (fray[a as usize], fray[b as usize]) = (0.0, 0.0);
        is_torn = true;
    }
    if !is_torn {
        return;
    }
    for [a, b] in topology.edges.iter().map(|edge| edge.map(|slot| slot as usize)) {
        let share = topology.rest[a].distance(topology.rest[b]) / FRAY_REACH;
        if fray[a] == 0.0 && fray[b] > 0.0 {
            fray[b] = fray[b].min(share);
        } else if fray[b] == 0.0 && fray[a] > 0.0 {
            fray[a] = fray[a].min(share);
        }
    }
}

/// Memory to work out curvatures.
#[derive(Clone, Debug, Default)]
pub(crate) struct Folds {
    /// Mean curvature of each slot, 1/m, smoothed: positive where the front is the inside of a fold.
    curvature: Vec<f32>,
    sums: Vec<(Vec3, f32)>,
    smooth: Vec<(f32, f32)>,
}

impl Folds {
    /// Updates the curvatures of a surface whose slots stand at `positions` (m) with unit `normals`.
    pub fn update(&mut self, topology: &Topology, positions: &[Vec3], normals: &[Vec3]) {
        self.sums.clear();
        self.sums.resize(positions.len(), (Vec3::ZERO, 0.0));
        for [a, b] in topology.edges.iter().map(|edge| edge.map(|slot| slot as usize)) {
            let step = positions[b] - positions[a];
            let length = step.length_squared();
            if length > 0.0 {
                // An edge of length l on a circle of curvature κ rises by l²κ/2 from the tangent.
                self.sums[a].0 += step / length;
                self.sums[a].1 += 0.5;
                self.sums[b].0 -= step / length;
                self.sums[b].1 += 0.5;
            }
        }
        let curvature = |((sum, weight), normal): (&(Vec3, f32), &Vec3)| {
            if *weight > 0.0 { sum.dot(*normal) / weight } else { 0.0 }
        };
        self.curvature.clear();
        self.curvature.extend(self.sums.iter().zip(normals).map(curvature));
        for _ in 0..SMOOTHING {
            self.smooth.clear();
            self.smooth.extend(self.curvature.iter().map(|own| (2.0 * own, 2.0)));
            for [a, b] in topology.edges.iter().map(|edge| edge.map(|slot| slot as usize)) {
                let (of_a, of_b) = (self.curvature[a], self.curvature[b]);
                self.smooth[a] = (self.smooth[a].0 + of_b, self.smooth[a].1 + 1.0);
                self.smooth[b] = (self.smooth[b].0 + of_a, self.smooth[b].1 + 1.0);
            }
            self.curvature.iter_mut().zip(&self.smooth).for_each(|(own, (sum, count))| *own = sum / count);
        }
    }

    /// The part of the light of the surroundings that reaches the front and the back of a slot.
    pub fn light(&self, slot: u32) -> [f32; 2] {
        let curvature = self.curvature.get(slot as usize).copied().unwrap_or(0.0);
        [curvature, -curvature].map(light)
    }
}

/// The part of the light that reaches the inside of a fold of `curvature`, 1/m.
fn light(curvature: f32) -> f32 {
    (1.0 / (1.0 + curvature.max(0.0) / HALF_LIGHT)).max(LEAST_LIGHT)
}

/// What the shader is told of fire and water at a slot: burn and wet.
///
/// Burn: up to 1 scorched, up to 2 charred, up to 3 falling apart. Wet: up to 1 soaked; below 0 glowing, down to −1.
pub(crate) fn burn_and_wet(fire: Option<&Fire>, slot: u32) -> [f32; 2] {
    let (Some(fire), at) = (fire, slot as usize) else { return [0.0; 2] };
    let (Some(scorch), Some(char)) = (fire.scorch().get(at), fire.char().get(at)) else { return [0.0; 2] };
    let apart = ((char - 0.55) / 0.4).clamp(0.0, 1.0);
    let burn = scorch.clamp(0.0, 1.0) + (2.0 * char).clamp(0.0, 1.0) + apart;
    let wet = (fire.moisture()[at] / SOAKED).clamp(0.0, 1.0);
    let hot = ((fire.temperature()[at] - GLOW.0) / (GLOW.1 - GLOW.0)).clamp(0.0, 1.0);
    [burn, if wet > 0.0 { wet } else { -hot * (4.0 * char - 1.0).clamp(0.0, 1.0) }]
}

/// Fills `marks`, one for each slot, with [`burn_and_wet`]. Water is spread a little, so that its rim does not follow the
/// cells.
pub(crate) fn marks(topology: &Topology, fire: Option<&Fire>, marks: &mut Vec<[f32; 2]>) {
    marks.clear();
    marks.extend((0..topology.slots() as u32).map(|slot| burn_and_wet(fire, slot)));
    if !marks.iter().any(|[_, wet]| *wet > 0.0) {
        return;
    }
    let mut sums = Vec::with_capacity(marks.len());
    for _ in 0..SPREADING {
        sums.clear();
        sums.extend(marks.iter().map(|[_, wet]| (2.0 * wet, 2.0)));
        for [a, b] in topology.edges.iter().map(|edge| edge.map(|slot| slot as usize)) {
            let (of_a, of_b) = (marks[a][1].max(0.0), marks[b][1].max(0.0));
            sums[a] = (sums[a].0 + of_b, sums[a].1 + 1.0);
            sums[b] = (sums[b].0 + of_a, sums[b].1 + 1.0);
        }
        // What glows stays as hot as it is.
        for (mark, (sum, count)) in marks.iter_mut().zip(&sums).filter(|(mark, _)| mark[1] >= 0.0) {
            mark[1] = sum / count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_solver::topology::Resolution;

    fn sheet() -> Topology {
        Topology::rectangle(Vec2::new(0.4, 0.4), Resolution::Cells(UVec2::splat(16))).expect("a rectangle")
    }

    #[test]
    fn a_whole_cloth_frays_nowhere() {
        let topology = sheet();
        let mut found = Vec::new();
        fray(&topology, &hem(&topology), &mut found);
        assert!(found.iter().all(|fray| *fray == 1.0));
    }

    #[test]
    fn the_hem_of_a_rectangle_is_its_four_sides() {
        let topology = sheet();
        let hem = hem(&topology);
        for slot in topology.particles() {
            let side = topology.rest[slot as usize].xy().abs().max_element() > 0.199;
            assert_eq!(hem[slot as usize], side, "{:?}", topology.rest[slot as usize]);
        }
    }

    #[test]
    fn metres_per_uv_of_a_rectangle_are_its_size() {
        let topology =
            Topology::rectangle(Vec2::new(2.0, 0.5), Resolution::Cells(UVec2::splat(4))).expect("a rectangle");
        let uv = |slot: &u32| (topology.rest[*slot as usize].xy() / Vec2::new(2.0, -0.5)) + 0.5;
        let uvs: Vec<Vec2> = topology.vertex_particle.iter().map(uv).collect();
        assert!(metres_per_uv(&topology, &uvs).abs_diff_eq(Vec2::new(2.0, 0.5), 1e-5));
    }

    /// Curved to a quarter of a circle of radius 5 cm about the vertical, open to the front.
    #[test]
    fn the_inside_of_a_fold_is_darker_than_flat_cloth_and_its_outside_is_not() {
        let topology = sheet();
        let bend = |p: &Vec3| {
            let angle = p.x / 0.05;
            Vec3::new(0.05 * angle.sin(), p.y, 0.05 * (1.0 - angle.cos()))
        };
        let mut folds = Folds::default();
        let flat = topology.rest.clone();
        let mut normals = vec![Vec3::Z; flat.len()];
        folds.update(&topology, &flat, &normals);
        let middle = topology.particles().min_by(|a, b| {
            let far = |slot: &u32| flat[*slot as usize].length();
            far(a).total_cmp(&far(b))
        });
        let middle = middle.expect("a particle");
        assert_eq!(folds.light(middle), [1.0, 1.0]);
        let bent: Vec<Vec3> = flat.iter().map(bend).collect();
        crate::render::surface::normals(&topology.triangles, &bent, &mut normals);
        folds.update(&topology, &bent, &normals);
        let [inside, outside] = folds.light(middle);
        assert!((0.4..0.8).contains(&inside), "{inside}");
        assert_eq!(outside, 1.0);
    }
}
