//! The parts of the chess pieces that are not surfaces of revolution, and the board.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::implicit::{Lattice, mesh};
use super::noise::step;
use super::paint::{self, Size};
use super::patch;
use super::solids::{
    extrude, polygon, rounded_box, rounded_corners, smooth_difference, smooth_union,
};
use super::woods::{self, Wood};

/// The outline of a horse's head and neck, which looks along +x.
const HORSE: [(f64, f64); 20] = [
    (-0.25, 0.12),
    (-0.29, 0.36),
    (-0.30, 0.58),
    (-0.24, 0.78),
    (-0.12, 0.93),
    (-0.03, 1.00),
    (-0.01, 1.12),
    (0.06, 1.02),
    (0.13, 0.92),
    (0.22, 0.80),
    (0.33, 0.65),
    (0.36, 0.56),
    (0.32, 0.47),
    (0.22, 0.46),
    (0.13, 0.54),
    (0.03, 0.56),
    (0.02, 0.48),
    (0.12, 0.36),
    (0.20, 0.26),
    (0.23, 0.12),
];

/// The head of a knight.
pub(super) fn knight() -> Vec<u8> {
    let outline = rounded_corners(&HORSE.map(DVec2::from));
    let lattice = Lattice {
        low: DVec3::new(-0.40, 0.05, -0.28),
        high: DVec3::new(0.46, 1.16, 0.28),
        cell: 0.014,
    };
    let horse = mesh(&lattice, |place| {
        let side = place.with_z(place.z.abs());
        let figure = polygon(side.truncate(), &outline);
        // The neck is thick, the muzzle is thin.
        let half_width = 0.23 - 0.13 * step(0.2, 0.95, side.y) - 0.02 * step(0.1, 0.3, side.x);
        let body = extrude(figure, side.z, half_width, 0.085);
        // Curls of the mane along the back of the neck.
        let back = side.truncate() - DVec2::new(0.15, 0.50);
        let curls = (26.0 * back.y.atan2(-back.x)).sin() * step(-0.05, -0.2, side.x);
        let body = body + 0.008 * curls;
        let eye = (side - DVec3::new(0.10, 0.79, half_width)).length() - 0.03;
        let nostril = (side - DVec3::new(0.315, 0.575, half_width - 0.01)).length() - 0.02;
        let mouth = rounded_box(
            side - DVec3::new(0.31, 0.505, half_width),
            DVec3::new(0.07, 0.006, 0.05),
            0.005,
        );
        let between_ears =
            rounded_box(side - DVec3::new(0.0, 1.07, 0.0), DVec3::new(0.12, 0.09, 0.022), 0.01);
        let body = smooth_union(body, eye, 0.02);
        let carved = nostril.min(mouth).min(between_ears);
        smooth_difference(body, carved, 0.02)
    });
    patch::file(&horse)
}

/// The battlements of a rook.
pub(super) fn battlements() -> Vec<u8> {
    const SLOTS: f64 = 6.0;
    let lattice = Lattice {
        low: DVec3::new(-0.28, 0.68, -0.28),
        high: DVec3::new(0.28, 0.98, 0.28),
        cell: 0.011,
    };
    let crown = mesh(&lattice, |place| {
        let radius = place.xz().length();
        let ring = extrude((radius - 0.19).abs() - 0.055, place.y - 0.83, 0.11, 0.018);
        let turn = place.z.atan2(place.x) / TAU * SLOTS;
        let beside = (turn - turn.round()) * TAU / SLOTS * radius;
        let slot = (beside.abs() - 0.028).max(0.855 - place.y);
        smooth_difference(ring, slot, 0.02)
    });
    patch::file(&crown)
}

/// The points of a queen's coronet.
pub(super) fn coronet() -> Vec<u8> {
    const POINTS: u32 = 9;
    let lattice = Lattice {
        low: DVec3::new(-0.30, 1.20, -0.30),
        high: DVec3::new(0.30, 1.48, 0.30),
        cell: 0.012,
    };
    let crown = mesh(&lattice, |place| {
        let ring = DVec2::new(place.xz().length() - 0.215, place.y - 1.295).length() - 0.028;
        let ball = (place - DVec3::new(0.0, 1.385, 0.0)).length() - 0.068;
        let tips = (0..POINTS).map(|index| {
            let (sin, cos) = (TAU * f64::from(index) / f64::from(POINTS)).sin_cos();
            (place - DVec3::new(0.225 * cos, 1.325, 0.225 * sin)).length() - 0.034
        });
        tips.fold(ring, |all, tip| smooth_union(all, tip, 0.03)).min(ball)
    });
    patch::file(&crown)
}

/// The cross of a king.
pub(super) fn cross() -> Vec<u8> {
    let lattice = Lattice {
        low: DVec3::new(-0.14, 1.44, -0.08),
        high: DVec3::new(0.14, 1.80, 0.08),
        cell: 0.008,
    };
    let cross = mesh(&lattice, |place| {
        let place = place - DVec3::new(0.0, 1.64, 0.0);
        let flare = |along: f64| 0.026 + 0.16 * along * along;
        let upright = rounded_box(place, DVec3::new(flare(place.y), 0.125, 0.03), 0.012);
        let bar = rounded_box(place, DVec3::new(0.105, flare(place.x), 0.03), 0.012);
        let foot = (place + DVec3::new(0.0, 0.145, 0.0)).length() - 0.055;
        smooth_union(upright.min(bar), foot, 0.03)
    });
    patch::file(&cross)
}

/// The board: eight squares by eight of side 1 around the origin, in a frame.
pub(super) fn board() -> Vec<u8> {
    let half = DVec3::new(BOARD_HALF_SIZE, 0.2, BOARD_HALF_SIZE);
    let margin = DVec3::splat(0.1);
    let lattice = Lattice { low: -half - margin, high: half + margin, cell: 0.045 };
    let board = mesh(&lattice, |place| {
        let slab = rounded_box(place, half, 0.05);
        // A groove between the squares and the frame.
        let edge = place.x.abs().max(place.z.abs()) - 4.06;
        slab.max(0.012 - DVec2::new(edge, place.y - half.y).length())
    });
    patch::file(&board)
}

const BOARD_HALF_SIZE: f64 = 4.7;

/// The picture on the board, for texture coordinates from 0 to 1 across it.
pub(super) fn board_color() -> Vec<u8> {
    const MAPLE: Wood = Wood { light: [0.80, 0.64, 0.44], dark: [0.66, 0.47, 0.29], seed: 40 };
    const WALNUT: Wood = Wood { light: [0.36, 0.22, 0.14], dark: [0.20, 0.11, 0.07], seed: 41 };
    const FRAME: Wood = Wood { light: [0.27, 0.15, 0.09], dark: [0.14, 0.07, 0.045], seed: 42 };
    paint::color(Size { width: 2400, height: 2400 }, |u, v| {
        let [x, z] = [u, v].map(|place| (2.0 * place - 1.0) * BOARD_HALF_SIZE);
        let from_center = x.abs().max(z.abs());
        if from_center > 4.06 {
            // The frame's grain follows its sides, mitred at the corners.
            let (along, across) = if x.abs() > z.abs() { (z, x) } else { (x, z) };
            return FRAME.color(along * 0.5, across, 7);
        }
        if from_center > 4.0 {
            return MAPLE.color(x * 0.5, z, 3);
        }
        let [column, row] = [x, z].map(|place| (place + 4.0).floor().clamp(0.0, 7.0) as u32);
        let wood = if (column + row) % 2 == 0 { WALNUT } else { MAPLE };
        let joint = [x, z].map(|place| 0.5 - (place - place.floor() - 0.5).abs());
        let gap = step(0.0, 0.006, joint[0].min(joint[1]));
        wood.color(x * 0.7, z, 8 * row + column).map(|value| value * (0.45 + 0.55 * gap))
    })
}

/// The grain of the light pieces; it repeats.
pub(super) fn light_grain() -> Vec<u8> {
    woods::turned([0.80, 0.60, 0.36], [0.66, 0.44, 0.23], 60)
}

/// The grain of the dark pieces; it repeats.
pub(super) fn dark_grain() -> Vec<u8> {
    woods::turned([0.19, 0.085, 0.055], [0.10, 0.042, 0.03], 61)
}
