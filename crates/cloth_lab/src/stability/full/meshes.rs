//! Meshes as nobody should hand them over, and hinges folded flat.

use std::f32::consts::PI;

use cloth_solver::topology::MeshSource;
use cloth_solver::{Cloth, Fabric, Topology};
use glam::{Quat, Vec2, Vec3};

use super::sheet::{TICK, fastest, run};
use super::{Outcome, Row, Trial};

/// Rows 12, 13 and 32.
pub fn rows() -> Vec<Row> {
    let mut as_handed_over = vec![broken("zero-area triangle", |mesh| mesh.indices.extend([0, 0, 1]))];
    as_handed_over.push(broken("unused vertex", |mesh| mesh.positions.push(Vec3::ONE)));
    as_handed_over.push(broken("doubled face", |mesh| mesh.indices.extend([0, 1, 3])));
    as_handed_over.push(broken("edge of three triangles", |mesh| {
        mesh.positions.push(Vec3::new(0.05, 0.05, 0.1));
        mesh.indices.extend([1, 3, 16]);
    }));
    let pole = Vec3::new(0.1, 0.1, 0.0);
    let broken = vec![
        broken("zero-length edge", |mesh| mesh.positions[1] = mesh.positions[0]),
        broken("doubled vertex", |mesh| mesh.positions[5] = mesh.positions[6]),
        broken("lone triangle beside it", |mesh| {
            mesh.positions.extend([Vec3::X, Vec3::X + Vec3::Y * 0.1, Vec3::X * 1.1]);
            mesh.indices.extend([16, 17, 18]);
        }),
        broken("triangle turned over", |mesh| mesh.indices.swap(0, 1)),
        broken("all vertices in a point", move |mesh| mesh.positions.fill(pole)),
        broken("all vertices on a line", |mesh| mesh.positions.iter_mut().for_each(|p| p.y = 0.0)),
        broken("empty mesh", |mesh| {
            mesh.positions.clear();
            mesh.indices.clear();
        }),
        broken("one triangle", |mesh| mesh.indices.truncate(3)),
        broken("no triangle", |mesh| mesh.indices.clear()),
        broken("half a triangle", |mesh| mesh.indices.truncate(5)),
        broken("index out of range", |mesh| mesh.indices[4] = 1000),
        broken("NaN vertex", |mesh| mesh.positions[5].x = f32::NAN),
        broken("infinite vertex", |mesh| mesh.positions[5].y = f32::INFINITY),
        broken("vertex 10³⁰ m away", |mesh| mesh.positions[5].y = 1e30),
    ];
    let row = |number, scene, must, trials| Row { number, scene, must, trials };
    vec![
        row(
            12,
            "meshes that are wrong in one way each",
            "an error that says why, or finite and below 15 m/s for a second",
            broken,
        ),
        row(13, "a damped hinge of paper folded by up to ±π", "flat within 1e-3 rad after 0.25 s", hinges()),
        row(
            32,
            "meshes as modellers hand them over",
            "simulated, finite and below 15 m/s for a second",
            as_handed_over.into_iter().map(simulated).collect(),
        ),
    ]
}

struct Mesh {
    positions: Vec<Vec3>,
    indices: Vec<u32>,
}

/// Four by four vertices, 10 cm apart.
fn whole() -> Mesh {
    let at = |i: u32| Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0) * 0.1;
    let quads = (0..9).map(|i| i % 3 + 4 * (i / 3));
    let indices = quads.flat_map(|i| [i, i + 1, i + 4, i + 1, i + 5, i + 4]).collect();
    Mesh { positions: (0..16).map(at).collect(), indices }
}

/// The mesh with something wrong: refused with a reason, or simulated.
fn broken(name: &'static str, spoil: impl Fn(&mut Mesh) + Send + Sync + 'static) -> Trial {
    Trial::new(name, move || {
        let mut mesh = whole();
        spoil(&mut mesh);
        let source = MeshSource { positions: &mesh.positions, uvs: &[], indices: &mesh.indices };
        let made = Topology::from_mesh(source).and_then(|topology| Cloth::new(topology.into(), &Fabric::COTTON_POPLIN));
        let mut cloth = match made {
            Ok(cloth) => cloth,
            Err(error) => return Outcome::new(!error.to_string().is_empty(), format!("refused: {error}")),
        };
        run(&mut cloth, 1.0);
        let held = cloth.particles.is_finite() && fastest(&cloth) < 15.0;
        Outcome::new(held, format!("simulated, {:.2} m/s after a second's fall", fastest(&cloth)))
    })
}

/// The same, to be refused no more.
fn simulated(trial: Trial) -> Trial {
    let Trial { at, place, play } = trial;
    let play = move || {
        let outcome = play();
        Outcome { held: outcome.held && outcome.measured.starts_with("simulated"), ..outcome }
    };
    Trial { place, ..Trial::new(at, play) }
}

fn hinges() -> Vec<Trial> {
    // Damped, or it would swing.
    let paper = Fabric { damping: 100.0, ..Fabric::PAPER };
    let trial = |angle: f32| {
        Trial::new(format!("{:.4} rad", angle), move || {
            let side = 0.02;
            let corner = |x: f32, y: f32| Vec3::new(side * x, side * y, 0.0);
            let positions = [corner(0.0, 0.0), corner(0.0, 1.0), corner(-1.0, 0.5), corner(1.0, 0.5)];
            let uvs = positions.map(|p| Vec2::new(p.x, p.y));
            let source = MeshSource { positions: &positions, uvs: &uvs, indices: &[0, 1, 2, 1, 0, 3] };
            let made = Topology::from_mesh(source).and_then(|topology| Cloth::new(topology.into(), &paper));
            let mut cloth = match made {
                Ok(cloth) => cloth,
                Err(error) => return Outcome::new(false, error.to_string()),
            };
            let bent = |rest: Vec3| if rest.x > 0.0 { Quat::from_rotation_y(angle) * rest } else { rest };
            crate::validate::rig::put(&mut cloth, bent);
            let at = |cloth: &Cloth, wanted: Vec3| {
                let slot =
                    cloth.topology.particles().find(|slot| cloth.topology.rest[*slot as usize].distance(wanted) < 1e-4);
                slot.map_or(Vec3::NAN, |slot| cloth.particles.position.get(slot as usize))
            };
            let left = [0.25, 2.0].map(|seconds| {
                (0..(seconds * 60.0) as u32).for_each(|_| cloth.step(TICK, Vec3::ZERO));
                let [a, b, left, right] = positions.map(|rest| at(&cloth, rest));
                (b - a).cross(left - a).angle_between((right - a).cross(b - a))
            });
            Outcome::new(left[0] < 1e-3, format!("{:.5} rad left, {:.5} rad 2 s later", left[0], left[1]))
        })
    };
    [PI, -PI, PI - 0.01, 0.01 - PI, 2.0, -2.0].into_iter().map(trial).collect()
}
