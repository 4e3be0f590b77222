//! A meadow: tufts of grass, flowers, trees, the ground, and where everything stands.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use etendue::mesh::TriangleMesh;
use glam::{DQuat, DVec3};

use super::noise::{mix, random, step, value};
use super::patch::{self, Grid};

/// How many tufts and flowers there are.
const PLANTS: u32 = 1_050_000;
/// Distances from the camera, which stands at the origin and looks along −z.
const NEAREST: f64 = 1.3;
const FARTHEST: f64 = 240.0;
/// Half of the angle in which plants stand.
const HALF_ANGLE: f64 = 0.56;
const TREES: u32 = 260;

/// The height of the ground: it falls into a valley, and rises to hills behind.
pub(super) fn ground_height(x: f64, z: f64) -> f64 {
    let away = -z;
    let swell = |size: f64, seed: u32| value(x / size + 90.0, z / size + 90.0, 1 << 16, seed) - 0.5;
    let near = 1.0 - step(0.0, 12.0, away);
    let slope = -4.5 * step(4.0, 60.0, away) + 15.0 * step(70.0, 300.0, away);
    slope + (1.0 - near) * (7.0 * swell(46.0, 1) + 1.4 * swell(11.0, 2)) + 0.10 * swell(1.6, 3)
}

/// The ground as a mesh, finer near the camera.
pub(super) fn ground() -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 260, rows: 320, closed_u: false, closed_v: false };
    patch::add(&mut mesh, grid, |u, v| {
        let away = -12.0 + 620.0 * v * (0.02 + 0.98 * v);
        let x = (2.0 * u - 1.0) * (14.0 + 1.1 * away.max(0.0));
        DVec3::new(x, ground_height(x, -away), -away)
    });
    patch::file(&mesh)
}

/// A tuft of grass about 0.4 high; tufts differ by their number.
fn tuft(number: u32, blades: u32) -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    for blade in 0..blades {
        let chance = |kind: u32| random(blade, kind, 300 + number);
        let turn = TAU * chance(0);
        let base = 0.07 * chance(1).sqrt();
        let length = mix(0.24, 0.46, chance(2));
        let lean = mix(0.15, 1.05, chance(3));
        let width = mix(0.0035, 0.0062, chance(4));
        let foot = DVec3::new(turn.cos(), 0.0, turn.sin()) * base;
        let away = turn + 1.6 * (chance(5) - 0.5);
        let ahead = DVec3::new(away.cos(), 0.0, away.sin());
        add_blade(&mut mesh, &Blade { foot, ahead, length, lean, width });
    }
    patch::file(&mesh)
}

/// A blade that bends over more and more towards its tip.
struct Blade {
    foot: DVec3,
    /// Where it bends to.
    ahead: DVec3,
    length: f64,
    lean: f64,
    width: f64,
}

fn add_blade(mesh: &mut TriangleMesh, blade: &Blade) {
    let across = blade.ahead.cross(DVec3::Y);
    let grid = Grid { columns: 5, rows: 1, closed_u: false, closed_v: false };
    patch::add(mesh, grid, |u, v| {
        let angle = blade.lean * u * 1.3;
        let place =
            blade.ahead * (angle.sin() * u * 0.75) + DVec3::Y * (u * (0.35 + 0.65 * angle.cos()));
        let half_width = blade.width * (1.02 - u.powi(2));
        // A fold along the middle would cost another row; smooth normals serve instead.
        blade.foot + place * blade.length + across * (half_width * (2.0 * v - 1.0))
    });
}

pub(super) fn tuft_green() -> Vec<u8> {
    tuft(0, 13)
}

pub(super) fn tuft_fresh() -> Vec<u8> {
    tuft(1, 11)
}

pub(super) fn tuft_dry() -> Vec<u8> {
    tuft(2, 8)
}

/// The stalk of a flower, 0.42 high.
pub(super) fn stalk() -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 6, rows: 5, closed_u: false, closed_v: true };
    patch::tube(&mut mesh, grid, 0.0028, flower_stalk, |_| DVec3::Z);
    patch::file(&mesh)
}

fn flower_stalk(along: f64) -> DVec3 {
    DVec3::new(0.05 * along * along, 0.42 * along, 0.015 * (4.0 * along).sin())
}

/// The petals of a daisy, on the stalk.
pub(super) fn daisy_petals() -> Vec<u8> {
    petals(15, 0.034, 0.0062, 0.18)
}

/// The petals of a poppy, on the stalk.
pub(super) fn poppy_petals() -> Vec<u8> {
    petals(5, 0.044, 0.030, 0.75)
}

/// Petals of this length and half width around the end of the stalk, raised by an angle.
fn petals(count: u32, length: f64, half_width: f64, raised: f64) -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 4, rows: 4, closed_u: false, closed_v: false };
    for petal in 0..count {
        let turn = TAU * (f64::from(petal) + 0.4 * random(petal, 0, 330)) / f64::from(count);
        let tilt = DQuat::from_rotation_z(-0.25) * DQuat::from_rotation_y(turn);
        patch::add(&mut mesh, grid, |u, v| {
            let u = 0.04 + 0.94 * u;
            let beside = (2.0 * v - 1.0) * half_width * (PI * u.powf(0.7)).sin().max(0.05);
            let angle = raised + 0.5 * u * (raised - 0.35);
            let cup = 6.0 * raised * beside * beside;
            let place =
                DVec3::new(u * length * angle.cos(), u * length * angle.sin() + cup, beside);
            flower_stalk(1.0) + tilt * place
        });
    }
    patch::file(&mesh)
}

/// The leaves of a tree about 7 high.
pub(super) fn tree_leaves() -> Vec<u8> {
    const LEAVES: u32 = 9000;
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 2, rows: 1, closed_u: false, closed_v: false };
    for leaf in 0..LEAVES {
        let chance = |kind: u32| random(leaf, kind, 350);
        // Boughs are balls of leaves, denser at their surface.
        let bough = leaf % 26;
        let spread = |kind: u32| random(bough, kind, 351) - 0.5;
        let height = mix(2.2, 6.2, random(bough, 3, 351));
        let breadth = 3.9 * (1.0 - ((height - 3.9) / 3.4).powi(2)).max(0.1).sqrt();
        let middle = DVec3::new(spread(0) * breadth, height, spread(1) * breadth);
        let direction = direction(chance(0), chance(1));
        let radius = mix(0.65, 1.15, random(bough, 4, 351)) * chance(2).powf(0.25);
        let base = middle + direction * radius * DVec3::new(1.0, 0.8, 1.0);
        let ahead = (direction + DVec3::new(0.0, -0.5, 0.0)).normalize();
        let across =
            DQuat::from_axis_angle(ahead, TAU * chance(3)) * ahead.any_orthonormal_vector();
        let size = mix(0.10, 0.19, chance(4));
        patch::add(&mut mesh, grid, |u, v| {
            let half_width = 0.36 * (PI * (0.06 + 0.88 * u)).sin();
            base + (ahead * u + across * (half_width * (2.0 * v - 1.0))) * size
        });
    }
    patch::file(&mesh)
}

fn direction(first: f64, second: f64) -> DVec3 {
    let up = 2.0 * first - 1.0;
    let (sin, cos) = (TAU * second).sin_cos();
    let flat = (1.0 - up * up).sqrt();
    DVec3::new(flat * cos, up, flat * sin)
}

/// The trunk of the tree and its lower boughs.
pub(super) fn trunk() -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 12, rows: 9, closed_u: false, closed_v: true };
    let stem = |along: f64| {
        DVec3::new(0.25 * along * along, -0.3 + 4.6 * along, 0.12 * (5.0 * along).sin())
    };
    patch::tube(&mut mesh, grid, 0.17, stem, |_| DVec3::Z);
    for bough in 0..5 {
        let (sin, cos) = (TAU * (f64::from(bough) * 0.37)).sin_cos();
        let start = stem(0.45 + 0.1 * f64::from(bough));
        let curve = |along: f64| {
            start + DVec3::new(1.3 * cos * along, 1.4 * along * (0.6 + along), 1.3 * sin * along)
        };
        patch::tube(&mut mesh, grid, 0.06, curve, |_| DVec3::new(-sin, 0.1, cos));
    }
    patch::file(&mesh)
}

/// All instances, as a scene file to be included.
pub(super) fn instances() -> Vec<u8> {
    let mut text = String::from("<scene version=\"3.0.0\">\n");
    for plant in 0..PLANTS {
        add_plant(&mut text, plant);
    }
    for tree in 0..TREES {
        add_tree(&mut text, tree);
    }
    text.push_str("</scene>\n");
    text.into_bytes()
}

fn add_plant(text: &mut String, plant: u32) {
    let chance = |kind: u32| random(plant, kind, 380);
    // As many at each distance: the nearer, the denser.
    let away = mix(NEAREST, FARTHEST, chance(0));
    let angle = (2.0 * chance(1) - 1.0) * HALF_ANGLE;
    let (x, z) = (away * angle.sin(), -away * angle.cos());
    let patch = |size: f64, seed: u32| value(x / size + 500.0, z / size + 500.0, 1 << 16, seed);
    let kind = match chance(2) {
        pick if pick < 0.030 * step(0.46, 0.74, patch(5.0, 4)) => "poppy",
        pick if pick < 0.075 * step(0.42, 0.70, patch(3.2, 5)) => "daisy",
        _ if chance(3) < 0.8 * step(0.35, 0.75, patch(9.0, 6)) => "fresh",
        _ if chance(4) < 0.16 => "dry",
        _ => "green",
    };
    // Far away, where they are sparser, they are larger.
    let size = mix(0.75, 1.25, chance(5)) * (1.0 + 0.006 * away);
    let place = Place { x, z, turn: TAU * chance(6), size };
    add_instance(text, kind, &place);
}

fn add_tree(text: &mut String, tree: u32) {
    let chance = |kind: u32| random(tree, kind, 390);
    let away = mix(62.0, 330.0, chance(0).powf(0.8));
    let angle = (2.0 * chance(1) - 1.0) * HALF_ANGLE;
    let (x, z) = (away * angle.sin(), -away * angle.cos());
    // They stand in groves.
    if value(x / 30.0 + 700.0, z / 30.0 + 700.0, 1 << 16, 7) > 0.55 {
        let place = Place { x, z, turn: TAU * chance(2), size: mix(0.7, 1.35, chance(3)) };
        add_instance(text, "tree", &place);
    }
}

struct Place {
    x: f64,
    z: f64,
    turn: f64,
    size: f64,
}

fn add_instance(text: &mut String, kind: &str, place: &Place) {
    let &Place { x, z, turn, size } = place;
    let y = ground_height(x, z) - 0.01;
    let (sin, cos) = turn.sin_cos();
    let (sin, cos) = (sin * size, cos * size);
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "<shape type=\"instance\"><ref id=\"{kind}\"/><transform name=\"to_world\"><matrix value=\"\
         {cos:.3} 0 {sin:.3} {x:.3} 0 {size:.3} 0 {y:.3} {:.3} 0 {cos:.3} {z:.3} 0 0 0 1\"/>\
         </transform></shape>",
        -sin,
    );
}
