//! Loading, scattering and rejection of measured materials.

use crate::testing::material::assert_finds;
use etendue_document::{Fault, Severity};

use super::data::Measurement;

const ISOTROPIC: &[u8] = include_bytes!("isotropic.bsdf");
const SPECTRAL: &[u8] = include_bytes!("spectral.bsdf");

/// The file with all occurrences of one byte string replaced by another of equal length.
fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let place = bytes.windows(from.len()).position(|window| window == from).expect("the text");
    let mut changed = bytes.to_vec();
    changed[place..place + to.len()].copy_from_slice(to);
    changed
}

#[track_caller]
fn assert_problem(bytes: &[u8], words: &str) {
    let problem = Measurement::read(bytes).expect_err("a problem");
    assert!(problem.contains(words), "{problem}");
}

#[test]
fn what_is_no_measurement_is_refused_in_words() {
    assert_problem(b"P6 16 16", "no tensor file");
    assert_problem(&ISOTROPIC[..ISOTROPIC.len() - 1], "too early");
    assert_problem(&replaced(ISOTROPIC, b"ndf", b"nix"), "no field `ndf`");
    assert_problem(&replaced(ISOTROPIC, b"rgb", b"rbg"), "no field `spectra`");
    assert_problem(&replaced(SPECTRAL, b"wavelengths", b"wavelongths"), "no field `wavelengths`");
    // The second elevation, 0.5079, becomes the first, and then NaN.
    let second = [0x22, 0x05, 0x02, 0x3f];
    assert_problem(&replaced(ISOTROPIC, &second, &0_f32.to_le_bytes()), "do not ascend");
    assert_problem(&replaced(ISOTROPIC, &second, &f32::NAN.to_le_bytes()), "do not ascend");
}

#[test]
fn the_file_is_named_where_it_cannot_be_read() {
    assert_finds(
        r#"<bsdf type="measured"><string name="filename" value="broken.bsdf"/></bsdf>"#,
        Severity::Error,
        Fault::Syntax,
        "broken.bsdf",
    );
    assert_finds(
        r#"<bsdf type="measured"/>"#,
        Severity::Error,
        Fault::MissingParameter,
        "filename",
    );
}

#[test]
fn damaged_files_do_no_harm() {
    let mut random = etendue_testkit::TestRng::new(17);
    for round in 0..20_000 {
        let mut bytes = if round % 2 == 0 { ISOTROPIC.to_vec() } else { SPECTRAL.to_vec() };
        for _ in 0..2 {
            let place = random.below(500) as usize;
            bytes[place] = random.below(256) as u8;
        }
        // Both results are valid. The test only checks that loading terminates.
        let _ = Measurement::read(&bytes);
    }
}
